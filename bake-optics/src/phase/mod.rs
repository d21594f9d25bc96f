//! Phase functions: how air spreads light over the angle of deflection.
//!
//! `cos_theta` is the cosine of the **deflection** angle between directions of propagation: +1 is straight on, `g > 0` is
//! forward. Every phase function is normalised, `2π ∫_{−1}^{1} Φ dμ = 1`, unit 1/sr.

mod check;
mod deflection;
mod functions;
mod sample;
mod scaling;

pub use check::PhaseError;
pub use deflection::Deflection;
pub use functions::{henyey_greenstein, henyey_greenstein_deflected, isotropic, linear, linear_deflected, rayleigh};
pub use sample::{PhaseSample, sample_henyey_greenstein, sample_linear, sample_rayleigh};
pub use scaling::Reduced;

use crate::axial_table::{AxialTable, AxialTableError};
use crate::legendre;
use crate::real::Real;

/// A phase function.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Phase<T> {
    /// The same in all directions: 1/(4π).
    #[default]
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
    /// Measured or computed (Mie) values over the angle; made and normalised by [`Phase::from_table`].
    Table(AxialTable<T>),
}

impl<T: Real> Phase<T> {
    /// A tabulated phase function: values at ascending angles (radians) that cover 0 … π, in any unit; normalised here.
    pub fn from_table(angles: Vec<T>, values: Vec<T>) -> Result<Self, AxialTableError> {
        let table = AxialTable::new(angles, values)?;
        let (from, to) = (table.angles()[0], table.angles()[table.angles().len() - 1]);
        if from != T::zero() || to != T::PI() {
            return Err(AxialTableError::Range { from: from.as_f64(), to: to.as_f64() });
        }
        let flux = table.flux();
        Ok(Self::Table(table.scaled(flux.recip())))
    }

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
            Self::Linear { a1 } => linear_deflected(*a1, deflection),
            Self::Rayleigh => rayleigh(deflection.cos_theta),
            Self::HenyeyGreenstein { g } => henyey_greenstein_deflected(*g, deflection),
            Self::Legendre(a) => legendre::series(a, deflection.cos_theta) * isotropic::<T>(),
            Self::Table(table) => table.eval(deflection.angle()),
        }
    }

    /// Legendre moments `2π ∫ Φ P_l dμ` for l < `out.len()`; the first is 1, the second the mean cosine.
    pub fn moments(&self, out: &mut [T]) {
        match self {
            Self::Table(table) => {
                let series = table.legendre(out.len());
                let scale = |l: usize| T::of(4.0) * T::PI() / T::of((2 * l + 1) as f64);
                out.iter_mut().zip(series).enumerate().for_each(|(l, (slot, c))| *slot = c * scale(l));
            }
            _ => out.iter_mut().enumerate().for_each(|(l, slot)| *slot = self.moment(l)),
        }
    }

    /// The phase function's first `bands` Legendre terms as a series of its own: exact where it ends there, truncated else.
    ///
    /// Truncation makes peaked functions negative: Henyey–Greenstein g = 0.75 with 11 terms reaches −0.011/sr, g = 0.9 −0.27/sr.
    pub fn to_legendre(&self, bands: usize) -> Self {
        let mut terms = vec![T::zero(); bands];
        self.moments(&mut terms);
        terms.iter_mut().enumerate().for_each(|(l, a)| *a *= T::of((2 * l + 1) as f64));
        Self::Legendre(terms)
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
            (Self::Table(table), _) => table.legendre(l + 1)[l] * T::of(4.0) * T::PI() / T::of((2 * l + 1) as f64),
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
