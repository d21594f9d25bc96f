//! The whole study: the reference, every point that is not known yet, the page.

use crate::clock::Clock;
use crate::effort::Effort;
use crate::error::StudyError;
use crate::measure::{Bench, Errors, Page};
use crate::point::{AirChange, Point};
use crate::report;
use crate::store::{self, Row, Store, hash};
use crate::summary::Summary;
use crate::sweep::{self, Group};
use crate::thumbnails;
use bake_core::atlas::AtlasError;
use bake_core::fingerprint;
use bake_core::job::{Job, JobError};
use bake_core::progress::{Progress, Silent};
use bake_core::settings::Settings;
use bake_core::solve::Mode;
use bake_formats::package::write_atomic;
use std::collections::HashSet;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// What is studied, and where the study is kept.
#[derive(Debug, Clone)]
pub struct Study {
    /// The scene file.
    pub file: PathBuf,
    /// Its settings, judged.
    pub settings: Settings,
    /// The folder of the study.
    pub folder: PathBuf,
    /// How much it may take.
    pub effort: Effort,
    /// What times are told by.
    pub clock: Clock,
}

/// Runs a study, or goes on with one; `tell` hears of every point. Writes `study.html`, `study.json`, `points.csv`,
/// the reference's pages and thumbnails. The same scene, settings and program give the same numbers, seconds aside; points
/// of another build are measured anew.
///
/// # Errors
/// An invalid scene, a file that cannot be read or written, or [`StudyError::Interrupted`]: what was measured until
/// then is kept.
pub fn run(study: &Study, progress: &dyn Progress, tell: &dyn Fn(&str)) -> Result<Summary, StudyError> {
    let job = prepare(study, progress)?;
    job.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    let reference = sweep::reference(&job.settings, &study.effort);
    let mut store = Store::open(&study.folder, subject(study, &job, &name(&reference))?)?;
    let groups = sweep::groups(&job, &study.effort);
    let mut runner = Runner { bench: Bench::new(&job, study.clock), job: &job, progress, tell };

    let points = missing(&groups, &store);
    let truth = store.reference(&reference, job.atlas.pages.len())?;
    let ahead = points.iter().map(|(_, point)| *point).chain(truth.is_none().then_some(reference));
    progress.stage("study", ahead.map(|point| runner.units(&point)).sum());
    let truth = match truth {
        Some(truth) => truth,
        None => runner.reference(&reference, &mut store)?,
    };
    for (label, point) in &points {
        runner.measure(label, point, &truth, &mut store)?;
    }
    let summary = Summary::new(&job, study, &groups, &store, &reference);
    let page = report::page(&summary, &groups, &store);
    write_atomic(&store.file("study.html"), |out| out.write_all(page.as_bytes()))?;
    let json = serde_json::to_string_pretty(&summary).expect("plain data becomes JSON");
    write_atomic(&store.file("study.json"), |out| out.write_all(json.as_bytes()))?;
    Ok(summary)
}

/// The groups of a study, with what has been measured of them so far.
///
/// # Errors
/// As [`run`].
pub fn measured(study: &Study) -> Result<(Vec<Group>, Store), StudyError> {
    let job = prepare(study, &Silent)?;
    let reference = sweep::reference(&job.settings, &study.effort);
    let store = Store::open(&study.folder, subject(study, &job, &name(&reference))?)?;
    Ok((sweep::groups(&job, &study.effort), store))
}

fn prepare(study: &Study, progress: &dyn Progress) -> Result<Job, StudyError> {
    prepare_with(study, &|settings| Settings { samples: None, ..settings }, progress)
}

/// Lays the scene out on pages of the effort, larger ones where its charts do not fit.
pub(crate) fn prepare_with(
    study: &Study,
    change: &dyn Fn(Settings) -> Settings,
    progress: &dyn Progress,
) -> Result<Job, StudyError> {
    let mut effort = study.effort.clone();
    loop {
        let settings = change(effort.pages(study.settings.clone()));
        match (Job::prepare(&study.file, settings, progress), &mut effort.page) {
            (Err(JobError::Atlas(AtlasError::TooManyCharts { .. })), Some(page))
                if *page < study.settings.page_size =>
            {
                *page *= 2;
            }
            (prepared, _) => return Ok(prepared?),
        }
    }
}

fn name(reference: &Point) -> String {
    serde_json::to_string(reference).expect("plain data becomes JSON")
}

/// What all numbers of a study have in common, hashed; `reference` names what they are compared with.
pub(crate) fn subject(study: &Study, job: &Job, reference: &str) -> Result<String, StudyError> {
    let settings = fingerprint::settings(&job.settings).map_err(StudyError::io(&study.file))?;
    Ok(hash(&[store::program(), &job.scene.blake3, &settings.to_string(), reference, study.clock.name()]))
}

