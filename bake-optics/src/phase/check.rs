//! Refusing parameters outside a phase function's domain, by name and value, before anything divides by them.

use super::Phase;
use crate::real::Real;

/// Why a phase function was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PhaseError {
    /// A parameter outside its range.
    #[error("phase function parameter {field} is {value}; it must lie {allowed}")]
    Parameter {
        /// `a1` or `g`.
        field: &'static str,
        /// The value.
        value: f64,
        /// The range, in words.
        allowed: &'static str,
    },
    /// A series that is not normalised or has an impossible moment.
    #[error("phase function Legendre term a_{index} is {value}; {allowed}")]
    Term {
        /// Degree.
        index: usize,
        /// The value.
        value: f64,
        /// The rule, in words.
        allowed: &'static str,
    },
}

impl<T: Real> Phase<T> {
    /// Whether the parameters lie in their domain; what passes here is evaluated and drawn without NaN.
    ///
    /// A series may still be negative somewhere, as a truncated peak is. A table has been checked when it was made.
    pub fn check(&self) -> Result<(), PhaseError> {
        let refuse = |field, value: T, allowed| Err(PhaseError::Parameter { field, value: value.as_f64(), allowed });
        let (zero, one) = (T::zero(), T::one());
        match self {
            Self::Linear { a1 } if !(zero..=one).contains(&a1.abs()) => refuse("a1", *a1, "from -1 to 1"),
            Self::HenyeyGreenstein { g } if !(zero..one).contains(&g.abs()) => {
                refuse("g", *g, "between -1 and 1, ends excluded")
            }
            Self::Legendre(terms) => check_terms(terms),
            _ => Ok(()),
        }
    }
}

fn check_terms<T: Real>(terms: &[T]) -> Result<(), PhaseError> {
    let refuse = |index, value, allowed| Err(PhaseError::Term { index, value, allowed });
    let first = terms.first().map_or(0.0, |a| a.as_f64());
    if !(1.0 - 1e-6..=1.0 + 1e-6).contains(&first) {
        return refuse(0, first, "it must be 1, so that the phase function integrates to 1");
    }
    let impossible = |(l, a): &(usize, &T)| !(0.0..=(2 * l + 1) as f64 * (1.0 + 1e-6)).contains(&a.as_f64().abs());
    match terms.iter().enumerate().find(impossible) {
        Some((l, a)) => refuse(l, a.as_f64(), "it must lie from -(2l+1) to 2l+1: its moment is a mean of P_l"),
        None => Ok(()),
    }
}
