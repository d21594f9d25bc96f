//! What accuracy costs: a scene is baked at many settings, each result is compared with a converged reference, and a
//! page of plots shows error against seconds.
//!
//! [`sweep`] says which settings are baked: [`point`]s, as many as the [`effort`] allows; [`measure`] bakes one of them, [`store`] keeps every measured
//! point at once, so that an interrupted study goes on where it was, [`pareto`] finds what is worth its time and [`reach`] when an error is reached,
//! [`report`] writes the page with [`plot`] and [`thumbnails`]; [`study`] runs all of it. [`effects`] checks the plan's
//! choices, [`stability`] shows where numbers keep their digits.
//!
//! Errors are those of [`bake_formats::metrics`], over baked texels before seams are stitched, on pages that are made
//! small unless the study is thorough.

pub mod clock;
pub mod effects;
pub mod effort;
pub mod error;
pub mod measure;
pub mod pareto;
pub mod plot;
pub mod point;
pub mod ratio;
pub mod reach;
pub mod report;
pub mod stability;
pub mod store;
pub mod study;
pub mod summary;
pub mod sweep;
pub mod thumbnails;

pub use error::StudyError;
pub use study::{Study, run};
