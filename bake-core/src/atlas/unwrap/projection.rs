//! The flattening that always finishes: connected triangles that face the same side of a box are projected along
//! its axis. Triangles of one chart that would overlap in the projection get charts of their own.

use super::super::flatten::FlatMesh;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Projects a mesh.
pub(super) fn project(positions: &[Vec3], triangles: &[[u32; 3]]) -> FlatMesh {
    let side: Vec<usize> = triangles.iter().map(|t| facing(t.map(|v| positions[v as usize]))).collect();
    let (chart, charts) = connected(positions, triangles, &side);
    let mut flat = FlatMesh { charts, chart, ..FlatMesh::default() };
    let mut vertex = HashMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        let corners = triangle.map(|v| {
            *vertex.entry((flat.chart[t], v)).or_insert_with(|| {
                flat.source_vertex.push(v);
                flat.position.push(along(positions[v as usize], side[t]));
                flat.position.len() as u32 - 1
            })
        });
        flat.triangles.push(corners);
    }
    flat
}

/// The box side, 0 to 5, that a triangle faces.
fn facing([a, b, c]: [Vec3; 3]) -> usize {
    let normal = (b - a).as_dvec3().cross((c - a).as_dvec3());
    let sides = normal.to_array();
    let axis = (0..3).fold(0, |best, k| if sides[k].abs() > sides[best].abs() { k } else { best });
    2 * axis + usize::from(sides[axis] < 0.0)
}

/// The two other coordinates.
fn along(p: Vec3, side: usize) -> Vec2 {
    match side / 2 {
        0 => Vec2::new(p.y, p.z),
        1 => Vec2::new(p.z, p.x),
        _ => Vec2::new(p.x, p.y),
    }
}

/// Charts of triangles that share an edge (by position) and a side, numbered in order of their first triangle.
fn connected(positions: &[Vec3], triangles: &[[u32; 3]], side: &[usize]) -> (Vec<u32>, u32) {
    let mut across: HashMap<_, Vec<u32>> = HashMap::new();
    let edge = |a: u32, b: u32, side: usize| {
        let (p, q) =
            (positions[a as usize].to_array().map(f32::to_bits), positions[b as usize].to_array().map(f32::to_bits));
        (p.min(q), p.max(q), side)
    };
    for (t, triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            across.entry(edge(triangle[k], triangle[(k + 1) % 3], side[t])).or_default().push(t as u32);
        }
    }
    let mut chart = vec![u32::MAX; triangles.len()];
    let mut charts = 0;
    for start in 0..triangles.len() {
        if chart[start] != u32::MAX {
            continue;
        }
        chart[start] = charts;
        let mut open = vec![start];
        while let Some(t) = open.pop() {
            let triangle = triangles[t];
            for k in 0..3 {
                for &other in &across[&edge(triangle[k], triangle[(k + 1) % 3], side[t])] {
                    if chart[other as usize] == u32::MAX {
                        chart[other as usize] = charts;
                        open.push(other as usize);
                    }
                }
            }
        }
        charts += 1;
    }
    (chart, charts)
}
