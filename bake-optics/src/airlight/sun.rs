//! The functions of Sun, Ramamoorthi, Narasimhan & Nayar 2005 for uniform air and isotropic lamps, as plain numbers.
//!
//! Arguments are tangents `t` = tan v where the paper has angles: an f32 angle near π/2 has lost its tangent, and
//! differences of F are formed as one integral, never from two values (their difference vanishes in the rounding as the
//! viewing angle nears π). Here is the f64 form for tables, checks and the curious; [`crate::airlight::Quadrature`] is faster.

use num_complex::Complex;

use crate::airlight::{Airlight, ClosedForm, Sight, UniformAir};
use crate::emitter::Emitter;
use crate::phase::Phase;
use crate::quadrature::GaussLegendre;
use crate::special::scaled_exponential_integral;

/// `F(u, v) = ∫_0^v exp(−u tan ξ) dξ`, u ≥ 0, 0 ≤ v ≤ π/2 in radians. Sun et al. 2005, eq. 10.
///
/// *Accuracy*: 1e-14.
pub fn f(u: f64, v: f64) -> f64 {
    f_difference(u, 0.0, tangent(v))
}

/// `F(u, atan t2) − F(u, atan t1)`, 0 ≤ t1 ≤ t2 ≤ ∞, as one integral.
///
/// *Accuracy*: 1e-14 relative to the difference, however small.
pub fn f_difference(u: f64, t1: f64, t2: f64) -> f64 {
    (-u * t1).exp() * scaled_integral(u, t1, t2, |_| 1.0)
}

/// `F_k(u, v) = ∫_0^v cos^k(2ξ) exp(−u tan ξ) dξ`: powers of the cosine of deflection. Sun et al. 2005, eq. 40.
///
/// *Accuracy*: 1e-14 of F_0; odd k cancel near v = π/2, u = 0.
pub fn f_k(k: u32, u: f64, v: f64) -> f64 {
    scaled_integral(u, 0.0, tangent(v), |t| ((1.0 - t * t) / (1.0 + t * t)).powi(k as i32))
}

/// Radiance of isotropic air-light (Sun et al. 2005, eq. 11): lamp of unit intensity at angle `gamma` (radians) and
/// optical distance `t_sv`, ray of optical length `t_vp` (may be infinite), scattering = extinction = `beta` (1/m).
///
/// *Accuracy*: 1e-12.
pub fn airlight(gamma: f64, t_sv: f64, t_vp: f64, beta: f64) -> f64 {
    let sight = Sight::from_angle(gamma, t_sv / beta, t_vp / beta);
    let air = UniformAir { sigma_s: beta, sigma_t: beta, phase: Phase::Isotropic };
    ClosedForm::default().radiance(&sight, &Emitter::Isotropic, &air)
}

/// `e^{−T} Im S_1(T sin γ (tan(γ/2) − i))`: what an endless ray at angle γ from a lamp at optical distance T gathers, times
/// the 2π T sin γ of air-light; finite everywhere. Sun et al. 2005, eqs. 11, 15 with v = π/2, prefactor folded in.
pub fn endless(gamma: f64, t: f64) -> f64 {
    if t == 0.0 {
        return 0.5 * (std::f64::consts::PI - gamma);
    }
    let (sin, cos) = (0.5 * gamma).sin_cos();
    (-t).exp() * -scaled_exponential_integral(1, Complex::new(2.0 * t * sin * sin, 2.0 * t * sin * cos)).im
}

/// tan v where the rounding of π/2 itself stands for the right angle.
fn tangent(v: f64) -> f64 {
    v.tan()
}

/// `∫_{va}^{vb} e^{−h (v − va)} f(v) dv/(1 + v²)` for h ≥ 0, 0 ≤ va ≤ vb ≤ ∞, f bounded and smooth in atan v.
///
/// 48 Gauss–Legendre nodes in v below 1, in ln v in panels of at most 1.5 above.
pub(crate) fn scaled_integral(h: f64, va: f64, vb: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = GaussLegendre::<f64>::cached(48);
    let end = if h > 0.0 { vb.min(va + 60.0 / h) } else { vb };
    let kernel = |offset: f64, v: f64| (-h * offset).exp() * f(v) / (1.0 + v * v);
    let mut sum = 0.0;
    if va < 1.0 {
        sum += rule.integrate_offset(end.min(1.0) - va, |offset| kernel(offset, va + offset));
    }
    let start = va.max(1.0);
    if end <= start {
        return sum;
    }
    if h == 0.0 {
        // v = 1/p, dv/(1 + v²) = dp/(1 + p²).
        let width = if end.is_finite() { (end - start) / start / end } else { 1.0 / start };
        return sum
            + rule.integrate_offset(width, |offset| {
                let p = 1.0 / end + offset;
                f(1.0 / p) / (1.0 + p * p)
            });
    }
    let width = ((end - start) / start).ln_1p();
    let panels = (width / 1.5).ceil().max(1.0);
    let step = width / panels;
    for i in 0..panels as usize {
        sum += rule.integrate_offset(step, |offset| {
            let grown = start * (i as f64 * step + offset).exp_m1();
            let v = start + grown;
            v * kernel(start - va + grown, v)
        });
    }
    sum
}
