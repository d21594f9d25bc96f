//! What brings tables of an infinite medium to a finite scene: factors measured once for the whole scene.
//!
//! Light that scatters from surfaces to a point x, with radiance 1 everywhere, is known without tables: it is what random
//! walks from x bring back, `π ⟨α^k; k ≥ 1, ends on a surface⟩`. Its quotient by what the tables say is `nu_surf(x)`; in a closed room
//! that absorbs nothing it needs no walks, since the mean is `1 − ⟨T⟩`. The sky has its own factor, each light (group) one for
//! the light that it sends to all surfaces. Sums stop at the number of collisions whose factors are nearest to 1.

use super::View;
use super::fold::sight;
use super::responses::{ORDERS, Responses};
use super::sources::{Flux, Lit, groups};
use super::stations::Stations;
use crate::scene::LightKind;
use crate::solve::Effort;
use crate::solve::path::{Counters, Vertex};
use crate::solve::sampler::{Sampler, hash};
use glam::Vec3;
use rayon::prelude::*;

/// Bounds of every factor.
pub const RANGE: (f32, f32) = (0.05, 6.0);

/// Stations and directions by which openness and size of a scene are judged.
const SURVEY: (usize, u32) = (256, 32);
/// Share of the walls' size below which most of what is ahead makes a crack.
const CRACK: f32 = 0.01;
/// Logarithms of a light's factor by which sums of orders are not told apart: other stations move it by 0.04.
const ALIKE: f32 = 0.05;
/// One of so many directions has a look at the own plane.
const BESIDE_EVERY: u32 = 2;
/// One of so many directions has a walk.
const WALK_EVERY: u32 = 4;

/// Factors of a scene, per channel.
pub struct Factors {
    /// By finite emitter; of lamps for light scattered more than once.
    pub emitters: Vec<Vec3>,
    /// By light of the scene.
    pub suns: Vec<Vec3>,
    stations: Stations,
    /// By station.
    known: Vec<Sums>,
    /// By station, what is known around it.
    locals: Vec<Local>,
    /// Means over stations, for points that have none near.
    mean: Local,
    /// What to tell of it.
    pub report: Report,
}

/// What is known at a point of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Local {
    /// Factor of surfaces.
    pub surfaces: Vec3,
    /// The same where those of the own plane are left out and the others stand for them.
    pub surfaces_ahead: Vec3,
    /// Factor of the sky.
    pub sky: Vec3,
    /// 1 where there is air in sight, 0 where there is none: tables would find light through walls.
    pub air: f32,
}

/// Sums over nearby stations, of which factors are quotients: a mean of quotients would be too large where they are noisy.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    /// By walks: from surfaces of radiance 1, and from the sky.
    walked: [Vec3; 2],
    /// By tables: from surfaces ahead, from all surfaces, from the sky.
    looked_up: [Vec3; 3],
    air: f32,
    weight: f32,
}

impl Sums {
    fn add(&mut self, other: &Self, weight: f32) {
        self.walked.iter_mut().zip(other.walked).for_each(|(s, w)| *s += weight * w);
        self.looked_up.iter_mut().zip(other.looked_up).for_each(|(s, l)| *s += weight * l);
        self.air += weight * other.air;
        self.weight += weight * other.weight;
    }

    fn local(&self) -> Local {
        Local {
            surfaces: factor(self.walked[0], self.looked_up[1]),
            surfaces_ahead: factor(self.walked[0], self.looked_up[0]),
            sky: factor(self.walked[1], self.looked_up[2]),
            air: self.air / self.weight.max(f32::MIN_POSITIVE),
        }
    }
}

/// How far tables had to be corrected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Numbers of collisions up to which tables are summed, per channel.
    pub orders: [usize; 3],
    /// Smallest, mean and largest factor of surfaces.
    pub surfaces: [f32; 3],
    /// Smallest and largest factor of emitters and suns; 1 where there are none.
    pub emitters: [f32; 2],
    /// Mean share of light that the air stops on its way from a surface to the next.
    pub opacity: f32,
    /// Share of rays that leave the scene.
    pub escaped: f32,
    /// Share of stations at which a factor met its bound.
    pub clamped: f32,
}

