//! Which settings are baked: data, derived from the scene and the effort.
//!
//! A [`Group`] is one plot with its table; its [`Series`] are the plot's lines. Points that stand in several groups are
//! measured once.

use bake_core::job::Job;
use bake_core::plan::Choice;
use bake_core::settings::{Quality, Settings};
use bake_core::solve::grid::GridSettings;
use bake_core::solve::{LightmapSettings, Mode};
use serde::Serialize;

/// How much a study may take.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// Largest width and height of the page that all must fit on; the settings' own pages when absent.
    pub page: Option<u32>,
    /// Samples per texel of the reference.
    pub reference_samples: u32,
    /// Samples per texel of the modes' lines.
    pub samples: Vec<u32>,
    /// Samples per texel where something else is varied.
    pub fixed_samples: u32,
    /// Standard errors asked for.
    pub targets: Vec<f32>,
    /// Cells along a side and walks a node of the light grid.
    pub grids: Vec<[u32; 2]>,
}

impl Effort {
    /// Minutes: one small page.
    pub fn quick() -> Self {
        Self {
            page: Some(96),
            reference_samples: 8192,
            samples: vec![8, 32, 128, 512, 2048],
            fixed_samples: 256,
            targets: vec![0.1, 0.04, 0.02],
            grids: vec![[4, 256], [8, 256], [12, 64], [12, 256], [12, 1024], [16, 256]],
        }
    }

    /// What it takes: the settings' own pages.
    pub fn thorough() -> Self {
        Self {
            page: None,
            reference_samples: 65536,
            samples: vec![8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192],
            fixed_samples: 1024,
            targets: vec![0.1, 0.04, 0.02, 0.01],
            grids: [4, 8, 12, 18, 24]
                .into_iter()
                .flat_map(|cells| [128, 512, 2048].map(|walks| [cells, walks]))
                .collect(),
        }
    }

    /// With another reference; points that it could not judge are left out.
    pub fn with_reference(mut self, samples: u32) -> Self {
        self.reference_samples = samples;
        self.samples.retain(|&point| point <= samples / 4);
        self.fixed_samples = self.fixed_samples.min(samples / 4);
        self
    }

    /// The settings with pages of this effort.
    pub fn pages(&self, mut settings: Settings) -> Settings {
        if let Some(page) = self.page {
            settings.page_size = settings.page_size.min(page);
            settings.max_pages = Some(1);
        }
        settings
    }
}

/// Where sampling ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Stop {
    /// After so many samples per texel.
    Samples(u32),
    /// At this standard error, within the range of samples of the preset that asks for it.
    Error(f32),
}

/// What is done to the air.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum AirChange {
    /// Nothing.
    AsIs,
    /// It is taken away.
    None,
    /// Scattering times a factor, extinction kept: 0 is attenuation only.
    Scattering(f64),
    /// Light scatters at most once between two surfaces.
    Once,
}

/// One way to bake.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// Solver of the air.
    pub mode: Mode,
    /// Samples.
    pub stop: Stop,
    /// Most reflections.
    pub bounces: Option<u32>,
    /// The air.
    pub air: AirChange,
    /// Cells and walks of the grid, where the mode has one.
    pub grid: Option<[u32; 2]>,
    /// Seed.
    pub seed: u32,
}

/// A line of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Points with their labels.
    pub points: Vec<(String, Point)>,
}

/// A plot with its table.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its kind.
    pub kind: Kind,
    /// The lines.
    pub series: Vec<Series>,
}

/// What a group varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Samples per texel, by mode.
    Samples,
    /// Reflections.
    Bounces,
    /// Collisions.
    Scattering,
    /// Cells and walks of the light grid.
    Grid,
    /// Standard error asked for.
    Target,
    /// Settings that are wrong on purpose.
    Control,
}

