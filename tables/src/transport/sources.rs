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
    /// Light scattered exactly `order` ≥ 1 times, albedo 1.
    pub fn order(order: usize) -> Self {
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
