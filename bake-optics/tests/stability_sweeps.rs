//! Random parameters over the stated domains: laws that hold everywhere, and textbook forms that break them on the same numbers.
//!
//! 256 draws a law; with `BAKE_LONG=1` 20,000.

use bake_optics::Real;
use bake_optics::airlight::{Airlight, ClosedForm, IsotropicLamp, Lut, Quadrature, Sight, UniformAir, Vacuum, macklin};
use bake_optics::emitter::Emitter;
use bake_optics::legendre::legendre;
use bake_optics::medium::exponential::{self, Climb};
use bake_optics::medium::linear;
use bake_optics::medium::planet::{self, Orbit};
use bake_optics::phase::{Deflection, Phase};
use bake_optics::quadrature::GaussLegendre;
use bake_optics::special::{chapman, chapman_horizontal, ln_chapman};
use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestError, TestRunner};
use std::f64::consts::PI;

/// Same seed in every run.
fn runner() -> TestRunner {
    let long = std::env::var("BAKE_LONG").as_deref() == Ok("1");
    let config = ProptestConfig {
        cases: if long { 20_000 } else { 256 },
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::default()
    };
    TestRunner::new_with_rng(config, proptest::test_runner::TestRng::deterministic_rng(Default::default()))
}

type Outcome = Result<(), TestCaseError>;

/// A law that must hold for all draws.
fn holds<S: Strategy>(draws: S, law: impl Fn(S::Value) -> Outcome) {
    runner().run(&draws, law).unwrap_or_else(|failure| panic!("{failure}"));
}

/// The negative control: the law must be broken by some draw.
fn breaks<S: Strategy>(what: &str, draws: S, law: impl Fn(S::Value) -> Outcome) {
    match runner().run(&draws, law) {
        Err(TestError::Fail(reason, _)) => println!("{what} breaks the law: {reason}"),
        _ => panic!("{what} must break the law"),
    }
}

/// 10^exponent.
fn decades(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    range.prop_map(|exponent| 10f64.powf(exponent))
}

/// Cosines with both poles and the horizon approached by decades.
fn cosines() -> impl Strategy<Value = f64> {
    (0..4, -1.0f64..1.0, -14.0f64..-1.0).prop_map(|(kind, c, exponent)| match kind {
        0 => 10f64.powf(exponent).copysign(c),
        1 => (1.0 - 10f64.powf(exponent)).copysign(c),
        _ => c,
    })
}

/// An optical length as a function of distance, its inverse and its density.
struct Path<F, I, D> {
    length: F,
    free: I,
    density: D,
}

/// Longer is deeper; the inverse returns the distance to the conditioning limit; nothing is NaN.
fn path_laws<T: Real>(
    path: &Path<impl Fn(T) -> T, impl Fn(T) -> T, impl Fn(T) -> T>,
    u: T,
    more: T,
    ulps: f64,
) -> Outcome {
    let (here, beyond) = ((path.length)(u), (path.length)(u * more));
    prop_assert!(here >= T::zero() && beyond >= here * (T::one() - T::of(ulps) * T::epsilon()), "{here} then {beyond}");
    let (density, back) = ((path.density)(u), (path.free)(here));
    prop_assert!(!back.is_nan() && back >= T::zero(), "inverse {back}");
    let condition = (here / (density * u)).max(T::one()) * (T::one() + density.ln().abs());
    if here > T::min_positive_value() && here < T::of(1e30) && condition * T::epsilon() < T::of(1e-3) {
        let error = ((back - u).abs() / (u * condition * T::epsilon())).as_f64();
        prop_assert!(error <= ulps, "inverse {back} of {u}: {error} ulp times condition");
    }
    Ok(())
}

fn linear_law<T: Real>((start, rate, u, more): (f64, f64, f64, f64)) -> Outcome {
    let (a, b) = (T::of(start), T::of(rate));
    let path = Path {
        length: |u| linear::optical_length(a, b, u),
        free: |q| linear::free_path(a, b, q),
        density: |u| (a + b * u).max(T::zero()),
    };
    path_laws(&path, T::of(u), T::of(more), 8.0)
}

