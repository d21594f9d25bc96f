//! Formulas of light in air: special functions, phase functions, media, air-light, harmonics. No I/O, threads or logging.
//!
//! Every formula is one generic source over [`Real`]: `f64` is the oracle, `f32` what bakes and shaders use.

pub mod airlight;
pub mod axial_table;
pub mod emitter;
pub mod harmonics;
pub mod legendre;
pub mod medium;
pub mod phase;
pub mod psf;
pub mod quadrature;
pub mod real;
pub mod special;
pub mod surface;

pub use real::Real;
