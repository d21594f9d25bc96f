//! Which effects a shader holds. What a scene does not call for leaves no instruction and no binding.

use std::collections::BTreeSet;

use crate::palette::{self, Palette};

/// Which pass a shader is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pass {
    /// Surfaces with their light.
    Surface,
    /// Their depth as a light sees them.
    Caster,
    /// What lies behind them.
    Sky,
    /// The air in front of everything opaque.
    Air,
    /// Exposure and tone curve.
    Tone,
    /// What lies under one texel.
    Pick,
    /// Two pictures' difference in false colours.
    Difference,
}

/// A shader: a pass, effects that are on, and sizes.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Variant {
    pass: Pass,
    effects: BTreeSet<&'static str>,
    constants: Vec<(&'static str, u32)>,
    nodes: u32,
}

impl Variant {
    /// A shader with nothing but its pass.
    pub fn new(pass: Pass) -> Self {
        Self { pass, effects: BTreeSet::new(), constants: Vec::new(), nodes: 0 }
    }

    /// With an effect, if `on`.
    pub fn with(mut self, effect: &'static str, on: bool) -> Self {
        if on {
            self.effects.insert(effect);
        }
        self
    }

    /// With a constant of its own.
    pub fn constant(mut self, name: &'static str, value: u32) -> Self {
        self.constants.push((name, value));
        self
    }

    /// With a number of quadrature nodes on each side of a lamp's foot.
    pub fn quadrature(mut self, nodes: u32) -> Self {
        self.nodes = nodes;
        self
    }

    /// With the effects and sizes of another.
    pub fn and(mut self, other: &Self) -> Self {
        self.effects.extend(&other.effects);
        let new = other.constants.iter().filter(|(name, _)| !self.constants.iter().any(|(known, _)| known == name));
        let new: Vec<_> = new.copied().collect();
        self.constants.extend(new);
        self.nodes = self.nodes.max(other.nodes);
        self
    }

    /// Its pass.
    pub fn pass(&self) -> Pass {
        self.pass
    }

    /// Whether an effect is on.
    pub fn has(&self, effect: &str) -> bool {
        self.effects.contains(effect)
    }

    /// Effects that are on, in alphabetical order.
    pub fn effects(&self) -> impl Iterator<Item = &'static str> {
        self.effects.iter().copied()
    }

    /// Modules that it begins with.
    pub fn roots(&self) -> Vec<&'static str> {
        match self.pass {
            Pass::Surface => vec!["surface"],
            Pass::Caster => vec!["caster"],
            Pass::Sky => vec!["sky"],
            Pass::Air => vec!["air"],
            Pass::Tone => vec!["tone"],
            Pass::Pick => vec!["pick"],
            Pass::Difference => vec!["difference"],
        }
    }

    /// Constants by name.
    pub fn constants(&self) -> &[(&'static str, u32)] {
        &self.constants
    }

    /// Colours of its numbers.
    pub fn palette(&self) -> &'static Palette {
        if self.pass == Pass::Difference { &palette::DIVERGING } else { &palette::SEQUENTIAL }
    }

    /// Quadrature nodes on each side of a lamp's foot.
    pub fn nodes(&self) -> u32 {
        self.nodes
    }
}

impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.pass)?;
        self.effects.iter().try_for_each(|effect| write!(f, " {effect}"))
    }
}
