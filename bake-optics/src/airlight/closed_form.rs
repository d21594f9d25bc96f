//! Pegoraro, Schott & Parker 2010 in partial fractions: Legendre phase function × Legendre lamp in uniform air.
//!
//! The paper sums antiderivatives of e^{−Hv} v^n/(v²+1)^m (eqs. 29, 30), which cancel without bound. The same content is one
//! rational function R(v) = Φ I/(v² + 1) with its only poles at ±i: R = 2 Re Σ_p C_p (v + i)^{−p}, and
//!
//! ```text
//! ∫_v^∞ e^{−H (v' − v)} R dv' = 2 Re Σ_p C_p (v + i)^{1−p} S_p(H (v + i)),    S_p(z) = e^z E_p(z).
//! ```
//!
//! The C_p are Laurent coefficients at u = v + i = 0; with A = 1/(v² + 1) = (i/2) Σ_k (−i/2)^k u^{k−1}, the cosines are
//! μ = 2A − 1 and c = −axis_along μ + 2 axis_across (u − i) A, and Legendre's recurrence runs on series in u.

use num_complex::Complex;

use crate::airlight::panels::Integrand;
use crate::airlight::{Air, Airlight, Quadrature, Sight, UniformAir};
use crate::emitter::Emitter;
use crate::legendre;
use crate::phase::Phase;
use crate::special::scaled_exponential_integrals;

/// Air-light in closed form.
///
/// *Domain*: uniform air, f64. Phase functions that are no polynomial are cut to `bands` Legendre terms (Henyey–Greenstein
/// g = 0.5 needs 11 for 4e-3 at its peak, g = 0.9 needs 110: use [`Quadrature`]); lamps are taken exactly where they are piecewise
/// polynomial (isotropic, Legendre, cos^n with integer n, spot cone), else cut to `bands` too.
/// Where the closed form cancels (pieces that span less than 0.05 in asinh(z/h); H < 1e-6) it hands over to 64 quadrature nodes.
/// *Accuracy*, relative to the air-light of an isotropic lamp in isotropic air: 1e-12 up to degree 12 (reference data, H = 1e-6 to 40).
/// Where lamp or phase function is nearly dark along the ray, fewer digits of the little that is left: 7e-10 at worst for degree 1.
/// *Cost*: 1 µs, O(degree³) beyond degree 4; `docs/airlight.md`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClosedForm {
    /// Legendre terms for what is no polynomial.
    pub bands: usize,
}

impl Default for ClosedForm {
    fn default() -> Self {
        Self { bands: 11 }
    }
}

impl Airlight<f64, UniformAir<f64>> for ClosedForm {
    fn radiance(&self, sight: &Sight<f64>, lamp: &Emitter<f64>, air: &UniformAir<f64>) -> f64 {
        if sight.meets_lamp() {
            return f64::INFINITY;
        }
        let integrand = Integrand { sight, lamp, air };
        let pieces = integrand.pieces(DEPTH, &[]);
        if air.sigma_t * sight.h < 1e-6 || pieces.iter().any(|&piece| is_narrow(sight, piece)) {
            return Quadrature::new(64).radiance(sight, lamp, air);
        }
        let phase = phase_series(&air.phase, self.bands);
        let sum: f64 = pieces.iter().map(|&piece| self.piece(sight, lamp, air, &phase, piece)).sum();
        2.0 * air.sigma_s / sight.h * sum * air.common_transmittance(sight)
    }
}

/// Beyond any rounding: pieces beyond are left out.
const DEPTH: f64 = 700.0;

impl ClosedForm {
    /// `e^{−σ excess} ∫ e^{−H (v − v_from)} R dv` over one piece.
    fn piece(
        &self,
        sight: &Sight<f64>,
        lamp: &Emitter<f64>,
        air: &UniformAir<f64>,
        phase: &[f64],
        (from, to): (f64, f64),
    ) -> f64 {
        let middle = if to.is_finite() { 0.5 * (from + to) } else { from + 1.0 };
        let lamp = lamp_series(lamp, sight.cos_axis(&sight.point(middle)), self.bands);
        let poles = principal_parts(sight, phase, &lamp);
        let tail = |s: f64| {
            let excess = sight.excess(s);
            let v = (sight.behind() + excess) / sight.h;
            (-air.sigma_t * excess).exp() * tail(&poles, air.sigma_t * sight.h, v)
        };
        tail(from) - if to.is_finite() { tail(to) } else { 0.0 }
    }
}

/// Whether a piece spans so little of asinh(z/h) that its ends' values cancel.
fn is_narrow(sight: &Sight<f64>, (from, to): (f64, f64)) -> bool {
    let angle = |s: f64| ((sight.z + s) / sight.h).asinh();
    to.is_finite() && angle(to) - angle(from) < 0.05
}

