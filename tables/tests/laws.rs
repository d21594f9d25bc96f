//! The convention of the sigma ratio, limits outside the grid, exact integrals over a plane, convergence, phase functions
//! beyond the tables.

use bake_optics::harmonics::clamped_cosine;
use bake_optics::phase::Phase;
use glam::Vec3;
use std::f64::consts::PI;
use tables::transport::harmonics::{real_norm, scaled_legendre};
use tables::transport::phase_basis::PhaseBasis;
use tables::transport::slab::SlabSource;
use tables::transport::sources::Source;
use tables::{Air, Geometry, Scatter, TableSet, ZonalRgb, area, axial, directional, point};
use testkit::compare::Worst;
use testkit::statistics::slope;

/// Physical quadrature of once-scattered fluence from a point light in a medium of any sigma_t, written without optical
/// distances: `∫ dω ∫ σ_s/(4π) e^{−σ(t+r)}/r² dt`, in prolate coordinates `t + r = d p`, `t − r = d q`:
/// dV = (d³/8)(p² − q²) dp dq dφ, `∫ dV/(t² r²) = (2/d)·2π ∫∫ dp dq/(p² − q²)`, and `∫ dq/(p²−q²) = ln((p+1)/(p−1))/p`.
fn physical_fluence(sigma_t: f64, sigma_s: f64, d: f64) -> f64 {
    // p = 1 + x⁴/(1−x)⁴-free form: p = 1 + u, u = (x/(1−x))⁴ spreads both ends.
    let n = 20_000;
    let sum: f64 = (0..n)
        .map(|i| {
            let x = (i as f64 + 0.5) / n as f64;
            let u = (x / (1.0 - x)).powi(4);
            let slope = 4.0 * x.powi(3) / (1.0 - x).powi(5);
            let p = 1.0 + u;
            slope / n as f64 * (-sigma_t * d * p).exp() * ((p + 1.0) / u).ln() / p
        })
        .sum();
    sigma_s / (4.0 * PI) * 4.0 * PI / d * sum
}

/// The first thing to hold: intensity fixed, two sigmas, two distances, three emitters.
#[test]
fn two_sigmas_fix_the_convention() {
    let set = TableSet::embedded();
    let mut worst = Worst::new("fluence of order 1 at two sigmas", 1e-3);
    for (sigma_t, albedo) in [(1.0, 1.0), (2.5, 0.6), (0.2, 0.9)] {
        let response = set.point(&Air::isotropic(albedo), Scatter::Single);
        for d in [0.3, 1.0, 2.0] {
            let mut c = [0.0f32; 11];
            response.coefficients(sigma_t as f32, d as f32, &mut c);
            let fluence = f64::from(c[0]) * (4.0 * PI).sqrt();
            worst
                .relative(fluence, physical_fluence(sigma_t, albedo * sigma_t, d), || format!("sigma {sigma_t} d {d}"));
        }
    }
    worst.check();
    // Directional light carries no power of sigma, an area the same two as a point.
    let (air, mut near, mut far) = (Air::isotropic(1.0), [0.0f32; 11], [0.0f32; 11]);
    let directional = set.directional(&air, Scatter::Single);
    directional.coefficients(1.0, 2.0, &mut near);
    directional.coefficients(4.0, 0.5, &mut far);
    assert_eq!(near, far);
    let geometry = Geometry::new(Vec3::Z, Vec3::Z, -Vec3::Z);
    let surface = set.area(&air, Scatter::Single);
    let ratio = surface.irradiance(4.0, 0.5, &geometry) / surface.irradiance(1.0, 2.0, &geometry);
    assert!((ratio - 16.0).abs() < 1e-4, "{ratio}");
    // Negative control: one power of sigma is off by the ratio itself.
    let mut c = [0.0f32; 11];
    set.point(&air, Scatter::Single).coefficients(2.5, 1.0, &mut c);
    let one_power = f64::from(c[0]) * (4.0 * PI).sqrt() / 2.5;
    assert!((one_power / physical_fluence(2.5, 2.5, 1.0) - 1.0).abs() > 0.5);
}

