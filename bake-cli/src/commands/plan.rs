//! `bake plan`: what a bake would do, and its sizes, memory and time; nothing is traced.

use super::later;
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use crate::flags::RARE;
use crate::input::{HELP_TEMPLATE, Input};

const EXAMPLES: &str = "\
Example:
  bake plan room.glb --quality final --page-size 2048";

/// Flags of `bake plan`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{RARE}"))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
}

/// Plans.
pub fn run(args: &Args, _global: &Global) -> Result<Outcome, Failure> {
    let _settings = args.input.settings()?;
    Err(later::refuse("the command `plan`"))
}
