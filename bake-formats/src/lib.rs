//! What is on disk: the bake package (manifest, lightmap pages, probe grids) and how it is read, written and verified.

pub mod term;

pub use term::Term;
