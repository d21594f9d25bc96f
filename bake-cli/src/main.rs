//! The `bake` program: flags, progress, reports, exit codes; nothing numeric.
//!
//! `cli` says what can be asked, `commands` does it (one file per command), `exit` turns its end into a process
//! status and is the only place that prints errors.

#![allow(dead_code, reason = "the pieces that only a finished `bake run` uses")]

mod cli;
mod commands;
mod exit;
mod flags;
mod input;
mod interrupt;
mod progress;
mod report;
mod values;

use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::parse() {
        Ok(cli) => exit::conclude(commands::dispatch(&cli), &cli.global),
        Err(usage) => usage.conclude(),
    }
}