#[test]
fn outside_the_grid_the_total_stays_within_a_percent() {
    let set = TableSet::embedded();
    let mut worst = Worst::new("orders 1 and 2 below the grid, of the total", 1e-2);
    let air = Air::isotropic(1.0);
    let (single, double) = (set.point(&air, Scatter::Single), set.point(&air, Scatter::Multiple(2)));
    let second = Source::order(1);
    for d in [1e-6, 1e-5, 1e-4, 5e-4, 9.9e-4, 1.01e-3f64] {
        let mut parts = [[0.0f32; 11]; 2];
        single.coefficients(1.0, d as f32, &mut parts[0]);
        double.coefficients(1.0, d as f32, &mut parts[1]);
        let scale = (-d).exp() / d;
        let first = point::compute_single(d, &PhaseBasis::Legendre(1), 11).concat();
        let want: Vec<f64> =
            first.iter().zip(point::compute_multiple(d, &second, 11)).map(|(a, b)| scale * (a + b)).collect();
        for l in 0..11 {
            let got = f64::from(parts[0][l] + parts[1][l]);
            worst.record((got - want[l]).abs() / want[0], || format!("d {d} l {l}"));
        }
    }
    worst.check();
    let mut far = [0.0f32; 11];
    let mut worst = Worst::new("all orders, albedo 1, beyond the grid", 1e-2);
    for d in [60.0, 100.0, 1000.0] {
        set.point(&air, Scatter::AllMultiple).coefficients(1.0, d as f32, &mut far);
        worst.relative(f64::from(far[0]) * (4.0 * PI).sqrt(), 3.0 / d, || format!("d {d}"));
    }
    worst.check();
}

/// A plane of radiance 1 under a half space of air: irradiance/π = (2/3)(1 − ln 2) exactly, 0.205637 with the coefficients of l ≤ 4.
#[test]
fn a_plane_reflects_through_the_air_what_theory_says() {
    let response = TableSet::embedded().area(&Air::isotropic(1.0), Scatter::Single);
    let geometry = Geometry::new(Vec3::Z, Vec3::X, Vec3::Z);
    let cosine = clamped_cosine::<f64>(9);
    // Receiver's normal and emitter's normal are both perpendicular to the line between them: γ = θ = 90°, φ = 0.
    let at_normal = axial::HARMONICS.map(|(l, m)| {
        let mut p = [0.0; 9];
        scaled_legendre(m, 0.0, 1.0, &mut p);
        if l <= 4 { cosine[l] * real_norm(l, m) * p[l] } else { 0.0 }
    });
    // ∫ 2π ρ R(ρ) dρ, uniform in ln ρ.
    let n = 4000;
    let (low, high) = (1e-6f64.ln(), 40.0f64.ln());
    let step = (high - low) / n as f64;
    let (mut all, mut eleven) = (0.0, 0.0);
    for i in 0..n {
        let rho = (low + step * (i as f64 + 0.5)).exp();
        let ring = 2.0 * rho * rho * step;
        all += ring * f64::from(response.irradiance(1.0, rho as f32, &geometry));
        let coefficients = response.coefficients(1.0, rho as f32, 0.0);
        eleven += ring * coefficients.iter().zip(at_normal).map(|(&c, y)| f64::from(c) * y).sum::<f64>();
    }
    println!("reflectance {all:.6}, {eleven:.6} of 0.205637 (11 coefficients), 0.204569 (exact)");
    assert!((eleven / 0.205637 - 1.0).abs() < 1e-3, "{eleven}");
    assert!((all / 0.204569 - 1.0).abs() < 8e-3, "{all}");
}

