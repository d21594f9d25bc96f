//! Laws and published values of light in air: slabs, furnaces, balances, limits, and cases that break careless code.

use super::fog::{by_grid, courtyard, courtyard_air, gathered, irradiance, room, sun, uniform};
use super::*;
use crate::solve::grid::GridSettings;
use crate::solve::tables::TablePaths;
use crate::solve::tables::medium::{Tabled, reduce};
use bake_optics::medium::Bounds;
use bake_optics::phase::Phase;
use glam::{DVec3, Vec3};

/// Black ground under a fog layer 1 m high that reaches 40 free paths to each side.
fn layer(tau: f64, albedo: f64, phase: Phase<f64>) -> (Scene, MediumSet) {
    layer_of(40.0 / tau.min(1.0), tau, albedo, phase)
}

/// The same that reaches so many metres to each side.
fn layer_of(reach: f64, tau: f64, albedo: f64, phase: Phase<f64>) -> (Scene, MediumSet) {
    let (near, far) = (DVec3::new(-reach, 0.0, -reach), DVec3::new(reach, 1.0, reach));
    let corner = Vec3::new(-reach as f32, 0.0, reach as f32);
    let ground = quad(corner, Vec3::X * 2.0 * reach as f32, Vec3::NEG_Z * 2.0 * reach as f32, 0);
    (scene(vec![ground], vec![matte(0.0)]), uniform(Bounds::Box { min: near, max: far }, tau, albedo, phase))
}

const MIDDLE: [(Vec3, Vec3); 1] = [(Vec3::ZERO, Vec3::Y)];

/// Transmitted share: `published_benchmarks.md` sections 1 to 3 (Peierls' equation, adding–doubling).
#[test]
fn walk_meets_published_slabs() {
    let hg = |g: f64| Phase::HenyeyGreenstein { g };
    let mut worst = Worst::new("slab, beyond three standard errors", 0.005);
    let mut twin = Worst::new("the same, 5 % too bright", 0.005);
    let mut record = |what: String, (got, error): (f64, f64), want: f64| {
        twin.record((1.05 * got - want - 3.0 * error).max(0.0) / want, || what.clone());
        println!("{what}: {got:.4} ± {error:.4}, published {want:.4}");
        worst.record(((got - want).abs() - 3.0 * error).max(0.0) / want, || what);
    };
    for (phase, albedo, tau, want) in [
        (Phase::Isotropic, 0.5, 0.5, 0.53499),
        (Phase::Isotropic, 0.9, 1.0, 0.47475),
        (Phase::Isotropic, 1.0, 4.0, 0.24597),
        (hg(0.5), 0.9, 1.0, 0.598548),
        (hg(-0.3), 1.0, 2.0, 0.331654),
        (hg(0.75), 1.0, 2.0, 0.695960),
    ] {
        let what = format!("sky, {phase:?}, albedo {albedo}, depth {tau}");
        let (mut scene, air) = layer(tau, albedo, phase);
        scene.environment = Some(sky(1.0));
        let (got, error) = irradiance(&scene, &Fog::new(&air), &MIDDLE, 8192)[0];
        record(what, (got / std::f64::consts::PI, error / std::f64::consts::PI), want);
    }
    for (phase, albedo, tau, cos, want) in [
        (Phase::Isotropic, 0.9, 1.0, 0.5, 0.41484),
        (Phase::Isotropic, 1.0, 2.0, 1.0, 0.48249),
        (hg(0.75), 0.9, 2.0, 1.0, 0.66096),
    ] {
        let what = format!("sun, {phase:?}, albedo {albedo}, depth {tau}, cosine {cos}");
        let (mut scene, air) = layer(tau, albedo, phase);
        scene.lights = vec![sun(1.0, Vec3::new((1.0f32 - cos * cos).sqrt(), cos, 0.0))];
        let (got, error) = irradiance(&scene, &Fog::new(&air), &MIDDLE, 8192)[0];
        record(what, (got / f64::from(cos), error / f64::from(cos)), want);
    }
    worst.check();
    assert!(!twin.holds(), "a bake 5 % too bright must fail");
}

