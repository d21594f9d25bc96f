//! Irradiance made of the coefficients against exact irradiance: bands of a point light, the harmonics of an area,
//! a plane's own light.

use std::f64::consts::{FRAC_PI_2, PI};

use bake_optics::harmonics::{clamped_cosine, y_zonal_all};
use bake_optics::phase::Phase;
use glam::Vec3;
use rayon::prelude::*;
use tables::area::{clamped_cosine_moment, compute_exact};
use tables::axial::HARMONICS;
use tables::transport::harmonics::{real_norm, scaled_legendre};
use tables::transport::phase_basis::PhaseBasis;
use tables::transport::triangle::Triangle;
use tables::{Air, AxialResponse, Geometry, Scatter, TableSet, point};
use testkit::compare::Worst;

const ISOTROPIC: PhaseBasis = PhaseBasis::Legendre(1);

/// Irradiance of once-scattered light of a point light, times d e^d, on a receiver at angle `eta` from it.
///
/// *Equation*: the zonal integral with the kernel `K(γ, η) = ∫_0^{2π} max(0, cos between n and ω) dφ` in place of the harmonic.
fn exact_point(d: f64, eta: f64) -> f64 {
    let kink = (FRAC_PI_2 - eta).abs();
    let row = |row: &tables::transport::triangle::Row| {
        let inner = row.nodes.iter().map(|n| n.weight * (-d * (n.side_outer + n.side_inner - 1.0)).exp()).sum::<f64>();
        row.weight * clamped_cosine_moment(0, row.outer, eta) * inner
    };
    Triangle::with_kinks(48, &[kink, PI - kink], &[]).rows.iter().map(row).sum::<f64>() / (4.0 * PI)
}

/// `Σ A_l L_l y_l(cos η)`.
fn truncated(coefficients: &[f64], eta: f64) -> f64 {
    let mut y = vec![0.0; coefficients.len()];
    y_zonal_all(eta.cos(), &mut y);
    let cosine = clamped_cosine::<f64>(coefficients.len());
    coefficients.iter().zip(y).zip(cosine).map(|((c, y), a)| a * c * y).sum()
}

/// Specified error of irradiance by bands, of that of a receiver that faces the light; figures of one or two digits.
const TRUNCATION: [(f64, [f64; 5]); 4] = [
    (0.1, [2.1e-2, 7.2e-3, 3.9e-3, 1.6e-3, 9e-4]),
    (1.0, [2.7e-2, 1.0e-2, 5.5e-3, 2.4e-3, 1.3e-3]),
    (3.0, [3.3e-2, 1.3e-2, 7.6e-3, 3.4e-3, 1.9e-3]),
    (10.0, [4.0e-2, 1.9e-2, 1.1e-2, 5.4e-3, 3.2e-3]),
];

const BANDS: [usize; 5] = [3, 5, 7, 11, 15];

/// Largest error over all receivers of an irradiance by the angle from the light, of the facing one.
fn largest_error(d: f64, irradiance: impl Fn(f64) -> f64) -> f64 {
    let facing = exact_point(d, 0.0);
    let error = |degrees: i32| {
        let eta = f64::from(degrees).to_radians();
        (irradiance(eta) - exact_point(d, eta)).abs() / facing
    };
    (0..=180).step_by(5).map(error).fold(0.0, f64::max)
}

#[test]
fn the_error_falls_with_the_bands_as_specified() {
    let mut direct = Worst::new("error of irradiance against bands, of the specified figure", 0.1);
    let mut read = Worst::new("the same through look-up", 0.1);
    let air = Air::isotropic(1.0);
    let light = |bands: usize| TableSet::with_bands(bands).reduced(256, bands).point(&air, Scatter::Single);
    let responses = BANDS.map(light);
    for (d, figures) in TRUNCATION {
        let all = &point::compute_single(d, &ISOTROPIC, 15)[0];
        for ((bands, response), figure) in BANDS.into_iter().zip(&responses).zip(figures) {
            let of = |error: f64| (error / figure - 1.0).abs();
            let (exact, looked_up) = (
                largest_error(d, |eta| truncated(&all[..bands], eta)),
                largest_error(d, |eta| f64::from(response.irradiance(1.0, d as f32, eta.cos() as f32)) * d * d.exp()),
            );
            println!("d {d} bands {bands}: {exact:.2e}, looked up {looked_up:.2e}");
            direct.record(of(exact), || format!("d {d} bands {bands}: {exact:.2e}"));
            read.record(of(looked_up), || format!("d {d} bands {bands}: {looked_up:.2e}"));
        }
    }
    direct.check();
    read.check();
    // Negative control: eleven bands are not fifteen.
    let eleven = largest_error(1.0, |eta| f64::from(responses[3].irradiance(1.0, 1.0, eta.cos() as f32)) * 1f64.exp());
    assert!(eleven > 1.5 * TRUNCATION[1].1[4], "{eleven}");
}

