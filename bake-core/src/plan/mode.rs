//! Which solver the air calls for.

use super::expected::Situation;
use crate::air::{self, Air};
use crate::scene::Scene;
use crate::settings::{self, Settings};
use crate::solve::Mode;
use crate::solve::grid::{MOST_CELLS, MOST_FREE_PATHS, side};
use glam::DVec3;
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
    /// RMSE that more samples do not take away, as a share of irradiance, as measured where air, light and openness are alike;
    /// `None` where the mode is wrong by factors or nobody measured.
    pub expected_error: Option<f64>,
}

impl Choice {
    /// What the settings ask for, or what suits the air; `escaping` is the share of rays from surfaces that leave the scene.
    pub fn derive(scene: &Scene, air: &Air, settings: &Settings, escaping: f64) -> Self {
        let (size, cells) = optical_size(air);
        let situation = Situation::new(scene, air, size, escaping);
        let (mode, why) = match settings.mode {
            _ if settings.keep_paths => (Mode::Tables, "paths are kept, which tables alone can do".into()),
            _ if !air.scatters() => (Mode::Walk, "nothing scatters: transmittance alone, no volume is solved".into()),
            settings::Mode::Walk => (Mode::Walk, "as set".into()),
            settings::Mode::Grid => (Mode::Grid, "as set".into()),
            settings::Mode::Tables | settings::Mode::Paper if settings.sh1 => {
                (Mode::Grid, "tables are set, but hold no directions for sh1".into())
            }
            settings::Mode::Tables => (Mode::Tables, "as set".into()),
            settings::Mode::Paper => {
                (Mode::Paper, "as set: the published method, which can be twice too bright in closed rooms".into())
            }
            settings::Mode::Auto => automatic(&situation, cells),
        };
        Self { mode, why: why + &told_steps(air), expected_error: situation.error(mode) }
    }

    /// Another mode instead, with the reason.
    pub(super) fn instead(scene: &Scene, air: &Air, mode: Mode, why: &str, escaping: f64) -> Self {
        let situation = Situation::new(scene, air, optical_size(air).0, escaping);
        Self { mode, why: why.to_owned() + &told_steps(air), expected_error: situation.error(mode) }
    }
}

/// Says where tables would err.
fn told_steps(air: &Air) -> String {
    match &super::steps::steps(air)[..] {
        [] => String::new(),
        names => format!("; hard density steps ({}): grid or walk, where tables blur them", names.join(", ")),
    }
}

/// Walk or grid. Tables are not taken for their speed: processor seconds at qualities preview and high, tables beside grid, were
/// 3.1 and 31.6 beside 1.1 and 9.9 in a closed room of optical size 1, 0.6 and 1.7 beside 0.3 and 2.4 in a courtyard under
/// a sun, with a bias of 1.4 to 2.2 % beside at most 0.7 % and, in the courtyard, twice the RMSE. Once each, not at equal noise: in
/// the room at high tables had 1.3 % of it beside 2.3 %.
fn automatic(situation: &Situation, cells: f64) -> (Mode, String) {
    let &Situation { size, g, .. } = situation;
    if size < THIN {
        (Mode::Walk, format!("optical size {size:.2e}: next to no collisions"))
    } else if cells > f64::from(MOST_CELLS) {
        (Mode::Walk, format!("a grid would need {cells:.0}³ cells, {MOST_CELLS}³ are allowed"))
    } else if g >= PEAKED && situation.has_sun {
        (Mode::Walk, format!("mean cosine {g:.2} under a directional light is too peaked for a grid"))
    } else {
        let tables = situation.error(Mode::Tables).map_or("be wrong by factors".into(), |error| {
            let [tables, grid] = [error, situation.error(Mode::Grid).unwrap_or(0.0)].map(|e| 100.0 * e);
            format!("leave {tables:.1} % beside {grid:.1} %")
        });
        let cells = format!("cells of at most {MOST_FREE_PATHS} mean free paths suffice");
        let open = 100.0 * situation.escaping;
        let air = format!("optical size {size:.2}, mean cosine {g:.2}, {open:.0} % of rays escape");
        (Mode::Grid, format!("{air}: {cells}; tables would {tables}"))
    }
}

