//! What a command measured of itself: seconds by stage and peak memory, as a table for people or JSON for machines.

use serde::Serialize;
use std::time::Instant;

/// Seconds of one stage.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Name.
    pub name: &'static str,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Takes the time of a command's stages.
#[derive(Debug, Default)]
pub struct Stopwatch {
    stages: Vec<Stage>,
}

impl Stopwatch {
    /// Runs a stage and keeps its time.
    pub fn time<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.stages.push(Stage { name, seconds: start.elapsed().as_secs_f64() });
        result
    }

    /// The stages so far, in order.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// Their sum, seconds.
    pub fn total(&self) -> f64 {
        self.stages.iter().map(|stage| stage.seconds).sum()
    }
}

/// Largest resident memory of this process so far, bytes; `None` where the system does not say.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// Lines of the stage table: name, seconds, share of all.
pub fn stage_table(stopwatch: &Stopwatch) -> String {
    let total = stopwatch.total().max(f64::MIN_POSITIVE);
    let line = |name: &str, seconds: f64| format!("{name:<10} {seconds:>9.2} s {:>5.1} %\n", 100.0 * seconds / total);
    let mut table: String = stopwatch.stages().iter().map(|stage| line(stage.name, stage.seconds)).collect();
    table.push_str(&line("total", stopwatch.total()));
    table
}
