//! Two programs beside each other: `ab OLD NEW [PAIRS]` bakes small scenes with both in turns and fails where the new one
//! costs more beyond the noise of these runs. `ci/bench` builds the programs of two commits and calls it.
//!
//! The cost of a bake is seconds × error²: what the same error takes. Samples are fixed, the error is the one that the
//! bake states; seconds are those of tracing. Not shown: loading, layout, writing, large scenes.

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
    let folder = root.join("target/bench/out");
    let output = Command::new(program)
        .args(["run", "--json", "-q", "--page-size", "128", "--max-pages", "1", "-o"])
        .arg(&folder)
        .arg(root.join("scenes").join(scene).with_extension("glb"))
        .args(flags.split(' '))
        .output()?;
    let told: Value = serde_json::from_slice(&output.stdout)
        .map_err(|_| format!("{program} {scene} {flags}: {}", String::from_utf8_lossy(&output.stderr)))?;
    let stages = told["stages"].as_array().ok_or("no stages")?;
    let is_tracing = |stage: &&Value| ["light in the air", "trace"].iter().any(|name| stage["name"] == *name);
    let seconds: f64 = stages.iter().filter(is_tracing).filter_map(|stage| stage["seconds"].as_f64()).sum();
    let error = told["reached_error"].as_f64().ok_or("no error")?;
    Ok(seconds * error * error)
}
