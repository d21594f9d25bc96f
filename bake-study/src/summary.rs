//! What a study found, in a page of numbers: for people on standard output, for machines in `study.json`.

use crate::measure::Errors;
use crate::pareto;
use crate::point::{AirChange, Point};
use crate::reach::Reach;
use crate::store::{Row, Store};
use crate::study::Study;
use crate::sweep::{Group, Kind, Series};
use bake_core::job::Job;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// The errors for which the cheapest setting is named, shares of one.
pub const LEVELS: [f64; 4] = [0.05, 0.02, 0.01, 0.005];

/// What a study found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// The air in words; none where empty.
    pub air: Vec<String>,
    /// Version of the program.
    pub version: String,
    /// The processor.
    pub processor: String,
    /// Threads used.
    pub threads: usize,
    /// What times are told by: `wall` or `processor`, seconds of all threads together.
    pub clock: String,
    /// Seed.
    pub seed: u32,
    /// Width and height of each page.
    pub pages: Vec<[u32; 2]>,
    /// Texels compared.
    pub texels: usize,
    /// The reference.
    pub reference: Reference,
    /// The lines of samples per texel: one for each mode.
    pub modes: Vec<ModeSummary>,
    /// For each of [`LEVELS`] the cheapest setting measured.
    pub cheapest: Vec<Option<Cheapest>>,
    /// The settings that are wrong on purpose; none where nothing is reflected and nothing scatters.
    pub controls: Vec<Control>,
}

/// The reference's own worth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Samples per texel.
    pub samples: u32,
    /// Seconds.
    pub seconds: f64,
    /// Relative standard error, root mean square over texels.
    pub error: f64,
    /// Relative standard error of the mean over all texels.
    pub mean_error: f64,
}

/// One way to solve the air, over samples per texel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModeSummary {
    /// Its name.
    pub name: String,
    /// When it comes down to each of [`LEVELS`].
    pub seconds_to: Vec<Reach>,
    /// With the most samples: seconds and errors.
    pub seconds: f64,
    /// See `seconds`.
    pub errors: Errors,
    /// Seconds over those of the same number of samples without air, less one: at the most samples.
    pub overhead: Option<f64>,
    /// The same at the fewest samples, where what is prepared weighs most.
    pub overhead_at_fewest: Option<f64>,
}

/// The cheapest setting that reaches a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cheapest {
    /// What it is.
    pub setting: String,
    /// What it took.
    pub seconds: f64,
    /// What it reached.
    pub rmse: f64,
}

/// A setting that is wrong on purpose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Control {
    /// What is wrong.
    pub setting: String,
    /// What was measured of it.
    pub bias: f64,
    /// Its standard error.
    pub bias_error: f64,
    /// Whether the bias was told from chance, as it must be.
    pub is_caught: bool,
}

impl Summary {
    /// Gathers it from the measured points.
    pub fn new(job: &Job, study: &Study, groups: &[Group], store: &Store, reference: &Point) -> Self {
        let of = |kind| groups.iter().filter(move |group| group.kind == kind).flat_map(|group| &group.series);
        let bare = of(Kind::Scattering).find(|series| series.name == "no air");
        let truth = store.row(reference).expect("the reference was measured");
        // Where no reflection at all is missed, one too few is not wrong.
        let without = of(Kind::Bounces).flat_map(|series| &series.points).find(|(_, point)| point.bounces == Some(0));
        let reflects = without.and_then(|(_, point)| store.row(point)).is_none_or(|row| row.errors().is_biased());
        let controls = of(Kind::Control).flat_map(|series| &series.points);
        let controls = controls.filter(|(_, point)| reflects || point.air != AirChange::AsIs);
        let controls = controls.filter_map(|(setting, point)| {
            let errors = store.row(point)?.errors();
            let Errors { bias, bias_error, .. } = errors;
            Some(Control { setting: setting.clone(), bias, bias_error, is_caught: errors.is_biased() })
        });
        Self {
            scene: job.scene.name.clone(),
            air: job.air.summaries().iter().map(air_text).collect(),
            version: env!("CARGO_PKG_VERSION").into(),
            processor: processor(),
            threads: rayon::current_num_threads(),
            clock: study.clock.name().into(),
            seed: job.settings.seed,
            pages: job.atlas.pages.iter().map(|page| [page.width, page.height]).collect(),
            texels: truth.texels,
            reference: Reference {
                samples: study.effort.reference_samples,
                seconds: truth.seconds,
                error: truth.reference_error,
                mean_error: truth.bias_error / 2f64.sqrt(),
            },
            modes: of(Kind::Samples).filter_map(|series| ModeSummary::new(series, bare, store)).collect(),
            cheapest: LEVELS.map(|level| cheapest(groups, store, level)).into(),
            controls: controls.collect(),
        }
    }

