//! Analytic media: optical depth, transmittance and free paths in closed form (Golubev 2018), and sums of them.
//!
//! *Kernels* ([`uniform`], [`linear`], [`exponential`], [`planet`]) are functions of plain numbers in f32 or f64 whose
//! result is an *optical length*: the integral of the density along a ray, metres at density 1. Multiplied by sigma_t
//! it is the optical depth. *Records* ([`Medium`], [`MediumSet`]) place densities in the world. They work in f64, because
//! a ray over a planet needs metres out of 6.4 million; the shaders' f32 twins call the same kernels relative to the planet.
//!
//! Axes are glTF's: Y up, height = y. `cos_theta` is that of the direction of travel against up.
//! Nothing here knows about light; see [`crate::airlight`].

pub mod bounds;
pub mod density;
pub mod exponential;
pub mod grid;
pub mod invert;
pub mod linear;
pub mod majorant;
pub mod mesh;
pub mod planet;
mod ray;
mod set;
pub mod transmittance;
pub mod uniform;
pub mod walk;

pub use bounds::Bounds;
pub use density::Density;
pub use ray::Ray;
pub use set::{Medium, MediumSet, Scatter};
