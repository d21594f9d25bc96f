//! Phase functions and lamps over their whole domains through the public functions: normalised, positive, never NaN, the limits met,
//! f32 within a few ulp of f64.

use bake_optics::Real;
use bake_optics::emitter::Emitter;
use bake_optics::phase::{Deflection, Phase, PhaseError, henyey_greenstein, henyey_greenstein_deflected};
use bake_optics::quadrature::GaussLegendre;
use proptest::prelude::*;
use testkit::compare::Worst;

const PI: f64 = std::f64::consts::PI;

/// `2π ∫ f(θ) sin θ dθ` in the variable ln tan(θ/2), where any lobe is smooth: sin θ dθ = 4v²/(1+v²)² dln v.
fn over_sphere(f: impl Fn(Deflection<f64>) -> f64) -> f64 {
    let h = 1.0 / 16.0;
    let sum: f64 = (-700..=700)
        .map(|i| (f64::from(i) * h).exp())
        .map(|v| f(Deflection::from_half_tangent(v)) * 4.0 * (v / (1.0 + v * v)).powi(2))
        .sum();
    2.0 * PI * h * sum
}

#[test]
fn henyey_greenstein_is_normalised_with_mean_g_up_to_the_delta() {
    let mut worst = Worst::new("HG norm and mean cosine (absolute)", 2e-14);
    for exponent in 0..=36 {
        let gap = 10f64.powf(-f64::from(exponent) / 4.0);
        for g in [1.0 - gap, gap - 1.0] {
            worst.record((over_sphere(|d| henyey_greenstein_deflected(g, d)) - 1.0).abs(), || format!("norm, g {g}"));
            // 1 − g itself: the mean of 1 ∓ μ, which a mean near 1 would hide.
            let gap = 1.0 - g.abs();
            let from_peak = |d: Deflection<f64>| if g > 0.0 { d.one_minus_cos } else { d.one_plus_cos };
            let spread = over_sphere(|d| henyey_greenstein_deflected(g, d) * from_peak(d));
            worst.record((spread / gap - 1.0).abs(), || format!("mean, g {g}"));
        }
    }
    worst.check();
}

#[test]
fn an_unnormalised_lobe_is_caught() {
    let book = |d: Deflection<f64>| (1.0 - 0.81) / (1.81 - 1.8 * d.cos_theta).powf(1.5);
    assert!((over_sphere(book) - 1.0).abs() > 0.1, "without 1/(4 pi) the norm must be missed");
}

