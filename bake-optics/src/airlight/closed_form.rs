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

use crate::Real;
use crate::airlight::panels::Integrand;
use crate::airlight::{Air, Airlight, IsotropicLamp, Lamp, Quadrature, Sight, UniformAir};
use crate::emitter::Emitter;
use crate::legendre;
use crate::phase::Phase;
use crate::special::scaled_exponential_integrals;

/// Air-light in closed form.
///
/// *Domain*: uniform air; f64 with every lamp, f32 with [`IsotropicLamp`] only. Phase functions that are no polynomial are cut to
/// `bands` Legendre terms (Henyey–Greenstein g = 0.5 needs 11 for 4e-3 at its peak, g = 0.9 needs 110: use [`Quadrature`]); lamps
/// are taken exactly where they are piecewise polynomial (isotropic, Legendre, cos^n with integer n, spot cone), else cut to
/// `bands` too. Where the closed form cancels (pieces that span less than 0.05 in asinh(z/h); H < 1e-6; in f32 also less than 2 %
/// of the endless ray, and phase functions beyond degree 2) it hands over to quadrature.
/// *Accuracy*, relative to the air-light of an isotropic lamp in isotropic air: in f64 1e-12 up to degree 12 (reference data,
/// H = 1e-6 to 40), in f32 3e-5. Where lamp or phase function is nearly dark along the ray, fewer digits of the little that is
/// left: 7e-10 at worst for degree 1 in f64.
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
        self.evaluate(sight, lamp, air, |cos_axis| lamp_series(lamp, cos_axis, self.bands))
    }
}

impl<T: Real> Airlight<T, UniformAir<T>, IsotropicLamp> for ClosedForm {
    fn radiance(&self, sight: &Sight<T>, lamp: &IsotropicLamp, air: &UniformAir<T>) -> T {
        self.evaluate(sight, lamp, air, |_| vec![T::one()])
    }
}

/// Legendre terms of the phase function beyond which f32 has no digits left (Pegoraro et al. 2010's order 10: errors above 1).
const MOST_TERMS_SINGLE: usize = 3;

/// Share of the endless ray's light below which the difference of two tails has lost its f32 digits. A bound on asinh(z/h) alone
/// does not see it: at 1e-4 rad from a lamp behind the ray's end it leaves an error of 6e-3.
const LEAST_SHARE_SINGLE: f64 = 0.02;

impl ClosedForm {
    /// `lamp_series`: Legendre coefficients of the polynomial that the lamp is around a cosine from its axis.
    fn evaluate<T: Real, E: Lamp<T>>(
        &self,
        sight: &Sight<T>,
        lamp: &E,
        air: &UniformAir<T>,
        lamp_series: impl Fn(T) -> Vec<T>,
    ) -> T {
        if sight.meets_lamp() {
            return T::infinity();
        }
        // Depth beyond any rounding: pieces beyond are left out.
        let pieces = Integrand { sight, lamp, air }.pieces(T::of(T::pick(80.0, 700.0)), &[]);
        let phase = phase_series(&air.phase, self.bands);
        let cancels = air.sigma_t * sight.h < T::of(1e-6)
            || phase.len() > T::pick(MOST_TERMS_SINGLE, usize::MAX)
            || pieces.iter().any(|&piece| is_narrow(sight, piece));
        let by_quadrature = || Quadrature::new(T::pick(24, 64)).radiance(sight, lamp, air);
        if cancels {
            return by_quadrature();
        }
        let (mut sum, mut whole) = (T::zero(), T::zero());
        for (from, to) in pieces {
            let middle = if to.is_finite() { T::of(0.5) * (from + to) } else { from + T::one() };
            let poles = principal_parts(sight, &phase, &lamp_series(sight.cos_axis(&sight.point(middle))));
            let start = tail_from(sight, air, &poles, from);
            whole += start.abs();
            sum += start;
            sum -= if to.is_finite() { tail_from(sight, air, &poles, to) } else { T::zero() };
        }
        if sum < whole * T::of(T::pick(LEAST_SHARE_SINGLE, 0.0)) {
            return by_quadrature();
        }
        T::of(2.0) * air.sigma_s / sight.h * sum * air.common_transmittance(sight)
    }
}

/// `e^{−σ excess} ∫ e^{−H (v − v_s)} R dv` from distance `s` on.
fn tail_from<T: Real>(sight: &Sight<T>, air: &UniformAir<T>, poles: &[Complex<T>], s: T) -> T {
    let excess = sight.excess(s);
    let v = (sight.behind() + excess) / sight.h;
    (-air.sigma_t * excess).exp() * tail(poles, air.sigma_t * sight.h, v)
}

