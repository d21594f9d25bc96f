//! The viewer behind `bake view`: a picture of a package as PNG without any window, or a window to walk through it.
//!
//! ```text
//! options ─► keys::Viewer (navigator: camera; look: what is shown) ─► stage (packages on a device) ─► picture
//!                  ▲                                                                                   │
//!               panel (egui widgets) ◄──────────── window (winit, the screen) ◄────────────────────────┘
//! ```
//!
//! `navigator`, `look`, `turned`, `keys` and `pace` know neither window nor device; what is seen is computed by `bake-runtime`.

mod error;
mod keys;
mod look;
mod navigator;
mod options;
mod pace;
mod panel;
mod screenshot;
mod stage;
mod turned;
mod widgets;
mod window;

pub use error::ViewError;
pub use options::{
    AirArgument, CameraArgument, Compare, CompareArgument, OptionError, Options, SizeArgument, TermsArgument, View,
    ViewArgument,
};
pub use screenshot::{Screenshot, screenshot, variants};
pub use window::window;
