//! One bake measured: seconds, and error against the reference.
//!
//! With b the bake, t the reference, σ² the variances of their means that their replicates tell, over baked texels:
//! bias and relative RMSE as in [`bake_formats::metrics`], the reference's variance taken off the RMSE;
//! noise² = mean(σ_b²/max(t, 0.01 mean t)²); floor² = RMSE² − noise², what no number of samples takes away;
//! standard error of the bias = sqrt(Σ(σ_b² + σ_t²))/Σt.

use crate::clock::Clock;
use crate::point::{AirChange, Point};
use bake_core::air::Air;
use bake_core::job::Job;
use bake_core::plan::reduce;
use bake_core::progress::{Interrupted, Progress};
use bake_core::solve::buffers::{PageBuffers, Validity};
use bake_core::solve::{Lightmap, Mode, Solver};
use bake_core::trace::Tracer;
use bake_formats::metrics::{self, luminance};
use bake_optics::medium::{MediumSet, Scatter};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use tables::TableSet;

/// Standard errors from which a bias is no chance: one false alarm in 16,000 points.
pub const CERTAIN: f64 = 4.0;

/// What a texel that is no finite number counts as: so many times the reference's mean, so that no such bake looks good.
const NO_NUMBER: f32 = 1e4;

/// Bakes shorter than this are timed three times, seconds.
const BRIEF: f64 = 0.5;

/// A scene that is baked again and again.
pub struct Bench<'a> {
    job: &'a Job,
    tracer: Tracer<'a>,
    clock: Clock,
}

/// A bake and what it took.
pub struct Baked {
    /// What the solver returned.
    pub lightmap: Lightmap,
    /// Seconds until the first path: grids.
    pub prepare_seconds: f64,
    /// Seconds of all.
    pub seconds: f64,
}

impl<'a> Bench<'a> {
    /// Builds the trees.
    pub fn new(job: &'a Job, clock: Clock) -> Self {
        Self { job, tracer: Tracer::new(&job.scene), clock }
    }

    /// Bakes one point.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop.
    pub fn bake(&self, point: &Point, progress: &dyn Progress) -> Result<Baked, Interrupted> {
        let settings = point.solver_settings(&self.job.settings);
        let media = changed(&self.job.air, point.air);
        make_tables(point);
        let start = self.clock.start();
        let solver = Solver::prepare(&self.tracer, &media, &settings, progress)?;
        let prepare_seconds = start.seconds();
        let lightmap = solver.lightmap(&self.job.atlas, progress)?;
        Ok(Baked { lightmap, prepare_seconds, seconds: start.seconds() })
    }

    /// Bakes one point, brief ones three times: the fastest, and how much longer the slowest took as a share.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop.
    pub fn bake_timed(&self, point: &Point, progress: &dyn Progress) -> Result<(Baked, f64), Interrupted> {
        let mut fastest = self.bake(point, progress)?;
        let mut slowest = fastest.seconds;
        if fastest.seconds < BRIEF {
            for _ in 0..2 {
                let again = self.bake(point, progress)?;
                slowest = slowest.max(again.seconds);
                if again.seconds < fastest.seconds {
                    fastest = again;
                }
            }
        }
        let spread = slowest / fastest.seconds - 1.0;
        Ok((fastest, spread))
    }
}

/// Makes the tables that a program makes once, so that no point's seconds have it.
fn make_tables(point: &Point) {
    match point.mode {
        Mode::Tables => _ = TableSet::with_bands(point.tables.bands),
        Mode::Paper => _ = TableSet::published(),
        Mode::Walk | Mode::Grid => {}
    }
}

/// The air with a change.
fn changed(whole: &Air, change: AirChange) -> MediumSet {
    let mut air = whole.media.clone();
    match change {
        AirChange::AsIs | AirChange::Collisions(_) => {}
        AirChange::Uniform => air = reduce::homogeneous(whole).media,
        AirChange::None => air.media.clear(),
        AirChange::Scattering(factor) => air.media.iter_mut().for_each(|medium| {
            let (sigma_t, sigma_s) = (medium.scatter.sigma_t(), medium.scatter.sigma_s.map(|s| s * factor));
            medium.scatter = Scatter { sigma_s, sigma_a: std::array::from_fn(|c| sigma_t[c] - sigma_s[c]) };
        }),
    }
    air
}

/// One page as it is compared.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Irradiance, lux.
    pub total: Vec<Vec3>,
    /// Variance of its mean, lux².
    pub variance: Vec<Vec3>,
    /// Whether the texel was baked.
    pub valid: Vec<bool>,
}

impl From<&PageBuffers> for Page {
    fn from(page: &PageBuffers) -> Self {
        Self {
            width: page.width,
            height: page.height,
            total: (0..page.validity.len()).map(|index| page.total(index)).collect(),
            variance: page.variance.clone(),
            valid: page.validity.iter().map(|state| *state == Validity::Good).collect(),
        }
    }
}

