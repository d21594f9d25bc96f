//! How far a bake is from another: one definition for diff, study, sample and tests.
//!
//! With b the bake and t the truth over valid texels: bias = mean(b)/mean(t) − 1;
//! relative RMSE = sqrt(mean(((b − t)/max(t, 0.01·mean t))²)). Both on luminance and for each channel.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Share of the truth's mean below which the relative error's denominator does not fall.
pub const FLOOR: f64 = 0.01;

/// Error of one number a texel.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Error {
    /// mean(b)/mean(t) − 1; 0 where both are dark, infinite where only the truth is.
    pub bias: f64,
    /// Root of the mean squared relative error, the truth's own variance subtracted where it is known; infinite where a texel is
    /// no number.
    pub relative_rmse: f64,
}

/// Errors of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Metrics {
    /// Of Rec.709 luminance.
    pub luminance: Error,
    /// Of R, G and B.
    pub channels: [Error; 3],
    /// Number of texels compared.
    pub texels: usize,
    /// Whether a variance of the truth was subtracted.
    pub truth_variance_subtracted: bool,
}

/// Rec.709 luminance (ITU-R BT.709-6, section 3.2).
pub fn luminance(color: Vec3) -> f64 {
    0.2126 * f64::from(color.x) + 0.7152 * f64::from(color.y) + 0.0722 * f64::from(color.z)
}

/// Compares `bake` with `truth` where `valid`; `variance` is that of the truth's mean, if known. All slices have the
/// same length. The variance of luminance takes channels as fully correlated, as samples of one path are: it is the
/// square of the weighted standard errors.
pub fn compare(bake: &[Vec3], truth: &[Vec3], valid: &[bool], variance: Option<&[Vec3]>) -> Metrics {
    assert!(bake.len() == truth.len() && bake.len() == valid.len(), "one value a texel");
    let indices: Vec<usize> = (0..bake.len()).filter(|&index| valid[index]).collect();
    let pick = |values: &[Vec3], f: &dyn Fn(Vec3) -> f64| indices.iter().map(|&i| f(values[i])).collect::<Vec<f64>>();
    let error = |f: &dyn Fn(Vec3) -> f64, square: &dyn Fn(Vec3) -> f64| {
        let noise = variance.map(|variance| pick(variance, square));
        scalar(&pick(bake, f), &pick(truth, f), noise.as_deref())
    };
    let variance_of_luminance = |v: Vec3| luminance(v.max(Vec3::ZERO).map(f32::sqrt)).powi(2);
    let channel = |c: usize| error(&|v| f64::from(v[c]), &|v| f64::from(v[c]));
    Metrics {
        luminance: error(&luminance, &variance_of_luminance),
        channels: [channel(0), channel(1), channel(2)],
        texels: indices.len(),
        truth_variance_subtracted: variance.is_some(),
    }
}

/// Error of plain numbers; zero for none.
pub fn scalar(bake: &[f64], truth: &[f64], variance: Option<&[f64]>) -> Error {
    let count = truth.len().max(1) as f64;
    let (mean_bake, mean_truth) = (bake.iter().sum::<f64>() / count, truth.iter().sum::<f64>() / count);
    let bias = if mean_bake == mean_truth { 0.0 } else { mean_bake / mean_truth - 1.0 };
    let mut sum = 0.0;
    for (index, (b, t)) in bake.iter().zip(truth).enumerate() {
        if b == t && variance.is_none() {
            continue;
        }
        let floor = t.max(FLOOR * mean_truth);
        sum += ((b - t).powi(2) - variance.map_or(0.0, |variance| variance[index])) / floor.powi(2);
    }
    // What is no number must not pass for no error, which `max` would make of it.
    let square = if sum.is_nan() { f64::INFINITY } else { (sum / count).max(0.0) };
    Error { bias, relative_rmse: square.sqrt() }
}

