//! The Chapman function: slant over vertical optical depth of an exponential atmosphere around a planet, over its whole range.
//!
//! `C(z, c) = ∫_0^∞ e^{−(|x + s ω| − r)/H} ds/H` with z = r/H (start radius over scale height) and c = cosine between the ray and the
//! vertical; the optical depth of an unbounded ray is `sigma H e^{−alt/H} C(z, c)`. Below the horizon (c < 0) it grows like
//! e^{z(1 − sin θ)}: [`chapman_parts`] keeps that exponent apart.

use crate::quadrature::GaussLegendre;
use crate::real::Real;
use crate::special::erfcx;

/// `C(z, c)`, z ≥ 0, −1 ≤ c ≤ 1; +∞ where it exceeds the type (a ray deep through the planet).
///
/// *Accuracy*: 3e-15 in f64, 5e-7 in f32 (plus (z − z sin θ) ulp below the horizon, which is the function's own sensitivity).
/// *Cost*: 28 pairs of exponentials (f32: 12) per panel of 2; one panel for z > 40.
pub fn chapman<T: Real>(z: T, cos_theta: T) -> T {
    let (exponent, factor) = chapman_parts(z, cos_theta);
    exponent.exp() * factor
}

/// `ln C(z, c)`, finite wherever z is.
pub fn ln_chapman<T: Real>(z: T, cos_theta: T) -> T {
    let (exponent, factor) = chapman_parts(z, cos_theta);
    exponent + factor.ln()
}

/// `C = e^{exponent} factor` with exponent = z − z sin θ ≥ 0 below the horizon and 0 above: fold the exponent into e^{−alt/H} instead of
/// multiplying a huge by a tiny number.
///
/// *Equation*, below the horizon: `C(z, c) = 2 e^{z−z0} C_h(z0) − C(z, −c)`, z0 = z sin θ (Golubev, "Sampling Analytic Participating Media",
/// eq. 48); the first term is at least twice the second, so nothing cancels.
pub fn chapman_parts<T: Real>(z: T, cos_theta: T) -> (T, T) {
    let c = cos_theta.min(T::one()).max(-T::one());
    let above = chapman_above(z, c.abs());
    if c >= T::zero() {
        return (T::zero(), above);
    }
    let sin = ((T::one() - c) * (T::one() + c)).sqrt();
    let depth = z * c * c / (T::one() + sin);
    (depth, T::of(2.0) * chapman_horizontal(z * sin) - (-depth).exp() * above)
}

/// `C_h(z) = C(z, 0) = z e^z K_1(z)`: 1 at z = 0, then about sqrt(π z/2).
///
/// *Accuracy*: 1e-15 in f64 (`spec_math`, Cephes), rounded from it in f32.
pub fn chapman_horizontal<T: Real>(z: T) -> T {
    if z <= T::zero() {
        return T::one();
    }
    T::of(z.as_f64() * spec_math::cephes64::k1e(z.as_f64()))
}

/// Golubev's eq. 46 with the exact erfcx, 0 ≤ c ≤ 1: one erfcx and one root, for shaders and planets.
///
/// *Accuracy*: relative error below 0.34/z² in f64 for z ≥ 30; 3.3e-5 in f32 for z ≥ 100.
pub fn chapman_large_z<T: Real>(z: T, cos_theta: T) -> T {
    let (one, half, c) = (T::one(), T::of(0.5), cos_theta);
    let sin = ((one - c) * (one + c)).max(T::zero()).sqrt();
    let inverse = (one + sin).recip();
    let scaled = (z * inverse).sqrt();
    let flat = c * inverse * (one - half * inverse);
    let curved = sin - half + inverse + (T::of(2.0) - inverse) / (T::of(4.0) * z);
    flat + T::PI().sqrt() * scaled * erfcx(c * scaled) * curved
}

/// `C(z, c)` for 0 ≤ c ≤ 1 as an incomplete Bessel function.
///
/// *Equation*: with r' = radius along the ray, z' = r'/H, and the hyperbolic angle p of the point about the foot of the ray,
/// `C = ∫_0^∞ z (cosh p + c sinh p) e^{−z (2 sinh²(p/2) + c sinh p)} dp` (z' = z(cosh p + c sinh p)): the integrand is entire and positive and no
/// sine of θ appears. It is cut where its exponent reaches `CUT`, and integrated by Gauss–Legendre panels.
fn chapman_above<T: Real>(z: T, c: T) -> T {
    // C lies between 1 and C_h(z) = 1 + z + …
    if z < T::epsilon() * T::of(0.1) || c == T::one() {
        return T::one();
    }
    let (nodes, cut) = T::pick((12, 18.0), (28, 39.0));
    let reach = hyperbolic_reach(z, c, T::of(cut));
    let panels = (reach * T::of(0.5)).ceil().max(T::one());
    let length = reach / panels;
    let rule = GaussLegendre::<T>::cached(nodes);
    let mut sum = T::zero();
    for panel in 0..panels.to_usize().unwrap_or(1) {
        let start = length * T::of(panel as f64);
        sum += rule.integrate_offset(length, |offset| chapman_integrand(z, c, start + offset));
    }
    sum
}

#[inline]
fn chapman_integrand<T: Real>(z: T, c: T, p: T) -> T {
    let two = T::of(2.0);
    let s = (p * T::of(0.5)).sinh();
    let sinh = two * s * (T::one() + s * s).sqrt();
    let gain = two * s * s + c * sinh;
    (z + z * gain) * (-(z * gain)).exp()
}

/// The p at which `z (2 sinh²(p/2) + c sinh p) = cut`, as ln(1 + u) without cancellation for large z or overflow for small z.
fn hyperbolic_reach<T: Real>(z: T, c: T, cut: T) -> T {
    let (k, two) = (cut / z, T::of(2.0));
    let rest = if k > T::one() {
        (two + k) / ((T::one() + two / k + (c / k) * (c / k)).sqrt() + c / k)
    } else {
        let x = k * (two + k);
        x / ((x + c * c).sqrt() + c)
    };
    ((k + rest) / (T::one() + c)).ln_1p()
}
