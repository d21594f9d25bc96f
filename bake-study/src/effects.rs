//! The plan's choice of effects checked by experiment: each effect is left out, and what that changes is compared with
//! the bound that the plan states, and with the seconds that it saves.
//!
//! The quantity is the plan's own: mean over lightmapped texels of |E − E'| over the median texel irradiance, in
//! luminance. Walks of the same seed give E and E': what both draw alike cancels, so that changes far below the noise can be
//! told. Whatever noise is left, E[|δ + noise|] lies between |δ| and |δ| + E[|noise|], so that the measured mean M tells the
//! true change to lie between M − chance and M, where chance = mean(sqrt(2/π) (σ + σ')) over the median: the most that
//! noise of these deviations makes, however the two go together.

use crate::error::StudyError;
use crate::measure::{Baked, Page};
use crate::report;
use crate::store;
use crate::study::{Study, prepare_with};
use bake_core::job::Job;
use bake_core::plan::{Effect, Plan, effects::is_on};
use bake_core::progress::{Interrupted, Progress};
use bake_core::settings::{self, EffectName, Settings};
use bake_core::solve::Solver;
use bake_core::trace::Tracer;
use bake_formats::metrics::luminance;
use bake_formats::package::write_atomic;
use glam::Vec3;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// What leaving out one effect does; a line of `effects.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Left {
    /// Hash of everything that the numbers depend on.
    pub key: String,
    /// Name of the effect.
    pub effect: String,
    /// Whether the plan simulates it.
    pub planned: bool,
    /// The plan's reason.
    pub why: String,
    /// The most that leaving it out changes, says the plan; infinite where it knows no bound.
    pub bound: f64,
    /// The change lies above this, a share of the median,
    pub at_least: f64,
    /// and below this.
    pub at_most: f64,
    /// Seconds with everything.
    pub seconds_with: f64,
    /// Seconds without this effect.
    pub seconds_without: f64,
}

/// How a bound stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The change lies below it.
    Holds,
    /// The change may lie below or above.
    Open,
    /// The change lies above it.
    Broken,
}

impl Left {
    /// How the bound stands.
    pub fn verdict(&self) -> Verdict {
        match self {
            _ if self.at_most <= self.bound => Verdict::Holds,
            _ if self.at_least > self.bound => Verdict::Broken,
            _ => Verdict::Open,
        }
    }

    /// For people.
    pub fn text(&self) -> String {
        let [bound, least, most] =
            [self.bound, self.at_least, self.at_most].map(|share| format!("{:.3} %", 100.0 * share));
        let planned = if self.planned { "on" } else { "left out" };
        let verdict = self.verdict().name();
        let (with, without) = (self.seconds_with, self.seconds_without);
        format!(
            "{:<14} {planned:<8} bound {bound:>12}  change {least:>9} to {most:>9}  {verdict:<7} {with:.2} s, without {without:.2} s",
            self.effect
        )
    }
}

impl Verdict {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Open => "open",
            Self::Broken => "BROKEN",
        }
    }
}

/// Leaves out every effect that the scene has, one at a time, or goes on with it; writes `effects.html` and `effects.csv`, a line
/// as soon as it is known.
///
/// # Errors
/// As a study.
pub fn run(study: &Study, progress: &dyn Progress, tell: &dyn Fn(&str)) -> Result<Vec<Left>, StudyError> {
    let samples = Some(study.effort.reference_samples / 4);
    let change = |settings| Settings { samples, mode: settings::Mode::Walk, ..settings };
    let job = prepare_with(study, &change, progress)?;
    std::fs::create_dir_all(&study.folder).map_err(StudyError::io(&study.folder))?;
    let key = crate::study::subject(study, &job, "effects")?;
    let table = study.folder.join("effects.csv");
    let experiment = Experiment { tracer: Tracer::new(&job.scene), job: &job, study, progress };
    let planned = experiment.plan(&|_| None)?;
    let mut all = known_before(&table, &key)?;
    let with = experiment.with_all(&key, all.first())?;
    for &(name, effect) in &EffectName::ALL {
        let Some(known) = planned.effects.iter().find(|known| known.name == name && known.bound > 0.0) else {
            continue;
        };
        if all.iter().any(|left| left.effect == name) {
            continue;
        }
        let without = experiment.bake(&experiment.plan(&|other| Some(other != effect))?)?;
        let left = left(&key, known, is_on(&planned.effects, effect), &with, &without.into());
        tell(&left.text());
        all.push(left);
        write_atomic(&table, |out| out.write_all(&csv(&all)))?;
    }
    let page = page(&job.scene.name, study.effort.reference_samples / 4, &all);
    write_atomic(&study.folder.join("effects.html"), |out| out.write_all(page.as_bytes()))?;
    Ok(all)
}

