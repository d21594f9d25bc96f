//! Where along a view ray the way to a lamp meets a corner or a flank of a medium's bounds: there the way through the medium,
//! and with it the light, has a kink.
//!
//! All ways from the ray to the lamp lie in one plane; in it bounds are a circle or a convex polygon. A kink belongs to each
//! vertex of the polygon and to both tangents of the circle, projected from the lamp onto the ray.

use glam::{DVec2, DVec3, DVec4};

use crate::medium::mesh::ClosedMesh;
use crate::medium::{Bounds, Density, Medium, Ray};

/// Distances along `ray`, unsorted, at which the way to `lamp` has a kink or the ray crosses a border itself.
pub(super) fn kinks(medium: &Medium, ray: &Ray, lamp: DVec3) -> Vec<f64> {
    let inside = medium.bounds.intervals(ray);
    let mut found: Vec<f64> = inside.into_iter().flat_map(|(enter, leave)| [enter, leave]).collect();
    if let Density::Linear { zero_m, .. } = medium.density {
        found.push((zero_m - ray.origin.y) / ray.dir.y);
    }
    if let Some(section) = Section::new(ray, lamp) {
        let corners = match &medium.bounds {
            Bounds::Unbounded => Vec::new(),
            Bounds::Sphere { centre, radius } => section.tangent_points(*centre, *radius),
            Bounds::Box { min, max } => section.vertices(&with_zero_level(box_planes(*min, *max), &medium.density)),
            Bounds::Hull(planes) => section.vertices(&with_zero_level(planes.to_vec(), &medium.density)),
            Bounds::Mesh(mesh) => section.outline(mesh),
        };
        found.extend(corners.into_iter().filter_map(|corner| section.project(corner)));
    }
    found.retain(|s| *s > 0.0 && *s < ray.length);
    found
}

fn box_planes(min: DVec3, max: DVec3) -> Vec<DVec4> {
    DVec3::AXES.into_iter().flat_map(|axis| [axis.extend(axis.dot(max)), (-axis).extend(-axis.dot(min))]).collect()
}

/// The planes n·x ≤ d of a convex region, and the one below or above which a linear density is zero.
fn with_zero_level(mut planes: Vec<DVec4>, density: &Density) -> Vec<DVec4> {
    if let Density::Linear { zero_m, slope_per_m } = density {
        let sign = -slope_per_m.signum();
        planes.push(DVec4::new(0.0, sign, 0.0, sign * zero_m));
    }
    planes
}

/// The plane of ray and lamp: x along the ray from its origin, y towards the lamp.
struct Section {
    origin: DVec3,
    along: DVec3,
    across: DVec3,
    lamp: DVec2,
}

/// A vertex may lie outside another plane by this share of the plane's offsets: vertices where three planes meet are kept.
const SLACK: f64 = 1e-9;

impl Section {
    /// `None` where the lamp lies on the ray's line: then the way to it is the ray's own.
    fn new(ray: &Ray, lamp: DVec3) -> Option<Self> {
        let to_lamp = lamp - ray.origin;
        let along = to_lamp.dot(ray.dir);
        let across = to_lamp - along * ray.dir;
        let height = across.length();
        (height > 1e-12 * to_lamp.length()).then(|| Self {
            origin: ray.origin,
            along: ray.dir,
            across: across / height,
            lamp: DVec2::new(along, height),
        })
    }

    /// Distance along the ray of the point from which the way to the lamp passes `corner`, if one does.
    fn project(&self, corner: DVec2) -> Option<f64> {
        let share = self.lamp.y / (self.lamp.y - corner.y);
        let between = corner.y >= 0.0 && corner.y < self.lamp.y;
        between.then_some(self.lamp.x + (corner.x - self.lamp.x) * share)
    }

    /// Vertices of the polygon that half spaces n·x ≤ d leave of the plane.
    fn vertices(&self, planes: &[DVec4]) -> Vec<DVec2> {
        let in_section = |plane: &DVec4| {
            let normal = plane.truncate();
            DVec3::new(normal.dot(self.along), normal.dot(self.across), plane.w - normal.dot(self.origin))
        };
        let lines: Vec<DVec3> = planes.iter().map(in_section).collect();
        let mut vertices = Vec::new();
        for (i, a) in lines.iter().enumerate() {
            for b in &lines[i + 1..] {
                let determinant = a.x * b.y - a.y * b.x;
                let vertex = DVec2::new(a.z * b.y - a.y * b.z, a.x * b.z - a.z * b.x) / determinant;
                let inside = |line: &DVec3| {
                    let size = line.z.abs() + (line.x * vertex.x).abs() + (line.y * vertex.y).abs();
                    line.x * vertex.x + line.y * vertex.y <= line.z + SLACK * size
                };
                if vertex.is_finite() && lines.iter().all(inside) {
                    vertices.push(vertex);
                }
            }
        }
        vertices
    }

    /// Where the edges of a mesh pass through the plane.
    fn outline(&self, mesh: &ClosedMesh) -> Vec<DVec2> {
        let normal = self.along.cross(self.across);
        let from_origin: Vec<DVec3> = mesh.positions().iter().map(|corner| *corner - self.origin).collect();
        let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        // Each edge is there both ways.
        let met = edges.filter(|(a, b)| a < b).filter_map(|(a, b)| {
            let (a, b) = (from_origin[a as usize], from_origin[b as usize]);
            let (over_a, over_b) = (normal.dot(a), normal.dot(b));
            let point = a + (b - a) * (over_a / (over_a - over_b));
            ((over_a > 0.0) != (over_b > 0.0)).then(|| DVec2::new(point.dot(self.along), point.dot(self.across)))
        });
        met.collect()
    }

    /// Where lines from the lamp touch the circle that a ball leaves of the plane; none from within.
    fn tangent_points(&self, centre: DVec3, radius: f64) -> Vec<DVec2> {
        let from_origin = centre - self.origin;
        let centre = DVec2::new(from_origin.dot(self.along), from_origin.dot(self.across));
        let off_plane = from_origin.cross(self.along).dot(self.across).abs();
        let squared = (radius - off_plane) * (radius + off_plane);
        let to_centre = centre - self.lamp;
        let distance = to_centre.length();
        let tangent_squared = distance * distance - squared;
        if squared <= 0.0 || off_plane >= radius || tangent_squared <= 0.0 {
            return Vec::new();
        }
        let (forward, side) = (tangent_squared, (tangent_squared * squared).sqrt());
        [side, -side]
            .map(|side| self.lamp + (to_centre * forward + to_centre.perp() * side) / (distance * distance))
            .to_vec()
    }
}