fn exponential_law<T: Real>((n, height, cos_theta, u, more): (f64, f64, f64, f64, f64)) -> Outcome {
    let (n, climb) = (T::of(n), Climb { height: T::of(height), cos_theta: T::of(cos_theta) });
    let path = Path {
        length: |u| exponential::optical_length(n, climb, u),
        free: |q| exponential::free_path(n, climb, q),
        density: |u: T| (-n * (climb.height + u * climb.cos_theta)).exp(),
    };
    // The sum of the height's exponent and the ray's is rounded whole.
    path_laws(&path, T::of(u), T::of(more), 8.0 * (1.0 + (n * climb.height).abs().as_f64()))
}

fn planet_law<T: Real>((scale, height, cos_theta, u, more): (f64, f64, f64, f64, f64)) -> Outcome {
    // Planet of radius 1, scale height 1/scale; altitudes and distances in scale heights.
    let (n, h) = (T::of(scale), T::of(height / scale));
    let orbit = Orbit { radius: T::one() + h, altitude: h, cos_theta: T::of(cos_theta) };
    let path = Path {
        length: |u| planet::optical_length(n, orbit, u),
        free: |q| planet::free_path(n, orbit, q, T::infinity()),
        density: |u| (-n * orbit.altitude_at(u)).exp(),
    };
    path_laws(&path, T::of(u / scale), T::of(more), 64.0 * (1.0 + height))
}

fn signed_decades(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    (decades(range), any::<bool>()).prop_map(|(x, up)| if up { x } else { -x })
}

#[test]
fn media_are_monotone_and_invert() {
    let draws = || (signed_decades(-9.0..3.0), signed_decades(-9.0..1.0), decades(-5.0..5.0), 1.0..3.0);
    holds(draws(), linear_law::<f64>);
    holds(draws(), linear_law::<f32>);
    breaks("the density that goes negative", draws(), |(a, b, u, more)| {
        let length = |u: f64| u * (a + 0.5 * b * u);
        let free = |q: f64| ((a * a + 2.0 * b * q).sqrt() - a) / b;
        path_laws(&Path { length, free, density: |u: f64| (a + b * u).max(0.0) }, u, more, 8.0)
    });
    let draws = || (decades(-9.0..1.0), -20.0..40.0, cosines(), decades(-4.0..5.0), 1.0..3.0);
    let mild = || {
        draws().prop_filter("finite", |&(n, h, c, u, more): &(f64, f64, f64, f64, f64)| {
            (n * (h + c * u * more)).abs() < 60.0
        })
    };
    holds(mild(), exponential_law::<f64>);
    holds(mild(), exponential_law::<f32>);
    breaks("exp(x) - 1", mild(), |(n, h, c, u, more)| {
        let (p, e) = (-n * c, (-n * h).exp());
        let length = |u: f64| e * ((p * u).exp() - 1.0) / p;
        let free = |q: f64| (1.0 + p * q / e).ln() / p;
        path_laws(&Path { length, free, density: |u: f64| e * (p * u).exp() }, u, more, 8.0 * (1.0 + (n * h).abs()))
    });
}

#[test]
fn planets_are_monotone_and_invert_across_the_horizon() {
    let draws = || (decades(-1.0..4.0), 0.0..20.0, cosines(), decades(-4.0..2.0), 1.0..3.0);
    holds(draws(), planet_law::<f64>);
    holds(draws(), planet_law::<f32>);
    breaks("a difference of two endless rays", draws(), |(scale, height, cos_theta, u, more)| {
        let (n, h) = (scale, height / scale);
        let orbit = Orbit { radius: 1.0 + h, altitude: h, cos_theta };
        let endless = |orbit: Orbit<f64>| planet::optical_length(n, orbit, f64::INFINITY);
        let length = |s: f64| {
            let altitude = orbit.altitude_at(s);
            let cos_theta = ((s + orbit.radius * cos_theta) / (1.0 + altitude)).clamp(-1.0, 1.0);
            endless(orbit) - endless(Orbit { radius: 1.0 + altitude, altitude, cos_theta })
        };
        let free = |q| planet::free_path(n, orbit, q, f64::INFINITY);
        let density = |s| (-n * orbit.altitude_at(s)).exp();
        path_laws(&Path { length, free, density }, u / scale, more, 64.0 * (1.0 + height))
    });
}

