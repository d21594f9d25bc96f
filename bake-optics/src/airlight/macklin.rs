//! Integrals of 1/r² along a ray (Macklin 2010) and the first terms of their series in extinction.

use crate::Real;

/// Angle at the lamp between the ends of the ray, radians: atan2(h len, h² + z_a z_b), in [0, π].
///
/// The difference of two arc tangents loses all digits far from the lamp; this form has neither branch nor difference,
/// but for h² + z_a z_b near a right angle, where it does no harm.
pub fn opening_angle<T: Real>(z: T, h: T, length: T) -> T {
    if length == T::infinity() { h.atan2(z) } else { (h * length).atan2(h * h + z * (z + length)) }
}

/// `∫_0^length ds/((s + z)² + h²)`; `length` may be infinite, h = 0 where the ray does not meet the lamp.
///
/// *Equation*: angle/h, for flat angles len/(h² + z_a z_b) (1 − x²/3 + …), which holds at h = 0. *Source*: Macklin 2010,
/// whose sqrt(c − b²) is NaN for rays near the lamp and whose 1/(4π) is folded into σ_s.
/// *Accuracy*: 5e-16 in f64, 3e-7 in f32.
pub fn inverse_square_integral<T: Real>(z: T, h: T, length: T) -> T {
    let one = T::one();
    // len/(h² + z_a z_b), 1/z_a at infinity.
    let flat = if length == T::infinity() { one / z } else { length / (h * h + z * (z + length)) };
    let x = h * flat;
    if flat > T::zero() && x < T::of(1e-3) {
        let x2 = x * x;
        return flat * (one - x2 * (T::of(1.0 / 3.0) - x2 * (T::of(0.2) - x2 * T::of(1.0 / 7.0))));
    }
    if h == T::zero() { T::infinity() } else { opening_angle(z, h, length) / h }
}

/// `M_k = ∫ (s + r)^k/r² ds` for k = 0, 1, 2, where s is the distance from the eye.
///
/// Air-light is σ_s Φ Σ_k (−σ_t)^k/k! M_k while σ_t (len + r) < 0.05: a check of evaluators near vacuum.
/// *Accuracy*: M_1 and M_2 are differences and lose digits for length ≪ |z|.
pub fn extinction_moments(z: f64, h: f64, length: f64) -> [f64; 3] {
    let end = z + length;
    let (ra, rb) = (z.hypot(h), end.hypot(h));
    let m0 = inverse_square_integral(z, h, length);
    let ln_ratio = (length * (z + end) / (ra + rb) / ra).ln_1p();
    let angle = (end / h).asinh() - (z / h).asinh();
    let m1 = ln_ratio + angle - z * m0;
    let m2 = 2.0 * length + (z * z - h * h) * m0 - 2.0 * z * ln_ratio + 2.0 * (rb - ra) - 2.0 * z * angle;
    [m0, m1, m2]
}
