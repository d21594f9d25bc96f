//! The scaled complementary error function, from the crate `errorfunctions` (S. G. Johnson's Faddeeva package: 1e-15 on the whole line).

use crate::real::Real;

/// `erfcx(x) = e^{x²} erfc(x)`, never formed as that product: e^{x²} overflows at x = 9.4 (f32) or 26.6 (f64).
///
/// *Range*: every real x; +∞ below −26.6 (f64) or −9.4 (f32), where the value exceeds the type. *Accuracy*: 1e-15 in f64, rounded from it in f32.
/// For −x large the value is e^{x²}-sensitive: errors of 2x² ulp of x are in its nature.
#[inline]
pub fn erfcx<T: Real>(x: T) -> T {
    T::of(errorfunctions::RealErrorFunctions::erfcx(x.as_f64()))
}