/// Sums at one station.
#[derive(Clone, Copy, Default)]
struct Measured {
    /// By walks: from surfaces of radiance 1, and from the sky.
    walked: [Vec3; 2],
    /// By tables for each of [`ORDERS`]: from surfaces of radiance 1 ahead, and on the own plane.
    surfaces: [Vec3; ORDERS.len()],
    beside: [Vec3; ORDERS.len()],
    /// From the sky.
    sky: [Vec3; ORDERS.len()],
    opacity: f32,
    /// Looks, and those that meet a surface at once.
    looks: u32,
    short: u32,
}

impl Measured {
    fn air(&self) -> f32 {
        if self.opacity > 0.0 { 1.0 } else { 0.0 }
    }

    fn all_surfaces(&self, k: usize) -> Vec3 {
        self.surfaces[k] + self.beside[k]
    }

    fn sums(&self, chosen: [usize; 3]) -> Sums {
        let all = std::array::from_fn(|k| self.all_surfaces(k));
        Sums {
            walked: self.walked,
            looked_up: [&self.surfaces, &all, &self.sky].map(|sums| in_channels(sums, chosen)),
            air: self.air(),
            weight: 1.0,
        }
    }
}

/// What is known of a scene before stations are measured.
pub(super) struct Survey {
    /// Mean distance to the next surface.
    pub distance: f32,
    /// Share of rays that meet none.
    pub escaped: f32,
}

impl View<'_, '_> {
    /// Looks around in the scene.
    pub(super) fn survey(&self, stations: &Stations, seed: u32) -> Survey {
        let step = stations.vertices.len().div_ceil(SURVEY.0).max(1);
        let chosen: Vec<&Vertex> = stations.vertices.iter().step_by(step).collect();
        let (mut sum, mut hits, mut rays) = (0.0f64, 0u32, 0u32);
        for (i, vertex) in chosen.into_iter().enumerate() {
            for sample in 0..SURVEY.1 {
                let [u, v, w, _] = Sampler::new(sample, hash(seed, i as u32)).next4();
                let Some(ahead) = self.look(vertex, [u, v, w], &Counters::default()) else { continue };
                rays += 1;
                if ahead.arrival.hit.is_some() {
                    hits += 1;
                    sum += f64::from(ahead.leg.length);
                }
            }
        }
        let distance = if hits > 0 { (sum / f64::from(hits)) as f32 } else { 1.0 };
        Survey { distance, escaped: if rays > 0 { 1.0 - hits as f32 / rays as f32 } else { 1.0 } }
    }

    fn measure(&self, vertex: &Vertex, responses: &Responses, rays: u32, seed: u32) -> Measured {
        let mut sums = Measured::default();
        let counters = Counters::default();
        // Nothing is lost: every walk comes back.
        let all_return = self.is_closed && self.paths.media.is_conservative();
        for sample in 0..rays {
            let mut sampler = Sampler::new(sample, seed);
            let ([u, v, crossing, _], [a, b, ..]) = (sampler.next4(), sampler.next4());
            if self.own_plane
                && sample % BESIDE_EVERY == 0
                && let Some(beside) = self.beside(vertex, [a, b], &counters)
            {
                let depth = self.paths.media.depth(&beside.leg);
                let step = beside.step();
                let sight = sight(vertex.normal_shading, &beside.leg, depth, &step);
                let [once, more @ ..] = responses.area_of_all(&sight);
                let weight = step.weight * BESIDE_EVERY as f32;
                sums.beside.iter_mut().zip(more).for_each(|(s, m)| *s += (once + m) * weight);
            }
            let Some(ahead) = self.look(vertex, [u, v, crossing], &counters) else { continue };
            sums.looks += 1;
            sums.short += u32::from(ahead.leg.length < CRACK * self.wall);
            let received = ahead.cos / ahead.pdf;
            let depth = self.paths.media.depth(&ahead.leg);
            let opacity = Vec3::ONE - depth.map(|d| (-d).exp());
            sums.opacity += received * opacity.element_sum() / 3.0;
            if all_return {
                sums.walked[0] += received * opacity;
            } else if sample % WALK_EVERY == 0
                && let Some(stray) = self.stray(&ahead.leg, &ahead.arrival, &mut sampler, &counters)
            {
                let weight = stray.weight * (received * WALK_EVERY as f32);
                match stray.exit {
                    None => sums.walked[0] += weight,
                    Some(dir) => sums.walked[1] += weight * self.paths.emitters.environment(dir),
                }
            }
            if let Some(step) = ahead.step() {
                let sight = sight(vertex.normal_shading, &ahead.leg, depth, &step);
                let [once, more @ ..] = responses.area_of_all(&sight);
                let weight = step.weight * step.reflect;
                sums.surfaces.iter_mut().zip(more).for_each(|(s, m)| *s += weight * (once + m));
            } else {
                let radiance = self.paths.emitters.environment(ahead.leg.dir) * ahead.arrival.passed;
                let [once, more @ ..] = responses.distant_of_all(&ahead.leg, depth, ahead.cos);
                sums.sky.iter_mut().zip(more).for_each(|(s, m)| *s += (once + m) * radiance / ahead.pdf);
            }
        }
        sums.opacity /= std::f32::consts::PI * rays as f32;
        sums
    }
}

