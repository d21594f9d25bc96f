//! Light through air against independent truth: closed rooms, a courtyard, slabs, furnaces and laws.

use super::*;
use crate::scene::{Material, Mesh};
use bake_optics::medium::{Bounds, Medium, Scatter};
use bake_optics::phase::Phase;
use glam::DVec3;
use std::path::Path;
use testkit::reference::{Row, read_csv, shared};

/// Irradiance at points of the world (red channel) with its standard error.
pub fn irradiance<M: Media>(scene: &Scene, media: &M, points: &[(Vec3, Vec3)], samples: u32) -> Vec<(f64, f64)> {
    let tracer = Tracer::new(scene);
    let emitters = Emitters::new(&tracer);
    let paths = Paths { tracer: &tracer, emitters: &emitters, media, bounces: u32::MAX, sh1: false };
    gathered(&paths, points, samples)
}

/// The same by any way to gather light.
pub fn gathered<G: Gather>(paths: &G, points: &[(Vec3, Vec3)], samples: u32) -> Vec<(f64, f64)> {
    replicates(paths, points, samples).iter().map(|means| with_error(means, 0)).collect()
}

/// Mean of one channel and its standard error.
pub(super) fn with_error(replicates: &[Vec3], channel: usize) -> (f64, f64) {
    let values: Vec<f64> = replicates.iter().map(|e| f64::from(e[channel])).collect();
    testkit::statistics::mean_and_error(&values)
}

/// Irradiance at points of the world: 32 independent means of each.
pub(super) fn replicates<G: Gather>(paths: &G, points: &[(Vec3, Vec3)], samples: u32) -> Vec<Vec<Vec3>> {
    let at = |(index, &(point, normal)): (usize, &(Vec3, Vec3))| {
        let start = path::Vertex { origin: point + normal * 1e-4, normal_geom: normal, normal_shading: normal };
        let replicate = |replicate| {
            let seed = hash(index as u32, replicate);
            let one = |i| paths.gather(&start, &mut Sampler::new(i, seed), &Counters::default());
            (0..samples / 32).map(|i| one(i).terms.iter().sum::<Vec3>()).sum::<Vec3>() / (samples / 32) as f32
        };
        (0..32).map(replicate).collect()
    };
    points.par_iter().enumerate().map(at).collect()
}

/// A homogeneous medium.
pub fn uniform(bounds: Bounds, sigma_t: f64, albedo: f64, phase: Phase<f64>) -> MediumSet {
    let scatter = Scatter { sigma_s: [sigma_t * albedo; 3], sigma_a: [sigma_t * (1.0 - albedo); 3] };
    MediumSet { media: vec![Medium { bounds, scatter, phase, ..Medium::default() }] }
}

/// How a bake stands against truth.
#[derive(Debug)]
pub(super) struct Score {
    /// Of the mean.
    pub(super) bias: f64,
    /// Relative RMSE of architecture, with the variances of truth and bake taken off.
    pub(super) rmse: f64,
    /// What was taken off.
    noise: f64,
    points: usize,
}

impl Score {
    /// Of irradiance with its errors against a truth with its own.
    pub(super) fn new(got: &[(f64, f64)], truth: &[(f64, f64)]) -> Self {
        let (points, total) = (truth.len(), |values: &[(f64, f64)]| values.iter().map(|v| v.0).sum::<f64>());
        let floor = 0.01 * total(truth) / points as f64;
        let mean = |f: &dyn Fn((f64, f64), (f64, f64)) -> f64| {
            let relative = |(&g, &t): (&(f64, f64), &(f64, f64))| f(g, t) / t.0.max(floor).powi(2);
            got.iter().zip(truth).map(relative).sum::<f64>() / points as f64
        };
        let variance = mean(&|g, t| g.1 * g.1 + t.1 * t.1);
        let rmse = (mean(&|g, t| (g.0 - t.0).powi(2)) - variance).max(0.0).sqrt();
        Self { bias: total(got) / total(truth) - 1.0, rmse, noise: variance.sqrt(), points }
    }

    /// Whether bias and error lie within limits, given three standard deviations of what chance does to both.
    pub(super) fn holds(&self, bias: f64, rmse: f64) -> bool {
        let n = self.points as f64;
        let chance = 3.0 * (2.0 / n).sqrt() * self.noise.powi(2);
        self.bias.abs() < bias + 3.0 * self.noise / n.sqrt() && self.rmse.powi(2) < rmse.powi(2) + chance
    }
}

