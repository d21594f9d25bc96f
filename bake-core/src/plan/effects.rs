//! Everything that light may do, on or off for this scene, with the reason and a bound on what it contributes.

use super::bounds::Bounds;
use super::budget::Budget;
use super::reduce;
use crate::air::Air;
use crate::scene::{AlphaMode, Material, Scene};
use crate::settings::{EffectName, Settings};
use crate::solve::Mode;
use bake_optics::medium::Density;
use glam::Vec3;
use serde::Serialize;
use std::collections::BTreeMap;

/// Something that light may do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// Name; that of [`EffectName`] where it can be forced.
    pub name: &'static str,
    /// Whether it is simulated.
    pub on: bool,
    /// The most that leaving it out changes: mean over the lightmapped surface, as a share of the median texel irradiance
    /// (derived in [`super::bounds`]). Zero where the scene has none of it, infinite (`null` in JSON) where no bound is
    /// known.
    pub bound: f64,
    /// The reason.
    pub why: String,
}

impl Effect {
    fn new(name: &'static str, on: bool, bound: f64, why: impl Into<String>) -> Self {
        Self { name, on, bound, why: why.into() }
    }

    /// On where there is at least one of what it takes.
    fn counted(name: &'static str, count: usize, what: &str, bound: f64) -> Self {
        let plural = match what {
            "medium" if count > 1 => "media".into(),
            what if count > 1 => format!("{what}s"),
            what => what.to_owned(),
        };
        let why = if count == 0 { format!("no {what}") } else { format!("{count} {plural}") };
        Self::new(name, count > 0, if count == 0 { 0.0 } else { bound }, why)
    }

    /// Whether the scene has it and it is not simulated.
    pub fn is_left_out(&self) -> bool {
        !self.on && self.bound > 0.0
    }
}

/// Whether an effect is on in a list; true where the list does not name it.
pub fn is_on(effects: &[Effect], name: EffectName) -> bool {
    effects.iter().find(|effect| effect.name == name.name()).is_none_or(|effect| effect.on)
}

type Reduction = fn(&Air) -> Air;

/// What takes each effect out of the air.
const REDUCTIONS: [(EffectName, Reduction); 5] = [
    (EffectName::Heterogeneity, reduce::homogeneous),
    (EffectName::Colour, reduce::grey),
    (EffectName::Absorption, reduce::without_absorption),
    (EffectName::Scattering, reduce::without_scattering),
    (EffectName::Anisotropy, reduce::isotropic),
];

/// The air with what the effects leave of it.
pub fn reduce(effects: &[Effect], air: &Air) -> Air {
    if !is_on(effects, EffectName::Attenuation) {
        return Air { scene: air.scene, ..Air::default() };
    }
    let off = REDUCTIONS.iter().filter(|(name, _)| !is_on(effects, *name));
    off.fold(air.clone(), |air, (_, reduce)| reduce(&air))
}

/// The effects of emitters and surfaces, then those of the air.
pub fn derive(scene: &Scene, air: &Air, settings: &Settings, budget: &Budget) -> Vec<Effect> {
    let judge = Judge { force: &settings.force_effect, tolerance: f64::from(settings.tolerance) };
    let bounds = Bounds::new(*budget, air);
    let mut effects = of_surfaces(scene, settings, budget, &bounds, &judge);
    effects.extend(of_air(scene, air, budget, &bounds, &judge));
    effects
}

/// What may be left out.
struct Judge<'a> {
    force: &'a BTreeMap<EffectName, bool>,
    tolerance: f64,
}

/// What the scene calls for.
struct Call {
    is_there: bool,
    bound: f64,
    why: String,
}

impl Judge<'_> {
    fn judge(&self, name: EffectName, call: Call) -> Effect {
        let Call { is_there, bound, mut why } = call;
        if !is_there {
            if self.force.get(&name) == Some(&true) {
                why += "; forced on, but there is nothing to simulate";
            }
            return Effect::new(name.name(), false, 0.0, why);
        }
        let on = match self.force.get(&name) {
            Some(&on) => {
                why += if on { "; forced on" } else { "; forced off" };
                on
            }
            None if bound > self.tolerance => true,
            None => {
                why += &format!("; left out, below the tolerance of {}", self.tolerance as f32);
                false
            }
        };
        Effect::new(name.name(), on, bound, why)
    }
}

