//! Places in the tables of three colour channels at once: one logarithm, one exponential, one division for all.
//!
//! Logarithm and exponential are our own: those of `wide` serve all of f32, and take most of a look-up's time; positive normal
//! numbers and 1e-6 suffice here.

use crate::curves::{DistanceMap, LARGEST_DISTANCE, Place, SMALLEST_DISTANCE};
use bytemuck::cast;
use std::f32::consts::{LN_2, LOG2_E};
use wide::{f32x4, i32x4};

/// Three channels; the last lane repeats the third.
#[inline]
pub(crate) fn lanes(channels: [f32; 3]) -> f32x4 {
    f32x4::from([channels[0], channels[1], channels[2], channels[2]])
}

/// ln of positive normal numbers. *Equation*: x = 2^e m, √½ ≤ m < √2, ln m = 2 artanh t, t = (m − 1)/(m + 1). *Accuracy*: 1.2e-7
/// (1 + |ln x|).
#[inline]
fn ln(x: f32x4) -> f32x4 {
    let bits: i32x4 = cast(x);
    let root_half = i32x4::splat(0x3f35_04f3);
    let exponent: i32x4 = (bits - root_half) >> 23;
    let m: f32x4 = cast(bits - (exponent << 23));
    let t = (m - f32x4::ONE) / (m + f32x4::ONE);
    let s = t * t;
    let series = (s * (2.0 / 7.0) + 2.0 / 5.0) * (s * s) + (s * (2.0 / 3.0) + 2.0);
    f32x4::from_i32x4(exponent) * LN_2 + t * series
}

/// e^{−x} for x ≥ 0; that of 87 beyond. *Equation*: 2^n e^r, |r| ≤ ½ ln 2, Taylor. *Accuracy*: relative 1e-7 (2 + x).
#[inline]
fn exp_negative(x: f32x4) -> f32x4 {
    let y = x.fast_min(f32x4::splat(87.0)) * -LOG2_E;
    let n = y.fast_round_int();
    let r = (y - f32x4::from_i32x4(n)) * LN_2;
    let (high, low) = ((r * (1.0 / 720.0) + 1.0 / 120.0) * r + 1.0 / 24.0, (r * 0.5 + 1.0) * r + 1.0);
    let r3 = r * r * r;
    let scale: f32x4 = cast((n + i32x4::splat(127)) << 23);
    scale * (low + r3 * (high * r + 1.0 / 6.0))
}

/// Where three distances lie among the rows of their tables.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places {
    /// Lower of the two rows.
    pub rows: [usize; 3],
    /// Weight of the row above it.
    pub fractions: [f32; 3],
    /// s(d), with the fade where there is one; the last lane repeats the third.
    pub scale: f32x4,
}

/// The mappings of three tables side by side.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DistanceLanes {
    maps: [DistanceMap; 3],
    min: f32x4,
    fade_from: f32x4,
    ln_min: f32x4,
    inverse_step: f32x4,
    rate: f32x4,
    /// What decay is divided by: `divisor.0 d + divisor.1`.
    divisor: (f32x4, f32x4),
}

impl DistanceLanes {
    pub fn new(maps: [DistanceMap; 3]) -> Self {
        let all = |field: fn(&DistanceMap) -> f32| lanes(maps.each_ref().map(field));
        Self {
            min: all(|map| map.min),
            fade_from: all(|map| map.fade_from),
            ln_min: all(|map| map.ln_min),
            inverse_step: all(|map| map.inverse_step),
            rate: all(|map| map.rate),
            divisor: (
                all(|map| f32::from(u8::from(map.shape.inverse_distance))),
                all(|map| f32::from(u8::from(!map.shape.inverse_distance))),
            ),
            maps,
        }
    }

    /// Places of three canonical distances; any f32 is allowed.
    #[inline]
    pub fn places(&self, optical: f32x4) -> Places {
        let d = optical.fast_max(f32x4::splat(SMALLEST_DISTANCE)).fast_min(f32x4::splat(LARGEST_DISTANCE));
        if !(d.simd_ge(self.min) & d.simd_le(self.fade_from)).all() {
            return self.one_by_one(d);
        }
        let x = (ln(d) - self.ln_min) * self.inverse_step;
        let node = x.fast_trunc_int();
        let scale = exp_negative(self.rate * d) / (d * self.divisor.0 + self.divisor.1);
        // At the last node the row above is the far limit, at weight 0.
        let ([i, j, k, _], [u, v, w, _]) = (node.to_array(), (x - f32x4::from_i32x4(node)).to_array());
        Places { rows: [i as usize + 1, j as usize + 1, k as usize + 1], fractions: [u, v, w], scale }
    }

    #[cold]
    fn one_by_one(&self, d: f32x4) -> Places {
        let d = d.to_array();
        let places: [Place; 3] = std::array::from_fn(|i| self.maps[i].place(d[i]));
        let scale = lanes(places.map(|p| p.scale));
        Places { rows: places.map(|p| p.row), fractions: places.map(|p| p.fraction), scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Grid, Shape};
    use testkit::compare::Worst;

    #[test]
    fn logarithm_and_exponential_agree_with_f64() {
        let mut logarithm = Worst::new("ln, absolute of 1 + |ln|", 1.2e-7);
        let mut exponential = Worst::new("e^-x, relative, of 2 + x", 1e-7);
        for i in 0..40_000 {
            let x = (f64::from(i) * 0.00138 - 27.6).exp() as f32;
            let (want, got) = (f64::from(x).ln(), ln(f32x4::splat(x)).to_array()[1]);
            logarithm.record((f64::from(got) - want).abs() / (1.0 + want.abs()), || format!("{x}"));
            let x = 86.9 * (i as f32 / 40_000.0);
            let (want, got) = ((-f64::from(x)).exp(), exp_negative(f32x4::splat(x)).to_array()[1]);
            exponential.record((f64::from(got) / want - 1.0).abs() / (2.0 + f64::from(x)), || format!("{x}"));
        }
        logarithm.check();
        exponential.check();
    }

    #[test]
    fn places_of_three_agree_with_single_places_everywhere() {
        let grid = Grid { bins: 64, ..Grid::default() };
        let shapes = [Shape::POINT_SINGLE, Shape::POINT_MULTIPLE.all_orders(0.0), Shape::DIRECTIONAL.all_orders(0.3)];
        let maps = shapes.map(|shape| DistanceMap::new(&grid, shape));
        let three = DistanceLanes::new(maps);
        let mut worst = Worst::new("place (in rows) and scale (relative) of three against one", 1e-5);
        let ends = [0.0, -1.0, 1e-3, 45.0, 50.0, 1e30, f32::INFINITY, f32::NAN];
        for d in (0..3000).map(|i| 1e-7 * (0.0085 * i as f32).exp()).chain(ends) {
            let Places { rows, fractions, scale } = three.places(f32x4::splat(d));
            for (i, map) in maps.iter().enumerate() {
                let got = Place { row: rows[i], fraction: fractions[i], scale: scale.to_array()[i] };
                let want = map.place(d);
                let rows = |p: &Place| p.row as f64 + f64::from(p.fraction);
                worst.record((rows(&got) - rows(&want)).abs(), || format!("{d} channel {i}"));
                let tiny = f64::from(f32::MIN_POSITIVE);
                worst.record(f64::from((got.scale - want.scale).abs()) / (f64::from(want.scale) + 1e6 * tiny), || {
                    format!("{d} scale {i}")
                });
            }
        }
        worst.check();
    }
}
