//! Phase functions: how air spreads light over the angle of deflection.
//!
//! `cos_theta` is the cosine of the **deflection** angle between directions of propagation: +1 is straight on, `g > 0` is
//! forward. Every phase function is normalised, `2π ∫_{−1}^{1} Φ dμ = 1`, unit 1/sr.

mod deflection;
mod functions;

pub use deflection::Deflection;
pub use functions::{henyey_greenstein, henyey_greenstein_deflected, isotropic, linear, rayleigh};

use crate::legendre;
use crate::real::Real;

/// A phase function.
#[derive(Debug, Clone, PartialEq)]
pub enum Phase<T> {
    /// The same in all directions: 1/(4π).
    Isotropic,
    /// (1 + a1 μ)/(4π), −1 ≤ a1 ≤ 1; mean cosine a1/3 (Eddington).
    Linear {
        /// Slope.
        a1: T,
    },
    /// 3 (1 + μ²)/(16π): particles much smaller than the wavelength.
    Rayleigh,
    /// Henyey & Greenstein 1941, −1 < g < 1; mean cosine g.
    HenyeyGreenstein {
        /// Mean cosine.
        g: T,
    },
    /// `1/(4π) Σ a_l P_l(μ)` with a_0 = 1: the moment of degree l is a_l/(2l+1).
    Legendre(Vec<T>),
}

impl<T: Real> Phase<T> {
    /// Value, 1/sr, at the cosine of the deflection angle.
    #[inline]
    pub fn eval(&self, cos_theta: T) -> T {
        self.eval_deflected(Deflection::from_cos(cos_theta))
    }

    /// Value, 1/sr, at a deflection that also knows its distance from straight on and straight back.
    #[inline]
    pub fn eval_deflected(&self, deflection: Deflection<T>) -> T {
        match self {
            Self::Isotropic => isotropic(),
            Self::Linear { a1 } => linear(*a1, deflection.cos_theta),
            Self::Rayleigh => rayleigh(deflection.cos_theta),
            Self::HenyeyGreenstein { g } => henyey_greenstein_deflected(*g, deflection),
            Self::Legendre(a) => legendre::series(a, deflection.cos_theta) * isotropic::<T>(),
        }
    }

    /// Legendre moments `2π ∫ Φ P_l dμ` for l < `out.len()`; the first is 1, the second the mean cosine.
    pub fn moments(&self, out: &mut [T]) {
        out.iter_mut().enumerate().for_each(|(l, slot)| *slot = self.moment(l));
    }

    /// Legendre moment `2π ∫ Φ P_l dμ` of degree l.
    pub fn moment(&self, l: usize) -> T {
        let zero = T::zero();
        match (self, l) {
            (_, 0) => T::one(),
            (Self::Linear { a1 }, 1) => *a1 / T::of(3.0),
            (Self::Rayleigh, 2) => T::of(0.1),
            (Self::HenyeyGreenstein { g }, _) => g.powi(l as i32),
            (Self::Legendre(a), _) => a.get(l).map_or(zero, |&a| a / T::of((2 * l + 1) as f64)),
            _ => zero,
        }
    }

    /// Mean cosine of the deflection angle.
    pub fn mean_cosine(&self) -> T {
        self.moment(1)
    }
}

#[cfg(test)]
mod tests;
