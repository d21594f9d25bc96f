//! Light that has already scattered, as the source of the next collision.
//!
//! Of light scattered k times only the fluence scatters on (isotropic medium). An emitter whose intensity is P_l'(cos) about
//! an axis makes the fluence `f_{k,l'}(r) P_l'(cos)`; by reciprocity f_{k,l'} is also the P_l' moment of the radiance that an
//! isotropic emitter sends to distance r, which is how it is computed here:
//! `f_{k,l'}(d) = (1/2d) ∫∫ P_l'(cos γ) e^{−t} r² f_{k−1,0}(r) dβ dγ`.

use super::fluence::{Fluence, Pole};
use super::profile::Profile;
use super::triangle::Triangle;
use bake_optics::legendre::legendre_all;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Legendre degrees l' = 0 … 16 of an axial emitter.
pub const EMITTER_DEGREES: usize = 17;

/// Distances at which sources are tabulated. Outside, the end values are held; what lies there weighs less than 1e-6.
const RANGE: (f64, f64) = (1e-6, 500.0);
const NODES: usize = 480;

/// Light scattered k times (or k times and more), by the emitter's Legendre degree.
#[derive(Debug, Clone)]
pub struct Source {
    /// κ: the exponential rate divided out.
    pub rate: f64,
    /// Lanes `q_l'(r) = r² f_l'(r) e^{κ r}`, albedo powers included where the source is a sum over orders.
    pub moments: Profile,
}

impl Source {
    /// Light scattered exactly `order` times, 1 … 10, albedo 1. Made once in a process, in about half a second.
    pub fn order(order: usize) -> Self {
        static MADE: [OnceLock<Source>; 10] = [const { OnceLock::new() }; 10];
        MADE[order - 1].get_or_init(|| Self::make_order(order)).clone()
    }

    fn make_order(order: usize) -> Self {
        let this = Fluence::order(order);
        let q_before = match order {
            1 => None,
            _ => {
                let fluence = Fluence::order(order - 1);
                Some(profile_of(|r| r * r * fluence.eval_scaled(r, 1.0)))
            }
        };
        let before = |r: f64| q_before.as_ref().map_or(1.0, |profile| profile.eval(r));
        Self { rate: 1.0, moments: moments(1.0, 1.0, before, |r| r * r * this.eval_scaled(r, 1.0)) }
    }

    /// Light scattered once or more in a medium of the given albedo, 0 < α ≤ 1.
    pub fn all(albedo: f64) -> Self {
        let scattered = Fluence::from_order_on(1, albedo);
        let rate = Pole::new(albedo).rate;
        let own = profile_of(|r| r * r * scattered.eval_scaled(r, rate));
        let before = |r: f64| (-(1.0 - rate) * r).exp() + own.eval(r);
        Self { rate, moments: moments(rate, albedo, before, |r| own.eval(r)) }
    }
}

fn profile_of(q: impl Fn(f64) -> f64 + Sync) -> Profile {
    let nodes = Profile::nodes(RANGE.0, RANGE.1, NODES);
    let rows: Vec<_> = nodes.par_iter().map(|&r| vec![q(r)]).collect();
    Profile::new(RANGE.0, RANGE.1, &rows)
}

/// All lanes: degree 0 from the exact fluence, the others by the integral above from the source `before`.
fn moments(rate: f64, albedo: f64, before: impl Fn(f64) -> f64 + Sync, exact: impl Fn(f64) -> f64 + Sync) -> Profile {
    let nodes = Profile::nodes(RANGE.0, RANGE.1, NODES);
    let row = |&d: &f64| {
        let mut lanes = zonal_moments(d, rate, &before, EMITTER_DEGREES);
        lanes.iter_mut().for_each(|m| *m *= albedo * d);
        lanes[0] = exact(d);
        lanes
    };
    let rows: Vec<_> = nodes.par_iter().map(row).collect();
    Profile::new(RANGE.0, RANGE.1, &rows)
}

/// `½ ∫∫ P_l(cos γ) e^{−t} q(r) e^{−κ(r−d)} dβ dγ` for l < `bands`: d e^{κd} times the P_l moment of the radiance at distance d
/// from an isotropic emitter whose light of the collision before has `r² f(r) = q(r) e^{−κ r}`.
pub fn zonal_moments(d: f64, rate: f64, q: impl Fn(f64) -> f64, bands: usize) -> Vec<f64> {
    let (mut sums, mut p) = (vec![0.0; bands], vec![0.0; bands]);
    for row in &Triangle::standard().rows {
        let inner = |n: &super::triangle::Node| {
            n.weight * q(d * n.side_outer) * (-d * (rate * (n.side_outer - 1.0) + n.side_inner)).exp()
        };
        let value = 0.5 * row.weight * row.nodes.iter().map(inner).sum::<f64>();
        legendre_all(row.cos_outer, &mut p);
        sums.iter_mut().zip(&p).for_each(|(sum, p)| *sum += p * value);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::quadrature::GaussLegendre;
    use std::f64::consts::PI;
    use testkit::{compare::Worst, reference};

    /// Radiance scattered exactly `order` times at angle γ from the light: the source along the ray,
    /// `L = ∫ e^{−t} φ(r)/(4π) dt` with `r = h cosh w`, `t = d cos γ + h sinh w`, h = d sin γ.
    fn radiance(d: f64, gamma: f64, q: impl Fn(f64) -> f64) -> f64 {
        let (h, along) = (d * gamma.sin(), d * gamma.cos());
        let (start, end) = (-(along / h).asinh(), (40.0 / h).asinh());
        let middle = start.max(0.0) + 2.0;
        let rule = GaussLegendre::<f64>::new(96);
        let value = |w: f64| {
            let (r, t) = (h * w.cosh(), along + h * w.sinh());
            (-t - r).exp() * q(r) / (4.0 * PI * r)
        };
        rule.integrate(start, middle, value) + rule.integrate(middle, end.max(middle), value)
    }

    #[test]
    fn the_reference_radiances_are_met() {
        let Some(path) = reference::shared("reference/radiance_k.csv") else { return };
        let sources: Vec<_> = (1..10).map(Source::order).collect();
        let mut worst = Worst::new("radiance_k.csv, relative", 1e-6);
        for row in reference::read_csv(&path) {
            let (d, gamma, k) = (row.number("d"), row.number("gamma_rad"), row.number("k") as usize);
            if k == 0 || k > 10 {
                continue;
            }
            let q = |r: f64| if k == 1 { 1.0 } else { sources[k - 2].moments.eval(r) };
            worst.relative(radiance(d, gamma, q), row.number("L_k"), || format!("d {d} gamma {gamma} k {k}"));
        }
        worst.check();
        // Negative control: the source of the collision before.
        let (right, wrong) = (|r: f64| sources[1].moments.eval(r), |r: f64| sources[0].moments.eval(r));
        assert!((radiance(1.0, 0.5, wrong) / radiance(1.0, 0.5, right) - 1.0).abs() > 0.1);
    }
}
