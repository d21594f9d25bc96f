//! Light at the points of a lattice, as harmonics of incident radiance: what probes and fog volumes hold.
//!
//! Sampled as texels are: independent sequences whose spread gives the error, rounds until it is small enough, the same
//! bits for any number of threads.

use super::lattice::Lattice;
use super::media::Media;
use super::noise::Noise;
use super::path::{Counters, Paths};
use super::rounds::Rounds;
use super::sampler::{Sampler, hash};
use super::sphere::{Incident, Sh9};
use super::work::{self, Work};
use super::{LUMINANCE, LightmapSettings, REPLICATES};
use crate::progress::{Interrupted, Progress};
use glam::{Vec2, Vec3};
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
    /// How far points see ([`super::visibility::moments`]), where it was asked for.
    pub visibility: Option<Vec<Vec2>>,
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
    /// Root mean square over directions, and over all points but the noisiest hundredth, of the standard error of irradiance,
    /// over the mean irradiance of the point, or of the median point where that is more; in luminance.
    pub error: f32,
    /// The same over the noisiest hundredth; 0 among fewer than a hundred points, of which none is left out of `error`.
    pub noisiest: f32,
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
    let mut work = Work::begin(progress, "light at points", 0, &rounds);
    work.expect(points, &rounds);
    let noise = loop {
        let samples = rounds.samples();
        let tasks = estimates.par_iter_mut().zip(&places).enumerate().map(|(index, (estimate, place))| {
            let counters = Counters::default();
            if let Some(place) = place {
                let seed = hash(hash(settings.seed, SEED), index as u32);
                estimate.add(paths, *place, seed, samples.clone(), &counters);
            }
            work.advance(1, work::units(&samples)).map(|()| counters)
        });
        tasks.collect::<Result<Vec<_>, _>>()?.iter().for_each(|counters| counters.add_to(&mut sums));
        work.finish_round(points, &samples);
        let noise = noise(&estimates, &places);
        let goes_on = rounds.go_on(noise.error);
        work.expect(points, &rounds);
        if !goes_on {
            break noise;
        }
    };
    let moved = |(index, place): (usize, &Option<Vec3>)| place.is_some_and(|place| place != lattice.position(index));
    let report = LatticeReport {
        points,
        invalid_points: places.iter().filter(|place| place.is_none()).count(),
        moved_points: places.iter().enumerate().filter(|&pair| moved(pair)).count(),
        samples: rounds.samples().end * REPLICATES as u32,
        error: noise.error,
        noisiest: noise.noisiest,
        rays: sums[0],
        shadow_rays: sums[1],
        cut_paths: sums[2],
    };
    let light = estimates.into_iter().map(|estimate| estimate.mean).collect();
    Ok(LatticeLight { lattice: lattice.clone(), places, light, visibility: None, report })
}

/// See [`LatticeReport::error`].
fn noise(estimates: &[Estimate], places: &[Option<Vec3>]) -> Noise {
    let valid = estimates.iter().zip(places).filter(|(_, place)| place.is_some());
    Noise::of(valid.map(|(estimate, _)| (estimate.mean[0].dot(LUMINANCE), estimate.variance())))
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
