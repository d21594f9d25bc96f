//! How a lamp spreads its light around an axis: relative intensity as a function of the angle from the axis.
//!
//! `cos_axis` is the cosine between the lamp's axis (direction in which it shines) and the direction in which light leaves.
//! Values are relative intensities: the lamp's intensity (W/sr or cd) multiplies them.

use crate::axial_table::AxialTable;
use crate::legendre;
use crate::phase::Deflection;
use crate::real::Real;

/// A distribution of light around an axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Emitter<T> {
    /// 1 in all directions.
    Isotropic,
    /// glTF cone (KHR_lights_punctual): 1 inside the inner cone, 0 outside the outer, a squared ramp in the cosine between.
    SpotCone {
        /// Cosine of the inner half angle.
        cos_inner: T,
        /// Cosine of the outer half angle, at most `cos_inner`.
        cos_outer: T,
    },
    /// max(0, cos)^n: nothing behind the lamp.
    CosinePower {
        /// Exponent n ≥ 0, any real number.
        exponent: T,
    },
    /// `Σ c_l P_l(cos)`, as it is: negative where the series is.
    Legendre(Vec<T>),
    /// Measured values over the angle from the axis; IES profiles become one by [`AxialTable::from_profile`].
    Table(AxialTable<T>),
}

impl<T: Real> Emitter<T> {
    /// Relative intensity towards `cos_axis`, clamped to [−1, 1].
    #[inline]
    pub fn eval(&self, cos_axis: T) -> T {
        let c = cos_axis.min(T::one()).max(-T::one());
        match self {
            Self::Isotropic => T::one(),
            Self::SpotCone { cos_inner, cos_outer } => spot_cone(*cos_inner, *cos_outer, c),
            Self::CosinePower { exponent } => cosine_power(*exponent, c),
            Self::Legendre(coefficients) => legendre::series(coefficients, c),
            Self::Table(table) => table.eval(Deflection::from_cos(c).angle()),
        }
    }

    /// Cosines, ascending, where the distribution or its derivative jumps: where quadrature must split.
    /// For a table its ends only, where light may stop short; its inner corners are as fine as the data.
    pub fn kinks(&self) -> Vec<T> {
        match self {
            Self::SpotCone { cos_inner, cos_outer } if cos_inner > cos_outer => vec![*cos_outer, *cos_inner],
            Self::SpotCone { cos_outer, .. } => vec![*cos_outer],
            Self::CosinePower { .. } => vec![T::zero()],
            Self::Isotropic | Self::Legendre(_) => Vec::new(),
            Self::Table(table) => {
                let ends = [table.angles()[table.angles().len() - 1], table.angles()[0]];
                ends.into_iter().filter(|&a| a > T::zero() && a < T::PI()).map(T::cos).collect()
            }
        }
    }

    /// Coefficients c_l of `Σ c_l P_l(cos)` for l < `bands`: the best approximation in mean square.
    pub fn legendre(&self, bands: usize) -> Vec<T> {
        let mut out = vec![T::zero(); bands];
        match self {
            Self::Isotropic => out.iter_mut().take(1).for_each(|c| *c = T::one()),
            Self::Legendre(c) => out.iter_mut().zip(c).for_each(|(out, &c)| *out = c),
            Self::CosinePower { exponent } => {
                legendre::half_range_moments(*exponent, &mut out);
                out.iter_mut().enumerate().for_each(|(l, c)| *c *= T::of(l as f64 + 0.5));
            }
            Self::Table(table) => return table.legendre(bands),
            Self::SpotCone { .. } => {
                let inside: Vec<T> = self.kinks().into_iter().filter(|k| k.abs() < T::one()).collect();
                return legendre::project(bands, bands + 3, &inside, |c| self.eval(c));
            }
        }
        out
    }

    /// The distribution as a series of `bands` Legendre terms, for methods that need one.
    pub fn to_legendre(&self, bands: usize) -> Self {
        Self::Legendre(self.legendre(bands))
    }

    /// Flux per unit intensity, sr: `2π ∫ I dcos`.
    pub fn flux(&self) -> T {
        self.legendre(1)[0] * T::of(4.0) * T::PI()
    }
}

/// Why a lamp's distribution was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("lamp parameter {field} is {value}; it must be {allowed}")]
pub struct EmitterError {
    /// Which parameter.
    pub field: &'static str,
    /// Its value.
    pub value: f64,
    /// The range, in words.
    pub allowed: &'static str,
}