/// The points that are not measured yet, each once.
fn missing(groups: &[Group], store: &Store) -> Vec<(String, Point)> {
    let all = groups.iter().flat_map(|group| &group.series).flat_map(|series| &series.points);
    let mut seen = HashSet::new();
    all.filter(|(_, point)| store.row(point).is_none() && seen.insert(store.key(point))).cloned().collect()
}

struct Runner<'a> {
    bench: Bench<'a>,
    job: &'a Job,
    progress: &'a dyn Progress,
    tell: &'a dyn Fn(&str),
}

impl Runner<'_> {
    /// What a point takes, about, in units of a sample without air: for the time left only.
    fn units(&self, point: &Point) -> u64 {
        let texels: usize = self.job.atlas.pages.iter().map(|page| page.texels.len()).sum();
        let is_foggy = !self.job.air.is_empty() && point.air != AirChange::None;
        let weight = match point.mode {
            _ if !is_foggy => 1,
            Mode::Walk => 4,
            _ => 3,
        };
        let grid =
            point.grid.filter(|_| is_foggy).map_or(0, |[cells, walks]| u64::from(cells).pow(3) * u64::from(walks) * 8);
        u64::from(point.likely_samples()) * texels as u64 * weight + grid
    }

    fn portion(&self, point: &Point) -> Portion<'_> {
        Portion {
            outer: self.progress,
            units: self.units(point),
            of_stage: AtomicU64::new(0),
            given: AtomicU64::new(0),
        }
    }

    fn reference(&mut self, point: &Point, store: &mut Store) -> Result<Vec<Page>, StudyError> {
        let portion = self.portion(point);
        let baked = self.bench.bake(point, &portion)?;
        portion.finish();
        let pages: Vec<Page> = baked.lightmap.pages.iter().map(Page::from).collect();
        let errors = Errors::between(&pages, &pages);
        store.keep_reference(point, &pages)?;
        thumbnails::write(store, &store.key(point), &baked.lightmap.pages[0], &pages[0])?;
        store.add(Row::new(store.key(point), point, &baked, 0.0, &errors))?;
        let error = 100.0 * errors.reference_error;
        (self.tell)(&format!("reference: {:.1} s, relative standard error {error:.2} %", baked.seconds));
        Ok(pages)
    }

    fn measure(&mut self, label: &str, point: &Point, truth: &[Page], store: &mut Store) -> Result<(), StudyError> {
        let portion = self.portion(point);
        let (baked, spread) = self.bench.bake_timed(point, &portion)?;
        portion.finish();
        let pages: Vec<Page> = baked.lightmap.pages.iter().map(Page::from).collect();
        let errors = Errors::between(&pages, truth);
        let key = store.key(point);
        thumbnails::write(store, &key, &baked.lightmap.pages[0], &truth[0])?;
        store.add(Row::new(key, point, &baked, spread, &errors))?;
        let [bias, rmse] = [errors.bias, errors.rmse].map(|share| 100.0 * share);
        (self.tell)(&format!("{label}: {:.2} s, bias {bias:+.2} %, RMSE {rmse:.2} %", baked.seconds));
        Ok(())
    }
}

/// A point's part of the study's progress.
struct Portion<'a> {
    outer: &'a dyn Progress,
    units: u64,
    /// Units of the stage at hand.
    of_stage: AtomicU64,
    /// Of `units`, those that were told.
    given: AtomicU64,
}

impl Portion<'_> {
    /// Tells the rest.
    fn finish(&self) {
        let given = self.given.swap(self.units, Ordering::Relaxed);
        self.outer.advance(self.units.saturating_sub(given));
    }
}

impl Progress for Portion<'_> {
    fn stage(&self, name: &str, units: u64) {
        self.of_stage.store(if name == "trace" { units } else { 0 }, Ordering::Relaxed);
    }

    fn expect(&self, units: u64) {
        if self.of_stage.load(Ordering::Relaxed) > 0 {
            self.of_stage.store(units, Ordering::Relaxed);
        }
    }

    fn advance(&self, units: u64) {
        let of_stage = self.of_stage.load(Ordering::Relaxed);
        if of_stage > 0 {
            let part = (u128::from(self.units) * u128::from(units) / u128::from(of_stage)) as u64;
            // Repeats are not counted again.
            let before = self.given.fetch_add(part, Ordering::Relaxed);
            let room = self.units.saturating_sub(before);
            self.outer.advance(part.min(room));
        }
    }

    fn is_cancelled(&self) -> bool {
        self.outer.is_cancelled()
    }
}

impl From<JobError> for StudyError {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Interrupted(error) => Self::Interrupted(error),
            error => Self::Job(error),
        }
    }
}
