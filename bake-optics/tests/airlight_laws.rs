//! Laws of air-light over wide ranges, and the textbook forms that break them.

use bake_optics::Real;
use bake_optics::airlight::pegoraro::{self, Basis};
use bake_optics::airlight::{
    Airlight, ClosedForm, IsotropicLamp, Lamp, Lut, MediumAlong, Oracle, Quadrature, RayMarch, Sight, UniformAir,
    Vacuum, macklin, sun,
};
use bake_optics::emitter::Emitter;
use bake_optics::medium::{Bounds, Density, Medium, MediumSet, Ray, Scatter};
use bake_optics::phase::Phase;
use bake_optics::{psf, surface};
use glam::DVec3;
use smallvec::SmallVec;
use std::f64::consts::PI;
use testkit::compare::{Worst, relative_error};
use testkit::statistics;

const ANGLES: [f64; 12] = [0.0, 1e-12, 1e-7, 1e-3, 0.1, 0.7, 0.5 * PI, 2.4, 3.1, 3.13, PI - 1e-7, PI];
const DISTANCES: [f64; 4] = [1e-3, 0.7, 30.0, 2e3];
const LENGTHS: [f64; 6] = [1e-4, 0.3, 5.0, 100.0, 1e6, f64::INFINITY];
const EXTINCTIONS: [f64; 6] = [0.0, 1e-12, 1e-5, 1e-2, 0.5, 20.0];

fn phases<T: Real>() -> Vec<Phase<T>> {
    let hg = |g: f64| Phase::HenyeyGreenstein { g: T::of(g) };
    vec![Phase::Isotropic, Phase::Rayleigh, Phase::Linear { a1: T::of(-1.0) }, hg(-0.9), hg(0.5), hg(0.999)]
}

fn lamps<T: Real>() -> Vec<Emitter<T>> {
    let cone = Emitter::SpotCone { cos_inner: T::of(0.95), cos_outer: T::of(0.8) };
    vec![Emitter::Isotropic, Emitter::CosinePower { exponent: T::of(10.0) }, cone]
}

/// All sights of the sweep that do not run into the lamp, in order of growing length for each direction.
fn sights<T: Real>() -> impl Iterator<Item = Sight<T>> {
    let all = ANGLES.into_iter().flat_map(|a| DISTANCES.map(|d| (a, d))).flat_map(|(a, d)| LENGTHS.map(|l| (a, d, l)));
    all.map(|(a, d, l)| Sight {
        axis_along: T::of(-0.5),
        axis_across: T::of(-0.7),
        ..Sight::from_angle(T::of(a), T::of(d), T::of(l))
    })
    .filter(|s| !s.meets_lamp())
}

/// Radiance of a ray with unit scattering at extinction 0 and scattering = extinction else.
fn each<T: Real>(mut check: impl FnMut(&Sight<T>, &UniformAir<T>, &Emitter<T>)) {
    for phase in phases::<T>() {
        for sigma in EXTINCTIONS {
            let sigma_s = if sigma == 0.0 { 1.0 } else { sigma };
            let air = UniformAir { sigma_s: T::of(sigma_s), sigma_t: T::of(sigma), phase: phase.clone() };
            for lamp in lamps() {
                sights().for_each(|sight| check(&sight, &air, &lamp));
            }
        }
    }
}

fn never_negative_and_grows_with_length<T: Real>(nodes: usize, allowed: f64) {
    let mut worst = Worst::new("fall of air-light on a longer ray, of its value", allowed);
    let mut last: Option<(Sight<T>, T)> = None;
    each(|sight: &Sight<T>, air, lamp| {
        let here = Quadrature::new(nodes).radiance(sight, lamp, air);
        assert!(here >= T::zero() && here.is_finite(), "{here} for {sight:?} {air:?} {lamp:?}");
        match last {
            Some((s, before))
                if (s.z, s.h) == (sight.z, sight.h) && s.length < sight.length && before > T::min_positive_value() =>
            {
                worst.record(((before - here) / before).max(T::zero()).as_f64(), || {
                    format!("{sight:?} {air:?} {lamp:?}")
                });
            }
            _ => {}
        }
        last = Some((*sight, here));
    });
    worst.check();
}

