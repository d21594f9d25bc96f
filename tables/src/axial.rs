//! Emitters with a direction, light scattered twice or more: a small Lambertian surface element, a spot, a measured lamp.
//!
//! The response is symmetric to the plane of the emitter's axis and the line to the receiver, so it is held as real SH with
//! cos(mφ) only, about the direction `a` from the receiver to the emitter, φ = 0 towards the side to which the emitter's axis
//! (the normal of a surface) leans. Its dependence on θ, the angle between that axis and −a, separates: an intensity
//! `Σ c_l' P_l'` makes
//! `L_lm(d, θ) = Σ_l' c_l' P̄_l'^m(cos θ) G_{lm,l'}(d)`, `P̄_l^m = sqrt((l−m)!/(l+m)!) P_l^m`,
//! for every θ from 0 to 180°. The tables hold G: one curve per (l, m, l').
//!
//! Canonical: sigma_t = sigma_s = 1; intensity `L_o dA cos θ'` with L_o dA = 1 for an area.

use crate::curves::{Curves, Grid, Shape};
use crate::transport::harmonics::{real_norm, scaled_legendre};
use crate::transport::sources::{EMITTER_DEGREES, Source};
use crate::transport::triangle::Triangle;
use std::sync::OnceLock;

/// The (l, m) that are kept: all that irradiance sees of l ≤ 4 (its odd l ≥ 3 vanish), and of l = 6 and 8 what light from behind an
/// emitter needs, a narrow lobe about the line to it. RMS error of irradiance below 2 % at every θ, distance and |g| ≤ 0.8; with
/// the first eleven 0.4–1.8 % up to 90° and 2 mean free paths, 3–4 % behind or beyond.
pub const HARMONICS: [(usize, usize); HARMONIC_COUNT] =
    [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4), (6, 0), (6, 1), (8, 0)];

/// How many [`HARMONICS`] there are.
pub const HARMONIC_COUNT: usize = 14;

/// Degrees l up to the largest among [`HARMONICS`].
pub(crate) const DEGREES: usize = 9;

/// Largest m among [`HARMONICS`], plus one.
pub(crate) const ORDERS_M: usize = 5;

/// All degrees of a general axial emitter.
pub const ALL_DEGREES: [usize; EMITTER_DEGREES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16];

// Compute.

/// Light that each of `sources` scatters once more, normalised (`d e^{κd} G`); `[source][curve]` over [`ALL_DEGREES`].
///
/// *Equation*: `G = (1/2d) ∫∫ Y_lm(γ, 0) P̄_l'^m(cos β) e^{−t} r² f_l'(r) dγ dβ`. *Accuracy*: 1e-6 of (0,0,0).
pub fn compute_multiple(d: f64, sources: &[Source]) -> Vec<Vec<f64>> {
    let list = curves(&ALL_DEGREES);
    let mut sums = vec![vec![0.0; list.len()]; sources.len()];
    let mut inner = vec![[[0.0; EMITTER_DEGREES]; ORDERS_M]; sources.len()];
    let mut q = [0.0; EMITTER_DEGREES];
    let rule = Triangle::standard();
    for (row, table) in rule.rows.iter().zip(inner_legendre().chunks(rule.rows.len())) {
        inner.iter_mut().for_each(|sum| *sum = [[0.0; EMITTER_DEGREES]; ORDERS_M]);
        for (n, p) in row.nodes.iter().zip(table) {
            let place = sources[0].moments.place(d * n.side_outer);
            for (source, sum) in sources.iter().zip(&mut inner) {
                let value = n.weight * (-d * (source.rate * (n.side_outer - 1.0) + n.side_inner)).exp();
                source.moments.read(&place, &mut q);
                q.iter_mut().for_each(|q| *q *= value);
                for (sum, p) in sum.iter_mut().zip(p) {
                    (0..EMITTER_DEGREES).for_each(|degree| sum[degree] += q[degree] * p[degree]);
                }
            }
        }
        let outer = scaled_all(row.cos_outer, row.outer.sin());
        for (sum, inner) in sums.iter_mut().zip(&inner) {
            for (slot, &(harmonic, degree)) in sum.iter_mut().zip(&list) {
                let (l, m) = HARMONICS[harmonic];
                *slot += row.weight * outer[m][l] * inner[m][degree];
            }
        }
    }
    normalise(&mut sums, &list);
    sums
}