/// The same by the light grid, judged up to depth 4 and mean cosine 0.5, and by tables, which are printed: sections 1 to 3 again, with
/// the ground's albedo by the adding equation πT/(1 − ρR). The grid is judged by the mean of points among many nodes, whose
/// noise is not part of a point's own.
#[test]
fn grid_meets_published_slabs() {
    let hg = |g: f64| Phase::HenyeyGreenstein { g };
    let is_long = std::env::var_os("BAKE_LONG").is_some();
    let settings = GridSettings { cells: if is_long { 24 } else { 16 }, samples: 512 };
    let mut worst = Worst::new("slab by grid, beyond three standard errors", 0.015);
    let mut twin = Worst::new("the same, 5 % too bright", 0.015);
    // Phase, albedo, depth, the sun's cosine if it is not the sky, the ground's albedo, published.
    let cases = [
        (Phase::Isotropic, 1.0, 4.0, None, 0.0, 0.24597),
        (Phase::Isotropic, 0.9, 1.0, None, 0.5, 0.47475 / (1.0 - 0.5 * 0.35271)),
        (hg(0.5), 0.9, 1.0, None, 0.0, 0.598548),
        (Phase::Isotropic, 0.9, 1.0, None, 0.0, 0.47475),
        (Phase::Isotropic, 0.9, 1.0, Some(0.5f32), 0.0, 0.41484),
        (Phase::Isotropic, 0.5, 0.5, None, 0.0, 0.53499),
        (Phase::Isotropic, 1.0, 2.0, Some(1.0), 0.0, 0.48249),
        (hg(0.5), 0.9, 2.0, Some(1.0), 0.0, 0.52327),
        (hg(-0.3), 1.0, 2.0, None, 0.0, 0.331654),
        (hg(0.75), 1.0, 2.0, None, 0.0, 0.695960),
        (hg(0.75), 0.9, 2.0, Some(1.0), 0.0, 0.66096),
        (Phase::Isotropic, 1.0, 8.0, None, 0.0, 0.14153),
    ];
    for (phase, albedo, tau, cos, ground, want) in cases.into_iter().take(if is_long { usize::MAX } else { 3 }) {
        let is_judged = tau <= 4.0 && phase.mean_cosine().abs() <= 0.5;
        let what = format!("{phase:?}, albedo {albedo}, depth {tau}, sun {cos:?}, ground {ground}");
        // A low sun shines in at the sides. Other light is sent back there by white walls: without them it adds 1.2 % at depth
        // 4 and ten free paths.
        let is_walled = cos.is_none_or(|cos| cos == 1.0);
        let reach = if is_walled { 6.0 } else { 13.0 } / tau;
        let (mut scene, air) = layer_of(reach, tau, albedo, phase);
        scene.materials = vec![matte(ground), matte(1.0)];
        if is_walled {
            add_walls(&mut scene, reach as f32);
        }
        match cos {
            None => scene.environment = Some(sky(1.0)),
            Some(cos) => scene.lights = vec![sun(1.0, Vec3::new((1.0 - cos * cos).sqrt(), cos, 0.0))],
        }
        let unit = cos.map_or(std::f64::consts::PI, f64::from);
        // Within two free paths of the middle.
        let step = 2.0 / (3.0 * tau as f32);
        let points = (0..49)
            .map(|i| ((Vec3::new((i % 7) as f32, 0.0, (i / 7) as f32) - 3.0 * (Vec3::X + Vec3::Z)) * step, Vec3::Y));
        let points: Vec<(Vec3, Vec3)> = points.collect();
        let at_points = by_grid(&scene, &air, &points, settings, if is_long { 1024 } else { 256 });
        let count = points.len() as f64 * unit;
        let grid = at_points.iter().map(|(got, _)| got).sum::<f64>() / count;
        let noise = at_points.iter().map(|(_, error)| error * error).sum::<f64>().sqrt() / count;
        let tables = by_tables(&scene, &air, &MIDDLE, if is_long { 8192 } else { 2048 })[0].0 / unit;
        println!("{what}: grid {grid:.4} ± {noise:.4}, tables {tables:.4}, published {want:.4}");
        if is_judged {
            let off = |got: f64| ((got - want).abs() - 3.0 * noise).max(0.0) / want;
            worst.record(off(grid), || what.clone());
            twin.record(off(1.05 * grid), || what);
        }
    }
    worst.check();
    assert!(!twin.holds(), "a bake 5 % too bright must fail");
}

