//! Validation through the real program: closed forms, an independent renderer's truth, scenes that nobody here made.
//! `BAKE_LONG=1` runs the long forms.

mod closed_forms;
mod dark;
mod fog;
mod leaks;
mod real_scenes;
mod truth;
