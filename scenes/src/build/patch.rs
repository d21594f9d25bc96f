//! Surfaces under construction: patches, and meshes as lists of patches.
//!
//! A patch is a piece of surface that unrolls onto a plane without overlap: it becomes one lightmap chart. Its chart
//! coordinates are lengths on the surface in metres, so that all charts of a mesh have the same texel density.

use super::material::MaterialId;
use glam::{DAffine3, DVec2, DVec3};

/// A corner shared by triangles of one patch.
#[derive(Debug, Clone, Copy)]
pub struct Vertex {
    /// Metres, object space.
    pub position: DVec3,
    /// Unit shading normal.
    pub normal: DVec3,
    /// Place in the chart, metres along the surface.
    pub chart: DVec2,
}

/// A piece of surface that is one lightmap chart.
#[derive(Debug, Clone, Default)]
pub struct Patch {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Counter-clockwise corners seen from the front, with material.
    pub triangles: Vec<([u32; 3], MaterialId)>,
}

impl Patch {
    /// The parallelogram `corner + s·u + t·v`, s, t in [0, 1], facing u × v; chart axes along u and v (which should be
    /// perpendicular).
    pub fn quad(corner: DVec3, u: DVec3, v: DVec3, material: MaterialId) -> Self {
        let mut patch = Self::default();
        patch.add_quad(corner, u, v, DVec2::ZERO, material);
        patch
    }

    /// A square on the ground about the origin, facing up.
    pub fn floor(width: f64, material: MaterialId) -> Self {
        let corner = DVec3::new(-width / 2.0, 0.0, width / 2.0);
        Self::quad(corner, DVec3::X * width, -DVec3::Z * width, material)
    }

    /// The rectangle `corner + s·u + t·v` without its part s in [a.x, b.x], t in [a.y, b.y], in one chart.
    pub fn quad_with_hole(corner: DVec3, u: DVec3, v: DVec3, hole: [DVec2; 2], material: MaterialId) -> Self {
        let mut patch = Self::default();
        let s = [0.0, hole[0].x, hole[1].x, 1.0];
        let t = [0.0, hole[0].y, hole[1].y, 1.0];
        for j in 0..3 {
            for i in (0..3).filter(|&i| (i, j) != (1, 1)) {
                let chart = DVec2::new(s[i] * u.length(), t[j] * v.length());
                let (du, dv) = (u * (s[i + 1] - s[i]), v * (t[j + 1] - t[j]));
                patch.add_quad(corner + u * s[i] + v * t[j], du, dv, chart, material);
            }
        }
        patch
    }

    /// Adds a parallelogram whose corner has the given chart coordinates.
    pub fn add_quad(&mut self, corner: DVec3, u: DVec3, v: DVec3, chart: DVec2, material: MaterialId) {
        let normal = u.cross(v).normalize();
        let first = self.vertices.len() as u32;
        for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let chart = chart + DVec2::new(s * u.length(), t * v.length());
            self.vertices.push(Vertex { position: corner + u * s + v * t, normal, chart });
        }
        self.triangles.push(([first, first + 1, first + 2], material));
        self.triangles.push(([first, first + 2, first + 3], material));
    }

    /// Adds a convex polygon in the plane at `z`, counter-clockwise and facing +Z, charted by its own coordinates.
    pub fn add_polygon(&mut self, corners: &[DVec2], z: f64, material: MaterialId) {
        let first = self.vertices.len() as u32;
        let vertex = |&chart: &DVec2| Vertex { position: chart.extend(z), normal: DVec3::Z, chart };
        self.vertices.extend(corners.iter().map(vertex));
        self.triangles.extend((2..corners.len() as u32).map(|i| ([first, first + i - 1, first + i], material)));
    }

    /// Turns the front to the other side.
    pub fn flipped(mut self) -> Self {
        for (corners, _) in &mut self.triangles {
            corners.swap(1, 2);
        }
        for vertex in &mut self.vertices {
            vertex.normal = -vertex.normal;
            vertex.chart.x = -vertex.chart.x;
        }
        self
    }

    /// Moved by a rigid transform.
    pub fn moved(mut self, by: DAffine3) -> Self {
        for vertex in &mut self.vertices {
            vertex.position = by.transform_point3(vertex.position);
            vertex.normal = by.transform_vector3(vertex.normal);
        }
        self
    }

    /// Least and greatest chart coordinates.
    pub fn chart_bounds(&self) -> (DVec2, DVec2) {
        let fold = |f: fn(DVec2, DVec2) -> DVec2| self.vertices.iter().map(|v| v.chart).reduce(f);
        (fold(DVec2::min).unwrap_or_default(), fold(DVec2::max).unwrap_or_default())
    }
}

/// The six faces of the box between two corners, facing inward: a room.
pub fn room(min: DVec3, max: DVec3, material: MaterialId) -> [Patch; 6] {
    cuboid(min, max, material).map(Patch::flipped)
}

/// The six faces of the box between two corners, facing outward, in the order −x, +x, −y, +y, −z, +z.
pub fn cuboid(min: DVec3, max: DVec3, material: MaterialId) -> [Patch; 6] {
    let d = max - min;
    let (x, y, z) = (DVec3::X * d.x, DVec3::Y * d.y, DVec3::Z * d.z);
    [
        Patch::quad(min, z, y, material),
        Patch::quad(max, -y, -z, material),
        Patch::quad(min, x, z, material),
        Patch::quad(max, -z, -x, material),
        Patch::quad(min, y, x, material),
        Patch::quad(max, -x, -y, material),
    ]
}
