//! Edges in the world that two charts' borders share.
//!
//! Found: whole edges with both ends equal, within one instance or between instances. Not found: borders that meet
//! along a part of an edge only (T-junctions).

use crate::atlas::{Atlas, Bilinear, Layout};
use crate::scene::{Mesh, Scene};
use crate::solve::buffers::{PageBuffers, Validity};
use glam::{Mat3A, Vec2, Vec3};
use std::collections::HashMap;

/// One edge of the world, where it lies in the atlas on either side of a cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// The two sides, their ends in the same order.
    pub sides: [SeamSide; 2],
}

/// An edge on a page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeamSide {
    /// Page.
    pub page: u32,
    /// The edge's ends, texels (centres at half-integers).
    pub ends: [Vec2; 2],
}

impl Seam {
    /// Lookups on both sides at places `per_texel` to a texel of the longer side.
    pub(super) fn samples(&self, atlas: &Atlas, per_texel: f32) -> impl Iterator<Item = [(u32, Bilinear); 2]> {
        let longest = self.sides.iter().map(|s| s.ends[0].distance(s.ends[1])).fold(0.0, f32::max);
        let count = (longest * per_texel).ceil().clamp(1.0, 65536.0) as u32;
        let sizes = self.sides.map(|s| (atlas.pages[s.page as usize].width, atlas.pages[s.page as usize].height));
        let sides = self.sides;
        (0..count).map(move |k| {
            let t = (k as f32 + 0.5) / count as f32;
            [0, 1].map(|i| {
                let side = sides[i];
                (side.page, Bilinear::at(side.ends[0].lerp(side.ends[1], t), sizes[i].0, sizes[i].1))
            })
        })
    }
}

/// Whether every texel of a lookup holds a value.
pub(super) fn is_readable(pages: &[PageBuffers], (page, lookup): &(u32, Bilinear)) -> bool {
    let validity = &pages[*page as usize].validity;
    lookup.used().all(|(t, _)| matches!(validity[t], Validity::Good | Validity::Filled))
}

/// Largest angle between the two sides' triangles, degrees: with smooth normals a coarse curve is still one surface.
const FACET_ANGLE: f32 = 60.0;

/// The seams of an atlas: borders that share an edge in the world whose interpolated normals, at both ends, agree
/// within `max_angle` degrees. Sorted by place, so the order depends on scene and atlas only.
pub fn find_seams(scene: &Scene, atlas: &Atlas, max_angle: f32) -> Vec<Seam> {
    let borders: Vec<_> =
        atlas.layouts.iter().map(|layout| borders(&scene.meshes[layout.mesh as usize], layout)).collect();
    let mut edges = Vec::new();
    for (instance, placement) in scene.instances.iter().zip(&atlas.placements) {
        let Some(placement) = placement else { continue };
        let layout = &atlas.layouts[placement.layout as usize];
        let mesh = &scene.meshes[instance.mesh as usize];
        let page = &atlas.pages[placement.page as usize];
        let cofactor = cofactor(instance.world_from_object.matrix3);
        for border in &borders[placement.layout as usize] {
            let end = |v: u32| {
                let own = layout.source_vertex[v as usize] as usize;
                End {
                    position: instance.world_from_object.transform_point3(mesh.positions[own]),
                    normal: (cofactor * mesh.normals[own]).normalize_or_zero(),
                    texel: placement.texel(layout.uv[v as usize], page),
                }
            };
            let facet = (cofactor * border.normal).normalize_or_zero();
            edges.push(WorldEdge { page: placement.page, ends: border.ends.map(end), facet });
        }
    }
    join(edges, max_angle)
}

/// An edge of a layout with a triangle of its chart on one side only.
struct Border {
    /// Layout vertices.
    ends: [u32; 2],
    /// Unit normal of the triangle, object space.
    normal: Vec3,
}

/// The borders of a layout: edges that no second triangle repeats in both space and texture.
fn borders(mesh: &Mesh, layout: &Layout) -> Vec<Border> {
    let corner = |v: u32| {
        let position = mesh.positions[layout.source_vertex[v as usize] as usize];
        (position.to_array().map(f32::to_bits), layout.uv[v as usize].to_array().map(f32::to_bits))
    };
    let key = |[a, b]: [u32; 2]| {
        let (a, b) = (corner(a), corner(b));
        (a.min(b), a.max(b))
    };
    let edges = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let mut count: HashMap<_, u32> = HashMap::new();
    for edge in layout.triangles.iter().flat_map(edges) {
        *count.entry(key(edge)).or_default() += 1;
    }
    let mut borders = Vec::new();
    for (t, triangle) in layout.triangles.iter().enumerate() {
        let [a, b, c] = mesh.triangles[t].map(|v| mesh.positions[v as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        let single = edges(triangle).into_iter().filter(|edge| count[&key(*edge)] == 1);
        borders.extend(single.map(|ends| Border { ends, normal }));
    }
    borders
}

/// Cofactor matrix: turns normals as the transform turns surfaces, mirrored ones included, up to length.
fn cofactor(m: Mat3A) -> Mat3A {
    let sign = m.determinant().signum();
    Mat3A::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)) * sign
}

struct WorldEdge {
    page: u32,
    ends: [End; 2],
    facet: Vec3,
}

struct End {
    position: Vec3,
    normal: Vec3,
    texel: Vec2,
}

/// Pairs edges whose ends lie in the same cells of a grid of about 1e-5 of the largest coordinate (a power of two, so
/// that round numbers lie amid a cell): transforms of two instances round differently by a hundredth of that.
fn join(mut edges: Vec<WorldEdge>, max_angle: f32) -> Vec<Seam> {
    let reach = edges.iter().flat_map(|e| &e.ends).map(|e| e.position.abs().max_element()).fold(0.0, f32::max);
    let cell = (1e-5 * f64::from(reach)).max(f64::MIN_POSITIVE).log2().round().exp2();
    let round = |p: Vec3| (p.as_dvec3() / cell).round().to_array().map(|c| c as i64);
    let mut keyed = Vec::with_capacity(edges.len());
    for (i, edge) in edges.iter_mut().enumerate() {
        let mut key = [round(edge.ends[0].position), round(edge.ends[1].position)];
        if key[0] > key[1] {
            key.swap(0, 1);
            edge.ends.swap(0, 1);
        }
        if key[0] != key[1] {
            keyed.push((key, i));
        }
    }
    keyed.sort_unstable();
    let mut seams = Vec::new();
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        for (k, (_, i)) in group.iter().enumerate() {
            // Each edge with the next that agrees: a chain through all of an agreeing set.
            let next = group[k + 1..].iter().find(|(_, j)| agree(&edges[*i], &edges[*j], max_angle));
            seams.extend(next.map(|(_, j)| Seam { sides: [side(&edges[*i]), side(&edges[*j])] }));
        }
    }
    seams
}

fn agree(a: &WorldEdge, b: &WorldEdge, max_angle: f32) -> bool {
    let within = |m: Vec3, n: Vec3, degrees: f32| m.dot(n) >= degrees.to_radians().cos();
    within(a.facet, b.facet, FACET_ANGLE) && (0..2).all(|k| within(a.ends[k].normal, b.ends[k].normal, max_angle))
}

fn side(edge: &WorldEdge) -> SeamSide {
    SeamSide { page: edge.page, ends: [edge.ends[0].texel, edge.ends[1].texel] }
}
