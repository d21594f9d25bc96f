//! A small Lambertian surface element: mirror-symmetric SH of the light it sends after one collision, by distance and by
//! θ from 0 to 180° (a surface that faces away still lights the air). Higher orders come from [`crate::axial`].
//!
//! Frame and harmonics as there. Stored is `L_lm / sin^m θ`, a smooth function of cos θ: the look-up then needs neither
//! θ nor a frame, only dot products, and nothing is special where the element faces the receiver.
//! Canonical: sigma_t = sigma_s = 1, L_o dA = 1.

use crate::axial::{DEGREES, HARMONIC_COUNT, HARMONICS};
use crate::curves::{Curves, Grid, Shape};
use crate::transport::harmonics::{real_norm, scaled_legendre};
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::triangle::Triangle;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

// Compute.

/// Nodes in β (on each side of 90°) and γ of [`compute_single`]. Where the kink of the emitter lies inside a panel it costs 1e-5
/// of the largest coefficient; at θ = 0, 90 and 180° it lies at an end.
const RULE: (usize, usize) = (256, 80);

/// Once-scattered light of a Lambertian element, normalised and stripped (`d e^d L_lm / sin^m θ`), for each function of the
/// basis and each node of the angles; `[function][node][harmonic]`, flat.
///
/// *Equation*: `L_lm = (1/4πd) ∫∫ Y_lm(γ, 0) C_m(β, θ) 4πp(cos(γ+β)) e^{−(t+r)} dγ dβ`.
pub fn compute_single(d: f64, basis: &PhaseBasis, angles: &AngleGrid) -> Vec<f64> {
    let rule = Rule::standard();
    rule.compute(d, basis, &emitter_moments(&rule.triangle, angles))
}

/// The same at many angles at once, not stripped, by a finer rule: against it the whole table is measured. It is made once for
/// all distances. *Accuracy*: 4e-5 of l = 0 at the same angle, up to 40 mean free paths.
pub struct AllAngles {
    rule: Rule,
    emitter: Vec<[f64; 5]>,
}

impl AllAngles {
    /// The nodes of the finer rule in β (on each side of 90°) and γ.
    const RULE: (usize, usize) = (384, 80);

    /// Of these angles θ.
    pub fn new(thetas: &[f64]) -> Self {
        let rule = Rule::new(Self::RULE);
        let at = |beta: f64, theta: f64| std::array::from_fn(|m| clamped_cosine_moment(m, beta, theta));
        let rows = &rule.triangle.rows;
        let emitter = rows.iter().flat_map(|row| thetas.iter().map(move |&theta| at(row.outer, theta))).collect();
        Self { rule, emitter }
    }

    /// `d e^d L_lm`; `[function][angle][harmonic]`, flat.
    pub fn compute(&self, d: f64, basis: &PhaseBasis) -> Vec<f64> {
        self.rule.compute(d, basis, &self.emitter)
    }
}

/// Places of the scattering point.
struct Rule {
    triangle: Triangle,
    /// `Y_lm(γ, 0)` at every place.
    inner_harmonics: Vec<[f64; HARMONIC_COUNT]>,
}

impl Rule {
    fn new((outer, inner): (usize, usize)) -> Self {
        let triangle = Triangle::rectangular(outer, inner, &[FRAC_PI_2]);
        let at = |n: &crate::transport::triangle::Node| {
            HARMONICS.map(|(l, m)| {
                let mut p = [0.0; DEGREES];
                scaled_legendre(m, n.cos_inner, n.sin_inner, &mut p);
                real_norm(l, m) * p[l]
            })
        };
        let inner_harmonics = triangle.rows.iter().flat_map(|row| &row.nodes).map(at).collect();
        Self { triangle, inner_harmonics }
    }

