//! Special functions swept densely over their domains, against independent integrals, in both precisions; each sweep with a textbook form
//! that must fail it.

use bake_optics::special::{
    Complex, chapman, chapman_horizontal, chapman_large_z, chapman_parts, erfcx, lam, ln_chapman, phi1,
    scaled_exponential_integral, scaled_exponential_integrals,
};
use proptest::prelude::*;
use testkit::compare::Worst;
use testkit::oracle::{half_line, logarithmic_line};

/// 1 in the normal run, more with `BAKE_LONG=1`.
fn density() -> usize {
    if std::env::var("BAKE_LONG").as_deref() == Ok("1") { 4 } else { 1 }
}

/// `count + 1` values from `from` to `to`, equal steps.
fn steps(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..=count).map(move |i| from + (to - from) * i as f64 / count as f64)
}

/// `S_p(z) = z^{p−1} ∫_0^∞ e^{−w}/(z + w)^p dw`: the defining integral turned onto the ray where nothing oscillates.
fn exponential_integral_oracle(p: i32, z: Complex<f64>) -> Complex<f64> {
    let integrand = |w: f64| (z / (z + w)).powi(p) / z * (-w).exp();
    let line = |f: &dyn Fn(f64) -> f64| logarithmic_line(z.norm().min(1.0).ln() - 42.0, 4.5, 12, f);
    Complex::new(line(&|w| integrand(w).re), line(&|w| integrand(w).im))
}

/// `Im S_1(x − iy) = y ∫ e^{−w}/((x + w)² + y²) dw`, a sum of terms of one sign.
fn imaginary_part_oracle(x: f64, y: f64) -> f64 {
    y * half_line(1.0, 16, |w| (-w).exp() / ((x + w).powi(2) + y * y))
}

/// The right half plane, from 1e-6 to 1e6 in |z|.
fn right_half_plane() -> impl Iterator<Item = Complex<f64>> {
    let fine = density();
    steps(-6.0, 6.0, 60 * fine).flat_map(move |exponent| {
        steps(0.0, 1.0, 16 * fine).map(move |share| {
            let (sin, cos) = (share * std::f64::consts::FRAC_PI_2).sin_cos();
            Complex::new(if share == 1.0 { 0.0 } else { cos }, sin) * 10f64.powf(exponent)
        })
    })
}

#[test]
fn scaled_exponential_integrals_hold_over_the_right_half_plane() {
    let mut double = Worst::new("S_1 f64 against the turned integral", 8e-15);
    let mut single = Worst::new("S_1 f32 against f64", 1.6e-6);
    let mut book = Worst::new("e^z times E_1 by series (negative control)", 1e-6);
    for z in right_half_plane() {
        let want = exponential_integral_oracle(1, z);
        let got = scaled_exponential_integral(1, z);
        double.record((got - want).norm() / want.norm(), || format!("{z}"));
        let z32 = Complex::new(z.re as f32, z.im as f32);
        let got32 = scaled_exponential_integral(1, z32);
        let want32 = scaled_exponential_integral(1, Complex::new(f64::from(z32.re), f64::from(z32.im)));
        let wide = Complex::new(f64::from(got32.re), f64::from(got32.im));
        single.record((wide - want32).norm() / want32.norm(), || format!("{z32}"));
        if z.norm() < 100.0 {
            book.record((textbook_s1(z) - want).norm() / want.norm(), || format!("{z}"));
        }
    }
    double.check();
    single.check();
    assert!(!book.holds());
}

/// The series at every z, multiplied by e^z afterwards.
fn textbook_s1(z: Complex<f64>) -> Complex<f64> {
    let (mut sum, mut term) = (-z.ln() - 0.577_215_664_901_532_9, Complex::new(1.0, 0.0));
    for k in 1..400 {
        term *= -z / f64::from(k);
        sum -= term / f64::from(k);
    }
    z.exp() * sum
}

#[test]
fn higher_orders_hold_over_the_right_half_plane() {
    let mut together = Worst::new("S_1..S_12 f64 by recurrence from p = |z|", 2e-14);
    let mut alone = Worst::new("S_p f64 one by one", 2e-14);
    for z in right_half_plane().step_by(7) {
        let mut all = [Complex::new(0.0, 0.0); 12];
        scaled_exponential_integrals(z, &mut all);
        for p in [1, 2, 3, 5, 8, 12] {
            let want = exponential_integral_oracle(p, z);
            let place = || format!("p {p} z {z}");
            together.record((all[p as usize - 1] - want).norm() / want.norm(), place);
            alone.record((scaled_exponential_integral(p as usize, z) - want).norm() / want.norm(), place);
        }
    }
    together.check();
    alone.check();
}

