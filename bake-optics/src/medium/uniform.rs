//! Constant density.

use crate::Real;

/// Integral of a constant `density` ≥ 0 over `length` ≥ 0 (may be infinite). Golubev 2018, section 3.1.
#[inline]
pub fn optical_length<T: Real>(density: T, length: T) -> T {
    if density == T::zero() { T::zero() } else { density * length }
}

/// Distance after which [`optical_length`] reaches `target`; infinite where it never does.
#[inline]
pub fn free_path<T: Real>(density: T, target: T) -> T {
    if target <= T::zero() { T::zero() } else { target / density }
}
