//! Where a medium ends: clipping a ray to a region.

use glam::{DVec3, DVec4};
use std::sync::Arc;

use crate::medium::Ray;
use crate::medium::mesh::{ClosedMesh, Intervals};

/// A region of space, convex but for meshes.
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
    /// The inside of a closed mesh.
    Mesh(Arc<ClosedMesh>),
}

impl Bounds {
    /// Distances at which the ray first enters and last leaves, cut to [0, length]; `None` where it misses or only touches.
    /// Between them a ray may be outside of a mesh: see [`Bounds::intervals`].
    pub fn clip(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (enter, leave) = match self {
            Self::Unbounded => (0.0, ray.length),
            Self::Box { min, max } => clip_box(ray, *min, *max),
            Self::Sphere { centre, radius } => clip_sphere(ray, *centre, *radius),
            Self::Hull(planes) => clip_planes(ray, planes.iter().map(|p| (p.truncate(), p.w))),
            Self::Mesh(mesh) => {
                let intervals = mesh.intervals(ray);
                (intervals.first()?.0, intervals.last()?.1)
            }
        };
        let (enter, leave) = (enter.max(0.0), leave.min(ray.length));
        (enter < leave).then_some((enter, leave))
    }

    /// The parts of the ray inside: ascending, apart, cut to [0, length]; at most one where the region is convex.
    pub fn intervals(&self, ray: &Ray) -> Intervals {
        match self {
            Self::Mesh(mesh) => mesh.intervals(ray),
            _ => self.clip(ray).into_iter().collect(),
        }
    }

    /// Lowest and highest corner of the box around the region, metres; infinite where it has no end.
    pub fn bounding_box(&self) -> [DVec3; 2] {
        match self {
            Self::Unbounded => [DVec3::NEG_INFINITY, DVec3::INFINITY],
            Self::Box { min, max } => [*min, *max],
            Self::Sphere { centre, radius } => [*centre - *radius, *centre + *radius],
            Self::Hull(planes) => hull_box(planes),
            Self::Mesh(mesh) => mesh.bounding_box(),
        }
    }

    /// Whether a point lies inside or on the border (of a mesh: on the border either may come out).
    pub fn contains(&self, point: DVec3) -> bool {
        match self {
            Self::Unbounded => true,
            Self::Box { min, max } => point.cmpge(*min).all() && point.cmple(*max).all(),
            Self::Sphere { centre, radius } => point.distance_squared(*centre) <= radius * radius,
            Self::Hull(planes) => planes.iter().all(|p| p.truncate().dot(point) <= p.w),
            Self::Mesh(mesh) => mesh.contains(point),
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

/// The box around the vertices, which are the points where three planes meet inside all others.
fn hull_box(planes: &[DVec4]) -> [DVec3; 2] {
    let size = planes.iter().map(|p| p.w.abs()).fold(0.0, f64::max);
    let inside = |point: DVec3| planes.iter().all(|p| p.truncate().dot(point) <= p.w + 1e-9 * size);
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            let along = a.truncate().cross(b.truncate());
            for c in &planes[j + 1..] {
                let determinant = along.dot(c.truncate());
                let (bc, ca) = (b.truncate().cross(c.truncate()), c.truncate().cross(a.truncate()));
                let vertex = (bc * a.w + ca * b.w + along * c.w) / determinant;
                if determinant.abs() > 1e-9 && inside(vertex) {
                    bounds = [bounds[0].min(vertex), bounds[1].max(vertex)];
                }
            }
        }
    }
    bounds
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
