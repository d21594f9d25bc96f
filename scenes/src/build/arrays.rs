//! Vertex arrays as they are written: single precision, rounded, without repetition.

use super::material::MaterialId;
use super::patch::{Patch, Vertex};
use glam::DVec2;
use std::collections::HashMap;

/// Positions are multiples of this, metres; faces that meet have equal coordinates.
pub const GRID_M: f64 = 1.0 / 65536.0;
/// Texture coordinates are multiples of this.
pub const GRID_UV: f64 = 1.0 / 1048576.0;

/// Vertex arrays of one primitive; equal vertices are stored once.
#[derive(Default)]
pub(super) struct Arrays {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub texcoords: [Vec<[f32; 2]>; 2],
    pub indices: Vec<u16>,
    known: HashMap<[[u32; 3]; 3], u16>,
}

impl Arrays {
    /// Adds a patch's triangles of one material; `chart` is the scale and offset of its lightmap chart.
    pub fn append(&mut self, patch: &Patch, material: MaterialId, chart: Option<(f64, DVec2)>) {
        let of_material = patch.triangles.iter().filter(|(_, m)| *m == material);
        for &corner in of_material.flat_map(|(corners, _)| corners) {
            let index = self.index(&patch.vertices[corner as usize], chart);
            self.indices.push(index);
        }
    }

    fn index(&mut self, vertex: &Vertex, chart: Option<(f64, DVec2)>) -> u16 {
        let position = vertex.position.to_array().map(|x| round(x, GRID_M) as f32);
        let normal = vertex.normal.to_array().map(|x| round(x, GRID_UV) as f32);
        let flat = |uv: DVec2| uv.to_array().map(|x| round(x, GRID_UV) as f32);
        let [u, v] = chart.map_or([0.0; 2], |(scale, offset)| flat(vertex.chart * scale + offset));
        let key = [position, normal, [u, v, 0.0]].map(|row| row.map(f32::to_bits));
        let next = u16::try_from(self.positions.len()).expect("a primitive has at most 65536 vertices");
        let index = *self.known.entry(key).or_insert(next);
        if index == next {
            self.positions.push(position);
            self.normals.push(normal);
            self.texcoords[0].push(flat(vertex.chart));
            self.texcoords[1].push([u, v]);
        }
        index
    }
}

/// The nearest multiple of `grid`; never −0.
pub(super) fn round(x: f64, grid: f64) -> f64 {
    (x / grid).round() * grid + 0.0
}