#[test]
fn quadrature_is_finite_positive_and_grows_in_f64() {
    // The allowance is the rule's own error on the hardest rays: the lamp next to the ray.
    never_negative_and_grows_with_length::<f64>(64, 1e-6);
}

#[test]
fn quadrature_is_finite_and_positive_in_f32() {
    never_negative_and_grows_with_length::<f32>(64, 5e-6);
}

#[test]
fn other_methods_are_finite_and_not_negative() {
    let lut = Lut::new(32, 3);
    for (i, sight) in sights::<f64>().enumerate() {
        for sigma in EXTINCTIONS {
            let air = UniformAir { sigma_s: 0.5, sigma_t: sigma, phase: phases()[i % 3].clone() };
            let values = [
                Vacuum::default().radiance(&sight, &Emitter::Isotropic, &air),
                lut.radiance(&sight, &IsotropicLamp, &air),
                ClosedForm::default().radiance(&sight, &Emitter::Isotropic, &air),
            ];
            assert!(values.iter().all(|v| v.is_finite()), "{values:?} {sight:?} {air:?}");
            let bound = values[0] * 1e-9;
            assert!(values.iter().all(|v| *v >= -bound), "{values:?} {sight:?} {air:?}");
        }
    }
}

#[test]
fn vanishing_extinction_is_the_vacuum() {
    let mut worst = Worst::new("σ_t = 1e-13 against the vacuum's closed form", 1e-9);
    for sight in sights::<f64>().filter(|s| s.length <= 100.0 && s.h > 1e-6) {
        let air = UniformAir { sigma_s: 1.0, sigma_t: 1e-13, phase: Phase::Isotropic };
        let want = macklin::inverse_square_integral(sight.z, sight.h, sight.length) / (4.0 * PI);
        worst.relative(Quadrature::new(64).radiance(&sight, &Emitter::Isotropic, &air), want, || format!("{sight:?}"));
    }
    worst.check();
}

/// γ = 0 short of the lamp: β² e^{−T} V/(4π T (T − V)); the limit from small angles must run into it.
#[test]
fn rays_straight_at_the_lamp_need_no_special_case() {
    let (t, v) = (2.0f64, 0.7);
    let want = (-t).exp() * v / (4.0 * PI * t * (t - v));
    let air = UniformAir { sigma_s: 1.0, sigma_t: 1.0, phase: Phase::Isotropic };
    for gamma in [0.0, 1e-30, 1e-12, 1e-9] {
        let got = Quadrature::new(16).radiance(&Sight::from_angle(gamma, t, v), &Emitter::Isotropic, &air);
        assert!(relative_error(got, want) < 1e-14, "γ {gamma}: {got} want {want}");
        let air = UniformAir { sigma_s: 1.0f32, sigma_t: 1.0, phase: Phase::Isotropic };
        let got = Quadrature::new(16).radiance(&Sight::from_angle(gamma as f32, 2.0, 0.7), &Emitter::Isotropic, &air);
        assert!(relative_error(got.into(), want) < 1e-6, "f32, γ {gamma}: {got} want {want}");
    }
    assert_eq!(Quadrature::new(8).radiance(&Sight::from_angle(0.0, t, 3.0), &Emitter::Isotropic, &air), f64::INFINITY);
}

#[test]
fn strongly_peaked_phase_functions_converge() {
    let mut worst = Worst::new("HG ±0.99 with 128+128 nodes against the oracle", 1e-9);
    for g in [-0.99, 0.99] {
        let air = UniformAir { sigma_s: 0.1, sigma_t: 0.1, phase: Phase::HenyeyGreenstein { g } };
        for sight in sights::<f64>().filter(|s| s.h > 1e-3 && s.length > 0.1) {
            let want = Oracle::default().radiance(&sight, &Emitter::Isotropic, &air);
            worst.relative(Quadrature::new(128).radiance(&sight, &Emitter::Isotropic, &air), want, || {
                format!("{sight:?}")
            });
        }
    }
    worst.check();
}

