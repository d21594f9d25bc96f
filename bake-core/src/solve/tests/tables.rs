//! The table mode against independent truth: closed rooms, a courtyard by day, and air of any thickness.

use super::fog::{courtyard, courtyard_air, gathered, points, room, score, sun, truth_room, uniform, unit_box};
use super::*;
use crate::solve::tables::TablePaths;
use crate::solve::tables::factors::{RANGE, Report};
use crate::solve::tables::medium::{Tabled, reduce};
use bake_optics::phase::Phase;
use testkit::reference::{read_csv, shared};

/// Irradiance at points by tables, and how far they had to be corrected.
fn irradiance(
    scene: &Scene,
    air: &MediumSet,
    points: &[(Vec3, Vec3)],
    samples: u32,
    effort: Effort,
) -> (Vec<(f64, f64)>, Report) {
    let (tracer, reduced) = (Tracer::new(scene), reduce(air));
    let (emitters, tabled) = (Emitters::new(&tracer), Tabled::new(&reduced));
    let paths = Paths { tracer: &tracer, emitters: &emitters, media: &tabled, bounces: u32::MAX, sh1: false };
    let paths = TablePaths::new(paths, effort, 1);
    (gathered(&paths, points, samples), paths.factors().report)
}

fn effort() -> (u32, Effort) {
    if std::env::var_os("BAKE_LONG").is_some() {
        (4096, Effort { stations: 4096, rays: 512, ..Effort::default() })
    } else {
        (512, Effort::default())
    }
}

/// Limits of bias and RMSE. At optical size up to 1 tables are held to an RMSE of 2.5 % and to no bias of its own; 2 % of bias leaves
/// 1.5 % for the spread. The room of three mean free paths is the hardest for them.
#[test]
fn tables_meet_the_closed_rooms() {
    for (number, bias, rmse) in [(1, 0.02, 0.025), (2, 0.02, 0.025), (3, 0.05, 0.06)] {
        let Some(path) = shared(&format!("reference/box_truth_s{number}.csv")) else { return };
        let (scene, air, truth) = truth_room(number, &path);
        let (samples, effort) = effort();
        let (got, report) = irradiance(&scene, &air, &points(&truth), samples, effort);
        println!("{report:?}");
        let result = score(&format!("tables, room {number}"), &got, &truth);
        let brighter: Vec<_> = got.iter().map(|g| (g.0 * 1.15, g.1)).collect();
        assert!(!score("15 % too bright", &brighter, &truth).holds(bias, rmse));
        assert!(result.holds(bias, rmse), "{result:?}");
    }
}

/// Specified for tables summed to two collisions: 7.6 % under the sun; half as much again is allowed. At night texels that the
/// lamp does not reach are wrong by factors, which is printed.
#[test]
fn tables_meet_the_courtyard() {
    for (number, light) in [
        (1, sun(4.0, Vec3::new(-0.612_372_46, -0.353_553_4, 0.707_106_77))),
        (2, point_light(Vec3::new(-1.0, 1.0, 2.0), 100.0)),
    ] {
        let Some(path) = shared(&format!("reference/open_truth_o{number}.csv")) else { return };
        let mut scene = courtyard();
        scene.lights = vec![light];
        let truth = read_csv(&path);
        let (samples, effort) = effort();
        let (got, report) = irradiance(&scene, &courtyard_air(), &points(&truth), samples, effort);
        println!("{report:?}");
        let result = score(&format!("tables, courtyard {number}"), &got, &truth);
        assert!(number == 2 || result.holds(0.03, 0.114), "{result:?}");
        assert!(report.escaped > 0.5);
    }
}

#[test]
fn air_of_any_thickness_stays_finite_and_absorption_only_darkens() {
    let mut scene = room([0.5; 6]);
    scene.lights = vec![point_light(Vec3::splat(0.5), 1.0)];
    let corner = (Vec3::new(0.2, 0.3, 0.0), Vec3::Z);
    let quick = Effort { stations: 64, rays: 32, ..Effort::default() };
    let mut last = f64::INFINITY;
    for sigma_t in [1e-6, 1e-2, 0.5, 4.0, 50.0, 1e4] {
        for albedo in [0.0, 0.5, 1.0] {
            let air = uniform(unit_box(), sigma_t, albedo, Phase::HenyeyGreenstein { g: 0.4 });
            let (got, report) = irradiance(&scene, &air, &[corner], 64, quick);
            let e = got[0].0;
            assert!(e.is_finite() && e >= 0.0, "sigma_t {sigma_t}, albedo {albedo}: {e}");
            assert!(report.surfaces[0] >= RANGE.0 && report.surfaces[2] <= RANGE.1, "{report:?}");
            if albedo == 0.0 {
                assert!(e <= last * 1.001, "absorbing air of sigma_t {sigma_t} brightens: {e} after {last}");
                last = e;
            }
        }
    }
    assert!(last < 1e-6, "nothing comes through ten thousand mean free paths");
}

#[test]
fn threads_do_not_change_a_bit() {
    let mut scene = room([0.5; 6]);
    scene.lights = vec![point_light(Vec3::splat(0.5), 1.0)];
    let air = uniform(unit_box(), 1.0, 0.8, Phase::Isotropic);
    let tables = Effort { stations: 256, rays: 32, ..Effort::default() };
    let settings =
        LightmapSettings { min_samples: 16, max_samples: 16, mode: Mode::Tables, tables, ..Default::default() };
    let bake = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let solve = || lightmap(&Tracer::new(&scene), &air, &quad_atlas(SIZE), &settings, &Silent).unwrap();
        pool.install(solve).pages[0].clone()
    };
    let (one, three) = (bake(1), bake(3));
    assert!(one.terms[2].irradiance.iter().any(|e| *e != Vec3::ZERO));
    for (a, b) in one.terms.iter().zip(&three.terms) {
        assert_eq!(a.irradiance, b.irradiance);
    }
}
