//! From the coarse nodes of the file to the fine ones that are read: four-point Lagrange interpolation.
//!
//! Stored curves are smooth, so that half the nodes and a cubic lose 1e-5 of a value where linear reading of them would lose 1e-3.

use crate::curves::{Curves, Grid};

/// First node and weights of the four nodes around `x` (a fractional index) among `count` ≥ 4.
fn cubic(x: f64, count: usize) -> (usize, [f64; 4]) {
    let first = (x.max(1.0) as usize - 1).min(count - 4);
    let t = x - first as f64;
    let [a, b, c, d] = [t, t - 1.0, t - 2.0, t - 3.0];
    (first, [b * c * d / -6.0, a * c * d / 2.0, a * b * d / -2.0, a * b * c / 6.0])
}

/// The same curves at the nodes of another grid over the same distances; limits are kept. A grid of fewer than four nodes is kept.
pub fn distances(curves: &Curves, grid: Grid) -> Curves {
    if curves.grid == grid || curves.grid.bins < 4 {
        return curves.clone();
    }
    let mut values = curves.row(0).to_vec();
    for d in grid.distances() {
        let (first, weights) = cubic(curves.grid.index(d), curves.grid.bins);
        let rows: [&[f32]; 4] = std::array::from_fn(|i| curves.row(first + i + 1));
        let at = |column: usize| (0..4).map(|i| weights[i] * f64::from(rows[i][column])).sum::<f64>() as f32;
        values.extend((0..curves.columns).map(at));
    }
    values.extend(curves.row(curves.grid.bins + 1));
    Curves { grid, values, ..*curves }
}

/// Values of `N` harmonics at `from` angle nodes → at the places `indices` among them.
pub fn angles<const N: usize>(nodes: &[[f64; N]], indices: impl Iterator<Item = f64>) -> Vec<[f64; N]> {
    let at = |x: f64| {
        let (first, weights) = cubic(x, nodes.len());
        std::array::from_fn(|h| (0..4).map(|i| weights[i] * nodes[first + i][h]).sum())
    };
    indices.map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::Shape;

    #[test]
    fn a_cubic_in_ln_d_is_kept_and_a_step_is_not() {
        let coarse = Grid { bins: 20, ..Grid::default() };
        let cubic = |d: f64| 1.0 + d.max(1e-3).ln() - 0.1 * d.max(1e-3).ln().powi(3);
        let curves = Curves::store(coarse, Shape::POINT_SINGLE, 1, |d| vec![cubic(d)]);
        let fine = distances(&curves, Grid { bins: 57, ..coarse });
        for (i, d) in fine.grid.distances().into_iter().enumerate() {
            assert!((f64::from(fine.row(i + 1)[0]) - cubic(d)).abs() < 3e-5, "{d}");
        }
        assert_eq!(fine.row(0), curves.row(0));
        let step = Curves::store(coarse, Shape::POINT_SINGLE, 1, |d| vec![if d > 1.0 { 1.0 } else { 0.0 }]);
        let fine = distances(&step, Grid { bins: 57, ..coarse });
        assert!((0..57).any(|i| (fine.row(i + 1)[0] - 0.5).abs() < 0.45), "a step must be blurred");
    }
}
