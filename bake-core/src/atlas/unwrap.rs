//! Cutting a mesh without lightmap coordinates into charts and flattening them.

mod projection;

use super::flatten::FlatMesh;
use glam::Vec3;
use std::time::Instant;

/// What became of a mesh's triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct UnwrapReport {
    /// Triangles that were projected along axes because the unwrapper gave up.
    pub projected: u32,
    /// Whether the wall-clock limit was the reason for any of them.
    pub timed_out: bool,
}

/// Flattens a mesh of world-shaped positions.
pub(super) fn unwrap(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    _deadline: Option<Instant>,
) -> (FlatMesh, UnwrapReport) {
    (projection::project(positions, triangles), UnwrapReport::default())
}
