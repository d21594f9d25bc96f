//! The light terms: named by the last leg to the texel, in every scene, with or without air.

use serde::{Deserialize, Serialize};

/// One part of the irradiance; the parts sum to the total.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Term {
    /// Straight from an emitter.
    Direct,
    /// Straight from a reflecting surface.
    Indirect,
    /// One collision in the air since the last surface or emitter.
    Single,
    /// Two or more collisions.
    Multiple,
}

impl Term {
    /// All terms in their order on disk.
    pub const ALL: [Self; 4] = [Self::Direct, Self::Indirect, Self::Single, Self::Multiple];

    /// Name in files, flags and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Single => "single",
            Self::Multiple => "multiple",
        }
    }
}
