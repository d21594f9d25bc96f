//! The published method shows its bias, and none where it has none.

use super::fog::{gathered, points, score, truth_room, uniform};
use super::*;
use crate::solve::tables::TablePaths;
use crate::solve::tables::medium::Tabled;
use crate::solve::tables::paper::PaperPaths;
use ::tables::TableSet;
use bake_formats::Term;
use bake_optics::medium::Bounds;
use bake_optics::phase::Phase;
use glam::DVec3;
use testkit::reference::shared;

fn with_paper<T>(set: &TableSet, scene: &Scene, air: &MediumSet, solve: impl FnOnce(&PaperPaths) -> T) -> T {
    let (tracer, tabled) = (Tracer::new(scene), Tabled::new(air));
    let emitters = Emitters::new(&tracer);
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &tabled, bounces: u32::MAX, sh1: false };
    solve(&PaperPaths::new(paths, set))
}

fn with_tables<T>(scene: &Scene, air: &MediumSet, solve: impl FnOnce(&TablePaths) -> T) -> T {
    let (tracer, tabled) = (Tracer::new(scene), Tabled::new(air));
    let emitters = Emitters::new(&tracer);
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &tabled, bounces: u32::MAX, sh1: false };
    solve(&TablePaths::new(paths, Effort { stations: 512, rays: 64, ..Effort::default() }, 1))
}

/// Ten orders of an infinite medium without correction were measured with a prototype to be 11, 66 and 20 % too bright in rooms
/// of optical size 0.2, 1 and 3, with tables about no fitted axis; a fifth more or less is allowed. With the published tables
/// the room of size 1 is held to 40 to 80 %. The corrected mode is the twin that lies outside.
#[test]
fn the_published_method_is_too_bright_in_rooms_by_what_was_measured() {
    let samples = if std::env::var_os("BAKE_LONG").is_some() { 4096 } else { 256 };
    for (number, bias) in [(1, 0.11), (2, 0.66), (3, 0.20)] {
        let Some(path) = shared(&format!("reference/box_truth_s{number}.csv")) else { return };
        let (scene, air, truth) = truth_room(number, &path);
        let bias_of = |name: &str, set: &TableSet| {
            let got = with_paper(set, &scene, &air, |paths| gathered(paths, &points(&truth), samples));
            score(&format!("paper, {name} tables, room {number}"), &got, &truth).bias
        };
        let exact = bias_of("exact", TableSet::embedded());
        assert!((exact / bias - 1.0).abs() < 0.2, "room {number}: {exact}, expected about {bias}");
        let published = bias_of("published", TableSet::published());
        if number == 2 {
            let got = with_tables(&scene, &air, |paths| gathered(paths, &points(&truth), 128));
            let twin = score("tables, room 2", &got, &truth).bias;
            let holds = |bias: f64| (0.4..0.8).contains(&bias);
            assert!(holds(published) && !holds(twin), "{published}, corrected {twin}");
        }
    }
}

/// Mean of the once-scattered term at a point looking up, with its standard error.
fn once(paths: &impl Gather, origin: Vec3, samples: u32) -> (f64, f64) {
    let start = path::Vertex { origin, normal_geom: Vec3::Z, normal_shading: Vec3::Z };
    let of = |seed: u32| {
        let one = |i| paths.gather(&start, &mut Sampler::new(i, seed), &Counters::default());
        (0..samples).map(|i| f64::from(one(i).terms[Term::Single as usize].x)).sum::<f64>() / f64::from(samples)
    };
    testkit::statistics::mean_and_error(&(0..16).map(of).collect::<Vec<_>>())
}

/// Black ground under a lamp in thin air without end: half of an infinite medium is all that the ground can see. The tables'
/// mode samples what the published one looks up; published tables have 11 bands, 1 % of what arrives here. The twin is air of another density.
#[test]
fn open_thin_air_scatters_once_as_in_the_mode_that_samples_it() {
    let mut scene =
        scene(vec![quad(Vec3::new(-50.0, -50.0, 0.0), Vec3::X * 100.0, Vec3::Y * 100.0, 0)], vec![matte(0.0)]);
    scene.lights = vec![point_light(Vec3::new(0.0, 0.0, 2.0), 10.0)];
    let air = |sigma_t| uniform(Bounds::Unbounded, sigma_t, 1.0, Phase::Isotropic);
    for x in [0.5, 3.0] {
        let at = Vec3::new(x, 0.0, 1e-4);
        let (exact, error) = with_tables(&scene, &air(1e-3), |paths| once(paths, at, 1024));
        let (published, _) = with_paper(TableSet::published(), &scene, &air(1e-3), |paths| once(paths, at, 1));
        println!("{x} m aside: {published:.6e} as published, {exact:.6e} ± {error:.1e} sampled");
        let holds = |value: f64| (value - exact).abs() < 0.02 * exact + 4.0 * error;
        assert!(holds(published), "{published} against {exact}");
        let (twin, _) = with_paper(TableSet::published(), &scene, &air(1.1e-3), |paths| once(paths, at, 1));
        assert!(!holds(twin), "{twin} against {exact}");
    }
}

/// Air ends at the ground, so that legs from just above it pass through next to none; or it has no end under a sky.
#[test]
fn where_air_ends_or_does_not_light_stays_finite() {
    let all_finite = |scene: &Scene, bounds: Bounds| {
        let air = uniform(bounds, 0.05, 0.9, Phase::Isotropic);
        with_paper(TableSet::published(), scene, &air, |paths| {
            let gather = |i: u32| {
                let [x, y, ..] = Sampler::new(i, 1).next4();
                let start =
                    path::Vertex { origin: Vec3::new(x, y, 1.2e-5), normal_geom: Vec3::Z, normal_shading: Vec3::Z };
                paths.gather(&start, &mut Sampler::new(i, 0), &Counters::default())
            };
            (0..4096).all(|i| gather(i).terms.iter().all(|term| term.is_finite()))
        })
    };
    let mut ground = scene(vec![quad(Vec3::ZERO, Vec3::X, Vec3::Y, 0)], vec![matte(1.0)]);
    ground.lights = vec![point_light(Vec3::splat(0.5), 1.0)];
    let below = |top: f64| Bounds::Box { min: DVec3::splat(-10.0), max: DVec3::new(10.0, 10.0, top) };
    assert!([0.0, 1e-9, 1e-7, 1e-6].iter().all(|&top| all_finite(&ground, below(top))));
    ground.environment = Some(Environment { width: 1, height: 1, radiance: vec![Vec3::ONE], rotation: 0.0 });
    assert!(all_finite(&ground, Bounds::Unbounded));
}
