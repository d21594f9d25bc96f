//! Light on texels: path tracing from the surface points of every texel until the page's error is small enough.
//!
//! A texel's samples are split over [`REPLICATES`] independently scrambled sequences; the spread of their means gives
//! the standard error. Rounds add samples to every texel of a page until the target or the cap is reached ([`rounds`]).
//! Results depend on scene, atlas, settings and seed alone, never on threads; under a deadline on the machine too.

mod air;
pub mod buffers;
#[cfg(feature = "media")]
mod control;
pub mod emitters;
#[cfg(feature = "media")]
pub mod grid;
pub mod grid_size;
#[cfg(not(feature = "media"))]
pub use grid_size as grid;
#[cfg(feature = "media")]
mod in_air;
#[cfg(feature = "media")]
pub mod kept;
pub mod kept_size;
pub mod lattice;
pub mod media;
mod noise;
mod octahedron;
pub mod path;
pub mod pilot;
pub mod points;
pub(crate) mod rounds;
pub mod sampler;
pub mod sphere;
#[cfg(feature = "media")]
pub mod tables;
pub mod texels;
pub mod visibility;
pub mod warp;
mod work;

use crate::atlas::{Atlas, Page};
use crate::progress::{Interrupted, Progress};
use crate::trace::Tracer;
use bake_optics::medium::MediumSet;
use buffers::{PageBuffers, TermImage, Validity};
use emitters::Emitters;
use glam::Vec3;
use grid::GridSettings;
#[cfg(feature = "media")]
use in_air::InAir;
use lattice::Lattice;
use media::{Media, Vacuum};
use noise::Noise;
use path::{Counters, Gather, Gathered, Paths};
use points::LatticeLight;
use rayon::prelude::*;
use rounds::Rounds;
use sampler::{Sampler, hash};
use std::time::Instant;
use texels::Start;
use work::Work;

/// Luminance of linear Rec.709.
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Independent sequences per texel.
pub const REPLICATES: usize = 8;

/// Texels that one task solves.
const TEXELS_PER_TASK: usize = 64;

/// How much light to gather.
#[derive(Debug, Clone, PartialEq)]
pub struct LightmapSettings {
    /// Standard error to reach, as a share of the page's median (see [`PageReport::error`]).
    pub target_error: f32,
    /// Samples per texel at least and at most; rounded up to multiples of [`REPLICATES`].
    pub min_samples: u32,
    /// See `min_samples`.
    pub max_samples: u32,
    /// Most reflections; `None` leaves it to Russian roulette.
    pub bounces: Option<u32>,
    /// Gather l ≤ 1 harmonics of incident radiance.
    pub sh1: bool,
    /// Same seed, same bits.
    pub seed: u32,
    /// Moment at which sampling ends, whatever the error; pages share the time by their texels. Bits do not repeat then.
    pub deadline: Option<Instant>,
    /// Whether the scene's environment shines.
    pub environment: bool,
    /// Most collisions of light between two surfaces, at least 1; `None` sets no end. [`Mode::Grid`] knows 1 and no end,
    /// [`Mode::Tables`] no end ([`Effort::orders`]).
    pub collisions: Option<u32>,
    /// How light in the air is solved, where there is any.
    pub mode: Mode,
    /// The light grid of [`Mode::Grid`].
    pub grid: GridSettings,
    /// The factors of [`Mode::Tables`].
    pub tables: Effort,
}

/// How much work the factors of [`Mode::Tables`] take, and how fine its tables are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Surface points at which they are measured.
    pub stations: usize,
    /// Directions per point.
    pub rays: u32,
    /// Distances at which tables are read, at least 16.
    pub bins: usize,
    /// Degrees l below which tables are read, up to 16; areas and lamps hold none above 8.
    pub bands: usize,
    /// Collisions up to which tables are summed, of 2, 3, 5 and 10; `None` takes what the scene is nearest to.
    pub orders: Option<usize>,
    /// Whether points of a surface's own plane, which no ray from it meets, are drawn on their own; else factors make other
    /// surfaces stand for them.
    pub own_plane: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self { stations: 2048, rays: 128, bins: 256, bands: 11, orders: None, own_plane: true }
    }
}

