//! A ray through media.

use glam::{DVec3, Vec3};

/// A half line in world space with a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start, metres.
    pub origin: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
    /// Length, metres; may be infinite.
    pub length: f64,
}

impl Ray {
    /// A ray from its parts; `dir` must be a unit vector.
    pub fn new(origin: DVec3, dir: DVec3, length: f64) -> Self {
        Self { origin, dir, length }
    }

    /// The same from single precision; the direction is normalised again.
    pub fn from_single(origin: Vec3, dir: Vec3, length: f32) -> Self {
        Self::new(origin.as_dvec3(), dir.as_dvec3().normalize_or_zero(), f64::from(length))
    }

    /// The segment between two points.
    pub fn between(from: DVec3, to: DVec3) -> Self {
        let offset = to - from;
        let length = offset.length();
        Self::new(from, if length > 0.0 { offset / length } else { DVec3::Y }, length)
    }

    /// The point at distance `s`.
    pub fn at(&self, s: f64) -> DVec3 {
        self.origin + self.dir * s
    }

    /// The part between distances `from` and `to`.
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self::new(self.at(from), self.dir, to - from)
    }
}