#[test]
fn the_imaginary_part_keeps_its_own_digits_where_it_is_tiny() {
    let mut ours = Worst::new("Im S_1(x - i y), y << x, f64", 4e-15);
    let mut book = Worst::new("the same by the series (negative control)", 1e-3);
    for x in steps(0.4, 5.0, 100 * density()).map(|e| 10f64.powf(e)) {
        for y in [1e-12, 1e-6, 1e-2].map(|share| share * x) {
            let z = Complex::new(x, -y);
            ours.relative(scaled_exponential_integral(1, z).im, imaginary_part_oracle(x, y), || format!("{z}"));
            book.relative(textbook_s1(z).im, imaginary_part_oracle(x, y), || format!("{z}"));
        }
    }
    assert!(!book.holds());
    ours.check();
}

#[test]
fn erfcx_agrees_with_its_integral() {
    let mut worst = Worst::new("erfcx f64 against (2/sqrt pi) int e^{-t^2-2xt}", 4e-15);
    for x in steps(-4.0, 8.0, 240 * density()).map(|e| 10f64.powf(e)) {
        let scale = 1.0f64.min(0.5 / x);
        let want = half_line(scale, 16, |t| (-t * (t + 2.0 * x)).exp()) * 2.0 / std::f64::consts::PI.sqrt();
        worst.relative(erfcx(x), want, || format!("{x}"));
    }
    worst.check();
}

/// The defining path integral with the exponent free of cancellation, formulas' direct form; 0 ≤ c ≤ 1.
fn chapman_oracle(z: f64, c: f64) -> f64 {
    let exponent = |t: f64| {
        let gain = t * (2.0 * z * c + t);
        gain / (z + (z * z + gain).sqrt())
    };
    // Length over which the exponent reaches 1.
    let scale = (1.0 + 2.0 * z) / (z * c + ((z * c).powi(2) + 1.0 + 2.0 * z).sqrt());
    half_line(scale, 32, |t| (-exponent(t)).exp())
}

fn zeniths() -> impl Iterator<Item = f64> + Clone {
    let near_horizon = steps(-8.0, -1.0, 14 * density()).map(|e| 10f64.powf(e));
    let near_zenith = steps(-8.0, -1.0, 14 * density()).map(|e| 1.0 - 10f64.powf(e));
    [0.0, 1.0].into_iter().chain(near_horizon).chain(steps(0.15, 0.85, 14 * density())).chain(near_zenith)
}

#[test]
fn chapman_holds_from_tiny_to_huge_planets() {
    let mut double = Worst::new("Chapman f64 above the horizon", 8e-15);
    let mut single = Worst::new("Chapman f32 above the horizon", 1e-6);
    let mut book = Worst::new("two-term expansion below z = 100 (negative control)", 1e-4);
    let mut planets = Worst::new("two-term expansion f64, error times z^2, z >= 30", 0.4);
    let mut shader = Worst::new("two-term expansion f32, z >= 100", 3.5e-5);
    for z in steps(-6.0, 8.0, 84 * density()).map(|e| 10f64.powf(e)) {
        for c in zeniths() {
            let want = chapman_oracle(z, c);
            let place = || format!("z {z} c {c}");
            double.relative(chapman(z, c), want, place);
            let (z32, c32) = (z as f32, c as f32);
            single.relative(chapman(z32, c32).into(), chapman(f64::from(z32), f64::from(c32)), place);
            let large = chapman_large_z(z, c);
            if (1.0..100.0).contains(&z) {
                book.relative(large, want, place);
            }
            if (30.0..1e5).contains(&z) {
                planets.record((large / want - 1.0).abs() * z * z, place);
            }
            if z >= 100.0 {
                shader.relative(chapman_large_z(z32, c32).into(), chapman(f64::from(z32), f64::from(c32)), place);
            }
        }
    }
    double.check();
    single.check();
    planets.check();
    shader.check();
    assert!(!book.holds());
}

