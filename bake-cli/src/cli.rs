//! What can be asked of the program: the commands and the flags that all of them share.
//!
//! A flag has one place that holds its name, help, default and unit: here when every command takes it, otherwise in
//! the `Args` of its command's file.

use crate::commands;
use crate::exit;
use crate::progress::ProgressMode;
use clap::error::ErrorKind;
use clap::{ArgAction, Args, Parser, Subcommand};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  bake run room.glb                          bake to room.bake/ beside the scene
  bake run room.glb --quality preview -o out/room
  bake reference room.glb -o out/truth       the same by walks alone, unbiased, slower
  bake plan room.glb                         sizes, memory and time; traces nothing
  bake init room.glb                         write room.bake.ron, every setting explained
  bake diff out/a out/b                      compare two packages

A bar shows progress on a terminal; `--progress json` writes lines for machines, `--progress none` nothing.
Exit codes: 0 done, 1 failed, 2 wrong usage or invalid input, 3 done but some texels could not be baked,
130 interrupted.";

/// Bakes the light of glTF scenes into lightmaps.
#[derive(Debug, Parser)]
#[command(name = "bake", version, about, after_help = EXAMPLES, max_term_width = 110, arg_required_else_help = true)]
#[command(disable_help_subcommand = true, disable_help_flag = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Flags of every command.
    #[command(flatten)]
    pub global: Global,
}

/// Flags of every command.
#[derive(Debug, Clone, Args)]
pub struct Global {
    /// Print the result as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Threads to use [default: one per processor]; the result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// How to show progress on standard error
    #[arg(long, global = true, value_name = "HOW", default_value = "auto", hide = true)]
    pub progress: ProgressMode,
    /// Say more
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Say nothing but errors and the result
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Print this help; after a command, the command's
    #[arg(short, long, global = true, action = ArgAction::HelpShort)]
    help: Option<bool>,
}

/// The commands. A variant's `Args` and `run` live in the file of its name under `commands`.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Bake a scene: plan, trace, write a package
    Run(Box<commands::run::Args>),
    /// Bake a scene by volumetric path tracing alone: the unbiased truth
    Reference(Box<commands::reference::Args>),
    /// Other air for a bake made with --keep-paths, without tracing it again
    Refog(Box<commands::refog::Args>),
    /// Say what would be baked, and its sizes, memory and time; trace nothing
    Plan(Box<commands::plan::Args>),
    /// Write a commented settings file for a scene
    Init(commands::init::Args),
    /// Make, show and check the tables that fog is baked with
    Tables(commands::tables::Args),
    /// Look up baked light at points in space
    Sample(commands::sample::Args),
    /// Compare two packages: bias, relative RMSE, worst texels, by term
    Diff(commands::diff::Args),
    /// Show what accuracy costs in time: a report of many bakes of one scene
    Study(Box<commands::study::Args>),
    /// Show what was baked
    #[cfg(feature = "view")]
    View(Box<commands::view::Args>),
}

/// Prints what clap has to say, and gives the exit code: 0 for help and version that were asked for, else 2.
pub fn conclude(error: &clap::Error) -> ExitCode {
    // A closed standard output is no failure.
    let _ = error.print();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => ExitCode::SUCCESS,
        _ => ExitCode::from(exit::INVALID),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn no_two_flags_collide() {
        Cli::command().debug_assert();
    }
}
