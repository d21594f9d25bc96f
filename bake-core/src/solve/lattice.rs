//! Boxes of points in space, and where in its cell each point finds free air: probes and the cells of a fog volume.
//!
//! A point inside something, or too near a surface to stand for its cell, moves to the nearest of a fixed set of places
//! in its cell from which nothing is near; a point that has been free moves only to where it sees. A cell without any
//! free place keeps no light.

use super::texels::is_back;
use super::warp;
use crate::trace::{Ray, Tracer};
use glam::{UVec3, Vec3};
use serde::Serialize;

/// Points of one lattice at most.
pub const MOST_POINTS: u64 = 1 << 20;
/// Texels across of the widest image: slices lie side by side.
pub const WIDEST_IMAGE: u64 = 1 << 16;
/// Rays by which a place is judged.
const RAYS: u32 = 48;
/// Share of a cell that points move by, along each axis: two steps each way.
const STEP: f32 = 0.225;
/// Distance of surfaces from which a place is taken at once, as a share of the smallest spacing.
const CLEARANCE: f32 = 0.1;

/// Points at equal distances along each axis, or listed one by one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lattice {
    /// The point with the smallest coordinates, metres.
    pub origin: Vec3,
    /// Distance of neighbours, metres.
    pub spacing: Vec3,
    /// Points along each axis, at least 1.
    pub count: UVec3,
    /// Positions of listed points, which count as points along x; the spacing is the size of their cells then. Empty where points
    /// lie at equal distances.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub listed: Vec<Vec3>,
}

impl Lattice {
    /// Points in the middles of equal cells of at most `spacing` that fill a box.
    pub fn filling(min: Vec3, max: Vec3, spacing: f32) -> Self {
        // A cell is not split because of a rounding error of the box.
        let count = ((max - min) / spacing - 1e-4).ceil().max(Vec3::ONE);
        let size = (max - min) / count;
        let spacing = Vec3::select(size.cmpgt(Vec3::ZERO), size, Vec3::splat(spacing));
        Self::even(min + 0.5 * size, spacing, count.as_uvec3())
    }

    /// Points at equal distances from `origin` on.
    pub fn even(origin: Vec3, spacing: Vec3, count: UVec3) -> Self {
        Self { origin, spacing, count, listed: vec![] }
    }

    /// Points one by one, at least one, each in a cell `spacing` wide.
    pub fn listed(points: Vec<Vec3>, spacing: f32) -> Self {
        let (origin, count) = (points.first().copied().unwrap_or_default(), points.len() as u32);
        Self { origin, spacing: Vec3::splat(spacing), count: UVec3::new(count, 1, 1), listed: points }
    }

    /// Number of points.
    pub fn points(&self) -> u64 {
        self.count.as_u64vec3().to_array().into_iter().fold(1, u64::saturating_mul)
    }

    /// Whether it can be solved, and stored at `tile` texels across a point.
    pub fn fits(&self, tile: u32) -> bool {
        let tile = u64::from(tile);
        self.points() <= MOST_POINTS / tile && u64::from(self.count.x) * u64::from(self.count.z) <= WIDEST_IMAGE / tile
    }

    /// Position of a point. Points are numbered as pixels of their image, row by row: x fastest, then z, then y.
    pub fn position(&self, index: usize) -> Vec3 {
        if let Some(point) = self.listed.get(index) {
            return *point;
        }
        let (index, [nx, _, nz]) = (index as u32, self.count.to_array());
        self.origin + UVec3::new(index % nx, index / (nx * nz), index / nx % nz).as_vec3() * self.spacing
    }

    /// Where in its cell a point finds free air.
    pub(super) fn settle(&self, tracer: &Tracer, index: usize) -> Option<Vec3> {
        let (point, clearance) = (self.position(index), CLEARANCE * self.spacing.min_element());
        let mut best: Option<(f32, Vec3)> = None;
        let mut was_free = false;
        for (number, offset) in offsets().into_iter().enumerate() {
            let place = point + offset * self.spacing;
            let Some(nearest) = nearest_surface(tracer, place) else { continue };
            if number == 0 {
                was_free = true;
            } else if was_free && !sees(tracer, point, place) {
                continue;
            }
            if nearest >= clearance {
                return Some(place);
            }
            if best.is_none_or(|(distance, _)| nearest > distance) {
                best = Some((nearest, place));
            }
        }
        best.map(|(_, place)| place)
    }
}

/// Places in a cell as shares of the spacing, the nearest first.
fn offsets() -> Vec<Vec3> {
    let at = |i: i32| Vec3::new((i % 5 - 2) as f32, (i / 5 % 5 - 2) as f32, (i / 25 - 2) as f32);
    let mut offsets: Vec<Vec3> = (0..125).map(at).collect();
    offsets.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    offsets.into_iter().map(|offset| offset * STEP).collect()
}

