//! The inside of a closed triangle mesh of any shape: where a ray is inside, in f64.
//!
//! Inside is where the winding number is not zero: overlapping shells unite, a shell turned inwards within another one is a
//! hole. Every ray is projected along itself; there each crossing is decided by the exact sign of a 2 × 2 determinant, ties
//! by moving the ray aside by an infinitesimal (ε, ε²) (Edelsbrunner and Mücke 1990), the same for all triangles. So a ray
//! through an edge or a vertex is counted once, and the crossings of a line always sum to zero.

mod crossing;
mod shells;
mod tree;

pub use shells::MeshError;
pub use tree::MeshBox;

use crossing::Sheared;
use glam::{DVec3, DVec4};
use smallvec::SmallVec;
use tree::Tree;

use crate::medium::Ray;

/// Distances of entry and exit, ascending and apart.
pub type Intervals = SmallVec<[(f64, f64); 2]>;

/// Triangles that enclose a region.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedMesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    tree: Tree,
}

impl ClosedMesh {
    /// From corners (metres) and indices; corners at the same place are one.
    ///
    /// # Errors
    /// The triangles do not close, or look both ways, or enclose nothing.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let (positions, mut triangles) = shells::welded(positions, triangles)?;
        shells::check_closed(&positions, &triangles)?;
        if shells::outward_volume(&positions, &triangles)? < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let tree = Tree::new(&positions, &mut triangles);
        Ok(Self { positions, triangles, tree })
    }

    /// The corners, metres.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Indices into the corners, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Boxes around its triangles, depth first: for walks without a stack.
    pub fn boxes(&self) -> Vec<MeshBox> {
        self.tree.boxes()
    }

    /// Lowest and highest corner of the box around it.
    pub fn bounding_box(&self) -> [DVec3; 2] {
        self.tree.bounds()
    }

    /// The parts of the ray inside, cut to [0, length].
    pub fn intervals(&self, ray: &Ray) -> Intervals {
        let crossings = self.crossings(ray);
        let mut winding: i32 = crossings.iter().map(|crossing| crossing.1).sum();
        let (mut intervals, mut from) = (Intervals::new(), 0.0);
        for (distance, turn) in crossings {
            let before = winding;
            winding -= turn;
            if before == 0 {
                from = distance;
            } else if winding == 0 {
                push(&mut intervals, from, distance.min(ray.length));
            }
        }
        intervals
    }

    /// Whether a point lies inside; on the border either may come out.
    pub fn contains(&self, point: DVec3) -> bool {
        let ray = Ray::new(point, DVec3::new(0.36, 0.48, 0.8), f64::INFINITY);
        self.crossings(&ray).iter().map(|crossing| crossing.1).sum::<i32>() != 0
    }

    /// Crossings ahead of the ray's start, by distance: +1 where it leaves a shell, −1 where it enters one.
    fn crossings(&self, ray: &Ray) -> SmallVec<[(f64, i32); 8]> {
        let sheared = Sheared::new(ray);
        let mut found = SmallVec::<[(f64, i32); 8]>::new();
        self.tree.for_each_met(ray, |index| {
            let corners = self.triangles[index].map(|corner| self.positions[corner as usize]);
            found.extend(sheared.crossing(corners).filter(|crossing| crossing.0 > 0.0));
        });
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }

    /// The planes (n, d) with n·x ≤ d inside, where the mesh is convex and has at most `limit` of them.
    ///
    /// Corners may stand out by 1e-6 of the size: single precision does not hold faces flat.
    pub fn convex_planes(&self, limit: usize) -> Option<Vec<DVec4>> {
        let [min, max] = self.bounding_box();
        let slack = 1e-6 * (max - min).max_element();
        let mut planes: Vec<DVec4> = Vec::new();
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| self.positions[corner as usize]);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let known = |p: &DVec4| p.truncate().distance(normal) < 1e-6 && (p.truncate().dot(a) - p.w).abs() <= slack;
            if planes.iter().any(known) {
                continue;
            }
            let reach = self.positions.iter().map(|p| normal.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
            if reach > normal.dot(a) + slack || planes.len() == limit {
                return None;
            }
            planes.push(normal.extend(reach));
        }
        Some(planes)
    }
}

/// Adds an interval; one that begins where the last ends continues it.
fn push(intervals: &mut Intervals, from: f64, to: f64) {
    match intervals.last_mut() {
        Some(last) if from <= last.1 => last.1 = last.1.max(to),
        _ if from < to => intervals.push((from, to)),
        _ => {}
    }
}
