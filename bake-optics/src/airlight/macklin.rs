//! Integrals of 1/r² along a ray (Macklin 2010) and the first terms of their series in extinction.

use crate::Real;
use crate::airlight::{Air, Airlight, IsotropicLamp, PathPoint, Quadrature, Sight};
use crate::phase::Deflection;

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

/// `M_k = ∫_0^length (s + r)^k/r² ds` for k = 0 … 4, where s is the distance from the eye and r that from the lamp.
///
/// Air-light is σ_s Φ Σ_k (−σ_t)^k/k! M_k while σ_t (length + r) < 0.05, with an error below the first term left out: a check
/// of evaluators near vacuum. M_k for k > 0 is infinite on endless rays.
/// M_0 in closed form; the others by quadrature of their positive integrand: their closed forms are differences that
/// have no digits left for length ≪ |z|.
/// *Accuracy*: 1e-14 in f64, 1e-6 in f32.
pub fn extinction_moments<T: Real>(z: T, h: T, length: T) -> [T; 5] {
    let sight = Sight { z, h, length, axis_along: T::one(), axis_across: T::zero() };
    std::array::from_fn(|power| match power {
        0 => inverse_square_integral(z, h, length),
        _ if length == T::infinity() => length,
        _ => {
            let air = PathPower { eye_distance: sight.eye_distance(), power: power as i32 };
            Quadrature::new(T::pick(24, 64)).radiance(&sight, &IsotropicLamp, &air)
        }
    })
}

/// Air whose "transmittance" is a power of the path lamp → point → eye, and whose scattering is 1.
struct PathPower<T> {
    eye_distance: T,
    power: i32,
}

impl<T: Real> Air<T> for PathPower<T> {
    fn common_transmittance(&self, _: &Sight<T>) -> T {
        T::one()
    }

    fn transmittance(&self, point: &PathPoint<T>) -> T {
        (self.eye_distance + point.excess).powi(self.power)
    }

    fn scattering(&self, _: T, _: Deflection<T>) -> T {
        T::one()
    }

    fn end(&self, sight: &Sight<T>, _: T, _: T) -> T {
        sight.length
    }
}
