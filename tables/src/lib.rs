//! Impulse-response tables: compute, map, store, look up.

pub mod area;
pub mod axial;
pub mod curves;
pub mod directional;
pub mod point;
pub mod transport;
