//! What each mode was measured to leave of error where more samples do not help, by situation.
//!
//! Points of a closed room and of a courtyard, against the truth of others or against walks: `cargo test -p bake-core --lib
//! tests::situations tests::fog tests::tables -- --nocapture`, and rooms, a courtyard by day and at night through the program.

use super::steps::is_hard;
use crate::air::Air;
use crate::scene::{LightKind, Scene};
use crate::solve::Mode;
use bake_optics::medium::Density;
use glam::DVec3;

/// Share of escaping rays from which a scene is open.
const OPEN: f64 = 0.05;
/// Mean cosine from which scattering is taken as forward.
const FORWARD: f64 = 0.2;

/// What of a scene decides how right a mode is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Situation {
    /// Largest side of the air in mean free paths.
    pub size: f64,
    /// Largest |g|.
    pub g: f64,
    /// Share of rays from surfaces that leave the scene.
    pub escaping: f64,
    /// Whether a directional light shines.
    pub has_sun: bool,
    /// Whether light comes from all sides.
    pub has_sky: bool,
    /// Whether density changes from place to place.
    pub is_uneven: bool,
    /// Whether air ends within the scene, or its density steps there.
    pub has_edges: bool,
}

impl Situation {
    pub fn new(scene: &Scene, air: &Air, size: f64, escaping: f64) -> Self {
        let media = &air.media.media;
        Self {
            size,
            escaping,
            g: media.iter().map(|m| m.phase.mean_cosine().abs()).fold(0.0, f64::max),
            has_sun: scene.lights.iter().any(|light| matches!(light.kind, LightKind::Directional { .. })),
            has_sky: scene.environment.is_some(),
            is_uneven: media.len() > 1 || media.iter().any(|m| m.density != Density::Uniform),
            has_edges: media.iter().any(|m| ends_within(m.bounds.bounding_box(), air.scene) || is_hard(m, air.scene)),
        }
    }

    /// Whether rays leave the scene.
    pub fn is_open(&self) -> bool {
        self.escaping > OPEN
    }

    /// RMSE as a share of irradiance; `None` where the mode is wrong by factors or was not measured.
    pub fn error(&self, mode: Mode) -> Option<f64> {
        match mode {
            Mode::Walk => Some(0.0),
            Mode::Grid => Some(self.of_grid()),
            Mode::Tables => self.of_tables(),
            Mode::Paper => None,
        }
    }

    fn of_grid(&self) -> f64 {
        match (self.is_open(), self.has_sun, self.has_sky) {
            (true, true, _) if self.g >= 0.7 => 0.086,
            (true, true, _) if self.g > FORWARD => 0.027,
            (true, false, false) => 0.029,
            _ => 0.01,
        }
    }

    fn of_tables(&self) -> Option<f64> {
        match (self.is_open(), self.has_sun, self.has_sky) {
            (true, false, false) => None,
            (true, true, _) if self.g > FORWARD => Some(0.11),
            (true, true, _) => Some(0.053),
            (true, false, true) => Some(0.03),
            (false, ..) if self.has_edges => Some(0.21),
            (false, ..) if self.is_uneven => Some(0.06),
            (false, ..) if self.size > 1.5 => Some(0.035),
            (false, ..) if self.size > 0.5 => Some(0.023),
            (false, ..) => Some(0.01),
        }
    }
}

/// Whether a box leaves out more than a hundredth of the scene's along some axis.
pub(super) fn ends_within([low, high]: [DVec3; 2], scene: [DVec3; 2]) -> bool {
    let slack = 0.01 * (scene[1] - scene[0]);
    (low - slack).cmpgt(scene[0]).any() || (high + slack).cmplt(scene[1]).any()
}