/// Lines that an earlier run of the same experiment left.
fn known_before(table: &Path, key: &str) -> Result<Vec<Left>, StudyError> {
    if !table.exists() {
        return Ok(Vec::new());
    }
    let text = std::fs::read_to_string(table).map_err(StudyError::io(table))?;
    let lines = csv::Reader::from_reader(text.as_bytes()).into_deserialize().collect::<Result<Vec<Left>, _>>();
    let lines = lines.map_err(|error| StudyError::Points { path: table.to_owned(), reason: error.to_string() })?;
    Ok(lines.into_iter().filter(|left| left.key == key).collect())
}

/// What is compared of a bake.
struct Measured {
    pages: Vec<Page>,
    seconds: f64,
}

impl From<Baked> for Measured {
    fn from(baked: Baked) -> Self {
        Self { pages: baked.lightmap.pages.iter().map(Page::from).collect(), seconds: baked.seconds }
    }
}

struct Experiment<'a> {
    tracer: Tracer<'a>,
    job: &'a Job,
    study: &'a Study,
    progress: &'a dyn Progress,
}

impl Experiment<'_> {
    /// The plan with effects forced as `force` says.
    fn plan(&self, force: &dyn Fn(EffectName) -> Option<bool>) -> Result<Plan, StudyError> {
        let force_effect = EffectName::ALL.iter().filter_map(|&(_, effect)| Some((effect, force(effect)?))).collect();
        let settings = Settings { force_effect, ..self.job.settings.clone() };
        Ok(Plan::derive(&self.tracer, &self.job.air, &settings, &self.job.atlas, 1)?)
    }

    /// The bake with every effect: kept beside the table, from where a later run takes it.
    fn with_all(&self, key: &str, known: Option<&Left>) -> Result<Measured, StudyError> {
        let path = |page: usize| self.study.folder.join(format!("effects-{key}.{page:02}.exr"));
        let paths: Vec<PathBuf> = (0..self.job.atlas.pages.len()).map(path).collect();
        if let Some(left) = known.filter(|_| paths.iter().all(|path| path.exists())) {
            let pages = paths.iter().map(|path| store::read_page(path)).collect::<Result<_, _>>()?;
            return Ok(Measured { pages, seconds: left.seconds_with });
        }
        let measured = Measured::from(self.bake(&self.plan(&|_| Some(true))?)?);
        paths.iter().zip(&measured.pages).try_for_each(|(path, page)| store::write_page(path, page))?;
        Ok(measured)
    }

    fn bake(&self, plan: &Plan) -> Result<Baked, Interrupted> {
        let start = self.study.clock.start();
        let solver = Solver::prepare(&self.tracer, &plan.simulated.media, &plan.solver, self.progress)?;
        let prepare_seconds = start.seconds();
        let lightmap = solver.lightmap(&self.job.atlas, self.progress)?;
        Ok(Baked { lightmap, prepare_seconds, seconds: start.seconds() })
    }
}

fn left(key: &str, effect: &Effect, planned: bool, with: &Measured, without: &Measured) -> Left {
    let (at_least, at_most) = change(&with.pages, &without.pages);
    Left {
        key: key.into(),
        effect: effect.name.into(),
        planned,
        why: effect.why.clone(),
        bound: effect.bound,
        at_least,
        at_most,
        seconds_with: with.seconds,
        seconds_without: without.seconds,
    }
}

