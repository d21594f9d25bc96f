//! The flattening that always finishes: connected triangles that face the same side of a box are projected along
//! its axis. A triangle that would lie on others of its chart goes to the chart's next layer, a chart of its own.
//! Lengths shrink by up to √3 where a triangle faces between the axes.

use super::super::flatten::FlatMesh;
use glam::{DVec2, Vec2, Vec3};
use std::collections::HashMap;

/// Projects a mesh.
pub(super) fn project(positions: &[Vec3], triangles: &[[u32; 3]]) -> FlatMesh {
    let side: Vec<usize> = triangles.iter().map(|t| facing(t.map(|v| positions[v as usize]))).collect();
    let flat = |t: usize| triangles[t].map(|v| along(positions[v as usize], side[t]));
    let (chart, charts) = layered(&connected(positions, triangles, &side), &flat);
    let mut mesh = FlatMesh { charts, chart, ..FlatMesh::default() };
    let mut vertex = HashMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        let corners = triangle.map(|v| {
            *vertex.entry((mesh.chart[t], v)).or_insert_with(|| {
                mesh.source_vertex.push(v);
                mesh.position.push(along(positions[v as usize], side[t]));
                mesh.position.len() as u32 - 1
            })
        });
        mesh.triangles.push(corners);
    }
    mesh
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

/// An edge by its ends' positions, on one side of the box.
type Edge = ([u32; 3], [u32; 3], usize);

/// Groups of triangles that share an edge and a side, in order of their first triangle.
fn connected(positions: &[Vec3], triangles: &[[u32; 3]], side: &[usize]) -> Vec<Vec<usize>> {
    let bits = |v: u32| positions[v as usize].to_array().map(f32::to_bits);
    let edges = |t: usize| -> [Edge; 3] {
        [0, 1, 2].map(|k| {
            let (p, q) = (bits(triangles[t][k]), bits(triangles[t][(k + 1) % 3]));
            (p.min(q), p.max(q), side[t])
        })
    };
    let mut across: HashMap<Edge, Vec<usize>> = HashMap::new();
    for t in 0..triangles.len() {
        for edge in edges(t) {
            across.entry(edge).or_default().push(t);
        }
    }
    let mut seen = vec![false; triangles.len()];
    let mut groups = Vec::new();
    for start in 0..triangles.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut group = vec![start];
        let mut next = 0;
        while next < group.len() {
            for edge in edges(group[next]) {
                // Taking the list keeps edges shared by very many triangles linear.
                for other in across.remove(&edge).unwrap_or_default() {
                    if !std::mem::replace(&mut seen[other], true) {
                        group.push(other);
                    }
                }
            }
            next += 1;
        }
        groups.push(group);
    }
    groups
}

/// Charts without overlap: per group, every triangle in the first layer where it lies on no other.
fn layered(groups: &[Vec<usize>], flat: &impl Fn(usize) -> [Vec2; 3]) -> (Vec<u32>, u32) {
    let mut chart = vec![0; groups.iter().map(Vec::len).sum()];
    let mut charts = 0;
    for group in groups {
        let cell = group.iter().map(|&t| extent(flat(t)).length()).sum::<f32>() / group.len() as f32;
        let mut layers: Vec<Layer> = Vec::new();
        for &t in group {
            let corners = flat(t);
            let free = layers.iter().position(|layer| !layer.meets(corners)).unwrap_or(layers.len());
            if free == layers.len() {
                layers.push(Layer { cell: cell.max(f32::MIN_POSITIVE), cells: HashMap::new() });
            }
            layers[free].add(corners);
            chart[t] = charts + free as u32;
        }
        charts += layers.len() as u32;
    }
    (chart, charts)
}

/// Triangles in the plane, found again by grid cell.
struct Layer {
    cell: f32,
    cells: HashMap<[i64; 2], Vec<[Vec2; 3]>>,
}

/// Share of the smaller triangle below which an overlap is rounding along a shared edge.
const OVERLAP: f64 = 1e-3;
/// Most cells along an axis that one triangle is entered into; larger ones use the outermost of these.
const MOST_CELLS: i64 = 64;

impl Layer {
    /// The cells that a triangle's bounds touch.
    fn touched(&self, corners: [Vec2; 3]) -> impl Iterator<Item = [i64; 2]> + use<> {
        let low = corners[0].min(corners[1]).min(corners[2]) / self.cell;
        let high = corners[0].max(corners[1]).max(corners[2]) / self.cell;
        // Cells are taken modulo MOST_CELLS: a bounded number of them, each still found by all that touch it.
        let range = |low: f32, high: f32| {
            let first = low.floor() as i64;
            first..=(high.floor() as i64).min(first.saturating_add(MOST_CELLS - 1))
        };
        let (columns, rows) = (range(low.x, high.x), range(low.y, high.y));
        columns.flat_map(move |x| rows.clone().map(move |y| [x.rem_euclid(MOST_CELLS), y.rem_euclid(MOST_CELLS)]))
    }

    fn add(&mut self, corners: [Vec2; 3]) {
        for cell in self.touched(corners) {
            self.cells.entry(cell).or_default().push(corners);
        }
    }

    fn meets(&self, corners: [Vec2; 3]) -> bool {
        let in_cell = |cell| self.cells.get(&cell).into_iter().flatten();
        self.touched(corners).flat_map(in_cell).any(|other| overlap(corners, *other))
    }
}

fn extent(corners: [Vec2; 3]) -> Vec2 {
    corners[0].max(corners[1]).max(corners[2]) - corners[0].min(corners[1]).min(corners[2])
}

fn area(polygon: &[DVec2]) -> f64 {
    polygon.windows(2).skip(1).map(|w| 0.5 * (w[0] - polygon[0]).perp_dot(w[1] - polygon[0])).sum::<f64>().abs()
}

/// Whether two triangles overlap by more than rounding: one clipped by the other's edges (Sutherland and Hodgman 1974).
fn overlap(a: [Vec2; 3], b: [Vec2; 3]) -> bool {
    let apart = |k: usize| {
        let range = |t: [Vec2; 3]| (t[0][k].min(t[1][k]).min(t[2][k]), t[0][k].max(t[1][k]).max(t[2][k]));
        let ((a0, a1), (b0, b1)) = (range(a), range(b));
        a1 <= b0 || b1 <= a0
    };
    if apart(0) || apart(1) {
        return false;
    }
    let (a, b) = (a.map(|p| p.as_dvec2()), b.map(|p| p.as_dvec2()));
    let smaller = area(&a).min(area(&b));
    let turn = (b[1] - b[0]).perp_dot(b[2] - b[0]).signum();
    let mut polygon = a.to_vec();
    for k in 0..3 {
        let (from, along) = (b[k], (b[(k + 1) % 3] - b[k]) * turn);
        let inside = |p: DVec2| along.perp_dot(p - from);
        let mut cut = Vec::with_capacity(polygon.len() + 1);
        for (i, &q) in polygon.iter().enumerate() {
            let p = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (dp, dq) = (inside(p), inside(q));
            if (dp < 0.0) != (dq < 0.0) {
                cut.push(p.lerp(q, dp / (dp - dq)));
            }
            if dq >= 0.0 {
                cut.push(q);
            }
        }
        polygon = cut;
    }
    polygon.len() > 2 && area(&polygon) > OVERLAP * smaller
}
