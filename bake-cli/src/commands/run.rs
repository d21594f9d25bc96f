//! `bake run`: the main job, from a scene file to a package on disk.

use super::later;
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use std::path::PathBuf;

/// Flags of `bake run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene: a .glb or .gltf file
    pub scene: PathBuf,
    /// Folder of the package [default: SCENE-stem.bake beside the scene]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Bakes.
pub fn run(_args: &Args, _global: &Global) -> Result<Outcome, Failure> {
    Err(later::refuse("the command `run`"))
}