/// Side of the largest scattering region within the scene in mean free paths where it is densest, and the grid cells
/// that it takes along the side of a cube of its volume.
fn optical_size(air: &Air) -> (f64, f64) {
    let across = |(medium, summary): (&bake_optics::medium::Medium, air::Summary)| {
        let [low, high] = medium.bounds.bounding_box();
        let size = (high.min(air.scene[1]) - low.max(air.scene[0])).max(DVec3::ZERO);
        let densest = summary.peak_density * medium.scatter.sigma_t().into_iter().fold(0.0, f64::max);
        (size.max_element() * densest, side(size) * densest / MOST_FREE_PATHS)
    };
    let most = |a: (f64, f64), b: (f64, f64)| (a.0.max(b.0), a.1.max(b.1));
    air.media.media.iter().zip(air.summaries()).map(across).fold((0.0, 0.0), most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, LightKind};
    use bake_optics::medium::{Bounds, Medium, MediumSet, Scatter};
    use bake_optics::phase::Phase;
    use glam::{DVec3, Vec3};

    fn choose(sigma_s: f64, sigma_a: f64, g: f64, has_sun: bool) -> Mode {
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::splat(2.0) };
        let scatter = Scatter { sigma_s: [sigma_s; 3], sigma_a: [sigma_a; 3] };
        let medium = Medium { bounds, scatter, phase: Phase::HenyeyGreenstein { g }, ..Medium::default() };
        let scene = [DVec3::ZERO, DVec3::splat(2.0)];
        let air = Air { media: MediumSet { media: vec![medium] }, names: vec!["fog".into()], scene };
        let kind = LightKind::Directional { direction: Vec3::NEG_Y, angular_radius: 0.0 };
        let sun = Light { path: "sun".into(), color: Vec3::ONE, kind };
        let scene = Scene { lights: if has_sun { vec![sun] } else { vec![] }, ..Scene::default() };
        Choice::derive(&scene, &air, &Settings::default(), 0.0).mode
    }

    #[test]
    fn the_air_decides() {
        assert_eq!(choose(0.001, 0.0, 0.0, false), Mode::Walk, "thin");
        assert_eq!(choose(1.0, 0.0, 0.0, false), Mode::Grid, "usual");
        assert_eq!(choose(100.0, 0.0, 0.0, false), Mode::Walk, "thick");
        assert_eq!(choose(0.0, 5.0, 0.0, false), Mode::Walk, "nothing scatters");
        assert_eq!(choose(1.0, 0.0, 0.8, false), Mode::Grid, "peaked, but no sharp light");
        assert_eq!(choose(1.0, 0.0, 0.8, true), Mode::Walk, "peaked under a sun");
    }

    /// What is expected is what was measured: tables err under a sun, and at night by nobody knows how much.
    #[test]
    fn errors_follow_the_situation() {
        let medium = Medium { scatter: Scatter { sigma_s: [0.5; 3], sigma_a: [0.0; 3] }, ..Medium::default() };
        let air = Air {
            media: MediumSet { media: vec![medium] },
            names: vec!["fog".into()],
            scene: [DVec3::ZERO, DVec3::ONE],
        };
        let settings = |mode| Settings { mode, ..Settings::default() };
        let error = |mode, escaping| Choice::derive(&Scene::default(), &air, &settings(mode), escaping).expected_error;
        assert_eq!(error(settings::Mode::Walk, 0.9), Some(0.0));
        assert!(error(settings::Mode::Tables, 0.0) > error(settings::Mode::Grid, 0.0).map(|e| 0.9 * e));
        assert_eq!(error(settings::Mode::Tables, 0.9), None, "a lamp outdoors");
        assert!(error(settings::Mode::Grid, 0.9) > error(settings::Mode::Grid, 0.0));
        let mut cube = air.clone();
        cube.media.media[0].bounds = Bounds::Box { min: DVec3::splat(0.3), max: DVec3::splat(0.7) };
        let of_cube = Choice::derive(&Scene::default(), &cube, &settings(settings::Mode::Tables), 0.0).expected_error;
        assert!(of_cube > error(settings::Mode::Tables, 0.0), "air that ends within the room is harder");
        for mode in [settings::Mode::Auto, settings::Mode::Tables] {
            let why = |air| Choice::derive(&Scene::default(), air, &settings(mode), 0.0).why;
            assert!(why(&cube).contains("hard density steps (fog)"), "{}", why(&cube));
            assert!(!why(&air).contains("hard density steps"), "{}", why(&air));
        }
        assert_eq!(Choice::derive(&Scene::default(), &cube, &settings(settings::Mode::Auto), 0.0).mode, Mode::Grid);
    }

    #[test]
    fn what_is_set_is_done() {
        let settings = Settings { mode: settings::Mode::Walk, ..Settings::default() };
        let medium = Medium { scatter: Scatter { sigma_s: [1.0; 3], sigma_a: [0.0; 3] }, ..Medium::default() };
        let air = Air { media: MediumSet { media: vec![medium] }, names: vec!["fog".into()], ..Air::default() };
        assert_eq!(Choice::derive(&Scene::default(), &air, &settings, 0.0).mode, Mode::Walk);
        let kept = Settings { keep_paths: true, ..settings };
        assert_eq!(Choice::derive(&Scene::default(), &air, &kept, 0.0).mode, Mode::Tables);
    }
}
