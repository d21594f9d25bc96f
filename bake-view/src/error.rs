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
    Runtime(#[from] RuntimeError),
    /// The picture cannot be encoded.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] image::ImageError),
    /// There is nowhere to open a window.
    #[error("no display for a window: {reason}; start it on a desktop, or write a picture with --screenshot FILE")]
    NoDisplay {
        /// What the system says.
        reason: String,
    },
    /// The adapter cannot draw to the window.
    #[error("adapter '{adapter}' cannot draw to this window: {reason}; write a picture with --screenshot FILE")]
    NoSurface {
        /// Name of the adapter.
        adapter: String,
        /// What it says.
        reason: String,
    },
}

impl From<winit::error::EventLoopError> for ViewError {
    fn from(error: winit::error::EventLoopError) -> Self {
        Self::NoDisplay { reason: error.to_string() }
    }
}
