//! `bake init`: a commented settings file beside a scene.

use super::later;
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use std::path::PathBuf;

/// Flags of `bake init`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene: a .glb or .gltf file
    pub scene: PathBuf,
}

/// Writes the file.
pub fn run(_args: &Args, _global: &Global) -> Result<Outcome, Failure> {
    Err(later::refuse("the command `init`"))
}
