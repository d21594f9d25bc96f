//! Draws bake packages on wgpu: lightmaps, probes, and the air's light in real time, the same medium as in the bake.
//!
//! No window, no surface, no global state: [`Renderer`] takes a device, a queue and a target format and draws a [`Model`]
//! to any texture view. [`Headless`] opens a device where the host has none of its own.
//!
//! ```text
//! Package ── scene::SceneData ──► Model (on the device) ──► Renderer::draw ──► texture view
//!                                   variant::Variant: which effects a shader holds ──► shader::compose
//! ```
//!
//! Shaders lie in `shaders/*.wgsl`; what they share with Rust is generated ([`layout`]), and each formula names its twin in
//! `bake-optics`. Radiance is linear Rec.709 in cd/m² until the tone curve at the very end.

pub mod air;
pub mod camera;
mod difference;
pub mod error;
pub mod headless;
pub mod layout;
mod model;
pub mod palette;
mod passes;
mod pick;
mod picture;
pub mod prune;
mod renderer;
pub mod scene;
pub mod shader;
mod shadows;
pub mod sky;
mod timing;
pub mod variant;

pub use air::Method;
pub use camera::Camera;
pub use error::RuntimeError;
pub use headless::Headless;
pub use model::Model;
pub use pick::Hit;
pub use renderer::{Onto, Renderer, Settings, Show};
pub use scene::SceneData;
