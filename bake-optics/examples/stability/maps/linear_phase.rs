//! Drawing from the linear phase function towards the isotropic limit.

use bake_optics::Real;
use bake_optics::phase::sample_linear;
use testkit::oracle::DoubleDouble;

use crate::map::{Axis, Map, Pair, relative};

pub fn map() -> Map {
    Map {
        name: "linear_phase_sample",
        title: "Drawing from the linear phase function: 1 − cos θ of a uniform number",
        text: "Textbook: the root (A − sqrt(A² − a1 u))/(a1/2), A = (1 + a1)/2, which is 0/0 for the isotropic a1 = 0. Ours: 2 u/(A + sqrt(A² − a1 u)). The same \
               rewriting inverts the optical depth of a density that is linear along the ray.",
        x: Axis::linear("uniform number", 0.0, 1.0, 20),
        y: Axis::decades("a1", -10.0, 0.0, 20),
        single: Pair { textbook: error::<f32, false>, ours: error::<f32, true> },
        double: Pair { textbook: error::<f64, false>, ours: error::<f64, true> },
    }
}

fn error<T: Real, const OURS: bool>(u: f64, a1: f64) -> f64 {
    let (u, a1) = (T::of(u), T::of(a1));
    let a = (T::one() + a1) * T::of(0.5);
    let got = if OURS { sample_linear(a1, u).one_minus_cos } else { (a - (a * a - a1 * u).sqrt()) / (a1 * T::of(0.5)) };
    let (u, a1) = (DoubleDouble::new(u.as_f64()), DoubleDouble::new(a1.as_f64()));
    let a = (DoubleDouble::new(1.0) + a1) * DoubleDouble::new(0.5);
    relative(got, ((u + u) / (a + (a * a - a1 * u).sqrt())).to_f64())
}
