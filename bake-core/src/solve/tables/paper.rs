//! Light through air as Dubouchet et al. 2019 publish it, without any correction: here to show its bias.
//!
//! Responses of an infinite medium, ten orders summed, read at optical distances and scaled by sigma_r²; once-scattered light
//! interpolated between tables of three mean cosines (areas about a fitted axis, eight angles), the orders above by
//! similarity with (1 − g) sigma_s; emitters only where they are seen; rays over the whole sphere from a point shifted off the surface by
//! 0.125 m, so that scattering from behind and beside is found. Distances are those from the unshifted point and the Jacobian
//! is the shifted one: with distances of zero, as the paper has it, what is beside would count nothing. Orders above the first
//! of areas are not fitted, and suns' are read at distances along their light. Nothing is normalised.

use super::View;
use super::medium::Tabled;
use super::sources::Seen;
use crate::scene::LightKind;
use crate::solve::emitters::{Source, Strategy, Target, punctual};
use crate::solve::media::{Leg, Media};
use crate::solve::path::{Counters, Gather, Gathered, Paths, Vertex};
use crate::solve::sampler::Sampler;
use crate::solve::warp;
use crate::trace::{Ray, Tracer};
use ::tables::{Air, AxialResponse, Geometry, Scatter, TableSet, ZonalResponse};
use bake_formats::Term;
use bake_optics::medium::Medium;
use bake_optics::phase::Phase;
use glam::Vec3;
use std::f32::consts::PI;

/// Orders summed.
const ORDERS: usize = 10;
/// Shift of the point from which rays go, metres.
const SHIFT: f32 = 0.125;
/// Smallest cosine at the emitter; only keeps a quotient finite.
const SMALLEST_COSINE: f32 = 1e-3;
/// Reflections after which Russian roulette may end a path.
const ROULETTE_FROM: u32 = 2;
/// Reflections after which a path is cut even when nothing absorbs.
const LONGEST_PATH: u32 = 1024;

/// The published method.
pub struct PaperPaths<'a, 's> {
    view: View<'a, 's>,
    /// By medium, then channel.
    media: Vec<[Channel; 3]>,
}

/// Responses, once and more often.
struct Channel {
    area: [AxialResponse; 2],
    point: [ZonalResponse; 2],
    distant: [ZonalResponse; 2],
    /// Extinction at which these are read over the true one: similarity for the orders above the first.
    thinner: [f32; 2],
}

/// A surface met from the shifted point, as the vertex sees it.
struct Met {
    leg: Leg,
    axis: Vec3,
    /// Inverse density per area, m².
    weight: f32,
}

impl Channel {
    fn new(set: &TableSet, medium: &Medium, c: usize) -> Self {
        let g = medium.phase.mean_cosine();
        let (sigma_s, sigma_t) = (medium.scatter.sigma_s[c], medium.scatter.sigma_t()[c]);
        let share = |s: f64, t: f64| if t > 0.0 { s / t } else { 0.0 };
        let reduced = sigma_t - g * sigma_s;
        let once = Air { albedo: share(sigma_s, sigma_t), phase: medium.phase.clone() };
        let more = Air { albedo: share((1.0 - g) * sigma_s, reduced), phase: Phase::Isotropic };
        let (single, multiple) = (Scatter::Single, Scatter::Multiple(ORDERS));
        Self {
            area: [set.area(&once, single), set.area(&more, multiple)],
            point: [set.point(&once, single), set.point(&more, multiple)],
            distant: [set.directional(&once, single), set.directional(&more, multiple)],
            thinner: [1.0, share(reduced, sigma_t) as f32],
        }
    }
}

impl<'a, 's> PaperPaths<'a, 's> {
    /// Prepares tables of a set, [`TableSet::published`] for all of the published method; the media are not reduced.
    pub fn new(paths: Paths<'a, 's, Tabled<'a>>, set: &TableSet) -> Self {
        let prepare = |medium: &Medium| std::array::from_fn(|c| Channel::new(set, medium, c));
        let media = paths.media.set().media.iter().map(prepare).collect();
        let view = View { paths, wall: 1.0, extent: 1.0, region: [Vec3::ZERO; 2], is_closed: false, own_plane: false };
        Self { view, media }
    }

