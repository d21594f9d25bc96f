//! Air-light: light of a point lamp scattered exactly once towards the eye along a view ray.
//!
//! ```text
//! L = I0 ∫_0^length σ_s(s) Φ(μ) I(c) e^{−τ(eye → s) − τ(s → lamp)} / r² ds
//! ```
//!
//! One trait, [`Airlight`], so that methods can be swapped and compared; what a method asks of the air and of the lamp
//! is in its `impl`: only [`Quadrature`], [`RayMarch`] and [`Oracle`] take air that varies.
//!
//! | method | air | phase, lamp | use |
//! | --- | --- | --- | --- |
//! | [`Vacuum`] | uniform, extinction left out | any | very thin air; bounds |
//! | [`Lut`] | uniform | Legendre phase, isotropic lamp | shaders in the manner of 2005 |
//! | [`ClosedForm`] | uniform | piecewise polynomial | cross-check |
//! | [`Quadrature`] | any analytic | any | **the one to use** |
//! | [`RayMarch`] | any analytic | any | baseline |
//! | [`Oracle`] | any analytic | any | truth in tests |
//!
//! What each costs and how far it errs is measured in `docs/airlight.md`.
//! Radiance is per unit intensity of the lamp. A ray that meets a point lamp itself has infinite air-light (1/r²): give
//! lamps a radius and keep `h` at least that.

mod air;
mod borders;
mod closed_form;
mod lut;
pub mod macklin;
mod oracle;
mod panels;
pub mod pegoraro;
mod quadrature;
mod ray_march;
mod sight;
pub mod sun;
mod vacuum;
pub mod wide;

pub use air::{Air, MediumAlong, UniformAir};
pub use closed_form::ClosedForm;
pub use lut::Lut;
pub use oracle::Oracle;
pub use quadrature::Quadrature;
pub use ray_march::RayMarch;
pub use sight::{PathPoint, Sight};
pub use vacuum::Vacuum;

use smallvec::{SmallVec, smallvec};

use crate::Real;
use crate::emitter::Emitter;

/// A method for the air-light of lamps `E` in air `A`.
pub trait Airlight<T: Real, A: ?Sized, E: Lamp<T> = Emitter<T>> {
    /// Radiance scattered once towards the eye, per unit intensity of the lamp (1/m² for intensities in W/sr).
    fn radiance(&self, sight: &Sight<T>, lamp: &E, air: &A) -> T;
}

/// How a lamp spreads light around its axis.
pub trait Lamp<T: Real> {
    /// Relative intensity towards the cosine from the axis.
    fn intensity(&self, cos_axis: T) -> T;
    /// Cosines where it or its derivative jumps, and beyond which it may be dark.
    fn jumps(&self) -> SmallVec<[T; 2]>;
}

impl<T: Real> Lamp<T> for Emitter<T> {
    #[inline]
    fn intensity(&self, cos_axis: T) -> T {
        self.eval(cos_axis)
    }

    fn jumps(&self) -> SmallVec<[T; 2]> {
        match self {
            Self::Isotropic => SmallVec::new(),
            Self::CosinePower { .. } => smallvec![T::zero()],
            _ => self.kinks().into_iter().collect(),
        }
    }
}

/// The lamp that shines alike in all directions; methods that know no other take this type.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IsotropicLamp;

impl<T: Real> Lamp<T> for IsotropicLamp {
    #[inline]
    fn intensity(&self, _: T) -> T {
        T::one()
    }

    fn jumps(&self) -> SmallVec<[T; 2]> {
        SmallVec::new()
    }
}
