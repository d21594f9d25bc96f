//! Legendre polynomials by recurrence against sums of powers.

use bake_optics::Real;
use bake_optics::legendre::legendre;
use testkit::oracle::DoubleDouble;

use crate::map::{Axis, Map, Pair};

pub fn map() -> Map {
    Map {
        name: "legendre",
        title: "Legendre polynomial P_l(x)",
        text: "Textbook: the sum of powers, as phase functions and lamps are expanded for closed-form air-light: its coefficients alternate and grow as 2.4^l. Ours: \
               Bonnet's recurrence. The error is absolute (|P_l| ≤ 1).",
        x: Axis::linear("x", -1.0, 1.0, 32),
        y: Axis::linear("degree l", 0.0, 48.0, 16),
        single: Pair { textbook: error::<f32, false>, ours: error::<f32, true> },
        double: Pair { textbook: error::<f64, false>, ours: error::<f64, true> },
    }
}

fn error<T: Real, const OURS: bool>(x: f64, degree: f64) -> f64 {
    let (x, l) = (T::of(x), degree as usize);
    let got = if OURS { legendre(l, x) } else { powers(l, x) };
    (got.as_f64() - oracle(l, x.as_f64())).abs()
}

/// `P_l(x) = 2^{−l} Σ_k (−1)^k C(l, k) C(2l − 2k, l) x^{l−2k}` (Abramowitz & Stegun 22.3.8).
fn powers<T: Real>(l: usize, x: T) -> T {
    let binomial = |n: usize, k: usize| (1..=k).fold(1.0, |b, i| b * (n - k + i) as f64 / i as f64);
    let mut sum = T::zero();
    for k in 0..=l / 2 {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let coefficient = sign * binomial(l, k) * binomial(2 * l - 2 * k, l) * 0.5f64.powi(l as i32);
        sum += T::of(coefficient) * x.powi((l - 2 * k) as i32);
    }
    sum
}

fn oracle(l: usize, x: f64) -> f64 {
    let x = DoubleDouble::new(x);
    let (mut below, mut current) = (DoubleDouble::new(0.0), DoubleDouble::new(1.0));
    for j in 0..l {
        let j = j as f64;
        let next = (DoubleDouble::new(2.0 * j + 1.0) * x * current - DoubleDouble::new(j) * below)
            / DoubleDouble::new(j + 1.0);
        (below, current) = (current, next);
    }
    current.to_f64()
}
