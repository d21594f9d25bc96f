//! The area emitter as Dubouchet et al. 2019 hold it: zonal harmonics about one fitted axis, here for comparison.
//!
//! About the bytes of the fourteen mirror-symmetric harmonics of [`crate::area`] and 6 to 50 times their error: nothing about one axis
//! can follow light that is not symmetric about one. Emitters that face away (θ > 90°) are not in these tables: they give 0.
//! Canonical: sigma_t = sigma_s = 1, L_o dA = 1.

use crate::area::compute_exact;
use crate::axial::{HARMONIC_COUNT, HARMONICS};
use crate::curves::{Curves, DistanceMap, Grid, Shape};
use crate::response::{IRRADIANCE_DEGREES, even_legendre};
use crate::transport::harmonics::{real_norm, scaled_legendre};
use crate::transport::phase_basis::PhaseBasis;
use bake_optics::harmonics::clamped_cosine;
use bake_optics::phase::Phase;
use glam::Vec3;
use std::f64::consts::FRAC_PI_2;

/// Zonal bands about the fitted axis.
pub const BANDS: usize = 11;

/// Emitter angles, uniform in θ from 0 to 90°.
pub const ANGLES: usize = 8;

/// Values of one node: the bands and `d_fit`, the sine of the axis's tilt.
pub const COLUMNS: usize = BANDS + 1;

/// Mean cosines of the Henyey–Greenstein functions that have tables; others are interpolated linearly.
pub const MEAN_COSINES: [f64; 3] = [-0.5, 0.0, 0.5];

/// Nodes per panel of the direct evaluation behind a fit.
const NODES: usize = 32;

// Compute.

/// What the axis is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Least squares of radiance, as published.
    Radiance,
    /// Least squares of irradiance over all receivers: degrees weighted by A_l².
    Irradiance,
}

/// Zonal harmonics about an axis tilted from the direction to the emitter towards the side to which the emitter leans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// Tilt of the axis, radians, 0 … π/2.
    pub tilt: f64,
    /// Zonal coefficients about it.
    pub zonal: [f64; BANDS],
}

/// The (l, m) with l < 11 of a mirror-symmetric function.
pub fn harmonics() -> Vec<(usize, usize)> {
    (0..BANDS).flat_map(|l| (0..=l).map(move |m| (l, m))).collect()
}

/// SH coefficients of a unit zonal harmonic of each degree about an axis at `tilt`: `sqrt(4π/(2l+1)) Y_lm(tilt, 0)`, in the
/// order of [`harmonics`].
pub fn lobe(tilt: f64) -> Vec<f64> {
    let (sin, cos) = tilt.sin_cos();
    let table: Vec<[f64; BANDS]> = (0..BANDS)
        .map(|m| {
            let mut p = [0.0; BANDS];
            scaled_legendre(m, cos, sin, &mut p);
            p
        })
        .collect();
    harmonics().into_iter().map(|(l, m)| real_norm(l, m) / real_norm(l, 0) * table[m][l]).collect()
}

impl Fit {
    /// The best axis for the coefficients of [`harmonics`].
    ///
    /// About a given axis the best zonal coefficient is the projection `c_l = Σ_m L_lm lobe_lm`, and what is left of degree l is
    /// `Σ_m L_lm² − c_l²`: the axis maximises `Σ_l w_l c_l²`, found by a scan and golden sections.
    pub fn new(coefficients: &[f64], criterion: Criterion) -> Self {
        let cosine = clamped_cosine::<f64>(BANDS);
        let weight = |l: usize| if criterion == Criterion::Radiance { 1.0 } else { cosine[l] * cosine[l] };
        let gain =
            |tilt: f64| -> f64 { project(coefficients, tilt).iter().enumerate().map(|(l, c)| weight(l) * c * c).sum() };
        let step = FRAC_PI_2 / 90.0;
        let best = (0..=90).map(|i| i as f64 * step).max_by(|a, b| gain(*a).total_cmp(&gain(*b))).unwrap_or(0.0);
        let (mut low, mut high) = ((best - step).max(0.0), (best + step).min(FRAC_PI_2));
        let golden = 0.618_033_988_749_895;
        for _ in 0..32 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if gain(a) >= gain(b) { high = b } else { low = a }
        }
        let tilt = if low == 0.0 && high < 1e-6 { 0.0 } else { 0.5 * (low + high) };
        Self { tilt, zonal: project(coefficients, tilt) }
    }

    /// The fitted function as coefficients of [`harmonics`].
    pub fn expand(&self) -> Vec<f64> {
        harmonics().iter().zip(lobe(self.tilt)).map(|(&(l, _), y)| self.zonal[l] * y).collect()
    }
}

fn project(coefficients: &[f64], tilt: f64) -> [f64; BANDS] {
    let mut zonal = [0.0; BANDS];
    for ((&(l, _), y), c) in harmonics().iter().zip(lobe(tilt)).zip(coefficients) {
        zonal[l] += c * y;
    }
    zonal
}

