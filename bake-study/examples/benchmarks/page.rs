//! The page `docs/benchmarks.md`.

use crate::Origin;
use crate::cases::{CASES, Case};
use bake_study::report::REACH;
use bake_study::summary::{LEVELS, ModeSummary, Summary, floor, percent};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "# Benchmarks: what accuracy costs in whole bakes

Written by `cargo run --release -p bake-study --example benchmarks` from the numbers kept beside it; `… -- record` measures anew.
Every point is in `benchmarks/NAME/points.csv`; `bake study SCENE` makes the same for any scene, with all plots and pictures.

Errors are relative to a reference by walks, whose variance is taken off; on one small page, before seams are stitched. Seconds are the
processor's, all threads together, without loading and layout: read them as ratios. The floor is the part of the RMSE at the most
samples that is not noise: what a mode's own bias costs (for `grid` and `tables` also the noise that all texels share). *Over no air* is
the time beside that of the same samples in the same scene without air; the published figure for tables is 4 to 15 % (Dubouchet et al. 2019).
";

/// The whole page, of the cases that were recorded.
pub fn markdown(kept: &Path) -> Result<String, Box<dyn Error>> {
    let mut text = format!("{HEAD}{REACH}\n");
    for case in &CASES {
        let folder = kept.join(case.name);
        if folder.join("study.json").exists() {
            let summary: Summary = serde_json::from_slice(&std::fs::read(folder.join("study.json"))?)?;
            let origin: Origin = serde_json::from_slice(&std::fs::read(folder.join("origin.json"))?)?;
            section(&mut text, case, &summary, &origin)?;
        }
    }
    let missing: Vec<&str> = CASES.iter().map(|case| case.name).filter(|name| !kept.join(name).exists()).collect();
    if !missing.is_empty() {
        writeln!(text, "\nNot recorded yet: {}.", missing.join(", "))?;
    }
    Ok(text)
}

fn section(text: &mut String, case: &Case, summary: &Summary, origin: &Origin) -> std::fmt::Result {
    let Case { name, scene, what, .. } = case;
    let Origin { commit, date, profile } = origin;
    let reference = &summary.reference;
    writeln!(text, "\n## {name}: {what}\n")?;
    writeln!(text, "![relative RMSE against seconds](benchmarks/{name}/modes.svg)\n")?;
    writeln!(
        text,
        "`scenes/{scene}.glb`, {} texels, seed {}; reference of {} samples, standard error {} a texel and {} of the mean. {}, {} threads, {date}, {commit}, {profile} profile.\n",
        summary.texels,
        summary.seed,
        reference.samples,
        percent(reference.error),
        percent(reference.mean_error),
        summary.processor,
        summary.threads
    )?;
    let levels: String = LEVELS.iter().map(|level| format!(" s to {} % |", 100.0 * level)).collect();
    writeln!(
        text,
        "| mode |{levels} floor | bias | over no air | at fewest samples |\n| --- |{} ---: | ---: | ---: | ---: |",
        " ---: |".repeat(LEVELS.len())
    )?;
    summary.modes.iter().try_for_each(|mode| row(text, mode))?;
    for control in &summary.controls {
        let verdict = if control.is_caught { "told from chance, as it must be" } else { "**not told from chance**" };
        writeln!(
            text,
            "\nControl, wrong on purpose: {}: bias {:+.2} ± {:.2} %, {verdict}.",
            control.setting,
            100.0 * control.bias,
            100.0 * control.bias_error
        )?;
    }
    Ok(())
}

fn row(text: &mut String, mode: &ModeSummary) -> std::fmt::Result {
    let seconds: String = mode.seconds_to.iter().map(|reach| format!(" {reach} |")).collect();
    let over = |share: Option<f64>| share.map_or("–".into(), |share| format!("{:+.0} %", 100.0 * share));
    let (bias, error) = (100.0 * mode.errors.bias, 100.0 * mode.errors.bias_error);
    writeln!(
        text,
        "| {} |{seconds} {} | {bias:+.2} ± {error:.2} % | {} | {} |",
        mode.name,
        floor(&mode.errors),
        over(mode.overhead),
        over(mode.overhead_at_fewest)
    )
}
