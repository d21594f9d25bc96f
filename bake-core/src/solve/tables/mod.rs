//! Light through air by tables: surface paths only, and at every vertex the air's part looked up.
//!
//! A path weighs the radiance of its next vertex by what the air lets through and by what it scatters from there to the vertex
//! (the table of a surface element, Dubouchet et al. 2019). Emitters are looked up by next-event estimation; light of lamps
//! and suns that scatters once is sampled with its real distribution and shadows, because tables know neither. Rays that escape are
//! sources at the medium's boundary. Surfaces on the receiver's own plane, which no ray from it meets, are drawn on their own.
//! Tables are those of an infinite medium: [`factors`] bring them to the scene.

mod ahead;
pub mod factors;
pub mod medium;
pub mod responses;
mod sources;
mod stations;
mod stray;

use super::emitters::Strategy;
use super::media::Media;
use super::path::{Counters, Draw, Gather, Gathered, Paths, Vertex};
use super::sampler::Sampler;
use crate::trace::Tracer;
use ahead::Ahead;
use bake_formats::Term;
use factors::{Effort, Factors};
use glam::Vec3;
use medium::Tabled;
use responses::{Lobe, Responses};
use std::f32::consts::PI;

/// One sample of so many looks at the own plane of a path's first vertex.
const BESIDE_EVERY: f32 = 3.0;
/// Share of later vertices at which a path goes on from the own plane.
const BESIDE_SHARE: f32 = 0.2;
/// Reflections after which Russian roulette may end a path.
const ROULETTE_FROM: u32 = 2;
/// Reflections after which a path is cut even when nothing absorbs.
const LONGEST_PATH: u32 = 1024;

/// A scene as looks into it see it.
pub(super) struct View<'a, 's> {
    paths: Paths<'a, 's, Tabled<'a>>,
    /// Typical size of walls, metres.
    wall: f32,
}

/// Follows surface paths and looks up what the air adds.
pub struct TablePaths<'a, 's> {
    view: View<'a, 's>,
    responses: Responses<'a>,
    factors: Factors,
}

/// Where a path goes on, and what its radiance there weighs in each term.
struct Next {
    vertex: Vertex,
    prefix: [Vec3; 4],
}

impl<'a, 's> TablePaths<'a, 's> {
    /// Prepares tables and measures factors.
    pub fn new(paths: Paths<'a, 's, Tabled<'a>>, effort: Effort, seed: u32) -> Self {
        let mut responses = Responses::new(paths.media, &paths.tracer.scene().lights);
        let mut view = View { paths, wall: 1.0 };
        let factors = Factors::new(&mut view, &mut responses, effort, seed);
        Self { view, responses, factors }
    }

    /// The factors in use.
    pub fn factors(&self) -> &Factors {
        &self.factors
    }

    /// What scatters onto a vertex of light straight from emitters, but for suns' and the sky's first collision. A path's later
    /// vertices draw one of two estimates.
    fn lit_through_air(&self, vertex: &Vertex, is_first: bool, air: &mut Sampler, counters: &Counters) -> Lobe {
        let mut lobe = [Vec3::ZERO; 2];
        let numbers = air.next4();
        let has_lamps = self.view.paths.emitters.has_lamps();
        let (around, finite) = match (is_first, has_lamps) {
            (false, true) if numbers[3] < 0.5 => (2.0, 0.0),
            (false, true) => (0.0, 2.0),
            _ => (1.0, 1.0),
        };
        if around > 0.0
            && let Some((radiance, _, cos)) = self.view.paths.lamps_around(vertex, air, counters)
        {
            lobe[0] += radiance * (cos * around);
        }
        if finite > 0.0
            && let Some(found) = self.view.finite_lobe(vertex, numbers, &self.responses, &self.factors, counters)
        {
            lobe.iter_mut().zip(found).for_each(|(l, f)| *l += f * finite);
        }
        lobe[1] += self.view.sun_lobe(vertex, &self.responses, &self.factors);
        lobe
    }

