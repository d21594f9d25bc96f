//! Optical depth through an exponential density and its inverse: what phi1 and lam are for.

use bake_optics::Real;
use bake_optics::special::{lam, phi1};
use testkit::oracle::DoubleDouble;

use crate::map::{Axis, Map, Pair, relative};

pub fn maps() -> Vec<Map> {
    vec![
        Map {
            name: "phi1",
            title: "Optical depth through a density e^{−p s}: u phi1(−p u)",
            text: "Textbook: (1 − e^{−p u})/p, which loses the digits of p u as the ray gets level or short, and is 0/0 for a level one. Ours: `u phi1(−p u)` by \
                   expm1.",
            x: Axis::decades("p (1/m)", -12.0, 0.0, 36),
            y: Axis::decades("u (m)", -2.0, 2.0, 12),
            single: Pair { textbook: depth_error::<f32, false>, ours: depth_error::<f32, true> },
            double: Pair { textbook: depth_error::<f64, false>, ours: depth_error::<f64, true> },
        },
        Map {
            name: "lam",
            title: "Its inverse: the distance to an optical depth, y lam(−p y)",
            text: "Textbook: −ln(1 − p y)/p. Ours: `y lam(−p y)` by log1p.",
            x: Axis::decades("p (1/m)", -12.0, 0.0, 36),
            y: Axis::decades("y (m)", -4.0, -0.5, 12),
            single: Pair { textbook: distance_error::<f32, false>, ours: distance_error::<f32, true> },
            double: Pair { textbook: distance_error::<f64, false>, ours: distance_error::<f64, true> },
        },
    ]
}

fn depth_error<T: Real, const OURS: bool>(p: f64, u: f64) -> f64 {
    let (p, u) = (T::of(p), T::of(u));
    let got = if OURS { u * phi1(-p * u) } else { (T::one() - (-p * u).exp()) / p };
    let x = DoubleDouble::new(p.as_f64()) * DoubleDouble::new(u.as_f64());
    relative(got, (DoubleDouble::new(u.as_f64()) * phi1_oracle(-x)).to_f64())
}

fn distance_error<T: Real, const OURS: bool>(p: f64, y: f64) -> f64 {
    let (p, y) = (T::of(p), T::of(y));
    let got = if OURS { y * lam(-p * y) } else { -(T::one() - p * y).ln() / p };
    let x = DoubleDouble::new(p.as_f64()) * DoubleDouble::new(y.as_f64());
    relative(got, (DoubleDouble::new(y.as_f64()) * lam_oracle(-x)).to_f64())
}

/// `(e^x − 1)/x`: Taylor series after halving the argument, `phi1(x) = phi1(x/2) (2 + (x/2) phi1(x/2))/2`.
fn phi1_oracle(x: DoubleDouble) -> DoubleDouble {
    let halvings = 12;
    let half = DoubleDouble::new(0.5);
    let mut small = x;
    (0..halvings).for_each(|_| small = small * half);
    let one = DoubleDouble::new(1.0);
    let mut value = one;
    for k in (2..24).rev() {
        value = one + small / DoubleDouble::new(f64::from(k)) * value;
    }
    for _ in 0..halvings {
        value = value * (one + half * small * value);
        small = small + small;
    }
    value
}

/// `ln(1 + x)/x = 2/(2 + x) Σ s^{2k}/(2k + 1)`, s = x/(2 + x), for |x| < 1/3.
fn lam_oracle(x: DoubleDouble) -> DoubleDouble {
    let two = DoubleDouble::new(2.0);
    let s = x / (two + x);
    let square = s * s;
    let sum = (0..40).rev().fold(DoubleDouble::new(0.0), |sum, k| {
        DoubleDouble::new(1.0) / DoubleDouble::new(f64::from(2 * k + 1)) + square * sum
    });
    two / (two + x) * sum
}