fn of_surfaces(scene: &Scene, settings: &Settings, budget: &Budget, bounds: &Bounds, judge: &Judge) -> Vec<Effect> {
    let suns = scene.lights.iter().filter(|light| light.is_directional()).count();
    let count = |test: fn(&Material) -> bool| scene.materials.iter().filter(|material| test(material)).count();
    let materials = |name, test| Effect::counted(name, count(test), "material", f64::INFINITY);
    let bounces = match settings.bounces {
        None => "unlimited reflections under Russian roulette".into(),
        Some(count) => format!("bounces is {count}"),
    };
    let (emitted, is_lit) = (budget.emitted, scene.environment.is_some());
    let environment = if is_lit { "1 sky or environment image" } else { "no sky or environment image" };
    vec![
        Effect::counted("point and spot lights", scene.lights.len() - suns, "light", bounds.emitter(emitted.lamps)),
        Effect::counted("directional lights", suns, "light", bounds.emitter(emitted.suns)),
        Effect::counted(
            "emissive surfaces",
            count(|m| m.emission != Vec3::ZERO),
            "material",
            bounds.emitter(emitted.glow),
        ),
        judge.judge(
            EffectName::Environment,
            Call { is_there: is_lit, bound: bounds.emitter(emitted.environment), why: environment.into() },
        ),
        judge.judge(
            EffectName::Indirect,
            Call { is_there: settings.bounces != Some(0), bound: bounds.indirect(), why: bounces },
        ),
        materials("cut-out and see-through", |m| m.alpha_mode != AlphaMode::Opaque),
        materials("transmission", |m| m.transmission > 0.0),
        materials("diffuse transmission", |m| m.diffuse_transmission > 0.0),
        materials("absorption in volumes", |m| m.volume_sigma_a != Vec3::ZERO),
    ]
}

fn of_air(scene: &Scene, air: &Air, budget: &Budget, bounds: &Bounds, judge: &Judge) -> Vec<Effect> {
    if air.is_empty() {
        return vec![Effect::new("fog", false, 0.0, "no medium")];
    }
    let mut effects = vec![Effect::counted("fog", air.names.len(), "medium", bounds.attenuation())];
    let attenuation = judge.judge(EffectName::Attenuation, attenuation(air, bounds));
    let scattering = judge.judge(EffectName::Scattering, scattering(air, bounds));
    // What stands under an effect that is off is off too.
    let (has_air, scatters) = (attenuation.on, attenuation.on && scattering.on);
    let under = |is_under: bool, reason: &str, effect: Effect| match effect {
        effect if is_under || !effect.on => effect,
        effect => Effect { on: false, why: reason.to_owned(), ..effect },
    };
    let of_air = |effect| under(has_air, "no air is left", effect);
    let of_scattering = |effect| under(scatters, "no scattering is left", effect);
    effects.push(attenuation);
    effects.push(of_air(judge.judge(EffectName::Absorption, absorption(air, bounds))));
    effects.push(of_air(scattering));
    effects.extend(scattering_by_emitter(scene, budget, bounds).into_iter().map(of_scattering));
    let multiple = Call { is_there: air.scatters(), bound: bounds.multiple(), why: "all orders of scattering".into() };
    effects.push(of_scattering(judge.judge(EffectName::Multiple, multiple)));
    effects.push(of_scattering(judge.judge(EffectName::Anisotropy, anisotropy(air, bounds))));
    effects.push(of_air(judge.judge(EffectName::Heterogeneity, heterogeneity(air, bounds))));
    effects.push(of_air(judge.judge(EffectName::Colour, colour(air, bounds))));
    effects
}

fn attenuation(air: &Air, bounds: &Bounds) -> Call {
    let depth = air.summaries().iter().flat_map(|medium| medium.optical_depth).fold(0.0, f64::max);
    let why = match depth {
        0.0 => "light is never stopped".into(),
        depth if depth < 1e-3 => format!("optical depth up to {depth:.1e} across the scene"),
        depth => format!("optical depth up to {depth:.3} across the scene"),
    };
    Call { is_there: air.scatters() || air.absorbs(), bound: bounds.attenuation(), why }
}

fn absorption(air: &Air, bounds: &Bounds) -> Call {
    let is_there = air.absorbs();
    let why = if is_there { "sigma_a above 0" } else { "sigma_a is 0" };
    Call { is_there, bound: bounds.absorption(), why: why.into() }
}

