//! A surface's light scattered twice or more, through the shipped tables: all harmonics, every angle with the kink at 90°, every
//! distance that is stored, against a series so long that its end does not count.

use std::f64::consts::PI;

use bake_optics::harmonics::clamped_cosine;
use bake_optics::legendre::legendre_all;
use rayon::prelude::*;
use tables::axial::{HARMONIC_COUNT, HARMONICS};
use tables::transport::fluence::{Fluence, Pole};
use tables::transport::harmonics::{real_norm, scaled_legendre};
use tables::transport::profile::Profile;
use tables::transport::triangle::Triangle;
use tables::{Air, AxialResponse, Scatter, TableSet};
use testkit::compare::Worst;

/// Degrees of the long series: those beyond weigh 2e-4 of l = 0 at 45 mean free paths and 90°, less elsewhere.
const DEGREES: usize = 161;

/// Nodes over the angle in which a degree oscillates, and over the other.
const RULE: (usize, usize) = (768, 96);

/// Albedo of the sums without end.
const ALBEDO: f64 = 0.8;

/// Largest m of the harmonics, plus one.
const ORDERS_M: usize = 5;

/// The Lambertian emitter's series without the terms that vanish: degree, `A_l (2l+1)/(4π)`.
fn cosine_series() -> Vec<(usize, f64)> {
    let a = clamped_cosine::<f64>(DEGREES);
    let terms = a.iter().enumerate().map(|(l, a)| (l, a * (2 * l + 1) as f64 / (4.0 * PI)));
    terms.filter(|(l, _)| *l < 2 || l % 2 == 0).collect()
}

/// Direct evaluation of the light of one order, or of all from two on.
struct Exact {
    albedo: f64,
    rate: f64,
    series: Vec<(usize, f64)>,
    /// By term of the series, `r² f_l(r) e^{κr}` of the light that scatters last.
    source: Profile,
}

impl Exact {
    /// `order` 2 … 10 at albedo 1, or all (`None`) at [`ALBEDO`].
    fn new(order: Option<usize>) -> Self {
        type Unscattered = Box<dyn Fn(f64) -> f64 + Sync>;
        let (albedo, rate, before): (f64, f64, Unscattered) = match order {
            Some(2) => (1.0, 1.0, Box::new(|_| 1.0)),
            Some(order) => {
                let fluence = Fluence::order(order - 2);
                (1.0, 1.0, Box::new(move |r| r * r * fluence.eval_scaled(r, 1.0)))
            }
            None => {
                let (rate, fluence) = (Pole::new(ALBEDO).rate, Fluence::from_order_on(1, ALBEDO));
                let q = move |r: f64| (-(1.0 - rate) * r).exp() + r * r * fluence.eval_scaled(r, rate);
                (ALBEDO, rate, Box::new(q))
            }
        };
        let (series, rule) = (cosine_series(), Triangle::rectangular(RULE.0, RULE.1, &[]));
        let (from, to) = (1e-6, 500.0);
        // The fluence before in closed form costs a sum of 400 terms: read from a profile, as q.
        let nodes = Profile::nodes(from, to, 480);
        let rows: Vec<_> = nodes.par_iter().map(|&r| vec![before(r)]).collect();
        let before = Profile::new(from, to, &rows);
        // The moment of degree l of what an isotropic emitter sends to r: the outer angle is at the receiver.
        let moments = |&r: &f64| -> Vec<f64> {
            let (mut sums, mut p) = (vec![0.0; series.len()], vec![0.0; DEGREES]);
            for row in &rule.rows {
                let value = row.nodes.iter().map(|n| {
                    n.weight * before.eval(r * n.side_outer) * (-r * (rate * (n.side_outer - 1.0) + n.side_inner)).exp()
                });
                let value = 0.5 * albedo * r * row.weight * value.sum::<f64>();
                legendre_all(row.cos_outer, &mut p);
                sums.iter_mut().zip(&series).for_each(|(sum, &(l, _))| *sum += p[l] * value);
            }
            sums
        };
        let nodes = Profile::nodes(from, to, 240);
        let rows: Vec<_> = nodes.par_iter().map(moments).collect();
        Self { albedo, rate, source: Profile::new(from, to, &rows), series }
    }

