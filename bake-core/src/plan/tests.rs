//! The plan's bounds and reductions against bakes: what is left out is gone, and changes no more than was said.

use super::*;
use crate::progress::Silent;
use crate::scene::{Environment, Light, Scene};
use crate::settings;
use crate::solve::{self, LUMINANCE};
use crate::test_scenes::{matte, point_light, quad, quad_atlas, scene};
use bake_optics::medium::{Bounds, Density, Medium, MediumSet, Scatter};
use bake_optics::phase::Phase;
use glam::DVec3;

const TEXELS: u32 = 3;

/// A closed room with a lamp, or without one wall under a dim sky; all of it takes lightmaps.
fn room(is_closed: bool) -> Scene {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let walls = [(Vec3::ZERO, y, z), (x, z, y), (Vec3::ZERO, z, x), (Vec3::ZERO, x, y), (z, y, x), (y, x, z)];
    let count = if is_closed { 6 } else { 5 };
    let meshes = walls[..count].iter().map(|&(corner, u, v)| quad(corner, u, v, 0)).collect();
    let mut scene = scene(meshes, vec![matte(0.5)]);
    scene.lights = vec![Light { color: Vec3::new(1.0, 0.8, 0.6), ..point_light(Vec3::new(0.6, 0.6, 0.5), 1.0) }];
    let sky = Environment { width: 1, height: 1, radiance: vec![Vec3::splat(0.1)], rotation: 0.0 };
    scene.environment = (!is_closed).then_some(sky);
    scene
}

/// One page a wall.
fn atlas(scene: &Scene) -> Atlas {
    let mut atlas = quad_atlas(TEXELS);
    let page = atlas.pages.remove(0);
    for instance in 0..scene.instances.len() as u32 {
        let mut page = page.clone();
        page.points.iter_mut().for_each(|point| point.instance = instance);
        atlas.pages.push(page);
    }
    atlas
}

/// Coloured, anisotropic, heterogeneous.
fn smoke(strength: f64) -> Air {
    let medium = Medium {
        bounds: Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE },
        density: Density::Exponential { base_m: 0.0, scale_height_m: 0.3 },
        scatter: Scatter { sigma_s: [0.5, 0.3, 0.1].map(|s| s * strength), sigma_a: [0.2 * strength; 3] },
        phase: Phase::HenyeyGreenstein { g: 0.6 },
    };
    Air { media: MediumSet { media: vec![medium] }, names: vec!["smoke".into()], scene: [DVec3::ZERO, DVec3::ONE] }
}

fn settings_of(samples: u32, force: &[(EffectName, bool)]) -> Settings {
    let force_effect = force.iter().copied().collect();
    Settings { samples: Some(samples), mode: settings::Mode::Walk, force_effect, ..Settings::default() }
}

fn plan(tracer: &Tracer, air: &Air, settings: &Settings) -> Plan {
    Plan::derive(tracer, air, settings, &atlas(tracer.scene()), 1).expect("no lattices")
}

/// Total irradiance of every texel.
fn bake(tracer: &Tracer, plan: &Plan, seed: u32) -> Vec<Vec3> {
    let solver = LightmapSettings { seed, ..plan.solver.clone() };
    let atlas = atlas(tracer.scene());
    let lightmap = solve::lightmap(tracer, &plan.simulated.media, &atlas, &solver, &Silent).expect("not interrupted");
    lightmap.pages.iter().flat_map(|page| (0..page.validity.len()).map(|texel| page.total(texel))).collect()
}

/// Bakes of several seeds with everything on, but for one effect.
fn bakes(tracer: &Tracer, air: &Air, without: Option<EffectName>) -> Vec<Vec<Vec3>> {
    let mut force = EffectName::ALL.map(|(_, effect)| (effect, true)).to_vec();
    force.extend(without.map(|effect| (effect, false)));
    let plan = plan(tracer, air, &settings_of(256, &force));
    let count = if std::env::var_os("BAKE_LONG").is_some() { 64 } else { 8 };
    (0..count).map(|seed| bake(tracer, &plan, seed)).collect()
}

