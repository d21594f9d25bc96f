//! The convention of the sigma ratio, limits outside the grid, exact integrals over a plane, convergence, an independent
//! Monte Carlo.

use bake_optics::phase::Phase;
use glam::Vec3;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use std::f64::consts::PI;
use tables::transport::phase_basis::PhaseBasis;
use tables::transport::sources::Source;
use tables::{Air, AxialRgb, Geometry, Scatter, TableSet, point};
use testkit::compare::Worst;
use testkit::statistics::{mean_and_error, slope};

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

/// A plane of radiance 1 under a half space of air: irradiance/π = (2/3)(1 − ln 2) exactly, 0.205637 with 11 coefficients.
#[test]
fn a_plane_reflects_through_the_air_what_theory_says() {
    let response = TableSet::embedded().area(&Air::isotropic(1.0), Scatter::Single);
    let geometry = Geometry::new(Vec3::Z, Vec3::X, Vec3::Z);
    // ∫ 2π ρ R(ρ) dρ, uniform in ln ρ.
    let n = 4000;
    let (low, high) = (1e-6f64.ln(), 40.0f64.ln());
    let step = (high - low) / n as f64;
    let sum: f64 = (0..n)
        .map(|i| {
            let rho = (low + step * (i as f64 + 0.5)).exp();
            2.0 * PI * rho * rho * step * f64::from(response.irradiance(1.0, rho as f32, &geometry))
        })
        .sum();
    println!("reflectance {} of 0.205637 (11 coefficients), 0.204569 (exact)", sum / PI);
    assert!((sum / PI - 0.205637).abs() < 0.205637 * 1e-3, "{}", sum / PI);
    assert!((sum / PI / 0.204569 - 1.0).abs() < 8e-3);
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
    let rgb = AxialRgb([1.0, 0.9, 0.5].map(|albedo| set.area(&Air::isotropic(albedo), Scatter::Multiple(3))));
    let mut worst = Worst::new("RGB against single look-ups", 2e-5);
    for i in 0..200 {
        let d = 1e-4 * 1.06f32.powi(i);
        let axis = Vec3::new((i as f32).sin(), (i as f32).cos(), 0.3).normalize();
        let geometry = Geometry::new(Vec3::new(0.6, 0.0, 0.8), Vec3::Z, axis);
        let sigma = [0.5, 1.0, 2.0];
        let got = rgb.irradiance(sigma, d, &geometry);
        for channel in 0..3 {
            let want = rgb.0[channel].irradiance(sigma[channel], d, &geometry);
            let optical = f64::from(sigma[channel] * d);
            if optical < 40.0 {
                worst.record(f64::from((got[channel] - want).abs()) / f64::from(want.abs() + 1e-30), || {
                    format!("d {d} channel {channel}")
                });
            }
        }
    }
    worst.check();
}