    /// `d e^{κd} L_lm` at each angle θ. Here the outer angle is at the emitter.
    fn at(&self, d: f64, thetas: &[f64]) -> Vec<[f64; HARMONIC_COUNT]> {
        let mut curves = vec![[0.0; HARMONIC_COUNT]; self.series.len()];
        let mut q = vec![0.0; self.series.len()];
        let mut inner = vec![[0.0; HARMONIC_COUNT]; self.series.len()];
        for row in &Triangle::rectangular(RULE.0, RULE.1, &[]).rows {
            inner.fill([0.0; HARMONIC_COUNT]);
            for n in &row.nodes {
                let value = n.weight * (-d * (self.rate * (n.side_inner - 1.0) + n.side_outer)).exp();
                let p = legendre::<9>(n.cos_inner, n.sin_inner);
                let y: [f64; HARMONIC_COUNT] = std::array::from_fn(|h| {
                    value * real_norm(HARMONICS[h].0, HARMONICS[h].1) * p[HARMONICS[h].1][HARMONICS[h].0]
                });
                self.source.read(&self.source.place(d * n.side_inner), &mut q);
                for (sum, q) in inner.iter_mut().zip(&q) {
                    (0..HARMONIC_COUNT).for_each(|h| sum[h] += q * y[h]);
                }
            }
            let p = legendre::<DEGREES>(row.cos_outer, row.outer.sin());
            for ((sum, inner), &(l, _)) in curves.iter_mut().zip(&inner).zip(&self.series) {
                (0..HARMONIC_COUNT).for_each(|h| sum[h] += 0.5 * row.weight * p[HARMONICS[h].1][l] * inner[h]);
            }
        }
        let at = |theta: &f64| {
            let p = legendre::<DEGREES>(theta.cos(), theta.sin());
            let terms = self.series.iter().zip(&curves);
            std::array::from_fn(|h| {
                self.albedo * terms.clone().map(|(&(l, c), curves)| c * p[HARMONICS[h].1][l] * curves[h]).sum::<f64>()
            })
        };
        thetas.iter().map(at).collect()
    }
}

/// `P̄_l^m`, m < 5.
fn legendre<const N: usize>(cos: f64, sin: f64) -> [[f64; N]; ORDERS_M] {
    std::array::from_fn(|m| {
        let mut row = [0.0; N];
        scaled_legendre(m, cos, sin, &mut row);
        row
    })
}

/// κ; by distance and angle, `d e^{κd} L_lm`.
type Values = (f64, Vec<Vec<[f64; HARMONIC_COUNT]>>);

#[test]
fn a_surface_is_met_in_every_order_up_to_the_last_distance() {
    let long = std::env::var_os("BAKE_LONG").is_some();
    let distances: &[f64] = if long {
        &[1e-3, 0.01, 0.1, 0.5, 1.0, 3.0, 8.0, 13.0, 18.0, 23.0, 28.0, 34.0, 40.0, 44.9]
    } else {
        &[1e-3, 0.1, 3.0, 18.0, 44.9]
    };
    let degrees = (0..=36).map(|i| 5.0 * f64::from(i)).chain((-20..=20).map(|i| 90.1 + 0.4 * f64::from(i)));
    let thetas: Vec<f64> = degrees.map(f64::to_radians).collect();
    let exact = |light: Option<usize>| {
        let exact = Exact::new(light);
        let values: Vec<_> = distances.par_iter().map(|&d| exact.at(d, &thetas)).collect();
        (exact.rate, values)
    };
    let compare = |what: &str, response: &AxialResponse, (rate, values): &Values| {
        let mut worst = Worst::new(format!("area, {what}, of l = 0 at the same angle"), 3e-3);
        for (&d, values) in distances.iter().zip(values) {
            let scale = d * (rate * d).exp();
            for (theta, want) in thetas.iter().zip(values) {
                let got = response.coefficients(1.0, d as f32, theta.cos() as f32);
                for (h, (l, m)) in HARMONICS.into_iter().enumerate() {
                    let got = f64::from(got[h]) * theta.sin().powi(m as i32) * scale;
                    let place = || format!("d {d} theta {:.1} {l},{m}", theta.to_degrees());
                    worst.record((got - want[h]).abs() / want[0], place);
                }
            }
        }
        worst
    };
    let check = |what: &str, air: Air, scatter: Scatter, exact: &Values| {
        compare(what, &TableSet::embedded().area(&air, scatter), exact).check();
    };
    let mut sum: Option<Values> = None;
    for order in 2..=if long { 10 } else { 3 } {
        let this = exact(Some(order));
        check(&format!("order {order}"), Air::isotropic(1.0), Scatter::Order(order), &this);
        if order == 2 {
            // Negative control: the series cut after the stored degrees.
            let cut = &tables::cosine_legendre()[..17];
            let cut = TableSet::embedded().axial(cut, &Air::isotropic(1.0), Scatter::Order(2));
            assert!(!compare("order 2, cut", &cut, &this).holds(), "the end of the series must be missed");
        }
        let sum = sum.get_or_insert_with(|| (this.0, vec![vec![[0.0; HARMONIC_COUNT]; thetas.len()]; distances.len()]));
        let pairs = sum.1.iter_mut().flatten().flatten().zip(this.1.iter().flatten().flatten());
        pairs.for_each(|(sum, this)| *sum += this);
        check(&format!("orders 2 to {order}"), Air::isotropic(1.0), Scatter::Multiple(order), sum);
    }
    check("all orders from two on", Air::isotropic(ALBEDO), Scatter::AllMultiple, &exact(None));
}
