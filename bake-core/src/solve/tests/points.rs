//! Light at free points against closed forms: a uniform sky, a point light, furnaces of air.

use super::fog::uniform;
use super::*;
use crate::scene::Mesh;
use crate::solve::points::LatticeReport;
use bake_optics::medium::Bounds;
use bake_optics::phase::Phase;
use glam::{DVec3, UVec3};

/// √(4π): c0 of radiance 1 from everywhere.
const FULL: f32 = 3.544_907_7;

/// Eight points, 0.4 m apart, about the origin.
fn cube() -> Lattice {
    Lattice::even(Vec3::splat(-0.2), Vec3::splat(0.4), UVec3::splat(2))
}

/// A speck far below: the tracer has something to trace.
fn speck() -> Mesh {
    quad(Vec3::new(0.0, -1e4, 0.0), Vec3::X, Vec3::NEG_Z, 0)
}

fn under_sky(radiance: f32, mesh: Mesh) -> Scene {
    let mut scene = scene(vec![mesh], vec![matte(0.0)]);
    let radiance = vec![Vec3::splat(radiance)];
    scene.environment = Some(Environment { width: 1, height: 1, radiance, rotation: 0.0 });
    scene
}

fn light(scene: &Scene, media: &MediumSet, settings: &LightmapSettings) -> LatticeLight {
    let tracer = Tracer::new(scene);
    Solver::prepare(&tracer, media, settings, &Silent).unwrap().lattice(&cube(), &Silent).unwrap()
}

fn samples(count: u32) -> LightmapSettings {
    LightmapSettings { target_error: 0.0, min_samples: count, max_samples: count, ..Default::default() }
}

/// Largest distance of any coefficient from `truth(point)`, relative to the truth's c0.
fn farthest(name: &str, light: &LatticeLight, allowed: f64, truth: impl Fn(Vec3) -> [f32; 9]) -> Worst {
    let mut worst = Worst::new(name, allowed);
    for (place, found) in light.places.iter().zip(&light.light) {
        let truth = truth(place.expect("free air"));
        for (i, (found, want)) in found.iter().zip(truth).enumerate() {
            worst.record(f64::from((found.x - want) / truth[0]).abs(), || format!("c{i}: {} against {want}", found.x));
        }
    }
    worst
}

#[test]
fn a_uniform_sky_is_a_constant() {
    let constant = |_| std::array::from_fn(|i| if i == 0 { 20.0 * FULL } else { 0.0 });
    let [few, many] =
        [64, 4096].map(|count| light(&under_sky(20.0, speck()), &MediumSet::default(), &samples(count)).report.error);
    let slope = (many / few).log(64.0);
    println!("stated error {few:.2e} with 64 samples, {many:.2e} with 4096: slope {slope:.2}");
    assert!(slope < -0.8, "directions are stratified, plain random ones would give -0.5: {slope}");
    let whole = light(&under_sky(20.0, speck()), &MediumSet::default(), &samples(1024));
    // c0 has no noise; the other coefficients' is that of 1024 stratified directions.
    farthest("uniform sky", &whole, 0.02, constant).check();
    let half = light(&under_sky(20.0, floor(0)), &MediumSet::default(), &samples(1024));
    assert!(!farthest("half a sky", &half, 0.02, constant).holds());
}

#[test]
fn a_point_light_is_its_direction_over_the_square_of_its_distance() {
    let lamp = Vec3::new(0.5, 1.5, -0.7);
    let mut scene = scene(vec![speck()], vec![matte(0.0)]);
    scene.lights = vec![point_light(lamp, 100.0)];
    let found = light(&scene, &MediumSet::default(), &samples(64));
    let exact = |place: Vec3, power: i32| {
        let way = lamp - place;
        sphere::harmonics(way.normalize()).map(|y| 100.0 * y / way.length().powi(power))
    };
    // The ball of 1 mm is a cap of directions: 1e-6 in c0, and 1e-3 of c1 at a metre's distance on a single draw.
    farthest("point light", &found, 1e-3, |place| exact(place, 2)).check();
    assert!(!farthest("1/r", &found, 1e-3, |place| exact(place, 1)).holds());
}

