//! Whole studies of tiny scenes: the same numbers again, going on after an interruption, and what is wrong on purpose
//! shows as bias.

use bake_core::progress::{Progress, Silent};
use bake_core::settings::{Bounds, Density, Medium, Mode, Phase, Quality, Scatter, Settings};
use bake_study::clock::Clock;
use bake_study::effects::{Left, Verdict};
use bake_study::effort::Effort;
use bake_study::summary::Summary;
use bake_study::sweep::Kind;
use bake_study::{Study, StudyError, effects, run};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use testkit::reference::{Row, read_csv};

fn effort() -> Effort {
    Effort {
        page: Some(16),
        reference_samples: 512,
        samples: vec![8, 64],
        fixed_samples: 64,
        targets: vec![0.2],
        grids: vec![[3, 16]],
        bins: vec![256],
        bands: vec![3, 15],
        orders: vec![],
    }
}

const FOG: Option<Scatter> = Some(Scatter::Sigma { s: [0.4; 3], a: [0.05; 3] });

fn study(folder: &Path, air: Option<Scatter>) -> Study {
    let (bounds, density, phase) = (Bounds::Scene, Density::Uniform, Phase::Isotropic);
    let media = air.map(|scatter| vec![Medium { name: "fog".into(), bounds, density, scatter, phase }]);
    let settings = Settings { media, mode: Mode::Walk, quality: Quality::Preview, ..Settings::default() };
    Study {
        file: scenes::folder().join("cornell.glb"),
        settings,
        folder: folder.to_owned(),
        effort: effort(),
        clock: Clock::Wall,
    }
}

fn whole(study: &Study) -> Summary {
    run(study, &Silent, &|_| ()).expect("the scene is sound")
}

/// The measured points without their times.
fn numbers(folder: &Path) -> Vec<[String; 6]> {
    let of = |row: &Row| ["key", "samples", "bias", "rmse", "noise", "rays"].map(|column| row.text(column).to_owned());
    let mut rows: Vec<_> = read_csv(&folder.join("points.csv")).iter().map(of).collect();
    rows.sort();
    rows
}

/// Stops after so many questions.
struct Impatient(AtomicU32);

impl Progress for Impatient {
    fn stage(&self, _: &str, _: u64) {}
    fn expect(&self, _: u64) {}
    fn advance(&self, _: u64) {}
    fn is_cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| Some(left.saturating_sub(1))) == Ok(0)
    }
}

#[test]
fn a_study_of_fog_repeats_and_goes_on_where_it_was() {
    let folders = [0, 1].map(|_| tempfile::tempdir().expect("a folder"));
    let [once, pieces] = folders.each_ref().map(|folder| study(folder.path(), FOG));
    let summary = whole(&once);
    let mut kept = 0;
    for patience in [100, 700, 1500] {
        let stopped = run(&pieces, &Impatient(patience.into()), &|_| ());
        assert!(matches!(stopped, Err(StudyError::Interrupted(_))), "patience of {patience}: {stopped:?}");
        if let Ok(text) = std::fs::read_to_string(pieces.folder.join("points.csv")) {
            assert!(text.lines().count() >= kept, "points are lost");
            kept = text.lines().count();
        }
    }
    assert!(kept > 1, "nothing was kept");
    let gone_on = whole(&pieces);
    assert_eq!(numbers(&once.folder), numbers(&pieces.folder));
    assert_eq!(summary.controls, gone_on.controls);
    // A third run has nothing to measure, and tells the same.
    let silent = run(&pieces, &Silent, &|line| assert!(line.starts_with("warning"), "measured again: {line}"));
    assert_eq!(silent.expect("all is there"), gone_on);
    assert_eq!(summary.modes.len(), 4);
    assert!(summary.modes.iter().all(|mode| mode.overhead.is_some()));
    assert_page(&once.folder, 7);
    assert_honest(&summary, 2);
    assert_fewer_collisions_are_darker(&once.folder);
}

/// What leaving out later collisions takes away falls with their number, and is gone at ten.
fn assert_fewer_collisions_are_darker(folder: &Path) {
    let rows = read_csv(&folder.join("points.csv"));
    let bias = |most: u32| {
        let air = format!("at most {most} collisions");
        let row = rows.iter().find(|row| row.text("air") == air && row.text("samples") == "64").expect("measured");
        (row.number("bias"), row.number("bias_error"))
    };
    let [once, twice, ten] = [1, 2, 10].map(bias);
    println!("bias of at most 1, 2, 10 collisions: {once:?} {twice:?} {ten:?}");
    assert!(once.0 < -4.0 * once.1 && once.0 < twice.0 && twice.0 < ten.0 && ten.0.abs() < 4.0 * ten.1);
}

#[test]
fn a_study_without_air_tells_wrong_from_right_and_one_seed_from_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = study(folder.path(), None);
    assert_honest(&whole(&study), 1);
    assert_page(&study.folder, 4);
    let points = numbers(&study.folder).len();
    let other = Study { settings: Settings { seed: 1, ..study.settings.clone() }, ..study.clone() };
    assert_honest(&whole(&other), 1);
    assert_eq!(numbers(&study.folder).len(), 2 * points);
}

