//! (e^x − 1)/x and ln(1+x)/x: what exponential densities need where the textbook subtracts.

use crate::real::Real;

/// `phi1(x) = (e^x − 1)/x`, phi1(0) = 1: the mean of e^t over t in [0, x].
///
/// *Range*: every real x; overflows only where the result does. *Accuracy*: 3 ulp (f32 and f64).
#[inline]
pub fn phi1<T: Real>(x: T) -> T {
    if x == T::zero() {
        T::one()
    } else if x > T::of(T::pick(80.0, 700.0)) {
        let half = (x * T::of(0.5)).exp();
        half / x.min(T::max_value()) * half
    } else {
        x.exp_m1() / x
    }
}

/// `lam(x) = ln(1+x)/x`, lam(0) = 1: inverse of [`phi1`] in the sense `u = y lam(p y)` solves `u phi1(p u) = y`.
///
/// *Range*: x > −1; +∞ at and below −1, where the equation has no solution. *Accuracy*: 3 ulp (f32 and f64).
#[inline]
pub fn lam<T: Real>(x: T) -> T {
    if x == T::zero() {
        T::one()
    } else if x <= -T::one() {
        T::infinity()
    } else if x.is_infinite() {
        T::zero()
    } else {
        x.ln_1p() / x
    }
}