/// ½ of 1/(2d) · d, and the norm of Y_lm.
fn normalise(sums: &mut [Vec<f64>], list: &[(usize, usize)]) {
    for sum in sums {
        for (slot, &(harmonic, _)) in sum.iter_mut().zip(list) {
            let (l, m) = HARMONICS[harmonic];
            *slot *= 0.5 * real_norm(l, m);
        }
    }
}

type LegendreTable = [[f64; EMITTER_DEGREES]; ORDERS_M];

/// `P̄_l^m` for m < 5, l ≤ 16.
fn scaled_all(cos: f64, sin: f64) -> LegendreTable {
    std::array::from_fn(|m| {
        let mut row = [0.0; EMITTER_DEGREES];
        scaled_legendre(m, cos, sin, &mut row);
        row
    })
}

/// [`scaled_all`] at the inner angle of every node of the standard rule, row after row.
fn inner_legendre() -> &'static [LegendreTable] {
    static TABLE: OnceLock<Vec<LegendreTable>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let nodes = Triangle::standard().rows.iter().flat_map(|row| &row.nodes);
        nodes.map(|n| scaled_all(n.cos_inner, n.sin_inner)).collect()
    })
}

// Map: distances by `Grid` and `DistanceMap`; curves by these two functions.

/// The curves (index into [`HARMONICS`], degree l') of one function, in storage order: all with m ≤ l'.
pub fn curves(degrees: &[usize]) -> Vec<(usize, usize)> {
    let pairs = HARMONICS.iter().enumerate().flat_map(|(h, &(_, m))| degrees.iter().map(move |&degree| (h, m, degree)));
    pairs.filter(|&(_, m, degree)| m <= degree).map(|(h, _, degree)| (h, degree)).collect()
}

/// Column of curve `curve` of phase-basis function `function`, of `curves` curves.
pub fn column(curves: usize, function: usize, curve: usize) -> usize {
    function * curves + curve
}

// Store.

/// The tables of several higher orders over [`ALL_DEGREES`], side by side: columns of [`column`] with the source as function.
pub fn store_multiple(grid: Grid, shape: Shape, sources: &[Source], albedo: f64) -> Curves {
    let columns = curves(&ALL_DEGREES).len() * sources.len();
    Curves::store(grid, shape, columns, |d| {
        compute_multiple(d, sources).concat().into_iter().map(|g| albedo * g).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    fn separated(g: &[f64], degrees: &[usize], theta: f64, c: &[f64]) -> Vec<f64> {
        let p = scaled_all(theta.cos(), theta.sin());
        let mut out = vec![0.0; HARMONICS.len()];
        for (&(h, degree), g) in curves(degrees).iter().zip(g) {
            out[h] += c[degree] * p[HARMONICS[h].1][degree] * g;
        }
        out
    }

    #[test]
    fn an_isotropic_emitter_gives_the_point_table() {
        let mut worst = Worst::new("axial degree 0 against point, of l = 0", 1e-10);
        let sources: Vec<_> = (1..3).map(Source::order).collect();
        for d in [0.01, 1.0, 10.0] {
            let axial = compute_multiple(d, &sources);
            for (source, axial) in sources.iter().zip(&axial) {
                let point = crate::point::compute_multiple(d, source, DEGREES);
                let got = separated(axial, &ALL_DEGREES, 0.7, &{
                    let mut c = vec![0.0; 17];
                    c[0] = 1.0;
                    c
                });
                for (h, &(l, m)) in HARMONICS.iter().enumerate() {
                    let want = if m == 0 { point[l] } else { 0.0 };
                    worst.record((got[h] - want).abs() / point[0], || format!("d {d} {:?}", HARMONICS[h]));
                }
            }
        }
        worst.check();
    }
}