/// Walls 1 m high around a layer that reaches so far to each side, which face it.
fn add_walls(scene: &mut Scene, reach: f32) {
    for (side, along) in
        [(Vec3::X, Vec3::Z), (Vec3::Z, Vec3::NEG_X), (Vec3::NEG_X, Vec3::NEG_Z), (Vec3::NEG_Z, Vec3::X)]
    {
        let wall = quad(reach * (side - along), 2.0 * reach * along, Vec3::Y, 1);
        scene.instances.push(crate::test_scenes::instance(scene.meshes.len() as u32, Affine3A::IDENTITY));
        scene.meshes.push(wall);
    }
}

fn sky(radiance: f32) -> Environment {
    Environment { width: 1, height: 1, radiance: vec![Vec3::splat(radiance)], rotation: 0.0 }
}

/// A white block in white fog under a uniform sky: irradiance is π on every side, in every mode.
#[test]
fn a_furnace_of_fog_stays_a_furnace() {
    let mut scene = scene(vec![closed_box(Vec3::splat(-0.2), Vec3::splat(0.2), false, 0)], vec![matte(1.0)]);
    scene.environment = Some(sky(1.0));
    let points: Vec<(Vec3, Vec3)> = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z]
        .map(|n| (n * 0.2 + Vec3::new(0.05, 0.05, 0.05) * (Vec3::ONE - n.abs()), n))
        .into();
    let region = || Bounds::Box { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
    let mut worst = Worst::new("furnace, beyond three standard errors", 0.01);
    let is_long = std::env::var_os("BAKE_LONG").is_some();
    for tau in [0.1, 1.0, 10.0] {
        let air = uniform(region(), tau, 1.0, Phase::Isotropic);
        let mut results = vec![("walk", irradiance(&scene, &Fog::new(&air), &points, 1024))];
        // The noise of nodes is not part of a texel's standard error, and thick air takes many nodes.
        if tau < 10.0 || is_long {
            let settings = GridSettings { cells: 12, samples: if is_long { 1024 } else { 512 } };
            results.push(("grid", by_grid(&scene, &air, &points, settings, 1024)));
        }
        for (mode, got) in results {
            for (got, error) in got {
                let off = (got / std::f64::consts::PI - 1.0).abs() - 3.0 * error / std::f64::consts::PI;
                worst.record(off.max(0.0), || format!("{mode}, optical size {tau}: {got}"));
            }
        }
    }
    worst.check();
    let absorbing = uniform(region(), 1.0, 0.9, Phase::Isotropic);
    let (dimmed, _) = irradiance(&scene, &Fog::new(&absorbing), &points[..1], 2048)[0];
    assert!(dimmed < 0.97 * std::f64::consts::PI, "albedo 0.9 must not pass for 1: {dimmed}");
}

/// Share of uniform light that a sphere of air absorbs: `published_benchmarks.md` section 7 (integral equation for r·J(r)).
#[test]
fn walk_meets_published_spheres() {
    let speck = quad(Vec3::new(0.0, -1e4, 0.0), Vec3::X, Vec3::NEG_Z, 0);
    let scene = Scene { environment: Some(sky(1.0)), ..scene(vec![speck], vec![matte(0.0)]) };
    // What leaves through the border arrives at a receiver there that looks inwards.
    let border: Vec<(Vec3, Vec3)> =
        [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|out| (out, -out)).into();
    let samples = if std::env::var_os("BAKE_LONG").is_some() { 1 << 17 } else { 1 << 13 };
    let mut worst = Worst::new("absorbed by a sphere, beyond three standard errors", 0.005);
    let mut twin = Worst::new("the same, 5 % too much", 0.005);
    for (radius, albedo, want) in [
        (0.5, 0.5, 0.27583),
        (1.0, 0.2, 0.61940),
        (1.0, 0.9, 0.12199),
        (2.0, 0.5, 0.65108),
        (2.0, 0.99, 0.02608),
        (4.0, 0.8, 0.51377),
        (4.0, 0.9, 0.34060),
    ] {
        let ball = Bounds::Sphere { centre: DVec3::ZERO, radius: 1.0 };
        let got = irradiance(&scene, &Fog::new(&uniform(ball, radius, albedo, Phase::Isotropic)), &border, samples);
        let count = got.len() as f64 * std::f64::consts::PI;
        let absorbed = 1.0 - got.iter().map(|e| e.0).sum::<f64>() / count;
        let error = got.iter().map(|e| e.1 * e.1).sum::<f64>().sqrt() / count;
        println!("radius {radius}, albedo {albedo}: {absorbed:.5} ± {error:.5}, published {want:.5}");
        let off = |absorbed: f64| ((absorbed - want).abs() - 3.0 * error).max(0.0) / want;
        worst.record(off(absorbed), || format!("radius {radius}, albedo {albedo}: {absorbed}"));
        twin.record(off(1.05 * absorbed), || format!("radius {radius}, albedo {albedo}"));
    }
    worst.check();
    assert!(!twin.holds(), "5 % too much must fail");
}