    /// That of [`compute_single`].
    fn standard() -> &'static Self {
        static STANDARD: OnceLock<Rule> = OnceLock::new();
        STANDARD.get_or_init(|| Self::new(RULE))
    }

    /// The integral from the emitter's moments at all rows and angles, which do not depend on the distance.
    fn compute(&self, d: f64, basis: &PhaseBasis, emitter: &[[f64; 5]]) -> Vec<f64> {
        let rows = &self.triangle.rows;
        let (functions, angles) = (basis.len(), emitter.len() / rows.len());
        let mut sums = vec![0.0; functions * angles * HARMONIC_COUNT];
        let (mut at_node, mut inner) = (vec![0.0; functions], vec![[0.0; HARMONIC_COUNT]; functions]);
        for (row, emitter) in rows.iter().zip(emitter.chunks_exact(angles)) {
            inner.fill([0.0; HARMONIC_COUNT]);
            for (n, y) in row.nodes.iter().zip(&self.inner_harmonics[row.first..]) {
                let value = n.weight * (-d * (n.side_outer + n.side_inner - 1.0)).exp();
                basis.eval(n.closing, &mut at_node);
                for (lane, phase) in inner.iter_mut().zip(&at_node) {
                    let value = value * phase;
                    (0..HARMONIC_COUNT).for_each(|h| lane[h] += value * y[h]);
                }
            }
            let weight = row.weight / (4.0 * PI);
            for (block, lane) in sums.chunks_exact_mut(angles * HARMONIC_COUNT).zip(&inner) {
                for (sum, c) in block.chunks_exact_mut(HARMONIC_COUNT).zip(emitter) {
                    (0..HARMONIC_COUNT).for_each(|h| sum[h] += weight * c[HARMONICS[h].1] * lane[h]);
                }
            }
        }
        sums
    }
}

/// `C_m(β, θ)/sin^m θ`, m < 5, for every row of the rule and every node of the angles.
fn emitter_moments(rule: &Triangle, angles: &AngleGrid) -> Vec<[f64; 5]> {
    let at = |beta: f64, node: usize| -> [f64; 5] {
        std::array::from_fn(|m| {
            let theta = angles.theta_to_compute(node, m);
            match (m, theta.sin() < 1e-9) {
                (1, true) => {
                    if theta.cos() * beta.cos() > 0.0 {
                        PI * beta.sin()
                    } else {
                        0.0
                    }
                }
                _ => clamped_cosine_moment(m, beta, theta) / theta.sin().powi(m as i32),
            }
        })
    };
    rule.rows.iter().flat_map(|row| (0..angles.nodes).map(move |node| at(row.outer, node))).collect()
}

/// `C_m(β, θ) = ∫_0^{2π} cos(mφ) max(0, cos β cos θ + sin β sin θ cos φ) dφ` in closed form.
pub fn clamped_cosine_moment(m: usize, beta: f64, theta: f64) -> f64 {
    let (a, b) = (beta.cos() * theta.cos(), beta.sin() * theta.sin());
    let p = match (b == 0.0, a > 0.0) {
        (true, true) => PI,
        (true, false) => 0.0,
        _ => (-a / b).clamp(-1.0, 1.0).acos(),
    };
    let k = m as f64;
    match m {
        0 => 2.0 * (a * p + b * p.sin()),
        1 => 2.0 * (a * p.sin() + b * (p / 2.0 + (2.0 * p).sin() / 4.0)),
        _ => {
            let beat = ((k - 1.0) * p).sin() / (k - 1.0) + ((k + 1.0) * p).sin() / (k + 1.0);
            2.0 * (a * (k * p).sin() / k + b / 2.0 * beat)
        }
    }
}

