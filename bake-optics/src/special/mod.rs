//! Special functions of light transport, each scaled so that nothing over- or underflows where the result does not.
//!
//! Taken from kept crates where one has range and accuracy: erfcx (`errorfunctions`), K_1 (`spec_math`). Our own where none has:
//! the complex exponential integral (no crate for complex argument under our licences) and the Chapman function.

mod chapman;
mod elementary;
mod erfcx;
mod exponential_integral;
pub mod shader;

pub use chapman::{chapman, chapman_horizontal, chapman_large_z, chapman_parts, ln_chapman};
pub use elementary::{lam, phi1};
pub use erfcx::erfcx;
pub use exponential_integral::{e1, scaled_exponential_integral, scaled_exponential_integrals};
pub use num_complex::Complex;
