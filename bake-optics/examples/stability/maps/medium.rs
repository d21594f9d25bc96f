//! Optical depths and free paths of the media.

use bake_optics::Real;
use bake_optics::medium::exponential::{self, Climb};
use bake_optics::medium::linear;
use bake_optics::medium::planet::{self, Orbit};
use bake_optics::quadrature::GaussLegendre;

use crate::map::{Axis, Map, Pair};

pub fn maps() -> Vec<Map> {
    vec![linear_free_path(), exponential_length(), planet_length()]
}

fn relative(got: f64, want: f64) -> f64 {
    (got / want - 1.0).abs()
}

fn linear_free_path() -> Map {
    Map {
        name: "medium_linear",
        title: "Free path where density is linear in height",
        text: "Distance u at which the density 1 + b s has summed to q. Textbook: (sqrt(1 + 2 b q) − 1)/b (Golubev, eq. 31), which cancels for \
               small b q and is 0/0 on level rays. Ours: 2 q/(1 + sqrt(1 + 2 b q)).",
        x: Axis::decades("rate b, 1/m", -12.0, 2.0, 32),
        y: Axis::decades("optical length q, m", -4.0, 4.0, 16),
        single: Pair { textbook: linear_error::<f32, false>, ours: linear_error::<f32, true> },
        double: Pair { textbook: linear_error::<f64, false>, ours: linear_error::<f64, true> },
    }
}

fn linear_error<T: Real, const OURS: bool>(b: f64, q: f64) -> f64 {
    let (b, q) = (T::of(b), T::of(q));
    let got =
        if OURS { linear::free_path(T::one(), b, q) } else { ((T::one() + T::of(2.0) * b * q).sqrt() - T::one()) / b };
    let (b, q, u) = (b.as_f64(), q.as_f64(), got.as_f64());
    // What is left of u + b u²/2 = q, positive terms, as a share of u (one Newton step).
    ((u + 0.5 * b * u * u - q) / (1.0 + b * u) / u).abs()
}

fn exponential_length() -> Map {
    Map {
        name: "medium_exponential",
        title: "Optical length where density falls exponentially with height",
        text: "A ray of length u that climbs at x = u cos θ/scale height. Textbook: (1 − exp(−x))/x with a test on |cos θ|/scale height (Golubev, \
               eq. 34); y is the start's height in scale heights. Ours: expm1, measured from the denser end.",
        x: Axis::decades("x", -12.0, 2.0, 32),
        y: Axis::linear("start's height / scale height", -20.0, 20.0, 16),
        single: Pair { textbook: exponential_error::<f32, false>, ours: exponential_error::<f32, true> },
        double: Pair { textbook: exponential_error::<f64, false>, ours: exponential_error::<f64, true> },
    }
}

fn exponential_error<T: Real, const OURS: bool>(x: f64, height: f64) -> f64 {
    let (x, height) = (T::of(x), T::of(height));
    let got = if OURS {
        exponential::optical_length(T::one(), Climb { height, cos_theta: T::one() }, x)
    } else {
        (-height).exp() * (T::one() - (-x).exp())
    };
    let rule = GaussLegendre::<f64>::cached(64);
    let want = rule.integrate(0.0, x.as_f64().min(45.0), |s| (-s).exp());
    relative(got.as_f64(), (-height.as_f64()).exp() * want)
}

/// Earth: scale height 8 km, radius 6360 km, in km.
const N: f64 = 0.125;

fn planet_length() -> Map {
    Map {
        name: "medium_planet",
        title: "Optical length around a planet",
        text: "A segment that starts 1 km above an Earth of scale height 8 km. Textbook: difference of two endless rays, each as exact as can be (Golubev, \
               eq. 43, with exact Chapman functions): digits go with the segment's share of the ray. Ours: one integral of positive terms.",
        x: Axis::decades("segment, km", -6.0, 3.0, 24),
        y: Axis::linear("cos θ", 0.0, 1.0, 11),
        single: Pair { textbook: planet_error::<f32, false>, ours: planet_error::<f32, true> },
        double: Pair { textbook: planet_error::<f64, false>, ours: planet_error::<f64, true> },
    }
}

fn planet_error<T: Real, const OURS: bool>(length: f64, cos_theta: f64) -> f64 {
    let (n, length) = (T::of(N), T::of(length));
    let orbit = Orbit { radius: T::of(6361.0), altitude: T::one(), cos_theta: T::of(cos_theta) };
    let got = if OURS {
        planet::optical_length(n, orbit, length)
    } else {
        let altitude = orbit.altitude_at(length);
        let radius = T::of(6360.0) + altitude;
        let later = Orbit { radius, altitude, cos_theta: (length + orbit.radius * orbit.cos_theta) / radius };
        planet::optical_length(n, orbit, T::infinity()) - planet::optical_length(n, later, T::infinity())
    };
    relative(got.as_f64(), brute_force(length.as_f64(), orbit.cos_theta.as_f64()))
}

/// 48 nodes in each of 32 equal panels.
fn brute_force(length: f64, cos_theta: f64) -> f64 {
    let orbit = Orbit { radius: 6361.0, altitude: 1.0, cos_theta };
    let rule = GaussLegendre::<f64>::cached(48);
    let edge = |i: i32| length * f64::from(i) / 32.0;
    (0..32).map(|i| rule.integrate(edge(i), edge(i + 1), |s| (-N * orbit.altitude_at(s)).exp())).sum()
}