/// Mean over texels of the change of luminance, in medians, and of its noise. Both sides drew the same random numbers.
fn change(with: &[Vec<Vec3>], without: &[Vec<Vec3>]) -> (f64, f64) {
    let texels = with[0].len();
    let level = |light: Vec3| f64::from(light.dot(LUMINANCE));
    let mut levels: Vec<f64> = (0..texels).map(|t| with.iter().map(|run| level(run[t])).sum()).collect();
    levels.sort_by(f64::total_cmp);
    let median = levels[texels / 2] / with.len() as f64;
    let of = |texel: usize| {
        let runs = with.iter().zip(without);
        let changes: Vec<f64> = runs.map(|(with, without)| level(with[texel] - without[texel])).collect();
        testkit::statistics::mean_and_error(&changes)
    };
    let changes: Vec<(f64, f64)> = (0..texels).map(of).collect();
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| changes.iter().map(f).sum::<f64>() / (texels as f64 * median);
    (mean(&|change| change.0.abs()), mean(&|change| change.1))
}

/// Every effect forced off changes the light by less than its bound. What it changes clearly, it changes by more than
/// a thousandth of the bound, so that a bound that is a thousand times too small would fail.
#[test]
fn what_is_left_out_stays_within_its_bound() {
    let (closed, open, air) = (room(true), room(false), smoke(1.0));
    let rooms = [&closed, &open].map(Tracer::new);
    let with = rooms.each_ref().map(|tracer| bakes(tracer, &air, None));
    let effects = rooms.each_ref().map(|tracer| plan(tracer, &air, &settings_of(16, &[])).effects);
    let mut told = 0;
    for (name, effect) in EffectName::ALL {
        let room = usize::from(effect == EffectName::Environment);
        let bound = effects[room].iter().find(|effect| effect.name == name).expect("listed").bound;
        let (change, noise) = change(&with[room], &bakes(&rooms[room], &air, Some(effect)));
        println!("{name}: changes {change:.4} ± {noise:.4}, bound {bound:.4}, {:.0} times as much", bound / change);
        let holds = |bound: f64| change - 2.0 * noise <= bound;
        assert!(bound.is_finite() && holds(bound), "{name}: {change} ± {noise} beyond {bound}");
        if change > 4.0 * noise {
            assert!(!holds(bound / 1000.0), "{name}: a bound of {} would pass as well", bound / 1000.0);
            told += 1;
        }
    }
    assert!(told >= 4, "only {told} effects stand out of the noise");
}

/// Air that the plan leaves out gives the bits of a bake without air; forced on it gives the same within rounding.
#[test]
fn air_that_is_left_out_is_vacuum() {
    let scene = room(true);
    let tracer = Tracer::new(&scene);
    let vacuum = bake(&tracer, &plan(&tracer, &Air::default(), &settings_of(16, &[])), 3);
    let thin = smoke(1e-12);
    let left_out = plan(&tracer, &thin, &settings_of(16, &[]));
    assert!(left_out.simulated.is_empty() && left_out.mode.is_none());
    assert_eq!(bake(&tracer, &left_out, 3), vacuum);
    let forced = |air: &Air| {
        let all = EffectName::ALL.map(|(_, effect)| (effect, true));
        let plan = plan(&tracer, air, &settings_of(16, &all));
        assert!(plan.simulated == *air && plan.mode.is_some());
        bake(&tracer, &plan, 3)
    };
    let furthest = |light: &[Vec3]| {
        let off = light.iter().zip(&vacuum).map(|(a, b)| (*a - *b).abs().max_element() / b.max_element());
        off.fold(0.0, f32::max)
    };
    let (thin, felt) = (furthest(&forced(&thin)), furthest(&forced(&smoke(1e-2))));
    println!("forced on: {thin:e} at 1e-12, {felt:e} at 1e-2");
    assert!(thin < 1e-5, "{thin}");
    assert!(felt > 1e-3, "a hundredth per metre must be felt: {felt}");
    // Forced off, thick smoke is vacuum too.
    let off = plan(&tracer, &smoke(1.0), &settings_of(16, &[(EffectName::Attenuation, false)]));
    assert_eq!(bake(&tracer, &off, 3), vacuum);
}

/// The pilot's limit lies below the median of a bake, and not far below.
#[test]
fn the_pilot_stays_below_the_median() {
    let scene = room(true);
    let tracer = Tracer::new(&scene);
    let atlas = atlas(&scene);
    let of = |strength: f64| {
        let plan = plan(&tracer, &smoke(strength), &settings_of(256, &[]));
        let mut levels: Vec<f32> = bake(&tracer, &plan, 0).iter().map(|light| light.dot(LUMINANCE)).collect();
        levels.sort_by(f32::total_cmp);
        let limit = pilot::median(&tracer, &smoke(strength).media, &atlas, &LightmapSettings::default());
        (limit, f64::from(levels[levels.len() / 2]))
    };
    for strength in [1e-9, 1.0, 4.0] {
        let (limit, median) = of(strength);
        println!("strength {strength}: limit {limit:.3}, median {median:.3}");
        assert!(limit < median && limit > 0.2 * median);
    }
}

