//! Cutting a mesh without lightmap coordinates into charts and flattening them.
//!
//! The library's time grows faster than the number of triangles and has no bound of its own, so it is given clusters of
//! bounded size: that bound is what keeps unwrapping from hanging, and it depends on the mesh alone. The wall clock
//! is only a last resort. Whatever the library refuses or has no time for is projected along axes.

mod clusters;
mod projection;

use super::flatten::FlatMesh;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::time::Instant;

/// Most triangles given to the library at once.
const CLUSTER_TRIANGLES: usize = 8192;
/// Largest angle between a triangle and its chart's mean normal, degrees: two faces of a box, 45° from their mean,
/// do not share a chart.
const CHART_ANGLE: f32 = 44.0;
/// Largest ratio of a triangle's relative texel area to its relative surface area, either way.
const AREA_DISTORTION: f32 = 2.0;

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
    deadline: Option<Instant>,
) -> (FlatMesh, UnwrapReport) {
    let clusters = clusters::split(positions, triangles, CLUSTER_TRIANGLES);
    let parts: Vec<_> =
        clusters.into_par_iter().map(|members| Part::new(positions, triangles, members, deadline)).collect();
    let mut report = UnwrapReport::default();
    for part in parts.iter().filter(|part| part.projected) {
        report.projected += part.members.len() as u32;
        report.timed_out |= deadline.is_some_and(|deadline| Instant::now() >= deadline);
    }
    (join(&parts, triangles.len()), report)
}

/// A flattened cluster, its vertices those of the whole mesh.
struct Part {
    /// Triangles of the mesh, in the order of `flat`.
    members: Vec<u32>,
    flat: FlatMesh,
    projected: bool,
}

impl Part {
    fn new(positions: &[Vec3], triangles: &[[u32; 3]], members: Vec<u32>, deadline: Option<Instant>) -> Self {
        let mut source = Vec::new();
        let mut local = HashMap::new();
        let compact: Vec<[u32; 3]> = members
            .iter()
            .map(|&t| {
                triangles[t as usize].map(|v| {
                    *local.entry(v).or_insert_with(|| {
                        source.push(v);
                        source.len() as u32 - 1
                    })
                })
            })
            .collect();
        let positions: Vec<Vec3> = source.iter().map(|&v| positions[v as usize]).collect();
        let unwrapped = library(&positions, &compact, deadline);
        let projected = unwrapped.is_none();
        let mut flat = unwrapped.unwrap_or_else(|| projection::project(&positions, &compact));
        for v in &mut flat.source_vertex {
            *v = source[*v as usize];
        }
        Self { members, flat, projected }
    }
}

/// One flat mesh of all clusters; charts and vertices are numbered cluster by cluster.
fn join(parts: &[Part], triangles: usize) -> FlatMesh {
    let mut whole = FlatMesh { triangles: vec![[0; 3]; triangles], chart: vec![0; triangles], ..FlatMesh::default() };
    for Part { members, flat, .. } in parts {
        let first_vertex = whole.position.len() as u32;
        whole.source_vertex.extend(&flat.source_vertex);
        whole.position.extend(&flat.position);
        for (k, &t) in members.iter().enumerate() {
            whole.triangles[t as usize] = flat.triangles[k].map(|v| v + first_vertex);
            whole.chart[t as usize] = whole.charts + flat.chart[k];
        }
        whole.charts += flat.charts;
    }
    whole
}

/// The library's unwrap, its packing undone to metres; `None` where it refuses or time is over.
fn library(positions: &[Vec3], triangles: &[[u32; 3]], deadline: Option<Instant>) -> Option<FlatMesh> {
    let area: f64 = triangles.iter().map(|t| surface_area(t.map(|v| positions[v as usize]))).sum();
    if !(area > 0.0 && area.is_finite()) {
        return None;
    }
    // Its packing is not used: on a page of about 256² texels it takes little time and costs no precision.
    let texels_per_unit = (256.0 / area.sqrt()) as f32;
    let options = uvunwrap::Options {
        max_chart_angle: CHART_ANGLE,
        max_area_distortion: AREA_DISTORTION,
        density: uvunwrap::Density::Fixed { texels_per_unit, page_size: None },
        padding: 0,
        allow_rotation: false,
        packing: uvunwrap::Packing::Fast,
        ..uvunwrap::Options::default()
    };
    let positions: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
    let mesh = uvunwrap::MeshInput::new(&positions, triangles.as_flattened());
    let in_time = |_| deadline.is_none_or(|deadline| Instant::now() < deadline);
    let atlas = uvunwrap::generate_with_progress(&[mesh], &options, in_time).ok()?;
    let metres = Vec2::new(atlas.width as f32, atlas.height as f32) / texels_per_unit;
    let mesh = atlas.meshes.first()?;
    // Triangles without area get no chart from the library; they share one, collapsed to a point.
    let stray = atlas.chart_count;
    let chart_of = |t: &[u32]| mesh.vertices[t[0] as usize].chart.unwrap_or(stray);
    let chart: Vec<u32> = mesh.indices.chunks_exact(3).map(chart_of).collect();
    let strays = u32::from(chart.contains(&stray));
    let flat = FlatMesh {
        source_vertex: mesh.vertices.iter().map(|v| v.xref).collect(),
        position: mesh.vertices.iter().map(|v| Vec2::from(v.uv) * metres).collect(),
        triangles: mesh.indices.as_chunks().0.to_vec(),
        chart,
        charts: atlas.chart_count + strays,
        keeps_arrangement: false,
    };
    flat.position.iter().all(|p| p.is_finite()).then_some(flat)
}

fn surface_area([a, b, c]: [Vec3; 3]) -> f64 {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests;
