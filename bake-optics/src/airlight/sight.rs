//! The geometry of one view ray and one lamp, reduced to five numbers, and a point on the ray.
//!
//! With w the ray's direction and q = eye − lamp: `z` = w·q is the signed distance past the foot of the perpendicular from
//! the lamp, h = |w × q| the lamp's distance from the line. Two lengths stand for the point at z, r = hypot(z, h):
//!
//! ```text
//! ahead  x = r − z,   behind  y = r + z,   x y = h²,   ds/r² = 2 dy/(h² + y²) = −2 dx/(h² + x²)
//! path lamp → point → eye = r + s = r_a + (y − y_a)
//! ```
//!
//! Each is formed as h²/other on the side where it would cancel. v = y/h is Pegoraro's variable (2010, eq. 6), tan(θ/2)
//! of the deflection θ; but x and y stay finite at h = 0, so a ray straight at (short of) the lamp needs no special case.

use crate::Real;
use crate::phase::Deflection;

/// A view ray relative to a lamp; lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight<T> {
    /// Signed distance of the eye past the lamp's foot on the ray's line; negative: the foot lies ahead.
    pub z: T,
    /// Distance of the lamp from the line, ≥ 0.
    pub h: T,
    /// Length of the ray, > 0, may be infinite.
    pub length: T,
    /// Cosine between the lamp's axis and the ray's direction.
    pub axis_along: T,
    /// Cosine between the lamp's axis and the direction lamp → foot.
    pub axis_across: T,
}

impl<T: Real> Sight<T> {
    /// A ray that leaves the eye at angle `gamma` (radians) from the direction to a lamp `distance` away; axis along the ray.
    pub fn from_angle(gamma: T, distance: T, length: T) -> Self {
        let (sin, cos) = gamma.sin_cos();
        Self { z: -distance * cos, h: distance * sin.abs(), length, axis_along: T::one(), axis_across: T::zero() }
    }

    /// From points: eye, unit direction, length, lamp's position and unit axis.
    pub fn from_points(eye: [T; 3], dir: [T; 3], length: T, lamp: [T; 3], axis: [T; 3]) -> Self {
        let q = std::array::from_fn(|i| eye[i] - lamp[i]);
        // w × q, not sqrt(|q|² − z²), which cancels near the line and may be the root of a negative number.
        let moment = cross(dir, q);
        let h = dot(moment, moment).sqrt();
        let axis_along = dot(dir, axis);
        let limit = ((T::one() - axis_along) * (T::one() + axis_along)).max(T::zero()).sqrt();
        // The foot as seen from the lamp is (w × q) × w = q − z w.
        let across = dot(cross(moment, dir), axis) / h;
        let axis_across = if h > T::zero() { across.max(-limit).min(limit) } else { limit };
        Self { z: dot(dir, q), h, length, axis_along, axis_across }
    }

    /// Distance eye – lamp.
    pub fn eye_distance(&self) -> T {
        distance(self.z, self.h)
    }

    /// x = r − z at the eye.
    pub fn ahead(&self) -> T {
        let r = self.eye_distance();
        if self.z <= T::zero() { r - self.z } else { self.h * (self.h / (r + self.z)) }
    }

    /// y = r + z at the eye.
    pub fn behind(&self) -> T {
        let r = self.eye_distance();
        if self.z >= T::zero() { r + self.z } else { self.h * (self.h / (r - self.z)) }
    }

    /// Distance along the ray after which the path lamp → point → eye is longer than from the eye by `excess`.
    ///
    /// *Equation*: s = (Δ/2)(1 + x_a/(y_a + Δ)).
    pub fn reach(&self, excess: T) -> T {
        if excess == T::infinity() {
            return excess;
        }
        T::of(0.5) * excess * (T::one() + self.ahead() / (self.behind() + excess))
    }