impl Page {
    /// Signed relative error of luminance against a reference at every texel that both baked.
    pub fn relative_errors(&self, truth: &Self) -> Vec<Option<f64>> {
        let both: Vec<usize> = (0..self.valid.len()).filter(|&at| self.valid[at] && truth.valid[at]).collect();
        let level = |page: &Self, at: usize| luminance(page.total[at]);
        let mean = both.iter().map(|&at| level(truth, at)).sum::<f64>() / both.len().max(1) as f64;
        let mut errors = vec![None; self.valid.len()];
        for at in both {
            let (b, t) = (level(self, at), level(truth, at));
            errors[at] = Some(if b == t { 0.0 } else { (b - t) / t.max(metrics::FLOOR * mean) });
        }
        errors
    }
}

/// How far a bake is from the reference; shares of one.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Errors {
    /// mean(b)/mean(t) − 1.
    pub bias: f64,
    /// Its standard error.
    pub bias_error: f64,
    /// Relative RMSE, the reference's variance taken off.
    pub rmse: f64,
    /// The part of it that is noise, by the bake's own variance.
    pub noise: f64,
    /// The rest, which samples do not take away.
    pub floor: f64,
    /// The smallest floor that can be told from chance.
    pub least_floor: f64,
    /// Relative standard error of the reference.
    pub reference_error: f64,
    /// Texels compared.
    pub texels: usize,
}

impl Errors {
    /// Compares pages of one layout.
    pub fn between(bake: &[Page], truth: &[Page]) -> Self {
        let gather = |pick: &dyn Fn(usize) -> Vec<Vec3>| -> Vec<Vec3> { (0..truth.len()).flat_map(pick).collect() };
        let (mut b, t) = (gather(&|i| bake[i].total.clone()), gather(&|i| truth[i].total.clone()));
        let (mut var_b, var_t) = (gather(&|i| bake[i].variance.clone()), gather(&|i| truth[i].variance.clone()));
        let valid: Vec<bool> =
            bake.iter().zip(truth).flat_map(|(b, t)| b.valid.iter().zip(&t.valid).map(|(b, t)| *b && *t)).collect();
        let finite: Vec<bool> = b.iter().map(|light| light.is_finite()).collect();
        refuse_no_numbers(&mut b, &mut var_b, &t, &valid);
        let error = metrics::compare(&b, &t, &valid, Some(&var_t)).luminance;
        let at: Vec<usize> = (0..valid.len()).filter(|&i| valid[i]).collect();
        let levels: Vec<f64> = at.iter().map(|&i| luminance(t[i])).collect();
        let deviations = |variance: &[Vec3]| -> Vec<f64> {
            at.iter().map(|&i| luminance(variance[i].max(Vec3::ZERO).map(f32::sqrt))).collect()
        };
        let (dev_b, dev_t) = (deviations(&var_b), deviations(&var_t));
        let relative = |deviations: &[f64]| {
            let shifted: Vec<f64> = levels.iter().zip(deviations).map(|(level, deviation)| level + deviation).collect();
            metrics::scalar(&shifted, &levels, None).relative_rmse
        };
        let (noise, reference_error) = (relative(&dev_b), relative(&dev_t));
        let squares: f64 = dev_b.iter().chain(&dev_t).map(|deviation| deviation * deviation).sum();
        let rmse = error.relative_rmse;
        let count = at.len().max(1) as f64;
        let normal = (2.0 / count).sqrt() * (noise * noise + reference_error * reference_error);
        // A few wild texels, as fireflies are, make the mean of squares wilder than normal noise does.
        let least_level = metrics::FLOOR * levels.iter().sum::<f64>() / count;
        let unexplained = (0..at.len()).filter(|&i| finite[at[i]]).map(|i| {
            let off = [luminance(b[at[i]]) - levels[i], dev_b[i], dev_t[i]].map(|x| x / levels[i].max(least_level));
            off[0] * off[0] - off[1] * off[1] - off[2] * off[2]
        });
        let wild = (spread(&unexplained.collect::<Vec<_>>()) / count).sqrt();
        Self {
            bias: error.bias,
            bias_error: squares.sqrt() / levels.iter().sum::<f64>().max(f64::MIN_POSITIVE),
            rmse,
            noise,
            floor: (rmse * rmse - noise * noise).max(0.0).sqrt(),
            least_floor: (3.0 * normal.max(wild)).sqrt(),
            reference_error,
            texels: at.len(),
        }
    }

    /// Whether the bias cannot be chance.
    pub fn is_biased(&self) -> bool {
        self.bias.abs() > CERTAIN * self.bias_error
    }

    /// Whether the floor can be told from chance.
    pub fn has_floor(&self) -> bool {
        self.floor > self.least_floor
    }
}

/// Variance of values; 0 of none.
fn spread(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count
}

