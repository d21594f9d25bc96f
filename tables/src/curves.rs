//! Coefficients over distance: the grid, the mapping from a distance to a place in it, and what holds outside.
//!
//! Every table stores `n(d) = L(d) / s(d)` with `s(d) = e^{−κ d}/d` (emitters at a point) or `e^{−κ d}` (directional light),
//! at nodes uniform in ln d, and reads it by linear interpolation in ln d. Row 0 is the limit d → 0 and the last row the
//! limit d → ∞, so that places outside the grid are reads between two rows like all others.

use serde::{Deserialize, Serialize};

/// Canonical distances below this are read at it: a receiver inside the lamp.
pub(crate) const SMALLEST_DISTANCE: f32 = 1e-12;

/// Canonical distances above this are read at it: infinity included.
pub(crate) const LARGEST_DISTANCE: f32 = 1e12;

/// Share of the largest distance at which tables per order start to fade.
const FADE_START: f64 = 0.9;

/// Node distances uniform in ln d. Canonical (optical) distance, no unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// First node.
    pub min: f64,
    /// Last node.
    pub max: f64,
    /// Number of nodes, at least 2.
    pub bins: usize,
}

impl Default for Grid {
    fn default() -> Self {
        Self { min: 1e-3, max: 50.0, bins: 256 }
    }
}

impl Grid {
    /// Difference of ln d between nodes.
    pub fn step(&self) -> f64 {
        (self.max / self.min).ln() / (self.bins - 1) as f64
    }

    /// Distance of node `index`, fractions allowed. Mapping: index → d.
    pub fn distance(&self, index: f64) -> f64 {
        (self.min.ln() + self.step() * index).exp()
    }

    /// Place of a distance among the nodes, as a fractional index. Mapping: d → index, the inverse of [`Grid::distance`].
    pub fn index(&self, d: f64) -> f64 {
        (d / self.min).ln() / self.step()
    }

    /// All node distances.
    pub fn distances(&self) -> Vec<f64> {
        (0..self.bins).map(|i| self.distance(i as f64)).collect()
    }
}

/// How n(d) goes from its limit at d = 0 to the first node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Near {
    /// `n_0 + (n_1 − n_0) (d ln d)/(d_1 ln d_1)`: once-scattered light and directional light.
    Logarithmic,
    /// `n_1 d/d_1`: the coefficient itself is held (light of a point-like emitter scattered twice or more).
    Hold,
}

/// What follows after the last node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Far {
    /// Smoothly to zero between 0.9 of the largest distance and that distance.
    Fade,
    /// `n_∞ + (n_last − n_∞) d_last/d`: sums over all orders go on by their pole term.
    Pole,
}

/// The analytic part of a family of curves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// κ of the exponential divided out.
    pub rate: f64,
    /// Whether 1/d is divided out as well.
    pub inverse_distance: bool,
    /// Below the grid.
    pub near: Near,
    /// Above the grid.
    pub far: Far,
}

impl Shape {
    /// Light of a point-like emitter scattered exactly once.
    pub const POINT_SINGLE: Self = Self { rate: 1.0, inverse_distance: true, near: Near::Logarithmic, far: Far::Fade };
    /// Light of a point-like emitter scattered exactly k ≥ 2 times.
    pub const POINT_MULTIPLE: Self = Self { near: Near::Hold, ..Self::POINT_SINGLE };
    /// Directional light scattered any number of times.
    pub const DIRECTIONAL: Self = Self { inverse_distance: false, ..Self::POINT_SINGLE };

    /// The same for a sum over all orders that decays with `rate`.
    pub const fn all_orders(self, rate: f64) -> Self {
        Self { rate, far: Far::Pole, ..self }
    }

    /// s(d), by which stored values are multiplied.
    pub fn scale(&self, d: f64) -> f64 {
        (-self.rate * d).exp() / if self.inverse_distance { d } else { 1.0 }
    }
}

