//! `bake study` through the program: its files, going on, and what it needs no scene for.

use crate::bake::Desk;
use serde_json::Value;

const STUDY: &str = "study room.glb --page-size 16 --reference-samples 64 -o out";

#[test]
fn a_study_leaves_its_page_and_numbers_and_has_nothing_to_do_twice() {
    let desk = Desk::with_room();
    let ended = desk.bake(&format!("-v {STUDY}"));
    ended.expect(0, &["reference:", "samples:"]);
    assert!(ended.out.contains("control") && ended.out.contains("study.html"), "{}", ended.out);
    let page = std::fs::read_to_string(desk.path("out/study.html")).expect("written");
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<svg"));
    let again = desk.bake(&format!("-v --json {STUDY}"));
    again.expect(0, &[]);
    assert!(!again.err.contains("samples:"), "measured again: {}", again.err);
    let told: Value = serde_json::from_str(&again.out).expect("JSON");
    let kept: Value =
        serde_json::from_slice(&std::fs::read(desk.path("out/study.json")).expect("written")).expect("JSON");
    assert_eq!(told, kept);
}

#[test]
fn effects_are_left_out_one_by_one_and_their_bounds_told() {
    let desk = Desk::with_room();
    let fog = "--fog sigma_t=0.3/0.4/0.5,albedo=0.8,g=0.4";
    let ended = desk.bake(&format!("study room.glb --effects --page-size 16 --reference-samples 256 {fog} -o out"));
    ended.expect(0, &[]);
    for effect in ["attenuation", "absorption", "scattering", "multiple", "anisotropy", "colour", "indirect"] {
        assert!(ended.out.contains(effect), "no {effect} in\n{}", ended.out);
    }
    assert!(!ended.out.contains("heterogeneity") && !ended.out.contains("BROKEN"), "{}", ended.out);
    let csv = std::fs::read_to_string(desk.path("out/effects.csv")).expect("written");
    assert_eq!(csv.lines().count(), 8, "{csv}");
}

#[test]
fn a_scene_is_needed_unless_numbers_are_asked_for() {
    let desk = Desk::with_room();
    desk.bake("study").expect(2, &["<SCENE>", "bake study [OPTIONS] <SCENE>"]);
    let help = desk.bake("study --help").out;
    assert!(help.contains("bake study --stability"), "{help}");
    for unused in ["--keep-paths", "--half", "--probes", "--keep-raw"] {
        assert!(!help.contains(unused), "{unused}: {help}");
    }
    desk.bake("study nope.glb").expect(2, &["nope.glb does not exist"]);
    std::fs::create_dir(desk.path("out")).expect("created");
    desk.write("out/points.csv", "a,b\n1,2\n");
    desk.bake(STUDY).expect(2, &["points.csv", "-o"]);
}
