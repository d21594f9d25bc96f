//! Transmittance, opacity and the optical depth that a random number asks for.

use crate::Real;

/// `exp(−τ)`, the share of light that passes optical depth τ ≥ 0.
#[inline]
pub fn transmittance<T: Real>(optical_depth: T) -> T {
    (-optical_depth).exp()
}

/// `1 − exp(−τ)`, the share that is scattered or absorbed; full relative accuracy for thin air.
#[inline]
pub fn opacity<T: Real>(optical_depth: T) -> T {
    -(-optical_depth).exp_m1()
}

/// Optical depth to a collision for a random number `xi` in [0, 1), given that one happens within `opacity` (1: anywhere).
///
/// *Equation*: τ = −ln(1 − ξ O). *Source*: Golubev 2018, eq. 24, whose first equality should read −ln(1 − O).
/// *Accuracy*: `ln_1p` keeps all digits for thin air, where 1 − ξ O in f32 keeps fewer than three below O = 1e-4.
#[inline]
pub fn sampled_optical_depth<T: Real>(xi: T, opacity: T) -> T {
    -(-xi * opacity).ln_1p()
}