/// Irradiance at points by tables, with its standard error.
fn by_tables(scene: &Scene, air: &MediumSet, points: &[(Vec3, Vec3)], samples: u32) -> Vec<(f64, f64)> {
    let (tracer, reduced) = (Tracer::new(scene), reduce(air));
    let (emitters, media) = (Emitters::new(&tracer), Tabled::new(&reduced));
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &media, bounces: u32::MAX, sh1: false };
    let effort = Effort { stations: 512, rays: 64, ..Effort::default() };
    gathered(&TablePaths::new(paths, effort, 1), points, samples)
}

/// A mode, and what it finds at points.
type Solve<'a> = (&'a str, &'a dyn Fn(&Scene, &MediumSet) -> Vec<(f64, f64)>);

/// Walls that reflect all and air that absorbs nothing give more light than any other, at every point and in every mode.
#[test]
fn nothing_is_brighter_than_white_walls_and_white_air() {
    let lit = |albedo: f32| {
        let mut scene = Scene { lights: vec![sun(1.0, Vec3::new(-0.5, -0.3, 0.8))], ..courtyard() };
        scene.materials.iter_mut().for_each(|material| material.base_color = Vec3::splat(albedo).extend(1.0));
        scene
    };
    let bounds = &courtyard_air().media[0].bounds;
    let air = |tau: f64, albedo: f64| uniform(bounds.clone(), tau / 8.0, albedo, Phase::Isotropic);
    let at = |i: u32| -8.0 + 3.9 * i as f32;
    let ground: Vec<(Vec3, Vec3)> = (0..25).map(|i| (Vec3::new(at(i % 5), at(i / 5), 0.0), Vec3::Z)).collect();
    let samples = if std::env::var_os("BAKE_LONG").is_some() { 8192 } else { 512 };
    let modes: [Solve; 3] = [
        ("walk", &|scene, air| irradiance(scene, &Fog::new(air), &ground, samples)),
        ("grid", &|scene, air| by_grid(scene, air, &ground, GridSettings { cells: 6, samples: 64 }, samples)),
        ("tables", &|scene, air| by_tables(scene, air, &ground, samples)),
    ];
    for ((mode, solve), tau) in modes.iter().flat_map(|mode| [0.3, 1.0, 3.0].map(|tau| (mode, tau))) {
        let most = solve(&lit(1.0), &air(tau, 1.0));
        let beyond = |got: &[(f64, f64)]| {
            let excess = |(got, most): (&(f64, f64), &(f64, f64))| (got.0 - most.0) / got.1.hypot(most.1);
            got.iter().zip(&most).map(excess).fold(f64::NEG_INFINITY, f64::max)
        };
        for (walls, albedo) in [(0.9, 1.0), (0.4, 0.9)] {
            let got = solve(&lit(walls), &air(tau, albedo));
            let excess = beyond(&got);
            println!("{mode}, optical height {tau}, walls {walls}, air {albedo}: {excess:+.1} standard errors");
            assert!(excess < 4.0, "{mode}, optical height {tau}, walls {walls}, air {albedo}: {excess}");
            let brighter: Vec<_> = got.iter().map(|e| (4.0 * e.0, e.1)).collect();
            assert!(beyond(&brighter) > 4.0, "four times as bright must fail");
        }
    }
}

