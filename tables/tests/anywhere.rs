//! Random media and places against direct evaluation, as a user may meet them: d from 1e-6 to 1e3 m, any angle, |g| ≤ 0.8, any
//! albedo and sigma.

use std::f64::consts::PI;

use bake_optics::phase::Phase;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use tables::axial::HARMONICS;
use tables::transport::phase_basis::PhaseBasis;
use tables::{Air, Scatter, TableSet, area, directional, point};
use testkit::compare::Worst;

/// One place: σ_t in 1/m, distance in m, θ in radians.
struct Place {
    sigma: f64,
    distance: f64,
    theta: f64,
}

fn places(random: &mut SmallRng, count: usize) -> Vec<Place> {
    let at = |_| Place {
        sigma: 10f64.powf(-2.0 + 3.0 * random.random::<f64>()),
        distance: 10f64.powf(-6.0 + 9.0 * random.random::<f64>()),
        theta: PI * random.random::<f64>(),
    };
    (0..count).map(at).collect()
}

#[test]
fn order_one_agrees_with_direct_evaluation_anywhere() {
    let set = TableSet::embedded();
    let long = std::env::var_os("BAKE_LONG").is_some();
    let mut random = SmallRng::seed_from_u64(20);
    let mut zonal = Worst::new("point and directional light anywhere, of l = 0", 1e-3);
    let mut surface = Worst::new("area anywhere, of l = 0 at that angle", 3e-3);
    let mut far = 0;
    for g in if long { vec![0.3, -0.55, 0.66, 0.8, -0.8] } else { vec![0.3, -0.8] } {
        let albedo = 0.05 + 0.95 * random.random::<f64>();
        let air = Air { albedo, phase: Phase::HenyeyGreenstein { g } };
        let (light, sun, patch) =
            (set.point(&air, Scatter::Single), set.directional(&air, Scatter::Single), set.area(&air, Scatter::Single));
        let basis = PhaseBasis::Functions(vec![air.phase.clone()]);
        let places = places(&mut random, if long { 120 } else { 20 });
        let errors = |place: &Place| {
            let (sigma, distance) = (place.sigma as f32, place.distance as f32);
            let d = f64::from(sigma * distance);
            let mut got = [[0.0f32; 11]; 2];
            light.coefficients(sigma, distance, &mut got[0]);
            sun.coefficients(sigma, distance, &mut got[1]);
            let patch = patch.coefficients(sigma, distance, place.theta.cos() as f32);
            if d > 45.0 {
                assert!(got.iter().flatten().chain(&patch).all(|c| c.is_finite()), "optical distance {d}");
                return None;
            }
            // Canonical, normalised: both sides divided by the same factor.
            let scale = albedo * f64::from(sigma).powi(2) * (-d).exp() / d;
            let slab = albedo * (-d).exp();
            let want = [&point::compute_single(d, &basis, 11)[0], &directional::compute_single(d, &basis, 11)[0]];
            let zonal = [scale, slab].into_iter().zip(got).zip(want).flat_map(|((scale, got), want)| {
                (0..11).map(move |l| (f64::from(got[l]) / scale - want[l]).abs() / want[0])
            });
            let want = &area::compute_exact(d, place.theta, &basis, &HARMONICS, if g.abs() > 0.7 { 96 } else { 64 })[0];
            let area = HARMONICS.iter().zip(patch).zip(want).map(|((&(_, m), got), want_one)| {
                (f64::from(got) / scale * place.theta.sin().powi(m as i32) - want_one).abs() / want[0]
            });
            Some((zonal.fold(0.0, f64::max), area.fold(0.0, f64::max)))
        };
        let all: Vec<_> = places.par_iter().map(errors).collect();
        for (place, errors) in places.iter().zip(all) {
            let what = || {
                format!(
                    "g {g} sigma {:.3e} d {:.3e} m theta {:.1}°",
                    place.sigma,
                    place.distance,
                    place.theta.to_degrees()
                )
            };
            match errors {
                Some((z, a)) => {
                    zonal.record(z, what);
                    surface.record(a, what);
                }
                None => far += 1,
            }
        }
    }
    assert!(far > 0, "some places lie beyond the grid");
    zonal.check();
    surface.check();
}