/// Once-scattered light of a Lambertian element, normalised (`d e^d`), fitted for each function of the basis and each angle:
/// columns of [`column`].
pub fn compute_single(d: f64, basis: &PhaseBasis, criterion: Criterion) -> Vec<f64> {
    let list = harmonics();
    let mut columns = vec![0.0; basis.len() * ANGLES * COLUMNS];
    for angle in 0..ANGLES {
        let exact = compute_exact(d, theta(angle as f64), basis, &list, NODES);
        for (function, coefficients) in exact.iter().enumerate() {
            let fit = Fit::new(coefficients, criterion);
            let start = column(function, angle, 0);
            columns[start..start + BANDS].copy_from_slice(&fit.zonal);
            columns[start + BANDS] = fit.tilt.sin();
        }
    }
    columns
}

/// The functions that have tables.
pub fn basis() -> PhaseBasis {
    PhaseBasis::Functions(MEAN_COSINES.map(|g| Phase::HenyeyGreenstein { g }).to_vec())
}

/// Weights of the three tables for a mean cosine: linear between them, continued linearly beyond.
pub fn weights(g: f64) -> [f64; 3] {
    let x = g / MEAN_COSINES[2];
    if x < 0.0 { [-x, 1.0 + x, 0.0] } else { [0.0, 1.0 - x, x] }
}

// Map.

/// Mapping: angle index, fractions allowed → θ.
pub fn theta(index: f64) -> f64 {
    FRAC_PI_2 * index / (ANGLES - 1) as f64
}

/// Mapping: θ → angle index, the inverse of [`theta`].
pub fn index(theta: f64) -> f64 {
    theta / FRAC_PI_2 * (ANGLES - 1) as f64
}

/// Column of value `value` (band, or `BANDS` for d_fit) at an angle of a phase function.
pub fn column(function: usize, angle: usize, value: usize) -> usize {
    (function * ANGLES + angle) * COLUMNS + value
}

// Store.

/// The order-1 table.
pub fn store_single(grid: Grid, criterion: Criterion) -> Curves {
    let basis = basis();
    let columns = basis.len() * ANGLES * COLUMNS;
    Curves::store(grid, Shape::POINT_SINGLE, columns, |d| compute_single(d, &basis, criterion))
}

// Look up.

/// One node at an angle between the stored ones; zonal coefficients and d_fit, both linear.
pub(crate) fn between(nodes: &[f64], theta: f64) -> [f64; COLUMNS] {
    let x = index(theta);
    let low = (x as usize).min(ANGLES - 2);
    let at = |angle: usize, value: usize| nodes[angle * COLUMNS + value];
    std::array::from_fn(|v| at(low, v) + (x - low as f64) * (at(low + 1, v) - at(low, v)))
}

/// The fitted function at θ as stripped harmonics of [`crate::axial::HARMONICS`].
pub(crate) fn stripped(nodes: &[f64], theta: f64) -> [f64; HARMONIC_COUNT] {
    // At θ = 0 the quotient by sin^m θ is that of a place beside it.
    let theta = theta.max(1e-3);
    let node = between(nodes, theta);
    let lobe = lobe(node[BANDS].clamp(0.0, 1.0).asin());
    HARMONICS.map(|(l, m)| node[l] * lobe[l * (l + 1) / 2 + m] / theta.sin().powi(m as i32))
}

/// Response of one medium and channel about a fitted axis.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedResponse {
    map: DistanceMap,
    /// Rows of [`ANGLES`]: `A_l` times the norm times the coefficient for the seven degrees that irradiance sees, and d_fit.
    nodes: Vec<[f32; 8]>,
}

impl FittedResponse {
    /// From rows of [`ANGLES`] × [`COLUMNS`] values.
    pub(crate) fn new(grid: &Grid, shape: Shape, rows: impl Iterator<Item = Vec<f64>>) -> Self {
        let cosine = clamped_cosine::<f64>(BANDS);
        let fold = |node: &[f64]| -> [f32; 8] {
            std::array::from_fn(|i| match i {
                7 => node[BANDS] as f32,
                _ => {
                    let l = IRRADIANCE_DEGREES[i];
                    (cosine[l] * real_norm(l, 0) * node[l]) as f32
                }
            })
        };
        let nodes = rows.flat_map(|row| row.chunks_exact(COLUMNS).map(fold).collect::<Vec<_>>()).collect();
        Self { map: DistanceMap::new(grid, shape), nodes }
    }