/// Between what the mean change lies, as a share of the median of `with`.
fn change(with: &[Page], without: &[Page]) -> (f64, f64) {
    let (mut levels, mut changes, mut chances) = (Vec::new(), 0.0, 0.0);
    for (a, b) in with.iter().zip(without) {
        for at in (0..a.valid.len()).filter(|&at| a.valid[at] && b.valid[at]) {
            levels.push(luminance(a.total[at]));
            changes += luminance((a.total[at] - b.total[at]).abs());
            let deviation = |page: &Page| page.variance[at].max(Vec3::ZERO).map(f32::sqrt);
            chances += (2.0 / PI).sqrt() * luminance(deviation(a) + deviation(b));
        }
    }
    levels.sort_by(f64::total_cmp);
    let median = levels.get(levels.len() / 2).copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let [change, chance] = [changes, chances].map(|sum| sum / (levels.len().max(1) as f64 * median));
    ((change - chance).max(0.0), change)
}

fn csv(all: &[Left]) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    all.iter().for_each(|left| writer.serialize(left).expect("memory takes a line"));
    writer.into_inner().expect("memory takes all")
}

/// For people, all of them.
pub fn text(all: &[Left]) -> String {
    let mut text = String::new();
    all.iter().for_each(|left| writeln!(text, "{}", left.text()).expect("a string takes text"));
    text
}

fn page(scene: &str, samples: u32, all: &[Left]) -> String {
    report::frame(
        &format!("{scene}: effects left out"),
        html! {
            p {
                "Each effect was left out of a bake with all others. Change: mean over texels of |E − E'| over the median "
                "texel irradiance, in luminance, between the two ends that noise leaves; walks, " (samples) " samples a texel. "
                "The plan's bound must not lie below."
            }
            table {
                tr { th { "effect" } th { "plan" } th.n { "bound" } th.n { "change" } th { "bound" } th.n { "seconds with" } th.n { "without" } th { "why" } }
                @for left in all { (row(left)) }
            }
        },
    )
}

fn row(left: &Left) -> Markup {
    let [bound, least, most] = [left.bound, left.at_least, left.at_most].map(|share| format!("{:.3} %", 100.0 * share));
    html! {
        tr {
            td { (left.effect) }
            td { @if left.planned { "on" } @else { "left out" } }
            td.n { (bound) }
            td.n { (least) " to " (most) }
            td class=(if left.verdict() == Verdict::Broken { "bad" } else { "" }) { (left.verdict().name()) }
            td.n { (format!("{:.2}", left.seconds_with)) }
            td.n { (format!("{:.2}", left.seconds_without)) }
            td { (left.why) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(level: f32, deviation: f32) -> Page {
        let noisy = |i: usize| Vec3::splat(level + if i.is_multiple_of(2) { deviation } else { -deviation });
        let variance = vec![Vec3::splat(deviation * deviation); 100];
        Page { width: 100, height: 1, total: (0..100).map(noisy).collect(), variance, valid: vec![true; 100] }
    }

    #[test]
    fn a_change_of_known_size_lies_between_its_ends_with_and_without_noise() {
        let (least, most) = change(&[page(10.0, 0.0)], &[page(9.0, 0.0)]);
        assert!((least - 0.1).abs() < 1e-6 && (most - 0.1).abs() < 1e-6, "{least} {most}");
        let (least, most) = change(&[page(10.0, 0.0)], &[page(9.0, 0.3)]);
        assert!(least < 0.1 && most >= 0.0999, "{least} {most}");
    }

    #[test]
    fn a_bound_that_is_too_low_is_broken_and_noise_leaves_it_open() {
        let with_bound = |bound| {
            let (at_least, at_most) = (0.02, 0.03);
            let [key, effect, why] = std::array::from_fn(|_| String::new());
            Left { key, effect, planned: true, why, bound, at_least, at_most, seconds_with: 1.0, seconds_without: 1.0 }
                .verdict()
        };
        assert_eq!([0.01, 0.025, 0.04].map(with_bound), [Verdict::Broken, Verdict::Open, Verdict::Holds]);
    }
}