/// Distance of the nearest surface that rays from a place meet; `None` where most of them meet the backs of
/// single-sided surfaces, which is inside of something.
fn nearest_surface(tracer: &Tracer, place: Vec3) -> Option<f32> {
    let (mut nearest, mut backs) = (f32::INFINITY, 0);
    for i in 0..RAYS {
        let dir = warp::uniform_sphere((i as f32 + 0.5) / RAYS as f32, (i as f32 * 0.618_034).fract());
        if let Some(hit) = tracer.closest_hit(&Ray { origin: place, dir, t_max: f32::INFINITY }) {
            backs += u32::from(is_back(tracer, &hit));
            nearest = nearest.min(hit.t);
        }
    }
    (2 * backs <= RAYS && nearest > 0.0).then_some(nearest)
}

fn sees(tracer: &Tracer, from: Vec3, to: Vec3) -> bool {
    tracer.transmittance(&Ray { origin: from, dir: to - from, t_max: 1.0 }) != Vec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;
    use crate::test_scenes::{closed_box, matte, quad, scene};

    #[test]
    fn cells_fill_the_box_and_points_lie_in_their_middles() {
        let lattice = Lattice::filling(Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 2.5, 2.0), 1.0);
        assert_eq!(lattice.count, UVec3::new(2, 3, 1));
        let expected = [(-0.5, 0.416_666_66), (0.5, 0.416_666_66), (-0.5, 1.25), (0.5, 1.25)];
        for (index, (x, y)) in expected.into_iter().enumerate() {
            assert!(lattice.position(index).abs_diff_eq(Vec3::new(x, y, 2.0), 1e-6), "{}", lattice.position(index));
        }
        assert_eq!(Lattice::filling(Vec3::ZERO, Vec3::splat(3.000_01), 1.0).count, UVec3::splat(3));
    }

    /// The numbering of pixels: x = ix + nx·iz, y = iy.
    #[test]
    fn points_are_numbered_as_pixels() {
        let lattice = Lattice::even(Vec3::ZERO, Vec3::ONE, UVec3::new(2, 3, 4));
        for (ix, iy, iz) in [(0, 0, 0), (1, 0, 0), (1, 2, 3), (0, 1, 2)] {
            let pixel = (ix + 2 * iz) + iy * (2 * 4);
            assert_eq!(lattice.position(pixel as usize), UVec3::new(ix, iy, iz).as_vec3());
        }
        assert!(lattice.fits(1));
        assert!(!Lattice { count: UVec3::splat(u32::MAX), ..lattice.clone() }.fits(1));
        assert!(!Lattice { count: UVec3::new(1 << 9, 1, 1 << 8), ..lattice }.fits(1), "too wide for an image");
    }

    #[test]
    fn points_leave_solids_and_walls_within_their_cell() {
        let block = closed_box(Vec3::new(-0.3, -0.3, -0.3), Vec3::new(0.3, 0.3, 0.3), false, 0);
        let hall = closed_box(Vec3::splat(5.0), Vec3::splat(8.0), false, 0);
        let wall = quad(Vec3::new(20.0, 0.0, 0.0), Vec3::Y * 4.0, Vec3::Z * 4.0, 1);
        let screen = Material { double_sided: true, ..matte(0.5) };
        let scene = scene(vec![block, hall, wall], vec![matte(0.5), screen]);
        let tracer = Tracer::new(&scene);
        let at = |origin: Vec3| {
            let place = Lattice::listed(vec![Vec3::splat(99.0), origin], 1.0).settle(&tracer, 1);
            assert_eq!(place, Lattice::even(origin, Vec3::ONE, UVec3::ONE).settle(&tracer, 0), "listed or not");
            (place, place.map(|place| (place - origin).abs().max_element()))
        };
        assert_eq!(at(Vec3::splat(2.0)).1, Some(0.0), "free air moves nothing");
        let (place, moved) = at(Vec3::ZERO);
        assert!(moved.is_some_and(|moved| moved <= 0.5), "the block is smaller than the cell");
        assert!(place.is_some_and(|place| place.abs().max_element() > 0.3), "out of the block: {place:?}");
        assert_eq!(at(Vec3::splat(6.5)).0, None, "nothing of the cell is outside the hall");
        let (place, moved) = at(Vec3::new(20.01, 2.0, 2.0));
        assert!(moved > Some(0.0) && place.is_some_and(|place| place.x >= 20.1), "away from the wall: {place:?}");
        let place = at(Vec3::new(19.98, 2.0, 2.0)).0;
        assert!(place.is_some_and(|place| place.x <= 19.9), "not through the wall, where room is as near: {place:?}");
    }
}