/// The same without nodes: any angle, any harmonics (l, m), panels split at the emitter's kinks; `d e^d L_lm`, not stripped.
/// `[function][harmonic]`. What the table is measured against. *Accuracy*: 1e-7 of l = 0 with 64 `nodes`.
pub fn compute_exact(
    d: f64,
    theta: f64,
    basis: &PhaseBasis,
    harmonics: &[(usize, usize)],
    nodes: usize,
) -> Vec<Vec<f64>> {
    let rule = Triangle::with_kinks(nodes, &[(FRAC_PI_2 - theta).abs(), PI - (FRAC_PI_2 - theta).abs()], &[]);
    let bands = harmonics.iter().map(|&(l, _)| l + 1).max().unwrap_or(1);
    let mut sums = vec![vec![0.0; harmonics.len()]; basis.len()];
    let (mut at_node, mut p) = (vec![0.0; basis.len()], vec![0.0; bands * bands]);
    for row in &rule.rows {
        let emitter: Vec<f64> = (0..bands).map(|m| clamped_cosine_moment(m, row.outer, theta)).collect();
        for n in &row.nodes {
            let value = row.weight * n.weight * (-d * (n.side_outer + n.side_inner - 1.0)).exp() / (4.0 * PI);
            basis.eval(n.closing, &mut at_node);
            for (m, lanes) in p.chunks_exact_mut(bands).enumerate() {
                scaled_legendre(m, n.cos_inner, n.sin_inner, lanes);
            }
            for (sum, phase) in sums.iter_mut().zip(&at_node) {
                for (slot, &(l, m)) in sum.iter_mut().zip(harmonics) {
                    *slot += value * phase * real_norm(l, m) * p[m * bands + l] * emitter[m];
                }
            }
        }
    }
    sums
}

// Map.

/// Stored nodes over c = cos θ from −1 to 1, uniform in `s = c sqrt((1 + k)/(k + c²))`: closer at 90°, where the emitter's kink is, and
/// smooth in between.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AngleGrid {
    /// Number of nodes, odd, at least 3.
    pub nodes: usize,
    /// k: nodes lie closer at 90° than at the ends by `((1 + k)/k)^{3/2}`.
    pub crowding: f64,
}

impl Default for AngleGrid {
    /// 49 nodes, 6.5 times closer at 90°: there and behind the emitter they then err about as much, 40 mean free paths away.
    fn default() -> Self {
        Self { nodes: 49, crowding: 0.4 }
    }
}

impl AngleGrid {
    /// Mapping: node index, fractions allowed → cos θ.
    pub fn cosine(&self, index: f64) -> f64 {
        let s = 2.0 * index / (self.nodes - 1) as f64 - 1.0;
        s * (self.crowding / (1.0 + self.crowding - s * s)).sqrt()
    }

    /// Mapping: cos θ → node index, the inverse of [`AngleGrid::cosine`].
    pub fn index(&self, cosine: f64) -> f64 {
        let stretch = ((1.0 + self.crowding) / (self.crowding + cosine * cosine)).sqrt();
        0.5 * (cosine * stretch + 1.0) * (self.nodes - 1) as f64
    }

    /// θ at which a node is computed. At 0 and 180° the quotient by sin^m θ, m ≥ 2, is read half a node inside: it is smooth
    /// there and weighs sin^m θ.
    fn theta_to_compute(&self, node: usize, m: usize) -> f64 {
        let last = self.nodes - 1;
        let inside = if m >= 2 && (node == 0 || node == last) {
            (node as f64 - 0.5).abs().min(last as f64 - 0.5)
        } else {
            node as f64
        };
        self.cosine(inside).clamp(-1.0, 1.0).acos()
    }
}

/// Column of harmonic h at angle node i of phase-basis function j.
pub fn column(angles: &AngleGrid, function: usize, node: usize, harmonic: usize) -> usize {
    (function * angles.nodes + node) * HARMONIC_COUNT + harmonic
}

// Store.