    /// Length of the path lamp → point → eye beyond the direct one at distance `s`: y − y_a, without cancellation.
    pub fn excess(&self, s: T) -> T {
        let (one, z, h) = (T::one(), self.z + s, self.h);
        let (r, ra) = (distance(z, h), self.eye_distance());
        // (r − r_a)/s.
        let slope = (z + self.z) / (r + ra);
        if slope >= T::zero() {
            s * (one + slope)
        } else if z <= T::zero() {
            s * (one - slope) * (h / (r - z)) * (h / (ra - self.z))
        } else {
            r + z - self.behind()
        }
    }

    /// Distance along the ray to the lamp's foot; negative when behind the eye.
    pub fn foot(&self) -> T {
        -self.z
    }

    /// Whether the ray runs into the lamp itself, where air-light is infinite.
    pub fn meets_lamp(&self) -> bool {
        self.h == T::zero() && self.z <= T::zero() && self.length >= -self.z
    }

    /// The point at distance `s` from the eye.
    #[inline]
    pub fn point(&self, s: T) -> PathPoint<T> {
        let z = self.z + s;
        let r = distance(z, self.h);
        // s + r − r_a = s (1 + (z + z_a)/(r + r_a)).
        let excess = s * (T::one() + (z + self.z) / (r + self.eye_distance()));
        PathPoint::new(s, excess, self.h / (r + z.abs()), z > T::zero())
    }

    /// Cosine from the lamp's axis of the direction lamp → point.
    #[inline]
    pub fn cos_axis(&self, point: &PathPoint<T>) -> T {
        self.axis_across * point.sin_theta - self.axis_along * point.deflection.cos_theta
    }

    /// Distances where [`Self::cos_axis`] passes `cosine`: none, one or two.
    ///
    /// *Equation*: (e − c) v² + 2 a v − (e + c) = 0, e = axis_along, a = axis_across, v > 0, z = h (v − 1/v)/2. The roots
    /// −b/(e − c) and (e + c)/b, b = a ± sqrt(a² + e² − c²) with the sign of a, have no cancellation.
    pub fn crossings(&self, cosine: T) -> impl Iterator<Item = T> + use<T> {
        let (e, a, h, z) = (self.axis_along, self.axis_across, self.h, self.z);
        let root = (a * a + (e - cosine) * (e + cosine)).sqrt();
        let b = a + root.copysign(a);
        let positive = [-b / (e - cosine), (e + cosine) / b].into_iter().filter(|v| *v > T::zero() && v.is_finite());
        positive.map(move |v| T::of(0.5) * h * (v - v.recip()) - z)
    }
}

/// A point on a view ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint<T> {
    /// Distance from the eye.
    pub s: T,
    /// Length of the path lamp → point → eye beyond the direct one: s + r − r_a = y − y_a ≥ 0.
    pub excess: T,
    /// Deflection angle of the light there.
    pub deflection: Deflection<T>,
    /// Its sine: h/r.
    pub sin_theta: T,
}

impl<T: Real> PathPoint<T> {
    /// With `near` = h/max(x, y) ≤ 1: tan(θ/2) before the foot, its reciprocal `past` it.
    #[inline(always)]
    pub fn new(s: T, excess: T, near: T, past: bool) -> Self {
        let (one, two) = (T::one(), T::of(2.0));
        let square = near * near;
        let inverse = one / (one + square);
        let (small, large, cos) = (two * square * inverse, two * inverse, (one - square) * inverse);
        let deflection = if past {
            Deflection { cos_theta: -cos, one_minus_cos: large, one_plus_cos: small }
        } else {
            Deflection { cos_theta: cos, one_minus_cos: small, one_plus_cos: large }
        };
        Self { s, excess, deflection, sin_theta: two * near * inverse }
    }
}

/// sqrt(z² + h²). Squares below the smallest number vanish beside the larger leg; ten times faster than `hypot`.
#[inline(always)]
pub(crate) fn distance<T: Real>(z: T, h: T) -> T {
    (z * z + h * h).sqrt().max(z.abs()).max(h)
}

fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