/// Real SH that the clamped cosine sees, up to degree 20: what is beyond weighs less than 1e-3.
fn visible_harmonics() -> Vec<(usize, usize)> {
    (0..=20).filter(|l| *l == 1 || l % 2 == 0).flat_map(|l| (0..=l).map(move |m| (l, m))).collect()
}

/// Media and their responses.
fn responses(airs: &[Air]) -> Vec<(Air, AxialResponse)> {
    airs.iter().map(|air| (air.clone(), TableSet::embedded().area(air, Scatter::Single))).collect()
}

/// RMS over all receiver normals of the error of the look-up, of the RMS of the exact irradiance (Parseval); of the stored
/// harmonics those up to `degree`, at one angle in each medium.
fn area_errors(media: &[(Air, AxialResponse)], d: f64, theta: f64, degree: usize) -> Vec<f64> {
    let list = visible_harmonics();
    let basis = PhaseBasis::Functions(media.iter().map(|(air, _)| air.phase.clone()).collect());
    let cosine = clamped_cosine::<f64>(21);
    let error = |((_, response), exact): (&(Air, AxialResponse), Vec<f64>)| {
        let stripped = response.coefficients(1.0, d as f32, theta.cos() as f32);
        let (mut error, mut all) = (0.0, 0.0);
        for (&(l, m), want) in list.iter().zip(&exact) {
            let h = HARMONICS.iter().position(|&pair| pair == (l, m)).filter(|_| l <= degree);
            let got = h.map_or(0.0, |h| f64::from(stripped[h]) * theta.sin().powi(m as i32) * d * d.exp());
            error += (cosine[l] * (got - want)).powi(2);
            all += (cosine[l] * want).powi(2);
        }
        (error / all).sqrt()
    };
    media.iter().zip(compute_exact(d, theta, &basis, &list, 40)).map(error).collect()
}

/// Every angle of the emitter, distances from where the air is a point to the last before the fade, strong phase functions.
#[test]
fn irradiance_of_an_area_is_within_two_percent_over_all_receivers() {
    let phase = |g: f64| if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } };
    let media = responses(&[0.0, 0.8, -0.8].map(|g| Air { albedo: 1.0, phase: phase(g) }));
    let long = std::env::var_os("BAKE_LONG").is_some();
    let (step, distances): (_, &[f64]) =
        if long { (5, &[1e-4, 1e-2, 0.05, 0.2, 0.5, 2.0, 5.0, 12.0, 25.0, 40.0]) } else { (45, &[0.5, 40.0]) };
    let degrees: Vec<f64> = (0..=180).step_by(step).map(f64::from).collect();
    let places: Vec<_> = distances.iter().flat_map(|&d| degrees.iter().map(move |&t| (d, t))).collect();
    let errors: Vec<_> = places.par_iter().map(|&(d, t)| area_errors(&media, d, t.to_radians(), 8)).collect();
    let mut worst = Worst::new("irradiance of an area, RMS over normals", 2e-2);
    for ((d, degrees), errors) in places.iter().zip(errors) {
        for (error, (air, _)) in errors.into_iter().zip(&media) {
            worst.record(error, || format!("d {d} theta {degrees} {:?}", air.phase));
        }
    }
    worst.check();
    // Negative control: without l = 6 and 8.
    let eleven = area_errors(&media[..1], 5.0, PI, 4)[0];
    assert!(eleven > 3e-2, "{eleven}");
}

/// The first eleven harmonics have the errors that the method's specification gives them, in percent with one decimal.
#[test]
fn eleven_harmonics_have_the_specified_error() {
    let media = responses(&[Air::isotropic(1.0)]);
    let mut specified = Worst::new("RMS against the specified figure (absolute)", 1e-3);
    for (d, figures) in [(0.05, [0.4, 0.5, 0.8]), (0.5, [0.5, 0.7, 1.1]), (2.0, [0.8, 1.0, 1.6])] {
        for (degrees, figure) in [30.0f64, 60.0, 85.0].into_iter().zip(figures) {
            let error = area_errors(&media, d, degrees.to_radians(), 4)[0];
            specified.record((error - 0.01 * figure).abs(), || format!("d {d} theta {degrees}: {error:.4}"));
        }
    }
    specified.check();
}

