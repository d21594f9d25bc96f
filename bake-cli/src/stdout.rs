//! The result of a command on standard output. A reader who has seen enough, as `| head` has, is no fault.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};

/// Prints what [`format_args`] makes.
pub fn print(text: Arguments) {
    if let Err(error) = stdout().lock().write_fmt(text)
        && error.kind() != ErrorKind::BrokenPipe
    {
        eprintln!("standard output: {error}");
    }
}
