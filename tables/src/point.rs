//! A point light: zonal coefficients about the direction from the receiver to the light, by distance.
//!
//! Canonical: sigma_t = sigma_s = 1, intensity 1 W/sr; coefficients in W/(m² sr). Order 0 is never in a table.

use crate::curves::{Curves, Grid, Shape};
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::sources::{Source, zonal_moments};
use crate::transport::triangle::Triangle;
use bake_optics::harmonics::zonal_from_legendre;
use bake_optics::legendre::legendre_all;
use std::f64::consts::PI;

// Compute.

/// Once-scattered light at distance `d` ≥ 0, normalised: `d e^d L_l`, for each function of the basis; `[function][l]`, l < `bands`.
///
/// *Equation*: `L_l = (1/2d) ∫_0^π dγ y_l(cos γ) ∫_0^{π−γ} dβ 4πp(cos(γ+β)) e^{−(t+r)}` (single scattering in the two base
/// angles of the triangle source – scatter – receiver). *Accuracy*: 3e-7 of l = 0 for l ≤ 16, d ≥ 1e-3.
pub fn compute_single(d: f64, basis: &PhaseBasis, bands: usize) -> Vec<Vec<f64>> {
    let mut sums = vec![vec![0.0; bands]; basis.len()];
    let (mut lanes, mut at_node, mut p) = (vec![0.0; basis.len()], vec![0.0; basis.len()], vec![0.0; bands]);
    for row in &Triangle::standard().rows {
        lanes.fill(0.0);
        for n in &row.nodes {
            let value = n.weight * (-d * (n.side_outer + n.side_inner - 1.0)).exp();
            basis.eval(n.closing, &mut at_node);
            lanes.iter_mut().zip(&at_node).for_each(|(lane, p)| *lane += value * p);
        }
        legendre_all(row.cos_outer, &mut p);
        for (sum, lane) in sums.iter_mut().zip(&lanes) {
            sum.iter_mut().zip(&p).for_each(|(s, p)| *s += 0.5 * row.weight * lane * p);
        }
    }
    sums.iter().map(|moments| from_moments(moments)).collect()
}

/// Light that `source` scatters once more, normalised: `d e^{κd} L_l`, l < `bands`.
///
/// *Equation*: `L_l = (1/2d) ∫∫ y_l(cos γ) e^{−t} r² φ(r) dβ dγ`. *Accuracy*: 1e-6 of l = 0.
pub fn compute_multiple(d: f64, source: &Source, bands: usize) -> Vec<f64> {
    from_moments(&zonal_moments(d, source.rate, |r| source.moments.eval(r), bands))
}

/// Zonal coefficients from Legendre moments m_l of the radiance: `sqrt((2l+1)/4π) m_l`.
fn from_moments(moments: &[f64]) -> Vec<f64> {
    let legendre: Vec<f64> = moments.iter().enumerate().map(|(l, m)| m * (2 * l + 1) as f64 / (4.0 * PI)).collect();
    zonal_from_legendre(&legendre)
}

// Map: distances by `Grid` and `DistanceMap`; columns by this one function.

/// Column of coefficient l of phase-basis function j.
pub fn column(bands: usize, function: usize, l: usize) -> usize {
    function * bands + l
}

// Store.

/// The order-1 table: columns of [`column`].
pub fn store_single(grid: Grid, basis: &PhaseBasis, bands: usize) -> Curves {
    Curves::store(grid, Shape::POINT_SINGLE, bands * basis.len(), |d| compute_single(d, basis, bands).concat())
}

/// The table of one higher order (or of all), `bands` columns; `albedo` is 1 for a table per order.
pub fn store_multiple(grid: Grid, shape: Shape, source: &Source, albedo: f64, bands: usize) -> Curves {
    Curves::store(grid, shape, bands, |d| compute_multiple(d, source, bands).into_iter().map(|c| albedo * c).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::phase::Phase;
    use testkit::{compare::Worst, reference};

    #[test]
    fn the_single_scattering_references_are_met() {
        let Some(path) = reference::shared("reference/zh_point_single.csv") else { return };
        let mut worst = Worst::new("zh_point_single.csv, of l = 0", 1e-6);
        let rows = reference::read_csv(&path);
        for group in rows.chunk_by(|a, b| a.text("d") == b.text("d") && a.text("g") == b.text("g")) {
            let (d, g) = (group[0].number("d"), group[0].number("g"));
            let basis = PhaseBasis::Functions(vec![Phase::HenyeyGreenstein { g }]);
            let got = &compute_single(d, &basis, 11)[0];
            for row in group {
                let (l, scale) = (row.number("l") as usize, (-d).exp() / d);
                let error = (got[l] * scale - row.number("L_scatter")).abs() / group[0].number("L_scatter");
                worst.record(error, || format!("d {d} g {g} l {l}"));
            }
        }
        worst.check();
    }

    #[test]
    fn the_multiple_scattering_references_are_met() {
        let Some(path) = reference::shared("reference/zh_point_multi.csv") else { return };
        let mut worst = Worst::new("zh_point_multi.csv, of l = 0", 1e-6);
        let rows: Vec<_> = reference::read_csv(&path).into_iter().filter(|r| r.number("k") >= 2.0).collect();
        let orders: Vec<_> = (1..10).map(Source::order).collect();
        for group in rows.chunk_by(|a, b| a.text("d") == b.text("d") && a.text("k") == b.text("k")) {
            let (d, k) = (group[0].number("d"), group[0].number("k") as usize);
            let got = compute_multiple(d, &orders[k - 2], 11);
            for row in group {
                let (l, scale) = (row.number("l") as usize, (-d).exp() / d);
                let error = (got[l] * scale - row.number("L_kl")).abs() / group[0].number("L_kl");
                worst.record(error, || format!("d {d} k {k} l {l}"));
            }
        }
        worst.check();
    }
}