fn scattering(air: &Air, bounds: &Bounds) -> Call {
    let albedo = air.summaries().iter().flat_map(|medium| medium.albedo).fold(0.0, f64::max);
    let is_there = air.scatters();
    let why = if is_there { format!("albedo up to {albedo:.3}") } else { "sigma_s is 0: no volume is solved".into() };
    Call { is_there, bound: bounds.scattering(), why }
}

/// First collisions by where light comes from. They are on and off together with all scattering.
fn scattering_by_emitter(scene: &Scene, budget: &Budget, bounds: &Bounds) -> Vec<Effect> {
    let emitted = &budget.emitted;
    let is_directional = |directional| scene.lights.iter().any(|light| light.is_directional() == directional);
    let of = |name, is_there: bool, bound: f64, what: &str| {
        let (is, why) = if is_there { ("", "single scattering; part of `scattering`") } else { ("no ", "") };
        let why = if is_there { why.to_owned() } else { format!("{is}{what}") };
        Effect::new(name, is_there, if is_there { bound } else { 0.0 }, why)
    };
    let first = |flux| bounds.scattered_emitter(flux);
    vec![
        of("scattering of lamps", is_directional(false), first(emitted.lamps), "point or spot light"),
        of("scattering of suns", is_directional(true), first(emitted.suns), "directional light"),
        of("scattering of emissive surfaces", emitted.glow > 0.0, first(emitted.glow), "emissive surface"),
        of("scattering of the environment", scene.environment.is_some(), first(emitted.environment), "environment"),
        of("scattering of reflections", true, bounds.scattered_reflections(), ""),
    ]
}

fn anisotropy(air: &Air, bounds: &Bounds) -> Call {
    let is_there = !air.is_isotropic();
    let cosines = air.media.media.iter().map(|medium| medium.phase.mean_cosine());
    let g = cosines.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let why = if is_there { format!("mean cosine up to {g:.2}") } else { "isotropic phase functions".into() };
    Call { is_there, bound: bounds.anisotropy(), why }
}

fn heterogeneity(air: &Air, bounds: &Bounds) -> Call {
    let varying = air.media.media.iter().filter(|medium| medium.density != Density::Uniform).count();
    let why = match varying {
        0 => "uniform densities".into(),
        varying => format!("{varying} of {} densities vary", air.names.len()),
    };
    Call { is_there: varying > 0, bound: bounds.heterogeneity(), why }
}

fn colour(air: &Air, bounds: &Bounds) -> Call {
    let is_there = !air.is_grey();
    let why = if is_there { "coefficients differ by channel" } else { "grey: one exponential serves all channels" };
    Call { is_there, bound: bounds.colour(), why: why.into() }
}

/// What the chosen solver adds to the list.
pub fn of_solver(mode: Option<Mode>, air: &Air, settings: &Settings, budget: &Budget) -> Vec<Effect> {
    let Some(mode) = mode else { return vec![] };
    let judge = Judge { force: &settings.force_effect, tolerance: f64::from(settings.tolerance) };
    let why = match mode {
        Mode::Tables => "drawn on its own: tables know no neighbours in a surface's plane",
        Mode::Paper => "not known to the published method",
        Mode::Walk | Mode::Grid => "paths through the air find it",
    };
    let bound = Bounds::new(*budget, air).own_plane();
    vec![judge.judge(EffectName::OwnPlane, Call { is_there: mode == Mode::Tables, bound, why: why.into() })]
}

#[cfg(test)]
mod tests {
    use super::super::budget::Emitted;
    use super::*;
    use bake_optics::medium::{Bounds, Medium, MediumSet, Scatter};
    use bake_optics::phase::Phase;
    use glam::DVec3;

    const BUDGET: Budget = Budget {
        emitted: Emitted { lamps: 1.0, suns: 0.0, glow: 0.0, environment: 0.0 },
        albedo: 0.5,
        area: 1.0,
        median: 1.0,
    };