/// Phase functions with parameters from two uniform numbers.
fn any_phase<T: Real>() -> impl Strategy<Value = Phase<T>> {
    (0usize..5, -1.0f64..=1.0, -12.0f64..-0.01).prop_map(|(kind, x, exponent)| match kind {
        0 => Phase::Isotropic,
        1 => Phase::Linear { a1: T::of(x) },
        2 => Phase::Rayleigh,
        3 => Phase::HenyeyGreenstein { g: T::of(x * 0.999) },
        _ => Phase::HenyeyGreenstein { g: T::of((1.0 - 10f64.powf(exponent.max(-6.0))).copysign(x)) },
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn draws_are_finite_ascending_and_agree_with_their_density(phase in any_phase::<f32>(), u in 0.0f32..0.999, step in 1e-4f32..1e-3) {
        prop_assert!(phase.check().is_ok());
        let (near, far) = (phase.sample(u), phase.sample(u + step));
        prop_assert!(near.pdf > 0.0 && near.pdf.is_finite() && near.weight == 1.0, "{phase:?} {near:?}");
        prop_assert!((0.0..=2.0).contains(&near.deflection.one_minus_cos));
        let slack = 1e-5 * far.deflection.one_minus_cos.max(1e-6);
        prop_assert!(near.deflection.one_minus_cos <= far.deflection.one_minus_cos + slack, "{phase:?} u {u}");
        prop_assert!(phase.eval(near.deflection.cos_theta) >= 0.0);
    }

    #[test]
    fn the_share_below_a_draw_is_the_number_it_was_drawn_with(g in -0.99f64..0.99, a1 in -1.0f64..1.0, u in 0.001f64..0.999) {
        let rule = GaussLegendre::<f64>::cached(200);
        for phase in [Phase::HenyeyGreenstein { g }, Phase::Linear { a1 }, Phase::Rayleigh] {
            let angle = phase.sample(u).deflection.angle();
            let density = |a: f64| phase.eval_deflected(Deflection::from_angle(a)) * a.sin();
            let below = 2.0 * PI * rule.integrate(0.0, angle, density);
            prop_assert!((below - u).abs() < 1e-9, "{phase:?}: {below} for {u}");
        }
    }

    #[test]
    fn lamps_are_never_nan_and_stay_within_their_axis_value(inner in 0.0f64..1.0, outer in 0.0f64..1.0, n in 0.0f64..200.0, c in -1.0f64..=1.0) {
        let (inner, outer) = ((inner.min(outer) * PI).cos(), (inner.max(outer) * PI).cos());
        for lamp in [Emitter::SpotCone { cos_inner: inner, cos_outer: outer }, Emitter::CosinePower { exponent: n }] {
            prop_assert!(lamp.check().is_ok());
            let value = lamp.eval(c);
            prop_assert!((0.0..=1.0).contains(&value), "{lamp:?} at {c}: {value}");
            prop_assert!(lamp.legendre(16).iter().all(|c| c.is_finite()));
            prop_assert!(lamp.flux() >= -1e-12 && lamp.flux() <= 4.0 * PI * (1.0 + 1e-12));
        }
    }
}

#[test]
fn single_precision_phase_functions_stay_within_a_few_ulp() {
    let mut worst = Worst::new("phase functions f32 against f64 from the same half tangent", 1e-6);
    for i in 0..200 {
        let v = 10f32.powf(i as f32 * 0.05 - 6.0);
        let (single, double) = (Deflection::from_half_tangent(v), Deflection::from_half_tangent(f64::from(v)));
        for (a, b) in [
            (Phase::Isotropic, Phase::Isotropic),
            (Phase::Linear { a1: 0.75 }, Phase::Linear { a1: 0.75 }),
            (Phase::Rayleigh, Phase::Rayleigh),
            (Phase::HenyeyGreenstein { g: 0.875 }, Phase::HenyeyGreenstein { g: 0.875 }),
            (Phase::Legendre(vec![1.0, 0.5, 0.25]), Phase::Legendre(vec![1.0, 0.5, 0.25])),
        ] {
            worst.relative(f64::from(a.eval_deflected(single)), b.eval_deflected(double), || format!("{b:?} v {v}"));
        }
    }
    worst.check();
}

#[test]
fn limits_are_met() {
    let isotropic = 0.25 / PI;
    assert_eq!(henyey_greenstein(0.0, 0.3), isotropic);
    assert_eq!(henyey_greenstein(1.0, 0.3), 0.0);
    assert_eq!(henyey_greenstein(1.0, 1.0), f64::INFINITY);
    assert_eq!(henyey_greenstein(-1.0f32, -1.0), f32::INFINITY);
    // The peak: (1 + g)/(4π (1 − g)²).
    let g = 1.0 - 1e-9;
    assert!((henyey_greenstein(g, 1.0) / ((1.0 + g) * isotropic / (1.0 - g).powi(2)) - 1.0).abs() < 1e-15);
    for phase in [Phase::Linear { a1: -1.0 }, Phase::Linear { a1: 1.0 }, Phase::HenyeyGreenstein { g: 0.0f64 }] {
        assert_eq!(phase.sample(0.0).deflection.one_minus_cos, 0.0, "{phase:?}");
        assert!((phase.sample(1.0).deflection.one_minus_cos - 2.0).abs() < 1e-15, "{phase:?}");
    }
}

#[test]
fn parameters_outside_their_domain_are_refused_by_name() {
    let refused = |phase: Phase<f64>| phase.check().expect_err("must be refused").to_string();
    assert!(refused(Phase::HenyeyGreenstein { g: 1.0 }).contains("g is 1"));
    assert!(refused(Phase::HenyeyGreenstein { g: f64::NAN }).contains("NaN"));
    assert!(refused(Phase::Linear { a1: 1.5 }).contains("a1 is 1.5"));
    assert!(refused(Phase::Legendre(vec![])).contains("a_0"));
    assert!(refused(Phase::Legendre(vec![1.0, 3.5])).contains("a_1 is 3.5"));
    assert!(matches!(Phase::Legendre(vec![2.0f32]).check(), Err(PhaseError::Term { index: 0, .. })));
    assert!(Phase::Legendre(vec![1.0, 2.9]).check().is_ok());
    assert!(Emitter::SpotCone { cos_inner: 0.5, cos_outer: 0.6 }.check().is_err());
    assert!(Emitter::CosinePower { exponent: -1.0 }.check().is_err());
    assert!(Emitter::Legendre(vec![1.0, f32::NAN]).check().is_err());
}

#[test]
fn a_deflection_keeps_both_ends_however_it_is_given() {
    let mut ours = Worst::new("1 - cos, 1 + cos and the angle in f32", 1e-6);
    let mut book = Worst::new("angle by acos(cos) in f32 (negative control)", 1e-2);
    for i in 0..=120 {
        let near = 10f32.powf(i as f32 * 0.05 - 6.0);
        for angle in [near, std::f32::consts::PI - near] {
            let exact = f64::from(angle);
            let (minus, plus) = (2.0 * (exact / 2.0).sin().powi(2), 2.0 * (exact / 2.0).cos().powi(2));
            let (sin, cos) = angle.sin_cos();
            // Between two vectors the small gap is a difference of coordinates: that of a forward pair is exact in this frame.
            let pair = Deflection::between([0.0, 0.0, 1.0], [sin, 0.0, cos]);
            for d in [Deflection::from_angle(angle), Deflection::from_half_tangent((exact / 2.0).tan() as f32)] {
                let place = || format!("{angle} {d:?}");
                ours.relative(d.one_minus_cos.into(), minus, place);
                ours.relative(d.angle().into(), exact, place);
                if exact < 3.1 {
                    ours.relative(d.one_plus_cos.into(), plus, place);
                }
                book.relative(d.cos_theta.acos().into(), exact, place);
            }
            if exact < 1.5 {
                ours.relative(pair.one_minus_cos.into(), minus, || format!("pair at {angle}"));
            }
        }
    }
    ours.check();
    assert!(!book.holds());
}
