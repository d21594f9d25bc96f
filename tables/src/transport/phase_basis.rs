//! What stands in for the phase function in an order-1 table: its Legendre orders one by one, or the actual function.

use bake_optics::legendre::legendre_all;
use bake_optics::phase::{Deflection, Phase};

/// Legendre orders of the phase function that the shipped order-1 tables hold: 12 would do for irradiance at |g| ≤ 0.8 in front of an
/// emitter, but light sent straight back (g = 0.5: 0.2 of the mean) needs 20 for 0.1 %. They serve |g| ≤ 0.62;
/// beyond, the actual function is computed when a medium is prepared, in about a second.
pub const LEGENDRE_ORDERS: usize = 20;

/// The functions of the deflection angle for which order 1 is computed, all in one pass.
#[derive(Debug, Clone, PartialEq)]
pub enum PhaseBasis {
    /// `P_0 … P_{n−1}` of the deflection cosine: a medium combines them with the weights of its phase function.
    Legendre(usize),
    /// `4π p` of each phase function.
    Functions(Vec<Phase<f64>>),
}

impl PhaseBasis {
    /// How many functions there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Legendre(count) => *count,
            Self::Functions(functions) => functions.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All functions at a scattering point whose closing angle is `π − deflection`; `out` has length [`Self::len`].
    pub fn eval(&self, closing: f64, out: &mut [f64]) {
        match self {
            Self::Legendre(_) => legendre_all(-closing.cos(), out),
            Self::Functions(functions) => {
                // 1 + cos(deflection) and 1 − cos(deflection) from the half angle, so that peaks keep their digits.
                let (s, c) = (0.5 * closing).sin_cos();
                let deflection =
                    Deflection { cos_theta: -closing.cos(), one_minus_cos: 2.0 * c * c, one_plus_cos: 2.0 * s * s };
                for (slot, phase) in out.iter_mut().zip(functions) {
                    *slot = 4.0 * std::f64::consts::PI * phase.eval_deflected(deflection);
                }
            }
        }
    }
}