/// Gives texels that are no finite numbers [`NO_NUMBER`] times the reference's mean, and no variance that could excuse it.
fn refuse_no_numbers(bake: &mut [Vec3], variance: &mut [Vec3], truth: &[Vec3], valid: &[bool]) {
    let levels = truth.iter().zip(valid).filter(|(t, valid)| **valid && t.is_finite()).map(|(t, _)| t.max_element());
    let (sum, count) = levels.fold((0.0, 0.0f32), |(sum, count), level| (sum + level, count + 1.0));
    let refused = Vec3::splat(NO_NUMBER * (sum / count.max(1.0)).max(f32::MIN_POSITIVE));
    for (b, variance) in bake.iter_mut().zip(variance) {
        if !b.is_finite() {
            (*b, *variance) = (refused, Vec3::ZERO);
        } else if !variance.is_finite() {
            *variance = Vec3::ZERO;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texel_that_is_no_number_cannot_look_good() {
        let truth = [page(|_| 10.0, 0.1)];
        for bad in [f32::NAN, f32::INFINITY] {
            let errors = Errors::between(&[page(|i| if i == 7 { bad } else { 10.0 }, 0.1)], &truth);
            assert!(errors.is_biased() && errors.bias > 5.0 && errors.rmse > 100.0, "{errors:?}");
            assert!(errors.has_floor() && errors.noise.is_finite(), "{errors:?}");
        }
        let mut unsure = page(|_| 10.0, 0.1);
        unsure.variance[3] = Vec3::splat(f32::NAN);
        let errors = Errors::between(&[unsure], &truth);
        assert!(errors.noise.is_finite() && errors.rmse < 0.1 && !errors.is_biased(), "{errors:?}");
    }

    fn page(level: impl Fn(usize) -> f32, deviation: f32) -> Page {
        let total = (0..1000).map(|i| Vec3::splat(level(i))).collect();
        Page {
            width: 1000,
            height: 1,
            total,
            variance: vec![Vec3::splat(deviation * deviation); 1000],
            valid: vec![true; 1000],
        }
    }

    /// Noise and bias of known sizes come back, each in its place.
    #[test]
    fn noise_and_floor_are_told_apart() {
        let truth = [page(|_| 10.0, 0.0)];
        // ±4 % of noise that the bake states, and 3 % too bright.
        let noisy = [page(|i| if i.is_multiple_of(2) { 10.4 } else { 9.6 } + 0.3, 0.4)];
        let errors = Errors::between(&noisy, &truth);
        assert!((errors.bias - 0.03).abs() < 1e-6 && (errors.noise - 0.04).abs() < 1e-6, "{errors:?}");
        assert!((errors.rmse - 0.05).abs() < 1e-6 && (errors.floor - 0.03).abs() < 1e-6, "{errors:?}");
        assert!(errors.is_biased() && errors.has_floor(), "{errors:?}");
        // The same noise alone is no bias and has no floor.
        let honest = Errors::between(&[page(|i| if i.is_multiple_of(2) { 10.4 } else { 9.6 }, 0.4)], &truth);
        assert!(!honest.is_biased() && !honest.has_floor(), "{honest:?}");
    }

    /// Two fireflies that the bake's own variance missed are no floor; the same error in every tenth texel is one.
    #[test]
    fn a_few_wild_texels_are_chance() {
        let truth = [page(|_| 10.0, 0.01)];
        let wild = |every: usize| page(move |i| if i.is_multiple_of(every) { 14.0 } else { 10.0 }, 0.01);
        let [few, many] = [500, 10].map(|every| Errors::between(&[wild(every)], &truth));
        assert!(few.floor > 0.015 && !few.has_floor(), "{few:?}");
        assert!(many.has_floor(), "{many:?}");
    }

    #[test]
    fn a_noisy_reference_does_not_make_a_bake_biased() {
        let truth = [page(|i| if i.is_multiple_of(3) { 11.0 } else { 9.0 } + 1.0 / 3.0 + 0.01, 1.0)];
        let errors = Errors::between(&[page(|_| 10.0, 0.0)], &truth);
        assert!(!errors.is_biased() && errors.reference_error > 0.09, "{errors:?}");
    }

    #[test]
    fn less_scattering_keeps_extinction() {
        let medium = bake_optics::medium::Medium {
            scatter: Scatter { sigma_s: [0.6; 3], sigma_a: [0.4; 3] },
            ..Default::default()
        };
        let air = Air { media: MediumSet { media: vec![medium] }, ..Air::default() };
        let scatter = |change| changed(&air, change).media[0].scatter;
        assert_eq!(scatter(AirChange::Scattering(0.5)).sigma_t(), [1.0; 3]);
        assert_eq!(scatter(AirChange::Scattering(0.0)).sigma_s, [0.0; 3]);
        assert!(changed(&air, AirChange::None).media.is_empty());
    }
}
