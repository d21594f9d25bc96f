//! What each effect of a plan did to the light and to the time: short bakes of a few texels with one effect less.
//!
//! *Changes.* [`TEXELS`] texels, evenly spread over all pages, are baked by walks with [`SAMPLES`] samples, once as
//! planned and once with each effect off; both draw the same random numbers. Air of an optical depth above [`THICKEST`] is
//! not walked: nothing is said of changes then.
//!
//! *Seconds.* The same texels are solved without air, with attenuation alone, with single scattering, and as the bake solved
//! them; what each adds to the time of the one before, never less than nothing, is its share of the stage in which pages are
//! traced. What is prepared for the air beforehand is another stage. The fastest of [`RUNS`] short runs: good to some per
//! cent, not to digits.

use crate::air::Air;
use crate::atlas::{Atlas, Page, Texel};
use crate::plan::effects::Effect;
use crate::plan::{Plan, effects};
use crate::progress::{Interrupted, Silent};
use crate::settings::EffectName;
use crate::solve::buffers::{PageBuffers, Validity};
use crate::solve::{self, LUMINANCE, LightmapSettings, Mode, Solver};
use crate::trace::Tracer;
use glam::Vec3;
use serde::Serialize;
use std::time::Instant;

/// Texels of the short bakes.
pub const TEXELS: usize = 256;
/// Samples of each.
pub const SAMPLES: u32 = 64;
/// Runs that are timed.
const RUNS: u32 = 3;
/// Optical depth of the deepest line above which no walks are taken.
pub const THICKEST: f64 = 30.0;

/// What the short bakes told.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// Texels looked at.
    pub texels: usize,
    /// What each effect that is on changed; empty in air too thick to be walked.
    pub changes: Vec<Change>,
    /// Shares of the time in which pages are traced; they sum to 1.
    pub shares: Vec<Share>,
}

/// What an effect changed: light with it less light without, in luminance over the median texel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// The effect.
    pub effect: &'static str,
    /// Mean over texels of the change's size.
    pub mean: f64,
    /// The largest.
    pub max: f64,
    /// Mean standard error of a texel's bake: what chance adds to both at most.
    pub noise: f64,
    /// What the plan had stated of the mean.
    pub bound: f64,
}

/// Part of a time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// What for.
    pub what: &'static str,
    /// In [0, 1].
    pub share: f64,
}

/// Explains a bake whose solver is ready.
///
/// # Errors
/// [`Interrupted`] when a short bake is.
pub fn explain(
    tracer: &Tracer,
    air: &Air,
    atlas: &Atlas,
    plan: &Plan,
    solver: &Solver,
) -> Result<Explanation, Interrupted> {
    let few = thinned(atlas);
    let texels = few.pages.iter().map(|page| page.texels.len()).sum();
    let pilots = Pilots { tracer, air, plan, few: &few };
    let deepest = plan.media.iter().flat_map(|medium| medium.optical_depth).fold(0.0, f64::max);
    let changes = if deepest <= THICKEST { pilots.changes()? } else { Vec::new() };
    Ok(Explanation { texels, changes, shares: pilots.shares(solver)? })
}

/// One page of texels that are evenly spread over all pages.
fn thinned(atlas: &Atlas) -> Atlas {
    let all: Vec<(&Page, &Texel)> =
        atlas.pages.iter().flat_map(|page| page.texels.iter().map(move |texel| (page, texel))).collect();
    let count = all.len().min(TEXELS);
    let mut few = Page { width: count as u32, height: 1, ..Page::default() };
    for index in 0..count {
        let (page, texel) = all[index * all.len() / count];
        let first_point = few.points.len() as u32;
        few.points.extend(page.points_of(texel));
        few.texels.push(Texel { x: index as u16, y: 0, first_point, ..*texel });
    }
    Atlas { pages: vec![few], ..Atlas::default() }
}

struct Pilots<'a, 's> {
    tracer: &'a Tracer<'s>,
    air: &'a Air,
    plan: &'a Plan,
    few: &'a Atlas,
}

impl Pilots<'_, '_> {
    /// Bakes the few texels by walks, without one of the effects.
    fn bake(&self, without: Option<EffectName>) -> Result<PageBuffers, Interrupted> {
        let (air, settings) = self.reduced(without, Mode::Walk);
        let lightmap = solve::lightmap(self.tracer, &air.media, self.few, &settings, &Silent)?;
        Ok(lightmap.pages.into_iter().next().unwrap_or_else(|| unreachable!("one page was asked for")))
    }

    /// Air and settings of a short bake without one of the effects.
    fn reduced(&self, without: Option<EffectName>, mode: Mode) -> (Air, LightmapSettings) {
        let list: Vec<Effect> = self.plan.effects.iter().map(|effect| off(effect, without)).collect();
        let mut settings = LightmapSettings { mode, sh1: false, ..self.short() };
        crate::plan::leave_out(&mut settings, &list);
        (effects::reduce(&list, self.air), settings)
    }

    fn short(&self) -> LightmapSettings {
        LightmapSettings { min_samples: SAMPLES, max_samples: SAMPLES, ..self.plan.solver.clone() }
    }

