//! Where a medium ends: clipping a ray to a convex region.

use glam::{DVec3, DVec4};
use std::sync::Arc;

use crate::medium::Ray;

/// A convex region of space.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Bounds {
    /// All of space.
    #[default]
    Unbounded,
    /// An axis-aligned box, metres; `min` ≤ `max`.
    Box {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner.
        max: DVec3,
    },
    /// A ball.
    Sphere {
        /// Centre, metres.
        centre: DVec3,
        /// Radius, metres, ≥ 0.
        radius: f64,
    },
    /// The points x with n·x ≤ d for each plane (n, d), n a unit vector.
    Hull(Arc<[DVec4]>),
}

impl Bounds {
    /// Distances at which the ray enters and leaves, cut to [0, length]; `None` where it misses or only touches.
    pub fn clip(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (enter, leave) = match self {
            Self::Unbounded => (0.0, ray.length),
            Self::Box { min, max } => clip_box(ray, *min, *max),
            Self::Sphere { centre, radius } => clip_sphere(ray, *centre, *radius),
            Self::Hull(planes) => clip_planes(ray, planes.iter().map(|p| (p.truncate(), p.w))),
        };
        let (enter, leave) = (enter.max(0.0), leave.min(ray.length));
        (enter < leave).then_some((enter, leave))
    }

    /// Whether a point lies inside or on the border.
    pub fn contains(&self, point: DVec3) -> bool {
        match self {
            Self::Unbounded => true,
            Self::Box { min, max } => point.cmpge(*min).all() && point.cmple(*max).all(),
            Self::Sphere { centre, radius } => point.distance_squared(*centre) <= radius * radius,
            Self::Hull(planes) => planes.iter().all(|p| p.truncate().dot(point) <= p.w),
        }
    }
}

fn clip_box(ray: &Ray, min: DVec3, max: DVec3) -> (f64, f64) {
    let faces = DVec3::AXES.into_iter().flat_map(|axis| [(axis, axis.dot(max)), (-axis, -axis.dot(min))]);
    clip_planes(ray, faces)
}

/// Entering and leaving distance against half spaces n·x ≤ d; a ray along a plane is in or out as a whole.
fn clip_planes(ray: &Ray, planes: impl Iterator<Item = (DVec3, f64)>) -> (f64, f64) {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for (normal, offset) in planes {
        let (speed, room) = (normal.dot(ray.dir), offset - normal.dot(ray.origin));
        if speed > 0.0 {
            leave = leave.min(room / speed);
        } else if speed < 0.0 {
            enter = enter.max(room / speed);
        } else if room < 0.0 {
            return (f64::INFINITY, f64::NEG_INFINITY);
        }
    }
    (enter, leave)
}

/// Half chord from the distance centre–line by a cross product: |q|² − b² would cancel far from the ball.
fn clip_sphere(ray: &Ray, centre: DVec3, radius: f64) -> (f64, f64) {
    let from_centre = ray.origin - centre;
    let nearest = -from_centre.dot(ray.dir);
    let h = from_centre.cross(ray.dir).length();
    if h >= radius {
        return (f64::INFINITY, f64::NEG_INFINITY);
    }
    let half_chord = ((radius - h) * (radius + h)).sqrt();
    (nearest - half_chord, nearest + half_chord)
}
