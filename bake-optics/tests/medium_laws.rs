//! Laws of the kernels over wide ranges in both precisions, each with the textbook form as negative control.

use bake_optics::Real;
use bake_optics::medium::exponential::{self, Climb};
use bake_optics::medium::linear;
use bake_optics::medium::planet::{self, Orbit};
use testkit::compare::Worst;

/// A path: optical length and its inverse as functions of plain numbers, and the density along it.
struct Path<T> {
    name: String,
    length: Box<dyn Fn(T) -> T>,
    free: Box<dyn Fn(T) -> T>,
    density: Box<dyn Fn(T) -> T>,
}

const COSINES: [f64; 13] = [-1.0, -0.7, -0.1, -1e-3, -1e-6, -1e-12, 0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.7, 1.0];

fn linear_paths<T: Real>() -> Vec<Path<T>> {
    let mut paths = Vec::new();
    for start in [-2.0, -1e-6, 0.0, 1e-9, 1e-3, 1.0, 50.0] {
        for rate in COSINES.iter().flat_map(|c| [c * 0.05, c * 10.0]) {
            let (a, b) = (T::of(start), T::of(rate));
            paths.push(Path {
                name: format!("linear start {start} rate {rate}"),
                length: Box::new(move |u| linear::optical_length(a, b, u)),
                free: Box::new(move |q| linear::free_path(a, b, q)),
                density: Box::new(move |u| (a + b * u).max(T::zero())),
            });
        }
    }
    paths
}

fn exponential_paths<T: Real>() -> Vec<Path<T>> {
    let mut paths = Vec::new();
    for n in [0.0, 1e-9, 1e-4, 0.125, 2.0] {
        for (height, cos_theta) in [-20.0, 0.0, 3.0, 40.0].iter().flat_map(|&h| COSINES.map(|c| (h, c))) {
            let (n, climb) = (T::of(n), Climb { height: T::of(height), cos_theta: T::of(cos_theta) });
            paths.push(Path {
                name: format!("exponential n {n} height {height} cos {cos_theta}"),
                length: Box::new(move |u| exponential::optical_length(n, climb, u)),
                free: Box::new(move |q| exponential::free_path(n, climb, q)),
                density: Box::new(move |u| (-n * (climb.height + u * climb.cos_theta)).exp()),
            });
        }
    }
    paths
}

fn planet_paths<T: Real>() -> Vec<Path<T>> {
    let mut paths = Vec::new();
    // (1/scale height, planet radius, altitude): Earth in km and in metres, an asteroid, a ball smaller than its scale height.
    for (n, r, h) in
        [(0.125, 6360.0, 0.0), (0.125, 6360.0, 60.0), (1.25e-4, 6.36e6, 2.0), (2.0, 10.0, 1.0), (0.1, 1.0, 1.0)]
    {
        for cos_theta in COSINES {
            let orbit = Orbit { radius: T::of(r + h), altitude: T::of(h), cos_theta: T::of(cos_theta) };
            let n = T::of(n);
            paths.push(Path {
                name: format!("planet n {n} R {r} h {h} cos {cos_theta}"),
                length: Box::new(move |u| planet::optical_length(n, orbit, u)),
                free: Box::new(move |q| planet::free_path(n, orbit, q, T::infinity())),
                density: Box::new(move |u| (-n * orbit.altitude_at(u)).exp()),
            });
        }
    }
    paths
}

fn distances<T: Real>() -> impl Iterator<Item = T> {
    (-18..=24).map(|i| T::of(10f64.powf(f64::from(i) * 0.25)))
}

/// Never negative, never NaN, never decreasing; the slope is the density; infinity is the limit.
fn obeys_laws<T: Real>(paths: &[Path<T>], allowed: f64) {
    let mut worst = Worst::new("fall of the optical length / its value", allowed);
    for path in paths {
        let mut previous = T::zero();
        for u in distances::<T>() {
            let here = (path.length)(u);
            assert!(here >= T::zero(), "{} at {u}: {here}", path.name);
            if previous > T::zero() && previous < T::infinity() {
                worst
                    .record(((previous - here) / previous).max(T::zero()).as_f64(), || format!("{} at {u}", path.name));
            }
            previous = here;
        }
        let everything = (path.length)(T::infinity());
        assert!(everything >= previous * T::of(1.0 - allowed), "{}: {everything} beyond {previous}", path.name);
    }
    worst.check();
}