/// Radiance 1 from everywhere stays 1 in air that only scatters.
#[test]
fn furnaces_of_air_stay_full() {
    // Two specks about the air give the scene its size.
    let mut scene = under_sky(1.0, quad(Vec3::splat(-0.6), Vec3::X * 1e-3, Vec3::Z * 1e-3, 0));
    scene.meshes.push(quad(Vec3::splat(0.6), Vec3::X * 1e-3, Vec3::Z * 1e-3, 0));
    scene.instances.push(crate::test_scenes::instance(1, Affine3A::IDENTITY));
    let bounds = || Bounds::Box { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
    let mean = |sigma_t: f64, albedo: f64, mode: Mode| {
        let air = uniform(bounds(), sigma_t, albedo, Phase::HenyeyGreenstein { g: 0.3 });
        // Thick air has so many nodes that a few walks each suffice.
        let grid = GridSettings { cells: 6, samples: if sigma_t > 5.0 { 48 } else { 1024 } };
        let found = light(&scene, &air, &LightmapSettings { mode, grid, ..samples(2048) });
        found.light.iter().map(|sh| f64::from(sh[0].x)).sum::<f64>() / 8.0 / f64::from(FULL)
    };
    let mut worst = Worst::new("furnaces of air, c0", 0.01);
    for mode in [Mode::Walk, Mode::Grid] {
        for size in [0.1, 1.0, 10.0] {
            let share = mean(size, 1.0, mode);
            println!("{} at optical size {size}: {share:.4} of full", mode.name());
            worst.record((share - 1.0).abs(), || format!("{} at {size}: {share}", mode.name()));
        }
        assert!(mean(1.0, 0.9, mode) < 0.98, "air that absorbs a tenth must show");
    }
    worst.check();
}

/// The same light by both modes in a closed room, bands apart: what is looked up is what is walked.
#[test]
fn modes_agree_in_a_room_of_fog() {
    let mut scene = super::fog::room([0.3, 0.7, 0.5, 0.5, 0.4, 0.6]);
    scene.lights = vec![point_light(Vec3::new(0.45, 0.4, 0.7), 1.0)];
    let air = uniform(Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE }, 1.0, 1.0, Phase::Isotropic);
    let tracer = Tracer::new(&scene);
    let lattice = Lattice::filling(Vec3::ZERO, Vec3::ONE, 0.5);
    let of = |mode| {
        let settings = LightmapSettings { mode, grid: GridSettings { cells: 8, samples: 1024 }, ..samples(32768) };
        Solver::prepare(&tracer, &air, &settings, &Silent).unwrap().lattice(&lattice, &Silent).unwrap()
    };
    let (walk, grid) = (of(Mode::Walk), of(Mode::Grid));
    // Root mean square of all coefficients' differences, in shares of c0.
    let rms = |bands: usize| {
        let pairs = walk.light.iter().zip(&grid.light);
        let squares = pairs.flat_map(|(a, b)| {
            (0..9).map(move |i| f64::from((a[i].x - if i < bands { b[i].x } else { 0.0 }) / a[0].x).powi(2))
        });
        (squares.sum::<f64>() / walk.light.len() as f64).sqrt()
    };
    let total = |light: &LatticeLight| light.light.iter().map(|sh| f64::from(sh[0].x)).sum::<f64>();
    let bias = total(&grid) / total(&walk) - 1.0;
    println!("grid against walk: c0 {:+.2} %, all {:.2} % of c0", 100.0 * bias, 100.0 * rms(9));
    assert!(bias.abs() < 0.01 && rms(9) < 0.05, "{bias} {}", rms(9));
    assert!(rms(1) > 0.15, "without directions the room must not pass: {}", rms(1));
}

#[test]
fn same_bits_for_any_number_of_threads_and_rounds_until_the_error_is_small() {
    let scene = under_sky(1.0, floor(0));
    let air = uniform(Bounds::Box { min: DVec3::splat(-1.0), max: DVec3::ONE }, 1.0, 0.9, Phase::Isotropic);
    let settings = LightmapSettings { target_error: 0.05, min_samples: 64, ..Default::default() };
    let of = |threads: usize, settings: &LightmapSettings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| light(&scene, &air, settings));
        (found.light, found.report)
    };
    let (first, report) = of(1, &settings);
    let LatticeReport { samples, error, .. } = report;
    assert!(samples > 64 && samples < 4096 && error <= 0.05, "{report:?}");
    assert_eq!((first.clone(), report), of(7, &settings));
    assert_ne!(first, of(1, &LightmapSettings { seed: 1, ..settings }).0);
}
