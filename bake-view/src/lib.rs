//! The viewer behind `bake view`: a picture of a package as PNG, without any window.

mod options;
mod screenshot;

pub use options::{AirArgument, CameraArgument, OptionError, Options, SizeArgument, TermsArgument, View, ViewArgument};
pub use screenshot::{Screenshot, ViewError, screenshot};
