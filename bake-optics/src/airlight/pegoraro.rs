//! Antiderivatives of Pegoraro, Schott & Parker 2010: `∫ e^{−H v} v^n/(v² + 1)^m dv`, m ≥ 1, 0 ≤ n ≤ 2m − 2.
//!
//! [`definite`] is what to use. [`eq29`] is the printed closed form (without its third line, which is identically zero for
//! n < 2m), kept because it is a reference and because it fails instructively: in f64 it has no digits left for H > 2 or m ≥ 5.
//! f64 only: in f32 the printed form has errors above 1 for all but isotropic thin air.

use num_complex::Complex;

use crate::airlight::sun::scaled_integral;
use crate::special::scaled_exponential_integral;

/// Which integrand: e^{−H v} v^n/(v² + 1)^m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Basis {
    /// Decay H ≥ 0.
    pub h: f64,
    /// Power of the denominator, 1..=32.
    pub m: i32,
    /// Power of the numerator, 0..=2m − 2.
    pub n: i32,
}

/// The integral from `va` ≥ 0 to `vb` ≤ ∞ by quadrature: 1e-13 everywhere.
pub fn definite(basis: Basis, va: f64, vb: f64) -> f64 {
    let Basis { h, m, n } = basis;
    let power = f64::from(n) * 0.5 - f64::from(m - 1);
    (-h * va).exp()
        * scaled_integral(h, va, vb, |v| {
            let square = 1.0 + v * v;
            // v^n (1 + v²)^{1−m} without overflow of v^n.
            (v / square.sqrt()).powi(n) * square.powf(power)
        })
}

/// Eqs. 29 and 30 at `v`, a = −H, with Ei of the third quadrant as printed: an antiderivative up to a constant.
///
/// "mod" is Euclid's (the exponents go below zero).
pub fn eq29(basis: Basis, v: f64) -> f64 {
    let Basis { h, m, n } = basis;
    let a = -h;
    let z = Complex::new(h * v, h);
    // Ei(−z) = −E_1(z) − iπ for Im z > 0.
    let ei = -((-z).exp() * scaled_exponential_integral(1, z)) - Complex::new(0.0, std::f64::consts::PI);
    let rotated = Complex::from_polar(1.0, h) * ei;
    let power_of_i = |j: i32| {
        [1.0, 0.0, -1.0, 0.0][j.rem_euclid(4) as usize] * rotated.re
            - [0.0, 1.0, 0.0, -1.0][j.rem_euclid(4) as usize] * rotated.im
    };
    let mut sum = 0.0;
    for l in 0..m {
        let mut inner = 0.0;
        for k in 0..=(m - 1 - l).min(n) {
            let q = m - 1 - l - k;
            let logarithmic = a.powi(q) / factorial(q) * power_of_i(m - n - l + k);
            let rational: f64 =
                (1..=q).map(|j| a.powi(q - j) * factorial(j - 1) / factorial(q) * rational(m - n - l + k, j, v)).sum();
            inner += binomial(n, k) * (logarithmic - (a * v).exp() * rational);
        }
        sum += 0.5f64.powi(l) * binomial(m - 1 + l, m - 1) * inner;
    }
    sum * 2f64.powi(1 - m)
}

/// `(v² + 1)^{−j} Σ_i (−1)^{(e+i)/2} C(j, i) v^i` over i ≡ e (mod 2), e = `order` − j.
fn rational(order: i32, j: i32, v: f64) -> f64 {
    let e = order - j;
    let terms = (e.rem_euclid(2)..=j).step_by(2);
    let sign = |i: i32| if ((e + i) / 2).rem_euclid(2) == 0 { 1.0 } else { -1.0 };
    terms.map(|i| sign(i) * binomial(j, i) * v.powi(i)).sum::<f64>() / (v * v + 1.0).powi(j)
}

fn factorial(n: i32) -> f64 {
    (1..=n).map(f64::from).product()
}

fn binomial(n: i32, k: i32) -> f64 {
    (1..=k).map(|i| f64::from(n - k + i) / f64::from(i)).product()
}
