//! Laws of the phase functions: normalisation, moments, sampling against the density, scaling.

use super::*;
use crate::quadrature::GaussLegendre;
use testkit::compare::Worst;

const PI: f64 = std::f64::consts::PI;

fn mie_like() -> Phase<f64> {
    let angles: Vec<f64> = (0..=180).map(|d| f64::from(d).to_radians()).collect();
    let values = angles.iter().map(|a| (-a * 4.0).exp() * 50.0 + 0.3 + 0.2 * (a * 3.0).cos()).collect();
    Phase::from_table(angles, values).expect("a valid table")
}

fn all() -> Vec<(&'static str, Phase<f64>)> {
    vec![
        ("isotropic", Phase::Isotropic),
        ("linear", Phase::Linear { a1: -0.7 }),
        ("linear at its end", Phase::Linear { a1: 1.0 }),
        ("rayleigh", Phase::Rayleigh),
        ("hg 0.5", Phase::HenyeyGreenstein { g: 0.5 }),
        ("hg -0.8", Phase::HenyeyGreenstein { g: -0.8 }),
        ("hg 0", Phase::HenyeyGreenstein { g: 0.0 }),
        ("legendre", Phase::Legendre(vec![1.0, 0.9, 0.4, 0.1])),
        ("table", mie_like()),
    ]
}

/// `2π ∫ f dμ`, degree by degree so that table kinks do no harm.
fn over_sphere(f: impl Fn(f64) -> f64) -> f64 {
    let rule = GaussLegendre::<f64>::cached(16);
    let degree = PI / 180.0;
    (0..180).map(|d| rule.integrate(f64::from(d) * degree, f64::from(d + 1) * degree, |a| f(a) * a.sin())).sum::<f64>()
        * 2.0
        * PI
}

#[test]
fn moments_agree_with_quadrature() {
    let mut worst = Worst::new("phase moments (absolute)", 1e-13);
    for (name, phase) in all() {
        let mut together = [0.0; 12];
        phase.moments(&mut together);
        for (l, &moment) in together.iter().enumerate() {
            let want =
                over_sphere(|a| phase.eval_deflected(Deflection::from_angle(a)) * legendre::legendre(l, a.cos()));
            worst.record((want - moment).abs(), || format!("{name} l {l}"));
            worst.record((phase.moment(l) - moment).abs(), || format!("{name} l {l}, one alone"));
        }
    }
    worst.check();
}

#[test]
fn a_legendre_reduction_keeps_the_moments() {
    let mut worst = Worst::new("moments after reduction (absolute)", 1e-15);
    for (name, phase) in all() {
        let reduced = phase.to_legendre(6);
        (0..6).for_each(|l| worst.record((reduced.moment(l) - phase.moment(l)).abs(), || format!("{name} l {l}")));
    }
    worst.check();
}

/// Chi-square of samples binned over equal angles against the density integrated over each bin; bins that expect fewer than 5 are left out.
fn chi_square(samples: impl Fn(f64) -> f64, density: impl Fn(f64) -> f64) -> f64 {
    const BINS: usize = 40;
    const COUNT: u64 = 40_000;
    let mut counts = [0.0; BINS];
    for i in 0..COUNT {
        let u = uniform(i);
        let bin = (samples(u) / PI * BINS as f64) as usize;
        counts[bin.min(BINS - 1)] += 1.0;
    }
    let rule = GaussLegendre::<f64>::cached(64);
    let width = PI / BINS as f64;
    (0..BINS)
        .map(|b| {
            let from = b as f64 * width;
            let share = 2.0 * PI * rule.integrate(from, from + width, |a| density(a) * a.sin());
            let expected = share * COUNT as f64;
            if expected < 5.0 { 0.0 } else { (counts[b] - expected).powi(2) / expected }
        })
        .sum()
}

