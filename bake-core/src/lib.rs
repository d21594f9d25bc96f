//! The bake: from a checked scene to light on texels and probes.
//!
//! Data flows one way: [`scene`] (everything invalid is refused there) → [`atlas`] (texels and their surface points)
//! → [`solve`] (light, through [`trace`]) → [`post`] (seams, dilation) → a package of `bake-formats`.
//! The crate is silent: progress and warnings leave as values; it knows no command line, window or GPU.

pub mod air;
pub mod atlas;
pub mod explain;
pub mod fingerprint;
pub mod job;
pub mod package;
pub mod plan;
pub mod post;
pub mod progress;
pub mod scene;
pub mod settings;
pub mod solve;
pub mod trace;

#[cfg(test)]
mod test_scenes;
