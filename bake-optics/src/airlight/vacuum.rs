//! Air that scatters but takes nothing away (Macklin 2010).

use crate::Real;
use crate::airlight::{Airlight, Lamp, Sight, UniformAir, macklin};
use crate::phase::Deflection;
use crate::quadrature::GaussLegendre;

/// Air-light without extinction: σ_s times the mean of phase function × lamp over the angle seen from the lamp, times
/// [`macklin::inverse_square_integral`].
///
/// *Domain*: uniform air whose σ_t is left out: an upper bound, close while σ_t (length + distance) < 0.01.
/// *Accuracy* as a vacuum: rounding for isotropic air and lamp, with any number of nodes; 16 nodes: 1e-9 for smooth
/// phase functions; lamps with jumps 1e-2. *Cost*: two arc tangents, and a sine, a cosine and the phase function a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Vacuum {
    /// Gauss–Legendre nodes over the angle, 1..=256; 1 is Macklin's form.
    pub nodes: usize,
}

impl Default for Vacuum {
    fn default() -> Self {
        Self { nodes: 16 }
    }
}

impl<T: Real, E: Lamp<T>> Airlight<T, UniformAir<T>, E> for Vacuum {
    fn radiance(&self, sight: &Sight<T>, lamp: &E, air: &UniformAir<T>) -> T {
        if sight.meets_lamp() {
            return T::infinity();
        }
        // The deflection angle grows as the angle at the lamp does.
        let start = sight.h.atan2(-sight.z);
        let opening = macklin::opening_angle(sight.z, sight.h, sight.length);
        let mean = GaussLegendre::<T>::cached(self.nodes.clamp(1, 256)).integrate_offset(T::one(), |share| {
            let deflection = Deflection::from_angle((start + opening * share).min(T::PI()));
            let sin = (deflection.one_minus_cos * deflection.one_plus_cos).sqrt();
            let cos_axis = sight.axis_across * sin - sight.axis_along * deflection.cos_theta;
            air.phase.eval_deflected(deflection) * lamp.intensity(cos_axis)
        });
        air.sigma_s * mean * macklin::inverse_square_integral(sight.z, sight.h, sight.length)
    }
}
