//! Which solver the air calls for.

use crate::air::Air;
use crate::scene::{LightKind, Scene};
use crate::settings::{self, Settings};
use crate::solve::Mode;
use crate::solve::grid::{MOST_CELLS, MOST_FREE_PATHS};
use serde::Serialize;

/// Optical size below which a walk hardly ever collides: nothing is gained by a grid.
const THIN: f64 = 0.02;
/// Mean cosine above which harmonics with l ≤ 2 lose what forward scattering makes of a sharp light.
const PEAKED: f64 = 0.7;

/// The solver, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The solver.
    pub mode: Mode,
    /// The reason.
    pub why: String,
}

impl Choice {
    /// What the settings ask for, or what suits the air.
    pub fn derive(scene: &Scene, air: &Air, settings: &Settings) -> Self {
        let because = |mode, why: String| Self { mode, why };
        match settings.mode {
            _ if !air.scatters() => {
                because(Mode::Walk, "nothing scatters: transmittance alone, no volume is solved".into())
            }
            settings::Mode::Walk => because(Mode::Walk, "as set".into()),
            settings::Mode::Grid => because(Mode::Grid, "as set".into()),
            settings::Mode::Tables if settings.sh1 => {
                because(Mode::Grid, "tables are set, but hold no directions for sh1".into())
            }
            settings::Mode::Tables => because(Mode::Tables, "as set".into()),
            settings::Mode::Auto => Self::automatic(scene, air),
        }
    }

    fn automatic(scene: &Scene, air: &Air) -> Self {
        let (size, cells) = optical_size(air);
        let g = air.media.media.iter().map(|m| m.phase.mean_cosine().abs()).fold(0.0, f64::max);
        let sharp = scene.lights.iter().any(|light| matches!(light.kind, LightKind::Directional { .. }));
        let because = |mode, why: String| Self { mode, why };
        if size < THIN {
            because(Mode::Walk, format!("optical size {size:.2e}: next to no collisions"))
        } else if cells > f64::from(MOST_CELLS) {
            because(Mode::Walk, format!("a grid would need {cells:.0} cells along a side, {MOST_CELLS} are allowed"))
        } else if g >= PEAKED && sharp {
            because(Mode::Walk, format!("mean cosine {g:.2} under a directional light is too peaked for a grid"))
        } else {
            because(
                Mode::Grid,
                format!(
                    "optical size {size:.2}, mean cosine {g:.2}: cells of at most {MOST_FREE_PATHS} mean free paths suffice"
                ),
            )
        }
    }
}

/// Largest optical depth across a medium's box at density 1, and the grid cells that it takes.
fn optical_size(air: &Air) -> (f64, f64) {
    let across = |medium: &bake_optics::medium::Medium| {
        let [low, high] = medium.bounds.bounding_box();
        let size = (high.min(air.scene[1]) - low.max(air.scene[0])).max_element().max(0.0);
        size * medium.scatter.sigma_t().into_iter().fold(0.0, f64::max)
    };
    let size = air.media.media.iter().map(across).fold(0.0, f64::max);
    (size, size / MOST_FREE_PATHS)
}