/// Where a distance lies among the rows, and the factor that undoes the normalisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Lower of the two rows.
    pub row: usize,
    /// Weight of the row above it.
    pub fraction: f32,
    /// s(d), with the fade where there is one.
    pub scale: f32,
}

/// The mapping of one table in f32, constants folded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceMap {
    pub(crate) min: f32,
    max: f32,
    pub(crate) fade_from: f32,
    pub(crate) ln_min: f32,
    pub(crate) inverse_step: f32,
    last_row: usize,
    near_end: f32,
    pub(crate) shape: Shape,
    pub(crate) rate: f32,
}

impl DistanceMap {
    /// For a grid and shape.
    pub fn new(grid: &Grid, shape: Shape) -> Self {
        Self {
            min: grid.min as f32,
            max: grid.max as f32,
            fade_from: if shape.far == Far::Fade { (FADE_START * grid.max) as f32 } else { grid.max as f32 },
            ln_min: grid.min.ln() as f32,
            inverse_step: (1.0 / grid.step()) as f32,
            last_row: grid.bins,
            near_end: (grid.min * grid.min.ln()) as f32,
            shape,
            rate: shape.rate as f32,
        }
    }

    /// Place of a canonical distance; any f32 is allowed.
    #[inline]
    #[allow(clippy::manual_clamp, reason = "clamp would let NaN through")]
    pub fn place(&self, d: f32) -> Place {
        let d = d.max(SMALLEST_DISTANCE).min(LARGEST_DISTANCE);
        let (ln_d, decay) = (d.ln(), (-self.rate * d).exp());
        let scale = if self.shape.inverse_distance { decay / d } else { decay };
        if d >= self.min && d <= self.fade_from {
            let x = (ln_d - self.ln_min) * self.inverse_step;
            let node = (x.max(0.0) as usize).min(self.last_row - 2);
            return Place { row: node + 1, fraction: x - node as f32, scale };
        }
        self.outside(d, ln_d, scale)
    }

    #[cold]
    fn outside(&self, d: f32, ln_d: f32, scale: f32) -> Place {
        if d < self.min {
            let fraction = match self.shape.near {
                Near::Logarithmic => d * ln_d / self.near_end,
                Near::Hold => d / self.min,
            };
            return Place { row: 0, fraction, scale };
        }
        match self.shape.far {
            Far::Pole => Place { row: self.last_row, fraction: 1.0 - self.max / d, scale },
            Far::Fade => {
                let t = ((self.max - d) / (self.max - self.fade_from)).max(0.0);
                let x = (ln_d.min(self.max.ln()) - self.ln_min) * self.inverse_step;
                let node = (x as usize).min(self.last_row - 2);
                Place { row: node + 1, fraction: x - node as f32, scale: scale * t * t * (3.0 - 2.0 * t) }
            }
        }
    }
}

/// Several curves over one grid: rows of `columns` values, row 0 the limit d → 0, then the nodes, then the limit d → ∞.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// The node distances.
    pub grid: Grid,
    /// The analytic part.
    pub shape: Shape,
    /// Values per row.
    pub columns: usize,
    /// `(bins + 2) × columns` normalised coefficients, row-major.
    pub values: Vec<f32>,
}

impl Curves {
    /// Rows needed for a grid.
    pub fn rows(grid: &Grid) -> usize {
        grid.bins + 2
    }

    /// One row.
    pub fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// Look up all columns at a canonical distance.
    pub fn look_up(&self, d: f64) -> Vec<f32> {
        let place = DistanceMap::new(&self.grid, self.shape).place(d as f32);
        self.read(&place).into_iter().map(|n| n * place.scale).collect()
    }

    /// Normalised values of all columns at a place.
    pub fn read(&self, place: &Place) -> Vec<f32> {
        let (low, high) = (self.row(place.row), self.row(place.row + 1));
        low.iter().zip(high).map(|(a, b)| a + place.fraction * (b - a)).collect()
    }

