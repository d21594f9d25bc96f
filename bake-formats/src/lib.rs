//! What is on disk: the bake package (manifest, lightmap pages, probe grids) and how it is read, written and verified.

pub mod baked_scene;
mod baked_scene_read;
pub mod diff;
pub mod error;
pub mod float_image;
pub mod glb;
pub mod manifest;
pub mod medium;
pub mod metrics;
pub mod package;
pub mod path_file;
pub mod sample;
pub mod table_file;
pub mod term;

pub use baked_scene::BakedScene;
pub use error::FormatError;
pub use manifest::Manifest;
pub use medium::MediumRecord;
pub use package::{Package, PackageWriter};
pub use term::Term;
