//! Everything that light may do, on or off for this scene, with the reason.

use crate::air::Air;
use crate::scene::{AlphaMode, LightKind, Material, Scene};
use crate::settings::Settings;
use bake_optics::medium::Density;
use glam::Vec3;
use serde::Serialize;

/// Something that light may do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Effect {
    /// Name.
    pub name: &'static str,
    /// Whether it is simulated.
    pub on: bool,
    /// The reason.
    pub why: String,
}

/// The effects of emitters and surfaces, then those of the air.
pub fn derive(scene: &Scene, air: &Air, settings: &Settings) -> Vec<Effect> {
    let mut effects = of_surfaces(scene, settings);
    effects.extend(of_air(air));
    effects
}

fn of_surfaces(scene: &Scene, settings: &Settings) -> Vec<Effect> {
    let near = scene.lights.iter().filter(|light| !matches!(light.kind, LightKind::Directional { .. })).count();
    let materials = |name, test: fn(&Material) -> bool| {
        Effect::counted(name, scene.materials.iter().filter(|material| test(material)).count(), "material")
    };
    let bounces = match settings.bounces {
        None => "unlimited reflections under Russian roulette".into(),
        Some(count) => format!("bounces is {count}"),
    };
    vec![
        Effect::counted("point and spot lights", near, "light"),
        Effect::counted("directional lights", scene.lights.len() - near, "light"),
        materials("emissive surfaces", |m| m.emission != Vec3::ZERO),
        Effect::counted("environment", usize::from(scene.environment.is_some()), "sky or environment image"),
        Effect::new("reflected light", settings.bounces != Some(0), bounces),
        materials("cut-out and see-through", |m| m.alpha_mode != AlphaMode::Opaque),
        materials("transmission", |m| m.transmission > 0.0),
        materials("diffuse transmission", |m| m.diffuse_transmission > 0.0),
        materials("absorption in volumes", |m| m.volume_sigma_a != Vec3::ZERO),
    ]
}

fn of_air(air: &Air) -> Vec<Effect> {
    if air.is_empty() {
        return vec![Effect::new("fog", false, "no medium")];
    }
    let summaries = air.summaries();
    let depth = summaries.iter().flat_map(|medium| medium.optical_depth).fold(0.0, f64::max);
    let albedo = summaries.iter().flat_map(|medium| medium.albedo).fold(0.0, f64::max);
    let g = summaries.iter().map(|medium| medium.g).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let varying = air.media.media.iter().filter(|medium| medium.density != Density::Uniform).count();
    let choose = |on: bool, yes: String, no: &str| if on { yes } else { no.to_owned() };
    let scatters = air.scatters();
    vec![
        Effect::counted("fog", air.names.len(), "medium"),
        Effect::new("attenuation", true, format!("optical depth up to {depth:.3} across the scene")),
        Effect::new("absorption", air.absorbs(), choose(air.absorbs(), "sigma_a above 0".into(), "sigma_a is 0")),
        Effect::new(
            "scattering, all orders",
            scatters,
            choose(scatters, format!("albedo up to {albedo:.3}"), "sigma_s is 0: no volume is solved"),
        ),
        Effect::new(
            "anisotropy",
            !air.is_isotropic(),
            choose(!air.is_isotropic(), format!("mean cosine up to {g:.2}"), "isotropic phase functions"),
        ),
        Effect::new(
            "heterogeneity",
            varying > 0,
            choose(varying > 0, format!("{varying} of {} densities vary", air.names.len()), "uniform densities"),
        ),
        Effect::new(
            "colour of the air",
            !air.is_grey(),
            choose(
                !air.is_grey(),
                "coefficients differ by channel".into(),
                "grey: one exponential serves all channels",
            ),
        ),
    ]
}

impl Effect {
    fn new(name: &'static str, on: bool, why: impl Into<String>) -> Self {
        Self { name, on, why: why.into() }
    }

    /// On where there is at least one of what it takes.
    fn counted(name: &'static str, count: usize, what: &str) -> Self {
        let plural = match what {
            "medium" if count > 1 => "media".into(),
            what if count > 1 => format!("{what}s"),
            what => what.to_owned(),
        };
        Self::new(name, count > 0, if count == 0 { format!("no {what}") } else { format!("{count} {plural}") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, Medium, MediumSet, Scatter};
    use bake_optics::phase::Phase;
    use glam::DVec3;

    fn air(medium: Medium) -> Air {
        let scene = [DVec3::ZERO, DVec3::ONE];
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE };
        Air { media: MediumSet { media: vec![Medium { bounds, ..medium }] }, names: vec!["fog".into()], scene }
    }

    fn on(air: &Air) -> Vec<&'static str> {
        of_air(air).into_iter().filter(|effect| effect.on).map(|effect| effect.name).collect()
    }

    #[test]
    fn only_what_the_air_calls_for_is_on() {
        let grey = Scatter { sigma_s: [0.5; 3], sigma_a: [0.0; 3] };
        let smoke = Medium {
            density: Density::Exponential { base_m: 0.0, scale_height_m: 1.0 },
            scatter: Scatter { sigma_s: [0.5, 0.4, 0.3], sigma_a: [0.1; 3] },
            phase: Phase::HenyeyGreenstein { g: 0.5 },
            ..Medium::default()
        };
        let black = Scatter { sigma_s: [0.0; 3], sigma_a: [1.0; 3] };
        assert_eq!(on(&Air::default()), [""; 0]);
        assert_eq!(
            on(&air(Medium { scatter: grey, ..Medium::default() })),
            ["fog", "attenuation", "scattering, all orders"]
        );
        assert_eq!(on(&air(Medium { scatter: black, ..Medium::default() })), ["fog", "attenuation", "absorption"]);
        assert_eq!(on(&air(smoke)).len(), 7, "coloured anisotropic heterogeneous smoke takes everything");
    }
}
