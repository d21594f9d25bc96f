//! The coefficients of one distance and one angle in 32 bytes, half a cache line, and their product with a receiver's basis.
//!
//! Fourteen integers of 16 bits share one scale: a look-up reads few cache lines, and contracts in integers by the
//! multiply-and-add-pairs that every SIMD instruction set has. *Accuracy*: 2e-5 of the node's largest coefficient.

use crate::axial::HARMONIC_COUNT;
use bytemuck::{Pod, Zeroable};
use wide::{f32x4, i16x8, i32x8};

/// Steps per unit of the basis. Its numbers stay below 1.05, and those that meet in one 32-bit sum (lanes 2k, 2k + 1, 2k + 8 and
/// 2k + 9) below 2.6 together, so that neither they nor the sum overflow.
const BASIS_STEPS: f32 = 24576.0;

/// Index among [`crate::axial::HARMONICS`] of the harmonic in lane 2, 3 … 15: (0,0), (1,0); the other zonal ones; m = 1; m > 1.
pub(crate) const LANES: [usize; HARMONIC_COUNT] = [0, 1, 3, 6, 11, 13, 2, 4, 7, 12, 5, 8, 9, 10];

/// `L_lm / sin^m θ` in steps, in the order of [`LANES`]; the bytes of their size are lanes 0 and 1.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Node {
    step: f32,
    steps: [i16; HARMONIC_COUNT],
}

impl Node {
    /// Rounds to 1/65534 of the largest of the values, which are in the order of [`crate::axial::HARMONICS`].
    pub fn new(values: &[f64; HARMONIC_COUNT]) -> Self {
        let largest = values.iter().fold(0.0f64, |largest, v| largest.max(v.abs()));
        let step = (largest / f64::from(i16::MAX)).max(f64::from(f32::MIN_POSITIVE)) as f32;
        Self { step, steps: LANES.map(|h| (values[h] / f64::from(step)).round() as i16) }
    }

    /// The coefficients in the order of [`crate::axial::HARMONICS`].
    pub fn values(&self) -> [f32; HARMONIC_COUNT] {
        let mut values = [0.0; HARMONIC_COUNT];
        LANES.iter().zip(self.steps).for_each(|(&h, v)| values[h] = f32::from(v) * self.step);
        values
    }

    /// Four partial sums of `weight · Σ value · basis`, in units of [`Basis::UNIT`].
    #[inline]
    pub fn dot(&self, basis: &Basis, weight: f32) -> f32x4 {
        let [low, high]: &[i16x8; 2] = bytemuck::cast_ref(self);
        let sums = low.dot(basis.0[0]) + high.dot(basis.0[1]);
        f32x4::from_i32x4(sums) * f32x4::splat(weight * self.step)
    }
}

/// What the coefficients are multiplied with, in the same lanes; lanes 0 and 1 are 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Basis([i16x8; 2]);

impl Basis {
    /// One step.
    pub const UNIT: f32 = 1.0 / BASIS_STEPS;

    /// Rounds to 1/49152. Four lanes each, the first two 0.
    #[inline]
    pub fn new([a, b, c, d]: [f32x4; 4]) -> Self {
        let steps = |lanes: f32x4| (lanes * BASIS_STEPS).fast_round_int();
        let pack = |low, high| i16x8::from_i32x8_saturate(bytemuck::cast::<_, i32x8>([steps(low), steps(high)]));
        Self([pack(a, b), pack(c, d)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_is_that_of_the_numbers() {
        let mut worst = testkit::compare::Worst::new("product in integers, of the largest coefficient", 1e-4);
        for i in 0..2000 {
            let at = |k: usize, lane: usize| ((i * 31 + k * 17 + lane * 7) as f64).sin();
            let values = std::array::from_fn(|lane| 1e3 * at(0, lane).powi(1 + (i % 7) as i32));
            let basis: [f32; HARMONIC_COUNT] = std::array::from_fn(|lane| 0.6 * at(1, lane) as f32);
            let node = Node::new(&values);
            let want: f64 = values.iter().zip(basis).map(|(v, b)| v * f64::from(b)).sum();
            let got = node.dot(&in_lanes(&basis), 0.25).reduce_add() * Basis::UNIT;
            let largest = values.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            worst.record((f64::from(got) - 0.25 * want).abs() / largest, || format!("case {i}"));
            for (got, want) in node.values().iter().zip(values) {
                assert!((f64::from(*got) - want).abs() <= 1.6e-5 * largest);
            }
        }
        worst.check();
    }

    /// A basis in the order of [`crate::axial::HARMONICS`].
    fn in_lanes(basis: &[f32; HARMONIC_COUNT]) -> Basis {
        let mut lanes = [0.0; 16];
        LANES.iter().zip(&mut lanes[2..]).for_each(|(&h, lane)| *lane = basis[h]);
        Basis::new(bytemuck::cast(lanes))
    }

    /// The largest numbers that [`crate::geometry`] makes, harmonic by harmonic, all at once and of one sign.
    #[test]
    fn the_largest_numbers_do_not_overflow() {
        let largest = [0.887, 1.024, 1.024, 0.496, 0.43, 0.43, 0.111, 0.12, 0.372, 0.08, 0.082, 0.05, 0.072, 0.029f32];
        let node = Node::new(&[5.0; HARMONIC_COUNT]);
        let want = 5.0 * largest.iter().sum::<f32>();
        for sign in [1.0, -1.0] {
            let got = node.dot(&in_lanes(&largest.map(|v| sign * v)), 1.0).reduce_add() * Basis::UNIT;
            assert!((got / (sign * want) - 1.0).abs() < 1e-4, "{got} {want}");
        }
    }
}