    /// What arrives along a look straight from emitters: attenuated, and scattered from a sun on the way or from the sky
    /// where the look escapes.
    fn along(
        &self,
        vertex: &Vertex,
        ahead: &Ahead,
        draws: f32,
        nu_sky: Vec3,
        air: &mut Sampler,
        counters: &Counters,
    ) -> [Vec3; 4] {
        let mut terms = [Vec3::ZERO; 4];
        let paths = &self.view.paths;
        let received = ahead.cos / ahead.pdf;
        terms[Term::Direct as usize] =
            ahead.passed() * paths.emitted(vertex, ahead.dir, ahead.pdf, draws, &ahead.arrival) * received;
        terms[Term::Single as usize] = self.suns_along(ahead, air, counters) * received;
        if ahead.arrival.hit.is_none() {
            let radiance = paths.emitters.environment(ahead.dir) * ahead.arrival.passed;
            if radiance != Vec3::ZERO {
                let [once, more] = self.responses.distant(&ahead.leg, ahead.depth, ahead.cos);
                terms[Term::Single as usize] += nu_sky * once * radiance / ahead.pdf;
                terms[Term::Multiple as usize] += nu_sky * more * radiance / ahead.pdf;
            }
        }
        terms
    }

    /// Radiance of suns' light that is scattered once on a leg.
    fn suns_along(&self, ahead: &Ahead, air: &mut Sampler, counters: &Counters) -> Vec3 {
        let paths = &self.view.paths;
        let mut suns = paths.emitters.strategies().iter().filter(|s| matches!(s, Strategy::Directional(_)));
        let count = suns.clone().count();
        if count == 0 {
            return Vec3::ZERO;
        }
        let [pick, a, b, c] = air.next4();
        let Some(&sun) = suns.nth((pick * count as f32) as usize) else { return Vec3::ZERO };
        let Some((distance, weight)) = paths.media.collide(&ahead.leg, Vec3::ONE, [a, b]) else { return Vec3::ZERO };
        let point = ahead.leg.at(distance);
        let Some((irradiance, towards, _)) = paths.draw_at(point, sun, [c, pick, a], counters) else {
            return Vec3::ZERO;
        };
        let scatter = paths.media.scatter(point, ahead.dir, towards);
        weight * ahead.arrival.passed_before(distance) * scatter * irradiance * count as f32
    }

    /// On to the surface ahead.
    fn onward(&self, vertex: &Vertex, ahead: &Ahead, lobe: f32, nu: Vec3) -> Option<Next> {
        let (hit, place, surface) = ahead.arrival.hit.as_ref()?;
        let (next, weight) = self.view.paths.scatter(hit, place, surface, lobe)?;
        let [once, more] = ahead.scattered(vertex, &self.responses);
        let attenuated = ahead.passed() * (ahead.cos / ahead.pdf);
        let reflected = weight / PI;
        Some(Next { vertex: next, prefix: [Vec3::ZERO, attenuated, nu * once, nu * more].map(|w| w * reflected) })
    }

    /// On to a point of the vertex's own plane.
    fn aside(&self, vertex: &Vertex, [u, v, lobe]: [f32; 3], nu: Vec3, counters: &Counters) -> Option<Next> {
        let beside = self.view.beside(vertex, [u, v], counters)?;
        let surface = beside.surface(self.view.paths.tracer.scene());
        let (next, weight) = self.view.paths.scatter(&beside.hit, &beside.place, &surface, lobe)?;
        let [once, more] = beside.scattered(vertex, &self.responses);
        let reflected = nu * weight / PI;
        Some(Next { vertex: next, prefix: [Vec3::ZERO, Vec3::ZERO, once * reflected, more * reflected] })
    }

