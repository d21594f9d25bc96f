//! The arrows between crates, as `cargo metadata` sees them: who may use whom, and what no crate below the program
//! may ever see.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Crate, and the crates of the project that it may use.
const ARROWS: &[(&str, &[&str])] = &[
    ("bake-optics", &[]),
    ("bake-formats", &["bake-optics"]),
    ("tables", &["bake-optics", "bake-formats"]),
    ("bake-core", &["tables", "bake-formats", "bake-optics"]),
    ("bake-runtime", &["bake-formats", "bake-optics", "tables"]),
    ("bake-view", &["bake-runtime", "bake-formats"]),
    ("bake-study", &["bake-core", "tables", "bake-formats", "bake-optics"]),
    ("bake-cli", &["bake-study", "bake-view", "bake-core", "tables", "bake-formats", "bake-optics"]),
    // For tests and for making scenes; no shipped crate may use them.
    ("testkit", &[]),
    ("scenes", &[]),
    (
        "bake-tests",
        &["bake-cli", "bake-core", "bake-formats", "bake-optics", "bake-runtime", "scenes", "tables", "testkit"],
    ),
];

/// Crate, and what it must never use: command line, terminal, window, GPU; for the formulas files and threads too.
const FORBIDDEN: &[(&str, &[&str])] = &[
    (
        "bake-optics",
        &["clap", "indicatif", "miette", "ctrlc", "rayon", "tracing", "wgpu", "winit", "serde_json", "tempfile"],
    ),
    ("bake-formats", &["clap", "indicatif", "miette", "ctrlc", "wgpu", "winit"]),
    ("tables", &["clap", "indicatif", "miette", "ctrlc", "wgpu", "winit"]),
    ("bake-core", &["clap", "indicatif", "miette", "ctrlc", "wgpu", "winit"]),
    ("bake-runtime", &["clap", "indicatif", "miette", "ctrlc", "winit", "egui"]),
    ("bake-view", &["clap", "indicatif", "miette", "ctrlc"]),
    ("bake-study", &["clap", "indicatif", "miette", "ctrlc", "wgpu", "winit"]),
    ("bake-cli", &["wgpu", "winit", "egui"]),
];

/// What each workspace crate uses outside its tests.
fn uses() -> BTreeMap<String, BTreeSet<String>> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(testkit::reference::workspace())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("a list");
    let name = |value: &Value| value["name"].as_str().expect("a name").to_owned();
    let shipped = |package: &Value| -> BTreeSet<String> {
        let dependencies = package["dependencies"].as_array().expect("a list").iter();
        dependencies.filter(|dependency| dependency["kind"] != "dev").map(name).collect()
    };
    packages.iter().map(|package| (name(package), shipped(package))).collect()
}

/// Every use that breaks a rule.
fn faults(uses: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let mut faults = Vec::new();
    for (name, used) in uses {
        let Some((_, allowed)) = ARROWS.iter().find(|(crate_name, _)| crate_name == name) else {
            faults.push(format!("{name} has no row in ARROWS"));
            continue;
        };
        let of_project = used.iter().filter(|other| uses.contains_key(*other));
        faults.extend(
            of_project.filter(|other| !allowed.contains(&other.as_str())).map(|other| format!("{name} → {other}")),
        );
        let forbidden = FORBIDDEN.iter().filter(|(crate_name, _)| crate_name == name).flat_map(|(_, list)| *list);
        faults.extend(forbidden.filter(|other| used.contains(**other)).map(|other| format!("{name} → {other}")));
    }
    faults
}

#[test]
fn dependencies_point_one_way() {
    let uses = uses();
    assert!(uses.len() >= 7, "the workspace's crates: {:?}", uses.keys());
    assert_eq!(faults(&uses), Vec::<String>::new());
}

#[test]
fn an_arrow_turned_round_is_found() {
    let mut uses = uses();
    uses.get_mut("bake-optics").expect("a crate").insert("bake-core".into());
    uses.get_mut("bake-core").expect("a crate").insert("clap".into());
    uses.insert("stranger".into(), BTreeSet::new());
    assert_eq!(faults(&uses), ["bake-core → clap", "bake-optics → bake-core", "stranger has no row in ARROWS"]);
}
