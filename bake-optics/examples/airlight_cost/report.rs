//! The page and the data.

use std::fmt::Write;

use crate::measure::{PASSES_TEXT, Point, RAYS, Result};

pub fn csv(results: &[Result]) -> String {
    let mut text = String::from("case,method,effort,ns_per_ray,median_error,p95_error,max_error\n");
    for result in results {
        for p in &result.points {
            let Point { method, effort, nanoseconds, median, p95, max } = p;
            let case = result.case;
            writeln!(text, "{case},\"{method}\",{effort},{nanoseconds:.1},{median:.3e},{p95:.3e},{max:.3e}")
                .expect("String");
        }
    }
    text
}

pub fn markdown(results: &[Result]) -> String {
    let mut text = format!(
        "# Air-light: what accuracy costs\n\n\
         Written by `cargo run --release -p bake-optics --example airlight_cost`; data in `airlight.csv`.\n\n\
         {RAYS} fixed rays a case (`examples/airlight_cost/rays.rs`): extinction 0.01 to 1/m, lamp 0.5 to 30 m away at any angle from 1° to \
         179°, length 1 to 100 m, every eighth endless. Errors are relative to the adaptive f64 oracle; rays in a lamp's dark do not \
         count. {PASSES_TEXT} Nodes are per side of the lamp's foot: 8 means 8 + 8. Spot and ball lamps are cut where they go dark. \
         Uniform air only: air that varies costs its optical depths on top. f32 rows include the rounding of the rays to f32. \
         The closed form cuts HG 0.9 to 11 Legendre terms, for which it was not made; the vacuum leaves extinction out.\n\n\
         Processor: {}; vector width as compiled: {}. Read times as ratios: the machine may have been shared while measuring.\n\n",
        processor(),
        width()
    );
    text.push_str(&verdict(results));
    for result in results {
        let file = result.case.replace(' ', "_");
        write!(text, "\n## {}\n\n![{}](airlight/{file}.svg)\n\n", result.case, result.case).expect("String");
        text.push_str("| method | nodes, steps or size | ns per ray | median | 95th percentile | largest |\n|---|---|---|---|---|---|\n");
        for p in &result.points {
            let Point { method, effort, nanoseconds, median, p95, max } = p;
            writeln!(text, "| {method} | {effort} | {nanoseconds:.0} | {median:.1e} | {p95:.1e} | {max:.1e} |")
                .expect("String");
        }
    }
    text
}

/// 8 + 8 nodes beside 32 steps.
fn verdict(results: &[Result]) -> String {
    let mut text = String::from(
        "**8 + 8 nodes beside a march of 32 steps** (time ratio below 1: quadrature is faster)\n\n\
         | case | time, quadrature / march | median error, march / quadrature | 95th percentile, march / quadrature |\n|---|---|---|---|\n",
    );
    for result in results {
        let find =
            |method: &str, effort: usize| result.points.iter().find(|p| p.method == method && p.effort == effort);
        let (Some(ours), Some(march)) = (find("quadrature", 8), find("ray march", 32)) else { continue };
        let time = ours.nanoseconds / march.nanoseconds;
        // An error of exactly zero counts as one rounding.
        let ratio = |march: f64, ours: f64| march / ours.max(f64::EPSILON);
        let (median, p95) = (ratio(march.median, ours.median), ratio(march.p95, ours.p95));
        writeln!(text, "| {} | {time:.2} | {median:.0e} | {p95:.0e} |", result.case).expect("String");
    }
    text
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name")).unwrap_or(": unknown");
    line.split(':').nth(1).unwrap_or("unknown").trim().to_owned()
}

fn width() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "AVX-512"
    } else if cfg!(target_feature = "avx2") {
        "AVX2"
    } else {
        "SSE2 (the default target)"
    }
}
