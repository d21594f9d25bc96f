//! Random media and places against direct evaluation, as a user may meet them: d from 1e-6 to 1e3 m, any angle, |g| ≤ 0.93, any
//! albedo and sigma, any scattering order and all of them.

use std::f64::consts::PI;

use bake_optics::phase::Phase;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use tables::axial::{HARMONIC_COUNT, HARMONICS};
use tables::transport::harmonics::scaled_legendre;
use tables::transport::phase_basis::PhaseBasis;
use tables::transport::slab::SlabSource;
use tables::transport::sources::Source;
use tables::{Air, AxialResponse, Scatter, TableSet, ZonalResponse, area, axial, directional, point};
use testkit::compare::Worst;

/// One place: σ_t in 1/m, distance in m, θ in radians.
#[derive(Debug)]
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
    // Up to |g| = 0.62 by Legendre orders, above by tables of the actual function.
    for g in if long { vec![0.3, -0.55, 0.62, 0.7, 0.8, -0.8, 0.88, 0.93, -0.93] } else { vec![0.3, -0.8, 0.93] } {
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
            let want = &area::compute_exact(d, place.theta, &basis, &HARMONICS, if g.abs() > 0.6 { 96 } else { 64 })[0];
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

/// Where the emitter's kink is, and nowhere else, strong functions ask for thrice the angles.
#[test]
fn strong_phase_functions_keep_to_the_bound_beside_the_kink() {
    let long = std::env::var_os("BAKE_LONG").is_some();
    let strong: &[f64] = if long { &[0.81, 0.88, -0.88, 0.93, -0.93] } else { &[0.93] };
    let distances: &[f64] =
        if long { &[1e-4, 1e-3, 1e-2, 0.05, 0.2, 0.7, 2.0, 6.0, 15.0, 40.0] } else { &[1e-3, 0.05, 0.7, 6.0] };
    let step = if long { 1 } else { 3 };
    let degrees: Vec<f64> = (-30..=30).step_by(step).map(|i| 90.05 + 0.1 * f64::from(i)).collect();
    let places: Vec<_> = distances.iter().flat_map(|&d| degrees.iter().map(move |&t| (d, t))).collect();
    let mut worst = Worst::new("area beyond |g| = 0.8 within 3° of 90°, of l = 0 at that angle", 3e-3);
    for &g in strong {
        let phase = Phase::HenyeyGreenstein { g };
        let response = TableSet::embedded().area(&Air { albedo: 1.0, phase: phase.clone() }, Scatter::Single);
        let basis = PhaseBasis::Functions(vec![phase]);
        let error = |&(d, degrees): &(f64, f64)| {
            let theta = degrees.to_radians();
            let want = &area::compute_exact(d, theta, &basis, &HARMONICS, 96)[0];
            let got = response.coefficients(1.0, d as f32, theta.cos() as f32);
            let full =
                HARMONICS.iter().zip(got).map(|(&(_, m), c)| f64::from(c) * theta.sin().powi(m as i32) * d * d.exp());
            full.zip(want).map(|(got, exact)| (got - exact).abs() / want[0]).fold(0.0, f64::max)
        };
        let errors: Vec<f64> = places.par_iter().map(error).collect();
        for ((d, degrees), error) in places.iter().zip(errors) {
            worst.record(error, || format!("g {g} d {d} theta {degrees:.2}"));
        }
    }
    worst.check();
}

/// `Σ_l' c_l' P̄_l'^m(cos θ) G` of one source's curves, for a Lambertian element.
fn turned(curves: &[f64], theta: f64) -> Vec<f64> {
    let cosine = tables::cosine_legendre();
    let legendre: [[f64; 17]; 5] = std::array::from_fn(|m| {
        let mut row = [0.0; 17];
        scaled_legendre(m, theta.cos(), theta.sin(), &mut row);
        row
    });
    let mut sum = vec![0.0; HARMONIC_COUNT];
    for (&(h, degree), g) in axial::curves(&axial::ALL_DEGREES).iter().zip(curves) {
        sum[h] += cosine[degree] * legendre[HARMONICS[h].1][degree] * g;
    }
    sum
}

/// Direct evaluation of a sum of orders, each with its power of the albedo.
struct Exact<'a> {
    scatter: Scatter,
    sources: &'a [Source],
    slabs: &'a [SlabSource],
    weights: Vec<f64>,
}

impl Exact<'_> {
    /// Normalised coefficients of point light, directional light and area.
    fn at(&self, d: f64, theta: f64) -> [[f64; HARMONIC_COUNT]; 3] {
        let add = |parts: &mut dyn Iterator<Item = Vec<f64>>| {
            let mut sum = [0.0; HARMONIC_COUNT];
            for (part, weight) in parts.zip(&self.weights) {
                sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += weight * part);
            }
            sum
        };
        [
            add(&mut self.sources.iter().map(|source| point::compute_multiple(d, source, 11))),
            add(&mut self.slabs.iter().map(|source| directional::compute_multiple(d, source, 11))),
            add(&mut axial::compute_multiple(d, self.sources).iter().map(|curves| turned(curves, theta))),
        ]
    }
}

/// The three emitters of one sum of orders.
struct Responses(ZonalResponse, ZonalResponse, AxialResponse);

