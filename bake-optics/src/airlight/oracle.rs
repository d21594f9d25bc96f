//! The truth that the other methods are measured against: adaptive, slow, f64.

use crate::airlight::panels::{Integrand, Panel};
use crate::airlight::{Air, Airlight, Lamp, Sight};
use crate::quadrature::GaussLegendre;

/// Air-light by bisecting panels until 24 and 48 nodes agree.
///
/// *Accuracy*: 1e-13 relative, in uniform air and in sums of bounded media (parts of a ray add up to the whole within 2e-15);
/// 1e-9 expected where kinks are not known ([`crate::airlight::MediumAlong`]).
/// *Cost*: at most 20,000 panels, some ten as a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oracle {
    /// Relative error at which bisecting stops.
    pub tolerance: f64,
}

impl Default for Oracle {
    fn default() -> Self {
        Self { tolerance: 1e-14 }
    }
}

const MOST_PANELS: usize = 20_000;

/// Far beyond what any other method keeps.
const DEPTH: f64 = 700.0;

impl<A: Air<f64> + ?Sized, E: Lamp<f64>> Airlight<f64, A, E> for Oracle {
    fn radiance(&self, sight: &Sight<f64>, lamp: &E, air: &A) -> f64 {
        if sight.meets_lamp() {
            return f64::INFINITY;
        }
        let integrand = Integrand { sight, lamp, air };
        let (coarse, fine) = (GaussLegendre::cached(24), GaussLegendre::cached(48));
        let whole = |panel: Panel<f64>| (panel, 0.0, panel.width());
        let mut todo: Vec<(Panel<f64>, f64, f64)> = integrand.panels(DEPTH).into_iter().map(whole).collect();
        let scale: f64 = todo.iter().map(|(panel, from, width)| integrand.sum(panel, *from, *width, fine).abs()).sum();
        let (mut sum, mut done) = (0.0, 0);
        while let Some((panel, from, width)) = todo.pop() {
            let (a, b) = (integrand.sum(&panel, from, width, coarse), integrand.sum(&panel, from, width, fine));
            done += 1;
            let agrees = (a - b).abs() <= self.tolerance * scale.max(b.abs());
            if agrees || done + todo.len() > MOST_PANELS || width < 1e-9 * panel.width() {
                sum += b;
            } else {
                let half = 0.5 * width;
                todo.extend([(panel, from + half, half), (panel, from, half)]);
            }
        }
        sum * air.common_transmittance(sight)
    }
}