#[test]
fn look_up_error_falls_with_the_square_of_the_bins() {
    use tables::curves::Grid;
    let basis = PhaseBasis::Legendre(1);
    let counts = [32.0f64, 64.0, 128.0, 256.0];
    let error = |bins: f64| {
        let grid = Grid { bins: bins as usize, ..Grid::default() };
        let curves = point::store_single(grid, &basis, 11);
        let places = (0..grid.bins).map(|i| grid.distance(i as f64 + 0.5)).filter(|&d| d < 44.0);
        let errors = places.map(|d| {
            let d = f64::from(d as f32);
            let want = point::compute_single(d, &basis, 1)[0][0] * (-d).exp() / d;
            (f64::from(curves.look_up(d)[0]) / want - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    };
    let errors = counts.map(error);
    println!("l = 0 error at {counts:?} bins: {errors:?}");
    let slope = slope(&counts.map(f64::ln), &errors.map(f64::ln));
    assert!((-2.4..-1.6).contains(&slope), "slope {slope}");
}

#[test]
fn three_channels_at_once_equal_three_single_look_ups() {
    let set = TableSet::embedded();
    let airs = [1.0, 0.9, 0.5].map(Air::isotropic);
    let area = set.area_rgb(&airs, Scatter::Single);
    let light = ZonalRgb::new(airs.each_ref().map(|air| set.point(air, Scatter::AllMultiple)));
    let mut worst = Worst::new("RGB against single look-ups", 2e-5);
    for i in 0..200 {
        let d = 1e-4 * 1.06f32.powi(i);
        let axis = Vec3::new((i as f32).sin(), (i as f32).cos(), 0.3).normalize();
        let geometry = Geometry::new(Vec3::new(0.6, 0.0, 0.8), Vec3::Z, axis);
        let sigma = [0.5, 1.0, 2.0];
        let got = [area.irradiance(sigma, d, &geometry), light.irradiance(sigma, d, 0.8)];
        for channel in 0..3 {
            let want = [
                area.channels()[channel].irradiance(sigma[channel], d, &geometry),
                light.channels()[channel].irradiance(sigma[channel], d, 0.8),
            ];
            if sigma[channel] * d < 40.0 {
                for (got, want) in got.iter().zip(want) {
                    let error = f64::from((got[channel] - want).abs() / (want.abs() + 1e-30));
                    worst.record(error, || format!("d {d} channel {channel}"));
                }
            }
        }
    }
    worst.check();
}

#[test]
fn outside_the_grid_area_and_directional_light_follow_direct_evaluation() {
    let set = TableSet::embedded();
    let (air, basis) = (Air::isotropic(1.0), PhaseBasis::Legendre(1));
    let mut worst = Worst::new("area and directional light outside the grid, of the total", 1e-2);
    let (first, second) = (set.area(&air, Scatter::Single), set.area(&air, Scatter::Multiple(2)));
    let sources = [Source::order(1)];
    let slab = SlabSource::order(None);
    let sun = [Scatter::Single, Scatter::Multiple(2)].map(|scatter| set.directional(&air, scatter));
    for d in [1e-6f64, 1e-4, 9.9e-4] {
        for theta in [0.0f64, 1.2, PI] {
            let one = &area::compute_exact(d, theta, &basis, &axial::HARMONICS, 64)[0];
            let two = facing_moments(&axial::compute_multiple(d, &sources)[0], theta);
            let got: Vec<f32> = [&first, &second]
                .map(|response| response.coefficients(1.0, d as f32, theta.cos() as f32))
                .into_iter()
                .reduce(|a, b| std::array::from_fn(|h| a[h] + b[h]))
                .map_or(Vec::new(), |sum| sum.to_vec());
            // (0,0) and (1,0).
            for h in 0..2 {
                let error = f64::from(got[h]) * d * d.exp() - (one[h] + two[h]);
                worst.record(error.abs() / (one[0] + two[0]), || format!("area d {d} theta {theta} h {h}"));
            }
        }
        let mut got = [[0.0f32; 11]; 2];
        sun.iter().zip(&mut got).for_each(|(response, got)| response.coefficients(1.0, d as f32, got));
        let (one, two) = (&directional::compute_single(d, &basis, 11)[0], directional::compute_multiple(d, &slab, 11));
        for l in 0..11 {
            let error = f64::from(got[0][l] + got[1][l]) * d.exp() - (one[l] + two[l]);
            worst.record(error.abs() / (one[0] + two[0]), || format!("directional d {d} l {l}"));
        }
    }
    let (all, slab) = (Source::all(1.0), SlabSource::all(1.0));
    let (area, sun) = (set.area(&air, Scatter::AllMultiple), set.directional(&air, Scatter::AllMultiple));
    for d in [55.0f64, 120.0, 300.0] {
        let want = facing_moments(&axial::compute_multiple(d, std::slice::from_ref(&all))[0], 0.6)[0] / d;
        let got = area.coefficients(1.0, d as f32, 0.6f32.cos())[0];
        worst.relative(f64::from(got), want, || format!("area, all orders, d {d}"));
        let mut c = [0.0f32; 11];
        sun.coefficients(1.0, d as f32, &mut c);
        let want = directional::compute_multiple(d, &slab, 1)[0];
        worst.relative(f64::from(c[0]), want, || format!("directional, all orders, d {d}"));
    }
    worst.check();
}

/// The (0,0) and (1,0) coefficients of a Lambertian element at angle θ from its separated curves.
fn facing_moments(curves: &[f64], theta: f64) -> [f64; 2] {
    let cosine = tables::cosine_legendre();
    let mut p = [0.0; 17];
    bake_optics::legendre::legendre_all(theta.cos(), &mut p);
    let mut sum = [0.0; 2];
    for (&(h, degree), g) in axial::curves(&axial::ALL_DEGREES).iter().zip(curves) {
        if h < 2 {
            sum[h] += cosine[degree] * p[degree] * g;
        }
    }
    sum
}

/// Above |g| = 0.8 the Legendre orders in the tables do not suffice: the actual phase function is used.
#[test]
fn strong_phase_functions_get_tables_of_their_own() {
    let set = TableSet::embedded();
    let mut worst = Worst::new("order 1 at |g| > 0.8, of l = 0 at that angle", 3e-3);
    let mut control = 0.0f64;
    for g in [0.9, -0.85] {
        let air = Air { albedo: 0.7, phase: Phase::HenyeyGreenstein { g } };
        let basis = PhaseBasis::Functions(vec![air.phase.clone()]);
        let (point, surface) = (set.point(&air, Scatter::Single), set.area(&air, Scatter::Single));
        for d in [0.05f64, 0.8, 4.0] {
            let (want, mut got) = (&point::compute_single(d, &basis, 11)[0], [0.0f32; 11]);
            point.coefficients(1.0, d as f32, &mut got);
            for l in 0..11 {
                let error = f64::from(got[l]) / 0.7 * d * d.exp() - want[l];
                worst.record(error.abs() / want[0], || format!("point g {g} d {d} l {l}"));
            }
            // A light that is seen from its back, where the series fails first.
            let theta = 2.6f64;
            let want = &area::compute_exact(d, theta, &basis, &axial::HARMONICS, 96)[0];
            let got = surface.coefficients(1.0, d as f32, theta.cos() as f32);
            for (h, &(_, m)) in axial::HARMONICS.iter().enumerate() {
                let error = f64::from(got[h]) / 0.7 * theta.sin().powi(m as i32) * d * d.exp() - want[h];
                worst.record(error.abs() / want[0], || format!("area g {g} d {d} h {h}"));
            }
            // Negative control: the twenty stored orders alone.
            let series = area::compute_exact(d, theta, &PhaseBasis::Legendre(20), &[(0, 0)], 96);
            let sum: f64 = series.iter().zip(air.legendre_weights(20)).map(|(s, w)| s[0] * w / 0.7).sum();
            control = control.max((sum / want[0] - 1.0).abs());
        }
    }
    worst.check();
    assert!(control > 0.05, "twenty orders must not suffice: {control}");
}

/// Less memory: same numbers where nothing is taken away, no degrees above the cut, larger errors with fewer distances.
#[test]
fn reduced_tables_lose_what_was_asked_and_nothing_else() {
    let whole = TableSet::embedded();
    let recipe = whole.recipe();
    let air = Air::isotropic(0.9);
    let area = |set: &TableSet, d: f32| set.area(&air, Scatter::Single).coefficients(1.0, d, 0.3);
    let point = |set: &TableSet, d: f32| {
        let mut c = [0.0f32; 11];
        set.point(&air, Scatter::Multiple(3)).coefficients(1.0, d, &mut c);
        c
    };
    let (same, cut) = (whole.reduced(recipe.read_bins, recipe.bands), whole.reduced(recipe.read_bins, 3));
    assert_eq!((area(&same, 0.7), point(&same, 0.7)), (area(whole, 0.7), point(whole, 0.7)));
    assert_eq!(point(&cut, 0.7)[..3], point(whole, 0.7)[..3]);
    assert!(point(&cut, 0.7)[3..].iter().all(|c| *c == 0.0));
    for ((got, want), (l, _)) in area(&cut, 0.7).iter().zip(area(whole, 0.7)).zip(tables::axial::HARMONICS) {
        // Steps of a node follow its largest coefficient, which the cut may take away.
        assert!(
            if l < 3 { (got - want).abs() < 1e-4 * want.abs().max(0.01) } else { *got == 0.0 },
            "l {l}: {got} {want}"
        );
    }
    let error = |bins: usize| {
        let coarse = whole.reduced(bins, recipe.bands);
        let off = |i: usize| {
            let d = 0.01 * 1.37f32.powi(i as i32);
            (point(&coarse, d)[0] / point(whole, d)[0] - 1.0).abs()
        };
        (0..20).map(off).fold(0.0, f32::max)
    };
    let errors = [16, 32, 64].map(error);
    println!("errors of point light at 16, 32, 64 distances: {errors:?}");
    assert!(errors[0] > 2.5 * errors[1] && errors[1] > 2.5 * errors[2] && errors[2] > 0.0);
}
