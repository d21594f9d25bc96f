//! Upright walls with openings, built in their own plane: s to the right, y up, facing +Z.

use super::material::MaterialId;
use super::patch::Patch;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Segments of a half circle.
const ARCH_SEGMENTS: u32 = 16;

/// An opening with a round arch.
#[derive(Debug, Clone, Copy)]
pub struct Opening {
    /// The middle's s, metres.
    pub centre: f64,
    /// Half the clear width, also the arch's radius.
    pub half_width: f64,
    /// Height of the sill.
    pub sill: f64,
    /// Height at which the arch begins.
    pub spring: f64,
}

impl Opening {
    /// Points of the arch from left to right.
    pub fn arch(&self) -> Vec<DVec2> {
        let point = |i: u32| {
            let angle = PI * (1.0 - f64::from(i) / f64::from(ARCH_SEGMENTS));
            DVec2::new(self.centre, self.spring) + DVec2::from_angle(angle) * self.half_width
        };
        (0..=ARCH_SEGMENTS).map(point).collect()
    }

    /// The opening's edge, counter-clockwise from the left end of the sill; without the sill where `open_below`.
    pub fn outline(&self, open_below: bool) -> Vec<DVec2> {
        let left = DVec2::new(self.centre - self.half_width, self.sill);
        let right = DVec2::new(self.centre + self.half_width, self.sill);
        let mut outline = if open_below { vec![right] } else { vec![left, right] };
        outline.extend(self.arch().into_iter().rev());
        outline.push(left);
        outline.dedup_by(|a, b| a.abs_diff_eq(*b, 1e-9));
        outline
    }

    /// The faces around the opening, from the wall's plane back to `depth` behind it.
    pub fn reveal(&self, depth: f64, open_below: bool, material: MaterialId) -> Patch {
        extrude(&self.outline(open_below), depth, material)
    }
}

/// A ribbon from a line in the wall's plane to the same line `depth` behind it, facing to the line's left.
pub fn extrude(line: &[DVec2], depth: f64, material: MaterialId) -> Patch {
    let mut patch = Patch::default();
    let mut along = 0.0;
    for pair in line.windows(2) {
        let (from, to) = (pair[0].extend(0.0), pair[1].extend(0.0));
        patch.add_quad(from, to - from, -DVec3::Z * depth, DVec2::new(along, 0.0), material);
        along += from.distance(to);
    }
    patch
}

/// A wall between s = `sides[0]` and `sides[1]` from `bottom` up to `top`, with openings above one another.
///
/// `top` lists points from left to right, the first and last at the sides; openings are sorted upwards and share one
/// centre. The lowest may reach the bottom.
pub fn wall(sides: [f64; 2], bottom: f64, top: &[DVec2], openings: &[Opening], material: MaterialId) -> Patch {
    let mut patch = Patch::default();
    let mut cuts: Vec<f64> = sides.into_iter().chain(top.iter().map(|point| point.x)).collect();
    for opening in openings {
        cuts.extend(opening.arch().iter().map(|point| point.x));
    }
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    for pair in cuts.windows(2) {
        let (s, t) = (pair[0], pair[1]);
        let mut low = [bottom; 2];
        for opening in openings {
            if (0.5 * (s + t) - opening.centre).abs() < opening.half_width {
                add_trapezoid(&mut patch, [s, t], low, [opening.sill; 2], material);
                let arch = opening.arch();
                low = [height_at(&arch, s), height_at(&arch, t)];
            }
        }
        add_trapezoid(&mut patch, [s, t], low, [height_at(top, s), height_at(top, t)], material);
    }
    patch
}

/// Height of a line of points sorted by s.
fn height_at(line: &[DVec2], s: f64) -> f64 {
    let after = line.partition_point(|point| point.x < s - 1e-9).clamp(1, line.len() - 1);
    let (a, b) = (line[after - 1], line[after]);
    if b.x - a.x < 1e-9 { b.y } else { a.y + (b.y - a.y) * (s - a.x) / (b.x - a.x) }
}

/// The part of the wall between two verticals, from `low` to `high` (at the left and the right one).
fn add_trapezoid(patch: &mut Patch, s: [f64; 2], low: [f64; 2], high: [f64; 2], material: MaterialId) {
    let mut corners = vec![DVec2::new(s[0], low[0]), DVec2::new(s[1], low[1])];
    corners.extend([DVec2::new(s[1], high[1]), DVec2::new(s[0], high[0])]);
    corners.dedup_by(|a, b| a.abs_diff_eq(*b, 1e-6));
    if corners.len() > 1 && corners[0].abs_diff_eq(corners[corners.len() - 1], 1e-6) {
        corners.pop();
    }
    patch.add_polygon(&corners, 0.0, material);
}