/// free(length(u)) = u to the conditioning limit: rounding the length by ε moves u by ε length/density.
fn inverts<T: Real>(paths: &[Path<T>], allowed_ulps: f64) {
    let mut worst = Worst::new("inverse of forward, in ulp times condition", allowed_ulps);
    for path in paths {
        for u in distances::<T>() {
            let depth = (path.length)(u);
            let density = (path.density)(u);
            let condition = (depth / (density * u)).max(T::one());
            if !(depth > T::min_positive_value() && depth < T::of(1e30) && condition * T::epsilon() < T::of(1e-3)) {
                continue;
            }
            // Exponents are formed from rounded inputs: their size counts as condition, too.
            let exponent = T::one() + density.ln().abs();
            let error = ((path.free)(depth) - u).abs() / (u * condition * exponent * T::epsilon());
            worst.record(error.as_f64(), || format!("{} u {u}", path.name));
        }
    }
    worst.check();
}

/// Two halves make the whole.
fn adds_up(paths: &[Path<f64>], rest: impl Fn(usize, f64) -> Box<dyn Fn(f64) -> f64>, allowed: f64) {
    let mut worst = Worst::new("optical length of two parts against the whole", allowed);
    for (i, path) in paths.iter().enumerate() {
        for u in distances::<f64>() {
            let (whole, first) = ((path.length)(u), (path.length)(0.3 * u));
            if whole < 1e250 && whole > 0.0 {
                worst.relative(first + rest(i, 0.3 * u)(0.7 * u), whole, || format!("{} u {u}", path.name));
            }
        }
    }
    worst.check();
}

#[test]
fn linear_laws() {
    obeys_laws::<f64>(&linear_paths(), 1e-15);
    obeys_laws::<f32>(&linear_paths(), 2e-7);
    inverts::<f64>(&linear_paths(), 8.0);
    inverts::<f32>(&linear_paths(), 8.0);
}

#[test]
fn exponential_laws() {
    obeys_laws::<f64>(&exponential_paths(), 1e-15);
    obeys_laws::<f32>(&exponential_paths(), 2e-6);
    inverts::<f64>(&exponential_paths(), 8.0);
    inverts::<f32>(&exponential_paths(), 8.0);
}

/// Far below the base in f32: e^{−n h} overflows where its product with a small length does not.
#[test]
fn exponential_density_overflows_no_earlier_than_the_depth() {
    let (n, climb) = (8.0f32, Climb { height: -12.5, cos_theta: 0.5 });
    let exact = Climb { height: -12.5, cos_theta: 0.5 };
    let depth = exponential::optical_length(n, climb, 1e-8);
    let want = exponential::optical_length(8.0, exact, 1e-8f64);
    assert!((f64::from(depth) / want - 1.0).abs() < 2e-5, "{depth} {want}");
    let back = exponential::free_path(n, climb, depth);
    assert!((back / 1e-8 - 1.0).abs() < 2e-5, "{back}");
    for cos_theta in [-0.5, 0.0, 0.5] {
        let climb = Climb { cos_theta, ..climb };
        assert_eq!(exponential::free_path(n, climb, f32::INFINITY), f32::INFINITY, "cos {cos_theta}");
    }
    let level = Climb { height: 1e4, cos_theta: 0.0 };
    assert_eq!(exponential::optical_length(1.0, level, f64::INFINITY), f64::INFINITY);
}

#[test]
fn planet_laws() {
    obeys_laws::<f64>(&planet_paths(), 1e-13);
    obeys_laws::<f32>(&planet_paths(), 4e-6);
    inverts::<f64>(&planet_paths(), 64.0);
    inverts::<f32>(&planet_paths(), 64.0);
    let rest = |n: f64, r: f64, h: f64, cos_theta: f64, s: f64| {
        let orbit = Orbit { radius: r + h, altitude: h, cos_theta };
        let altitude = orbit.altitude_at(s);
        let radius = r + altitude;
        // d r/d s = (s + r cos)/r(s).
        let later = Orbit { radius, altitude, cos_theta: ((s + (r + h) * cos_theta) / radius).clamp(-1.0, 1.0) };
        move |u: f64| planet::optical_length(n, later, u)
    };
    let small: Vec<Path<f64>> = planet_paths().into_iter().filter(|p| p.name.contains("R 10 ")).collect();
    adds_up(&small, |i, s| Box::new(rest(2.0, 10.0, 1.0, COSINES[i], s)), 1e-12);
}

