//! The `bake` program: flags, progress, reports, exit codes; nothing numeric.
//!
//! `cli` says what can be asked, `commands` does it (one file per command), `exit` turns its end into a process
//! status and is the only place that prints errors, `console` is all printing's way out.

// Both panic where the reader is gone; `console` does not.
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod cli;
mod commands;
mod console;
mod exit;
mod explain_text;
mod flags;
mod html;
mod input;
mod interrupt;
mod job;
mod output;
mod plan_text;
mod progress;
mod report;
mod units;
mod values;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::Cli::try_parse() {
        Ok(cli) => exit::conclude(commands::dispatch(&cli), &cli.global),
        Err(error) => cli::conclude(&error),
    }
}
