//! Whole bakes measured and kept: `cargo run --release -p bake-study --example benchmarks -- record [NAME …]` studies the
//! cases, keeps the numbers under `docs/benchmarks/`, and writes `docs/benchmarks.md`; without `record` only the page is
//! written anew from the numbers that are kept. An interrupted recording goes on where it was (`target/benchmarks`).

mod cases;
mod page;

use bake_core::progress::Silent;
use bake_study::clock::Clock;
use bake_study::sweep::{self, Kind};
use bake_study::{Study, report, store};
use cases::{CASES, Case};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where and when a case was recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Commit of the program.
    pub commit: String,
    /// Day.
    pub date: String,
    /// Profile that it was built with.
    pub profile: String,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let kept = workspace().join("docs/benchmarks");
    if arguments.first().is_some_and(|word| word == "record") {
        let wanted = |case: &&Case| arguments.len() == 1 || arguments[1..].iter().any(|name| name == case.name);
        for case in CASES.iter().filter(wanted) {
            record(case, &kept.join(case.name))?;
        }
    }
    std::fs::write(workspace().join("docs/benchmarks.md"), page::markdown(&kept)?)?;
    Ok(())
}

/// The workspace's root.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Studies a case and keeps its numbers and the plot of its modes.
fn record(case: &Case, kept: &Path) -> Result<(), Box<dyn Error>> {
    let folder = workspace().join("target/benchmarks").join(store::program()).join(case.name);
    let file = workspace().join("scenes").join(case.scene).with_extension("glb");
    let study = Study { settings: case.settings(&file)?, file, folder, effort: case.effort(), clock: Clock::Processor };
    eprintln!("{}", case.name);
    let summary = bake_study::run(&study, &Silent, &|line| eprintln!("  {line}"))?;
    print!("{}", summary.text());
    std::fs::create_dir_all(kept)?;
    for name in ["points.csv", "study.json"] {
        std::fs::copy(study.folder.join(name), kept.join(name))?;
    }
    let origin = Origin {
        commit: output("git", &["rev-parse", "--short", "HEAD"])?,
        date: output("date", &["-u", "+%F"])?,
        profile: if cfg!(debug_assertions) { "dev (opt-level 2)".into() } else { "release".into() },
    };
    std::fs::write(kept.join("origin.json"), serde_json::to_string_pretty(&origin)? + "\n")?;
    for (name, svg) in plots(&study)? {
        std::fs::write(kept.join(name), svg)?;
    }
    Ok(())
}

/// Error against seconds by mode, as a picture of its own.
fn plots(study: &Study) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let (groups, store) = bake_study::study::measured(study)?;
    let drawn = groups.iter().filter(|group| group.kind == Kind::Samples);
    Ok(drawn
        .map(|group: &sweep::Group| ("modes.svg".to_owned(), report::plot(group, &store).svg().into_string()))
        .collect())
}

fn output(program: &str, arguments: &[&str]) -> Result<String, Box<dyn Error>> {
    let output = Command::new(program).args(arguments).current_dir(workspace()).output()?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}
