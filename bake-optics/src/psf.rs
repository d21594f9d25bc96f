//! The glow around a distant lamp: point-spread function of uniform isotropic air (Sun et al. 2005, section 5.3), and what it
//! does to an environment map in spherical harmonics.
//!
//! ```text
//! PSF(γ; T) = T/(2π sin γ) e^{−T} Im S_1(T sin γ (tan(γ/2) − i))
//! ```
//!
//! is the radiance scattered once, seen at angle γ from a source of unit irradiance at optical distance T. Being this short it
//! needs no approximation: eq. 22 (T e^{−T} NPSF) errs by 60 to 500 % backwards.

use crate::Real;
use crate::airlight::sun;
use crate::legendre;
use crate::quadrature::GaussLegendre;

/// PSF at angle `gamma` in (0, π) radians and optical distance `t` > 0, 1/sr. Grows as T e^{−T}/(4γ) near γ = 0.
///
/// *Accuracy*: 1e-13 in f64, 2e-6 in f32 (plus T ulp).
pub fn psf<T: Real>(gamma: T, t: T) -> T {
    t / (T::of(2.0) * T::PI() * gamma.sin()) * sun::endless(gamma, t)
}

/// Normalised PSF(γ; 1)/e^{−1}: Sun et al. 2005, eq. 21.
///
/// *Accuracy*: 1e-13 in f64, 2e-6 in f32.
pub fn npsf<T: Real>(gamma: T) -> T {
    psf(gamma, T::one()) * T::E()
}

/// Zonal factors by which air of optical thickness `t` multiplies the bands l < `bands` of an environment's spherical
/// harmonics; the unscattered e^{−T} is not in them.
///
/// *Equation*: sqrt(4π/(2l+1)) ∫ PSF Y_l0 dω = T ∫_0^π e^{−T} Im S_1(…) P_l(cos γ) dγ, Gauss–Legendre in s, γ = π s² (3 − 2s).
/// *Accuracy*, of the first factor for l ≤ 16: 1e-10 in f64, 1e-6 in f32.
pub fn convolution_factors<T: Real>(t: T, bands: usize) -> Vec<T> {
    let rule = GaussLegendre::<T>::new(96 + 2 * bands);
    let mut factors = vec![T::zero(); bands];
    let mut polynomials = vec![T::zero(); bands];
    let (two, three, six) = (T::of(2.0), T::of(3.0), T::of(6.0));
    for &(s, weight) in rule.nodes() {
        let gamma = T::PI() * s * s * (three - two * s);
        let value = weight * six * T::PI() * s * (T::one() - s) * t * sun::endless(gamma, t);
        legendre::legendre_all(gamma.cos(), &mut polynomials);
        factors.iter_mut().zip(&polynomials).for_each(|(f, &p)| *f += value * p);
    }
    factors
}

/// Multiplies real spherical harmonics (index l(l+1)+m) by the scattered part of the glow, in place.
pub fn convolve<T: Real>(t: T, sh: &mut [T]) {
    let bands = (sh.len() as f64).sqrt().ceil() as usize;
    let factors = convolution_factors(t, bands);
    for (index, coefficient) in sh.iter_mut().enumerate() {
        *coefficient *= factors[index.isqrt()];
    }
}
