//! Surfaces of revolution.

use super::material::MaterialId;
use super::patch::{Patch, Vertex};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Profiles that turn by more than this at a point have an edge there.
const SMOOTH_RAD: f64 = 0.6;

/// Radii below this are on the axis, metres.
const AXIS_M: f64 = 1e-6;

/// Turns a profile of points (radius, height) about the Y axis, in `segments` steps. A profile that rises faces outward.
///
/// Shading normals are smooth around the axis, and along the profile except where it bends sharply. The chart is the
/// profile's length against the turn at the greatest radius.
pub fn lathe(profile: &[DVec2], segments: u32, material: MaterialId) -> Patch {
    let widest = profile.iter().map(|point| point.x).fold(0.0, f64::max);
    let mut patch = Patch::default();
    let mut along = 0.0;
    for i in 0..profile.len() - 1 {
        let (low, high) = (profile[i], profile[i + 1]);
        let length = low.distance(high);
        let normals = [profile_normal(profile, i, i), profile_normal(profile, i, i + 1)];
        for step in 0..segments {
            let first = patch.vertices.len() as u32;
            for (turn, end) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                // At the axis a triangle's tip lies in the middle of its segment.
                let at = [low, high][end];
                let turn = f64::from(step) + if at.x < AXIS_M { 0.5 } else { f64::from(turn) };
                let angle = TAU * turn / f64::from(segments);
                let out = DVec3::new(angle.sin(), 0.0, angle.cos());
                patch.vertices.push(Vertex {
                    position: out * at.x + DVec3::Y * at.y,
                    normal: out * normals[end].x + DVec3::Y * normals[end].y,
                    chart: DVec2::new(angle * widest, along + length * end as f64),
                });
            }
            if low.x >= AXIS_M {
                patch.triangles.push(([first, first + 1, first + 2], material));
            }
            if high.x >= AXIS_M {
                let tip = if low.x >= AXIS_M { first } else { first + 1 };
                patch.triangles.push(([tip, first + 2, first + 3], material));
            }
        }
        along += length;
    }
    patch
}

/// Outward normal of a profile's `segment` at the point `at`, one of its two ends.
fn profile_normal(profile: &[DVec2], segment: usize, at: usize) -> DVec2 {
    let direction = |i: usize| (profile[i + 1] - profile[i]).normalize();
    let own = direction(segment);
    let other = if at == segment { at.checked_sub(1) } else { (at + 1 < profile.len()).then_some(at) }.map(direction);
    let smooth =
        other.filter(|other| own.angle_to(*other).abs() < SMOOTH_RAD).map_or(own, |other| (own + other).normalize());
    DVec2::new(smooth.y, -smooth.x)
}
