//! One look-up of irradiance for three colour channels beside one closest-hit query, so that the reader sees the ratio.
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
use tables::{Air, Geometry, Scatter, TableSet, ZonalRgb};

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

/// A receiver, an emitter and the distance between them.
struct Case {
    normal: Vec3,
    aim: Vec3,
    axis: Vec3,
    distance: f32,
}

/// Distances from 0.01 to 10 m, in no order.
fn cases() -> Vec<Case> {
    let (normals, aims, axes) = (directions(1), directions(1789), directions(911));
    let distance = |i: usize| 0.01 * 1000f32.powf((i as f32 * 0.618_034).fract());
    (0..COUNT).map(|i| Case { normal: normals[i], aim: aims[i], axis: axes[i], distance: distance(i) }).collect()
}

const SIGMA: [f32; 3] = [0.5, 1.0, 2.0];

fn look_up(c: &mut Criterion) {
    let set = TableSet::embedded();
    let airs = [1.0, 0.9, 0.8].map(Air::isotropic);
    let area = set.area_rgb(&airs, Scatter::Single);
    let orders = set.area_rgb(&airs, Scatter::Multiple(3));
    let light = ZonalRgb::new(airs.each_ref().map(|air| set.point(air, Scatter::Single)));
    let sun = ZonalRgb::new(airs.each_ref().map(|air| set.directional(air, Scatter::Single)));
    let cases = cases();
    let mut forever = (0..COUNT).cycle().map(|i| &cases[black_box(i)]);
    let mut step = || forever.next().expect("no end");
    let mut group = c.benchmark_group("irradiance");
    for (name, rgb) in [("area, RGB, once scattered", &area), ("area, RGB, orders 2 and 3", &orders)] {
        group.bench_function(name, |b| {
            b.iter(|| {
                let Case { normal, aim, axis, distance } = *step();
                rgb.irradiance(SIGMA, distance, &Geometry::new(normal, aim, axis))
            });
        });
    }
    group.bench_function("area, one channel", |b| {
        b.iter(|| {
            let Case { normal, aim, axis, distance } = *step();
            area.channels()[1].irradiance(1.0, distance, &Geometry::new(normal, aim, axis))
        });
    });
    for (name, rgb) in [("point, RGB", &light), ("directional, RGB", &sun)] {
        group.bench_function(name, |b| {
            b.iter(|| {
                let case = step();
                rgb.irradiance(SIGMA, case.distance, case.normal.dot(case.aim))
            });
        });
    }
    group.bench_function("the loop alone", |b| b.iter(|| step().distance));
    let triangles = mesh();
    let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    group.bench_function("closest hit, 20 000 triangles", |b| {
        b.iter(|| {
            let case = step();
            let ray = Ray::new_inf((0.6 * case.normal).into(), case.aim.into());
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
