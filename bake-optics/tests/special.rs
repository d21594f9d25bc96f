//! Special functions against the reference tables, in both precisions, and against the textbook forms that must fail.

use bake_optics::Real;
use bake_optics::special::{
    Complex, chapman, e1, erfcx, lam, ln_chapman, phi1, scaled_exponential_integral, scaled_exponential_integrals,
};
use testkit::compare::Worst;
use testkit::reference::{Row, read_csv};

fn path(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/{name}.csv"))
}

fn rows(name: &str) -> Vec<Row> {
    read_csv(&path(name))
}

/// |got − want| relative to |want|, complex modulus.
fn modulus_error<T: Real>(got: Complex<T>, want: Complex<f64>) -> f64 {
    (double(got) - want).norm() / want.norm()
}

fn double<T: Real>(z: Complex<T>) -> Complex<f64> {
    Complex::new(z.re.as_f64(), z.im.as_f64())
}

/// `value` is the table's for the table's input. In f32 the input is rounded, so its oracle is the f64 form, which the table has checked.
fn oracle<T: Real, V>(value: V, at_rounded: impl Fn() -> V) -> V {
    T::pick(at_rounded(), value)
}

fn check_e1<T: Real>(name: &str, allowed_right: f64, allowed_left: f64) {
    let mut right = Worst::new(format!("S_1 {name}, Re z >= 0"), allowed_right);
    let mut left = Worst::new(format!("S_1 {name}, Re z < 0"), allowed_left);
    let mut plain = Worst::new(format!("E_1 {name}, |z| < 5, Re z >= 0"), allowed_right * 4.0);
    for row in rows("e1_complex") {
        let z = Complex::new(T::of(row.number("re_z")), T::of(row.number("im_z")));
        let scaled = Complex::new(row.number("expz_E1_re"), row.number("expz_E1_im"));
        let scaled = oracle::<T, _>(scaled, || scaled_exponential_integral(1, double(z)));
        let worst = if z.re >= T::zero() { &mut right } else { &mut left };
        worst.record(modulus_error(scaled_exponential_integral(1, z), scaled), || format!("{z}"));
        if z.norm() < T::of(5.0) && z.re >= T::zero() {
            let unscaled = Complex::new(row.number("E1_re"), row.number("E1_im"));
            let unscaled = oracle::<T, _>(unscaled, || e1(double(z)));
            plain.record(modulus_error(e1(z), unscaled), || format!("{z}"));
        }
    }
    right.check();
    left.check();
    plain.check();
}

#[test]
fn e1_meets_the_reference_in_both_precisions() {
    check_e1::<f64>("f64", 4e-15, 6e-15);
    check_e1::<f32>("f32", 1.6e-6, 3e-6);
}

fn check_ep<T: Real>(name: &str, allowed: f64) {
    let mut single = Worst::new(format!("S_p {name}, one by one"), allowed);
    let mut all = Worst::new(format!("S_p {name}, by recurrence from |z|"), allowed);
    for row in rows("ep_scaled") {
        let p = row.number("p") as usize;
        let z = Complex::new(T::of(row.number("H") * row.number("v")), T::of(row.number("H")));
        let want = Complex::new(row.number("expz_Ep_re"), row.number("expz_Ep_im"));
        let want = oracle::<T, _>(want, || scaled_exponential_integral(p, double(z)));
        single.record(modulus_error(scaled_exponential_integral(p, z), want), || format!("p {p} z {z}"));
        let mut out = [Complex::new(T::zero(), T::zero()); 12];
        scaled_exponential_integrals(z, &mut out);
        all.record(modulus_error(out[p - 1], want), || format!("p {p} z {z}"));
    }
    single.check();
    all.check();
}

#[test]
fn ep_meets_the_reference_in_both_precisions() {
    check_ep::<f64>("f64", 5e-15);
    check_ep::<f32>("f32", 2e-6);
}

#[test]
fn the_forward_recurrence_alone_fails() {
    let mut worst = Worst::new("S_p f64 by forward recurrence (negative control)", 1e-6);
    for row in rows("ep_scaled") {
        let z = Complex::new(row.number("H") * row.number("v"), row.number("H"));
        let mut s = scaled_exponential_integral(1, z);
        for p in 1..row.number("p") as usize {
            s = (-z * s + 1.0) / p as f64;
        }
        worst.record(modulus_error(s, Complex::new(row.number("expz_Ep_re"), row.number("expz_Ep_im"))), String::new);
    }
    assert!(!worst.holds(), "the textbook recurrence must lose its digits at large |z|");
}