#[test]
fn planet_agrees_with_brute_force_across_the_horizon() {
    let mut worst = Worst::new("planet against 4000 midpoint panels of 8 nodes", 1e-12);
    let rule = bake_optics::quadrature::GaussLegendre::<f64>::cached(8);
    for (n, r, h, u) in
        [(0.125, 6360.0, 0.5, 700.0), (2.0, 10.0, 3.0, 40.0), (0.1, 1.0, 2.0, 90.0), (3.0, 0.01, 0.5, 4.0)]
    {
        // Straight down (i = 60) the integrand has a kink at the centre, which the panels do not know of.
        for i in 0..60 {
            let cos_theta = (std::f64::consts::PI * f64::from(i) / 60.0).cos();
            let orbit = Orbit { radius: r + h, altitude: h, cos_theta };
            let width = u / 4000.0;
            let want: f64 = (0..4000)
                .map(|k| rule.integrate_offset(width, |s| (-n * orbit.altitude_at(f64::from(k) * width + s)).exp()))
                .sum();
            worst.relative(planet::optical_length(n, orbit, u), want, || format!("n {n} R {r} h {h} cos {cos_theta}"));
        }
    }
    worst.check();
}

#[test]
fn a_ray_through_the_very_centre_of_a_planet_is_finite() {
    // ∫_0^∞ e^{−n (s − R)} ds = e^{nR}/n.
    let orbit = Orbit { radius: 1e-300, altitude: -1.0, cos_theta: 0.3 };
    let got = planet::optical_length(2.0, orbit, f64::INFINITY);
    assert!((got / (2f64.exp() / 2.0) - 1.0).abs() < 1e-12, "{got}");
}

mod textbook {
    //! The printed forms, which the sweeps above must refuse.
    use super::*;

    /// Golubev eqs. 28, 31 with the minus sign, density not clamped.
    pub fn linear<T: Real>(a: f64, b: f64) -> Path<T> {
        let (a, b) = (T::of(a), T::of(b));
        Path {
            name: "linear, printed".into(),
            length: Box::new(move |u| u * (a + b * u * T::of(0.5))),
            free: Box::new(move |q| ((a * a + T::of(2.0) * b * q).sqrt() - a) / b),
            density: Box::new(move |u| a + b * u),
        }
    }

    /// Golubev eqs. 34, 35 with exp(x) − 1 and ln(1 + x).
    pub fn exponential<T: Real>(n: f64, cos_theta: f64) -> Path<T> {
        let (p, one) = (T::of(-n * cos_theta), T::one());
        Path {
            name: "exponential, printed".into(),
            length: Box::new(move |u| ((p * u).exp() - one) / p),
            free: Box::new(move |q| (one + p * q).ln() / p),
            density: Box::new(move |u| (p * u).exp()),
        }
    }

    #[test]
    #[should_panic(expected = "linear, printed")]
    fn unclamped_linear_density_breaks_monotony() {
        obeys_laws::<f64>(&[linear(1.0, -0.05)], 1e-15);
    }

    #[test]
    #[should_panic(expected = "inverse of forward")]
    fn cancelling_root_is_not_the_inverse() {
        inverts::<f32>(&[linear(1.0, 1e-6)], 8.0);
    }

    #[test]
    #[should_panic(expected = "inverse of forward")]
    fn exponential_without_expm1_is_not_the_inverse() {
        inverts::<f32>(&[exponential(1e-4, 1.0)], 8.0);
    }

    /// Optical length as a difference of two infinite rays, the way of the Chapman-function listing, with exact Chapman values.
    #[test]
    fn differences_of_infinite_rays_lose_short_segments() {
        let orbit = Orbit { radius: 6361.0f32, altitude: 1.0, cos_theta: 0.2 };
        let u = 1e-3f32;
        let moved = Orbit { radius: 6361.0 + 0.2 * u, altitude: 1.0 + 0.2 * u, cos_theta: 0.2 };
        let all = |o| planet::optical_length(0.125f32, o, f32::INFINITY);
        let want = planet::optical_length(
            0.125f64,
            Orbit { radius: 6361.0, altitude: 1.0, cos_theta: f64::from(0.2f32) },
            f64::from(u),
        );
        let ours = f64::from(planet::optical_length(0.125f32, orbit, u));
        let difference = f64::from(all(orbit) - all(moved));
        assert!((ours / want - 1.0).abs() < 1e-6, "ours {ours} want {want}");
        assert!((difference / want - 1.0).abs() > 1e-3, "difference {difference} want {want}");
    }
}