impl std::fmt::Display for Score {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [bias, rmse, noise] = [self.bias, self.rmse, self.noise].map(|x| 100.0 * x);
        write!(f, "bias {bias:+.2} %, RMSE {rmse:.2} % beside a noise of {noise:.2} %, {} points", self.points)
    }
}

/// Against the truth of others; points whose truth is uncertain by more than 2 % are left out.
pub(super) fn score(name: &str, got: &[(f64, f64)], truth: &[Row]) -> Score {
    let known = truth.iter().map(|row| (row.number("E"), row.number("se")));
    let (got, truth): (Vec<_>, Vec<_>) = got.iter().zip(known).filter(|(_, t)| t.1 < 0.02 * t.0).unzip();
    let score = Score::new(&got, &truth);
    println!("{name}: {score}");
    score
}

pub(super) fn points(rows: &[Row]) -> Vec<(Vec3, Vec3)> {
    let vector = |row: &Row, names: [&str; 3]| DVec3::from(names.map(|name| row.number(name))).as_vec3();
    rows.iter().map(|row| (vector(row, ["x", "y", "z"]), vector(row, ["nx", "ny", "nz"]))).collect()
}

/// The closed room of the box truths; walls in the order x0, x1, y0, y1, z0, z1.
pub fn room(albedo: [f32; 6]) -> Scene {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let walls = [(Vec3::ZERO, y, z), (x, z, y), (Vec3::ZERO, z, x), (y, x, z), (Vec3::ZERO, x, y), (z, y, x)];
    let meshes: Vec<Mesh> = (0..6).map(|i| quad(walls[i].0, walls[i].1, walls[i].2, i as u32)).collect();
    scene(meshes, albedo.map(matte).to_vec())
}

pub(super) const ROOM: [f32; 6] = [0.3, 0.7, 0.5, 0.5, 0.4, 0.6];

pub(super) fn unit_box() -> Bounds {
    Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE }
}

/// The rooms 1 to 3 of the reference: scene, air, truth.
pub(super) fn truth_room(number: usize, path: &Path) -> (Scene, MediumSet, Vec<Row>) {
    let mut scene = room(ROOM);
    let (sigma_t, albedo) = [(0.2, 1.0), (1.0, 1.0), (3.0, 0.7)][number - 1];
    if number == 3 {
        // Nearer to the ceiling than the points are: those under the lamp belong below it.
        let glow = Material { emission: Vec3::splat(10.0), ..matte(0.6) };
        scene.materials.push(glow);
        scene.meshes.push(quad(Vec3::new(0.35, 0.35, 0.99999), Vec3::Y * 0.3, Vec3::X * 0.3, 6));
        scene.instances.push(crate::test_scenes::instance(6, Affine3A::IDENTITY));
    } else {
        scene.lights = vec![point_light(Vec3::new(0.45, 0.4, 0.7), 1.0)];
    }
    (scene, uniform(unit_box(), sigma_t, albedo, Phase::Isotropic), read_csv(path))
}

#[test]
fn walk_meets_the_closed_rooms() {
    for number in 1..=3 {
        let Some(path) = shared(&format!("reference/box_truth_s{number}.csv")) else { return };
        let (scene, air, truth) = truth_room(number, &path);
        let got = irradiance(&scene, &Fog::new(&air), &points(&truth), 1024);
        let result = score(&format!("walk, room {number}"), &got, &truth);
        if number == 1 {
            let brighter: Vec<_> = got.iter().map(|g| (g.0 * 1.03, g.1)).collect();
            assert!(!score("3 % too bright", &brighter, &truth).holds(0.01, 0.03));
        }
        assert!(result.holds(0.01, 0.03), "{result:?}");
    }
}

/// The courtyard of the open truths: by day under a sun, or at night with a point light.
pub(super) fn courtyard() -> Scene {
    let boxes = [
        ((-10.0, -10.0, -1.0), (10.0, 10.0, 0.0), 0),
        ((-5.0, -5.0, 0.0), (-4.0, 5.0, 4.0), 1),
        ((-4.0, 4.0, 0.0), (5.0, 5.0, 3.0), 1),
        ((1.0, -3.5, 0.0), (3.5, -1.0, 2.5), 1),
    ];
    let meshes = boxes.iter().map(|&(min, max, material)| closed_box(min.into(), max.into(), false, material));
    scene(meshes.collect(), vec![matte(0.4), matte(0.5)])
}

pub(super) fn courtyard_air() -> MediumSet {
    let bounds = Bounds::Box { min: DVec3::new(-10.0, -10.0, 0.0), max: DVec3::new(10.0, 10.0, 8.0) };
    uniform(bounds, 0.125, 1.0, Phase::Isotropic)
}

