//! The Chapman function above and below the horizon.

use bake_optics::Real;
use bake_optics::quadrature::GaussLegendre;
use bake_optics::special::{chapman_large_z, ln_chapman};
use testkit::oracle::half_line;

use crate::map::{Axis, Map, Pair};

pub fn map() -> Map {
    Map {
        name: "chapman",
        title: "Chapman function C(z, cos θ)",
        text: "Slant over vertical optical depth of an exponential atmosphere; z = radius over scale height. Textbook: the two-term expansion with its three-term \
               horizon value and e^{z − z sin θ} as a factor (Golubev, eqs. 46 to 48), error about 0.3/z². Ours: the incomplete Bessel integral, logarithm kept \
               apart. The error is that of ln C per unit of the exponent z − z sin θ (at least 1): the digits that a rounded cosine leaves below the horizon.",
        x: Axis::decades("z", -2.0, 6.0, 32),
        y: Axis::linear("cos θ", -0.3, 1.0, 13),
        single: Pair { textbook: error::<f32, false>, ours: error::<f32, true> },
        double: Pair { textbook: error::<f64, false>, ours: error::<f64, true> },
    }
}

fn error<T: Real, const OURS: bool>(z: f64, c: f64) -> f64 {
    let (z, c) = (T::of(z), T::of(c));
    let (depth, factor) = oracle(z.as_f64(), c.as_f64());
    let got = if OURS { ln_chapman(z, c) } else { textbook(z, c).ln() };
    (got.as_f64() - (depth + factor.ln())).abs() / (1.0 + depth)
}

fn textbook<T: Real>(z: T, c: T) -> T {
    let above = chapman_large_z(z, c.abs());
    if c >= T::zero() {
        return above;
    }
    let sin = (T::one() - c * c).sqrt();
    let foot = z * sin;
    let horizon =
        (T::FRAC_PI_2() * foot).sqrt() * (T::one() + T::of(0.375) / foot - T::of(15.0 / 128.0) / (foot * foot));
    T::of(2.0) * (z - foot).exp() * horizon - above
}

/// (exponent, factor) of C by the path integral itself, the foot of the ray as origin below the horizon.
fn oracle(z: f64, c: f64) -> (f64, f64) {
    let path = |start: f64, along: f64, t: f64| {
        let gain = t * (2.0 * along + t);
        (-gain / (start + (start * start + gain).sqrt())).exp()
    };
    let scale = |start: f64, along: f64| (1.0 + 2.0 * start) / (along + (along * along + 1.0 + 2.0 * start).sqrt());
    if c >= 0.0 {
        return (0.0, half_line(scale(z, z * c), 24, |t| path(z, z * c, t)));
    }
    let sin = ((1.0 - c) * (1.0 + c)).sqrt();
    let foot = z * sin;
    let reach = (-z * c).min((45.0 * (2.0 * foot + 45.0)).sqrt());
    let rule = GaussLegendre::<f64>::cached(32);
    let pieces = 16;
    let down: f64 = (0..pieces)
        .map(|i| reach * f64::from(i) / f64::from(pieces))
        .map(|start| rule.integrate(start, start + reach / f64::from(pieces), |t| path(foot, 0.0, t)))
        .sum();
    (z * c * c / (1.0 + sin), down + half_line(scale(foot, 0.0), 24, |t| path(foot, 0.0, t)))
}