    /// Once and more often scattered light of all media and channels, in proportion to their optical depths on the leg.
    fn look_up(&self, leg: &Leg, look_up: impl Fn(&Channel, usize, f32) -> f32) -> [Vec3; 2] {
        let depth = self.view.paths.media.depth(leg);
        let ray = leg.ray();
        let mut sums = [Vec3::ZERO; 2];
        for (medium, channels) in self.view.paths.media.set().media.iter().zip(&self.media) {
            let length = medium.optical_length(&ray);
            for (c, channel) in channels.iter().enumerate() {
                let own = (medium.scatter.sigma_t()[c] * length) as f32;
                // Rounding may leave a leg that only touches the air with a length but no depth; nothing comes from air without end.
                if own > 0.0 && depth[c] > 0.0 && depth[c].is_finite() {
                    for (order, sum) in sums.iter_mut().enumerate() {
                        let found = look_up(channel, order, depth[c] * channel.thinner[order]);
                        sum[c] += found.max(0.0) * own / depth[c];
                    }
                }
            }
        }
        sums
    }

    fn area(&self, vertex: &Vertex, leg: &Leg, axis: Vec3) -> [Vec3; 2] {
        let geometry = Geometry::new(vertex.normal_shading, leg.dir, axis);
        self.look_up(leg, |channel, order, depth| {
            channel.area[order].irradiance(depth / leg.length, leg.length, &geometry)
        })
    }

    fn distant(&self, vertex: &Vertex, leg: &Leg) -> [Vec3; 2] {
        let cos = vertex.normal_shading.dot(leg.dir);
        self.look_up(leg, |channel, order, depth| channel.distant[order].irradiance(1.0, depth, cos))
    }

    /// What arrives from emitters in sight, by term.
    fn emitters(&self, vertex: &Vertex, sampler: &mut Sampler, counters: &Counters) -> [Vec3; 4] {
        let mut terms = [Vec3::ZERO; 4];
        for &strategy in self.view.paths.emitters.strategies() {
            let numbers = sampler.next4();
            let found = match strategy {
                Strategy::Directional(light) => self.sun(vertex, strategy, light, numbers, counters),
                Strategy::Environment => None,
                _ => self.finite(vertex, numbers, counters),
            };
            let (direct, [once, more]) = found.unwrap_or_default();
            terms[Term::Direct as usize] += direct;
            terms[Term::Single as usize] += once;
            terms[Term::Multiple as usize] += more;
        }
        terms
    }

    fn finite(&self, vertex: &Vertex, [u, v, w, _]: [f32; 4], counters: &Counters) -> Option<(Vec3, [Vec3; 2])> {
        let paths = &self.view.paths;
        let (index, probability) = paths.emitters.around(vertex.origin, u)?;
        let source = paths.emitters.source(paths.tracer, index, v, w);
        counters.shadow_rays.set(counters.shadow_rays.get() + 1);
        let (Seen { axis, strength }, leg) = self.view.sees(vertex, &source)?;
        let cos = vertex.normal_shading.dot(leg.dir);
        let (strength, shape, lobes) = match source {
            // The table of an isotropic light times what this one sends here.
            Source::Lamp { light, .. } => {
                let lobes = self.look_up(&leg, |channel, order, depth| {
                    channel.point[order].irradiance(depth / leg.length, leg.length, cos)
                });
                (strength * punctual::shape(light, -leg.dir), 1.0, lobes)
            }
            Source::Patch { .. } => (strength, -axis.dot(leg.dir), self.area(vertex, &leg, axis)),
        };
        let strength = strength / probability;
        let attenuated = paths.media.transmittance(&leg) * (cos.max(0.0) * shape.max(0.0) / (leg.length * leg.length));
        Some((strength * attenuated, lobes.map(|lobe| strength * lobe)))
    }

    fn sun(
        &self,
        vertex: &Vertex,
        strategy: Strategy,
        light: u32,
        [u, v, w, _]: [f32; 4],
        counters: &Counters,
    ) -> Option<(Vec3, [Vec3; 2])> {
        let paths = &self.view.paths;
        let drawn = paths.emitters.sample(paths.tracer, strategy, vertex.origin, Vec3::ZERO, [u, v, w])?;
        let (Target::Direction(dir), LightKind::Directional { .. }) =
            (drawn.target, &paths.tracer.scene().lights[light as usize].kind)
        else {
            return None;
        };
        let leg = Leg { origin: vertex.origin, dir, length: f32::INFINITY };
        counters.shadow_rays.set(counters.shadow_rays.get() + 1);
        let passed = paths.tracer.transmittance(&Ray { origin: leg.origin, dir, t_max: leg.length });
        if passed == Vec3::ZERO {
            return None;
        }
        let strength = drawn.irradiance * passed;
        let cos = vertex.normal_shading.dot(dir).max(0.0);
        Some((strength * paths.media.transmittance(&leg) * cos, self.distant(vertex, &leg).map(|l| strength * l)))
    }

