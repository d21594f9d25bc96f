//! The method that everyone uses: equal steps along the ray.

use crate::Real;
use crate::airlight::{Air, Airlight, Lamp, PathPoint, Sight};
use crate::phase::Deflection;

/// Air-light by `steps` midpoints at equal distances.
///
/// *Domain*: as [`crate::airlight::Quadrature`]; an infinite ray is marched as far as optical depth 12.
/// *Accuracy*: second order in the step where the step is below the lamp's distance from the ray, useless above: with 32
/// steps errors of per cents are usual. Here as baseline. *Cost*: one square root, one exponential, the phase function a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RayMarch {
    /// Number of steps; 0 counts as 1.
    pub steps: usize,
}

impl<T: Real, A: Air<T> + ?Sized, E: Lamp<T>> Airlight<T, A, E> for RayMarch {
    fn radiance(&self, sight: &Sight<T>, lamp: &E, air: &A) -> T {
        if sight.meets_lamp() {
            return T::infinity();
        }
        let (one, eye) = (T::one(), sight.eye_distance());
        let steps = self.steps.max(1);
        let step = air.end(sight, T::zero(), T::of(12.0)) / T::of(steps as f64);
        let mut sum = T::zero();
        for i in 0..steps {
            let s = step * T::of(i as f64 + 0.5);
            let z = sight.z + s;
            let r = (z * z + sight.h * sight.h).sqrt();
            let inverse = one / r;
            let cos_theta = -z * inverse;
            let deflection = Deflection { cos_theta, one_minus_cos: one - cos_theta, one_plus_cos: one + cos_theta };
            let point = PathPoint { s, excess: s + r - eye, deflection, sin_theta: sight.h * inverse };
            let light = air.scattering(s, deflection) * air.transmittance(&point);
            sum += lamp.intensity(sight.cos_axis(&point)) * light * inverse * inverse;
        }
        sum * step * air.common_transmittance(sight)
    }
}
