//! One file per command. Each has its flags as `Args` and does its work in
//! `run(&Args, &Global) -> Result<Outcome, Failure>`; a new command adds its file, a variant of `cli::Command` and a
//! line of `dispatch`.

pub mod diff;
pub mod init;
pub mod plan;
pub mod reference;
pub mod refog;
pub mod run;
pub mod sample;
pub mod study;
pub mod tables;
#[cfg(feature = "view")]
pub mod view;

use crate::cli::{Cli, Command};
use crate::exit::{Failure, Outcome};

/// Runs the command that was asked for.
pub fn dispatch(cli: &Cli) -> Result<Outcome, Failure> {
    if let Some(threads) = cli.global.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(Failure::failed)?;
    }
    match &cli.command {
        Command::Run(args) => run::run(args, &cli.global),
        Command::Reference(args) => reference::run(args, &cli.global),
        Command::Refog(args) => refog::run(args, &cli.global),
        Command::Plan(args) => plan::run(args, &cli.global),
        Command::Init(args) => init::run(args, &cli.global),
        Command::Tables(args) => tables::run(args, &cli.global),
        Command::Diff(args) => diff::run(args, &cli.global),
        Command::Study(args) => study::run(args, &cli.global),
        Command::Sample(args) => sample::run(args, &cli.global),
        #[cfg(feature = "view")]
        Command::View(args) => view::run(args, &cli.global),
    }
}
