//! How a command ends, as an exit code; the only place that prints errors.

use crate::cli::Global;
use miette::{Diagnostic, Report};
use std::error::Error;
use std::fmt;
use std::process::ExitCode;

/// Something went wrong that the input is not to blame for.
pub const FAILED: u8 = 1;
/// Wrong usage or invalid input.
pub const INVALID: u8 = 2;
/// Done, but some texels could not be baked.
pub const GAPS: u8 = 3;
/// Stopped by Ctrl-C.
pub const INTERRUPTED: u8 = 130;

/// A command that came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// All of it.
    Done,
    /// All of it but for texels that could not be baked.
    DoneWithGaps,
}

/// A command that did not.
#[derive(Debug)]
pub enum Failure {
    /// The machine, the disk or the program: exit code 1.
    Failed(Report),
    /// The command line, the scene or the settings: exit code 2.
    Invalid(Report),
    /// Ctrl-C: exit code 130.
    Interrupted,
}

impl Failure {
    /// A failure that the input is not to blame for.
    pub fn failed(error: impl Error + Send + Sync + 'static) -> Self {
        Self::Failed(Message::from_error(&error).into())
    }

    /// Invalid input.
    pub fn invalid(error: impl Error + Send + Sync + 'static) -> Self {
        Self::Invalid(Message::from_error(&error).into())
    }

    /// Invalid input, told in words with the next step.
    pub fn wrong(text: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Invalid(Message { text: text.into(), help: Some(help.into()), cause: None }.into())
    }

    /// Its exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::Failed(_) => FAILED,
            Self::Invalid(_) => INVALID,
            Self::Interrupted => INTERRUPTED,
        }
    }
}

/// An error in words: what, why, and the next step.
#[derive(Debug)]
struct Message {
    text: String,
    cause: Option<Box<Message>>,
    help: Option<String>,
}

impl Message {
    /// Copies the chain of an error, leaving out causes that their parent already tells.
    fn from_error(error: &dyn Error) -> Self {
        let text = error.to_string();
        let mut source = error.source();
        while source.is_some_and(|cause| text.contains(&cause.to_string())) {
            source = source.and_then(Error::source);
        }
        Self { text, cause: source.map(|cause| Box::new(Self::from_error(cause))), help: None }
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Error for Message {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

impl Diagnostic for Message {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as _)
    }
}

/// Turns a command's end into the exit code, telling of a failure on standard error.
pub fn conclude(result: Result<Outcome, Failure>, global: &Global) -> ExitCode {
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::DoneWithGaps) => ExitCode::from(GAPS),
        Err(Failure::Interrupted) if global.quiet => ExitCode::from(INTERRUPTED),
        Err(failure) => report(&failure),
    }
}

/// Prints a failure on standard error and gives its exit code.
pub fn report(failure: &Failure) -> ExitCode {
    match failure {
        Failure::Failed(report) | Failure::Invalid(report) => eprintln!("{report:?}"),
        Failure::Interrupted => eprintln!("interrupted; nothing was written"),
    }
    ExitCode::from(failure.code())
}
