//! Spots by seventeen Legendre coefficients against the whole series: what the degrees beyond weigh, at every angle and up to 18 mean
//! free paths, where almost nothing of the light is left.
//!
//! By reciprocity the fluence of an emitter `Σ c_l P_l` is `Σ c_l m_l(d) P_l(cos θ)`, m_l the moments of the radiance that an isotropic
//! emitter sends: one quadrature for any number of degrees, no table.

use std::f64::consts::PI;

use bake_optics::harmonics::clamped_cosine;
use bake_optics::legendre::legendre_all;
use rayon::prelude::*;
use tables::transport::fluence::{Fluence, Pole};
use tables::transport::profile::Profile;
use tables::transport::triangle::Triangle;
use tables::{Air, AxialResponse, Scatter, TableSet};
use testkit::compare::Worst;

/// Degrees of the whole series: those beyond weigh below 0.6 % for a spot of 10°, 0.2 % for one of 20°.
const DEGREES: usize = 400;

/// Albedo of the sums without end.
const ALBEDO: f64 = 0.8;

/// `(2l+1)/2 ∫ I P_l dμ` of glTF's falloff between two half angles.
fn spot(inner: f64, outer: f64) -> Vec<f64> {
    let (inner, outer) = (inner.to_radians().cos(), outer.to_radians().cos());
    let (mut sums, mut p, count) = (vec![0.0; DEGREES], vec![0.0; DEGREES], 20_000);
    for i in 0..count {
        // Dark outside the cone.
        let mu = outer + (1.0 - outer) * (f64::from(i) + 0.5) / f64::from(count);
        legendre_all(mu, &mut p);
        let weight = (1.0 - outer) / f64::from(count) * ((mu - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
        sums.iter_mut().zip(&p).enumerate().for_each(|(l, (sum, p))| *sum += (l as f64 + 0.5) * weight * p);
    }
    sums
}

/// Fluence of light that scatters once more, from its source before that.
struct Exact {
    scatter: Scatter,
    air: Air,
    rate: f64,
    source: Profile,
}

impl Exact {
    fn new(scatter: Scatter) -> Self {
        let (albedo, rate, fluence) = match scatter {
            Scatter::AllMultiple => (ALBEDO, Pole::new(ALBEDO).rate, Fluence::from_order_on(1, ALBEDO)),
            _ => (1.0, 1.0, Fluence::order(1)),
        };
        let nodes = Profile::nodes(1e-6, 500.0, 480);
        let rows: Vec<_> = nodes.par_iter().map(|&r| vec![albedo * r * r * fluence.eval_scaled(r, rate)]).collect();
        Self { scatter, air: Air::isotropic(albedo), rate, source: Profile::new(1e-6, 500.0, &rows) }
    }

    /// `½ ∫∫ P_l(cos γ) e^{−t} q(r) e^{−κ(r−d)} dβ dγ`, d e^{κd} times m_l.
    fn moments(&self, d: f64) -> Vec<f64> {
        let (mut sums, mut p) = (vec![0.0; DEGREES], vec![0.0; DEGREES]);
        for row in &Triangle::new(300).rows {
            let inner = row.nodes.iter().map(|n| {
                n.weight
                    * self.source.eval(d * n.side_outer)
                    * (-d * (self.rate * (n.side_outer - 1.0) + n.side_inner)).exp()
            });
            let value = 0.5 * row.weight * inner.sum::<f64>();
            legendre_all(row.cos_outer, &mut p);
            sums.iter_mut().zip(&p).for_each(|(sum, p)| *sum += p * value);
        }
        sums
    }
}

/// Largest errors of l = 0 at the same place, towards the spot (below 110°) and behind it: of the look-up, and of the series without filter.
struct Errors {
    look_up: [f64; 2],
    plain: [f64; 2],
}

fn errors(exact: &Exact, response: &AxialResponse, c: &[f64], d: f64) -> Errors {
    let moments = exact.moments(d);
    let mut errors = Errors { look_up: [0.0; 2], plain: [0.0; 2] };
    for degrees in (0..=180).step_by(3) {
        let cos = f64::from(degrees).to_radians().cos();
        let mut p = vec![0.0; DEGREES];
        legendre_all(cos, &mut p);
        let sum = |count: usize| (0..count).map(|l| c[l] * moments[l] * p[l]).sum::<f64>();
        let (want, plain) = (sum(DEGREES), sum(17));
        let got = f64::from(response.coefficients(1.0, d as f32, cos as f32)[0])
            * (4.0 * PI).sqrt()
            * d
            * (exact.rate * d).exp();
        let zone = usize::from(degrees >= 110);
        errors.look_up[zone] = errors.look_up[zone].max((got / want - 1.0).abs());
        errors.plain[zone] = errors.plain[zone].max((plain / want - 1.0).abs());
    }
    errors
}

/// A spot and what seventeen degrees are allowed to lose of it.
struct Spot {
    /// Half angles between which it fades.
    cone: (f64, f64),
    /// Towards it: order 2, all orders from 2 on.
    towards: [f64; 2],
    /// Behind it.
    behind: f64,
}

/// The narrow one is beyond seventeen degrees: what it loses is known, and no more.
const SPOTS: [Spot; 3] = [
    Spot { cone: (10.0, 20.0), towards: [0.1, 0.02], behind: 0.01 },
    Spot { cone: (30.0, 45.0), towards: [0.03, 0.01], behind: 0.01 },
    Spot { cone: (5.0, 10.0), towards: [0.6, 0.05], behind: 0.01 },
];

#[test]
fn seventeen_degrees_do_for_a_spot_and_its_back() {
    let mut plain = Worst::new("order 2 behind a spot without the filter, of l = 0", 0.01);
    for (i, exact) in [Exact::new(Scatter::Multiple(2)), Exact::new(Scatter::AllMultiple)].iter().enumerate() {
        for Spot { cone: (inner, outer), towards, behind } in SPOTS {
            let orders = ["order 2", "all orders from 2 on"][i];
            let mut worst = [("towards", towards[i]), ("behind", behind)]
                .map(|(zone, limit)| Worst::new(format!("{orders}, {zone} a spot of {outer}°, of l = 0"), limit));
            let c = spot(inner, outer);
            let response = TableSet::embedded().axial(&c[..17], &exact.air, exact.scatter);
            let distances = [0.3, 1.0, 3.0, 10.0, 18.0];
            let all: Vec<_> = distances.par_iter().map(|&d| errors(exact, &response, &c, d)).collect();
            for (d, Errors { look_up, plain: unfiltered }) in distances.iter().zip(all) {
                let what = || format!("spot of {outer}° d {d}");
                println!(
                    "{} {orders}: towards {:.2} %, behind {:.2} %, without filter {:.2} %",
                    what(),
                    100.0 * look_up[0],
                    100.0 * look_up[1],
                    100.0 * unfiltered[1]
                );
                worst.iter_mut().zip(look_up).for_each(|(worst, error)| worst.record(error, what));
                if i == 0 {
                    plain.record(unfiltered[1], what);
                }
            }
            worst.iter().for_each(Worst::check);
        }
    }
    assert!(plain.measured() > 0.3, "the ripple must show");
}

/// A surface's light by seventeen degrees, its kink at 90° included: within 0.3 % up to 8 mean free paths, summed over all orders up to
/// the last. Order 2 alone is known to lose more beyond, where it is a thousandth of all.
#[test]
fn seventeen_degrees_do_for_a_surface() {
    let cosine = clamped_cosine::<f64>(DEGREES);
    let c: Vec<f64> = cosine.iter().enumerate().map(|(l, a)| a * (2 * l + 1) as f64 / (4.0 * PI)).collect();
    for (scatter, limits) in [(Scatter::Multiple(2), [3e-3, 1.2e-2]), (Scatter::AllMultiple, [3e-3, 3e-3])] {
        let exact = Exact::new(scatter);
        let mut worst = ["up to", "beyond"]
            .into_iter()
            .zip(limits)
            .map(|(range, limit)| Worst::new(format!("area, {scatter:?}, {range} 8 mean free paths, of l = 0"), limit))
            .collect::<Vec<_>>();
        let mut plain = 0.0f64;
        let response = TableSet::embedded().area(&exact.air, scatter);
        for d in [0.1, 1.0, 3.0, 8.0, 18.0, 28.0, 40.0] {
            let Errors { look_up, plain: unweakened } = errors(&exact, &response, &c, d);
            println!("{scatter:?} d {d}: look-up {look_up:.5?}, plain series {unweakened:.5?}");
            look_up.iter().for_each(|error| worst[usize::from(d > 8.0)].record(*error, || format!("d {d}")));
            plain = plain.max(unweakened[1]);
        }
        worst.iter().for_each(Worst::check);
        // Negative control: the series as it is, behind.
        assert!(scatter == Scatter::AllMultiple || plain > limits[1], "{plain}");
    }
}
