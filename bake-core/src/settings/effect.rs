//! The effects that a user may force on or off against the plan's choice.

use serde::{Deserialize, Serialize};

/// An effect that the plan can leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum EffectName {
    /// Everything that the air does; off: no air.
    Attenuation,
    /// Light that the air swallows; off: `sigma_a` is 0.
    Absorption,
    /// Light that the air throws out of its way; off: it is swallowed.
    Scattering,
    /// Light scattered twice or more between surfaces; off: scattered light only weakens.
    Multiple,
    /// Scattering that prefers some deflections; off: isotropic.
    Anisotropy,
    /// Density that varies in space; off: constant.
    Heterogeneity,
    /// Coefficients that differ by channel; off: their mean.
    Colour,
    /// Light reflected by surfaces.
    Indirect,
    /// The sky, or the environment image.
    Environment,
    /// Light that mode `tables` scatters between points of one plane; off: other surfaces stand for it.
    OwnPlane,
}

impl EffectName {
    /// All, by the name that plan and flags use.
    pub const ALL: [(&str, Self); 10] = [
        ("attenuation", Self::Attenuation),
        ("absorption", Self::Absorption),
        ("scattering", Self::Scattering),
        ("multiple", Self::Multiple),
        ("anisotropy", Self::Anisotropy),
        ("heterogeneity", Self::Heterogeneity),
        ("colour", Self::Colour),
        ("indirect", Self::Indirect),
        ("environment", Self::Environment),
        ("own-plane", Self::OwnPlane),
    ];

    /// The name that plan and flags use.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_in_the_order_of_the_effects() {
        EffectName::ALL.iter().for_each(|(name, effect)| assert_eq!(effect.name(), *name));
    }
}