/// The order-1 table: columns of [`column`].
pub fn store_single(grid: Grid, angles: AngleGrid, basis: &PhaseBasis) -> Curves {
    let columns = basis.len() * angles.nodes * HARMONIC_COUNT;
    let rule = Rule::standard();
    let emitter = emitter_moments(&rule.triangle, &angles);
    Curves::store(grid, Shape::POINT_SINGLE, columns, |d| rule.compute(d, basis, &emitter))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resample;
    use bake_optics::phase::Phase;
    use testkit::compare::Worst;

    #[test]
    fn the_angle_mapping_is_its_own_inverse() {
        let grid = AngleGrid::default();
        for i in 0..=480 {
            let x = i as f64 * 0.1;
            assert!((grid.index(grid.cosine(x)) - x).abs() < 1e-9, "{x}");
        }
        assert_eq!((grid.cosine(0.0), grid.cosine(24.0), grid.cosine(48.0)), (-1.0, 0.0, 1.0));
    }

    #[test]
    fn all_angles_at_once_are_those_of_the_exact_rule() {
        // A thirtieth of the error that is measured against it.
        let mut worst = Worst::new("all angles at once, of l = 0", 1e-4);
        let basis =
            PhaseBasis::Functions(vec![Phase::HenyeyGreenstein { g: -0.6 }, Phase::HenyeyGreenstein { g: 0.6 }]);
        let thetas = [1.0, 47.0, 89.3, 90.0, 91.2, 133.0, 164.0, 178.0f64].map(f64::to_radians);
        let direct = AllAngles::new(&thetas);
        for d in [2e-3, 0.1, 4.0, 40.0] {
            let all = direct.compute(d, &basis);
            let places = (0..2).flat_map(|f| thetas.iter().map(move |theta| (f, *theta)));
            for ((f, theta), got) in places.zip(all.chunks_exact(HARMONIC_COUNT)) {
                let want = &compute_exact(d, theta, &basis, &HARMONICS, 64)[f];
                for (got, want_h) in got.iter().zip(want) {
                    worst.record((got - want_h).abs() / want[0], || format!("d {d} theta {:.1}", theta.to_degrees()));
                }
            }
        }
        worst.check();
    }

    /// Largest error of the cubic between `nodes` stored angles, of l = 0 at the same angle.
    fn angle_error(nodes: usize) -> f64 {
        let angles = AngleGrid { nodes, ..AngleGrid::default() };
        let basis = PhaseBasis::Functions(vec![Phase::HenyeyGreenstein { g: 0.5 }]);
        let thetas = [3.0, 20.0, 45.0, 57.0, 83.0, 88.0, 89.3, 91.0, 104.0, 135.0, 163.0f64].map(f64::to_radians);
        let mut worst = Worst::new(format!("{nodes} angle nodes, of l = 0"), 1.0);
        for d in [0.1, 5.0, 40.0] {
            let table = compute_single(d, &basis, &angles);
            let nodes: Vec<[f64; HARMONIC_COUNT]> =
                table.chunks_exact(HARMONIC_COUNT).map(|c| std::array::from_fn(|h| c[h])).collect();
            let read = resample::angles(&nodes, thetas.iter().map(|theta| angles.index(theta.cos())));
            for (theta, got) in thetas.iter().zip(read) {
                let exact = &compute_exact(d, *theta, &basis, &HARMONICS, 48)[0];
                for ((got, want), (l, m)) in got.iter().zip(exact).zip(HARMONICS) {
                    let error = (got * theta.sin().powi(m as i32) - want).abs() / exact[0];
                    worst.record(error, || format!("d {d} theta {:.1} {l},{m}", theta.to_degrees()));
                }
            }
        }
        worst.check();
        worst.measured()
    }

    #[test]
    fn the_error_between_angles_falls_as_a_cubic_does_up_to_the_kink() {
        let counts = [17.0f64, 25.0, 33.0, 49.0];
        let errors: Vec<f64> = counts.iter().map(|&n| angle_error(n as usize).ln()).collect();
        let slope = testkit::statistics::slope(&counts.map(f64::ln), &errors);
        println!("slope over angle nodes {slope:.2}");
        // 4 for a smooth function, 1 for a bare kink; the emitter's, smoothed by the air, leaves 2.
        assert!((-4.6..-1.6).contains(&slope), "{slope}");
    }
}
