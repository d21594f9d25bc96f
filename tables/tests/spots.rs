//! Spots by as many Legendre coefficients as are summed against the whole series, at every angle and up to 18 mean free paths, where
//! almost nothing of the light is left; and what a series cut after the stored seventeen would lose.
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
use tables::{Air, AxialResponse, SERIES_DEGREES, Scatter, TableSet};
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
        for row in &Triangle::rectangular(1500, 96, &[]).rows {
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

/// Largest errors of l = 0 at the same place, towards the spot (below 110°) and behind it: of the look-up, and of the plain series of
/// the stored degrees.
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

/// A spot and what a look-up may err.
struct Spot {
    /// Half angles between which it fades.
    cone: (f64, f64),
    /// Towards it: order 2, all orders from 2 on.
    towards: [f64; 2],
}

const SPOTS: [Spot; 3] = [
    Spot { cone: (10.0, 20.0), towards: [0.01, 0.003] },
    Spot { cone: (30.0, 45.0), towards: [0.005, 0.003] },
    Spot { cone: (5.0, 10.0), towards: [0.03, 0.01] },
];

#[test]
fn spots_are_met_in_their_beam_and_behind() {
    let mut plain = [Worst::new("cut after the stored degrees, towards", 0.03), Worst::new("the same, behind", 0.01)];
    for (i, exact) in [Exact::new(Scatter::Multiple(2)), Exact::new(Scatter::AllMultiple)].iter().enumerate() {
        for Spot { cone: (inner, outer), towards } in SPOTS {
            let orders = ["order 2", "all orders from 2 on"][i];
            let mut worst = [("towards", towards[i]), ("behind", 3e-3)]
                .map(|(zone, limit)| Worst::new(format!("{orders}, {zone} a spot of {outer}°, of l = 0"), limit));
            let c = spot(inner, outer);
            let response = TableSet::embedded().axial(&c[..SERIES_DEGREES], &exact.air, exact.scatter);
            let distances = [0.3, 1.0, 3.0, 10.0, 18.0];
            let all: Vec<_> = distances.par_iter().map(|&d| errors(exact, &response, &c, d)).collect();
            for (d, Errors { look_up, plain: cut }) in distances.iter().zip(all) {
                let what = || format!("spot of {outer}° d {d}");
                let per_cent = |zones: [f64; 2]| format!("{:.2} / {:.2} %", 100.0 * zones[0], 100.0 * zones[1]);
                println!("{} {orders}: towards / behind {}, cut {}", what(), per_cent(look_up), per_cent(cut));
                worst.iter_mut().zip(look_up).for_each(|(worst, error)| worst.record(error, what));
                plain.iter_mut().zip(cut).for_each(|(worst, error)| worst.record(error, what));
            }
            worst.iter().for_each(Worst::check);
        }
    }
    assert!(plain.iter().all(|plain| plain.measured() > 0.3), "the missing edge and the ripple must show");
}

/// By reciprocity, not by the curves: `tests/surface.rs` has all harmonics.
#[test]
fn a_surface_is_met_up_to_the_last_distance() {
    let cosine = clamped_cosine::<f64>(DEGREES);
    let c: Vec<f64> = cosine.iter().enumerate().map(|(l, a)| a * (2 * l + 1) as f64 / (4.0 * PI)).collect();
    for scatter in [Scatter::Multiple(2), Scatter::AllMultiple] {
        let exact = Exact::new(scatter);
        let mut worst = Worst::new(format!("area, {scatter:?}, of l = 0"), 3e-3);
        let mut plain = [0.0f64; 2];
        let response = TableSet::embedded().area(&exact.air, scatter);
        for d in [0.1, 1.0, 3.0, 8.0, 18.0, 28.0, 40.0, 44.9] {
            let Errors { look_up, plain: cut } = errors(&exact, &response, &c, d);
            look_up.iter().for_each(|error| worst.record(*error, || format!("d {d}")));
            plain = std::array::from_fn(|zone| plain[zone].max(cut[zone]));
        }
        worst.check();
        // Negative control: the series cut after the stored degrees, at the kink and behind.
        println!("{scatter:?} cut: {plain:.4?}");
        assert!(scatter == Scatter::AllMultiple || plain.iter().all(|error| *error > 3e-3), "{plain:?}");
    }
}
