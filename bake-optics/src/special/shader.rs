//! Forms for shading languages, which have neither expm1, log1p nor erfc: plain f32 arithmetic with exp, log and division only, the
//! twins of the shader functions of the same name.

/// [`phi1`](super::phi1) without expm1: Taylor polynomial for |x| < 0.5, else `(e^x − 1)/x`.
///
/// *Accuracy*: 4e-7 relative over −80 ≤ x ≤ 80.
#[inline]
pub fn phi1_f32(x: f32) -> f32 {
    if x.abs() >= 0.5 {
        return (x.exp() - 1.0) / x;
    }
    let mut sum = 1.0;
    for k in (2..=8u8).rev() {
        sum = 1.0 + x / f32::from(k) * sum;
    }
    sum
}

/// [`lam`](super::lam) without log1p, x > −1: `2/(2+x) Σ s^{2k}/(2k+1)`, s = x/(2+x), for −0.4 < x < 0.7, else `ln(1 + x)/x`.
///
/// *Accuracy*: 6e-7 relative over −0.999 ≤ x ≤ 1e6.
#[inline]
pub fn lam_f32(x: f32) -> f32 {
    if !(-0.4..0.7).contains(&x) {
        return (1.0 + x).ln() / x;
    }
    let s = x / (2.0 + x);
    let square = s * s;
    2.0 / (2.0 + x) * (1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0 + square / 9.0))))
}

/// [`erfcx`](super::erfcx) for x ≥ 0: polynomial in t = 3.9788608/(x + 3.9788608) (Golubev, "Sampling Analytic Participating Media", after Ooura).
///
/// *Accuracy*: 2e-6 relative over x ≥ 0.
#[inline]
pub fn erfcx_f32(x: f32) -> f32 {
    const REACH: f32 = 3.978_860_8;
    const COEFFICIENTS: [f32; 10] = [
        -0.010_297_533,
        0.288_184_3,
        0.805_188_1,
        1.203_098_8,
        1.371_236_6,
        1.312_000_9,
        1.079_175_2,
        0.774_399_9,
        0.490_166_7,
        0.275_374_62,
    ];
    let t = REACH / (x + REACH);
    let u = t - 0.5;
    COEFFICIENTS.iter().fold(0.0, |y, &c| y * u + c) * t
}

#[cfg(test)]
mod tests {
    use super::super::{erfcx, lam, phi1};
    use super::*;
    use testkit::compare::Worst;

    /// Both signs of 10^from … 10^to.
    fn sweep(from: f32, to: f32) -> impl Iterator<Item = f32> {
        (0..=4000).map(move |i| 10f32.powf(from + (to - from) * i as f32 / 4000.0)).flat_map(|x| [x, -x])
    }

    #[test]
    fn shader_forms_keep_their_stated_accuracy_and_the_textbook_does_not() {
        let mut worst = [Worst::new("phi1_f32", 4e-7), Worst::new("lam_f32", 6e-7), Worst::new("erfcx_f32", 2e-6)];
        let mut book = Worst::new("(exp(x)-1)/x in f32 (negative control)", 1e-4);
        for x in sweep(-12.0, 1.9) {
            worst[0].relative(phi1_f32(x).into(), phi1(f64::from(x)), || format!("{x}"));
            book.relative(f64::from((x.exp() - 1.0) / x), phi1(f64::from(x)), || format!("{x}"));
        }
        for x in sweep(-12.0, 6.0).filter(|&x| x > -0.999) {
            worst[1].relative(lam_f32(x).into(), lam(f64::from(x)), || format!("{x}"));
        }
        for x in sweep(-12.0, 12.0).map(f32::abs) {
            worst[2].relative(erfcx_f32(x).into(), erfcx(f64::from(x)), || format!("{x}"));
        }
        worst.iter().for_each(Worst::check);
        assert!(!book.holds());
        assert_eq!((phi1_f32(0.0), lam_f32(0.0)), (1.0, 1.0));
    }
}
