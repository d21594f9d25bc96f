//! Light at the points of a lattice, as harmonics of incident radiance: what probes and fog volumes hold.
//!
//! Sampled as texels are: independent sequences whose spread gives the error, rounds until it is small enough, the same
//! bits for any number of threads.

use super::lattice::Lattice;
use super::media::Media;
use super::path::{Counters, Paths};
use super::rounds::Rounds;
use super::sampler::{Sampler, hash};
use super::sphere::{Incident, Sh9};
use super::{LUMINANCE, LightmapSettings, REPLICATES};
use crate::progress::{Interrupted, Progress};
use glam::Vec3;
use rayon::prelude::*;

/// Of lattices, beside those of pages.
const SEED: u32 = 0x7072_6f62;

/// Squares of what irradiance keeps of a band against band 0: π, 2π/3 and π/4 (Ramamoorthi and Hanrahan 2001).
const BAND_WEIGHTS: [f32; 9] = {
    const ONE: f32 = 4.0 / 9.0;
    const TWO: f32 = 1.0 / 16.0;
    [1.0, ONE, ONE, ONE, TWO, TWO, TWO, TWO, TWO]
};

/// Light at the points of a lattice; lists are in the order of [`Lattice::position`].
#[derive(Debug, Clone)]
pub struct LatticeLight {
    /// Where the points were meant to be.
    pub lattice: Lattice,
    /// Where light was gathered; `None` for points in cells without free air.
    pub places: Vec<Option<Vec3>>,
    /// Incident radiance, cd/m²; zero where there is no place.
    pub light: Vec<Sh9>,
    /// How it went.
    pub report: LatticeReport,
}

/// How a lattice went.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LatticeReport {
    /// Points.
    pub points: usize,
    /// Of those, without free air in their cell.
    pub invalid_points: usize,
    /// Of those, moved off or out of surfaces.
    pub moved_points: usize,
    /// Samples a point.
    pub samples: u32,
    /// Root mean square over points and directions of the standard error of irradiance, over the mean irradiance of the
    /// point, or of the median point where that is more; in luminance.
    pub error: f32,
    /// Closest-hit rays.
    pub rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Paths cut because nothing absorbed them.
    pub cut_paths: u64,
}

/// Light gathered at one point so far.
#[derive(Debug, Clone)]
struct Estimate {
    mean: Sh9,
    /// Luminance of each replicate's mean.
    replicates: [[f32; 9]; REPLICATES],
}

/// Solves a lattice.
pub(super) fn solve<M: Media>(
    paths: &Paths<M>,
    lattice: &Lattice,
    settings: &LightmapSettings,
    progress: &dyn Progress,
) -> Result<LatticeLight, Interrupted> {
    let points = lattice.points() as usize;
    progress.stage("find free air", points as u64);
    let step = || {
        progress.advance(1);
        if progress.is_cancelled() { Err(Interrupted) } else { Ok(()) }
    };
    let places = (0..points).into_par_iter().map(|index| step().map(|()| lattice.settle(paths.tracer, index)));
    let places: Vec<Option<Vec3>> = places.collect::<Result<_, _>>()?;
    let mut estimates = vec![Estimate { mean: Sh9::default(), replicates: Default::default() }; points];
    let mut sums = [0; 3];
    let mut rounds = Rounds::new(settings, settings.deadline);
    let error = loop {
        progress.stage("light at points", points as u64);
        let tasks = estimates.par_iter_mut().zip(&places).enumerate().map(|(index, (estimate, place))| {
            let counters = Counters::default();
            if let Some(place) = place {
                let seed = hash(hash(settings.seed, SEED), index as u32);
                estimate.add(paths, *place, seed, rounds.samples(), &counters);
            }
            step().map(|()| counters)
        });
        tasks.collect::<Result<Vec<_>, _>>()?.iter().for_each(|counters| counters.add_to(&mut sums));
        let error = error(&estimates, &places);
        if !rounds.go_on(error) {
            break error;
        }
    };
    let moved = |(index, place): (usize, &Option<Vec3>)| place.is_some_and(|place| place != lattice.position(index));
    let report = LatticeReport {
        points,
        invalid_points: places.iter().filter(|place| place.is_none()).count(),
        moved_points: places.iter().enumerate().filter(|&pair| moved(pair)).count(),
        samples: rounds.samples().end * REPLICATES as u32,
        error,
        rays: sums[0],
        shadow_rays: sums[1],
        cut_paths: sums[2],
    };
    let light = estimates.into_iter().map(|estimate| estimate.mean).collect();
    Ok(LatticeLight { lattice: *lattice, places, light, report })
}

/// See [`LatticeReport::error`].
fn error(estimates: &[Estimate], places: &[Option<Vec3>]) -> f32 {
    let valid: Vec<&Estimate> =
        estimates.iter().zip(places).filter(|(_, place)| place.is_some()).map(|p| p.0).collect();
    let level = |estimate: &Estimate| estimate.mean[0].dot(LUMINANCE);
    let mut levels: Vec<f32> = valid.iter().map(|estimate| level(estimate)).collect();
    levels.sort_by(f32::total_cmp);
    let median = levels.get(levels.len() / 2).copied().unwrap_or(0.0);
    let square = |estimate: &&Estimate| {
        let level = level(estimate).max(median);
        if level > 0.0 { f64::from(estimate.variance() / (level * level)) } else { 0.0 }
    };
    (valid.iter().map(square).sum::<f64>() / valid.len().max(1) as f64).sqrt() as f32
}

impl Estimate {
    /// Takes a range of samples of every replicate; `samples.start` of each were taken before.
    fn add<M: Media>(
        &mut self,
        paths: &Paths<M>,
        place: Vec3,
        seed: u32,
        samples: std::ops::Range<u32>,
        counters: &Counters,
    ) {
        let (old, new) = (samples.start as f32, samples.end as f32);
        let mut mean = Sh9::default();
        for (index, levels) in self.replicates.iter_mut().enumerate() {
            let mut sum = Incident::default();
            for sample in samples.clone() {
                let mut sampler = Sampler::new(sample, hash(seed, index as u32));
                sum.add_scaled(&paths.gather_sphere(place, &mut sampler, counters), 1.0);
            }
            let sum = sum.total();
            levels.iter_mut().zip(sum).for_each(|(level, sum)| *level = (*level * old + sum.dot(LUMINANCE)) / new);
            mean.iter_mut().zip(sum).for_each(|(mean, sum)| *mean += sum / REPLICATES as f32);
        }
        self.mean.iter_mut().zip(mean).for_each(|(total, sum)| *total = (*total * old + sum) / new);
    }

    /// Mean over directions of the variance of irradiance, in units of what band 0 keeps.
    fn variance(&self) -> f32 {
        let count = REPLICATES as f32;
        let of = |i: usize| {
            let mean = self.replicates.iter().map(|levels| levels[i]).sum::<f32>() / count;
            self.replicates.iter().map(|levels| (levels[i] - mean).powi(2)).sum::<f32>() / (count * (count - 1.0))
        };
        (0..9).map(|i| BAND_WEIGHTS[i] * of(i)).sum()
    }
}