    /// Irradiance by term of the sky where a look escapes.
    fn sky(&self, vertex: &Vertex, dir: Vec3, passed: Vec3) -> [Vec3; 4] {
        let leg = Leg { origin: vertex.origin, dir, length: f32::INFINITY };
        let radiance = self.view.paths.emitters.environment(dir) * passed * (4.0 * PI);
        if radiance == Vec3::ZERO {
            return [Vec3::ZERO; 4];
        }
        let direct = self.view.paths.media.transmittance(&leg) * vertex.normal_shading.dot(dir).max(0.0);
        let [once, more] = self.distant(vertex, &leg);
        [direct * radiance, Vec3::ZERO, once * radiance, more * radiance]
    }

    /// Irradiance at the vertex by term, per radiance that leaves what was met.
    fn weights(&self, vertex: &Vertex, met: &Met) -> [Vec3; 4] {
        let Met { leg, axis, weight } = met;
        let cosines = vertex.normal_shading.dot(leg.dir).max(0.0) * -axis.dot(leg.dir).min(0.0);
        let attenuated = self.view.paths.media.transmittance(leg) * (cosines / (leg.length * leg.length));
        let [once, more] = self.area(vertex, leg, *axis);
        [Vec3::ZERO, attenuated * *weight, once * *weight, more * *weight]
    }
}

impl Gather for PaperPaths<'_, '_> {
    const TERMS: &'static [Term] = &Term::ALL;

    fn tracer(&self) -> &Tracer<'_> {
        self.view.paths.tracer
    }

    fn gather(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Gathered {
        let paths = &self.view.paths;
        let mut terms = [Vec3::ZERO; 4];
        // What the light at the vertex weighs in each term; at the start terms fall as they come.
        let (mut vertex, mut weights) = (*start, None::<[Vec3; 4]>);
        for bounce in 0.. {
            let mut arrived = self.emitters(&vertex, sampler, counters);
            let [u, v, crossing, lobe] = sampler.next4();
            let (origin, dir) = (vertex.origin + SHIFT * vertex.normal_geom, warp::uniform_sphere(u, v));
            let arrival = paths.travel(origin, dir, crossing, counters);
            if arrival.hit.is_none() {
                let sky = self.sky(&vertex, dir, arrival.passed);
                arrived.iter_mut().zip(sky).for_each(|(a, s)| *a += s);
            }
            match &weights {
                None => terms = arrived,
                Some(weights) => {
                    let all: Vec3 = arrived.into_iter().sum();
                    terms.iter_mut().zip(weights).for_each(|(t, w)| *t += *w * all);
                }
            }
            if bounce >= paths.bounces.min(LONGEST_PATH) {
                break;
            }
            let Some((hit, place, surface)) = &arrival.hit else { break };
            let way = place.point.position - vertex.origin;
            let Some(true_dir) = way.try_normalize() else { break };
            let shifted_cos = -place.normal_geom.dot(dir);
            let met = Met {
                leg: Leg { origin: vertex.origin, dir: true_dir, length: way.length() },
                axis: place.normal_geom * shifted_cos.signum(),
                weight: arrival.distance * arrival.distance * 4.0 * PI / shifted_cos.abs().max(SMALLEST_COSINE),
            };
            let Some((next, albedo)) = paths.scatter(hit, place, surface, lobe) else { break };
            let reflected = albedo * arrival.passed / PI;
            let step = self.weights(&vertex, &met).map(|w| w * reflected);
            let mut onward = match weights {
                None => step,
                Some(weights) => {
                    let all: Vec3 = step.into_iter().sum();
                    weights.map(|w| w * all)
                }
            };
            if bounce >= ROULETTE_FROM {
                let survival = onward.iter().sum::<Vec3>().max_element().min(1.0);
                if sampler.next4()[3] >= survival {
                    break;
                }
                onward = onward.map(|w| w / survival);
            }
            (vertex, weights) = (next, Some(onward));
        }
        Gathered { terms, ..Gathered::default() }
    }
}
