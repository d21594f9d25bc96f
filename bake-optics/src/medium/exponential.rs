//! Density exp(−n h), falling with height h above a plane; n = 1/scale height ≥ 0.
//!
//! *Source*: Golubev 2018, eqs. 34, 35. Departures: the segment is measured from its denser end, so that nothing
//! overflows before the result does; the printed listing has the sign of the height wrong in one direction, ignores
//! it on level rays, and takes the logarithm of a negative number where there is no collision.
//! *Accuracy* (measured against 50-digit references): 4e-16 in f64, 2e-7 in f32, times 1 + |n h| for rounded inputs.

use crate::Real;

/// Where a ray starts and how steeply it climbs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Climb<T> {
    /// Height of the start above the plane of density 1, metres.
    pub height: T,
    /// Cosine of the direction of travel against up, in [−1, 1].
    pub cos_theta: T,
}

/// `∫_0^length exp(−n (height + s cos_theta)) ds`; `length` may be infinite.
///
/// *Equation*: e^{−n h_low} · u · (1 − e^{−x})/x, x = n |cos_theta| u, h_low the lower end's height.
pub fn optical_length<T: Real>(n: T, climb: Climb<T>, length: T) -> T {
    let decay = n * climb.cos_theta.abs();
    let effective = falling_length(decay, length);
    if effective == T::zero() || effective == T::infinity() {
        return effective;
    }
    let low = if climb.cos_theta < T::zero() && n > T::zero() {
        climb.height + climb.cos_theta * length
    } else {
        climb.height
    };
    let e = (-n * low).exp();
    if e < T::infinity() {
        return e * effective;
    }
    let half = (-n * low * T::of(0.5)).exp();
    half * effective * half
}

/// `∫_0^length e^{−decay s} ds`, decay ≥ 0. The test is on the dimensionless product: a bound on decay alone has units.
fn falling_length<T: Real>(decay: T, length: T) -> T {
    if decay == T::zero() || decay * length < T::epsilon() { length } else { -(-decay * length).exp_m1() / decay }
}

/// Distance after which [`optical_length`] reaches `target`; infinite where it never does.
///
/// *Equation*: u = ln(1 + p q/e)/p, p = −n cos_theta, e = e^{−n h}; with ln(p q/e) formed from logarithms where e underflows.
pub fn free_path<T: Real>(n: T, climb: Climb<T>, target: T) -> T {
    if target <= T::zero() {
        return T::zero();
    }
    let p = -n * climb.cos_theta;
    let rise = n * climb.height;
    let (half, e) = ((rise * T::of(0.5)).exp(), (-rise).exp());
    // q/e in two factors: e^{±rise} alone overflows before the product does.
    let level = if e > T::min_positive_value() && e < T::infinity() { target / e } else { target * half * half };
    let y = p * level;
    if p == T::zero() || y.abs() < T::epsilon() {
        level
    } else if y <= -T::one() {
        T::infinity()
    } else if y < T::infinity() {
        y.ln_1p() / p
    } else {
        ((p * target).ln() + rise) / p
    }
}