/// Noise of one bake from two of different seeds: their relative RMSE against their mean, as for one of them.
///
/// With equal variance σ² in both, a − b has variance 2σ², so RMSE(a, b)/√2 is σ.
pub fn noise(a: &[Vec3], b: &[Vec3], valid: &[bool]) -> f64 {
    let mut mean_luminance = Vec::new();
    let mut difference = Vec::new();
    for index in (0..a.len()).filter(|&index| valid[index]) {
        let (a, b) = (luminance(a[index]), luminance(b[index]));
        mean_luminance.push(0.5 * (a + b));
        difference.push(0.5 * (a + b) + (a - b));
    }
    scalar(&difference, &mean_luminance, None).relative_rmse / std::f64::consts::SQRT_2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: f32) -> Vec<Vec3> {
        vec![Vec3::splat(value); 100]
    }

    #[test]
    fn what_is_no_number_is_no_small_error() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(scalar(&[1.0, bad], &[1.0, 1.0], Some(&[0.0, 0.0])).relative_rmse, f64::INFINITY);
        }
    }

    #[test]
    fn known_pairs_have_their_known_errors() {
        let valid = vec![true; 100];
        let same = compare(&flat(3.0), &flat(3.0), &valid, None);
        assert_eq!((same.luminance.bias, same.luminance.relative_rmse, same.texels), (0.0, 0.0, 100));
        let brighter = compare(&flat(1.1), &flat(1.0), &valid, None);
        assert!(
            (brighter.luminance.bias - 0.1).abs() < 1e-6 && (brighter.channels[1].relative_rmse - 0.1).abs() < 1e-6
        );
        // Half the texels 20 % up, half 20 % down: no bias, RMSE 0.2.
        let mixed: Vec<Vec3> = (0..100).map(|i| Vec3::splat(if i % 2 == 0 { 1.2 } else { 0.8 })).collect();
        let mixed = compare(&mixed, &flat(1.0), &valid, None);
        assert!(mixed.luminance.bias.abs() < 1e-6 && (mixed.luminance.relative_rmse - 0.2).abs() < 1e-6);
    }

    #[test]
    fn dark_texels_count_against_the_floor() {
        // One of 100 texels is black in truth and 0.0099 in the bake; mean t = 0.99, so the error there is exactly 1.
        let mut truth = flat(1.0);
        truth[0] = Vec3::ZERO;
        let mut bake = truth.clone();
        bake[0] = Vec3::splat(0.0099);
        let error = compare(&bake, &truth, &[true; 100], None).luminance.relative_rmse;
        assert!((error - 0.1).abs() < 1e-6, "{error}");
    }

    #[test]
    fn invalid_texels_do_not_count() {
        let mut bake = flat(1.0);
        bake[5] = Vec3::splat(1e6);
        let mut valid = vec![true; 100];
        assert!(compare(&bake, &flat(1.0), &valid, None).luminance.bias > 1.0);
        valid[5] = false;
        let metrics = compare(&bake, &flat(1.0), &valid, None);
        assert_eq!((metrics.luminance.bias, metrics.texels), (0.0, 99));
    }

    #[test]
    fn the_truths_own_noise_is_subtracted() {
        // Truth is 1 ± 0.1, the bake exactly 1.
        let truth: Vec<Vec3> = (0..100).map(|i| Vec3::splat(if i % 2 == 0 { 1.1 } else { 0.9 })).collect();
        let raw = compare(&flat(1.0), &truth, &[true; 100], None).luminance.relative_rmse;
        let clean = compare(&flat(1.0), &truth, &[true; 100], Some(&flat(0.01))).luminance.relative_rmse;
        assert!(raw > 0.09 && clean < 1e-3, "{raw} {clean}");
    }

    #[test]
    fn noise_of_two_seeds_is_that_of_one_bake() {
        let seeds = [1.0f32, -1.0].map(|sign| -> Vec<Vec3> {
            (0..100).map(|i| Vec3::splat(1.0 + sign * if i % 2 == 0 { 0.05 } else { -0.05 })).collect()
        });
        // a − b = ±0.1 at mean 1, so one bake has 0.1/√2.
        let noise = noise(&seeds[0], &seeds[1], &[true; 100]);
        assert!((noise - 0.1 / 2f64.sqrt()).abs() < 1e-6, "{noise}");
    }
}
