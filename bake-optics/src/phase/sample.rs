//! Drawing deflections from a phase function: inverse of the cumulative distribution measured from straight on.

use super::{Deflection, Phase, isotropic};
use crate::real::Real;

/// A drawn deflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseSample<T> {
    /// The deflection angle; the azimuth is uniform.
    pub deflection: Deflection<T>,
    /// Density of the draw per solid angle, 1/sr.
    pub pdf: T,
    /// Phase function over density: 1 wherever the inverse is exact, signed where a truncated series is negative.
    pub weight: T,
}

impl<T: Real> Phase<T> {
    /// Draws a deflection from a uniform number 0 ≤ u < 1; ascending u turns from straight on to straight back.
    ///
    /// Exact inverses (weight 1) for all but [`Phase::Legendre`]: a series may be negative, so it is drawn from half an isotropic,
    /// half a Henyey–Greenstein lobe of its mean cosine, and weighted.
    pub fn sample(&self, u: T) -> PhaseSample<T> {
        let deflection = match self {
            Self::Isotropic => from_gap(T::of(2.0) * u),
            Self::Linear { a1 } => sample_linear(*a1, u),
            Self::Rayleigh => sample_rayleigh(u),
            Self::HenyeyGreenstein { g } => sample_henyey_greenstein(*g, u),
            Self::Table(table) => Deflection::from_angle(table.sample(u)),
            Self::Legendre(_) => return self.sample_mixture(u),
        };
        PhaseSample { deflection, pdf: self.eval_deflected(deflection), weight: T::one() }
    }

    /// Density with which [`Phase::sample`] draws a deflection, 1/sr.
    pub fn pdf(&self, deflection: Deflection<T>) -> T {
        match self {
            Self::Legendre(_) => {
                let lobe = self.proposal_lobe().eval_deflected(deflection);
                T::of(0.5) * (isotropic::<T>() + lobe)
            }
            _ => self.eval_deflected(deflection),
        }
    }

    fn proposal_lobe(&self) -> Self {
        Self::HenyeyGreenstein { g: self.mean_cosine().min(T::of(0.95)).max(T::of(-0.95)) }
    }

    fn sample_mixture(&self, u: T) -> PhaseSample<T> {
        let twice = T::of(2.0) * u;
        let part = if u < T::of(0.5) { self.proposal_lobe() } else { Self::Isotropic };
        let deflection = part.sample(if u < T::of(0.5) { twice } else { twice - T::one() }).deflection;
        let pdf = self.pdf(deflection);
        PhaseSample { deflection, pdf, weight: self.eval_deflected(deflection) / pdf }
    }
}

/// A deflection from 1 − cos θ.
#[inline]
fn from_gap<T: Real>(gap: T) -> Deflection<T> {
    let gap = gap.max(T::zero()).min(T::of(2.0));
    Deflection { cos_theta: T::one() - gap, one_minus_cos: gap, one_plus_cos: T::of(2.0) - gap }
}

/// With s = 1 − μ the cumulative is A s − a1 s²/4, A = (1 + a1)/2: the root without cancellation, s = 2u/(A + sqrt(A² − a1 u)).
#[inline]
pub fn sample_linear<T: Real>(a1: T, u: T) -> Deflection<T> {
    let a = (T::one() + a1) * T::of(0.5);
    let denominator = a + (a * a - a1 * u).max(T::zero()).sqrt();
    from_gap(if denominator > T::zero() { T::of(2.0) * u / denominator } else { T::zero() })
}

/// The cumulative is the cubic μ³ + 3μ = 4 − 8u; its only real root is 2 sinh(asinh(2 − 4u)/3), free of the difference of cube roots.
#[inline]
pub fn sample_rayleigh<T: Real>(u: T) -> Deflection<T> {
    let third = T::of(3.0).recip();
    Deflection::from_cos(T::of(2.0) * (third * (T::of(2.0) - T::of(4.0) * u).asinh()).sinh())
}

/// `1 − μ = 2 u (1 + g − g u) ((1 − g)/(1 − g + 2 g (1 − u)))²` for g ≥ 0, mirrored below: the textbook inverse rewritten so that nothing is
/// subtracted and g = 0 needs no branch.
///
/// *Accuracy*: 6 ulp of 1 − μ for every −1 < g < 1; the textbook form divides by 2g and loses all digits of 1 − μ near the peak.
#[inline]
pub fn sample_henyey_greenstein<T: Real>(g: T, u: T) -> Deflection<T> {
    if g < T::zero() {
        let mirrored = sample_henyey_greenstein(-g, T::one() - u);
        return Deflection {
            cos_theta: -mirrored.cos_theta,
            one_minus_cos: mirrored.one_plus_cos,
            one_plus_cos: mirrored.one_minus_cos,
        };
    }
    let (one, two) = (T::one(), T::of(2.0));
    let gap = one - g;
    let shrink = gap / (gap + two * g * (one - u));
    from_gap(two * u * (one + g - g * u) * shrink * shrink)
}
