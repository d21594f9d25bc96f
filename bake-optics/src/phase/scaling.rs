//! Exchanging a peaked phase function for a flatter one in a thinner medium: similarity and delta scaling.
//!
//! Both keep the absorption coefficient and change scattering: `sigma_s' = scatter_factor sigma_s`, `sigma_t' = sigma_a + sigma_s'`.
//! They belong to the **whole** medium, attenuation of every path included: what is removed counts as light that went straight on.

use super::Phase;
use crate::real::Real;

/// A reduced phase function and what becomes of scattering.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced<T> {
    /// sigma_s' / sigma_s, in (0, 1].
    pub scatter_factor: T,
    /// The phase function that remains.
    pub phase: Phase<T>,
}

impl<T: Real> Reduced<T> {
    /// (sigma_s', sigma_t') of the reduced medium from those of the true one, 1/m.
    pub fn coefficients(&self, sigma_s: T, sigma_t: T) -> (T, T) {
        let reduced = sigma_s * self.scatter_factor;
        (reduced, (sigma_t - sigma_s) + reduced)
    }
}

impl<T: Real> Phase<T> {
    /// Similarity: isotropic scattering with `sigma_s' = (1 − g) sigma_s`, which keeps the first moment (van de Hulst 1980, ch. 14).
    /// A backward phase function (g < 0) is left with a factor above 1.
    pub fn similarity(&self) -> Reduced<T> {
        Reduced { scatter_factor: T::one() - self.mean_cosine(), phase: Self::Isotropic }
    }

    /// Delta-M scaling to `bands` Legendre terms: the share f = moment(bands) goes straight on, moments become (m_l − f)/(1 − f)
    /// (Wiscombe 1977, eqs. 14, 17). No share is taken where that moment is not positive.
    pub fn delta_m(&self, bands: usize) -> Reduced<T> {
        let forward = self.moment(bands).max(T::zero());
        let mut terms = vec![T::zero(); bands.max(1)];
        self.moments(&mut terms);
        for (l, a) in terms.iter_mut().enumerate() {
            *a = (*a - forward) / (T::one() - forward) * T::of((2 * l + 1) as f64);
        }
        Reduced { scatter_factor: T::one() - forward, phase: Self::Legendre(terms) }
    }

    /// Delta scaling to a Henyey–Greenstein lobe that keeps the first two moments: f = m_2, g' = (m_1 − f)/(1 − f); for Henyey–Greenstein
    /// f = g² and g' = g/(1 + g) (Joseph, Wiscombe & Weinman 1976, delta-Eddington). Unchanged factor where g ≤ 0.
    pub fn delta_henyey_greenstein(&self) -> Reduced<T> {
        let (first, second) = (self.mean_cosine(), self.moment(2));
        let forward = if first > T::zero() { second.max(T::zero()).min(first) } else { T::zero() };
        let g = (first - forward) / (T::one() - forward);
        Reduced { scatter_factor: T::one() - forward, phase: Self::HenyeyGreenstein { g } }
    }
}