#[test]
fn chapman_below_the_horizon_is_the_direct_integral_and_joins_it_at_the_horizon() {
    let mut worst = Worst::new("Chapman f64 below the horizon, per unit of exponent", 4e-15);
    let mut book = Worst::new("the same with e^z K_1(z) as a product (negative control)", 1e-6);
    for z in [0.5f64, 3.0, 30.0, 300.0, 900.0] {
        for c in steps(0.01, 0.999, 40 * density()) {
            let sin = ((1.0 - c) * (1.0 + c)).sqrt();
            let depth = z * c * c / (1.0 + sin);
            // Path from the start down to the foot and up to infinity: mirrored about the foot, with e^{depth} taken out.
            let below = |t: f64| {
                let gain = t * t - 2.0 * z * c * t;
                (-(gain / (z + (z * z + gain).sqrt()) + depth)).exp()
            };
            let rule = bake_optics::quadrature::GaussLegendre::<f64>::cached(64);
            let pieces = 64;
            let start = (0..pieces).map(|i| f64::from(i) * z * c / f64::from(pieces)).collect::<Vec<_>>();
            let down: f64 = start.iter().map(|&s| rule.integrate(s, s + z * c / f64::from(pieces), below)).sum();
            let want = down + chapman_horizontal(z * sin);
            let (exponent, factor) = chapman_parts(z, -c);
            let place = || format!("z {z} c {}", -c);
            worst.record(((exponent - depth).abs() + (factor / want - 1.0).abs()) / (1.0 + depth), place);
            let naive = 2.0 * z * sin * z.exp() * spec_math::cephes64::k1(z * sin) - chapman(z, c);
            book.relative(naive.ln(), ln_chapman(z, -c), place);
        }
    }
    worst.check();
    assert!(!book.holds());
    for z in [1e-3f64, 1.0, 800.0, 1e7] {
        let jump = chapman(z, -1e-18) / chapman(z, 0.0) - 1.0;
        assert!(jump.abs() < 1e-14, "the horizon must not show: {jump:.1e} at z {z}");
    }
}

#[test]
fn chapman_falls_from_nadir_to_zenith_and_lies_below_the_secant() {
    for z in steps(-3.0, 6.0, 30 * density()).map(|e| 10f64.powf(e)) {
        let mut previous = f64::INFINITY;
        for c in steps(-0.999, 1.0, 400) {
            let value = ln_chapman(z, c);
            assert!(value <= previous + 1e-14 * (1.0 + value.abs()), "z {z} c {c}: {value} after {previous}");
            assert!(c <= 0.0 || value <= -c.ln() + 1e-14, "z {z} c {c}: above the secant");
            previous = value;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_nan_and_signs_hold(exponent in -300.0f64..300.0, angle in 0.0f64..1.0, c in -1.0f64..=1.0, p in 1usize..12) {
        let modulus = 10f64.powf(exponent);
        let (sin, cos) = (angle * std::f64::consts::FRAC_PI_2).sin_cos();
        let s = scaled_exponential_integral(p, Complex::new(modulus * cos, modulus * sin));
        prop_assert!(s.re >= 0.0 && s.im <= 0.0 && s.re.is_finite(), "S_{p}: {s}");
        let rounded = Complex::new((modulus * cos) as f32, (modulus * sin) as f32);
        let s = scaled_exponential_integral(p, rounded);
        prop_assert!(!rounded.is_finite() || !s.is_nan(), "S_{p}({rounded}): {s}");
        prop_assert!(ln_chapman(modulus, c).is_finite(), "ln C({modulus}, {c})");
        prop_assert!(chapman(modulus, c) >= 0.0);
        let (z32, c32) = (modulus as f32, c as f32);
        prop_assert!(z32.is_infinite() || !chapman(z32, c32).is_nan(), "C({z32}, {c32})");
        prop_assert!(erfcx(modulus) >= 0.0 && erfcx(-modulus) >= 1.0);
    }

    #[test]
    fn lam_inverts_phi1(y in -20.0f64..4.0, exponent in -15.0f64..2.4, up in any::<bool>()) {
        // y = u phi1(p u) is solved by u = y lam(p y); for p < 0 as long as p y > −1.
        let u = 10f64.powf(y);
        let p = if up { 10f64.powf(exponent) } else { -10f64.powf(exponent).min(8.0) } / u;
        let forward = u * phi1(p * u);
        let back = forward * lam(p * forward);
        // Conditioning: du/dy · y/u = phi1(pu) e^{−pu} grows only for p u < 0.
        let sensitivity = 1.0 + phi1(p * u) * (-p * u).exp();
        prop_assert!((back / u - 1.0).abs() < 1e-15 * sensitivity * (4.0 + (p * u).abs()), "{back} for {u}, p {p}");
    }
}