impl Kind {
    /// Heading, and what to see; for the report.
    pub fn text(self) -> [&'static str; 2] {
        match self {
            Self::Samples => [
                "Samples per texel, by mode",
                "A line that goes level has met its mode's own error: more samples do not help. Walks are what `bake reference` does.",
            ],
            Self::Bounces => ["Reflections", "What leaving out later reflections costs in error and saves in time."],
            Self::Scattering => [
                "Scattering",
                "No air at all, air that only weakens, light scattered at most once between two surfaces (these by walks), and any number of times.",
            ],
            Self::Grid => {
                ["Cells and walks of the light grid", "Error of mode `grid` by cells along a side and walks a node."]
            }
            Self::Target => [
                "Error asked for",
                "Asked: the target. Stated: what the bake says of itself, its standard error over the larger of texel and median. Measured: the relative RMSE against the reference, whose denominator falls to a hundredth of the mean, so that dark texels weigh more.",
            ],
            Self::Control => [
                "Controls: wrong on purpose",
                "These must show a bias that cannot be chance; where they do not, this report cannot be trusted.",
            ],
        }
    }
}

/// The number that tells the reference's random numbers from those of all points.
const REFERENCE_SEED: u32 = 0x7275_7468;

/// The groups of a scene.
pub fn groups(job: &Job, effort: &Effort) -> Vec<Group> {
    let base = Base::new(job);
    let mut groups = vec![base.samples(effort), base.bounces(effort)];
    if base.scatters {
        groups.extend([base.scattering(effort), base.grids(effort)]);
    } else if base.has_air {
        groups.push(base.scattering(effort));
    }
    groups.extend([base.targets(effort), base.controls(effort)]);
    groups
}

/// The bake that all are compared with.
pub fn reference(settings: &Settings, effort: &Effort) -> Point {
    Point {
        mode: Mode::Walk,
        stop: Stop::Samples(effort.reference_samples),
        bounces: settings.bounces,
        air: AirChange::AsIs,
        grid: None,
        seed: settings.seed ^ REFERENCE_SEED,
    }
}

/// What the settings and the plan choose, from which one thing at a time is varied.
struct Base {
    point: Point,
    grid: [u32; 2],
    has_air: bool,
    scatters: bool,
}

impl Base {
    fn new(job: &Job) -> Self {
        let settings = &job.settings;
        let GridSettings { cells, samples } = settings.quality.grid();
        let has_air = !job.air.is_empty();
        let mode = if has_air { Choice::derive(&job.scene, &job.air, settings).mode } else { Mode::Walk };
        let point = Point {
            mode,
            stop: Stop::Samples(0),
            bounces: settings.bounces,
            air: AirChange::AsIs,
            grid: None,
            seed: settings.seed,
        };
        Self { point, grid: [cells, samples], has_air, scatters: has_air && job.air.scatters() }
    }

    fn with_mode(&self, mode: Mode, stop: Stop) -> Point {
        Point { mode, stop, grid: (mode == Mode::Grid).then_some(self.grid), ..self.point }
    }

    fn fixed(&self, effort: &Effort) -> Point {
        self.with_mode(self.point.mode, Stop::Samples(effort.fixed_samples))
    }

    fn samples(&self, effort: &Effort) -> Group {
        let line = |name: &str, mode| {
            let point =
                |&samples: &u32| (format!("{name}, {samples} samples"), self.with_mode(mode, Stop::Samples(samples)));
            Series { name: name.into(), points: effort.samples.iter().map(point).collect() }
        };
        let series = if self.scatters {
            [Mode::Walk, Mode::Grid, Mode::Tables].map(|mode| line(mode.name(), mode)).to_vec()
        } else {
            vec![line("paths", Mode::Walk)]
        };
        Group { kind: Kind::Samples, series }
    }

    fn bounces(&self, effort: &Effort) -> Group {
        const COUNTS: [u32; 7] = [0, 1, 2, 3, 4, 6, 10];
        let most = self.point.bounces.unwrap_or(u32::MAX);
        let capped = COUNTS.into_iter().filter(|&count| count < most).map(Some);
        let label = |bounces: Option<u32>| match bounces {
            None => "any number of reflections".into(),
            Some(1) => "1 reflection".into(),
            Some(count) => format!("{count} reflections"),
        };
        let points = capped.chain([self.point.bounces]);
        let points = points.map(|bounces| (label(bounces), Point { bounces, ..self.fixed(effort) })).collect();
        Group { kind: Kind::Bounces, series: vec![Series { name: self.point.mode.name().into(), points }] }
    }