/// How light in the air is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Volumetric path tracing: unbiased, slow.
    Walk,
    /// Paths over surfaces alone, which look the light in the air up in a grid.
    Grid,
    /// Paths over surfaces alone, which look up what the air scatters in tables of an infinite medium, brought to the scene
    /// by factors. Gathers no harmonics.
    Tables,
    /// The same as published in 2019, without any correction: to show its bias. Gathers no harmonics.
    Paper,
}

impl Default for LightmapSettings {
    fn default() -> Self {
        Self {
            target_error: 0.02,
            min_samples: 64,
            max_samples: 4096,
            bounces: None,
            sh1: false,
            seed: 0,
            deadline: None,
            environment: true,
            collisions: None,
            mode: Mode::Walk,
            grid: GridSettings { cells: 12, samples: 256 },
            tables: Effort::default(),
        }
    }
}

impl Mode {
    /// Name in flags and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Walk => "walk",
            Self::Grid => "grid",
            Self::Tables => "tables",
            Self::Paper => "paper",
        }
    }
}

/// How one page went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PageReport {
    /// Samples per texel.
    pub samples: u32,
    /// Root mean square, over all texels but the noisiest hundredth, of standard error / max(texel, page's median), in
    /// luminance. Texels that are all equally noisy read 1.0 % too low.
    pub error: f32,
    /// The same over the noisiest hundredth; 0 among fewer than a hundred texels, of which none is left out of `error`.
    pub noisiest: f32,
    /// Median luminance of the page's texels, lux.
    pub median: f32,
    /// Texels of each kind.
    pub good_texels: u32,
    /// Texels inside other geometry.
    pub buried_texels: u32,
}

/// What a bake of all pages returns.
#[derive(Debug, Clone, Default)]
pub struct Lightmap {
    /// One per page of the atlas.
    pub pages: Vec<PageBuffers>,
    /// One per page.
    pub reports: Vec<PageReport>,
    /// Closest-hit rays.
    pub rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Paths cut because nothing absorbed them.
    pub cut_paths: u64,
}

/// Light gathered at one texel so far: means over its samples.
#[derive(Debug, Clone)]
struct Estimate {
    /// Mean of the total of each replicate.
    replicates: [Vec3; REPLICATES],
    /// Mean of each term.
    terms: [Vec3; 4],
    sh1: [Vec3; 4],
}

/// A scene and its air made ready: the light grid is filled where the mode asks for one.
pub struct Solver<'a, 's> {
    tracer: &'a Tracer<'s>,
    settings: &'a LightmapSettings,
    /// None in a vacuum.
    #[cfg(feature = "media")]
    air: Option<InAir<'a>>,
}

impl<'a, 's> Solver<'a, 's> {
    /// Makes ready.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop.
    ///
    /// # Panics
    /// On media where the crate was built without its feature `media`; a plan refuses them before.
    pub fn prepare(
        tracer: &'a Tracer<'s>,
        media: &'a MediumSet,
        settings: &'a LightmapSettings,
        progress: &dyn Progress,
    ) -> Result<Self, Interrupted> {
        let has_air = !media.media.is_empty();
        #[cfg(not(feature = "media"))]
        {
            let _ = progress;
            assert!(!has_air, "{} media and no feature `media` to solve them", media.media.len());
            Ok(Self { tracer, settings })
        }
        #[cfg(feature = "media")]
        {
            let air = has_air.then(|| InAir::prepare(tracer, media, settings, progress)).transpose()?;
            Ok(Self { tracer, settings, air })
        }
    }

    /// Solves every page of the atlas; the counts include the grid's.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop; nothing is returned then.
    pub fn lightmap(&self, atlas: &Atlas, progress: &dyn Progress) -> Result<Lightmap, Interrupted> {
        self.lightmap_with(atlas, self.settings, progress)
    }