impl Factors {
    /// Measures them and chooses how many orders are summed, in `responses`.
    pub(super) fn new(view: &mut View, responses: &mut Responses, effort: Effort, seed: u32) -> Self {
        let tracer = view.paths.tracer;
        let mut stations = Stations::new(tracer, effort.stations);
        let survey = view.survey(&stations, hash(seed, 1));
        view.wall = 1.5 * survey.distance;
        view.region = view.region_of(&stations);
        view.extent = (view.region[1] - view.region[0]).length().clamp(f32::MIN_POSITIVE, f32::MAX);
        view.is_closed = survey.escaped == 0.0;
        let view = &*view;
        let measure =
            |(i, vertex): (usize, &Vertex)| view.measure(vertex, responses, effort.rays, hash(hash(seed, 2), i as u32));
        let measured: Vec<Measured> = stations.vertices.par_iter().enumerate().map(measure).collect();
        // What looks into a crack, as behind a lamp on a wall, must not speak for what is around it.
        let covered: Vec<bool> = measured.iter().map(|m| 4 * m.short > 3 * m.looks).collect();
        let measured = stations.retain(measured, &covered);
        let lit = Lit { stations: &stations, air: measured.iter().map(Measured::air).collect() };
        let groups = groups(view);
        let fluxes: Vec<Flux> = groups
            .iter()
            .enumerate()
            .map(|(i, members)| view.flux(members, groups.len(), &lit, responses, hash(hash(seed, 3), i as u32)))
            .collect();
        let lights = &tracer.scene().lights;
        let suns: Vec<Option<Flux>> = (0..lights.len())
            .map(|i| {
                let is_sun = matches!(lights[i].kind, LightKind::Directional { .. });
                is_sun.then(|| view.sun_flux(i as u32, &lit, responses, hash(hash(seed, 4), i as u32)))
            })
            .collect();
        let sources: Vec<&Flux> = fluxes.iter().chain(suns.iter().flatten()).collect();
        let asked = effort.orders.map(|most| ORDERS.iter().position(|&k| k >= most).unwrap_or(ORDERS.len() - 1));
        responses.chosen = std::array::from_fn(|c| asked.unwrap_or_else(|| chosen_sum(&sources, &measured, c)));
        let of = |flux: &Flux| factor(flux.walked, in_channels(&flux.looked_up, responses.chosen));
        let mut emitters = vec![Vec3::ONE; view.paths.emitters.finite_count()];
        for (members, flux) in groups.iter().zip(&fluxes) {
            members.iter().for_each(|&(index, _)| emitters[index as usize] = of(flux));
        }
        let suns: Vec<Vec3> = suns.iter().map(|flux| flux.as_ref().map_or(Vec3::ONE, of)).collect();
        let known: Vec<Sums> = measured.iter().map(|m| m.sums(responses.chosen)).collect();
        let mut mean = Sums::default();
        known.iter().for_each(|sums| mean.add(sums, 1.0));
        let mean = mean.local();
        let report = report(&known, &measured, emitters.iter().chain(&suns), responses.chosen, survey.escaped);
        let mut factors = Self { emitters, suns, stations, known, locals: vec![], mean, report };
        factors.locals = factors.stations.vertices.par_iter().map(|vertex| factors.at(vertex)).collect();
        factors
    }