/// Without its higher orders light scatters once, and what scatters once stays.
#[test]
fn single_scattering_alone_has_no_second_order() {
    let scene = room(true);
    let tracer = Tracer::new(&scene);
    let with = |mode, on| {
        let force = [(EffectName::Multiple, on)];
        let settings = Settings { mode, quality: settings::Quality::Preview, ..settings_of(32, &force) };
        plan(&tracer, &smoke(3.0), &settings)
    };
    for mode in [settings::Mode::Walk, settings::Mode::Grid] {
        let terms = |on: bool| {
            let plan = with(mode, on);
            let lightmap = solve::lightmap(&tracer, &plan.simulated.media, &atlas(&scene), &plan.solver, &Silent);
            let page = lightmap.expect("not interrupted").pages.remove(0);
            let sum =
                |image: &solve::buffers::TermImage| image.irradiance.iter().map(|e| e.dot(LUMINANCE)).sum::<f32>();
            page.terms.iter().map(sum).collect::<Vec<f32>>()
        };
        let (with, without) = (terms(true), terms(false));
        assert!(with[3] > 0.02 * with[2] && without[3] == 0.0, "{mode:?}: {with:?} against {without:?}");
        assert!(without[2] > 0.5 * with[2], "{mode:?}: {with:?} against {without:?}");
    }
    let tables = |on| with(settings::Mode::Tables, on).solver.mode;
    assert_eq!([tables(true), tables(false)], [Mode::Tables, Mode::Grid]);
}

/// Tables without points of the own plane: others stand for them, and what moves stays within its bound.
#[test]
fn the_own_plane_is_left_out_within_its_bound() {
    let scene = room(false);
    let tracer = Tracer::new(&scene);
    let of = |on: bool| {
        let settings = Settings { mode: settings::Mode::Tables, ..settings_of(256, &[(EffectName::OwnPlane, on)]) };
        let mut plan = plan(&tracer, &smoke(2.0), &settings);
        plan.solver.tables = solve::Effort { stations: 256, rays: 64, ..plan.solver.tables };
        let runs: Vec<_> = (0..4).map(|seed| bake(&tracer, &plan, seed)).collect();
        (plan, runs)
    };
    let ((with, on), (without, off)) = (of(true), of(false));
    let listed = |plan: &Plan| plan.effects.iter().find(|effect| effect.name == "own-plane").expect("listed").clone();
    assert!(
        listed(&with).on && !listed(&without).on && with.solver.tables.own_plane && !without.solver.tables.own_plane
    );
    let bound = listed(&with).bound;
    let (change, noise) = change(&on, &off);
    println!("own plane: changes {change:.4} ± {noise:.4}, bound {bound:.4}");
    assert!(bound.is_finite() && change - 2.0 * noise <= bound, "{change} ± {noise} beyond {bound}");
    assert_ne!(on, off, "it must be felt");
    let forced = settings_of(16, &[(EffectName::Scattering, true), (EffectName::Multiple, true)]);
    let tolerant = Settings { mode: settings::Mode::Tables, tolerance: 1.01 * bound as f32, ..forced };
    let left_out = plan(&tracer, &smoke(2.0), &tolerant).solver;
    assert_eq!((left_out.mode, left_out.tables.own_plane), (Mode::Tables, false), "too little to matter");
    let walk = plan(&tracer, &smoke(2.0), &settings_of(16, &[]));
    assert_eq!((listed(&walk).on, listed(&walk).bound), (false, 0.0), "walks find it");
}

/// A bare floor loses almost every ray: what is kept of it folds with more noise, most where it was kept without air.
#[test]
fn the_noise_of_kept_paths_is_said() {
    let settings = Settings { keep_paths: true, ..settings_of(16, &[]) };
    let noise = |scene: &Scene, air: &Air| plan(&Tracer::new(scene), air, &settings).kept_paths.map(|kept| kept.noise);
    let (mut floor, none) = (room(false), Air { media: MediumSet::default(), ..smoke(1.0) });
    floor.instances.truncate(1);
    let noises = [(&room(true), &smoke(1.0)), (&floor, &smoke(1.0)), (&floor, &none)].map(|(s, air)| noise(s, air));
    let [Some(closed), Some(open), Some(without_air)] = noises else { panic!("paths are kept: {noises:?}") };
    assert!(closed == 1.0 && closed < open && open < without_air, "{noises:?}");
    assert_eq!(plan(&Tracer::new(&floor), &none, &settings_of(16, &[])).kept_paths, None);
}