    /// The same with other samples; what was made ready stays.
    ///
    /// # Errors
    /// As [`Self::lightmap`].
    pub fn lightmap_with(
        &self,
        atlas: &Atlas,
        settings: &LightmapSettings,
        progress: &dyn Progress,
    ) -> Result<Lightmap, Interrupted> {
        #[cfg(feature = "media")]
        if let Some(air) = &self.air {
            return air.lightmap(self.tracer, atlas, settings, progress);
        }
        pages(self.tracer, &Vacuum, atlas, settings, progress)
    }

    /// Solves the points of a lattice, to the same error as pages.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop; nothing is returned then.
    pub fn lattice(&self, lattice: &Lattice, progress: &dyn Progress) -> Result<LatticeLight, Interrupted> {
        let Self { tracer, settings, .. } = self;
        let emitters = emitters(tracer, settings);
        #[cfg(feature = "media")]
        if let Some(air) = &self.air {
            return air.lattice(tracer, &emitters, lattice, settings, progress);
        }
        points::solve(&paths(tracer, &emitters, &Vacuum, settings), lattice, settings, progress)
    }
}

fn emitters<'s>(tracer: &Tracer<'s>, settings: &LightmapSettings) -> Emitters<'s> {
    let emitters = Emitters::new(tracer);
    if settings.environment { emitters } else { emitters.without_environment() }
}

fn paths<'a, 's, M>(
    tracer: &'a Tracer<'s>,
    emitters: &'a Emitters<'s>,
    media: &'a M,
    settings: &LightmapSettings,
) -> Paths<'a, 's, M> {
    Paths { tracer, emitters, media, bounces: settings.bounces.unwrap_or(u32::MAX), sh1: false }
}

/// Solves every page of the atlas, and nothing else: see [`Solver`].
///
/// # Errors
/// [`Interrupted`] when the progress asks to stop; nothing is returned then.
pub fn lightmap(
    tracer: &Tracer,
    media: &MediumSet,
    atlas: &Atlas,
    settings: &LightmapSettings,
    progress: &dyn Progress,
) -> Result<Lightmap, Interrupted> {
    Solver::prepare(tracer, media, settings, progress)?.lightmap(atlas, progress)
}

fn pages<M: Media>(
    tracer: &Tracer,
    media: &M,
    atlas: &Atlas,
    settings: &LightmapSettings,
    progress: &dyn Progress,
) -> Result<Lightmap, Interrupted> {
    let emitters = emitters(tracer, settings);
    let paths = Paths { sh1: settings.sh1, ..paths(tracer, &emitters, media, settings) };
    solve_pages(&paths, atlas, settings, progress)
}

/// Solves every page with one way to gather light.
fn solve_pages<G: Gather>(
    paths: &G,
    atlas: &Atlas,
    settings: &LightmapSettings,
    progress: &dyn Progress,
) -> Result<Lightmap, Interrupted> {
    let mut lightmap = Lightmap::default();
    let mut texels_left: usize = atlas.pages.iter().map(|page| page.texels.len()).sum();
    let mut work = Work::begin(progress, "trace", texels_left, &Rounds::new(settings, settings.deadline));
    for (index, page) in atlas.pages.iter().enumerate() {
        let share = page.texels.len() as f64 / texels_left.max(1) as f64;
        texels_left -= page.texels.len();
        let now = Instant::now();
        let deadline = settings.deadline.map(|end| now + end.saturating_duration_since(now).mul_f64(share));
        let solver = PageSolver { paths, page, settings, deadline, seed: hash(settings.seed, index as u32) };
        solver.solve(&mut lightmap, &mut work)?;
    }
    Ok(lightmap)
}

struct PageSolver<'a, G> {
    paths: &'a G,
    page: &'a Page,
    settings: &'a LightmapSettings,
    deadline: Option<Instant>,
    seed: u32,
}