    /// Builds all rows from a function of distance that returns normalised coefficients: at 0 (`None` for a shape that
    /// holds the coefficient), at every node, and the far limit where the shape has one.
    ///
    /// `compute(d)` is called in parallel, once per distance; the far limit follows from d_last and 4 d_last by
    /// `n(d) = n_∞ + b/d`.
    pub fn store(grid: Grid, shape: Shape, columns: usize, compute: impl Fn(f64) -> Vec<f64> + Sync) -> Self {
        use rayon::prelude::*;
        let mut distances = vec![0.0];
        distances.extend(grid.distances());
        distances.push(4.0 * grid.max);
        let needed = |d: f64| !(d == 0.0 && shape.near == Near::Hold || d > 2.0 * grid.max && shape.far == Far::Fade);
        let row = |&d: &f64| if needed(d) { compute(d) } else { vec![0.0; columns] };
        let mut rows: Vec<Vec<f64>> = distances.par_iter().map(row).collect();
        if shape.far == Far::Pole {
            let last = rows[grid.bins].clone();
            rows[grid.bins + 1].iter_mut().zip(last).for_each(|(far, near)| *far = (4.0 * *far - near) / 3.0);
        }
        let values = rows.iter().flatten().map(|&v| v as f32).collect();
        Self { grid, shape, columns, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    #[test]
    fn the_mapping_is_its_own_inverse_at_both_ends_and_inside() {
        let mut worst = Worst::new("index ∘ distance (absolute, in bins)", 1e-10);
        for bins in [2, 32, 256, 512] {
            let grid = Grid { bins, ..Grid::default() };
            for x in [0.0, 0.3, 0.5 * (bins - 1) as f64, (bins - 1) as f64] {
                worst.record((grid.index(grid.distance(x)) - x).abs(), || format!("bins {bins} x {x}"));
            }
            assert!((grid.distance(0.0) / grid.min - 1.0).abs() < 1e-14);
            assert!((grid.distance((bins - 1) as f64) / grid.max - 1.0).abs() < 1e-13);
        }
        worst.check();
    }

    #[test]
    fn places_in_f32_agree_with_the_f64_mapping() {
        // ln d is good to 1 ulp of 11 and the step is 0.042: 4e-5 bins.
        let mut worst = Worst::new("f32 place against f64 index (bins)", 1e-4);
        let grid = Grid::default();
        let map = DistanceMap::new(&grid, Shape::POINT_SINGLE);
        for i in 0..5000 {
            let d = grid.distance(i as f64 * 0.0497).min(44.9) as f32;
            let place = map.place(d);
            let x = place.row as f64 - 1.0 + f64::from(place.fraction);
            worst.record((x - grid.index(f64::from(d))).abs(), || format!("d {d}"));
        }
        worst.check();
    }

    #[test]
    fn reads_are_continuous_at_both_ends_and_finite_everywhere() {
        let grid = Grid { bins: 16, ..Grid::default() };
        for shape in [
            Shape::POINT_SINGLE,
            Shape::POINT_MULTIPLE,
            Shape::DIRECTIONAL,
            Shape::POINT_MULTIPLE.all_orders(0.0),
            Shape::DIRECTIONAL.all_orders(0.3),
        ] {
            let curves = Curves::store(grid, shape, 1, |d| vec![2.0 + d / (1.0 + d)]);
            for edge in [grid.min, FADE_START * grid.max, grid.max] {
                let (below, above) = (curves.look_up(edge * (1.0 - 1e-6))[0], curves.look_up(edge * (1.0 + 1e-6))[0]);
                // e^{−d} itself changes by 1e-4 over the step at d = 50.
                assert!((below - above).abs() <= 3e-4 * below.abs() + 1e-30, "{shape:?} at {edge}: {below} {above}");
            }
            for d in [0.0, 1e-30, 1e-12, 1e-3, 1.0, 44.0, 49.9, 50.0, 51.0, 1e6, f64::INFINITY, f64::NAN] {
                assert!(curves.look_up(d)[0].is_finite(), "{shape:?} at {d}");
            }
        }
    }
}
