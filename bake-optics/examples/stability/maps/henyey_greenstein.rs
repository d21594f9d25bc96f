//! The Henyey–Greenstein lobe and its inverse towards g = 1.

use bake_optics::Real;
use bake_optics::phase::{Deflection, henyey_greenstein_deflected, sample_henyey_greenstein};
use testkit::oracle::DoubleDouble;

use crate::map::{Axis, Map, Pair, relative};

pub fn maps() -> Vec<Map> {
    vec![
        Map {
            name: "henyey_greenstein",
            title: "Henyey–Greenstein phase function",
            text: "Textbook: 1 + g² − 2 g cos θ. Ours: (1 − g)² + 2 g (1 − cos θ) with 1 − cos θ carried along from the half angle. The angle is given by its half \
                   tangent, as air-light has it.",
            x: Axis::decades("tan(θ/2)", -6.0, 2.0, 32),
            y: Axis::decades("1 − g", -6.0, 0.0, 18),
            single: Pair { textbook: value_error::<f32, false>, ours: value_error::<f32, true> },
            double: Pair { textbook: value_error::<f64, false>, ours: value_error::<f64, true> },
        },
        Map {
            name: "henyey_greenstein_sample",
            title: "Drawing from the Henyey–Greenstein lobe: 1 − cos θ of a uniform number",
            text: "Textbook: cos θ = (1 + g² − ((1 − g²)/(1 − g + 2 g ξ))²)/(2 g). Ours: a product without subtraction. What counts is 1 − cos θ: in f32 the textbook form \
                   puts most of a peaked lobe straight on.",
            x: Axis::linear("uniform number", 0.0, 1.0, 20),
            y: Axis::decades("1 − g", -6.0, -0.01, 18),
            single: Pair { textbook: sample_error::<f32, false>, ours: sample_error::<f32, true> },
            double: Pair { textbook: sample_error::<f64, false>, ours: sample_error::<f64, true> },
        },
    ]
}

fn exact<T: Real>(x: T) -> DoubleDouble {
    DoubleDouble::new(x.as_f64())
}

fn value_error<T: Real, const OURS: bool>(half_tangent: f64, gap: f64) -> f64 {
    let (v, g) = (T::of(half_tangent), T::one() - T::of(gap));
    let deflection = Deflection::from_half_tangent(v);
    let got = if OURS { henyey_greenstein_deflected(g, deflection) } else { textbook(g, deflection.cos_theta) };
    let (one, square, lobe) = (DoubleDouble::new(1.0), exact(v) * exact(v), exact(g));
    let from_peak = (square + square) / (one + square);
    let gap = one - lobe;
    let denominator = gap * gap + (lobe + lobe) * from_peak;
    let want = gap * (one + lobe) / (denominator * denominator.sqrt());
    relative(got, want.to_f64() * 0.25 * std::f64::consts::FRAC_1_PI)
}

fn textbook<T: Real>(g: T, cos_theta: T) -> T {
    let denominator = T::one() + g * g - T::of(2.0) * g * cos_theta;
    (T::one() - g * g) / (T::of(4.0) * T::PI() * denominator * denominator.sqrt())
}

fn sample_error<T: Real, const OURS: bool>(u: f64, gap: f64) -> f64 {
    let (u, g, one) = (T::of(u), T::one() - T::of(gap), T::one());
    let got = if OURS {
        sample_henyey_greenstein(g, u).one_minus_cos
    } else {
        let ratio = (one - g * g) / (one + g - T::of(2.0) * g * u);
        one - (one + g * g - ratio * ratio) / (T::of(2.0) * g)
    };
    let (u, g, one) = (exact(u), exact(g), DoubleDouble::new(1.0));
    let shrink = (one - g) / (one + g - (g + g) * u);
    relative(got, ((u + u) * (one + g - g * u) * shrink * shrink).to_f64())
}
