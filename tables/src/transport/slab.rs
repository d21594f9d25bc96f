//! Light scattered in the half space below a plane that a directional light enters perpendicularly (irradiance 1 before it).
//!
//! Depth z ≥ 0, `μ` the cosine from the direction towards the light. The source of collision k + 1 is the fluence φ_k(z), φ_0 = e^{−z};
//! the radiance it makes is `L(μ) = ∫ e^{−t} φ_k(d − μ t)/(4π) dt`, up to the boundary for μ > 0, without end for μ < 0.

use super::fluence::Pole;
use super::profile::Profile;
use super::triangle::clustered_unit_rule;
use bake_optics::harmonics::y_zonal_all;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Optical lengths after which e^{−t} is left out.
const CUTOFF: f64 = 45.0;
/// Depths at which the fluence of a collision is tabulated.
const RANGE: (f64, f64) = (1e-6, 400.0);
const DEPTHS: usize = 480;

/// Fluence of light scattered k times (or once and more) over depth.
#[derive(Debug, Clone)]
pub struct SlabSource {
    /// κ: the exponential rate divided out.
    pub rate: f64,
    /// `φ(z) e^{κ z}`, albedo powers included where the source is a sum over orders.
    fluence: Profile,
}

impl SlabSource {
    /// Light scattered exactly `order` ≥ 1 times, albedo 1, from that of the collision before (`None` for order 1).
    pub fn order(before: Option<&Self>) -> Self {
        let q = |z: f64| before.map_or(1.0, |source| source.fluence.eval(z));
        Self { rate: 1.0, fluence: profile_of(|z| (4.0 * PI).sqrt() * zonal(z, 1.0, q, 1)[0]) }
    }

    /// Light scattered once or more in a medium of the given albedo, 0 < α ≤ 1: exact, by the resolvent of the half space.
    ///
    /// *Equation*: `φ(z) = H(1) [e^{−z} + ∫_0^z e^{−(z−t)} Φ(t) dt]` (Sobolev 1963; Ivanov 1973) with
    /// `Φ(t) = A e^{−κ t} + (α/2) ∫_0^1 e^{−t/x} / (x H(x) [(1 − αx atanh x)² + (παx/2)²]) dx`.
    pub fn all(albedo: f64) -> Self {
        let half_space = HalfSpace::new(albedo);
        let rate = half_space.rate;
        Self { rate, fluence: profile_of(|z| half_space.scattered(z)) }
    }

    /// Coefficients of the radiance this source scatters to depth `d` ≥ 0, times e^{κ d}; l < `bands`.
    pub fn zonal(&self, d: f64, bands: usize) -> Vec<f64> {
        zonal(d, self.rate, |z| self.fluence.eval(z), bands)
    }
}

fn profile_of(q: impl Fn(f64) -> f64 + Sync) -> Profile {
    let rows: Vec<_> = Profile::nodes(RANGE.0, RANGE.1, DEPTHS).par_iter().map(|&z| vec![q(z)]).collect();
    Profile::new(RANGE.0, RANGE.1, &rows)
}

/// Nodes (x, weight) on (0, 1) that crowd to both ends.
fn clustered() -> impl Iterator<Item = (f64, f64)> + Clone {
    clustered_unit_rule().iter().map(|place| (place.low, place.weight))
}

fn zonal(d: f64, rate: f64, q: impl Fn(f64) -> f64, bands: usize) -> Vec<f64> {
    let (mut sums, mut y) = (vec![0.0; bands], vec![0.0; bands]);
    for (sign, (mu, weight)) in [1.0, -1.0].iter().flat_map(|&s| clustered().map(move |node| (s, node))) {
        let mu = sign * mu;
        // e^{κd} e^{−t} φ(d − μt) = e^{−t(1−κμ)} q(d − μt).
        let decay = 1.0 - rate * mu;
        let end = if mu > 0.0 { (d / mu).min(CUTOFF / decay) } else { CUTOFF / decay };
        let along = |(x, w): (f64, f64)| w * (-decay * end * x).exp() * q(d - mu * end * x);
        let radiance = end / (4.0 * PI) * clustered().map(along).sum::<f64>();
        y_zonal_all(mu, &mut y);
        sums.iter_mut().zip(&y).for_each(|(sum, y)| *sum += 2.0 * PI * weight * radiance * y);
    }
    sums
}

