//! What the nodes hold, together: light in the air of a whole room against integrals over directions.

use super::*;
use crate::progress::Silent;
use crate::scene::{Light, LightKind, Scene};
use crate::solve::emitters::Emitters;
use crate::test_scenes::{closed_box, matte, point_light, scene};
use crate::trace::Tracer;
use bake_optics::medium::{Bounds, Medium, Scatter};
use testkit::compare::Worst;

/// Harmonic of order 0.
const Y0: f64 = 0.282_094_791_773_878_14;
/// So thin that nothing is lost on the way, 1/m.
const SIGMA: f64 = 1e-4;
const SIDE: f32 = 2.0;

fn spot(position: Vec3, intensity: f32) -> Light {
    let kind = LightKind::Spot {
        position,
        direction: Vec3::new(0.3, -0.9, 0.2).normalize(),
        cos_inner: 0.98,
        cos_outer: 0.95,
        radius: 1e-3,
        range: None,
        profile: None,
    };
    Light { kind, ..point_light(position, intensity) }
}

/// A black room of 2 m with one lamp.
fn room(lamp: Light) -> Scene {
    let mut scene = scene(vec![closed_box(Vec3::ZERO, Vec3::splat(SIDE), true, 0)], vec![matte(0.0)]);
    scene.lights = vec![lamp];
    scene
}

/// From a point inside along a unit direction to the wall, m.
fn to_wall(point: DVec3, dir: DVec3) -> f64 {
    let wall = DVec3::select(dir.cmpgt(DVec3::ZERO), DVec3::splat(SIDE.into()), DVec3::ZERO);
    ((wall - point) / dir).min_element()
}

fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    let at =
        move |i: u32| ((f64::from(i) + 0.5) / f64::from(count), ((f64::from(i) + 0.5) * 0.618_033_988_749_895).fract());
    (0..count).map(move |i| crate::solve::warp::uniform_sphere(at(i).0 as f32, at(i).1 as f32).as_dvec3())
}

/// Integrals over the room of a lamp's light straight, ∫∫ I dr dω, and of what the air scatters of it, ∫∫∫ sigma_s I/4π dr dω
/// times the mean way from there to the walls, lm m.
fn exact(lamp: &Light) -> [f64; 2] {
    let origin = punctual_position(lamp).as_dvec3();
    let (mut straight, mut scattered, fine) = (0.0, 0.0, 1 << 16);
    for (index, dir) in directions(fine).enumerate() {
        let flux = f64::from(crate::solve::emitters::punctual::intensity(lamp, dir.as_vec3(), 1.0).x)
            * 4.0
            * std::f64::consts::PI
            / f64::from(fine);
        if flux == 0.0 {
            continue;
        }
        let length = to_wall(origin, dir);
        straight += flux * length;
        let at = origin + dir * (length * (index as f64 * 0.754_877_666_246_693).fract());
        let onward = directions(64).map(|dir| to_wall(at, dir)).sum::<f64>() / 64.0;
        scattered += flux * length * SIGMA * onward;
    }
    [straight, scattered]
}

fn punctual_position(lamp: &Light) -> Vec3 {
    crate::solve::emitters::punctual::ball(lamp).expect("a lamp").0
}

/// The same as the grid has them, and the straight light as the nodes' own places see it.
fn of_the_grid(lamp: &Light) -> ([f64; 2], f64) {
    let scene = room(lamp.clone());
    let (tracer, emitters) = (Tracer::new(&scene), Emitters::new(&Tracer::new(&scene)));
    let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::splat(SIDE.into()) };
    let scatter = Scatter { sigma_s: [SIGMA; 3], sigma_a: [0.0; 3] };
    let set = MediumSet { media: vec![Medium { bounds, scatter, ..Medium::default() }] };
    let fog = Fog::new(&set);
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &fog, bounces: u32::MAX, sh1: false };
    let grid = LightGrid::lay_out(&paths, 8, 0);
    let emitted = grid.emitted(&paths, 64, 1, &mut [0; 3], &Silent).expect("nobody interrupts");
    let (mut sums, mut own) = ([0.0; 2], 0.0);
    for (index, light) in emitted.iter().enumerate() {
        let at = grid.lattice_point(index as u32);
        let volume = f64::from(grid.kernel_volume(at));
        sums[0] += volume * f64::from(light.straight[0].x) / Y0;
        sums[1] += volume * f64::from(light.scattered[0].x) / Y0;
        let away = grid.position(at) - punctual_position(lamp);
        let shone = crate::solve::emitters::punctual::intensity(lamp, away.normalize(), 1.0).x / away.length_squared();
        own += volume * f64::from(shone);
    }
    (sums, own)
}

