//! Meshes cut into charts and laid flat, before any texel is thought of.
//!
//! A mesh is flattened once per *shape* of its instances' transforms: rotation, mirroring, translation and uniform
//! scale leave the shape alone, other scales and shears do not. Lengths are metres of a world where the transform's
//! uniform scale is one.

use super::unwrap::{self, UnwrapReport};
use super::{own, settings::OwnUvProblem};
use crate::scene::{Instance, Mesh, Scene};
use glam::{DMat3, DVec3, Mat3A, Vec2};
use std::time::Instant;

/// A mesh cut into charts, each in the plane.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct FlatMesh {
    /// Per flat vertex, the mesh vertex that it repeats.
    pub source_vertex: Vec<u32>,
    /// Per flat vertex, metres.
    pub position: Vec<Vec2>,
    /// Flat vertices per triangle, in the mesh's order.
    pub triangles: Vec<[u32; 3]>,
    /// Chart of each triangle.
    pub chart: Vec<u32>,
    /// Number of charts.
    pub charts: u32,
    /// Whether the charts keep their places to each other (own TEXCOORD_1); else each is packed by itself.
    pub keeps_arrangement: bool,
}

impl FlatMesh {
    /// How many pieces packing may move.
    pub fn islands(&self) -> u32 {
        if self.keeps_arrangement { 1 } else { self.charts }
    }

    /// The piece that a triangle belongs to.
    pub fn island(&self, triangle: usize) -> usize {
        if self.keeps_arrangement { 0 } else { self.chart[triangle] as usize }
    }
}

/// Shape and size of a transform: `world = rotation · size · shape`, the shape's determinant being ±1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    /// The linear part divided by its size.
    pub matrix: Mat3A,
    /// Metres in the world per metre of the shape: cube root of the volume ratio.
    pub size: f32,
    /// Entries of the shape's metric matrixᵀ·matrix, rounded: equal for equal shapes.
    pub key: [i32; 6],
}

/// Steps of the metric that count as the same shape: 1/1000 of a length, far below a texel of any chart.
const METRIC_STEPS: f64 = 1000.0;

impl Shape {
    /// The shape of an instance's transform.
    pub fn of(instance: &Instance) -> Self {
        let linear = instance.world_from_object.matrix3;
        let wide = DMat3::from_cols(linear.x_axis.as_dvec3(), linear.y_axis.as_dvec3(), linear.z_axis.as_dvec3());
        let size = wide.determinant().abs().cbrt().max(f64::MIN_POSITIVE);
        let shape = wide * (1.0 / size);
        let metric = shape.transpose() * shape;
        let round = |value: f64| (value * METRIC_STEPS).round().clamp(-2e9, 2e9) as i32;
        let (x, y, z) = (metric.x_axis, metric.y_axis, metric.z_axis);
        let key = [x.x, y.y, z.z, x.y, x.z, y.z].map(round);
        let column = |c: DVec3| c.as_vec3();
        let matrix =
            Mat3A::from_cols(column(shape.x_axis).into(), column(shape.y_axis).into(), column(shape.z_axis).into());
        Self { matrix, size: size as f32, key }
    }
}

/// Which coordinates a mesh is to be flattened by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// Its TEXCOORD_1.
    Own,
    /// Unwrapping.
    Unwrap,
}

/// Where a mesh's coordinates can come from, judged without a density.
pub(super) fn source_of(mesh: &Mesh) -> (Source, Option<OwnUvProblem>) {
    if !mesh.has_texcoord_1 {
        return (Source::Unwrap, None);
    }
    match own::check(mesh) {
        Ok(()) => (Source::Own, None),
        Err(problem) => (Source::Unwrap, Some(problem)),
    }
}

/// Flattens a mesh placed with `shape`.
pub(super) fn flatten(
    scene: &Scene,
    mesh: u32,
    shape: &Shape,
    source: Source,
    deadline: Option<Instant>,
) -> (FlatMesh, UnwrapReport) {
    let mesh = &scene.meshes[mesh as usize];
    let positions: Vec<_> = mesh.positions.iter().map(|p| shape.matrix * *p).collect();
    match source {
        Source::Own => (own::flatten(mesh, &positions), UnwrapReport::default()),
        Source::Unwrap => unwrap::unwrap(&positions, &mesh.triangles, deadline),
    }
}
