//! A deflection angle that keeps its distance from straight on and straight back, where peaked phase functions need digits
//! that the cosine no longer holds.

use crate::real::Real;

/// Cosine μ of a deflection angle θ together with 1 − μ and 1 + μ, each formed without cancellation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deflection<T> {
    /// μ = cos θ.
    pub cos_theta: T,
    /// 1 − μ = 2 sin²(θ/2).
    pub one_minus_cos: T,
    /// 1 + μ = 2 cos²(θ/2).
    pub one_plus_cos: T,
}

impl<T: Real> Deflection<T> {
    /// From the cosine, clamped to [−1, 1]. Exact for the cosine given; but that itself is coarse near ±1 in f32.
    #[inline]
    pub fn from_cos(cos_theta: T) -> Self {
        let cos_theta = cos_theta.min(T::one()).max(-T::one());
        Self { cos_theta, one_minus_cos: T::one() - cos_theta, one_plus_cos: T::one() + cos_theta }
    }

    /// From the tangent v = tan(θ/2), 0 ≤ v ≤ ∞: μ = (1 − v²)/(1 + v²).
    #[inline]
    pub fn from_half_tangent(v: T) -> Self {
        let (one, two) = (T::one(), T::of(2.0));
        if v <= one {
            let share = v * v / (one + v * v);
            Self { cos_theta: one - two * share, one_minus_cos: two * share, one_plus_cos: two - two * share }
        } else {
            let share = one / (one + v * v);
            Self { cos_theta: two * share - one, one_minus_cos: two - two * share, one_plus_cos: two * share }
        }
    }

    /// From the angle θ, 0 ≤ θ ≤ π.
    #[inline]
    pub fn from_angle(theta: T) -> Self {
        let (sin, cos) = (theta * T::of(0.5)).sin_cos();
        let (two, s2, c2) = (T::of(2.0), sin * sin, cos * cos);
        Self { cos_theta: c2 - s2, one_minus_cos: two * s2, one_plus_cos: two * c2 }
    }

    /// The angle θ, radians; accurate at both ends, where acos is not.
    #[inline]
    pub fn angle(&self) -> T {
        T::of(2.0) * self.one_minus_cos.sqrt().atan2(self.one_plus_cos.sqrt())
    }

    /// From two unit directions of propagation: |a − b|²/2 = 1 − μ and |a + b|²/2 = 1 + μ lose nothing near ±1.
    #[inline]
    pub fn between(a: [T; 3], b: [T; 3]) -> Self {
        let half_square = |sign: T| {
            let [x, y, z] = std::array::from_fn(|i| a[i] + sign * b[i]);
            T::of(0.5) * (x * x + y * y + z * z)
        };
        let (one_minus_cos, one_plus_cos) = (half_square(-T::one()), half_square(T::one()));
        Self { cos_theta: T::of(0.5) * (one_plus_cos - one_minus_cos), one_minus_cos, one_plus_cos }
    }
}
