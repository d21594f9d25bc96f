//! What is on disk: the bake package (manifest, lightmap pages, probe grids) and how it is read, written and verified.

pub mod error;
pub mod float_image;
pub mod manifest;
pub mod package;
pub mod term;

pub use error::FormatError;
pub use manifest::Manifest;
pub use package::{Package, PackageWriter};
pub use term::Term;
