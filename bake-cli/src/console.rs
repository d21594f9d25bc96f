//! All that the program prints. A reader who closes the pipe (`bake tables inspect | head`) has seen enough: that is no
//! failure of the command, whose work and exit code stay what they are.

use crate::exit::Failure;
use std::io::{self, ErrorKind, Write};

/// Writes to standard output.
///
/// # Errors
/// What the system says, where the reader is not simply gone: a full disk behind `>`, for instance.
pub fn print(text: &str) -> Result<(), Failure> {
    write_to(io::stdout().lock(), text).map_err(Failure::failed)
}

/// The same with the end of a line.
///
/// # Errors
/// As [`print`].
pub fn print_line(text: &str) -> Result<(), Failure> {
    print(&format!("{text}\n"))
}

/// Writes a line on standard error. Nobody can be told where that fails.
pub fn tell(text: &str) {
    let _ = write_to(io::stderr().lock(), &format!("{text}\n"));
}

fn write_to(mut out: impl Write, text: &str) -> io::Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}