/// A lamp that does not tell where it goes dark.
struct Silent(Emitter<f64>);
impl Lamp<f64> for Silent {
    fn intensity(&self, cos_axis: f64) -> f64 {
        self.0.eval(cos_axis)
    }
    fn jumps(&self) -> SmallVec<[f64; 2]> {
        SmallVec::new()
    }
}

#[test]
fn lamps_with_edges_are_cut_at_them() {
    let air = UniformAir { sigma_s: 0.3, sigma_t: 0.3, phase: Phase::Isotropic };
    let lamp = Emitter::SpotCone { cos_inner: 0.85, cos_outer: 0.8 };
    let mut cut = Worst::new("spot cone, 16+16 nodes a piece", 1e-10);
    let mut uncut = Worst::new("spot cone, not cut", 1e-10);
    for i in 0..40 {
        let turn = f64::from(i) * 0.15;
        let sight = Sight { z: -4.0, h: 1.5, length: 9.0, axis_along: turn.cos(), axis_across: turn.sin() };
        let want = Oracle::default().radiance(&sight, &lamp, &air);
        if want > 0.0 {
            cut.relative(Quadrature::new(16).radiance(&sight, &lamp, &air), want, || format!("{turn}"));
            uncut.relative(Quadrature::new(16).radiance(&sight, &Silent(lamp.clone()), &air), want, || {
                format!("{turn}")
            });
        }
    }
    cut.check();
    assert!(!uncut.holds(), "the comparison must notice a missing cut");
}

#[test]
fn light_beyond_a_long_dark_stretch_is_found() {
    // The lamp shines away from the eye: the lit part begins 60 optical depths ahead.
    let air = UniformAir { sigma_s: 1.0, sigma_t: 1.0, phase: Phase::Isotropic };
    let sight = Sight { z: -60.0, h: 1.0, length: f64::INFINITY, axis_along: 1.0, axis_across: 0.0 };
    let lamp = Emitter::CosinePower { exponent: 1.0 };
    let got = Quadrature::new(32).radiance(&sight, &lamp, &air);
    let want = Oracle::default().radiance(&sight, &lamp, &air);
    assert!(got > 0.0 && relative_error(got, want) < 1e-9, "{got} {want}");
}

#[test]
fn errors_fall_as_each_rule_promises() {
    let air = UniformAir { sigma_s: 0.2, sigma_t: 0.2, phase: Phase::HenyeyGreenstein { g: 0.7 } };
    let sight = Sight::from_angle(0.4, 3.0, 20.0);
    let want = Oracle::default().radiance(&sight, &Emitter::Isotropic, &air);
    let (steps, errors): (Vec<f64>, Vec<f64>) = (7..=11)
        .map(|k| {
            let steps = 1 << k;
            let got = RayMarch { steps }.radiance(&sight, &Emitter::Isotropic, &air);
            ((steps as f64).ln(), relative_error(got, want).ln())
        })
        .unzip();
    let slope = statistics::slope(&steps, &errors);
    assert!((slope + 2.0).abs() < 0.2, "ray march: order {slope}, expected −2");
    let errors: Vec<f64> = [4, 8, 12, 16]
        .map(|n| relative_error(Quadrature::new(n).radiance(&sight, &Emitter::Isotropic, &air), want))
        .to_vec();
    assert!(errors.windows(2).all(|e| e[1] < 0.1 * e[0]), "quadrature is geometric: {errors:?}");
}

fn medium(density: Density, bounds: Bounds) -> Medium {
    let scatter = Scatter { sigma_s: [0.3; 3], sigma_a: [0.1; 3] };
    Medium { density, bounds, scatter, phase: Phase::Rayleigh }
}

