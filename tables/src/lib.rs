//! Impulse-response tables: what a point light, a directional light and a small surface element send to a receiver through
//! scattering in air. Made once by quadrature, shipped with the program, remapped to any medium.
//!
//! Each emitter has its file with four functions in this order: compute, map, store, look up. [`set::TableSet`] holds them
//! together and prepares a [`response`] for a medium.

pub mod accuracy;
mod angles;
pub mod area;
pub mod axial;
pub mod curves;
pub mod directional;
pub mod drawing;
pub mod fitted;
pub mod generate;
pub mod geometry;
mod lanes;
mod node;
pub mod point;
mod prepare;
pub mod recipe;
pub mod remap;
pub mod resample;
pub mod response;
pub mod rgb;
mod series;
pub mod set;
pub mod transport;

pub use generate::generate;
pub use geometry::Geometry;
pub use recipe::{Layout, Recipe};
pub use remap::{Air, RayAir};
pub use response::{AxialResponse, ZonalResponse};
pub use rgb::{AxialRgb, ZonalRgb};
pub use series::{SERIES_DEGREES, cosine_legendre};
pub use set::{Scatter, TableSet};
