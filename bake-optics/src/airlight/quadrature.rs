//! The recommended evaluator: a fixed number of Gauss–Legendre nodes on each side of the lamp's foot.

use crate::Real;
use crate::airlight::panels::Integrand;
use crate::airlight::{Air, Airlight, Lamp, Sight};
use crate::quadrature::GaussLegendre;

/// Air-light by `nodes` Gauss–Legendre nodes before and `nodes` past the lamp's foot (all of them on one side where the
/// ray has only one); pieces between jumps of the lamp or borders of the air each get their own.
///
/// *Domain*: every phase function, lamp and analytic medium; any σ, h ≥ 0, length up to infinity, in f32 and f64.
/// *Accuracy* in uniform air: `docs/airlight.md`. Terms are positive, so nothing cancels.
/// *Cost*: per node one exponential before the foot, two past it, and the phase function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quadrature {
    nodes: usize,
}

impl Quadrature {
    /// `nodes` per side, clamped to 1..=128.
    pub fn new(nodes: usize) -> Self {
        Self { nodes: nodes.clamp(1, 128) }
    }
}

impl Default for Quadrature {
    /// 24 per side: f32's own precision for smooth phase functions.
    fn default() -> Self {
        Self::new(24)
    }
}

/// Optical depth beyond which light is left out: e^{−depth} below the digits of T and, for narrow lobes, well below.
fn cut<T: Real>() -> T {
    T::of(T::pick(30.0, 45.0))
}

impl<T: Real, A: Air<T> + ?Sized, E: Lamp<T>> Airlight<T, A, E> for Quadrature {
    fn radiance(&self, sight: &Sight<T>, lamp: &E, air: &A) -> T {
        if sight.meets_lamp() {
            return T::infinity();
        }
        let integrand = Integrand { sight, lamp, air };
        let panels = integrand.panels(cut());
        let both = panels.iter().any(|p| p.is_past()) && panels.iter().any(|p| !p.is_past());
        let rule = GaussLegendre::<T>::cached(if both { self.nodes } else { 2 * self.nodes });
        let mut sum = T::zero();
        for panel in &panels {
            sum += integrand.graded_sum(panel, rule);
        }
        sum * air.common_transmittance(sight)
    }
}