#[test]
fn air_that_varies_agrees_with_the_uniform_form_and_with_a_fine_march() {
    let ray = Ray::new(DVec3::new(-3.0, 0.5, 0.2), DVec3::new(1.0, 0.2, 0.1).normalize(), 7.0);
    let (lamp_at, axis) = (DVec3::new(0.4, 2.0, -0.5), DVec3::NEG_Y);
    let uniform = MediumSet { media: vec![medium(Density::Uniform, Bounds::Unbounded)] };
    let along = MediumAlong::new(&uniform, 0, ray, lamp_at);
    let sight = along.sight(axis);
    let lamp = Emitter::CosinePower { exponent: 2.0 };
    let air = UniformAir { sigma_s: 0.3, sigma_t: 0.4, phase: Phase::Rayleigh };
    let want = Quadrature::new(32).radiance(&sight, &lamp, &air);
    let got = Quadrature::new(32).radiance(&sight, &lamp, &along);
    assert!(relative_error(got, want) < 1e-13, "uniform: {got} want {want}");

    let corner = DVec3::new(1.5, 3.0, 2.0);
    let layered = MediumSet {
        media: vec![
            medium(Density::Exponential { base_m: 0.0, scale_height_m: 0.8 }, Bounds::Unbounded),
            medium(Density::Linear { zero_m: -1.0, slope_per_m: 0.3 }, Bounds::Box { min: -corner, max: corner }),
        ],
    };
    let along = MediumAlong::new(&layered, 1, ray, lamp_at);
    let march = RayMarch { steps: 20_000 }.radiance(&sight, &lamp, &along);
    let got = Quadrature::new(32).radiance(&sight, &lamp, &along);
    let oracle = Oracle::default().radiance(&sight, &lamp, &along);
    assert!(relative_error(got, oracle) < 1e-6, "{got} oracle {oracle}");
    assert!(relative_error(got, march) < 1e-4, "{got} march {march}");
    let thin = MediumSet { media: vec![layered.media[0].clone()] };
    let other = Quadrature::new(32).radiance(&sight, &lamp, &MediumAlong::new(&thin, 1, ray, lamp_at));
    assert!(relative_error(other, march) > 1e-2, "the march must notice a missing medium");
}

#[test]
fn endless_rays_end_where_the_air_does() {
    let ball = Bounds::Sphere { centre: DVec3::ZERO, radius: 2.0 };
    let set = MediumSet { media: vec![medium(Density::Uniform, ball)] };
    let lamp_at = DVec3::new(0.5, 1.0, 0.0);
    let value = |length: f64| {
        let along = MediumAlong::new(&set, 2, Ray::new(DVec3::new(-5.0, 0.0, 0.0), DVec3::X, length), lamp_at);
        Oracle::default().radiance(&along.sight(DVec3::Y), &Emitter::Isotropic, &along)
    };
    assert!(relative_error(value(f64::INFINITY), value(50.0)) < 1e-9);
}

#[test]
fn tables_are_close_on_long_rays() {
    let lut = Lut::new(64, 3);
    let mut worst = Worst::new("64² table on rays longer than the lamp's distance", 1e-3);
    for gamma in [0.05, 0.3, 1.0, 1.5, 2.2] {
        for (distance, sigma) in [(0.5, 0.1), (3.0, 0.1), (3.0, 1.0), (10.0, 0.3)] {
            for phase in [Phase::Isotropic, Phase::Rayleigh] {
                let (sight, air) = (
                    Sight::from_angle(gamma, distance, 2.0 * distance),
                    UniformAir { sigma_s: sigma, sigma_t: sigma, phase },
                );
                let want = Oracle::default().radiance(&sight, &Emitter::Isotropic, &air);
                worst.relative(lut.radiance(&sight, &IsotropicLamp, &air), want, || {
                    format!("{gamma} {distance} {sigma}")
                });
            }
        }
    }
    worst.check();
    let table = surface::SurfaceTable::new(32, 1.0);
    let mut worst = Worst::new("32² surface table, of the value at θ = 0", 5e-3);
    for t in [0.05f64, 0.7, 3.0, 9.0] {
        for theta in [0.1, 1.1, 2.5] {
            let error = (table.look_up(t, theta) - surface::g(1.0, t, theta)).abs() / surface::g(1.0, t, 0.0);
            worst.record(error, || format!("{t} {theta}"));
        }
    }
    worst.check();
}

