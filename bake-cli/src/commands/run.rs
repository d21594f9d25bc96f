//! `bake run`: the main job, from a scene file to a package on disk.

use super::later;
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use crate::flags::RARE;
use crate::input::{HELP_TEMPLATE, Input};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  bake run room.glb --quality preview -o out/room
  bake run room.glb --sky 1000 --sun azimuth_deg=120,elevation_deg=35,lux=80000";

/// Flags of `bake run`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{RARE}"))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
    /// Folder of the package [default: SCENE-stem.bake beside the scene]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Bakes.
pub fn run(args: &Args, _global: &Global) -> Result<Outcome, Failure> {
    let _settings = args.input.settings()?;
    Err(later::refuse("the command `run`"))
}