#[test]
fn erfcx_meets_the_reference_in_both_precisions() {
    let mut in_double = Worst::new("erfcx f64", 4e-15);
    let mut in_single = Worst::new("erfcx f32", 1.2e-7);
    let mut product = Worst::new("erfcx as a product, f64 (negative control)", 1e-6);
    for row in rows("erfcx") {
        let (x, want) = (row.number("x"), row.number("erfcx"));
        in_double.relative(erfcx(x), want, || format!("{x}"));
        let rounded = x as f32;
        let finite = (erfcx(f64::from(rounded)) as f32).is_normal();
        if finite {
            in_single.relative(f64::from(erfcx(rounded)), erfcx(f64::from(rounded)), || format!("{x}"));
        }
        product.relative((x * x).exp() * errorfunctions::RealErrorFunctions::erfc(x), want, || format!("{x}"));
    }
    in_double.check();
    in_single.check();
    assert!(!product.holds());
}

/// Errors are measured per unit of ln C: that many ulp of the input move C by one.
fn check_chapman<T: Real>(name: &str, allowed: f64) {
    let mut above = Worst::new(format!("Chapman {name}, above the horizon"), allowed);
    let mut below = Worst::new(format!("Chapman {name}, below, per unit of exponent"), allowed);
    let mut logarithm = Worst::new(format!("ln Chapman {name} (absolute, of max(1, ln C))"), allowed);
    for row in rows("chapman") {
        let (z, c) = (T::of(row.number("z")), T::of(row.number("cos_theta")));
        let want = oracle::<T, _>(row.number("C"), || chapman(z.as_f64(), c.as_f64()));
        let want_ln = oracle::<T, _>(row.number("ln_C"), || ln_chapman(z.as_f64(), c.as_f64()));
        let place = || format!("z {z} c {c}");
        let got = chapman(z, c).as_f64();
        let sensitivity = 1.0 + want_ln.max(0.0);
        logarithm.record((ln_chapman(z, c).as_f64() - want_ln).abs() / sensitivity, place);
        if T::of(want).is_infinite() {
            assert!(got.is_infinite(), "{}", place());
        } else if c >= T::zero() {
            above.relative(got, want, place);
        } else {
            below.record((got / want - 1.0).abs() / sensitivity, place);
        }
    }
    above.check();
    below.check();
    logarithm.check();
}

#[test]
fn chapman_meets_the_reference_in_both_precisions() {
    check_chapman::<f64>("f64", 4e-15);
    check_chapman::<f32>("f32", 1e-6);
}

#[test]
fn phi1_and_lam_agree_with_their_series_and_the_textbook_does_not() {
    let mut worst = [Worst::new("phi1 f64", 4e-16), Worst::new("lam f64", 4e-16)];
    let mut textbook = Worst::new("phi1 as (exp(x)-1)/x (negative control)", 1e-8);
    for i in -160..=0 {
        let x = 0.09 * 10f64.powf(f64::from(i) * 0.1);
        for x in [x, -x] {
            // Taylor series, 40 terms of falling size: (e^x − 1)/x = Σ x^k/(k+1)!, ln(1+x)/x = Σ (−x)^k/(k+1).
            let (mut exponential, mut logarithm) = (1.0, 1.0 / 40.0);
            for k in (1..40).rev() {
                exponential = 1.0 + x / (f64::from(k) + 1.0) * exponential;
                logarithm = 1.0 / f64::from(k) - x * logarithm;
            }
            worst[0].relative(phi1(x), exponential, || format!("{x}"));
            worst[1].relative(lam(x), logarithm, || format!("{x}"));
            textbook.relative((x.exp() - 1.0) / x, exponential, || format!("{x}"));
        }
    }
    worst.iter().for_each(Worst::check);
    assert!(!textbook.holds());
}

#[test]
fn phi1_and_lam_keep_their_digits_in_f32() {
    let mut worst = Worst::new("phi1, lam f32 against f64", 3.6e-7);
    for i in -1200..=190 {
        let x = 10f32.powf(i as f32 * 0.01);
        for x in [x, -x] {
            worst.relative(phi1(x).into(), phi1(f64::from(x)), || format!("phi1 {x}"));
            if x > -1.0 {
                worst.relative(lam(x).into(), lam(f64::from(x)), || format!("lam {x}"));
            }
        }
    }
    worst.check();
}

#[test]
fn phi1_and_lam_reach_their_ends() {
    assert_eq!((phi1(0.0f32), lam(0.0f32)), (1.0, 1.0));
    assert_eq!((phi1(f64::INFINITY), phi1(f64::NEG_INFINITY)), (f64::INFINITY, 0.0));
    assert_eq!((lam(-1.0f64), lam(-1.5f64), lam(f64::INFINITY)), (f64::INFINITY, f64::INFINITY, 0.0));
    assert!(phi1(712.0f64).is_finite() && phi1(92.0f32).is_finite());
}