#[test]
fn chapman_joins_at_the_horizon_and_lies_between_its_bounds() {
    let draws = || (decades(-6.0..8.0), cosines());
    // 1 ≤ C ≤ C_h above the horizon, below it C(c) + C(−c) = 2 e^{z − z0} C_h(z0).
    let law = |value: fn(f64, f64) -> f64| {
        move |(z, c): (f64, f64)| {
            let (up, level) = (value(z, c.abs()), chapman_horizontal(z));
            prop_assert!(up >= 1.0 - 4e-15 && up <= level * (1.0 + 8e-15), "C({z}, {}) = {up}, level {level}", c.abs());
            let near = value(z, 1e-12 / (1.0 + z.sqrt())) / level - 1.0;
            prop_assert!(near.abs() < 1e-11, "jump of {near} at the horizon, z {z}");
            let (above, below) = (ln_chapman(z, c.abs()), ln_chapman(z, -c.abs()));
            prop_assert!(below.is_finite() && below >= above - 8e-15, "below the horizon {below}, above {above}");
            prop_assert!(!chapman(z as f32, c as f32).is_nan());
            Ok(())
        }
    };
    holds(draws(), law(chapman));
    breaks("the two-term expansion", draws(), law(bake_optics::special::chapman_large_z));
}

fn phases() -> impl Strategy<Value = Phase<f64>> {
    (0..4, -1.0f64..1.0).prop_map(|(kind, x)| match kind {
        0 => Phase::Isotropic,
        1 => Phase::Rayleigh,
        2 => Phase::Linear { a1: x },
        _ => Phase::HenyeyGreenstein { g: 0.95 * x },
    })
}

#[test]
fn phase_functions_have_unit_norm_and_their_moments() {
    let rule = GaussLegendre::<f64>::cached(256);
    // 256 nodes in the angle resolve |g| ≤ 0.95 and degree 8.
    let law = |value: fn(&Phase<f64>, Deflection<f64>) -> f64| {
        move |(phase, l): (Phase<f64>, usize)| {
            let sum = rule.integrate(0.0, PI, |angle| {
                let d = Deflection::from_angle(angle);
                2.0 * PI * angle.sin() * value(&phase, d) * legendre(l, d.cos_theta)
            });
            let want = if l == 0 { 1.0 } else { phase.moment(l) };
            prop_assert!((sum - want).abs() < 1e-11, "{phase:?} moment {l}: {sum}, {want}");
            Ok(())
        }
    };
    holds((phases(), 0usize..8), law(|phase, d| phase.eval_deflected(d)));
    // Schlick's rational approximation of the same lobe.
    breaks(
        "another lobe",
        (phases(), 0usize..8),
        law(|phase, d| match phase {
            Phase::HenyeyGreenstein { g } => {
                let k = 1.55 * g - 0.55 * g.powi(3);
                (1.0 - k * k) / (4.0 * PI * (1.0 - k * d.cos_theta).powi(2))
            }
            _ => phase.eval_deflected(d),
        }),
    );
}

/// Rays at all scales about a lamp: angle, distance, length, extinction.
fn rays() -> impl Strategy<Value = (f64, f64, f64, f64)> {
    let angle = (0..4, 0.0f64..PI, -7.0f64..-1.0).prop_map(|(kind, angle, exponent)| match kind {
        0 => 10f64.powf(exponent),
        1 => PI - 10f64.powf(exponent),
        _ => angle,
    });
    (angle, decades(-3.0..3.0), decades(-4.0..5.0), decades(-8.0..1.5))
}

fn sight<T: Real>((angle, distance, length): (f64, f64, f64)) -> Sight<T> {
    let Sight { z, h, .. } = Sight::from_angle(angle, distance, length);
    Sight { z: T::of(z), h: T::of(h), length: T::of(length), axis_along: T::of(-0.5), axis_across: T::of(-0.7) }
}

fn air<T: Real>(sigma: f64) -> UniformAir<T> {
    UniformAir { sigma_s: T::of(sigma), sigma_t: T::of(sigma), phase: Phase::Isotropic }
}

