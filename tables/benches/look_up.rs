//! One look-up of an area's irradiance for three colour channels beside one closest-hit query, so that the reader sees the ratio.
//!
//! Places run through a fixed list that no cache holds whole in order. The mesh: a bumpy sphere of 20 000 triangles, rays from inside it.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use tables::{Air, AxialRgb, Geometry, Scatter, TableSet};

const COUNT: usize = 4096;

/// Points of the unit sphere, spread evenly, shuffled by the stride.
fn directions(stride: usize) -> Vec<Vec3> {
    let at = |i: usize| {
        let i = (i * stride) % COUNT;
        let (z, turn) = (1.0 - (2 * i + 1) as f32 / COUNT as f32, 2.399_963_2 * i as f32);
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * turn.cos(), r * turn.sin(), z)
    };
    (0..COUNT).map(at).collect()
}

/// 100 × 100 quads over a sphere whose radius ripples.
fn mesh() -> Vec<Triangle> {
    let point = |i: usize, j: usize| {
        let (theta, phi) = (std::f32::consts::PI * i as f32 / 100.0, std::f32::consts::TAU * j as f32 / 100.0);
        let r = 1.0 + 0.1 * (7.0 * theta).sin() * (9.0 * phi).cos();
        r * Vec3A::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    };
    let quads = (0..100).flat_map(|i| (0..100).map(move |j| (i, j)));
    let split = |(i, j)| {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        [Triangle { v0: a, v1: b, v2: c }, Triangle { v0: a, v1: c, v2: d }]
    };
    quads.flat_map(split).collect()
}

fn look_up(c: &mut Criterion) {
    let set = TableSet::embedded();
    let rgb = AxialRgb([1.0, 0.9, 0.8].map(|albedo| set.area(&Air::isotropic(albedo), Scatter::Single)));
    let single = set.point(&Air::isotropic(1.0), Scatter::Single);
    let (normals, aims, axes) = (directions(1), directions(1789), directions(911));
    let distance = |i: usize| 0.01 * 1000f32.powf((i as f32 * 0.618_034).fract());
    let mut next = 0;
    let mut step = move || {
        next = (next + 1) % COUNT;
        black_box(next)
    };
    let mut group = c.benchmark_group("look-up");
    group.bench_function("area, irradiance, RGB", |b| {
        b.iter(|| {
            let i = step();
            let geometry = Geometry::new(normals[i], aims[i], axes[i]);
            rgb.irradiance([0.5, 1.0, 2.0], distance(i), &geometry)
        });
    });
    group.bench_function("point, irradiance, one channel", |b| {
        b.iter(|| {
            let i = step();
            single.irradiance(1.0, distance(i), normals[i].dot(aims[i]))
        });
    });
    group.bench_function("loop and distance alone", |b| b.iter(|| distance(step())));
    let triangles = mesh();
    let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    group.bench_function("closest hit, 20 000 triangles", |b| {
        b.iter(|| {
            let i = step();
            let ray = Ray::new_inf((0.6 * normals[i]).into(), aims[i].into());
            let mut hit = RayHit::none();
            let at = |ray: &Ray, id: usize| triangles[bvh.primitive_indices[id] as usize].intersect(ray);
            bvh.ray_traverse(ray, &mut hit, at);
            hit.t
        });
    });
    group.finish();
}

criterion_group!(benches, look_up);
criterion_main!(benches);
