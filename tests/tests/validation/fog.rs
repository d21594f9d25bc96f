//! Fog through the program: rooms and a courtyard baked in the mode that the plan chooses, sampled by `bake sample` and held
//! against a volumetric path tracer of others (box_truth, open_truth).
//!
//! The truth's variance is subtracted from the squared error; points whose truth is uncertain by more than 2 % are left out.
//! In the normal run scenes bake at medium quality on small pages and their own variance is subtracted too.

use bake_formats::metrics::{self, Metrics};
use bake_tests::ledger::Ledger;
use bake_tests::program::{Baked, run};
use glam::Vec3;
use testkit::reference::{Row, read_csv, shared};

/// Largest bias allowed.
const BIAS: f64 = 0.01;

struct Case {
    scene: &'static str,
    truth: &'static str,
    fog: &'static str,
    /// Largest relative RMSE allowed: more at night, where unlit corners are dark.
    rmse: f64,
}

const ROOMS: [Case; 3] = [
    Case { scene: "fog_room_point", truth: "box_truth_s1", fog: "sigma_t=0.2,albedo=1", rmse: 0.04 },
    Case { scene: "fog_room_point", truth: "box_truth_s2", fog: "sigma_t=1,albedo=1", rmse: 0.04 },
    Case { scene: "fog_room_lamp", truth: "box_truth_s3", fog: "sigma_t=3,albedo=0.7", rmse: 0.04 },
];
const YARD_FOG: &str = "sigma_t=0.125,albedo=1,bounds=-10:0:-10:10:8:10";
const DAY: Case = Case { scene: "fog_yard_day", truth: "open_truth_o1", fog: YARD_FOG, rmse: 0.04 };
const NIGHT: Case = Case { scene: "fog_yard_night", truth: "open_truth_o2", fog: YARD_FOG, rmse: 0.05 };

/// Baked light at the truth's points, whose z axis points up.
fn sampled(baked: &Baked, truth: &[Row]) -> Vec<Row> {
    let turned = |row: &Row, [x, y, z]: [&str; 3]| format!("{},{},{}", row.number(x), row.number(z), -row.number(y));
    let line = |row: &Row| format!("{},{}\n", turned(row, ["x", "y", "z"]), turned(row, ["nx", "ny", "nz"]));
    let points: String = truth.iter().map(line).collect();
    let desk = tempfile::tempdir().expect("a temporary folder");
    let [input, output] = ["points.csv", "light.csv"].map(|name| desk.path().join(name));
    std::fs::write(&input, format!("px,py,pz,nx,ny,nz\n{points}")).expect("a temporary folder takes files");
    let text = |path: &std::path::Path| path.to_str().expect("paths of tests are UTF-8").to_owned();
    let ended = run(&["sample", &text(baked.folder()), &text(&input), "-o", &text(&output)]);
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    read_csv(&output)
}

/// Errors of the baked red channel against the truth times `scale`, with the bake's own variance subtracted or not.
fn errors(baked: &[Row], truth: &[Row], scale: f64, own_variance: bool) -> Metrics {
    let is_sure = |row: &&(&Row, &Row)| row.1.number("se") < 0.02 * row.1.number("E");
    let pairs: Vec<(&Row, &Row)> = baked.iter().zip(truth).collect();
    let of = |f: &dyn Fn(&Row, &Row) -> f64| {
        pairs.iter().filter(is_sure).map(|(b, t)| Vec3::splat(f(b, t) as f32)).collect::<Vec<_>>()
    };
    let own = if own_variance { 1.0 } else { 0.0 };
    let variance = of(&|b, t| (scale * t.number("se")).powi(2) + own * b.number("var_r"));
    let exact = of(&|_, t| scale * t.number("E"));
    metrics::compare(&of(&|b, _| b.number("E_r")), &exact, &vec![true; exact.len()], Some(&variance))
}

fn check(case: &Case, quality: &str, pages: &str, own_variance: bool) {
    let Some(path) = shared(&format!("reference/{}.csv", case.truth)) else { return };
    let truth = read_csv(&path);
    let baked = Baked::own(case.scene, &format!("--quality {quality} {pages} --fog {}", case.fog));
    let ledger = Ledger::new("Fog", &format!("{}, {quality}", case.truth));
    ledger.note("seconds", baked.number("seconds"));
    ledger.note("standard error reached, share of the median", baked.number("reached_error"));
    let light = sampled(&baked, &truth);
    let right = errors(&light, &truth, 1.0, own_variance).luminance;
    ledger.at_most("|bias|", right.bias.abs(), BIAS);
    ledger.at_most("relative RMSE", right.relative_rmse, case.rmse);
    let wrong = errors(&light, &truth, 1.05, own_variance).luminance;
    ledger.refused("|bias| against a truth 5 % too bright", wrong.bias.abs(), BIAS);
}

#[test]
fn rooms_at_medium_quality() {
    ROOMS[..2].iter().for_each(|case| check(case, "medium", "--page-size 128 --max-pages 1 --texels-per-m 32", true));
}

#[test]
fn a_courtyard_by_day_at_medium_quality() {
    check(&DAY, "medium", "--page-size 128 --max-pages 1 --texels-per-m 32", true);
}

#[test]
fn all_at_final_quality() {
    if bake_tests::long() {
        ROOMS
            .iter()
            .chain([&DAY, &NIGHT])
            .for_each(|case| check(case, "final", "--page-size 256 --max-pages 1 --texels-per-m 48", false));
    }
}
