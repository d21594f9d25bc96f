//! What can go wrong between a package and what is seen of it.

use bake_formats::FormatError;
use bake_runtime::RuntimeError;

/// Why nothing is shown.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The package cannot be read.
    #[error(transparent)]
    Package(#[from] FormatError),
    /// It cannot be drawn.
    #[error(transparent)]
    Runtime(RuntimeError),
    /// The picture cannot be encoded.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] image::ImageError),
    /// There is nowhere to open a window.
    #[error("no display for a window: {reason}; start it on a desktop, or write a picture with `--screenshot FILE`")]
    NoDisplay {
        /// What the system says.
        reason: String,
    },
    /// The adapter cannot draw to the window.
    #[error("adapter '{adapter}' cannot draw to this window: {reason}; write a picture with `--screenshot FILE`")]
    NoSurface {
        /// Name of the adapter.
        adapter: String,
        /// What it says.
        reason: String,
    },
}

impl ViewError {
    /// Nowhere to open a window, for the reason in an error.
    pub(crate) fn no_display(error: impl ToString) -> Self {
        let text = error.to_string();
        // winit begins with the place in its own source: `os error at /…/mod.rs:757: reason`.
        let reason = text.split_once(".rs:").and_then(|(_, place)| Some(place.split_once(": ")?.1)).unwrap_or(&text);
        Self::NoDisplay { reason: reason.trim_end_matches('.').into() }
    }
}

impl From<winit::error::EventLoopError> for ViewError {
    fn from(error: winit::error::EventLoopError) -> Self {
        Self::no_display(error)
    }
}

impl From<RuntimeError> for ViewError {
    fn from(error: RuntimeError) -> Self {
        match error {
            RuntimeError::Package(error) => Self::Package(error),
            error => Self::Runtime(error),
        }
    }
}