/// `∫_v^∞ e^{−H (v' − v)} R dv'`.
fn tail(poles: &[Complex<f64>], h: f64, v: f64) -> f64 {
    let u = Complex::new(v, 1.0);
    let mut integrals = vec![Complex::default(); poles.len()];
    scaled_exponential_integrals(u * h, &mut integrals);
    let mut power = Complex::new(1.0, 0.0);
    let mut sum = 0.0;
    for (c, s) in poles.iter().zip(&integrals) {
        sum += (c * power * s).re;
        power /= u;
    }
    2.0 * sum
}

/// Legendre coefficients of the phase function itself (1/sr).
fn phase_series(phase: &Phase<f64>, bands: usize) -> Vec<f64> {
    let count = match phase {
        Phase::Isotropic => 1,
        Phase::Linear { .. } => 2,
        Phase::Rayleigh => 3,
        Phase::Legendre(a) => a.len().max(1),
        _ => bands,
    };
    (0..count).map(|l| phase.moment(l) * (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI)).collect()
}

/// Legendre coefficients of the polynomial that the lamp is around `cos_axis`.
fn lamp_series(lamp: &Emitter<f64>, cos_axis: f64, bands: usize) -> Vec<f64> {
    match lamp {
        Emitter::Isotropic => vec![1.0],
        Emitter::Legendre(c) => c.clone(),
        Emitter::CosinePower { exponent } if exponent.fract() == 0.0 && *exponent <= 40.0 => {
            let n = *exponent as usize;
            legendre::project(n + 1, n + 1, &[], |c: f64| c.powi(n as i32))
        }
        Emitter::SpotCone { cos_inner, .. } if cos_axis >= *cos_inner => vec![1.0],
        Emitter::SpotCone { cos_inner, cos_outer } => {
            legendre::project(3, 3, &[], |c: f64| ((c - cos_outer) / (cos_inner - cos_outer)).powi(2))
        }
        _ => lamp.legendre(bands),
    }
}

/// C_1 … C_N of Φ I/(v² + 1).
fn principal_parts(sight: &Sight<f64>, phase: &[f64], lamp: &[f64]) -> Vec<Complex<f64>> {
    let terms = phase.len() + lamp.len() - 1;
    let i = Complex::<f64>::i();
    let mut a = vec![i * 0.5];
    (1..terms).for_each(|k| a.push(a[k - 1] * i * -0.5));
    let below = |k: usize| if k == 0 { Complex::default() } else { a[k - 1] };
    let cos_theta = Series { order: 1, terms: (0..terms).map(|k| 2.0 * a[k] - f64::from(u8::from(k == 1))).collect() };
    let across = |k: usize| (below(k) - i * a[k]) * (2.0 * sight.axis_across);
    let cos_axis =
        Series { order: 1, terms: (0..terms).map(|k| across(k) - cos_theta.terms[k] * sight.axis_along).collect() };
    let product = cos_theta.legendre(phase).times(&cos_axis.legendre(lamp)).times(&Series { order: 1, terms: a });
    product.terms.into_iter().rev().collect()
}

/// Laurent series `Σ_j terms[j] u^{j − order}`, cut to a fixed number of terms.
#[derive(Clone)]
struct Series {
    order: usize,
    terms: Vec<Complex<f64>>,
}

impl Series {
    fn times(&self, other: &Self) -> Self {
        let term = |k: usize| (0..=k).map(|j| self.terms[j] * other.terms[k - j]).sum();
        Self { order: self.order + other.order, terms: (0..self.terms.len()).map(term).collect() }
    }

    /// `factor·self` added to a series of the same or higher order.
    fn add_to(&self, sum: &mut Self, factor: f64) {
        let shift = sum.order - self.order;
        for j in shift..sum.terms.len() {
            sum.terms[j] += self.terms[j - shift] * factor;
        }
    }

    /// `Σ c_l P_l` of this series (of order 1), Bonnet's recurrence.
    fn legendre(&self, coefficients: &[f64]) -> Self {
        let count = self.terms.len();
        let mut one = vec![Complex::default(); count];
        one[0] = Complex::new(1.0, 0.0);
        let zero = |order: usize| Self { order, terms: vec![Complex::default(); count] };
        let (mut below, mut current) = (zero(0), Self { order: 0, terms: one });
        let mut sum = zero(coefficients.len() - 1);
        for (l, &c) in coefficients.iter().enumerate() {
            current.add_to(&mut sum, c);
            let l = l as f64;
            let mut next = self.times(&current);
            next.terms.iter_mut().for_each(|t| *t *= (2.0 * l + 1.0) / (l + 1.0));
            below.add_to(&mut next, -l / (l + 1.0));
            (below, current) = (current, next);
        }
        sum
    }
}