impl<T: Real> Emitter<T> {
    /// Whether the parameters lie in their domain. A table has been checked when it was made.
    pub fn check(&self) -> Result<(), EmitterError> {
        let refuse = |field, value: T, allowed| Err(EmitterError { field, value: value.as_f64(), allowed });
        let cosines = -T::one()..=T::one();
        match self {
            Self::SpotCone { cos_inner, .. } if !cosines.contains(cos_inner) => {
                refuse("cos_inner", *cos_inner, "a cosine, from -1 to 1")
            }
            Self::SpotCone { cos_inner, cos_outer } if !(-T::one()..=*cos_inner).contains(cos_outer) => {
                refuse("cos_outer", *cos_outer, "a cosine, from -1 to cos_inner")
            }
            Self::CosinePower { exponent } if !(T::zero()..T::infinity()).contains(exponent) => {
                refuse("exponent", *exponent, "finite and at least 0")
            }
            Self::Legendre(terms) => match terms.iter().find(|c| !c.is_finite()) {
                Some(&c) => refuse("Legendre term", c, "finite"),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }
}

/// glTF spot cone: `clamp((c − cos_outer)/(cos_inner − cos_outer), 0, 1)²`; a step at `cos_outer` where both are equal.
#[inline]
pub fn spot_cone<T: Real>(cos_inner: T, cos_outer: T, cos_axis: T) -> T {
    let width = cos_inner - cos_outer;
    let ramp = if width > T::zero() {
        ((cos_axis - cos_outer) / width).min(T::one()).max(T::zero())
    } else if cos_axis >= cos_outer {
        T::one()
    } else {
        T::zero()
    };
    ramp * ramp
}

/// `max(0, c)^n`; n = 0 is 1 in front and 0 behind.
#[inline]
pub fn cosine_power<T: Real>(exponent: T, cos_axis: T) -> T {
    if cos_axis <= T::zero() { T::zero() } else { cos_axis.powf(exponent) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    fn all() -> Vec<(&'static str, Emitter<f64>)> {
        vec![
            ("isotropic", Emitter::Isotropic),
            ("cone", Emitter::SpotCone { cos_inner: 0.95, cos_outer: 0.7 }),
            ("step", Emitter::SpotCone { cos_inner: 0.7, cos_outer: 0.7 }),
            ("wide", Emitter::SpotCone { cos_inner: 1.0, cos_outer: -0.5 }),
            ("cosine", Emitter::CosinePower { exponent: 10.0 }),
            ("ball", Emitter::Legendre([vec![1.0], vec![0.0; 9], vec![1.0]].concat())),
            ("table", Emitter::Table(AxialTable::new(vec![0.0, 1.2], vec![3.0, 1.0]).expect("valid"))),
        ]
    }

    #[test]
    fn legendre_coefficients_agree_with_quadrature_split_at_the_kinks() {
        // A table linear in the angle has a square-root end in the cosine: the plain rule gives 1e-6 there.
        let mut worst = Worst::new("emitter Legendre coefficients (absolute)", 1e-13);
        let mut tables = Worst::new("tabulated emitter's coefficients (absolute)", 2e-6);
        for (name, emitter) in all() {
            let kinks: Vec<f64> = emitter.kinks().into_iter().filter(|k| k.abs() < 1.0).collect();
            let want = legendre::project(16, 200, &kinks, |c| emitter.eval(c));
            for (l, (got, want)) in emitter.legendre(16).iter().zip(&want).enumerate() {
                let worst = if name == "table" { &mut tables } else { &mut worst };
                worst.record((got - want).abs(), || format!("{name} l {l}"));
            }
        }
        worst.check();
        tables.check();
    }

    #[test]
    fn flux_of_known_lamps() {
        let pi = std::f64::consts::PI;
        // A step cone of half angle a sends 2π (1 − cos a); max(0, c)^n sends 2π/(n+1).
        assert!((Emitter::SpotCone { cos_inner: 0.7, cos_outer: 0.7 }.flux() - 2.0 * pi * 0.3).abs() < 1e-14);
        assert!((Emitter::CosinePower { exponent: 10.0 }.flux() - 2.0 * pi / 11.0).abs() < 1e-14);
        assert!((Emitter::<f64>::Isotropic.flux() - 4.0 * pi).abs() < 1e-14);
    }
}