/// Between what the whole ray's extinction leaves of the vacuum's light and all of it.
fn bounded_law<T: Real>(value: T, (angle, distance, length, sigma): (f64, f64, f64, f64), allowed: f64) -> Outcome {
    let (near, vacuum) = (sight::<f64>((angle, distance, length)), Vacuum::default());
    let most = vacuum.radiance(&near, &IsotropicLamp, &air::<f64>(sigma)) * (-sigma * near.h.min(distance)).exp();
    let end = (near.z + length).hypot(near.h);
    let least =
        vacuum.radiance(&near, &IsotropicLamp, &air::<f64>(sigma)) * (-sigma * (length + end.max(distance))).exp();
    let value = value.as_f64();
    let tiny = T::min_positive_value().as_f64() * 1e6;
    prop_assert!(value >= 0.0 && value.is_finite(), "{value}");
    prop_assert!(
        value <= most * (1.0 + allowed) + tiny && value + tiny >= least * (1.0 - allowed),
        "{least} {value} {most}"
    );
    Ok(())
}

#[test]
fn air_light_is_never_negative_and_within_the_vacuums_bounds() {
    let by = |nodes: usize| {
        move |ray: (f64, f64, f64, f64)| {
            let (angle, distance, length, sigma) = ray;
            let near = sight::<f64>((angle, distance, length));
            bounded_law(Quadrature::new(nodes).radiance(&near, &IsotropicLamp, &air(sigma)), ray, 1e-6)?;
            let spot = Quadrature::new(nodes).radiance(&near, &Emitter::CosinePower { exponent: 3.0 }, &air(sigma));
            prop_assert!(spot >= 0.0 && spot.is_finite(), "spot {spot}");
            let lut = Lut::new(2, 1).radiance(&near, &IsotropicLamp, &air(sigma));
            prop_assert!(lut >= 0.0 && lut.is_finite(), "table {lut}");
            bounded_law(ClosedForm::default().radiance(&near, &IsotropicLamp, &air(sigma)), ray, 1e-6)
        }
    };
    holds(rays(), by(32));
    holds(rays(), |ray| {
        let (angle, distance, length, sigma) = ray;
        let near = sight::<f32>((angle, distance, length));
        let exponent = 1.0 + sigma * distance;
        // The foot's distance h is rounded when the ray all but meets the lamp.
        bounded_law(Quadrature::new(32).radiance(&near, &IsotropicLamp, &air(sigma)), ray, 1e-5 * exponent)?;
        bounded_law(ClosedForm::default().radiance(&near, &IsotropicLamp, &air(sigma)), ray, 1e-4 * exponent)
    });
    breaks("32 equal steps", rays(), |ray| {
        let (angle, distance, length, sigma) = ray;
        let near = sight::<f64>((angle, distance, length));
        let march = bake_optics::airlight::RayMarch { steps: 32 };
        bounded_law(march.radiance(&near, &IsotropicLamp, &air(sigma)), ray, 1e-6)
    });
}

#[test]
fn vanishing_extinction_is_the_vacuum() {
    let law = |value: fn(&Sight<f64>) -> f64| {
        move |(angle, distance, length, _): (f64, f64, f64, f64)| {
            let near = sight::<f64>((angle, distance, length));
            let want = macklin::inverse_square_integral(near.z, near.h, length) / (4.0 * PI);
            let got = value(&near);
            prop_assert!((got / want - 1.0).abs() < 1e-9, "{near:?}: {got}, {want}");
            Ok(())
        }
    };
    let thin = UniformAir { sigma_s: 1.0, sigma_t: 1e-18, phase: Phase::Isotropic };
    holds(rays(), |ray| {
        let near = sight::<f64>((ray.0, ray.1, ray.2));
        let got = Quadrature::new(128).radiance(&near, &IsotropicLamp, &thin);
        let want = macklin::inverse_square_integral(near.z, near.h, ray.2) / (4.0 * PI);
        prop_assert!((got / want - 1.0).abs() < 1e-6, "{near:?}: {got}, {want}");
        Ok(())
    });
    holds(rays(), law(|s| Vacuum::default().radiance(s, &IsotropicLamp, &UniformAir { sigma_s: 1.0, ..air(0.0) })));
    breaks(
        "a difference of arc tangents",
        rays(),
        law(|s| (((s.z + s.length) / s.h).atan() - (s.z / s.h).atan()) / s.h / (4.0 * PI)),
    );
}