    /// Adds what is gathered from `next` on to the terms.
    fn follow(
        &self,
        next: Next,
        terms: &mut [Vec3; 4],
        (sampler, air): (&mut Sampler, &mut Sampler),
        counters: &Counters,
    ) {
        let Next { mut vertex, prefix } = next;
        let total: Vec3 = prefix.into_iter().sum();
        let mut throughput = Vec3::ONE;
        // In closed rooms other surfaces stand for the own plane: it is one among many there, and far from the texel.
        let closed = self.factors.report.escaped == 0.0;
        let share = if closed { 0.0 } else { BESIDE_SHARE };
        for bounce in 1u32.. {
            let [pick, u, v, survive] = sampler.next4();
            let strategies = self.view.paths.emitters.strategies();
            let draws = 1.0 / strategies.len().max(1) as f32;
            let local = self.factors.at(&vertex);
            let mut arrived = Vec3::ZERO;
            if !strategies.is_empty() {
                let place = pick * strategies.len() as f32;
                let strategy = strategies[(place as usize).min(strategies.len() - 1)];
                let drawn = self.view.paths.draw(
                    Draw { strategy, share: draws, is_first: false },
                    &vertex,
                    [place.fract(), u, v],
                    counters,
                );
                arrived += drawn.map_or(Vec3::ZERO, |(irradiance, _, cos)| irradiance * cos);
            }
            let [once, more] = self.lit_through_air(&vertex, false, air, counters);
            arrived += (once + more) * local.air;
            let [a, b, crossing, lobe] = sampler.next4();
            let ahead = self.view.look(&vertex, [a, b, crossing], counters);
            if let Some(ahead) = &ahead {
                arrived += self.along(&vertex, ahead, draws, local.sky, air, counters).into_iter().sum::<Vec3>();
            }
            terms.iter_mut().zip(prefix).for_each(|(t, p)| *t += p * throughput * arrived);
            if bounce >= self.view.paths.bounces {
                return;
            }
            if bounce >= LONGEST_PATH {
                counters.cut_paths.set(counters.cut_paths.get() + 1);
                return;
            }
            let [choice, e, f, _] = air.next4();
            let (next, probability) = if choice < share {
                (self.aside(&vertex, [e, f, lobe], local.surfaces, counters), share)
            } else {
                let nu = if closed { local.surfaces_ahead } else { local.surfaces };
                (ahead.and_then(|ahead| self.onward(&vertex, &ahead, lobe, nu)), 1.0 - share)
            };
            let Some(next) = next else { return };
            throughput *= next.prefix.into_iter().sum::<Vec3>() / probability;
            vertex = next.vertex;
            if bounce >= ROULETTE_FROM {
                let survival = (throughput * total).max_element().min(1.0);
                if survive >= survival {
                    return;
                }
                throughput /= survival;
            }
        }
    }
}

impl Gather for TablePaths<'_, '_> {
    const TERMS: &'static [Term] = &Term::ALL;

    fn tracer(&self) -> &Tracer<'_> {
        self.view.paths.tracer
    }

    fn gather(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Gathered {
        let mut gathered = Gathered::default();
        let terms = &mut gathered.terms;
        let paths = &self.view.paths;
        for &strategy in paths.emitters.strategies() {
            let [u, v, w, _] = sampler.next4();
            let drawn = paths.draw(Draw::first(strategy), start, [u, v, w], counters);
            terms[Term::Direct as usize] += drawn.map_or(Vec3::ZERO, |(irradiance, _, cos)| irradiance * cos);
        }
        let mut air = sampler.fork();
        let [once, more] = self.lit_through_air(start, true, &mut air, counters);
        let local = self.factors.at(start);
        terms[Term::Single as usize] += once * local.air;
        terms[Term::Multiple as usize] += more * local.air;
        let [u, v, crossing, lobe] = sampler.next4();
        if let Some(ahead) = self.view.look(start, [u, v, crossing], counters) {
            let straight = self.along(start, &ahead, 1.0, local.sky, &mut air, counters);
            terms.iter_mut().zip(straight).for_each(|(t, s)| *t += s);
            if paths.bounces > 0
                && let Some(next) = self.onward(start, &ahead, lobe, local.surfaces)
            {
                self.follow(next, terms, (sampler, &mut air), counters);
            }
        }
        let mut second = air.fork();
        let [choice, a, b, c] = second.next4();
        if choice * BESIDE_EVERY < 1.0
            && paths.bounces > 0
            && let Some(mut next) = self.aside(start, [a, b, c], local.surfaces, counters)
        {
            next.prefix = next.prefix.map(|p| p * BESIDE_EVERY);
            let mut more_air = second.fork();
            self.follow(next, terms, (&mut second, &mut more_air), counters);
        }
        gathered
    }
}