impl<G: Gather> PageSolver<'_, G> {
    fn solve(&self, lightmap: &mut Lightmap, work: &mut Work) -> Result<(), Interrupted> {
        let starts = self.starts(work)?;
        work.found(starts.len());
        let good: Vec<bool> = starts.iter().map(|starts| !starts.is_empty()).collect();
        let mut estimates = vec![Estimate::default(); starts.len()];
        let mut rounds = Rounds::new(self.settings, self.deadline);
        loop {
            let samples = rounds.samples();
            self.round(&starts, &mut estimates, samples.clone(), lightmap, work)?;
            work.finish_round(starts.len(), &samples);
            let report = self.report(&good, &estimates, samples.end * REPLICATES as u32);
            let goes_on = rounds.go_on(report.error);
            work.expect(starts.len(), &rounds);
            if !goes_on {
                lightmap.reports.push(report);
                lightmap.pages.push(self.buffers(&good, &estimates, report.samples));
                return Ok(());
            }
        }
    }

    fn starts(&self, work: &Work) -> Result<Vec<Vec<Start>>, Interrupted> {
        let tasks: Vec<_> = self
            .page
            .texels
            .par_chunks(TEXELS_PER_TASK)
            .map(|texels| {
                let found: Vec<_> =
                    texels.iter().map(|texel| texels::starts(self.paths.tracer(), self.page, texel)).collect();
                work.advance(texels.len(), work::FINDING)?;
                Ok(found)
            })
            .collect::<Result<_, Interrupted>>()?;
        Ok(tasks.into_iter().flatten().collect())
    }

    /// Adds a range of samples per replicate to every texel.
    fn round(
        &self,
        starts: &[Vec<Start>],
        estimates: &mut [Estimate],
        samples: std::ops::Range<u32>,
        lightmap: &mut Lightmap,
        work: &Work,
    ) -> Result<(), Interrupted> {
        let tasks = estimates.par_chunks_mut(TEXELS_PER_TASK).enumerate().map(|(task, estimates)| {
            let counters = Counters::default();
            for (offset, estimate) in estimates.iter_mut().enumerate() {
                let texel = task * TEXELS_PER_TASK + offset;
                // A texel may take seconds in late rounds: too long to wait for its whole task.
                work.check()?;
                let (starts, seed) = (&starts[texel], self.texel_seed(texel));
                if starts.is_empty() {
                    continue;
                }
                estimate.add(samples.clone(), |replicate, sample| {
                    let mut sampler = Sampler::new(sample, hash(seed, replicate));
                    let [u, ..] = sampler.next4();
                    self.paths.gather(&starts[texels::pick(starts, u)].vertex, &mut sampler, &counters)
                });
            }
            work.advance(estimates.len(), work::units(&samples))?;
            Ok(counters)
        });
        for counters in tasks.collect::<Result<Vec<_>, Interrupted>>()? {
            lightmap.count(&counters);
        }
        Ok(())
    }

    fn texel_seed(&self, texel: usize) -> u32 {
        let texel = &self.page.texels[texel];
        hash(self.seed, u32::from(texel.x) | u32::from(texel.y) << 16)
    }

    fn report(&self, good: &[bool], estimates: &[Estimate], samples: u32) -> PageReport {
        let texels = good.len() as u32;
        let good = || good.iter().zip(estimates).filter(|(good, _)| **good).map(|(_, estimate)| estimate);
        let level = |estimate: &Estimate| (estimate.total().dot(LUMINANCE), estimate.luminance_variance());
        let Noise { median, error, noisiest } = Noise::of(good().map(level));
        let good_texels = good().count() as u32;
        PageReport { samples, error, noisiest, median, good_texels, buried_texels: texels - good_texels }
    }

    fn buffers(&self, good: &[bool], estimates: &[Estimate], samples: u32) -> PageBuffers {
        let size = (self.page.width * self.page.height) as usize;
        let mut buffers = PageBuffers {
            width: self.page.width,
            height: self.page.height,
            terms: G::TERMS.iter().map(|&term| TermImage { term, irradiance: vec![Vec3::ZERO; size] }).collect(),
            variance: vec![Vec3::ZERO; size],
            samples: vec![0; size],
            validity: vec![Validity::Empty; size],
            sh1: self.settings.sh1.then(|| vec![[Vec3::ZERO; 4]; size]),
        };
        for ((texel, good), estimate) in self.page.texels.iter().zip(good).zip(estimates) {
            let at = self.page.index(texel.x.into(), texel.y.into());
            if !good {
                buffers.validity[at] = Validity::Buried;
                continue;
            }
            buffers.validity[at] = Validity::Good;
            for image in &mut buffers.terms {
                image.irradiance[at] = estimate.terms[image.term as usize];
            }
            buffers.variance[at] = estimate.variance();
            buffers.samples[at] = samples;
            if let Some(sh1) = &mut buffers.sh1 {
                sh1[at] = estimate.sh1;
            }
        }
        buffers
    }
}

