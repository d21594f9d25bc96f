//! The deterministic integrals behind every table, in f64: no file, no look-up, no Monte Carlo.
//!
//! Canonical medium throughout: sigma_t = sigma_s = 1, so distances are optical; intensity 1 W/sr or irradiance 1 W/m².

pub mod fluence;
pub mod harmonics;
pub mod phase_basis;
pub mod profile;
pub mod slab;
pub mod sources;
pub mod triangle;