    fn changes(&self) -> Result<Vec<Change>, Interrupted> {
        let with = self.bake(None)?;
        let good: Vec<usize> = (0..with.validity.len()).filter(|&t| with.validity[t] == Validity::Good).collect();
        let level = |light: Vec3| f64::from(light.dot(LUMINANCE));
        let mut levels: Vec<f64> = good.iter().map(|&texel| level(with.total(texel))).collect();
        levels.sort_by(f64::total_cmp);
        let median = levels.get(levels.len() / 2).copied().unwrap_or(0.0);
        if median <= 0.0 {
            return Ok(Vec::new());
        }
        let mean = |of: &dyn Fn(usize) -> f64| good.iter().map(|&t| of(t)).sum::<f64>() / good.len() as f64;
        let error = mean(&|texel| level(with.variance[texel]).max(0.0).sqrt());
        // Walks know no plane of their own.
        let names = EffectName::ALL.into_iter().filter(|(_, effect)| *effect != EffectName::OwnPlane);
        let on = names.filter_map(|(name, effect)| {
            let listed = self.plan.effects.iter().find(|listed| listed.name == name && listed.on)?;
            Some((effect, listed))
        });
        on.map(|(effect, listed)| {
            let without = self.bake(Some(effect))?;
            let change = |texel: usize| level(with.total(texel) - without.total(texel)).abs() / median;
            let max = good.iter().map(|&texel| change(texel)).fold(0.0, f64::max);
            Ok(Change { effect: listed.name, mean: mean(&change), max, noise: error / median, bound: listed.bound })
        })
        .collect()
    }

    fn shares(&self, solver: &Solver) -> Result<Vec<Share>, Interrupted> {
        let mode = self.plan.solver.mode;
        let whole = self.seconds(solver, &self.short())?;
        if self.plan.mode.is_none() {
            return Ok(added(&[("surface tracing", whole)]));
        }
        let surfaces = ("surface tracing", self.seconds_without(EffectName::Attenuation, Mode::Walk)?);
        if !self.plan.simulated.scatters() {
            return Ok(added(&[surfaces, ("attenuation", whole)]));
        }
        let steps = [
            surfaces,
            ("attenuation", self.seconds_without(EffectName::Scattering, Mode::Walk)?),
            ("single scattering", self.seconds_without(EffectName::Multiple, mode)?),
            ("multiple scattering", whole),
        ];
        Ok(added(&steps))
    }

    /// The same for a bake without one of the effects, prepared for itself.
    fn seconds_without(&self, effect: EffectName, mode: Mode) -> Result<f64, Interrupted> {
        let (air, settings) = self.reduced(Some(effect), mode);
        self.seconds(&Solver::prepare(self.tracer, &air.media, &settings, &Silent)?, &settings)
    }

    /// Seconds in which the few texels are solved.
    fn seconds(&self, solver: &Solver, settings: &LightmapSettings) -> Result<f64, Interrupted> {
        let mut fastest = f64::INFINITY;
        for _ in 0..RUNS {
            let start = Instant::now();
            solver.lightmap_with(self.few, settings, &Silent)?;
            fastest = fastest.min(start.elapsed().as_secs_f64());
        }
        Ok(fastest)
    }
}

/// An effect, or its absence.
fn off(effect: &Effect, without: Option<EffectName>) -> Effect {
    let is_off = without.is_some_and(|name| name.name() == effect.name);
    Effect { on: effect.on && !is_off, ..effect.clone() }
}

/// What each step adds to the ones before, as shares of the last; times that fall count as nothing added.
fn added(steps: &[(&'static str, f64)]) -> Vec<Share> {
    let mut reached = 0.0;
    let mut shares: Vec<Share> = Vec::new();
    for &(what, seconds) in steps {
        shares.push(Share { what, share: f64::max(seconds - reached, 0.0) });
        reached = f64::max(reached, seconds);
    }
    let sum: f64 = shares.iter().map(|share| share.share).sum();
    shares.iter_mut().for_each(|share| share.share /= sum.max(f64::MIN_POSITIVE));
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_step_adds_is_its_share() {
        let shares = |steps: &[(&'static str, f64)]| added(steps).iter().map(|s| s.share).collect::<Vec<f64>>();
        assert_eq!(shares(&[("a", 1.0), ("b", 3.0), ("c", 4.0)]), [0.25, 0.5, 0.25]);
        assert_eq!(shares(&[("a", 2.0), ("b", 1.0), ("c", 4.0)]), [0.5, 0.0, 0.5], "a shorter run adds nothing");
    }

    #[test]
    fn few_texels_are_spread_over_all_pages() {
        let mut atlas = crate::test_scenes::quad_atlas(32);
        atlas.pages.push(atlas.pages[0].clone());
        let few = thinned(&atlas);
        let page = &few.pages[0];
        assert_eq!((few.pages.len(), page.texels.len(), page.width), (1, TEXELS, TEXELS as u32));
        let taken: Vec<_> = page.texels.iter().map(|texel| page.points_of(texel)[0].barycentric).collect();
        assert_eq!(taken[0], taken[TEXELS / 2], "the second page begins half way");
    }
}
