//! `bake reference`: the same bake by volumetric path tracing alone, unbiased: the truth that other modes are judged by.

use super::run;
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use crate::flags::rare;
use crate::input::{HELP_TEMPLATE, Input};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Example, with `bake diff room.bake out/truth` to follow (the settings file's `mode` does not count here):
  bake reference room.glb --quality high -o out/truth";

/// Flags of `bake reference`: those of `bake run` that go with walks.
#[derive(Debug, clap::Args)]
#[command(mut_arg("mode", |mode| mode.hide(true)))]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{}", rare(&["--keep-paths"])))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
    /// Folder of the package [default: SCENE-stem.bake beside the scene]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Bakes by walks.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let input = args.input.clone().by_walks()?;
    run::run(&run::Args { input, output: args.output.clone(), explain: false }, global)
}