pub fn sun(irradiance: f32, towards: Vec3) -> Light {
    let kind = LightKind::Directional { direction: -towards.normalize(), angular_radius: 0.0 };
    Light { path: "sun".into(), color: Vec3::splat(irradiance), kind }
}

#[test]
fn walk_meets_the_courtyard() {
    for (number, light, samples) in [
        (1, sun(4.0, Vec3::new(-0.612_372_46, -0.353_553_4, 0.707_106_77)), 2048),
        (2, point_light(Vec3::new(-1.0, 1.0, 2.0), 100.0), 4096),
    ] {
        let Some(path) = shared(&format!("reference/open_truth_o{number}.csv")) else { return };
        let mut scene = courtyard();
        scene.lights = vec![light];
        let truth = read_csv(&path);
        let got = irradiance(&scene, &Fog::new(&courtyard_air()), &points(&truth), samples);
        let score = score(&format!("walk, courtyard {number}"), &got, &truth);
        assert!(score.holds(0.01, 0.03), "{score:?}");
    }
}

/// Irradiance by mode `grid`.
pub fn by_grid(
    scene: &Scene,
    air: &MediumSet,
    points: &[(Vec3, Vec3)],
    settings: GridSettings,
    samples: u32,
) -> Vec<(f64, f64)> {
    let tracer = Tracer::new(scene);
    let (emitters, fog) = (Emitters::new(&tracer), Fog::new(air));
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &fog, bounces: u32::MAX, sh1: false };
    let grid = grid::LightGrid::solve(&paths, settings, 7, &mut [0; 3], &Silent).unwrap();
    println!("grid of {} nodes", grid.size());
    irradiance(scene, &grid::Lit::new(fog.clone(), &grid, &tracer), points, samples)
}

/// Fewer looks at the air are noisier, not darker: lamp and sun, on a path's first leg and on later ones, in air all around and
/// in a cube that stands beside most ways to the lamp.
#[test]
fn looks_at_the_air_are_shared_without_bias() {
    let Some(path) = shared("reference/open_truth_o1.csv") else { return };
    let points: Vec<_> = points(&read_csv(&path)).into_iter().step_by(8).collect();
    let lights = vec![sun(4.0, Vec3::new(-0.612_372_46, -0.353_553_4, 0.707_106_77)), point_light(Vec3::Z * 3.0, 40.0)];
    let scene = Scene { lights, ..courtyard() };
    let cube = Bounds::Box { min: DVec3::new(2.0, 2.0, 0.5), max: DVec3::new(6.0, 6.0, 4.5) };
    let samples = if std::env::var_os("BAKE_LONG").is_some() { 1 << 17 } else { 1 << 12 };
    for air in [courtyard_air(), uniform(cube, 0.5, 1.0, Phase::Isotropic)] {
        let (tracer, fog) = (Tracer::new(&scene), Fog::new(&air));
        let emitters = Emitters::new(&tracer);
        let paths = Paths { tracer: &tracer, emitters: &emitters, media: &fog, bounces: u32::MAX, sh1: false };
        let settings = GridSettings { cells: 6, samples: 32 };
        let grid = grid::LightGrid::solve(&paths, settings, 7, &mut [0; 3], &Silent).unwrap();
        let with = |spread| {
            let lit = grid::Lit::new(fog.clone(), &grid, &tracer).beside(spread);
            let light = irradiance(&scene, &lit, &points, samples);
            let variance: f64 = light.iter().map(|(_, error)| error * error).sum();
            (light.iter().map(|(mean, _)| mean).sum::<f64>(), variance)
        };
        let (often, rarely) = (with(0.1), with(10.0));
        let error = (often.1 + rarely.1).sqrt();
        println!("looks often {:.4}, rarely {:.4}, ± {error:.4}", often.0, rarely.0);
        let agree = |a: f64, b: f64| (a - b).abs() < 4.0 * error;
        assert!(agree(often.0, rarely.0), "biased");
        assert!(!agree(often.0, 0.95 * rarely.0), "5 % must be told");
        assert!(rarely.1 > 1.02 * often.1, "fewer looks leave more noise: {} and {}", often.1, rarely.1);
    }
}

