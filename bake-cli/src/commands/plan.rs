//! `bake plan`: what a bake would do, and its sizes, memory and time; nothing is traced.

use super::later;
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use std::path::PathBuf;

/// Flags of `bake plan`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene: a .glb or .gltf file
    pub scene: PathBuf,
}

/// Plans.
pub fn run(_args: &Args, _global: &Global) -> Result<Outcome, Failure> {
    Err(later::refuse("the command `plan`"))
}