#[test]
fn the_air_of_a_room_holds_all_light_of_its_lamp() {
    for (name, lamp) in [
        ("a lamp", point_light(Vec3::new(0.9, 1.1, 1.3), 100.0)),
        ("a lamp beside a node", point_light(Vec3::new(1.01, 0.99, 1.02), 100.0)),
        ("a narrow spot", spot(Vec3::new(0.4, 1.9, 0.6), 100.0)),
    ] {
        let (want, (found, own)) = (exact(&lamp), of_the_grid(&lamp));
        // 8192 stratified rays; the integrals' own 65536 directions are finer.
        let mut worst = Worst::new(name, 0.01);
        worst.record((found[0] / want[0] - 1.0).abs(), || format!("straight {} against {}", found[0], want[0]));
        worst.record((found[1] / want[1] - 1.0).abs(), || format!("scattered {} against {}", found[1], want[1]));
        worst.check();
        assert!((own / want[0] - 1.0).abs() > 0.03, "{name}: light at the nodes' places would do: {own}");
    }
}

#[test]
fn isotropic_air_knows_the_mean_of_what_corners_would_tell() {
    let mut scene = room(point_light(Vec3::new(0.9, 1.1, 1.3), 100.0));
    scene.materials = vec![matte(0.5)];
    let (tracer, emitters) = (Tracer::new(&scene), Emitters::new(&Tracer::new(&scene)));
    let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::splat(SIDE.into()) };
    let scatter = Scatter { sigma_s: [0.5, 0.2, 0.1], sigma_a: [0.0; 3] };
    let set = MediumSet { media: vec![Medium { bounds, scatter, ..Medium::default() }] };
    let fog = Fog::new(&set);
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &fog, bounces: u32::MAX, sh1: false };
    let settings = GridSettings { cells: 4, samples: 16 };
    let grid = LightGrid::solve(&paths, settings, 3, &mut [0; 3], &Silent).expect("nobody interrupts");
    let (lit, corners) = (Lit::new(fog.clone(), &grid, &tracer), Lit { even: None, ..Lit::new(fog, &grid, &tracer) });
    assert!(lit.even.is_some());
    // A sum over 4096 corners misses each one's weight by at most 1/4096.
    let (mut worst, mut one) = (Worst::new("blended against drawn corners", 4e-3), 0.0f64);
    for dir in directions(32) {
        let (dir, n) = (dir.as_vec3(), 4096u32);
        let point = Vec3::splat(0.5 * SIDE) + 0.4 * SIDE * dir;
        let u = |i: u32| (i as f32 + 0.5) / n as f32;
        let mean = |of: &dyn Fn(f32) -> Vec3| (0..n).map(|i| of(u(i))).sum::<Vec3>() / n as f32;
        let mut compare = |got: Vec3, want: Vec3| {
            worst.record(f64::from(((got - want) / want).abs().max_element()), || format!("at {point}"));
        };
        let whole = lit.cached_whole(point, dir, 0.0);
        compare(whole, mean(&|u| corners.cached_whole(point, dir, u)));
        let InScattered { reflected, collided, drawn } = lit.cached(point, dir, 0.0);
        compare(reflected, mean(&|u| corners.cached(point, dir, u).reflected));
        compare(collided, mean(&|u| corners.cached(point, dir, u).collided));
        assert_eq!(drawn, 0.0, "lamps are not drawn in the air");
        one = one.max(f64::from((corners.cached_whole(point, dir, 0.5) / whole - 1.0).abs().max_element()));
    }
    worst.check();
    assert!(one > 0.05, "a single corner would do: {one}");
}