    /// Irradiance (W/m²) per L_o dA on a receiver with `normal`, `distance_m` from the emitter, which lies in direction
    /// `to_emitter` and has the axis `axis`; all unit vectors. 0 where the emitter faces away. `sigma_t` in 1/m, ≥ 0.
    #[inline]
    pub fn irradiance(&self, sigma_t: f32, distance_m: f32, normal: Vec3, to_emitter: Vec3, axis: Vec3) -> f32 {
        let cos = -axis.dot(to_emitter);
        if cos < 0.0 {
            return 0.0;
        }
        let place = self.map.place(sigma_t * distance_m);
        let x = cos.min(1.0).acos() * ((ANGLES - 1) as f32 / std::f32::consts::FRAC_PI_2);
        let low = (x as usize).min(ANGLES - 2);
        let (v, u, first) = (x - low as f32, place.fraction, place.row * ANGLES + low);
        let weights = [(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v];
        let rows = [first, first + 1, first + ANGLES, first + ANGLES + 1].map(|i| &self.nodes[i]);
        let node: [f32; 8] = std::array::from_fn(|i| (0..4).map(|k| weights[k] * rows[k][i]).sum());
        let tilted = tilt(to_emitter, axis + cos * to_emitter, node[7]);
        let p: [f32; 8] = bytemuck::cast(even_legendre(normal.dot(tilted)));
        sigma_t * sigma_t * place.scale * (0..7).map(|i| node[i] * p[i]).sum::<f32>()
    }
}

/// The direction to the emitter tilted towards the side `aside` by an angle of the given sine.
#[inline]
fn tilt(to_emitter: Vec3, aside: Vec3, sine: f32) -> Vec3 {
    let sine = sine.clamp(0.0, 1.0);
    (1.0 - sine * sine).sqrt() * to_emitter + sine * aside.normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    #[test]
    fn a_zonal_function_about_a_tilted_axis_is_found_again() {
        let mut worst = Worst::new("fit of a zonal function (absolute)", 1e-5);
        let zonal: [f64; BANDS] = std::array::from_fn(|l| 0.7f64.powi(l as i32));
        for tilt in [0.0, 0.3, 1.1] {
            let fit = Fit { tilt, zonal };
            for criterion in [Criterion::Radiance, Criterion::Irradiance] {
                let found = Fit::new(&fit.expand(), criterion);
                worst.record((found.tilt - tilt).abs(), || format!("tilt {tilt} {criterion:?}"));
                (0..BANDS)
                    .for_each(|l| worst.record((found.zonal[l] - zonal[l]).abs(), || format!("tilt {tilt} l {l}")));
            }
        }
        worst.check();
    }

    /// RMS over all receiver normals of the error of irradiance, of the RMS of irradiance (Parseval), in percent.
    fn error(coefficients: &[f64], criterion: Criterion) -> f64 {
        let cosine = clamped_cosine::<f64>(BANDS);
        let fit = Fit::new(coefficients, criterion).expand();
        let (mut error, mut all) = (0.0, 0.0);
        for ((&(l, _), want), got) in harmonics().iter().zip(coefficients).zip(fit) {
            error += (cosine[l] * (got - want)).powi(2);
            all += (cosine[l] * want).powi(2);
        }
        100.0 * (error / all).sqrt()
    }

    /// The method's specification gives these errors for order 1, two digits.
    #[test]
    fn the_error_of_one_axis_is_what_was_measured_before() {
        let mut worst = Worst::new("error of a fitted axis, of the specified figure", 0.06);
        for (d, radiance, irradiance) in [
            (0.05, [14.0, 27.0, 33.0], [4.3, 6.9, 7.0]),
            (0.5, [8.7, 19.0, 26.0], [1.9, 4.6, 6.0]),
            (2.0, [4.2, 11.0, 18.0], [0.7, 2.4, 4.5]),
        ] {
            for (i, degrees) in [30.0f64, 60.0, 85.0].into_iter().enumerate() {
                let exact = &compute_exact(d, degrees.to_radians(), &PhaseBasis::Legendre(1), &harmonics(), 40)[0];
                for (criterion, want) in [(Criterion::Radiance, radiance[i]), (Criterion::Irradiance, irradiance[i])] {
                    let got = error(exact, criterion);
                    println!("d {d} theta {degrees} {criterion:?}: {got:.2} % ({want})");
                    worst.relative(got, want, || format!("d {d} theta {degrees} {criterion:?}"));
                }
            }
        }
        worst.check();
    }

    #[test]
    fn weights_are_one_at_their_table_and_sum_to_one() {
        for (i, g) in MEAN_COSINES.into_iter().enumerate() {
            assert_eq!(weights(g)[i], 1.0);
        }
        for g in [-0.9, -0.2, 0.1, 0.8] {
            let w = weights(g);
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((w.iter().zip(MEAN_COSINES).map(|(w, g)| w * g).sum::<f64>() - g).abs() < 1e-15);
        }
        assert!((0..ANGLES).all(|i| (index(theta(i as f64)) - i as f64).abs() < 1e-12));
    }
}