    fn air(medium: Medium) -> Air {
        let scene = [DVec3::ZERO, DVec3::ONE];
        let bounds = Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE };
        Air { media: MediumSet { media: vec![Medium { bounds, ..medium }] }, names: vec!["fog".into()], scene }
    }

    /// Coloured, anisotropic, heterogeneous; `thin` scales all coefficients.
    fn smoke(thin: f64) -> Air {
        air(Medium {
            density: Density::Exponential { base_m: 0.0, scale_height_m: 1.0 },
            scatter: Scatter { sigma_s: [0.5, 0.4, 0.3].map(|s| s * thin), sigma_a: [0.1 * thin; 3] },
            phase: Phase::HenyeyGreenstein { g: 0.5 },
            ..Medium::default()
        })
    }

    fn effects(air: &Air, force: &[(EffectName, bool)], tolerance: f32) -> Vec<Effect> {
        let force_effect = force.iter().copied().collect();
        derive(&Scene::default(), air, &Settings { force_effect, tolerance, ..Settings::default() }, &BUDGET)
    }

    /// Those of the air that can be forced.
    fn on(effects: &[Effect]) -> Vec<&'static str> {
        let names = EffectName::ALL.map(|(name, _)| name);
        let named = effects.iter().filter(|effect| effect.on && names[..7].contains(&effect.name));
        named.map(|effect| effect.name).collect()
    }

    const ALL: [&str; 7] =
        ["attenuation", "absorption", "scattering", "multiple", "anisotropy", "heterogeneity", "colour"];

    #[test]
    fn only_what_the_air_calls_for_is_on() {
        let on = |medium: Medium| on(&effects(&air(medium), &[], 0.001));
        let grey = Scatter { sigma_s: [0.5; 3], sigma_a: [0.0; 3] };
        let black = Scatter { sigma_s: [0.0; 3], sigma_a: [1.0; 3] };
        assert_eq!(effects(&Air::default(), &[], 0.001).last().map(|fog| (fog.name, fog.on)), Some(("fog", false)));
        assert_eq!(on(Medium { scatter: grey, ..Medium::default() }), ["attenuation", "scattering", "multiple"]);
        assert_eq!(on(Medium { scatter: black, ..Medium::default() }), ["attenuation", "absorption"]);
        assert_eq!(super::tests::on(&effects(&smoke(1.0), &[], 0.001)), ALL);
    }

    #[test]
    fn thinner_air_loses_its_effects_one_by_one_and_then_all() {
        let left = |thin| on(&effects(&smoke(thin), &[], 0.001)).len();
        let counts: Vec<usize> = (0..8).map(|digits| left(0.1f64.powi(digits))).collect();
        assert!(counts.is_sorted_by(|a, b| a >= b), "{counts:?}");
        assert_eq!((counts[0], counts[7]), (7, 0));
        assert_eq!(
            on(&effects(&smoke(3e-3), &[], 0.001)),
            ["attenuation", "absorption", "scattering", "anisotropy", "heterogeneity", "colour"]
        );
        assert!(reduce(&effects(&smoke(1e-7), &[], 0.001), &smoke(1e-7)).is_empty());
        assert_eq!(on(&effects(&smoke(1e-7), &[], 0.0)), ALL, "without tolerance nothing is left out");
        assert!(effects(&smoke(1e-7), &[], 0.001).iter().any(|e| e.is_left_out() && e.why.contains("tolerance")));
    }

    #[test]
    fn force_wins_in_both_directions() {
        for (index, &(name, effect)) in EffectName::ALL[..7].iter().enumerate() {
            let air = smoke(1.0);
            let without = effects(&air, &[(effect, false)], 0.001);
            assert!(!is_on(&without, effect));
            assert_eq!(reduce(&without, &air) == air, effect == EffectName::Multiple, "{name}");
            let gone = match index {
                0 => 7,
                2 => 3,
                _ => 1,
            };
            assert_eq!(on(&without).len(), 7 - gone, "{name}");
        }
        let thin = smoke(1e-7);
        let all = EffectName::ALL.map(|(_, effect)| (effect, true));
        assert_eq!(on(&effects(&thin, &all, 0.001)), ALL);
        assert_eq!(reduce(&effects(&thin, &all, 0.001), &thin), thin);
    }

    /// In the dark, under perfect white and in air without end nothing is bounded, and so nothing is left out.
    #[test]
    fn where_no_bound_holds_everything_stays() {
        let settings = Settings::default();
        let of = |air: &Air, budget: &Budget| on(&derive(&Scene::default(), air, &settings, budget)).len();
        let mut endless = smoke(1e-7);
        endless.media.media[0].bounds = Bounds::Unbounded;
        assert_eq!(of(&smoke(1e-7), &BUDGET), 0);
        assert_eq!(of(&smoke(1e-7), &Budget { median: 0.0, ..BUDGET }), 7);
        assert_eq!(of(&smoke(1e-7), &Budget { albedo: 1.0, ..BUDGET }), 7);
        assert_eq!(of(&endless, &BUDGET), 7);
    }
}