/// Rays through the lamp itself are infinite in every method; rays that stop short of it are finite and agree.
#[test]
fn rays_through_the_lamp() {
    let draws = || (decades(-3.0..3.0), 0.01f64..0.9, decades(-6.0..1.0));
    let law = |value: fn(f64, f64, f64) -> f64| {
        move |(distance, share, sigma): (f64, f64, f64)| {
            // γ = 0, V < T: β² e^{−T} V/(4π T (T − V)) in optical lengths.
            let (t, v) = (sigma * distance, sigma * distance * share);
            let want = sigma * sigma * (-t).exp() * v / (4.0 * PI * t * (t - v));
            let got = value(distance, share * distance, sigma);
            prop_assert!((got - want).abs() <= 1e-9 * want + 1e-300, "{got} want {want}");
            for method in [1usize, 8] {
                let through = sight::<f64>((0.0, distance, distance / share));
                prop_assert_eq!(Quadrature::new(method).radiance(&through, &IsotropicLamp, &air(sigma)), f64::INFINITY);
                prop_assert_eq!(ClosedForm::default().radiance(&through, &IsotropicLamp, &air(sigma)), f64::INFINITY);
                prop_assert_eq!(Lut::new(2, 1).radiance(&through, &IsotropicLamp, &air(sigma)), f64::INFINITY);
            }
            Ok(())
        }
    };
    holds(draws(), law(|d, l, s| Quadrature::new(16).radiance(&sight::<f64>((0.0, d, l)), &IsotropicLamp, &air(s))));
    holds(draws(), law(|d, l, s| Quadrature::new(16).radiance(&sight::<f64>((1e-9, d, l)), &IsotropicLamp, &air(s))));
    // The wrong branch for v_b − v_a: nothing is left of a ray that all but meets the lamp.
    breaks(
        "v_b − v_a as a difference",
        draws(),
        law(|d, l, s| {
            let near = sight::<f64>((1e-9, d, l));
            let v = |z: f64| (z + z.hypot(near.h)) / near.h;
            let (a, b) = (v(near.z), v(near.z + l));
            s / (2.0 * PI * near.h) * (-s * d).exp() * (b.atan() - a.atan())
        }),
    );
}

/// The path s + r grows along the ray, so M_k lies between M_0 times its k-th power at either end.
#[test]
fn moments_lie_between_those_of_the_ends() {
    let law = |value: fn(f64, f64, f64) -> [f64; 5]| {
        move |(angle, distance, length, _): (f64, f64, f64, f64)| {
            let near = sight::<f64>((angle, distance, length));
            let (first, last) = (near.eye_distance(), length + (near.z + length).hypot(near.h));
            let moments = value(near.z, near.h, length);
            for (k, moment) in moments.iter().enumerate() {
                let share = moment / moments[0];
                let (least, most) = (first.powi(k as i32), last.powi(k as i32));
                prop_assert!(
                    share >= least * (1.0 - 1e-9) && share <= most * (1.0 + 1e-9),
                    "M_{k}: {least} {share} {most}"
                );
            }
            Ok(())
        }
    };
    holds(rays(), law(macklin::extinction_moments));
    breaks(
        "M_1 and M_2 as sums of logarithms",
        rays(),
        law(|z, h, length| {
            let (end, m0) = (z + length, macklin::inverse_square_integral(z, h, length));
            let (ra, rb) = (z.hypot(h), end.hypot(h));
            let (ln_ratio, angle) = ((rb / ra).ln(), (end / h).asinh() - (z / h).asinh());
            let m1 = ln_ratio + angle - z * m0;
            let m2 = 2.0 * length + (z * z - h * h) * m0 - 2.0 * z * (ln_ratio + angle) + 2.0 * (rb - ra);
            [m0, m1, m2, m0 * ra.powi(3), m0 * ra.powi(4)]
        }),
    );
}