    fn scattering(&self, effort: &Effort) -> Group {
        let line = |name: &str, air| {
            let point = |&samples: &u32| {
                let mode = if air == AirChange::AsIs { self.point.mode } else { Mode::Walk };
                (format!("{name}, {samples} samples"), Point { air, ..self.with_mode(mode, Stop::Samples(samples)) })
            };
            Series { name: name.into(), points: effort.samples.iter().map(point).collect() }
        };
        let mut series = vec![line("no air", AirChange::None), line("attenuation only", AirChange::Scattering(0.0))];
        if self.scatters {
            series.extend([line("scattered once", AirChange::Once), line("all orders", AirChange::AsIs)]);
        }
        Group { kind: Kind::Scattering, series }
    }

    fn grids(&self, effort: &Effort) -> Group {
        let point = |&[cells, walks]: &[u32; 2]| {
            let point = self.with_mode(Mode::Grid, Stop::Samples(effort.fixed_samples));
            (format!("{cells} cells, {walks} walks"), Point { grid: Some([cells, walks]), ..point })
        };
        let points = effort.grids.iter().map(point).collect();
        Group { kind: Kind::Grid, series: vec![Series { name: "grid".into(), points }] }
    }

    fn targets(&self, effort: &Effort) -> Group {
        let point =
            |&target: &f32| (format!("{} %", 100.0 * target), self.with_mode(self.point.mode, Stop::Error(target)));
        let points = effort.targets.iter().map(point).collect();
        Group { kind: Kind::Target, series: vec![Series { name: self.point.mode.name().into(), points }] }
    }

    fn controls(&self, effort: &Effort) -> Group {
        let fixed = Point { mode: Mode::Walk, grid: None, ..self.fixed(effort) };
        let mut points = vec![("one reflection".to_owned(), Point { bounces: Some(1), ..fixed })];
        if self.scatters {
            points.push(("a fifth less scattering".into(), Point { air: AirChange::Scattering(0.8), ..fixed }));
        }
        Group { kind: Kind::Control, series: vec![Series { name: "wrong".into(), points }] }
    }
}

impl Point {
    /// What the solver is told.
    pub fn solver_settings(&self, settings: &Settings) -> LightmapSettings {
        let mut solver = settings.lightmap_settings();
        match self.stop {
            Stop::Samples(samples) => (solver.min_samples, solver.max_samples) = (samples, samples),
            Stop::Error(target) => {
                solver.target_error = target;
                (solver.min_samples, solver.max_samples) = preset(target).sample_range();
            }
        }
        (solver.bounces, solver.seed, solver.mode) = (self.bounces, self.seed, self.mode);
        solver.multiple = self.air != AirChange::Once;
        if let Some([cells, samples]) = self.grid {
            solver.grid = GridSettings { cells, samples };
        }
        solver
    }

    /// Samples per texel that it will take, about.
    pub fn likely_samples(&self) -> u32 {
        match self.stop {
            Stop::Samples(samples) => samples,
            Stop::Error(target) => {
                let (floor, cap) = preset(target).sample_range();
                (target.powi(-2) as u32).clamp(floor, cap)
            }
        }
    }
}

/// The coarsest preset that is at least as exact.
fn preset(target: f32) -> Quality {
    let fitting =
        Quality::ALL.into_iter().map(|(_, quality)| quality).find(|quality| quality.relative_error() <= target);
    fitting.unwrap_or(Quality::Final)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_takes_the_range_of_the_preset_that_asks_for_it() {
        assert_eq!(
            [0.2, 0.1, 0.05, 0.04, 0.01, 0.001].map(preset),
            [Quality::Preview, Quality::Preview, Quality::Medium, Quality::Medium, Quality::Final, Quality::Final]
        );
    }

    #[test]
    fn no_point_draws_the_references_numbers() {
        let settings = Settings::default();
        assert_ne!(reference(&settings, &Effort::quick()).seed, settings.seed);
    }
}
