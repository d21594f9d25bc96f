//! Slow, obvious numbers to compare f64 formulas with: double-double arithmetic and double-exponential quadrature.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// An unevaluated sum of two f64: about 31 digits in +, −, ×, ÷ and square root (Dekker 1971).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// Exactly this double.
    pub const fn new(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// The nearest double.
    pub fn to_f64(self) -> f64 {
        self.high + self.low
    }

    /// Square root of a value ≥ 0: one Newton step from the double's root.
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::new(0.0);
        }
        let root = Self::new(self.high.sqrt());
        (root + self / root) * Self::new(0.5)
    }

    fn from_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_part = high - a;
        Self { high, low: (a - (high - b_part)) + (b - b_part) }
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self::new(value)
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = Self::from_sum(self.high, other.high);
        let low = Self::from_sum(self.low, other.low);
        let first = Self::from_sum(high.high, high.low + low.high);
        Self::from_sum(first.high, first.low + low.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let error = self.high.mul_add(other.high, -high);
        Self::from_sum(high, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::new(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::new(second);
        Self::from_sum(first, second) + Self::new(rest.high / other.high)
    }
}

/// `∫_0^∞ f(x) dx` for f that is smooth in ln x and decays at least like e^{−x/scale}: trapezoid in s with x = scale·exp(s − e^{−s}), `steps` per unit of s.
///
/// 16 steps give 15 digits where f is analytic for |arg x| < π/2; a positive f loses nothing to cancellation.
pub fn half_line(scale: f64, steps: u32, mut f: impl FnMut(f64) -> f64) -> f64 {
    let h = 1.0 / f64::from(steps);
    let mut sum = 0.0;
    for i in -(5 * steps as i64)..=(8 * steps as i64) {
        let s = i as f64 * h;
        let x = scale * (s - (-s).exp()).exp();
        let value = f(x) * x * (1.0 + (-s).exp());
        if value.is_finite() {
            sum += value;
        }
    }
    sum * h
}

/// `∫_{e^from}^{e^to} f(x) dx` by the trapezoid in ln x, `steps` per unit: for integrands with two far apart scales that vanish at both ends.
pub fn logarithmic_line(from: f64, to: f64, steps: u32, mut f: impl FnMut(f64) -> f64) -> f64 {
    let h = 1.0 / f64::from(steps);
    let count = ((to - from) / h).ceil() as u64;
    (0..=count).map(|i| (from + i as f64 * h).exp()).map(|x| f(x) * x).sum::<f64>() * h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn double_double_keeps_what_a_double_drops() {
        let tiny = DoubleDouble::new(1e-25);
        let one = DoubleDouble::new(1.0);
        assert_eq!(((one + tiny) - one).to_f64(), 1e-25);
        let third = one / DoubleDouble::new(3.0);
        assert!((third * DoubleDouble::new(3.0) - one).to_f64().abs() < 1e-31);
        let root = DoubleDouble::new(2.0).sqrt();
        assert!((root * root - DoubleDouble::new(2.0)).to_f64().abs() < 1e-31);
    }

    #[test]
    fn half_line_integrals_of_known_value() {
        assert!((half_line(1.0, 16, |x| (-x).exp()) - 1.0).abs() < 1e-15);
        assert!((half_line(1e4, 16, |x| (-x / 1e4).exp() / 1e4) - 1.0).abs() < 1e-15);
        assert!((logarithmic_line(-40.0, 4.5, 16, |x| (-x).exp()) - 1.0).abs() < 1e-15);
        assert!((half_line(1.0, 16, |x| (-x * x).exp()) - std::f64::consts::PI.sqrt() / 2.0).abs() < 1e-15);
    }
}
