//! The program as its users meet it: the built binary, files in, exit code and files out.

mod air;
mod bake;
mod killed;
#[cfg(all(feature = "view", target_os = "linux"))]
mod person;
mod refog;
mod run;
mod settings;
mod study;
mod tables;
mod usage;
#[cfg(feature = "view")]
mod view;
#[cfg(all(feature = "view", target_os = "linux"))]
mod window;
#[cfg(all(feature = "view", target_os = "linux"))]
mod window_panel;
