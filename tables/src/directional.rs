//! A directional light that enters a half space of air perpendicularly: zonal coefficients about the direction towards the
//! light, by depth. Canonical: sigma_t = sigma_s = 1, irradiance 1 W/m² before the boundary.
//!
//! The half space has no end below: higher orders hold the light that comes back up from there. Near the boundary light scattered once
//! is a spike narrower than a band: with 11 bands irradiance is 4.5 % off at d = 0.01, 0.5 % at 0.1, below 0.03 % from 0.3 on, and
//! nowhere negative.

use crate::curves::{Curves, Grid, Shape};
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::slab::SlabSource;
use crate::transport::triangle::clustered_unit_rule;
use bake_optics::harmonics::y_zonal_all;

// Compute.

/// Once-scattered light at depth `d` ≥ 0, normalised: `e^d L_l`, for each function of the basis; `[function][l]`.
///
/// *Equation*: `L(μ) = p(μ) e^{−d} (1 − e^{−d(1−μ)/μ})/(1−μ)` for μ > 0, `p(μ) e^{−d}/(1−μ)` for μ ≤ 0: the deflection is the angle
/// from the light all along the ray. *Accuracy*: 1e-9 of l = 0.
pub fn compute_single(d: f64, basis: &PhaseBasis, bands: usize) -> Vec<Vec<f64>> {
    let mut sums = vec![vec![0.0; bands]; basis.len()];
    let (mut phase, mut y) = (vec![0.0; basis.len()], vec![0.0; bands]);
    let rule = clustered_unit_rule();
    for (sign, node) in [1.0, -1.0].iter().flat_map(|&s| rule.iter().map(move |n| (s, n))) {
        let mu = sign * node.low;
        // 1 − μ from the far end of the axis where μ is near 1.
        let gap = if sign > 0.0 { node.high } else { 1.0 + node.low };
        let share = if sign > 0.0 { -(-d * gap / mu).exp_m1() } else { 1.0 };
        let closing = 2.0 * (0.5 * (1.0 + mu)).sqrt().clamp(0.0, 1.0).asin();
        basis.eval(closing, &mut phase);
        y_zonal_all(mu, &mut y);
        for (sum, p) in sums.iter_mut().zip(&phase) {
            // 2π · p/(4π) · share/(1 − μ).
            let value = 0.5 * node.weight * p * share / gap;
            sum.iter_mut().zip(&y).for_each(|(s, y)| *s += value * y);
        }
    }
    sums
}

/// Light that `source` scatters once more, normalised: `e^{κd} L_l`, l < `bands`.
pub fn compute_multiple(d: f64, source: &SlabSource, bands: usize) -> Vec<f64> {
    source.zonal(d, bands)
}

// Map: as for a point light.

pub use crate::point::column;

// Store.

/// The order-1 table: columns of [`column`].
pub fn store_single(grid: Grid, basis: &PhaseBasis, bands: usize) -> Curves {
    Curves::store(grid, Shape::DIRECTIONAL, bands * basis.len(), |d| compute_single(d, basis, bands).concat())
}

/// The table of one higher order (or of all), `bands` columns; `albedo` is 1 for a table per order.
pub fn store_multiple(grid: Grid, shape: Shape, source: &SlabSource, albedo: f64, bands: usize) -> Curves {
    Curves::store(grid, shape, bands, |d| compute_multiple(d, source, bands).into_iter().map(|c| albedo * c).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::phase::Phase;
    use testkit::{compare::Worst, reference};

    #[test]
    fn the_references_are_met() {
        let Some(path) = reference::shared("reference/zh_directional_single.csv") else { return };
        let mut worst = Worst::new("zh_directional_single.csv, of l = 0", 1e-8);
        let rows = reference::read_csv(&path);
        for group in rows.chunk_by(|a, b| a.text("d") == b.text("d") && a.text("g") == b.text("g")) {
            let (d, g) = (group[0].number("d"), group[0].number("g"));
            let basis = PhaseBasis::Functions(vec![Phase::HenyeyGreenstein { g }]);
            let got = &compute_single(d, &basis, 11)[0];
            for row in group {
                let l = row.number("l") as usize;
                let error = (got[l] * (-d).exp() - row.number("L_scatter")).abs() / group[0].number("L_scatter");
                worst.record(error, || format!("d {d} g {g} l {l}"));
            }
        }
        worst.check();
    }

    /// Without absorption nothing is lost: what scattered light carries down and what is left of the beam cancel at every
    /// depth, `∫ L μ dω + e^{−d} = 0`.
    #[test]
    fn the_net_flux_of_all_orders_vanishes_without_absorption() {
        let mut worst = Worst::new("net flux in the half space, albedo 1", 2e-6);
        let source = SlabSource::all(1.0);
        let single = PhaseBasis::Legendre(1);
        for d in [0.0, 1e-3, 0.1, 1.0, 5.0, 20.0] {
            let l1 = compute_single(d, &single, 2)[0][1] * (-d).exp() + compute_multiple(d, &source, 2)[1];
            let flux = (4.0 * std::f64::consts::PI / 3.0).sqrt() * l1;
            worst.record((flux + (-d).exp()).abs(), || format!("depth {d}"));
        }
        worst.check();
        let absorbing = SlabSource::all(0.9);
        let l1 = compute_single(0.0, &single, 2)[0][1] * 0.9 + 0.9 * compute_multiple(0.0, &absorbing, 2)[1];
        assert!(
            ((4.0 * std::f64::consts::PI / 3.0).sqrt() * l1 + 1.0).abs() > 0.1,
            "an absorbing half space must not balance"
        );
    }

    #[test]
    fn all_orders_are_the_sum_of_the_orders() {
        let mut worst = Worst::new("sum of 24 orders at albedo 0.5", 1e-6);
        let mut orders = vec![SlabSource::order(None)];
        for k in 1..24 {
            orders.push(SlabSource::order(orders.get(k - 1)));
        }
        let all = SlabSource::all(0.5);
        for d in [0.01, 0.3, 1.0, 4.0] {
            let sum: f64 = orders
                .iter()
                .zip(1..)
                .map(|(source, k)| 0.5f64.powi(k) * compute_multiple(d, source, 1)[0] * (-d).exp())
                .sum();
            worst.relative(compute_multiple(d, &all, 1)[0] * (-all.rate * d).exp(), sum, || format!("d {d}"));
        }
        worst.check();
    }
}
