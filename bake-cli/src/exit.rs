//! How a command ends, as an exit code; the only place that prints errors.

use crate::cli::Global;
use crate::console;
use bake_core::settings::{SettingsError, Syntax};
use miette::{Diagnostic, LabeledSpan, NamedSource, Report, SourceCode};
use std::error::Error;
use std::fmt;
use std::io;
use std::path::Path;
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
    /// Ctrl-C on work that can go on later, told in words: exit code 130.
    Paused(String),
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

    /// A file that cannot be read.
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        Self::wrong(format!("cannot read {}: {error}", path.display()), "check the path and its permissions")
    }

    /// A file or folder that cannot be written, and that `-o` moves.
    pub fn unwritable(path: &Path, error: io::Error) -> Self {
        Self::unwritable_so(path, error, "choose another place with `-o`")
    }

    /// A file or folder that cannot be written, with the way to another place.
    pub fn unwritable_so(path: &Path, error: io::Error, way_out: &str) -> Self {
        use io::ErrorKind::{AlreadyExists, NotADirectory, NotFound, PermissionDenied, QuotaExceeded, StorageFull};
        let (reason, help) = match error.kind() {
            NotFound => ("its folder does not exist".to_owned(), format!("make the folder, or {way_out}")),
            AlreadyExists | NotADirectory => {
                (format!("a file stands where a folder belongs ({error})"), way_out.into())
            }
            PermissionDenied => (error.to_string(), format!("{way_out}, or check the folder's permissions")),
            StorageFull | QuotaExceeded => (error.to_string(), format!("make room, or {way_out}")),
            _ => (error.to_string(), way_out.into()),
        };
        let text = format!("cannot write {}: {reason}", path.display());
        Self::Failed(Message { text, help: Some(help), cause: None }.into())
    }

    /// Its exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::Failed(_) => FAILED,
            Self::Invalid(_) => INVALID,
            Self::Interrupted | Self::Paused(_) => INTERRUPTED,
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

impl From<SettingsError> for Failure {
    fn from(error: SettingsError) -> Self {
        match error {
            SettingsError::Syntax(fault) => Self::Invalid(Excerpt::new(*fault).into()),
            SettingsError::Unreadable { file, source } => Self::wrong(
                format!("cannot read the settings file {}: {source}", file.display()),
                "check the path; `bake init SCENE` writes a file to start from",
            ),
            other => Self::invalid(other),
        }
    }
}

/// A fault in a text file, shown with the lines around it.
#[derive(Debug)]
struct Excerpt {
    fault: Syntax,
    source: NamedSource<String>,
}

impl Excerpt {
    fn new(fault: Syntax) -> Self {
        Self { source: NamedSource::new(fault.file.to_string_lossy(), fault.text.clone()), fault }
    }
}

impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Syntax { file, line, column, message, .. } = &self.fault;
        write!(f, "{}:{line}:{column}: {message}", file.display())
    }
}

impl Error for Excerpt {}

impl Diagnostic for Excerpt {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.fault.hint.as_ref().map(|hint| Box::new(hint) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(None, self.fault.span.clone()))))
    }
}

/// Turns a command's end into the exit code, telling of a failure on standard error.
pub fn conclude(result: Result<Outcome, Failure>, global: &Global) -> ExitCode {
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::DoneWithGaps) => ExitCode::from(GAPS),
        Err(Failure::Interrupted | Failure::Paused(_)) if global.quiet => ExitCode::from(INTERRUPTED),
        Err(failure) => report(&failure),
    }
}

/// Prints a failure on standard error and gives its exit code.
fn report(failure: &Failure) -> ExitCode {
    match failure {
        Failure::Failed(report) | Failure::Invalid(report) => console::tell(&format!("{report:?}")),
        Failure::Interrupted => console::tell("interrupted; nothing was written"),
        Failure::Paused(what) => console::tell(&format!("interrupted; {what}")),
    }
    ExitCode::from(failure.code())
}