impl Default for Estimate {
    fn default() -> Self {
        Self { replicates: [Vec3::ZERO; REPLICATES], terms: [Vec3::ZERO; 4], sh1: [Vec3::ZERO; 4] }
    }
}

impl Estimate {
    /// Takes a range of samples of every replicate, each from `gather(replicate, sample)`; `samples.start` of each were taken
    /// before.
    fn add(&mut self, samples: std::ops::Range<u32>, mut gather: impl FnMut(u32, u32) -> Gathered) {
        let mut sums = [Gathered::default(); REPLICATES];
        for (index, sum) in sums.iter_mut().enumerate() {
            for sample in samples.clone() {
                sum.add(&gather(index as u32, sample));
            }
        }
        self.add_sums(samples, &sums);
    }

    /// The same from the sums of every replicate over the range.
    fn add_sums(&mut self, samples: std::ops::Range<u32>, sums: &[Gathered; REPLICATES]) {
        let mut sum = Gathered::default();
        let (old, new) = (samples.start as f32, samples.end as f32);
        for (mean, replicate) in self.replicates.iter_mut().zip(sums) {
            *mean = (*mean * old + replicate.terms.into_iter().sum::<Vec3>()) / new;
            sum.add(replicate);
        }
        let count = REPLICATES as f32;
        let blend = |mean: &mut Vec3, sum: Vec3| *mean = (*mean * old + sum / count) / new;
        self.terms.iter_mut().zip(sum.terms).for_each(|(mean, sum)| blend(mean, sum));
        self.sh1.iter_mut().zip(sum.sh1).for_each(|(mean, sum)| blend(mean, sum));
    }

    fn total(&self) -> Vec3 {
        self.terms.iter().sum()
    }

    /// Variance of the mean of the total, from the spread of the replicates.
    fn variance(&self) -> Vec3 {
        let count = REPLICATES as f32;
        let mean = self.replicates.iter().sum::<Vec3>() / count;
        self.replicates.iter().map(|r| (*r - mean) * (*r - mean)).sum::<Vec3>() / (count * (count - 1.0))
    }

    fn luminance_variance(&self) -> f32 {
        let count = REPLICATES as f32;
        let levels = self.replicates.map(|r| r.dot(LUMINANCE));
        let mean = levels.iter().sum::<f32>() / count;
        levels.iter().map(|level| (level - mean).powi(2)).sum::<f32>() / (count * (count - 1.0))
    }
}

impl Lightmap {
    fn count(&mut self, counters: &Counters) {
        self.rays += counters.rays.get();
        self.shadow_rays += counters.shadow_rays.get();
        self.cut_paths += counters.cut_paths.get();
    }
}

impl Gathered {
    fn add(&mut self, other: &Self) {
        self.terms.iter_mut().zip(other.terms).for_each(|(sum, value)| *sum += value);
        self.sh1.iter_mut().zip(other.sh1).for_each(|(sum, value)| *sum += value);
    }
}

#[cfg(test)]
mod tests;