/// Ringing of the truncated series: how far below zero irradiance may come, of its largest value over all receivers. Worst
/// where the lobe is narrowest: behind an area, or 40 mean free paths away.
const RINGING: f64 = 1.5e-2;

#[test]
fn no_irradiance_is_negative_beyond_the_ringing_bound() {
    let set = TableSet::embedded();
    let mut worst = Worst::new("most negative irradiance, of the largest over all receivers", RINGING);
    let air = Air::isotropic(1.0);
    let normals: Vec<Vec3> = (0..500)
        .map(|i| {
            let (z, turn) = (1.0 - (2 * i + 1) as f32 / 500.0, 2.399_963_2 * i as f32);
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * turn.cos(), r * turn.sin(), z)
        })
        .collect();
    for scatter in [Scatter::Single, Scatter::Multiple(2), Scatter::AllMultiple] {
        let (area, light, sun) = (set.area(&air, scatter), set.point(&air, scatter), set.directional(&air, scatter));
        for d in [1e-6f32, 1e-4, 1e-3, 1e-2, 0.03, 0.1, 1.0, 4.0, 15.0, 40.0] {
            let check = |worst: &mut Worst, name: &str, irradiance: &dyn Fn(Vec3) -> f32| {
                let values = normals.iter().map(|&n| f64::from(irradiance(n)));
                let (low, high) =
                    values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
                assert!(high > 0.0, "{name} {scatter:?} d {d}");
                worst.record(-low / high, || format!("{name} {scatter:?} d {d}"));
            };
            check(&mut worst, "point", &|n| light.irradiance(1.0, d, n.z));
            check(&mut worst, "directional", &|n| sun.irradiance(1.0, d, n.z));
            for degrees in (0..=180).step_by(15) {
                let (sin, cos) = (degrees as f32).to_radians().sin_cos();
                let axis = Vec3::new(sin, 0.0, -cos);
                check(&mut worst, &format!("area {degrees}°"), &|n| {
                    area.irradiance(1.0, d, &Geometry::new(n, Vec3::Z, axis))
                });
            }
        }
    }
    worst.check();
}

/// Order-1 reflectance of a half space over a plane of radiance 1, by degrees of harmonics up to `degree`: quadrature, no table.
fn reflectance(degree: usize) -> f64 {
    let list: Vec<_> = visible_harmonics().into_iter().filter(|&(l, _)| l <= degree).collect();
    let cosine = clamped_cosine::<f64>(degree + 1);
    // Receiver's normal and emitter's normal are both perpendicular to the line between them: γ = θ = 90°, φ = 0.
    let at_normal: Vec<f64> = list
        .iter()
        .map(|&(l, m)| {
            let mut p = vec![0.0; degree + 1];
            scaled_legendre(m, 0.0, 1.0, &mut p);
            cosine[l] * real_norm(l, m) * p[l]
        })
        .collect();
    // ∫ 2πρ R(ρ) dρ by the trapezoid rule in ln ρ, which converges exponentially.
    let step = 0.25;
    let ring = |i: usize| {
        let rho = (1e-6f64.ln() + step * i as f64).exp();
        let coefficients = &compute_exact(rho, FRAC_PI_2, &ISOTROPIC, &list, 40)[0];
        let irradiance: f64 = coefficients.iter().zip(&at_normal).map(|(c, y)| c * y).sum();
        2.0 * PI * rho * step * (-rho).exp() * irradiance
    };
    (0..72).map(ring).sum::<f64>() / PI
}

#[test]
fn a_plane_reflects_through_the_air_what_theory_says_before_any_table() {
    let exact = 2.0 / 3.0 * (1.0 - 2.0f64.ln());
    assert!((exact - 0.204569).abs() < 5e-7);
    let eleven = reflectance(4);
    let many = reflectance(20);
    println!("reflectance {eleven:.6} with 11 coefficients, {many:.6} up to degree 20, {exact:.6} exact");
    assert!((eleven - 0.205637).abs() < 2e-6, "{eleven}");
    assert!((many / exact - 1.0).abs() < 3e-4, "{many}");
}
