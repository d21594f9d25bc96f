//! What can go wrong between a package and a picture.

use bake_formats::FormatError;

/// Why nothing is drawn.
#[derive(Debug, thiserror::Error)]
pub enum RuntimeError {
    /// The machine offers no GPU and no software stand-in.
    #[error(
        "no graphics adapter: {reason}; install a GPU driver, or Mesa's software Vulkan (Debian: mesa-vulkan-drivers libvulkan1)"
    )]
    NoAdapter {
        /// What the loader says.
        reason: String,
    },
    /// The adapter refuses a device.
    #[error(
        "adapter '{adapter}' gives no device: {reason}; update its driver, or choose another with WGPU_ADAPTER_NAME"
    )]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The package cannot be read.
    #[error(transparent)]
    Package(#[from] FormatError),
    /// A picture inside the package cannot be decoded.
    #[error("texture {index} of {file}: {reason}; bake again")]
    Texture {
        /// The scene file.
        file: String,
        /// Index of the texture.
        index: usize,
        /// What the decoder says.
        reason: String,
    },
    /// A record of the manifest does not say what it should.
    #[error("{field} is {value}; {expected}")]
    Record {
        /// Which record.
        field: String,
        /// What it says.
        value: String,
        /// What it should say.
        expected: String,
    },
    /// The device cannot hold what is asked for.
    #[error("{what} needs {needed}, the device allows {allowed}; {next}")]
    Limit {
        /// What is too large.
        what: String,
        /// Its size.
        needed: u64,
        /// The device's limit.
        allowed: u64,
        /// What to do.
        next: &'static str,
    },
    /// A buffer could not be read back.
    #[error("cannot read the picture back from the device: {reason}")]
    ReadBack {
        /// What the device says.
        reason: String,
    },
}

/// Short form.
pub type Result<T> = std::result::Result<T, RuntimeError>;
