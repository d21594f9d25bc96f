//! An emitter's Legendre series over the curves of [`crate::axial`], summed at every angle that is read: the stored degrees, and those
//! beyond by the law that they follow.
//!
//! Light scattered twice comes back to the line between emitter and receiver with a logarithm at its middle, more often with
//! less: the curves of high degrees fall as a power of l. Where the air is thick that power is small and a series cut after the last
//! stored degree would err by a percent beside an emitter's kink.

use bake_optics::harmonics::clamped_cosine;

use crate::angles;
use crate::axial::{self, ALL_DEGREES, HARMONIC_COUNT, HARMONICS, ORDERS_M};
use crate::transport::harmonics::stripped_legendre;
use crate::transport::sources::EMITTER_DEGREES;

/// Legendre degrees l' = 0 … 64 of an emitter that are worth giving: a spot of 10° asks for no more.
pub const SERIES_DEGREES: usize = 65;

/// The degrees beyond go on as the last two stored ones of equal parity.
const LAST: [usize; 2] = [EMITTER_DEGREES - 3, EMITTER_DEGREES - 1];

/// Legendre coefficients of the clamped cosine, `A_l (2l+1)/(4π)`: ¼, ½, 5/16, 0, −3/32 …
pub fn cosine_legendre() -> Vec<f64> {
    let a = clamped_cosine::<f64>(SERIES_DEGREES);
    a.iter().enumerate().map(|(l, a)| a * (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI)).collect()
}

/// An emitter's distribution at the places of [`angles::cosines`].
pub(crate) struct Series {
    /// Those whose coefficient does not vanish.
    degrees: Vec<usize>,
    /// `c_l' P̄_l'^m(cos θ)/sin^m θ` of each harmonic, degree by degree, angle by angle.
    weights: Vec<[f64; HARMONIC_COUNT]>,
}

impl Series {
    /// Of `Σ c_l P_l(cos)` at so many angles and between them; a spot's or lamp's is filtered behind it.
    pub fn new(angles: usize, legendre: &[f64], is_lamp: bool) -> Self {
        // Degree 0 stays, for an emitter that is dark.
        let degrees: Vec<usize> = (0..legendre.len().max(1)).filter(|&l| l == 0 || legendre[l] != 0.0).collect();
        let at = |cos: f64| {
            let p: [Vec<f64>; ORDERS_M] = std::array::from_fn(|m| {
                let mut p = vec![0.0; legendre.len().max(1)];
                stripped_legendre(m, cos, &mut p);
                p
            });
            let weight = |l: usize| legendre.get(l).unwrap_or(&0.0) * if is_lamp { filter(l, cos) } else { 1.0 };
            degrees.iter().map(|&l| HARMONICS.map(|(_, m)| weight(l) * p[m][l])).collect::<Vec<_>>()
        };
        let weights = angles::cosines(angles).into_iter().flat_map(at).collect();
        Self { degrees, weights }
    }

    /// The stripped harmonics at every angle, from the stored curves of one distance.
    pub fn sum(&self, stored: &[f64]) -> Vec<[f64; HARMONIC_COUNT]> {
        let curves = self.curves(stored);
        let at = |weights: &[[f64; HARMONIC_COUNT]]| {
            let mut sum = [0.0; HARMONIC_COUNT];
            for (weights, curves) in weights.iter().zip(&curves) {
                (0..HARMONIC_COUNT).for_each(|h| sum[h] += weights[h] * curves[h]);
            }
            sum
        };
        self.weights.chunks_exact(self.degrees.len()).map(at).collect()
    }

    /// G of every harmonic, degree by degree.
    fn curves(&self, stored: &[f64]) -> Vec<[f64; HARMONIC_COUNT]> {
        let mut known = [[0.0; EMITTER_DEGREES]; HARMONIC_COUNT];
        axial::curves(&ALL_DEGREES).iter().zip(stored).for_each(|(&(h, l), g)| known[h][l] = *g);
        let powers = known.map(|curve| power(&curve));
        let at = |&l: &usize| {
            std::array::from_fn(|h| known[h].get(l).copied().unwrap_or_else(|| beyond(&known[h], powers[h], l)))
        };
        self.degrees.iter().map(at).collect()
    }
}

/// p of `G ∝ (l' + ½)^p`; −∞ where the last degrees do not fall.
fn power(curve: &[f64; EMITTER_DEGREES]) -> f64 {
    let [before, last] = LAST.map(|l| curve[l]);
    let ratio = last / before;
    if ratio > 0.0 && ratio < 1.0 { ratio.ln() / (place(LAST[1]) / place(LAST[0])).ln() } else { f64::NEG_INFINITY }
}

/// G of a degree that is not stored.
fn beyond(curve: &[f64; EMITTER_DEGREES], power: f64, degree: usize) -> f64 {
    curve[LAST[1]] * (place(degree) / place(LAST[1])).powf(power)
}

fn place(degree: usize) -> f64 {
    degree as f64 + 0.5
}

/// What a degree is weakened by behind an emitter, where the end of a narrow spot's series would shine: a ripple adds up on the
/// axis to light that comes straight to the receiver, and 18 mean free paths away outweighs what has had to turn round.
///
/// *Equation*: `exp(−8 s (l/17)⁶)`, s = −c/0.34 within 0 … 1, an exponential filter (Gottlieb & Shu 1997, 5). *Accuracy*: order 2 of a spot of
/// 20° at 18 mean free paths, beyond 110°: 0.4 % of l = 0, without it 43 % (`tests/spots.rs`).
fn filter(degree: usize, cos: f64) -> f64 {
    let behind = (-cos / 0.34).clamp(0.0, 1.0);
    (-8.0 * behind * (degree as f64 / EMITTER_DEGREES as f64).powi(6)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stored curves of every harmonic that follow `law` over the degrees.
    fn stored(law: impl Fn(f64) -> f64) -> Vec<f64> {
        axial::curves(&ALL_DEGREES).iter().map(|&(_, l)| law(place(l))).collect()
    }

    #[test]
    fn a_power_law_goes_on_and_curves_that_do_not_fall_end() {
        let all: Vec<f64> = (0..SERIES_DEGREES).map(|l| 1.0 / (1.0 + l as f64)).collect();
        let series = Series::new(9, &all, false);
        let last = |curves: Vec<[f64; HARMONIC_COUNT]>| curves[SERIES_DEGREES - 1];
        for value in last(series.curves(&stored(|x| 3.0 * x.powf(-1.7)))) {
            assert!((value / (3.0 * 64.5f64.powf(-1.7)) - 1.0).abs() < 1e-12, "{value}");
        }
        for law in [|x: f64| x, |x: f64| (x - 15.5).signum(), |_| 0.0, |_| 1.0] {
            assert_eq!(last(series.curves(&stored(law))), [0.0; HARMONIC_COUNT]);
        }
    }

    #[test]
    fn a_dark_emitter_and_one_without_coefficients_are_dark() {
        for dark in [&[][..], &[0.0; 5]] {
            let sums = Series::new(9, dark, true).sum(&stored(|x| 1.0 / x));
            assert_eq!(sums, vec![[0.0; HARMONIC_COUNT]; 17]);
        }
    }
}
