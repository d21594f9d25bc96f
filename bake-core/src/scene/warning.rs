//! What the loader let pass but the user should know: warnings as values, counted by kind.

use super::error::Place;
use std::fmt;

/// A warning, with how often it came up.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// What it is about.
    pub kind: WarningKind,
    /// First place in the file where it came up.
    pub object: String,
    /// What was met there, and what is done about it.
    pub message: String,
    /// Number of places (or of triangles, vertices, where the kind counts those).
    pub count: u64,
}

impl fmt::Display for Warning {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        if !self.object.is_empty() {
            write!(out, "{}: ", self.object)?;
        }
        out.write_str(&self.message)?;
        if self.count > 1 { write!(out, " ({} in all)", self.count) } else { Ok(()) }
    }
}

/// What a warning is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum WarningKind {
    /// An image cannot be read; its factor alone is used.
    MissingTexture,
    /// Texture coordinate sets beyond 2 are not read.
    TexcoordSet,
    /// Points and lines are not baked.
    PointsOrLines,
    /// Triangles without area were dropped; counts triangles.
    DegenerateTriangles,
    /// Normals of length zero were replaced by geometric ones; counts vertices.
    BadNormals,
    /// Vertex colours outside [0, 1] were clamped; counts vertices.
    ColorRange,
    /// A primitive without positions, or with nothing in it, was left out.
    EmptyPrimitive,
    /// A material value outside its range was clamped.
    MaterialRange,
    /// Skins and morph targets are not applied.
    Deformation,
    /// A node squeezes its mesh flat; it was left out.
    FlatInstance,
    /// An optional extension is not known and ignored.
    IgnoredExtension,
    /// Lights look as if they were not in candela and lux.
    LightUnits,
    /// Unlit materials neither reflect nor emit.
    Unlit,
    /// A setting names something that the scene does not have.
    UnusedSetting,
    /// Environment radiance below zero was set to zero; counts texels.
    EnvironmentRange,
}

/// Collects warnings, one entry a kind (a message each for extensions and settings).
#[derive(Debug, Default)]
pub(super) struct Warnings(Vec<Warning>);

impl Warnings {
    /// Adds one.
    pub fn push(&mut self, kind: WarningKind, place: &Place, message: impl Into<String>) {
        self.push_many(kind, place, 1, message);
    }

    /// Adds `count` of a kind; none when it is zero.
    pub fn push_many(&mut self, kind: WarningKind, place: &Place, count: u64, message: impl Into<String>) {
        if count == 0 {
            return;
        }
        let message = message.into();
        let by_message = matches!(kind, WarningKind::IgnoredExtension | WarningKind::UnusedSetting);
        let known = |w: &&mut Warning| w.kind == kind && (!by_message || w.message == message);
        match self.0.iter_mut().find(known) {
            Some(warning) => warning.count += count,
            None => self.0.push(Warning { kind, object: place.to_string(), message, count }),
        }
    }

    /// All warnings, in the order in which they first came up.
    pub fn into_vec(self) -> Vec<Warning> {
        self.0
    }
}