/// Moment `∫ L P_l dω` (l = 0, 1) of light from a lamp at distance d scattered `orders` ≤ 2 times, by random paths backwards from
/// the receiver: directions uniform in the angle from the axis, last leg equi-angular. Shares nothing with the tables.
fn monte_carlo(
    sigma_t: f64,
    albedo: f64,
    phase: &Phase<f64>,
    d: f64,
    lamp: impl Fn(f64) -> f64,
    order: usize,
    seed: u64,
) -> [(f64, f64); 2] {
    let mut random = SmallRng::seed_from_u64(seed);
    let count = 60_000;
    let mut moments = [Vec::with_capacity(count), Vec::with_capacity(count)];
    for _ in 0..count {
        let (gamma, phi) = (PI * random.random::<f64>(), 2.0 * PI * random.random::<f64>());
        let first = glam::DVec3::new(gamma.sin() * phi.cos(), gamma.sin() * phi.sin(), gamma.cos());
        let mut weight = 2.0 * PI * PI * gamma.sin();
        let (mut position, mut direction) = (glam::DVec3::ZERO, first);
        let source = glam::DVec3::Z * d;
        if order == 2 {
            let t = -(1.0 - random.random::<f64>()).ln() / sigma_t;
            position += direction * t;
            // The second direction is uniform in the angle from the line to the lamp.
            let axis = (source - position).normalize();
            let (angle, turn) = (PI * random.random::<f64>(), 2.0 * PI * random.random::<f64>());
            let (u, v) = axis.any_orthonormal_pair();
            let next = axis * angle.cos() + (u * turn.cos() + v * turn.sin()) * angle.sin();
            weight *= albedo * phase.eval(direction.dot(next)) * 2.0 * PI * PI * angle.sin();
            direction = next;
        }
        // Equi-angular along the ray (Kulla & Fajardo 2012), to infinity.
        let along = (source - position).dot(direction);
        let height = ((source - position) - direction * along).length();
        let (low, high) = ((-along / height).atan(), 0.5 * PI);
        let t = along + height * (low + (high - low) * random.random::<f64>()).tan();
        let place = position + direction * t;
        let to_lamp = source - place;
        let r = to_lamp.length();
        // 1/(pdf r²) = (high − low)/height.
        weight *= (high - low) / height
            * albedo
            * sigma_t
            * phase.eval(direction.dot(to_lamp) / r)
            * (-sigma_t * (t + r)).exp();
        // The lamp's axis points down to the receiver.
        weight *= lamp(to_lamp.z / r);
        let value = if weight.is_finite() { weight } else { 0.0 };
        moments[0].push(value);
        moments[1].push(value * first.z);
    }
    [mean_and_error(&moments[0]), mean_and_error(&moments[1])]
}

/// Point light and an area that faces the receiver, in two media.
#[test]
fn an_independent_monte_carlo_agrees() {
    let set = TableSet::embedded();
    let mut worst = Worst::new("tables against Monte Carlo, in standard errors", 4.0);
    let media = [(1.0, 1.0, Phase::Isotropic, 2), (2.5, 0.6, Phase::HenyeyGreenstein { g: 0.5 }, 1)];
    for (sigma_t, albedo, phase, orders) in media {
        for order in 1..=orders {
            let air = Air { albedo, phase: phase.clone() };
            let scatter = if order == 1 { Scatter::Single } else { Scatter::Multiple(2) };
            let d = 0.8;
            let mut c = [0.0f32; 11];
            set.point(&air, scatter).coefficients(sigma_t as f32, d as f32, &mut c);
            let facing = set.area(&air, scatter).coefficients(sigma_t as f32, d as f32, 1.0);
            let away = set.area(&air, scatter).coefficients(sigma_t as f32, d as f32, -1.0);
            for (name, coefficients, lamp) in [
                ("point", [c[0], c[1]], (|_| 1.0) as fn(f64) -> f64),
                ("area", [facing[0], facing[1]], |cos| cos.max(0.0)),
                ("area facing away", [away[0], away[1]], |cos| (-cos).max(0.0)),
            ] {
                let truth = monte_carlo(sigma_t, albedo, &phase, d, lamp, order, 7);
                for (l, (mean, error)) in truth.into_iter().enumerate() {
                    let got = f64::from(coefficients[l]) / ((2 * l + 1) as f64 / (4.0 * PI)).sqrt();
                    // The look-up's own 0.3 % of l = 0 is allowed beside the noise.
                    let allowed = error + 0.003 / 4.0 * truth_scale(&coefficients);
                    println!("{name} sigma {sigma_t} order {order} l {l}: {got:.5} Monte Carlo {mean:.5} ± {error:.5}");
                    worst
                        .record((got - mean).abs() / allowed, || format!("{name} sigma {sigma_t} order {order} l {l}"));
                }
            }
        }
    }
    worst.check();
}

fn truth_scale(coefficients: &[f32; 2]) -> f64 {
    f64::from(coefficients[0]) * (4.0 * PI).sqrt()
}