/// In a closed room with air of albedo 1 the walls absorb what the lamp emits.
#[test]
fn walls_absorb_what_the_lamp_emits() {
    let mut scene = room([0.3, 0.7, 0.5, 0.5, 0.4, 0.6]);
    scene.lights = vec![point_light(Vec3::new(0.45, 0.4, 0.7), 1.0)];
    let air = uniform(Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE }, 2.0, 1.0, Phase::HenyeyGreenstein { g: 0.4 });
    let samples = if std::env::var_os("BAKE_LONG").is_some() { 2048 } else { 64 };
    let per_side = 16;
    let at = |i: u32| (i as f32 + 0.5) / per_side as f32;
    let (mut absorbed, mut variance) = (0.0, 0.0);
    for (wall, albedo) in [0.3, 0.7, 0.5, 0.5, 0.4, 0.6].into_iter().enumerate() {
        let (axis, side) = (wall / 2, (wall % 2) as f32);
        let mut normal = Vec3::ZERO;
        normal[axis] = 1.0 - 2.0 * side;
        let points: Vec<(Vec3, Vec3)> = (0..per_side * per_side)
            .map(|i| {
                let mut point = Vec3::ZERO;
                (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) =
                    (side, at(i % per_side), at(i / per_side));
                (point, normal)
            })
            .collect();
        for (got, error) in irradiance(&scene, &Fog::new(&air), &points, samples) {
            let share = (1.0 - albedo) / f64::from(per_side * per_side);
            absorbed += share * got;
            variance += (share * error).powi(2);
        }
    }
    let (ratio, error) = (absorbed / (4.0 * std::f64::consts::PI), variance.sqrt() / (4.0 * std::f64::consts::PI));
    println!("absorbed over emitted {ratio:.4} ± {error:.4}");
    let balances = |ratio: f64| (ratio - 1.0).abs() < 0.005 + 3.0 * error;
    assert!(balances(ratio));
    assert!(!balances(0.95 * ratio), "a loss of 5 % must fail");
    assert!(error < 0.01, "too noisy to tell");
}

/// Next to no air gives the bake without air, path by path.
#[test]
fn thin_air_is_vacuum() {
    let mut scene = room([0.3, 0.7, 0.5, 0.5, 0.4, 0.6]);
    scene.lights = vec![point_light(Vec3::new(0.45, 0.4, 0.7), 1.0)];
    let tracer = Tracer::new(&scene);
    let emitters = Emitters::new(&tracer);
    let start = path::Vertex { origin: Vec3::new(0.2, 0.3, 1e-4), normal_geom: Vec3::Z, normal_shading: Vec3::Z };
    let gather = |media: &MediumSet, sample: u32| {
        let fog = Fog::new(media);
        let paths = Paths { tracer: &tracer, emitters: &emitters, media: &fog, bounces: u32::MAX, sh1: false };
        paths.gather(&start, &mut Sampler::new(sample, 5), &Counters::default())
    };
    let vacuum = Paths { tracer: &tracer, emitters: &emitters, media: &Vacuum, bounces: u32::MAX, sh1: false };
    let everywhere = || Bounds::Box { min: DVec3::splat(-9.0), max: DVec3::splat(9.0) };
    let (thin, thick) =
        (uniform(everywhere(), 1e-12, 0.5, Phase::Isotropic), uniform(everywhere(), 1e-2, 0.5, Phase::Isotropic));
    let (mut worst, mut differing) = (Worst::new("thin air", 1e-5), 0);
    for sample in 0..512 {
        let want = vacuum.gather(&start, &mut Sampler::new(sample, 5), &Counters::default());
        let got = gather(&thin, sample);
        for (a, b) in got.terms.iter().zip(want.terms) {
            worst.record(
                f64::from((*a - b).abs().max_element() / want.terms.iter().sum::<Vec3>().max_element().max(1e-3)),
                || format!("sample {sample}"),
            );
        }
        differing += u32::from(gather(&thick, sample).terms != want.terms);
    }
    worst.check();
    assert!(differing > 256, "a hundredth per metre must be felt: {differing}");
}