/// SplitMix64, to a number in [0, 1).
fn uniform(index: u64) -> f64 {
    let mut x = index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// 99.99 % of chi-square with 39 degrees of freedom (Abramowitz & Stegun 26.4.17): at nine phase functions one false alarm in a thousand builds of
/// other seeds; this seed is fixed.
const CHI_SQUARE_LIMIT: f64 = 81.5;

#[test]
fn samples_follow_their_density() {
    for (name, phase) in all() {
        let chi = chi_square(|u| phase.sample(u).deflection.angle(), |a| phase.pdf(Deflection::from_angle(a)));
        println!("{name}: chi-square {chi:.1}, limit {CHI_SQUARE_LIMIT}");
        assert!(chi < CHI_SQUARE_LIMIT, "{name}: {chi}");
    }
}

#[test]
fn samples_of_a_slightly_other_lobe_are_caught() {
    let (drawn, claimed) = (Phase::HenyeyGreenstein { g: 0.5 }, Phase::HenyeyGreenstein { g: 0.52 });
    let chi = chi_square(|u| drawn.sample(u).deflection.angle(), |a| claimed.pdf(Deflection::from_angle(a)));
    assert!(chi > CHI_SQUARE_LIMIT, "{chi}");
}

#[test]
fn weighted_samples_give_the_moments() {
    let mut worst = Worst::new("sampled moments (in standard errors)", 4.5);
    for (name, phase) in all() {
        for l in 0..5 {
            let values: Vec<f64> = (0..20_000)
                .map(|i| phase.sample(uniform(i)))
                .map(|s| s.weight * legendre::legendre(l, s.deflection.cos_theta))
                .collect();
            let (mean, error) = testkit::statistics::mean_and_error(&values);
            worst.record((mean - phase.moment(l)).abs() / error.max(1e-12), || format!("{name} l {l}"));
        }
    }
    worst.check();
}

#[test]
fn similarity_keeps_the_first_moment_and_delta_scaling_the_first_two() {
    let mut worst = Worst::new("scaled moments: sigma_s (1 - m_l) kept (absolute)", 1e-15);
    for (name, phase) in all() {
        // What a medium scatters out of band l is sigma_s (1 − m_l).
        let lost = |p: &Phase<f64>, factor: f64, l| factor * (1.0 - p.moment(l));
        let similar = phase.similarity();
        worst.record((lost(&similar.phase, similar.scatter_factor, 1) - lost(&phase, 1.0, 1)).abs(), || name.into());
        let delta = phase.delta_henyey_greenstein();
        worst.record((lost(&delta.phase, delta.scatter_factor, 1) - lost(&phase, 1.0, 1)).abs(), || name.into());
        let cut = phase.delta_m(4);
        for l in 1..4 {
            worst.record((lost(&cut.phase, cut.scatter_factor, l) - lost(&phase, 1.0, l)).abs(), || {
                format!("{name} {l}")
            });
        }
    }
    worst.check();
    let delta = Phase::HenyeyGreenstein { g: 0.8f64 }.delta_henyey_greenstein();
    assert!((delta.scatter_factor - 0.36).abs() < 1e-15);
    assert!(matches!(delta.phase, Phase::HenyeyGreenstein { g } if (g - 0.8 / 1.8).abs() < 1e-15));
    let (sigma_s, sigma_t) = delta.coefficients(2.0, 2.5);
    assert!((sigma_s - 0.72).abs() < 1e-15 && (sigma_t - 1.22).abs() < 1e-15);
}

/// The textbook forms in the same precision.
mod textbook {
    use crate::Real;

    pub fn henyey_greenstein<T: Real>(g: T, mu: T) -> T {
        let one = T::one();
        let square = one + g * g - T::of(2.0) * g * mu;
        (one - g * g) / (T::of(4.0) * T::PI() * square * square.sqrt())
    }

    pub fn sample_henyey_greenstein<T: Real>(g: T, u: T) -> T {
        let (one, two) = (T::one(), T::of(2.0));
        let ratio = (one - g * g) / (one - g + two * g * u);
        (one + g * g - ratio * ratio) / (two * g)
    }
}

#[test]
fn a_peaked_lobe_keeps_its_digits_in_f32_and_the_textbook_does_not() {
    let mut ours = Worst::new("HG f32, |g| to 1 - 1e-5", 1.5e-6);
    let mut book = Worst::new("textbook HG f32 (negative control)", 1e-2);
    for i in 0..50 {
        let g = 1.0 - 10f32.powf(-0.1 * i as f32);
        for j in 0..80 {
            let v = 10f32.powf(-6.0 + 0.1 * j as f32);
            for sign in [1.0f32, -1.0] {
                let (g, v) = (g * sign, if sign > 0.0 { v } else { 1.0 / v });
                // Oracle: f64 from the same half-angle tangent.
                let want = henyey_greenstein_deflected(f64::from(g), Deflection::from_half_tangent(f64::from(v)));
                let deflection = Deflection::from_half_tangent(v);
                ours.relative(henyey_greenstein_deflected(g, deflection).into(), want, || format!("g {g} v {v}"));
                book.relative(textbook::henyey_greenstein(g, deflection.cos_theta).into(), want, || {
                    format!("g {g} v {v}")
                });
            }
        }
    }
    ours.check();
    assert!(!book.holds());
}

#[test]
fn drawn_lobes_are_exact_to_the_last_digits_for_every_g_and_the_textbook_is_not() {
    let mut ours = Worst::new("HG sample f32: 1 - cos", 1.5e-6);
    let mut book = Worst::new("textbook HG sample f32 (negative control)", 1e-2);
    for g in [0.0f32, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99, 0.999, 0.99999] {
        for i in 0..100 {
            let u = (i as f32 + 0.5) / 100.0;
            let want = sample_henyey_greenstein(f64::from(g), f64::from(u)).one_minus_cos;
            ours.relative(sample_henyey_greenstein(g, u).one_minus_cos.into(), want, || format!("g {g} u {u}"));
            book.relative(f64::from(1.0 - textbook::sample_henyey_greenstein(g, 1.0 - u)), want, || {
                format!("g {g} u {u}")
            });
        }
    }
    ours.check();
    assert!(!book.holds());
}

#[test]
fn a_tabulated_phase_function_must_cover_every_angle() {
    assert!(matches!(Phase::from_table(vec![0.0, 1.0], vec![1.0, 1.0]), Err(AxialTableError::Range { .. })));
}
