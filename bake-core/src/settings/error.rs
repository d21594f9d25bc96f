//! What can be wrong with settings, and the way out.

use ron::error::{Error as RonError, SpannedError};
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Settings that cannot be used.
#[derive(Debug, Error)]
pub enum SettingsError {
    /// The file cannot be read.
    #[error("cannot read the settings file {file}")]
    Unreadable {
        /// Its path.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The text is no settings record.
    #[error(transparent)]
    Syntax(Box<Syntax>),
    /// A value outside its range.
    #[error("setting `{key}` is {value}; allowed is {allowed}")]
    OutOfRange {
        /// Key, with the path to it: `sun.lux`.
        key: String,
        /// The value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// What a setting asks for would not fit.
    #[error("setting `{key}` would write about {} GB; at most {} GB are written: {way_out}", bytes / 1_000_000_000, most / 1_000_000_000)]
    TooLarge {
        /// The setting.
        key: &'static str,
        /// About what it takes.
        bytes: u64,
        /// What is allowed.
        most: u64,
        /// The next step.
        way_out: &'static str,
    },
    /// `extras.bake_media` of the scene file is no list of media.
    #[error(
        "the scene's extras: `bake_media{at}` is no medium as a settings file has it: {source}; correct it or state `media` in the settings"
    )]
    Extras {
        /// Path to the place.
        at: String,
        /// What is wrong there.
        source: serde_json::Error,
    },
}

/// A fault in the text of a settings file.
#[derive(Debug, Error)]
#[error("{}:{line}:{column}: {message}{}", file.display(), hint.as_deref().map(|hint| format!("; {hint}")).unwrap_or_default())]
pub struct Syntax {
    /// The file.
    pub file: PathBuf,
    /// Its text.
    pub text: String,
    /// Bytes of the text that are wrong.
    pub span: Range<usize>,
    /// Line, counted from 1.
    pub line: usize,
    /// Character in the line, counted from 1.
    pub column: usize,
    /// What is wrong.
    pub message: String,
    /// The next step, where one can be named.
    pub hint: Option<String>,
}

impl Syntax {
    pub(super) fn new(file: &Path, text: String, error: &SpannedError) -> Self {
        let (message, hint) = explain(&error.code);
        let (start, end) = (error.span.start, error.span.end);
        let from = byte_of(&text, start.line, start.col);
        let to = byte_of(&text, end.line, end.col).max(from);
        Self { file: file.to_owned(), text, span: from..to, line: start.line, column: start.col, message, hint }
    }
}

/// Byte position of a line and column, both counted from 1; the end of the text where they lie beyond it.
fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let line_start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let in_line: usize = text[line_start..].chars().take(column.saturating_sub(1)).map(char::len_utf8).sum();
    line_start + in_line
}

/// The fault in our words, and the way out.
fn explain(error: &RonError) -> (String, Option<String>) {
    let init = "`bake init SCENE` writes a file that shows every key with its form";
    let belongs = |what: &str, example: &str| (format!("{what} belongs here"), Some(format!("like {example}; {init}")));
    match error {
        RonError::NoSuchStructField { expected, found, .. } => {
            (format!("unknown key `{found}`"), Some(suggest(found, expected)))
        }
        RonError::NoSuchEnumVariant { expected, found, .. } => {
            (format!("unknown value `{found}`"), Some(suggest(found, expected)))
        }
        RonError::MissingStructField { field, outer } => {
            let place = outer.as_deref().map(|outer| format!(" in `{outer}(…)`")).unwrap_or_default();
            (format!("the key `{field}` is missing{place}"), Some(init.into()))
        }
        RonError::ExpectedDifferentStructName { expected, found } => {
            (format!("found `{found}` where `{expected}(…)` belongs"), Some(init.into()))
        }
        RonError::ExpectedInteger => belongs("a whole number", "16"),
        RonError::ExpectedFloat => belongs("a number", "0.5"),
        RonError::ExpectedBoolean => belongs("true or false", "true"),
        RonError::ExpectedString => belongs("text", "\"lamp.ies\""),
        RonError::ExpectedNamedStructLike(name) if !name.is_empty() => {
            belongs("a record", &format!("`{name}(key: value, …)`"))
        }
        RonError::Eof => ("the file ends too early".into(), Some("a settings file reads `Bake(key: value, …)`".into())),
        other => (other.to_string(), Some(init.into())),
    }
}

/// "did you mean" the nearest name where one is near, otherwise all of them.
pub fn suggest(found: &str, expected: &[&str]) -> String {
    /// Similarity from which a name counts as meant; the value that clap uses for flags is 0.7.
    const NEAR: f64 = 0.7;
    let lower = found.to_lowercase();
    let nearest = expected
        .iter()
        .map(|name| (strsim::jaro_winkler(&lower, &name.to_lowercase()), name))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        Some((similarity, name)) if similarity > NEAR => format!("did you mean `{name}`?"),
        _ => format!("known are {}", expected.join(", ")),
    }
}
