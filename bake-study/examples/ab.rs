//! Two programs beside each other: `ab OLD NEW [PAIRS]` bakes small scenes with both in turns and fails where the new one
//! costs more beyond the noise of these runs. `ci/bench` builds the programs of two commits and calls it.
//!
//! The cost of a bake is seconds × error²: what the same error takes. Samples are fixed, the error is the one that the bake
//! states; seconds are what the processor spends on the whole program, as the shell's `times` tells them: a busy machine
//! changes them little. Not shown: large scenes, how well threads are used.

use bake_study::ratio::{Verdict, decide};
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Scene and flags.
const BAKES: [(&str, &str); 4] = [
    ("cornell", "--samples 256"),
    ("cornell", "--samples 64 --fog sigma_t=0.3,albedo=0.9 --mode walk"),
    ("cornell", "--samples 64 --fog sigma_t=0.3,albedo=0.9 --mode grid --quality preview"),
    ("cornell", "--samples 32 --fog sigma_t=0.3,albedo=0.9 --mode tables"),
];

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [old, new, rest @ ..] = arguments.as_slice() else { return Err("ab OLD NEW [PAIRS]".into()) };
    let count = rest.first().map_or(Ok(8), |count| count.parse())?;
    if count < 3 {
        return Err("at least 3 pairs: fewer do not tell their noise".into());
    }
    let mut lost = false;
    for (scene, flags) in BAKES {
        let pairs = (0..count).map(|turn| pair(old, new, scene, flags, turn)).collect::<Result<Vec<_>, _>>()?;
        let decision = decide(&pairs);
        println!(
            "{scene} {flags}: new/old {:.3} ± {:.3}: {}",
            decision.ratio,
            decision.error,
            match decision.verdict {
                Verdict::Kept => "kept",
                Verdict::Lost => "LOST",
                Verdict::TooNoisy => "too noisy to tell: more pairs, or a quieter machine",
            }
        );
        lost |= decision.verdict == Verdict::Lost;
    }
    Ok(if lost { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// Costs of one bake by both; who begins alternates.
fn pair(old: &str, new: &str, scene: &str, flags: &str, turn: u32) -> Result<(f64, f64), Box<dyn Error>> {
    if turn.is_multiple_of(2) {
        let first = cost(old, scene, flags)?;
        Ok((first, cost(new, scene, flags)?))
    } else {
        let first = cost(new, scene, flags)?;
        Ok((cost(old, scene, flags)?, first))
    }
}

fn cost(program: &str, scene: &str, flags: &str) -> Result<f64, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let output = Command::new("sh")
        .args(["-c", "\"$@\" && times", "sh", program])
        .args(["run", "--json", "-q", "--page-size", "128", "--max-pages", "1", "-o"])
        .arg(root.join("target/bench/out"))
        .arg(root.join("scenes").join(scene).with_extension("glb"))
        .args(flags.split(' '))
        .output()?;
    let told = String::from_utf8(output.stdout)?;
    let fault = || format!("{program} {scene} {flags}: {}", String::from_utf8_lossy(&output.stderr));
    let (report, seconds) = told_seconds(&told).ok_or_else(fault)?;
    let report: Value = serde_json::from_str(report).map_err(|_| fault())?;
    let error = report["reached_error"].as_f64().ok_or("no error")?;
    Ok(seconds * error * error)
}

/// What a program printed, and the seconds that its processes took: `times` ends with a line of them, "1m2.5s 0m0.1s".
fn told_seconds(told: &str) -> Option<(&str, f64)> {
    let (before, children) = told.trim_end().rsplit_once('\n')?;
    let (report, _shell) = before.rsplit_once('\n')?;
    let seconds = |time: &str| {
        let (minutes, seconds) = time.strip_suffix('s')?.split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
    };
    let each: Option<Vec<f64>> = children.split_whitespace().map(seconds).collect();
    Some((report, each.filter(|each| each.len() == 2)?.iter().sum()))
}