    /// Where they were measured.
    pub(in crate::solve) fn stations(&self) -> &Stations {
        &self.stations
    }

    /// What is known around a station.
    pub(super) fn of_station(&self, station: Option<u32>) -> &Local {
        station.and_then(|station| self.locals.get(station as usize)).unwrap_or(&self.mean)
    }

    /// What is known at a vertex.
    pub fn at(&self, vertex: &Vertex) -> Local {
        let mut sum = Sums::default();
        self.stations.around(vertex, |station, weight| sum.add(&self.known[station], weight));
        if sum.weight > 0.0 { sum.local() } else { self.mean }
    }
}

/// The sum of orders whose factors are nearest to 1 in a channel: over lights by what they scatter onto surfaces; where that does not
/// tell sums apart, or without lights, over surfaces.
fn chosen_sum(sources: &[&Flux], measured: &[Measured], c: usize) -> usize {
    let distance = |walked: f32, looked_up: f32| {
        if walked > 0.0 && looked_up > 0.0 { (walked / looked_up).ln().abs() } else { 0.0 }
    };
    let scattered: f32 = sources.iter().map(|f| f.walked[c]).sum();
    let of_lights =
        |k: usize| -> f32 { sources.iter().map(|f| f.walked[c] * distance(f.walked[c], f.looked_up[k][c])).sum() };
    let of_surfaces = |k: usize| -> f32 {
        measured.iter().map(|m| m.walked[0][c] * distance(m.walked[0][c], m.all_surfaces(k)[c])).sum()
    };
    let sums = || 0..ORDERS.len();
    let least = sums().map(of_lights).fold(f32::INFINITY, f32::min);
    let alike = sums().filter(|&k| of_lights(k) <= least + ALIKE * scattered);
    alike.min_by(|&a, &b| of_surfaces(a).total_cmp(&of_surfaces(b))).unwrap_or(0)
}

fn in_channels(sums: &[Vec3; ORDERS.len()], chosen: [usize; 3]) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|c| sums[chosen[c]][c]))
}

/// Quotient per channel, within bounds; 1 where there is nothing to correct.
fn factor(walked: Vec3, looked_up: Vec3) -> Vec3 {
    let of = |c: usize| if looked_up[c] > 0.0 { (walked[c] / looked_up[c]).clamp(RANGE.0, RANGE.1) } else { 1.0 };
    Vec3::from_array(std::array::from_fn(of))
}

fn report<'f>(
    known: &[Sums],
    measured: &[Measured],
    emitters: impl Iterator<Item = &'f Vec3>,
    chosen: [usize; 3],
    escaped: f32,
) -> Report {
    let local: Vec<Local> = known.iter().map(Sums::local).collect();
    let count = local.len().max(1) as f32;
    let surfaces = local.iter().map(|l| l.surfaces);
    let (low, high) =
        surfaces.clone().fold((f32::INFINITY, 0.0f32), |(a, b), s| (a.min(s.min_element()), b.max(s.max_element())));
    let mean = surfaces.map(|s| s.element_sum() / 3.0).sum::<f32>() / count;
    let met = |v: &Vec3| v.min_element() <= RANGE.0 || v.max_element() >= RANGE.1;
    let clamped = local.iter().filter(|l| met(&l.surfaces) || met(&l.sky)).count() as f32 / count;
    let of_emitters = emitters.fold([1.0f32; 2], |[a, b], e| [a.min(e.min_element()), b.max(e.max_element())]);
    let opacity = measured.iter().map(|m| m.opacity).sum::<f32>() / count;
    Report {
        orders: chosen.map(|k| ORDERS[k]),
        surfaces: [low, mean, high],
        emitters: of_emitters,
        opacity,
        escaped,
        clamped,
    }
}