/// Whether a piece spans so little of asinh(z/h) that its ends' values cancel.
fn is_narrow<T: Real>(sight: &Sight<T>, (from, to): (T, T)) -> bool {
    let angle = |s: T| ((sight.z + s) / sight.h).asinh();
    to.is_finite() && angle(to) - angle(from) < T::of(0.05)
}

/// `∫_v^∞ e^{−H (v' − v)} R dv'`.
fn tail<T: Real>(poles: &[Complex<T>], h: T, v: T) -> T {
    let u = Complex::new(v, T::one());
    let zero = Complex::new(T::zero(), T::zero());
    let mut integrals = vec![zero; poles.len()];
    scaled_exponential_integrals(u * h, &mut integrals);
    let mut power = Complex::new(T::one(), T::zero());
    let mut sum = T::zero();
    for (&c, &s) in poles.iter().zip(&integrals) {
        sum += (c * power * s).re;
        power /= u;
    }
    T::of(2.0) * sum
}

/// Legendre coefficients of the phase function itself (1/sr).
fn phase_series<T: Real>(phase: &Phase<T>, bands: usize) -> Vec<T> {
    let count = match phase {
        Phase::Isotropic => 1,
        Phase::Linear { .. } => 2,
        Phase::Rayleigh => 3,
        Phase::Legendre(a) => a.len().max(1),
        _ => bands,
    };
    let norm = |l: usize| T::of((2 * l + 1) as f64 * 0.25 * std::f64::consts::FRAC_1_PI);
    (0..count).map(|l| phase.moment(l) * norm(l)).collect()
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
fn principal_parts<T: Real>(sight: &Sight<T>, phase: &[T], lamp: &[T]) -> Vec<Complex<T>> {
    let terms = phase.len() + lamp.len() - 1;
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    let i = Complex::new(zero, one);
    let mut a = vec![i * T::of(0.5)];
    (1..terms).for_each(|k| a.push(a[k - 1] * i * T::of(-0.5)));
    let below = |k: usize| if k == 0 { Complex::new(zero, zero) } else { a[k - 1] };
    let constant = |k: usize| if k == 1 { one } else { zero };
    let cos_theta = Series { order: 1, terms: (0..terms).map(|k| a[k] * two - constant(k)).collect() };
    let across = |k: usize| (below(k) - i * a[k]) * (two * sight.axis_across);
    let cos_axis =
        Series { order: 1, terms: (0..terms).map(|k| across(k) - cos_theta.terms[k] * sight.axis_along).collect() };
    let product = cos_theta.legendre(phase).times(&cos_axis.legendre(lamp)).times(&Series { order: 1, terms: a });
    product.terms.into_iter().rev().collect()
}

/// Laurent series `Σ_j terms[j] u^{j − order}`, cut to a fixed number of terms.
#[derive(Clone)]
struct Series<T> {
    order: usize,
    terms: Vec<Complex<T>>,
}

impl<T: Real> Series<T> {
    fn zero(order: usize, count: usize) -> Self {
        Self { order, terms: vec![Complex::new(T::zero(), T::zero()); count] }
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = Self::zero(self.order + other.order, self.terms.len());
        for (k, term) in product.terms.iter_mut().enumerate() {
            (0..=k).for_each(|j| *term += self.terms[j] * other.terms[k - j]);
        }
        product
    }

    /// `factor·self` added to a series of the same or higher order.
    fn add_to(&self, sum: &mut Self, factor: T) {
        let shift = sum.order - self.order;
        for j in shift..sum.terms.len() {
            sum.terms[j] += self.terms[j - shift] * factor;
        }
    }

    /// `Σ c_l P_l` of this series (of order 1), Bonnet's recurrence.
    fn legendre(&self, coefficients: &[T]) -> Self {
        let count = self.terms.len();
        let (mut below, mut current) = (Self::zero(0, count), Self::zero(0, count));
        current.terms[0] = Complex::new(T::one(), T::zero());
        let mut sum = Self::zero(coefficients.len() - 1, count);
        for (l, &c) in coefficients.iter().enumerate() {
            current.add_to(&mut sum, c);
            let l = l as f64;
            let mut next = self.times(&current);
            next.terms.iter_mut().for_each(|t| *t *= T::of((2.0 * l + 1.0) / (l + 1.0)));
            below.add_to(&mut next, T::of(-l / (l + 1.0)));
            (below, current) = (current, next);
        }
        sum
    }
}