#[test]
fn grid_meets_the_closed_rooms() {
    for number in 1..=3 {
        let Some(path) = shared(&format!("reference/box_truth_s{number}.csv")) else { return };
        let (scene, air, truth) = truth_room(number, &path);
        let got = by_grid(&scene, &air, &points(&truth), GridSettings { cells: 10, samples: 256 }, 512);
        if number == 1 {
            let brighter: Vec<_> = got.iter().map(|g| (g.0 * 1.03, g.1)).collect();
            assert!(!score("3 % too bright", &brighter, &truth).holds(0.01, 0.03));
        }
        let score = score(&format!("grid, room {number}"), &got, &truth);
        assert!(score.holds(0.01, 0.03), "{score:?}");
    }
}

#[test]
fn grid_meets_the_courtyard() {
    // At night light passes walls of 1 m where cells are wider, and dark nodes take many walks.
    for (number, light, cells, is_long) in [
        (1, sun(4.0, Vec3::new(-0.612_372_46, -0.353_553_4, 0.707_106_77)), 10, false),
        (2, point_light(Vec3::new(-1.0, 1.0, 2.0), 100.0), 24, true),
    ] {
        if is_long && std::env::var_os("BAKE_LONG").is_none() {
            continue;
        }
        let samples = if is_long { 1024 } else { 256 };
        let Some(path) = shared(&format!("reference/open_truth_o{number}.csv")) else { return };
        let mut scene = courtyard();
        scene.lights = vec![light];
        let truth = read_csv(&path);
        let got = by_grid(&scene, &courtyard_air(), &points(&truth), GridSettings { cells, samples }, 1024);
        let score = score(&format!("grid, courtyard {number}"), &got, &truth);
        assert!(score.holds(0.01, 0.03), "{score:?}");
    }
}

/// Points of floor, walls and the far end of the corridor of `scenes/fog_corridor.glb`, lit and unlit.
fn corridor_points() -> Vec<(Vec3, Vec3)> {
    let along = (0..8).map(|i| 0.7 + 1.5 * i as f32);
    let walls = along.flat_map(|z| {
        let x = 0.4 + 0.27 * z;
        [
            (Vec3::new(3.0 - 0.7 * (x - 0.3), 0.0, z), Vec3::Y),
            (Vec3::new(0.0, 0.2 + 0.2 * z, z), Vec3::X),
            (Vec3::new(x.min(2.8), 3.0, z), Vec3::NEG_Y),
        ]
    });
    walls.chain([(Vec3::new(1.2, 1.0, 12.0), Vec3::NEG_Z), (Vec3::new(2.0, 1.7, 0.0), Vec3::Z)]).collect()
}

#[test]
fn grid_meets_walk_under_spots_in_haze() {
    let long = std::env::var_os("BAKE_LONG").is_some();
    let path = testkit::reference::workspace().join("scenes/fog_corridor.glb");
    let (scene, _) = crate::scene::load(&path, &crate::scene::LoadOptions::default()).expect("a scene of our own");
    let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::new(3.0, 3.0, 12.0) };
    let air = uniform(bounds, 0.2, 0.9, Phase::HenyeyGreenstein { g: 0.5 });
    let (points, samples) = (corridor_points(), if long { 1 << 18 } else { 1 << 14 });
    let walk = irradiance(&scene, &Fog::new(&air), &points, samples);
    let settings = GridSettings { cells: if long { 24 } else { 12 }, samples: if long { 512 } else { 128 } };
    let grid = by_grid(&scene, &air, &points, settings, samples);
    // All points together, the mean's chance taken as it is; each by itself relative to what both know of it.
    let sum = |light: &[(f64, f64)]| light.iter().map(|l| l.0).sum::<f64>();
    let chance = walk.iter().chain(&grid).map(|l| l.1 * l.1).sum::<f64>().sqrt() / sum(&walk);
    let excess = |grid: &[(f64, f64)]| {
        let square = |(w, g): (&(f64, f64), &(f64, f64))| ((g.0 - w.0).powi(2) - g.1 * g.1 - w.1 * w.1) / w.0.powi(2);
        (walk.iter().zip(grid).map(square).sum::<f64>() / walk.len() as f64).max(0.0).sqrt()
    };
    let (bias, rmse) = (sum(&grid) / sum(&walk) - 1.0, excess(&grid));
    println!("corridor: bias {:+.2} %, chance {:.2} %, RMSE {:.2} %", 100.0 * bias, 100.0 * chance, 100.0 * rmse);
    let allowed = if long { [0.01, 0.04] } else { [0.02, 0.08] };
    assert!(bias.abs() < allowed[0] + 3.0 * chance && rmse < allowed[1]);
    let brighter: Vec<_> = grid.iter().map(|g| (1.15 * g.0, g.1)).collect();
    assert!(excess(&brighter) > allowed[1], "15 % too bright is seen");
}
