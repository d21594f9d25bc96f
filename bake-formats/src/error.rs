//! What can be wrong with files: every variant names the file, the object or field in it, and the next step.

use std::io;
use std::path::{Path, PathBuf};

/// An error of reading or writing a bake's files.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The operating system refused.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried: "read"; everything else is writing.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// The folder holds no manifest.
    #[error("{}: no bake package here (no file NAME.bake.json); make one with `bake run SCENE -o DIR`", folder.display())]
    NoPackage {
        /// The folder looked into.
        folder: PathBuf,
    },
    /// A scene was named where a package belongs.
    #[error("{0} is a scene and no package: bake it with `bake run {0}`, or name the folder that it was baked to, like {1}", scene.display(), scene.with_extension("bake").display())]
    Scene {
        /// Its file.
        scene: PathBuf,
    },
    /// The folder holds a package of another name, or several.
    #[error("{}: the folder holds the package '{found}' already; one package a folder: choose another with -o", folder.display())]
    FolderTaken {
        /// The folder.
        folder: PathBuf,
        /// Name or names found there.
        found: String,
    },
    /// The file is not of the kind that it was opened as.
    #[error("{}: {field} is {value}, not {expected}: written by another program?", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What was looked at.
        field: &'static str,
        /// What stood there.
        value: String,
        /// What should have stood there.
        expected: String,
    },
    /// The file's version is not the one this program reads.
    #[error("{}: format version {found}, this program reads {supported}: {}", path.display(), if found > supported { "update `bake`" } else { "bake again" })]
    Version {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: u32,
        /// Version understood.
        supported: u32,
    },
    /// A file is not the one that the manifest was written for.
    #[error("{}: stale package: {reason}; bake again", path.display())]
    Stale {
        /// The file that does not match.
        path: PathBuf,
        /// In which way.
        reason: String,
    },
    /// A field holds a value that cannot be used.
    #[error("{}: {field} is {value}, expected {expected}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Field, with the object that it belongs to.
        field: String,
        /// The value found.
        value: String,
        /// Allowed values, and the next step where it is not plain.
        expected: String,
    },
    /// The bytes do not form a file of their format.
    #[error("{}: damaged {format} file: {reason}; bake again, or copy the file again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Format by name.
        format: &'static str,
        /// What the reader stumbled over.
        reason: String,
    },
}

/// Result of reading or writing.
pub type Result<T> = std::result::Result<T, FormatError>;

impl FormatError {
    /// Wraps an input/output error; for `map_err`.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io { action, path: path.to_owned(), source }
    }

    /// A damaged file; for `map_err`.
    pub fn damaged(format: &'static str, path: &Path, reason: impl ToString) -> Self {
        Self::Damaged { path: path.to_owned(), format, reason: reason.to_string() }
    }

    /// A field whose value cannot be used.
    pub fn invalid(path: &Path, field: impl Into<String>, value: impl ToString, expected: impl Into<String>) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            field: field.into(),
            value: value.to_string(),
            expected: expected.into(),
        }
    }
}
