//! What a bake measured of itself: a table for people, JSON for machines, and the package's `NAME.run.json`.

use crate::units;
use bake_core::explain::{Change, Explanation};
use bake_core::plan::Effect;
use bake_core::solve::buffers::{PageBuffers, Validity};
use bake_core::solve::points::LatticeReport;
use bake_core::solve::{LUMINANCE, Lightmap, PageReport};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

/// Seconds of one stage.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Name.
    pub name: &'static str,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// The stages whose rays are counted.
const TRACING: [&str; 5] = ["light in the air", "trace", "vacuum", "probes", "fog volume"];

/// Takes the time of a command's stages.
#[derive(Debug, Default)]
pub struct Stopwatch(Vec<Stage>);

impl Stopwatch {
    /// Runs a stage and keeps its time.
    pub fn time<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(name, start.elapsed().as_secs_f64());
        result
    }

    /// Keeps the time of a stage that was taken elsewhere.
    pub fn add(&mut self, name: &'static str, seconds: f64) {
        self.0.push(Stage { name, seconds });
    }
}

/// Everything measured about one bake; the numbers are in base units.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// The package's manifest.
    pub package: PathBuf,
    /// Stages in their order.
    pub stages: Vec<Stage>,
    /// Their sum.
    pub seconds: f64,
    /// Rays that asked for the nearest surface.
    pub rays: u64,
    /// Rays that asked whether light arrives.
    pub shadow_rays: u64,
    /// Both, by the seconds of tracing.
    pub rays_per_second: f64,
    /// Paths cut because nothing absorbed them.
    pub cut_paths: u64,
    /// Largest resident memory, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// Threads used.
    pub threads: usize,
    /// The machine.
    pub machine: Machine,
    /// Standard error asked for, as a share of the page's median.
    pub target_error: f32,
    /// The largest that a page reached.
    pub reached_error: f32,
    /// Texels with a surface behind them.
    pub texels: u64,
    /// Of those, buried in other geometry and filled from their neighbours, or from the nearest of their object.
    pub filled_texels: u64,
    /// Of those, without any value.
    pub unbaked_texels: u64,
    /// Of those, texels of objects that got no light at all: what ends a bake with code 3.
    pub lightless_texels: u64,
    /// Page by page.
    pub pages: Vec<PageMeasured>,
    /// The probes.
    pub probes: Option<LatticeReport>,
    /// The fog volume.
    pub fog_volume: Option<LatticeReport>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// What the plan left out, with the bound on what that changes.
    pub left_out: Vec<Effect>,
    /// What each effect cost and changed, where that was asked for.
    pub explained: Option<Explained>,
}

/// What each effect cost and changed.
#[derive(Debug, Clone, Serialize)]
pub struct Explained {
    /// Seconds by effect; those of tracing are divided by the shares of short bakes.
    pub seconds: Vec<Stage>,
    /// Mean and largest share of each term in a texel's light.
    pub terms: Vec<TermShare>,
    /// Texels of the short bakes.
    pub texels: usize,
    /// What each effect changed.
    pub changes: Vec<Change>,
}

/// Share of a term in the light of texels.
#[derive(Debug, Clone, Serialize)]
pub struct TermShare {
    /// The term.
    pub term: &'static str,
    /// Of all light together.
    pub mean: f64,
    /// In the texel that has most of it.
    pub max: f64,
}

/// One page.
#[derive(Debug, Clone, Serialize)]
pub struct PageMeasured {
    /// Samples per texel.
    pub samples_per_texel: u32,
    /// Standard error, as a share of the median, without the noisiest hundredth of the texels.
    pub error: f32,
    /// Standard error of that hundredth.
    pub noisiest: f32,
    /// Median luminance of the irradiance.
    pub median_lux: f32,
    /// Texels that were baked.
    pub good_texels: u32,
    /// Texels buried in other geometry.
    pub buried_texels: u32,
}

/// Where it ran.
#[derive(Debug, Clone, Serialize)]
pub struct Machine {
    os: &'static str,
    architecture: &'static str,
    processors: usize,
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Self { os: std::env::consts::OS, architecture: std::env::consts::ARCH, processors }
    }
}

impl From<&PageReport> for PageMeasured {
    fn from(report: &PageReport) -> Self {
        Self {
            samples_per_texel: report.samples,
            error: report.error,
            noisiest: report.noisiest,
            median_lux: report.median,
            good_texels: report.good_texels,
            buried_texels: report.buried_texels,
        }
    }
}

impl Measured {
    /// Gathers what the solver and the stopwatch know; the rest is for the caller to fill in.
    pub fn new(stopwatch: Stopwatch, lightmap: &Lightmap, target_error: f32) -> Self {
        let stages = stopwatch.0;
        let tracing: f64 = stages.iter().filter(|stage| TRACING.contains(&stage.name)).map(|stage| stage.seconds).sum();
        let good: u64 = lightmap.reports.iter().map(|page| u64::from(page.good_texels)).sum();
        let buried: u64 = lightmap.reports.iter().map(|page| u64::from(page.buried_texels)).sum();
        Self {
            package: PathBuf::new(),
            seconds: stages.iter().map(|stage| stage.seconds).sum(),
            stages,
            rays: lightmap.rays,
            shadow_rays: lightmap.shadow_rays,
            rays_per_second: (lightmap.rays + lightmap.shadow_rays) as f64 / tracing.max(1e-9),
            cut_paths: lightmap.cut_paths,
            peak_memory_bytes: peak_memory(),
            threads: rayon::current_num_threads(),
            machine: Machine::here(),
            target_error,
            reached_error: lightmap.reports.iter().map(|page| page.error).fold(0.0, f32::max),
            texels: good + buried,
            filled_texels: buried,
            unbaked_texels: 0,
            lightless_texels: 0,
            pages: lightmap.reports.iter().map(PageMeasured::from).collect(),
            probes: None,
            fog_volume: None,
            warnings: Vec::new(),
            left_out: Vec::new(),
            explained: None,
        }
    }

