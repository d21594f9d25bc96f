//! A mesh's own TEXCOORD_1: whether it is a lightmap UV set, its charts, and its size on the surface.

use super::flatten::FlatMesh;
use super::settings::OwnUvProblem;
use crate::scene::Mesh;
use glam::{DVec2, Vec2, Vec3};
use std::collections::HashMap;

/// How far outside [0, 1] a coordinate may lie: exporters round, and quantized sets step by 1/65535.
const OUTSIDE_ALLOWED: f32 = 1e-3;
/// Share of the surface that may have no area in UV space: slivers of real exports, not a missing chart.
const DEGENERATE_ALLOWED: f64 = 1e-3;
/// UV area below which a triangle of the unit square counts as having none.
const NO_UV_AREA: f64 = 1e-12;
/// Share of covered texels on which triangles may overlap, at the density chosen.
pub(super) const OVERLAP_ALLOWED: f32 = 0.02;

/// What can be said of TEXCOORD_1 without a density: range, and area everywhere. Overlap is judged on texels.
pub(super) fn check(mesh: &Mesh) -> Result<(), OwnUvProblem> {
    let uv = &mesh.texcoords[1];
    let outside = |c: f32| if c.is_finite() { (c - 1.0).max(-c) } else { f32::INFINITY };
    let used = mesh.triangles.iter().flatten().flat_map(|&v| uv[v as usize].to_array());
    let worst = used.max_by(|a, b| outside(*a).total_cmp(&outside(*b))).unwrap_or(0.0);
    if outside(worst) > OUTSIDE_ALLOWED {
        return Err(OwnUvProblem::Outside { coordinate: worst });
    }
    let (mut total, mut without) = (0.0, 0.0);
    for triangle in &mesh.triangles {
        let area = surface_area(triangle.map(|v| mesh.positions[v as usize]));
        total += area;
        if uv_area(triangle.map(|v| uv[v as usize])) < NO_UV_AREA {
            without += area;
        }
    }
    if total == 0.0 || without > DEGENERATE_ALLOWED * total {
        let share = if total == 0.0 { 1.0 } else { without / total };
        return Err(OwnUvProblem::Degenerate { share: share as f32 });
    }
    Ok(())
}

/// Charts of TEXCOORD_1: triangles connected through corners equal in position and coordinate. Coordinates are
/// scaled to metres, per axis, so that a density means the same as on an unwrapped mesh.
pub(super) fn flatten(mesh: &Mesh, positions: &[Vec3]) -> FlatMesh {
    let uv = &mesh.texcoords[1];
    let metres = metres_per_uv(mesh, positions);
    let (chart, charts) = charts(mesh);
    FlatMesh {
        source_vertex: (0..positions.len() as u32).collect(),
        position: uv.iter().map(|t| t.clamp(Vec2::ZERO, Vec2::ONE) * metres).collect(),
        triangles: mesh.triangles.clone(),
        chart,
        charts,
        keeps_arrangement: true,
    }
}

/// Charts by union of triangles over welded corners, numbered in order of their first triangle.
fn charts(mesh: &Mesh) -> (Vec<u32>, u32) {
    let mut first_with = HashMap::new();
    let mut parent: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &v in triangle {
            let (p, uv) = (mesh.positions[v as usize], mesh.texcoords[1][v as usize]);
            let corner = (p.to_array().map(f32::to_bits), uv.to_array().map(f32::to_bits));
            let other = *first_with.entry(corner).or_insert(t as u32);
            let (a, b) = (root(&mut parent, t as u32), root(&mut parent, other));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut number = HashMap::new();
    let chart: Vec<u32> = (0..parent.len() as u32)
        .map(|t| {
            let next = number.len() as u32;
            *number.entry(root(&mut parent, t)).or_insert(next)
        })
        .collect();
    (chart, number.len() as u32)
}

/// The representative of a union, halving paths on the way.
fn root(parent: &mut [u32], mut at: u32) -> u32 {
    while parent[at as usize] != at {
        parent[at as usize] = parent[parent[at as usize] as usize];
        at = parent[at as usize];
    }
    at
}

/// Metres per unit of u and of v: sqrt(surface area / UV area), shared between the axes as the mean stretch along
/// them asks (weighted by UV area, so that triangles without any count finitely).
fn metres_per_uv(mesh: &Mesh, positions: &[Vec3]) -> Vec2 {
    let (mut surface, mut flat, mut along) = (0.0, 0.0, DVec2::ZERO);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.texcoords[1][v as usize].as_dvec2());
        let [p, q, r] = triangle.map(|v| positions[v as usize].as_dvec3());
        surface += 0.5 * (q - p).cross(r - p).length();
        flat += 0.5 * (b - a).perp_dot(c - a).abs();
        // UV area times |dP/du| and |dP/dv|, from dP = P_u du + P_v dv on two edges.
        let (s, t) = (b - a, c - a);
        along.x += 0.5 * ((q - p) * t.y - (r - p) * s.y).length();
        along.y += 0.5 * ((r - p) * s.x - (q - p) * t.x).length();
    }
    let isotropic = (surface / flat.max(f64::MIN_POSITIVE)).sqrt();
    let stretch = (along.x / along.y.max(f64::MIN_POSITIVE)).sqrt().clamp(0.25, 4.0);
    DVec2::new(isotropic * stretch, isotropic / stretch).as_vec2()
}

fn surface_area([a, b, c]: [Vec3; 3]) -> f64 {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

fn uv_area([a, b, c]: [Vec2; 3]) -> f64 {
    let (a, b, c) = (a.as_dvec2(), b.as_dvec2(), c.as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}