#[test]
fn glow_factors_agree_with_brute_force_and_scale_bands() {
    let factors = psf::convolution_factors(1.3f64, 9);
    for l in [0usize, 1, 4, 8] {
        // Midpoint rule over γ: the kernel is finite.
        let steps = 20_000;
        let sum: f64 = (0..steps)
            .map(|i| {
                let gamma = PI * (f64::from(i) + 0.5) / f64::from(steps);
                2.0 * PI * gamma.sin() * psf::psf(gamma, 1.3) * bake_optics::legendre::legendre(l, gamma.cos()) * PI
                    / f64::from(steps)
            })
            .sum();
        assert!((factors[l] - sum).abs() < 1e-6 * factors[0], "l {l}: {} {sum}", factors[l]);
    }
    let mut sh = vec![1.0; 81];
    psf::convolve(1.3, &mut sh);
    assert_eq!((sh[0], sh[1], sh[3], sh[4], sh[80]), (factors[0], factors[1], factors[1], factors[2], factors[8]));
}

mod textbook {
    //! Printed forms, which must fail where ours hold.
    use super::*;

    /// Sun et al.'s F(A_1, v2) − F(A_1, v1) with both values exact but rounded to f32, angles near π.
    #[test]
    fn difference_of_two_values_of_f_loses_backward_rays() {
        let (gamma, t, v) = (3.1f64, 1.0f64, 2.0f64);
        let a1 = t * gamma.sin();
        let (v1, v2) = (0.5 * gamma, PI / 4.0 + 0.5 * ((v - t * gamma.cos()) / a1).atan());
        let difference = f64::from(sun::f(a1, v2) as f32 - sun::f(a1, v1) as f32);
        let want = sun::airlight(gamma, t, v, 1.0);
        let printed = (-t * gamma.cos()).exp() / (2.0 * PI * a1) * difference;
        let air = UniformAir { sigma_s: 1.0f32, sigma_t: 1.0, phase: Phase::Isotropic };
        let ours = Quadrature::new(16).radiance(&Sight::from_angle(gamma as f32, 1.0, 2.0), &Emitter::Isotropic, &air);
        assert!(relative_error(ours.into(), want) < 2e-6, "{ours} {want}");
        assert!(relative_error(printed, want) > 2e-5, "{printed} {want}");
    }

    /// The prefactor e^{−T cos γ} overflows for a lamp behind the eye, F underflows.
    #[test]
    fn prefactor_overflows() {
        let air = UniformAir { sigma_s: 1.0f32, sigma_t: 1.0, phase: Phase::Isotropic };
        let ours = Quadrature::new(16).radiance(&Sight::from_angle(3.0f32, 60.0, 5.0), &Emitter::Isotropic, &air);
        assert!(ours > 0.0 && ours.is_finite());
        assert_eq!((-100.0f32 * 3.0f32.cos()).exp(), f32::INFINITY);
    }

    #[test]
    fn eq29_has_no_digits_left_in_dense_air() {
        let basis = Basis { h: 50.0, m: 7, n: 12 };
        let want = pegoraro::definite(basis, 0.5, 2.0);
        let printed = pegoraro::eq29(basis, 2.0) - pegoraro::eq29(basis, 0.5);
        assert!(relative_error(printed, want) > 1e-3, "{printed} {want}");
    }

    /// Macklin's distance as sqrt(c − b²) in f32.
    #[test]
    fn square_root_of_a_difference_loses_the_lamps_distance() {
        let eye = [1000.0f32, 0.01, 0.0];
        let (b, c) = (-eye[0], eye[0] * eye[0] + eye[1] * eye[1]);
        let printed = (c - b * b).sqrt();
        let sight = Sight::from_points(eye, [-1.0, 0.0, 0.0], 10.0, [0.0; 3], [0.0, 1.0, 0.0]);
        assert_eq!(sight.h, 0.01);
        assert!(printed.is_nan() || (printed / 0.01 - 1.0).abs() > 0.5, "{printed}");
    }
}
