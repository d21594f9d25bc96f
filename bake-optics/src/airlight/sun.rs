//! The functions of Sun, Ramamoorthi, Narasimhan & Nayar 2005 for uniform air and isotropic lamps, as plain numbers.
//!
//! Arguments are tangents `t` = tan v where the paper has angles: an f32 angle near π/2 has lost its tangent, so the forms
//! that take angles ([`f`], [`f_k`]) exist in f64 only. Differences of F are formed as one integral, never from two values
//! (their difference vanishes in the rounding as the viewing angle nears π). For tables, checks and the curious;
//! [`crate::airlight::Quadrature`] is faster.

use num_complex::Complex;

use crate::Real;
use crate::airlight::{Airlight, ClosedForm, IsotropicLamp, Sight, UniformAir};
use crate::phase::{Deflection, Phase};
use crate::quadrature::GaussLegendre;
use crate::special::scaled_exponential_integral;

/// `F(u, v) = ∫_0^v exp(−u tan ξ) dξ`, u ≥ 0, 0 ≤ v ≤ π/2 in radians. Sun et al. 2005, eq. 10.
///
/// *Accuracy*: 1e-14. In f32 take [`f_difference`] from 0 to tan v.
pub fn f(u: f64, v: f64) -> f64 {
    f_difference(u, 0.0, tangent(v))
}

/// `F(u, atan t2) − F(u, atan t1)`, 0 ≤ t1 ≤ t2 ≤ ∞, as one integral of a positive function.
///
/// *Accuracy* relative to the difference, however small: 1e-14 in f64, 1e-6 in f32 (plus u t1 ulp: that of e^{−u t1}).
pub fn f_difference<T: Real>(u: T, t1: T, t2: T) -> T {
    (-u * t1).exp() * scaled_integral(u, t1, t2, |_| T::one())
}

/// `F_k(u, v) = ∫_0^v cos^k(2ξ) exp(−u tan ξ) dξ`: powers of the cosine of deflection. Sun et al. 2005, eq. 40.
///
/// *Accuracy*: 1e-14 of F_0; odd k cancel near v = π/2, u = 0. In f32 take [`f_k_difference`] from 0 to tan v.
pub fn f_k(k: u32, u: f64, v: f64) -> f64 {
    f_k_difference(k, u, 0.0, tangent(v))
}

/// `F_k(u, atan t2) − F_k(u, atan t1)`, 0 ≤ t1 ≤ t2 ≤ ∞, as one integral.
///
/// *Accuracy*, of F_0's difference: 1e-14 in f64, 1e-6 in f32.
pub fn f_k_difference<T: Real>(k: u32, u: T, t1: T, t2: T) -> T {
    let power = |t: T| Deflection::from_half_tangent(t).cos_theta.powi(k as i32);
    (-u * t1).exp() * scaled_integral(u, t1, t2, power)
}

/// Radiance of isotropic air-light (Sun et al. 2005, eq. 11): lamp of unit intensity at angle `gamma` (radians) and
/// optical distance `t_sv`, ray of optical length `t_vp` (may be infinite), scattering = extinction = `beta` (1/m).
///
/// [`ClosedForm`] with its hand-over to quadrature on short spans.
/// *Accuracy*: 1e-12 in f64, 1e-5 in f32 (plus T ulp).
pub fn airlight<T: Real>(gamma: T, t_sv: T, t_vp: T, beta: T) -> T {
    let sight = Sight::from_angle(gamma, t_sv / beta, t_vp / beta);
    let air = UniformAir { sigma_s: beta, sigma_t: beta, phase: Phase::Isotropic };
    ClosedForm::default().radiance(&sight, &IsotropicLamp, &air)
}

/// `e^{−T} Im S_1(T sin γ (tan(γ/2) − i))`: what an endless ray at angle γ from a lamp at optical distance T gathers, times
/// the 2π T sin γ of air-light; finite everywhere. Sun et al. 2005, eqs. 11, 15 with v = π/2, prefactor folded in.
///
/// *Accuracy*: 1e-13 in f64, 2e-6 in f32 (plus T ulp: that of e^{−T}).
pub fn endless<T: Real>(gamma: T, t: T) -> T {
    let half = T::of(0.5);
    if t == T::zero() {
        return half * (T::PI() - gamma);
    }
    let (sin, cos) = (half * gamma).sin_cos();
    let reach = T::of(2.0) * t * sin;
    (-t).exp() * -scaled_exponential_integral(1, Complex::new(reach * sin, reach * cos)).im
}

/// tan v where the rounding of π/2 itself stands for the right angle.
fn tangent(v: f64) -> f64 {
    v.tan()
}

/// `∫_{va}^{vb} e^{−h (v − va)} f(v) dv/(1 + v²)` for h ≥ 0, 0 ≤ va ≤ vb ≤ ∞, f bounded and smooth in atan v.
///
/// 48 (f32: 24) Gauss–Legendre nodes in v below 1, in ln v in panels of at most 1.5 above.
pub(crate) fn scaled_integral<T: Real>(h: T, va: T, vb: T, f: impl Fn(T) -> T) -> T {
    let (zero, one) = (T::zero(), T::one());
    let (nodes, cut) = T::pick((24, 25.0), (48, 60.0));
    let rule = GaussLegendre::<T>::cached(nodes);
    let end = if h > zero { vb.min(va + T::of(cut) / h) } else { vb };
    let kernel = |offset: T, v: T| (-h * offset).exp() * f(v) / (one + v * v);
    let mut sum = zero;
    if va < one {
        sum += rule.integrate_offset((end - va).min(one - va), |offset| kernel(offset, va + offset));
    }
    let start = va.max(one);
    if end <= start {
        return sum;
    }
    if h == zero {
        // v = 1/p, dv/(1 + v²) = dp/(1 + p²).
        let width = if end.is_finite() { (end - start) / start / end } else { one / start };
        return sum
            + rule.integrate_offset(width, |offset| {
                let p = one / end + offset;
                f(one / p) / (one + p * p)
            });
    }
    let width = ((end - start) / start).ln_1p();
    let panels = (width / T::of(1.5)).ceil().max(one);
    let step = width / panels;
    for i in 0..panels.to_usize().unwrap_or(1) {
        let passed = T::of(i as f64) * step;
        sum += rule.integrate_offset(step, |offset| {
            let grown = start * (passed + offset).exp_m1();
            let v = start + grown;
            v * kernel(start - va + grown, v)
        });
    }
    sum
}
