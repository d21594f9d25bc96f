//! Why a study ends early.

use bake_core::job::JobError;
use bake_core::progress::Interrupted;
use bake_core::settings::SettingsError;
use bake_formats::FormatError;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A study that did not come to its end; what was measured is kept.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The scene, its settings, its air or its layout.
    #[error(transparent)]
    Job(JobError),
    /// Stopped from outside.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A file that was written before cannot be read, or one cannot be written.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A file or folder of the study.
    #[error("{}: {source}", path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The table of measured points is not one that a study wrote.
    #[error("{} is no table of measured points ({reason}); delete it, or choose another folder with `-o`", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl StudyError {
    /// A failed access to `path`.
    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}

impl From<SettingsError> for StudyError {
    fn from(error: SettingsError) -> Self {
        Self::Job(JobError::Settings(error))
    }
}
