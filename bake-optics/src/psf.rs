//! The glow around a distant lamp: point-spread function of uniform isotropic air (Sun et al. 2005, section 5.3), and what it
//! does to an environment map in spherical harmonics.
//!
//! ```text
//! PSF(γ; T) = T/(2π sin γ) e^{−T} Im S_1(T sin γ (tan(γ/2) − i))
//! ```
//!
//! is the radiance scattered once, seen at angle γ from a source of unit irradiance at optical distance T. Being this short it
//! needs no approximation: eq. 22 (T e^{−T} NPSF) errs by 60 to 500 % backwards.

use std::f64::consts::PI;

use crate::airlight::sun;
use crate::legendre;
use crate::quadrature::GaussLegendre;

/// PSF at angle `gamma` in (0, π) radians and optical distance `t` > 0, 1/sr. Grows as T e^{−T}/(4γ) near γ = 0.
///
/// *Accuracy*: 1e-13.
pub fn psf(gamma: f64, t: f64) -> f64 {
    t / (2.0 * PI * gamma.sin()) * sun::endless(gamma, t)
}

/// Normalised PSF(γ; 1)/e^{−1}: Sun et al. 2005, eq. 21.
pub fn npsf(gamma: f64) -> f64 {
    psf(gamma, 1.0) * 1f64.exp()
}

/// Zonal factors by which air of optical thickness `t` multiplies the bands l < `bands` of an environment's spherical
/// harmonics; the unscattered e^{−T} is not in them.
///
/// *Equation*: sqrt(4π/(2l+1)) ∫ PSF Y_l0 dω = T ∫_0^π e^{−T} Im S_1(…) P_l(cos γ) dγ, Gauss–Legendre in s, γ = π s² (3 − 2s).
/// *Accuracy*: 1e-10 of the first factor for l ≤ 16.
pub fn convolution_factors(t: f64, bands: usize) -> Vec<f64> {
    let rule = GaussLegendre::<f64>::new(96 + 2 * bands);
    let mut factors = vec![0.0; bands];
    let mut polynomials = vec![0.0; bands];
    for &(s, weight) in rule.nodes() {
        let gamma = PI * s * s * (3.0 - 2.0 * s);
        let value = weight * 6.0 * PI * s * (1.0 - s) * t * sun::endless(gamma, t);
        legendre::legendre_all(gamma.cos(), &mut polynomials);
        factors.iter_mut().zip(&polynomials).for_each(|(f, p)| *f += value * p);
    }
    factors
}

/// Multiplies real spherical harmonics (index l(l+1)+m) by the scattered part of the glow, in place.
pub fn convolve(t: f64, sh: &mut [f64]) {
    let bands = (sh.len() as f64).sqrt().ceil() as usize;
    let factors = convolution_factors(t, bands);
    for (index, coefficient) in sh.iter_mut().enumerate() {
        *coefficient *= factors[index.isqrt()];
    }
}