impl Responses {
    fn new(air: &Air, scatter: Scatter) -> Self {
        let set = TableSet::embedded();
        Self(set.point(air, scatter), set.directional(air, scatter), set.area(air, scatter))
    }

    /// Coefficients in the medium, those of the area with their powers of sin θ.
    fn at(&self, place: &Place) -> [[f64; HARMONIC_COUNT]; 3] {
        let (sigma, distance) = (place.sigma as f32, place.distance as f32);
        let mut got = [[0.0f32; HARMONIC_COUNT]; 3];
        self.0.coefficients(sigma, distance, &mut got[0][..11]);
        self.1.coefficients(sigma, distance, &mut got[1][..11]);
        got[2] = self.2.coefficients(sigma, distance, place.theta.cos() as f32);
        let mut got = got.map(|c| c.map(f64::from));
        got[2].iter_mut().zip(HARMONICS).for_each(|(c, (_, m))| *c *= place.theta.sin().powi(m as i32));
        got
    }
}

/// Normalised l = 0 coefficients of light scattered once, albedo 1: what orders from two on may be measured against below the grid, where
/// they vanish in the whole response.
fn once(d: f64, theta: f64) -> [f64; 3] {
    let isotropic = PhaseBasis::Legendre(1);
    let area = area::compute_exact(d, theta, &isotropic, &[(0, 0)], 48)[0][0];
    [point::compute_single(d, &isotropic, 1)[0][0], directional::compute_single(d, &isotropic, 1)[0][0], area]
}

/// Orders from two on summed up to some, and without end; errors of the l = 0 coefficient of the same place. Areas up to 8 mean free paths.
#[test]
fn higher_orders_agree_with_direct_evaluation_anywhere() {
    let long = std::env::var_os("BAKE_LONG").is_some();
    let mut random = SmallRng::seed_from_u64(21);
    let sums = if long { vec![2, 3, 5, 7, 10] } else { vec![2, 4] };
    let sources: Vec<Source> = (1..sums[sums.len() - 1]).map(Source::order).collect();
    let slabs = sources.iter().fold(Vec::new(), |mut slabs, _| {
        slabs.push(SlabSource::order(slabs.last()));
        slabs
    });
    let albedo = 0.3 + 0.7 * random.random::<f64>();
    let air = Air::isotropic(albedo);
    let (all, slab_all) = ([Source::all(albedo)], [SlabSource::all(albedo)]);
    let up_to = |&k: &usize| Exact {
        scatter: Scatter::Multiple(k),
        sources: &sources[..k - 1],
        slabs: &slabs[..k - 1],
        weights: (2..=k).map(|n| albedo.powi(n as i32)).collect(),
    };
    let mut kinds: Vec<Exact> = sums.iter().map(up_to).collect();
    kinds.push(Exact { scatter: Scatter::AllMultiple, sources: &all, slabs: &slab_all, weights: vec![albedo] });
    let kinds: Vec<_> = kinds.into_iter().map(|exact| (Responses::new(&air, exact.scatter), exact)).collect();
    let errors = |place: &Place| -> Vec<[f64; 3]> {
        let d = f64::from(place.sigma as f32 * place.distance as f32);
        let once = if d < 1e-3 { once(d, place.theta).map(|c| albedo * c) } else { [0.0; 3] };
        let of = |(responses, exact): &(Responses, Exact)| {
            let (got, want) = (responses.at(place), exact.at(d, place.theta));
            let decay = [exact.sources[0].rate, exact.slabs[0].rate].map(|rate| (-rate * d).exp());
            let near = place.sigma.powi(2) * decay[0] / d;
            let largest = |i: usize, scale: f64| {
                let errors = got[i].iter().zip(&want[i]).map(|(got, want)| (got / scale - want).abs());
                errors.fold(0.0, f64::max) / (want[i][0] + once[i])
            };
            [largest(0, near), largest(1, decay[1]), largest(2, near)]
        };
        kinds.iter().map(of).collect()
    };
    let mut places = places(&mut random, if long { 150 } else { 24 });
    places.retain(|place| place.sigma * place.distance < 44.0);
    let all_errors: Vec<_> = places.par_iter().map(errors).collect();
    let mut worst = ["point", "directional", "area"]
        .map(|name| Worst::new(format!("{name}, higher orders anywhere, of l = 0"), 3e-3));
    for (place, errors) in places.iter().zip(all_errors) {
        for ((_, exact), errors) in kinds.iter().zip(errors) {
            let what = || format!("{:?} {place:?}", exact.scatter);
            // Seventeen degrees of an area's series are no truth farther away: `surface.rs` has the whole of it.
            let told = if place.sigma * place.distance > 8.0 { 2 } else { 3 };
            worst.iter_mut().zip(errors).take(told).for_each(|(worst, error)| worst.record(error, what));
        }
    }
    worst.iter().for_each(Worst::check);
    // Negative control: one order more.
    let place = Place { sigma: 1.0, distance: 1.0, theta: 1.0 };
    let (got, next) = (kinds[0].0.at(&place), kinds[1].1.at(1.0, 1.0));
    assert!((0..3).all(|i| (got[i][0] * 1f64.exp() - next[i][0]).abs() > 0.1 * next[i][0]));
}
