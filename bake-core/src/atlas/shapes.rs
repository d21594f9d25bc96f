//! Shapes and small scenes for the tests of atlas and post.

use crate::scene::{Instance, Mesh, Primitive, Scene};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// Positions and triangles.
pub(crate) type Soup = (Vec<Vec3>, Vec<[u32; 3]>);

/// A grid of (n + 1) × (m + 1) vertices, `place` giving each its position.
pub(crate) fn grid(n: u32, m: u32, place: impl Fn(f32, f32) -> Vec3) -> Soup {
    let at = |i: u32, j: u32| i * (m + 1) + j;
    let positions = (0..=n)
        .flat_map(|i| (0..=m).map(move |j| (i, j)))
        .map(|(i, j)| place(i as f32 / n as f32, j as f32 / m as f32));
    let quads = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let triangles = quads
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]);
    (positions.collect(), triangles.collect())
}

pub(crate) fn sphere(n: u32) -> Soup {
    grid(n, 2 * n, |u, v| {
        let (polar, turn) = (u * TAU / 2.0, (v % 1.0) * TAU);
        Vec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin())
    })
}

pub(crate) fn moebius(n: u32) -> Soup {
    grid(n, 4, |u, v| {
        let (turn, across) = (u * TAU, v - 0.5);
        let (half, r) = (turn / 2.0, 1.0);
        let out = r + across * half.cos();
        Vec3::new(out * turn.cos(), across * half.sin(), out * turn.sin())
    })
}

/// A floor of rounded cobbles.
pub(crate) fn cobbles(n: u32) -> Soup {
    grid(n, n, |u, v| {
        let bump = |t: f32| (1.0 - ((t * 40.0).fract() * 2.0 - 1.0).powi(2)).max(0.0).sqrt();
        Vec3::new(20.0 * u, 0.1 * bump(u) * bump(v), 20.0 * v)
    })
}

pub(crate) fn soup(n: u32) -> Soup {
    let at = |i, k| Vec3::from_array([0u32, 1, 2].map(|d| sobol_burley::sample(i, 3 * k + d, 5)));
    let positions = (0..n).flat_map(|i| [0u32, 1, 2].map(|k| at(i, 0) * 10.0 + at(i, k + 1))).collect();
    (positions, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Noise that turns steeply from triangle to triangle.
pub(crate) fn spiky(n: u32) -> Soup {
    let size = n as f32;
    grid(n, n, |u, v| Vec3::new(u, 0.3 * sobol_burley::sample((u * size * size + v * size) as u32, 0, 3), v))
}

/// Pages that meet in one edge: not a manifold.
pub(crate) fn book(pages: u32) -> Soup {
    let mut positions = vec![Vec3::ZERO, Vec3::Z];
    let mut triangles = Vec::new();
    for i in 0..pages {
        let (sin, cos) = (i as f32 / pages as f32 * TAU).sin_cos();
        positions.extend([Vec3::new(cos, sin, 0.0), Vec3::new(cos, sin, 1.0)]);
        triangles.extend([[0, 2 + 2 * i, 3 + 2 * i], [0, 3 + 2 * i, 1]]);
    }
    (positions, triangles)
}

/// A ramp that winds over itself: faces one way everywhere, so that a projection covers itself.
pub(crate) fn helix(n: u32, turns: f32) -> Soup {
    grid(n, 2, |u, v| {
        let (sin, cos) = (u * turns * TAU).sin_cos();
        Vec3::new((1.0 + v) * cos, u * turns, (1.0 + v) * sin)
    })
}

/// A fan of triangles a hundred thousand times longer than wide.
pub(crate) fn needles(n: u32) -> Soup {
    let positions = (0..=n).flat_map(|i| [Vec3::new(1e-4 * i as f32, 0.0, 0.0), Vec3::new(1e-4 * i as f32, 0.0, 10.0)]);
    let triangles = (0..n).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 2, 2 * i + 1, 2 * i + 3]]);
    (positions.collect(), triangles.collect())
}

/// The mesh of a soup without lightmap coordinates, its normals smoothed over equal positions.
pub(crate) fn smooth(soup: Soup) -> Mesh {
    let bits = |v: u32| soup.0[v as usize].to_array().map(f32::to_bits);
    let mut sums = std::collections::HashMap::new();
    for t in &soup.1 {
        let [a, b, c] = t.map(|v| soup.0[v as usize]);
        for v in t {
            *sums.entry(bits(*v)).or_insert(Vec3::ZERO) += (b - a).cross(c - a);
        }
    }
    let normals = (0..soup.0.len() as u32).map(|v| sums[&bits(v)].normalize_or_zero()).collect();
    Mesh { normals, ..mesh(soup.0, None, soup.1) }
}

pub(crate) fn mesh(positions: Vec<Vec3>, uv: Option<Vec<Vec2>>, triangles: Vec<[u32; 3]>) -> Mesh {
    let n = positions.len();
    let all = Primitive { triangles: 0..triangles.len() as u32, vertices: 0..n as u32, material: 0 };
    Mesh {
        name: "mesh 0".into(),
        normals: vec![Vec3::Y; n],
        has_texcoord_1: uv.is_some(),
        texcoords: [vec![Vec2::ZERO; n], uv.unwrap_or_else(|| vec![Vec2::ZERO; n]), vec![Vec2::ZERO; n]],
        colors: vec![glam::Vec4::ONE; n],
        positions,
        triangles,
        primitives: vec![all],
    }
}

pub(crate) fn scene_of(meshes: Vec<Mesh>, placed: &[(u32, Affine3A)]) -> Scene {
    let instances = placed
        .iter()
        .enumerate()
        .map(|(node, (mesh, world_from_object))| Instance {
            path: format!("node {node}"),
            node: node as u32,
            mesh: *mesh,
            world_from_object: *world_from_object,
            lightmapped: true,
        })
        .collect();
    Scene { meshes, instances, ..Scene::default() }
}

/// The box [0, size], its six faces apart in a 3 × 2 grid of UV cells with a margin.
pub(crate) fn block(size: Vec3, margin: f32) -> Mesh {
    let (mut positions, mut uv, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for face in 0..6u32 {
        let axis = face as usize / 2;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let flip = face % 2 == 0;
        for corner in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            let mut p = Vec3::ZERO;
            p[axis] = if flip { 0.0 } else { 1.0 };
            p[u] = corner[0];
            p[v] = corner[1];
            positions.push(p * size);
            let cell = Vec2::new((face % 3) as f32 / 3.0, (face / 3) as f32 / 2.0);
            let inner = Vec2::splat(margin) + Vec2::from(corner) * (1.0 - 2.0 * margin);
            uv.push(cell + inner * Vec2::new(1.0 / 3.0, 0.5));
        }
        let v = |k: u32| 4 * face + k;
        let quad = [[v(0), v(1), v(2)], [v(0), v(2), v(3)]];
        triangles.extend(quad.map(|t| if flip { [t[0], t[2], t[1]] } else { t }));
    }
    mesh(positions, Some(uv), triangles)
}

pub(crate) fn without_uv(mut mesh: Mesh) -> Mesh {
    mesh.has_texcoord_1 = false;
    mesh.texcoords[1].fill(Vec2::ZERO);
    mesh
}