/// The exact solution of the half space: H function, resolvent.
struct HalfSpace {
    rate: f64,
    h_one: f64,
    pole: f64,
    /// Nodes x of the continuous part with everything but the exponentials.
    continuum: Vec<(f64, f64)>,
}

impl HalfSpace {
    fn new(albedo: f64) -> Self {
        let rate = Pole::new(albedo).rate;
        let h = |mu: f64| h_function(albedo, mu);
        let pole = if rate == 0.0 { 3.0f64.sqrt() } else { pole_strength(albedo, rate, h(1.0 / rate)) };
        let density = |x: f64| {
            let real = 1.0 - albedo * x * x.atanh();
            let imaginary = FRAC_PI_2 * albedo * x;
            0.5 * albedo / (x * h(x) * (real * real + imaginary * imaginary))
        };
        let continuum = clustered().map(|(x, w)| (x, w * density(x))).collect();
        Self { rate, h_one: h(1.0), pole, continuum }
    }

    /// `(φ(z) − e^{−z}) e^{κ z}`.
    fn scattered(&self, z: f64) -> f64 {
        let k = self.rate;
        let pole = if k < 1.0 { self.pole * -(-(1.0 - k) * z).exp_m1() / (1.0 - k) } else { self.pole * z };
        // ∫_0^z e^{−(z−t)} e^{−t/x} dt = e^{−z} (1 − e^{−z(1/x − 1)})/(1/x − 1).
        let inner = |&(x, w): &(f64, f64)| {
            let rate = (1.0 / x - 1.0).max(1e-15);
            w * -(-z * rate).exp_m1() / rate
        };
        let fast = (-(1.0 - k) * z).exp();
        let bracket = fast * self.continuum.iter().map(inner).sum::<f64>() + pole;
        (self.h_one - 1.0) * fast + self.h_one * bracket
    }
}

/// Residue A of the resolvent at its pole s = −κ, from `1 + Φ̃(s) = H(1/s)` and `H(1/s) H(−1/s) Λ(s) = 1` with
/// `Λ(s) = 1 − α atanh(s)/s`: `A = 1/(Λ'(−κ) H(1/κ))`, `Λ'(−κ) = (α/(1−κ²) − 1)/κ`. √3 in the conservative limit.
fn pole_strength(albedo: f64, rate: f64, h_at_inverse_rate: f64) -> f64 {
    let slope = (albedo / (1.0 - rate * rate) - 1.0) / rate;
    1.0 / (slope * h_at_inverse_rate)
}

/// Chandrasekhar's H function of the isotropic half space, μ ≥ 0.
///
/// *Equation*: `ln H(μ) = −(μ/π) ∫_0^{π/2} ln(1 − α θ cot θ)/(cos²θ + μ² sin²θ) dθ` (Stibbs & Weir 1959).
fn h_function(albedo: f64, mu: f64) -> f64 {
    let integrand = |(x, w): (f64, f64)| {
        let theta = FRAC_PI_2 * x;
        let (s, c) = theta.sin_cos();
        let gap = if theta < 1e-2 {
            1.0 - albedo + albedo * theta * theta * (1.0 / 3.0 + theta * theta / 45.0)
        } else {
            1.0 - albedo * theta * c / s
        };
        w * gap.ln() / (c * c + mu * mu * s * s)
    };
    (-mu * 0.5 * clustered().map(integrand).sum::<f64>()).exp()
}