/// A lone floor reflects nothing to itself: no setting that reflects too little is wrong there, and none is said to be.
#[test]
fn nothing_wrong_is_made_up_where_nothing_is_reflected() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = Study { file: scenes::folder().join("plane_point.glb"), ..study(folder.path(), None) };
    let summary = whole(&study);
    assert!(summary.controls.is_empty() && summary.controls_hold(), "{:?}", summary.controls);
    assert!(summary.text().contains("nothing is reflected"), "{}", summary.text());
}

#[test]
fn effects_left_out_go_on_where_they_were() {
    let folders = [0, 1].map(|_| tempfile::tempdir().expect("a folder"));
    let [once, pieces] = folders.each_ref().map(|folder| study(folder.path(), FOG));
    let numbers = |all: &[Left]| all.iter().map(|left| (left.effect.clone(), left.at_most)).collect::<Vec<_>>();
    let whole = effects::run(&once, &Silent, &|_| ()).expect("the scene is sound");
    let told = AtomicU32::new(0);
    let count = |_: &str| {
        told.fetch_add(1, Ordering::Relaxed);
    };
    for patience in [200, 400, 800, 1600, 3200] {
        let _ = effects::run(&pieces, &Impatient(patience.into()), &count);
    }
    let gone_on = effects::run(&pieces, &Silent, &count).expect("the scene is sound");
    assert_eq!(numbers(&whole), numbers(&gone_on));
    assert_eq!(told.load(Ordering::Relaxed) as usize, whole.len(), "each is measured once");
    effects::run(&pieces, &Silent, &|line| panic!("measured again: {line}")).expect("all is there");
}

/// Thin air with a touch of blue: what the plan leaves out changes less than its bound says, and a bound that is too low is told.
#[test]
fn what_the_plan_leaves_out_of_thin_air_keeps_to_its_bound() {
    let folder = tempfile::tempdir().expect("a folder");
    let thin = Scatter::Sigma { s: [1e-3, 1e-3, 1.0005e-3], a: [5e-6; 3] };
    let study = study(folder.path(), Some(thin));
    let all = effects::run(&study, &Silent, &|_| ()).expect("the scene is sound");
    println!("{}", effects::text(&all));
    let left_out: Vec<_> = all.iter().filter(|left| !left.planned).collect();
    let names: Vec<_> = left_out.iter().map(|left| left.effect.as_str()).collect();
    assert!(["absorption", "colour", "multiple"].iter().all(|name| names.contains(name)), "{names:?}");
    for left in &left_out {
        assert_eq!(left.verdict(), Verdict::Holds, "{}", left.text());
        assert!(left.why.contains("left out") && left.bound < f64::from(study.settings.tolerance), "{left:?}");
        assert!(left.seconds_with > 0.0 && left.text().contains(&format!("without {:.2} s", left.seconds_without)));
    }
    // What it keeps matters, and would not pass for less.
    let kept = all.iter().find(|left| left.effect == "indirect").expect("walls are lit");
    assert!(kept.planned && kept.at_least > 0.05, "{kept:?}");
    assert_eq!(effects::Left { bound: 0.5 * kept.at_least, ..kept.clone() }.verdict(), Verdict::Broken);
    let page = std::fs::read_to_string(folder.path().join("effects.html")).expect("written");
    assert_eq!(page.matches("<td>left out</td>").count(), left_out.len());
}

/// What is wrong on purpose shows as bias, honest walks do not.
fn assert_honest(summary: &Summary, controls: usize) {
    println!("{}", summary.text());
    assert_eq!(summary.controls.len(), controls);
    assert!(summary.controls_hold(), "{:?}", summary.controls);
    let honest = &summary.modes[0];
    assert!(!honest.errors.is_biased(), "{honest:?}");
    assert!(honest.errors.floor < 2.0 * honest.errors.least_floor, "{honest:?}");
    // The verdict is worth something: a walk that passed for a control must fail it.
    let mut fooled = summary.clone();
    fooled.controls[0].is_caught = honest.errors.is_biased();
    assert!(!fooled.controls_hold());
}

/// The page stands alone and shows every group.
fn assert_page(folder: &Path, groups: usize) {
    let page = std::fs::read_to_string(folder.join("study.html")).expect("written");
    for kind in [Kind::Samples, Kind::Bounces, Kind::Target, Kind::Control] {
        assert!(page.contains(kind.text()[0]), "{kind:?}");
    }
    assert_eq!(page.matches("<svg").count(), groups);
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http") && !page.contains("NaN"));
    assert!(page.contains("data:image/png;base64,") && page.contains("5 %"));
    // A scene with fog also shows what 15 bands would gain.
    assert_eq!(page.contains(">15</td>"), groups == 7);
}
