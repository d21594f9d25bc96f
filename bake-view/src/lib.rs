//! The viewer behind `bake view`: a picture of a package as PNG, without any window.

mod options;
mod screenshot;

pub use options::{CameraArgument, OptionError, Options, SizeArgument};
pub use screenshot::{Screenshot, ViewError, screenshot};
