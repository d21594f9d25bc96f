//! The scaled complementary error function.

use bake_optics::Real;
use bake_optics::special::erfcx;
use testkit::oracle::half_line;

use crate::map::{Axis, Map, Pair, relative};

pub fn map() -> Map {
    Map {
        name: "erfcx",
        title: "Scaled complementary error function e^{x²} erfc(x)",
        text: "Needed by planetary atmospheres. Textbook: the product, whose factors overflow and underflow at x = 9.4 (f32) and 26.6 (f64). Ours: the crate \
               `errorfunctions`. A function of one parameter: the map's height has no meaning.",
        x: Axis::decades("x", -3.0, 3.0, 60),
        y: Axis::linear("", 0.0, 1.0, 1),
        single: Pair { textbook: error::<f32, false>, ours: error::<f32, true> },
        double: Pair { textbook: error::<f64, false>, ours: error::<f64, true> },
    }
}

fn error<T: Real, const OURS: bool>(x: f64, _: f64) -> f64 {
    let x = T::of(x);
    let exact = x.as_f64();
    let scale = 1.0f64.min(0.5 / exact);
    let want = half_line(scale, 16, |t| (-t * (t + 2.0 * exact)).exp()) * 2.0 / std::f64::consts::PI.sqrt();
    let got = if OURS { erfcx(x) } else { (x * x).exp() * T::of(errorfunctions::RealErrorFunctions::erfc(exact)) };
    relative(got, want)
}