    /// Whether every setting that is wrong on purpose was told from an honest one.
    pub fn controls_hold(&self) -> bool {
        self.controls.iter().all(|control| control.is_caught)
    }

    /// For people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| writeln!(text, "{name:<10} {value}").expect("a string takes text");
        let Reference { samples, seconds, error, mean_error } = self.reference;
        let plural = if self.pages.len() == 1 { "" } else { "s" };
        line("scene", format!("{}, {} texels on {} page{plural}", self.scene, self.texels, self.pages.len()));
        line("times", format!("{} seconds on {}, {} threads", self.clock, self.processor, self.threads));
        self.air.iter().for_each(|air| line("air", air.clone()));
        line(
            "reference",
            format!(
                "{samples} samples, {seconds:.1} s, standard error {} a texel, {} of the mean",
                percent(error),
                percent(mean_error)
            ),
        );
        for (level, cheapest) in LEVELS.iter().zip(&self.cheapest) {
            let found = cheapest
                .as_ref()
                .map(|found| format!("{:.2} s: {} ({})", found.seconds, found.setting, percent(found.rmse)));
            line(&format!("{} %", 100.0 * level), found.unwrap_or_else(|| "not reached".into()));
        }
        self.modes.iter().for_each(|mode| line(&mode.name, mode.text()));
        if self.controls.is_empty() {
            line("control", "none: nothing is reflected and nothing scatters that could be left out".into());
        }
        for control in &self.controls {
            let verdict =
                if control.is_caught { "caught, as it must be" } else { "NOT CAUGHT: do not trust this study" };
            line(
                "control",
                format!(
                    "{}: bias {:+.2} ± {:.2} %: {verdict}",
                    control.setting,
                    100.0 * control.bias,
                    100.0 * control.bias_error
                ),
            );
        }
        text
    }
}

impl ModeSummary {
    fn new(series: &Series, bare: Option<&Series>, store: &Store) -> Option<Self> {
        let rows: Vec<&Row> = series.points.iter().filter_map(|(_, point)| store.row(point)).collect();
        let overhead = |row: &Row| {
            let same =
                bare?.points.iter().filter_map(|(_, point)| store.row(point)).find(|b| b.samples == row.samples)?;
            Some(row.seconds / same.seconds - 1.0)
        };
        let most = rows.last()?;
        Some(Self {
            name: series.name.clone(),
            seconds_to: LEVELS.iter().filter_map(|&level| Reach::new(&rows, level)).collect(),
            seconds: most.seconds,
            errors: most.errors(),
            overhead: overhead(most),
            overhead_at_fewest: overhead(rows[0]),
        })
    }

    fn text(&self) -> String {
        let to = LEVELS.iter().zip(&self.seconds_to).map(|(level, reach)| format!("{} %: {reach}", 100.0 * level));
        let mut text = format!(
            "seconds to {}; floor {}, bias {:+.2} %",
            to.collect::<Vec<_>>().join(", "),
            floor(&self.errors),
            100.0 * self.errors.bias
        );
        if let (Some(most), Some(fewest)) = (self.overhead, self.overhead_at_fewest) {
            let _ = write!(
                text,
                "; {:+.0} % over the bake without air ({:+.0} % at fewest samples)",
                100.0 * most,
                100.0 * fewest
            );
        }
        text
    }
}

/// The floor, or that it cannot be told from chance.
pub fn floor(errors: &Errors) -> String {
    if errors.has_floor() { percent(errors.floor) } else { format!("below {}", percent(errors.least_floor)) }
}

/// A share in per cent, with as many digits as it bears.
pub fn percent(share: f64) -> String {
    format!("{:.*} %", if share.abs() < 0.01 { 3 } else { 2 }, 100.0 * share)
}

/// Of all settings that are not wrong on purpose.
fn cheapest(groups: &[Group], store: &Store, level: f64) -> Option<Cheapest> {
    let honest = groups.iter().filter(|group| group.kind != Kind::Control).flat_map(|group| &group.series);
    let rows: Vec<(&String, &Row)> = honest
        .flat_map(|series| &series.points)
        .filter_map(|(label, point)| Some((label, store.row(point)?)))
        .collect();
    let points: Vec<(f64, f64)> = rows.iter().map(|(_, row)| (row.seconds, row.rmse)).collect();
    let (label, row) = rows[pareto::cheapest(&points, level)?];
    Some(Cheapest { setting: label.clone(), seconds: row.seconds, rmse: row.rmse })
}

fn air_text(medium: &bake_core::air::Summary) -> String {
    let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
    let (depth, albedo) = (largest(medium.optical_depth), largest(medium.albedo));
    format!(
        "{}: {}, optical depth up to {depth:.3}, albedo {albedo:.3}, {} (g {:.2})",
        medium.name, medium.density, medium.phase, medium.g
    )
}

/// Its name, where the system tells.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or(std::env::consts::ARCH.into(), |(_, name)| name.trim().into())
}
