//! Scaled exponential integrals S_p(z) over the right half plane.

use bake_optics::Real;
use bake_optics::special::{Complex, scaled_exponential_integral};
use testkit::oracle::logarithmic_line;

use crate::map::{Axis, Map, Pair};

pub fn maps() -> Vec<Map> {
    let axes = || (Axis::decades("|z|", -3.0, 3.0, 30), Axis::linear("arg z in quarter turns", 0.0, 1.0, 15));
    let ((x1, y1), (x8, y8)) = (axes(), axes());
    vec![
        Map {
            name: "exponential_integral_1",
            title: "Exponential integral e^z E_1(z)",
            text: "The heart of the closed forms of air-light. Textbook: the power series (Abramowitz & Stegun 5.1.11) times e^z, which cancels as \
                   e^{|z| + Re z}. Ours: series, continued fraction evaluated backward, each where it holds; e^z is never formed beyond |z| = 4.",
            x: x1,
            y: y1,
            single: Pair { textbook: error::<f32, 1, false>, ours: error::<f32, 1, true> },
            double: Pair { textbook: error::<f64, 1, false>, ours: error::<f64, 1, true> },
        },
        Map {
            name: "exponential_integral_8",
            title: "Exponential integral e^z E_8(z)",
            text: "Textbook: S_1 exact, then the recurrence p S_{p+1} = 1 − z S_p upwards, as an antiderivative in closed form unrolls it (Pegoraro et al. \
                   2010, eq. 29): each step multiplies the error by |z|/p. Ours: the continued fraction of order p.",
            x: x8,
            y: y8,
            single: Pair { textbook: error::<f32, 8, false>, ours: error::<f32, 8, true> },
            double: Pair { textbook: error::<f64, 8, false>, ours: error::<f64, 8, true> },
        },
    ]
}

fn error<T: Real, const P: usize, const OURS: bool>(modulus: f64, quarters: f64) -> f64 {
    let (sin, cos) = (quarters * std::f64::consts::FRAC_PI_2).sin_cos();
    let z = Complex::new(T::of(modulus * cos), T::of(modulus * sin));
    let got = match (OURS, P) {
        (true, _) => scaled_exponential_integral(P, z),
        (false, 1) => series(z),
        (false, _) => forward(z, P),
    };
    let want = oracle(P as i32, Complex::new(z.re.as_f64(), z.im.as_f64()));
    (Complex::new(got.re.as_f64(), got.im.as_f64()) - want).norm() / want.norm()
}

/// `S_p(z) = z^{p−1} ∫_0^∞ e^{−w}/(z + w)^p dw`.
fn oracle(p: i32, z: Complex<f64>) -> Complex<f64> {
    let integrand = |w: f64| (z / (z + w)).powi(p) / z * (-w).exp();
    let line = |f: &dyn Fn(f64) -> f64| logarithmic_line(z.norm().min(1.0).ln() - 42.0, 4.5, 8, f);
    Complex::new(line(&|w| integrand(w).re), line(&|w| integrand(w).im))
}

fn series<T: Real>(z: Complex<T>) -> Complex<T> {
    let mut sum = -z.ln() - T::of(0.577_215_664_901_532_9);
    let mut term = Complex::new(T::one(), T::zero());
    for k in 1..200 {
        let k = T::of(f64::from(k));
        term = -z * term / k;
        sum -= term / k;
    }
    z.exp() * sum
}

fn forward<T: Real>(z: Complex<T>, p: usize) -> Complex<T> {
    (1..p).fold(scaled_exponential_integral(1, z), |s, k| (-z * s + T::one()) / T::of(k as f64))
}