/// What light meets has no favourite channel.
#[test]
fn channels_permute_with_the_scene() {
    let bake = |order: [usize; 3]| {
        let turn = |rgb: [f32; 3]| Vec3::from(order.map(|c| rgb[c]));
        let mut scene = room([0.5; 6]);
        scene.materials[0].base_color = turn([0.7, 0.2, 0.4]).extend(1.0);
        scene.lights = vec![Light { color: turn([1.0, 2.0, 0.5]), ..point_light(Vec3::new(0.45, 0.4, 0.7), 1.0) }];
        let mut air = uniform(Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE }, 1.0, 1.0, Phase::Isotropic);
        let turn = |rgb: [f64; 3]| order.map(|c| rgb[c]);
        air.media[0].scatter.sigma_s = turn([0.5, 1.5, 3.0]);
        air.media[0].scatter.sigma_a = turn([0.1, 0.0, 0.3]);
        let tracer = Tracer::new(&scene);
        let (emitters, fog) = (Emitters::new(&tracer), Fog::new(&air));
        let paths = Paths { tracer: &tracer, emitters: &emitters, media: &fog, bounces: u32::MAX, sh1: false };
        let start = path::Vertex { origin: Vec3::new(0.4, 0.6, 1e-4), normal_geom: Vec3::Z, normal_shading: Vec3::Z };
        let values: Vec<Vec3> = (0..32)
            .map(|r| {
                let one = |i| paths.gather(&start, &mut Sampler::new(i, r), &Counters::default());
                (0..256).map(|i| one(i).terms.iter().sum::<Vec3>()).sum::<Vec3>() / 256.0
            })
            .collect();
        std::array::from_fn::<_, 3, _>(|c| {
            let c = order.iter().position(|&o| o == c).unwrap();
            testkit::statistics::mean_and_error(&values.iter().map(|v| f64::from(v[c])).collect::<Vec<_>>())
        })
    };
    let (straight, turned) = (bake([0, 1, 2]), bake([2, 0, 1]));
    for channel in 0..3 {
        let ((a, ea), (b, eb)) = (straight[channel], turned[channel]);
        println!("channel {channel}: {a:.4} ± {ea:.4}, permuted {b:.4} ± {eb:.4}");
        assert!((a - b).abs() < 4.0 * ea.hypot(eb));
    }
    assert!((straight[0].0 - straight[1].0).abs() > 0.05 * straight[0].0, "channels must differ for the test to tell");
}

/// Finite, never negative, and close to the neighbour case where parameters meet their ends.
#[test]
fn hard_cases_stay_finite() {
    let cases = [1e-9, 1e-3, 1.0, 1e3, 1e6].into_iter().flat_map(|sigma_t| {
        let albedos = [0.0, 0.5, 1.0].into_iter();
        albedos.flat_map(move |albedo| [-0.99, 0.0, 0.99].map(|g| (sigma_t, albedo, g)))
    });
    for (sigma_t, albedo, g) in cases {
        let mut scene = room([0.5; 6]);
        // A lamp 2 mm from a wall, and air whose border cuts through the floor's middle and the lamp.
        scene.lights = vec![point_light(Vec3::new(0.5, 0.5, 0.002), 1.0)];
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::new(0.5, 1.0, 1.0) };
        let air = uniform(bounds, sigma_t, albedo, Phase::HenyeyGreenstein { g });
        let points = [
            (Vec3::new(0.5, 0.5, 0.0), Vec3::Z),
            (Vec3::new(0.499_999, 0.2, 0.0), Vec3::Z),
            (Vec3::new(0.9, 0.9, 1.0), Vec3::NEG_Z),
        ];
        let walk = irradiance(&scene, &Fog::new(&air), &points, 32);
        // Every thick case has the same grid; one of them is enough.
        let has_grid = sigma_t < 10.0 || (sigma_t == 1e6 && albedo == 0.5 && g == 0.0);
        let grid = has_grid.then(|| by_grid(&scene, &air, &points, GridSettings { cells: 3, samples: 1 }, 32));
        for (got, _) in walk.into_iter().chain(grid.into_iter().flatten()) {
            assert!(got.is_finite() && got >= 0.0, "sigma_t {sigma_t}, albedo {albedo}, g {g}: {got}");
        }
    }
}