    /// Divides the seconds of tracing by the shares of an explanation, and adds what the pages tell of the terms.
    pub fn explain(&self, explanation: Explanation, pages: &[PageBuffers]) -> Explained {
        let spent = |names: &[&str]| -> f64 {
            self.stages.iter().filter(|stage| names.contains(&stage.name)).map(|stage| stage.seconds).sum()
        };
        let trace = spent(&["trace"]);
        let traced = explanation.shares.iter().map(|part| (part.what, part.share * trace));
        let others = ["light in the air", "vacuum", "probes", "fog volume", "post"].map(|name| (name, spent(&[name])));
        let seconds = traced.chain(others.into_iter().filter(|(_, seconds)| *seconds > 0.0));
        Explained {
            seconds: seconds.map(|(name, seconds)| Stage { name, seconds }).collect(),
            terms: term_shares(pages),
            texels: explanation.texels,
            changes: explanation.changes,
        }
    }

    /// For people.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let width = self.stages.iter().map(|stage| stage.name.len()).fold(12, usize::max);
        let mut line =
            |name: &str, value: String| writeln!(text, "{name:<width$} {value}").expect("a string takes text");
        for stage in &self.stages {
            let share = 100.0 * stage.seconds / self.seconds.max(1e-9);
            line(stage.name, format!("{:>9.2} s {share:>5.1} %", stage.seconds));
        }
        line("total", format!("{:>9.2} s on {} threads", self.seconds, self.threads));
        let rays = self.rays + self.shadow_rays;
        line("rays", format!("{} at {:.2} Mrays/s", units::count(rays as f64), self.rays_per_second / 1e6));
        if let Some(bytes) = self.peak_memory_bytes {
            line("peak memory", units::bytes(bytes));
        }
        let samples = self.pages.iter().map(|page| page.samples_per_texel);
        let (least, most) = (samples.clone().min().unwrap_or(0), samples.max().unwrap_or(0));
        let samples = if least == most { most.to_string() } else { format!("{least} to {most}") };
        line("error", format!("{:.2} % of the median with {samples} samples per texel", 100.0 * self.reached_error));
        let pages = self.pages.len();
        line("texels", format!("{} on {pages} page{}", self.texels, if pages == 1 { "" } else { "s" }));
        if self.filled_texels > 0 {
            line("", format!("{} buried in other geometry, filled from their neighbours", self.filled_texels));
        }
        if self.unbaked_texels > 0 {
            line("", format!("{} inside other geometry, with nothing to be filled from", self.unbaked_texels));
        }
        for (name, report) in [("probes", &self.probes), ("cells", &self.fog_volume)] {
            if let Some(LatticeReport { points, invalid_points, moved_points, samples, error, .. }) = report {
                let error = 100.0 * error;
                line(name, format!("{points}, error {error:.2} % of the median with {samples} samples each"));
                if invalid_points + moved_points > 0 {
                    line("", format!("{moved_points} moved into free air, {invalid_points} without any in their cell"));
                }
            }
        }
        if !self.warnings.is_empty() {
            line("warnings", self.warnings.len().to_string());
        }
        line("package", self.package.display().to_string());
        text
    }
}

/// Shares of the terms over all texels that were baked.
fn term_shares(pages: &[PageBuffers]) -> Vec<TermShare> {
    let Some(first) = pages.first() else { return Vec::new() };
    let of = |index: usize| {
        let (mut sum, mut total, mut max) = (0.0, 0.0, 0.0f64);
        for page in pages {
            for texel in (0..page.validity.len()).filter(|&texel| page.validity[texel] == Validity::Good) {
                let light = [page.terms[index].irradiance[texel], page.total(texel)];
                let [part, all] = light.map(|light| f64::from(LUMINANCE.dot(light)));
                sum += part;
                total += all;
                max = if all > 0.0 { max.max(part / all) } else { max };
            }
        }
        let mean = if total > 0.0 { sum / total } else { 0.0 };
        TermShare { term: first.terms[index].term.name(), mean, max }
    };
    (0..first.terms.len()).map(of).collect()
}

/// Largest resident memory of this process so far, bytes; `None` where the system does not say.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A process holds at least what it has just written, and less than a terabyte.
    #[test]
    #[cfg(target_os = "linux")]
    fn peak_memory_sees_what_was_touched() {
        let before = peak_memory().expect("Linux tells");
        let block = std::hint::black_box(vec![1u8; 64 << 20]);
        let after = peak_memory().expect("Linux tells");
        assert!(after >= block.len() as u64 && after >= before && after < 1 << 40, "{before} then {after}");
    }
}
