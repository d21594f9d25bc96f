//! Emitters in groups that share one factor: what each sends astray, and what tables say that it sends.

use super::responses::{ORDERS, Sight};
use super::stations::Stations;
use super::{Responses, View};
use crate::scene::{Light, LightKind};
use crate::solve::emitters::{Source, punctual};
use crate::solve::media::Leg;
use crate::solve::path::{Counters, Vertex};
use crate::solve::sampler::{MAX_SAMPLES, Sampler, hash};
use crate::solve::warp;
use crate::trace::Ray;
use ::tables::Geometry;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Most groups.
const MOST_GROUPS: usize = 64;
/// Walks over all groups, and of each at least.
const WALKS: (usize, usize) = (1 << 13, 1 << 10);

/// Lift of a glowing surface's end of a shadow ray, as a share of its length: what counts is that light gets to the air
/// between, even if the receiver lies in the emitter's plane or a little behind it.
const LIFT: f32 = 0.05;

/// What one group of emitters scatters onto all surfaces, watts.
#[derive(Clone, Copy)]
pub(super) struct Flux {
    /// By random walks.
    pub walked: Vec3,
    /// By tables, for each of [`ORDERS`].
    pub looked_up: [Vec3; ORDERS.len()],
}

impl Flux {
    const NONE: Self = Self { walked: Vec3::ZERO, looked_up: [Vec3::ZERO; ORDERS.len()] };

    fn add(&mut self, other: &Self) {
        self.walked += other.walked;
        self.looked_up.iter_mut().zip(other.looked_up).for_each(|(s, l)| *s += l);
    }
}

/// Surface points that light can be scattered onto.
pub(super) struct Lit<'a> {
    pub stations: &'a Stations,
    /// 1 where there is air in sight, else 0.
    pub air: Vec<f32>,
}

/// A member of a group with the probability of drawing it.
type Member = (u32, f32);

/// Instance where it glows, place, members.
type Group = (Option<u32>, Vec3, Vec<Member>);

/// Groups of finite emitters: lamps one by one, glowing triangles by instance; what is near each other where there are many.
pub(super) fn groups(view: &View) -> Vec<Vec<Member>> {
    let emitters = view.paths.emitters;
    let mut groups: Vec<Group> = Vec::new();
    for index in 0..emitters.finite_count() as u32 {
        match emitters.source(view.paths.tracer, index, 0.5, 0.5) {
            Source::Lamp { light, .. } => {
                let centre = punctual::ball(light).map_or(Vec3::ZERO, |b| b.0);
                groups.push((None, centre, vec![(index, light.color.element_sum())]));
            }
            Source::Patch { instance, place, radiance, area, .. } => {
                let member = (index, area * radiance.element_sum().max(f32::MIN_POSITIVE));
                match groups.last_mut() {
                    Some((Some(last), _, members)) if *last == instance => members.push(member),
                    _ => groups.push((Some(instance), place.point.position, vec![member])),
                }
            }
        }
    }
    let mut clusters = vec![groups];
    while clusters.len() < MOST_GROUPS && clusters.iter().map(Vec::len).sum::<usize>() > MOST_GROUPS {
        let largest = (0..clusters.len()).max_by_key(|&i| clusters[i].len()).unwrap_or(0);
        let (a, b) = halves(clusters.swap_remove(largest));
        clusters.extend([a, b]);
    }
    let flat: Vec<_> = if clusters.len() == 1 {
        clusters.remove(0).into_iter().map(|group| group.2).collect()
    } else {
        clusters.into_iter().map(|cluster| cluster.into_iter().flat_map(|group| group.2).collect()).collect()
    };
    flat.into_iter().map(normalised).collect()
}

/// Splits groups at the median of their longest axis.
fn halves(mut groups: Vec<Group>) -> (Vec<Group>, Vec<Group>) {
    let bounds = groups.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), g| (a.min(g.1), b.max(g.1)));
    let extent = bounds.1 - bounds.0;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    groups.sort_by(|a, b| a.1[axis].total_cmp(&b.1[axis]).then(a.2[0].0.cmp(&b.2[0].0)));
    let second = groups.split_off(groups.len() / 2);
    (groups, second)
}

fn normalised(mut members: Vec<Member>) -> Vec<Member> {
    let sum: f32 = members.iter().map(|m| m.1).sum();
    let even = 1.0 / members.len() as f32;
    members.iter_mut().for_each(|m| m.1 = if sum > 0.0 { m.1 / sum } else { even });
    members
}

fn pick(members: &[Member], mut u: f32) -> Member {
    for &(index, probability) in members {
        if u < probability {
            return (index, probability);
        }
        u -= probability;
    }
    members[members.len() - 1]
}

impl View<'_, '_> {
    /// What a group sends to all surfaces through the air, by walks and by tables.
    pub(super) fn flux(&self, members: &[Member], groups: usize, lit: &Lit, responses: &Responses, seed: u32) -> Flux {
        let walks = (WALKS.0 / groups.max(1)).max(WALKS.1).min(MAX_SAMPLES as usize);
        let walk = |i: u32| {
            let landed = self.emit(members, &mut Sampler::new(i, seed));
            Flux { walked: landed.unwrap_or(Vec3::ZERO) / walks as f32, ..Flux::NONE }
        };
        let look = |i: usize| {
            let [u, v, w, _] = Sampler::new(i as u32, hash(seed, 1)).next4();
            let (index, probability) = pick(members, u);
            let source = self.paths.emitters.source(self.paths.tracer, index, v, w);
            let lobes = self.lobe_of_all(&lit.stations.vertices[i], &source, responses);
            let scale = lit.stations.area * lit.air[i] / probability;
            Flux { looked_up: lobes.map(|e| e * scale), ..Flux::NONE }
        };
        let walked: Vec<Flux> = (0..walks as u32).into_par_iter().map(walk).collect();
        let looked_up: Vec<Flux> = (0..lit.stations.vertices.len()).into_par_iter().map(look).collect();
        let mut sum = Flux::NONE;
        walked.iter().chain(&looked_up).for_each(|flux| sum.add(flux));
        sum
    }

    /// Sends one walk out from a group; the power that it lands on a surface by as many collisions as tables are used for: one
    /// and more from glowing surfaces, two and more from lamps.
    fn emit(&self, members: &[Member], walk: &mut Sampler) -> Option<Vec3> {
        let ([u, v, w, x], [y, crossing, ..]) = (walk.next4(), walk.next4());
        let (index, probability) = pick(members, u);
        let (origin, dir, power, least) = match self.paths.emitters.source(self.paths.tracer, index, v, w) {
            Source::Lamp { light, .. } => {
                let (dir, weight) = lamp_direction(light, x, y);
                (punctual::ball(light)?.0, dir, light.color * weight, 2)
            }
            Source::Patch { place, radiance, area, two_sided, .. } => {
                // One number chooses the side and goes on as a fresh one.
                let (side, x) = match two_sided {
                    true if x < 0.5 => (-1.0, 2.0 * x),
                    true => (1.0, 2.0 * x - 1.0),
                    false => (1.0, x),
                };
                let normal = place.normal_geom * side;
                let dir = warp::about(normal, warp::cosine_hemisphere(x, y));
                let sides = if two_sided { 2.0 } else { 1.0 };
                (place.point.offset_along(normal), dir, radiance * (PI * area * sides), 1)
            }
        };
        let counters = Counters::default();
        let arrival = self.paths.travel(origin, dir, crossing, &counters);
        let leg = Leg { origin, dir, length: arrival.distance };
        let stray = self.stray(&leg, &arrival, walk, &counters)?;
        let lands = stray.exit.is_none() && stray.collisions >= least;
        lands.then(|| power * stray.weight / probability)
    }

    /// Irradiance by scattering of one emitter (of a glowing triangle: of all its area at this point) for all sums of orders.
    fn lobe_of_all(&self, vertex: &Vertex, source: &Source, responses: &Responses) -> [Vec3; ORDERS.len()] {
        let Some((seen, leg)) = self.sees(vertex, source) else { return [Vec3::ZERO; ORDERS.len()] };
        let sight = self.sight(vertex, &seen, &leg);
        match source {
            Source::Lamp { index, .. } => responses.lamp_of_all(&sight, *index as usize).map(|r| r * seen.strength),
            Source::Patch { .. } => {
                let [once, more @ ..] = responses.area_of_all(&sight);
                more.map(|r| (once + r) * seen.strength)
            }
        }
    }

    fn sight<'l>(&self, vertex: &Vertex, seen: &Seen, leg: &'l Leg) -> Sight<'l> {
        let geometry = Geometry::new(vertex.normal_shading, leg.dir, seen.axis);
        Sight { leg, depth: self.paths.media.depth(leg), geometry }
    }

    /// The emitter as a receiver sees it, if it does.
    pub(super) fn sees(&self, vertex: &Vertex, source: &Source) -> Option<(Seen, Leg)> {
        let (target, axis, strength) = match *source {
            Source::Lamp { light, .. } => (punctual::ball(light)?.0, punctual::axis(light), light.color),
            Source::Patch { place, radiance, area, two_sided, .. } => {
                let towards = (vertex.origin - place.point.position).dot(place.normal_geom);
                let normal = place.normal_geom * if two_sided && towards < 0.0 { -1.0 } else { 1.0 };
                (place.point.offset_along(normal), normal, radiance * area)
            }
        };
        let way = target - vertex.origin;
        let length = way.length();
        let leg = Leg { origin: vertex.origin, dir: way.try_normalize()?, length };
        let lift = if let Source::Patch { .. } = source { LIFT * length * axis } else { Vec3::ZERO };
        let passed = self.paths.tracer.transmittance(&Ray { origin: vertex.origin, dir: way + lift, t_max: 1.0 });
        let reach = if let Source::Lamp { light, .. } = source { punctual::reach(light, length) } else { 1.0 };
        (passed != Vec3::ZERO).then_some((Seen { axis, strength: strength * passed * reach }, leg))
    }

    /// What directional light `index` of the scene sends to all surfaces by two collisions and more.
    pub(super) fn sun_flux(&self, index: u32, lit: &Lit, responses: &Responses, seed: u32) -> Flux {
        let scene = self.paths.tracer.scene();
        let mut flux = Flux::NONE;
        let light = &scene.lights[index as usize];
        let LightKind::Directional { direction, .. } = light.kind else { return flux };
        let [low, high] = self.region;
        let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length() * 1.01);
        let power = light.color * (PI * radius * radius);
        let walks: Vec<Vec3> = (0..WALKS.0 as u32)
            .into_par_iter()
            .map(|i| {
                let mut walk = Sampler::new(i, seed);
                let [u, v, crossing, _] = walk.next4();
                let disk = warp::concentric_disk(u, v) * radius;
                let (x, y) = direction.any_orthonormal_pair();
                let origin = centre + disk.x * x + disk.y * y - direction * radius;
                let counters = Counters::default();
                let arrival = self.paths.travel(origin, direction, crossing, &counters);
                let leg = Leg { origin, dir: direction, length: arrival.distance };
                match self.stray(&leg, &arrival, &mut walk, &counters) {
                    Some(stray) if stray.exit.is_none() && stray.collisions >= 2 => {
                        power * stray.weight / WALKS.0 as f32
                    }
                    _ => Vec3::ZERO,
                }
            })
            .collect();
        flux.walked = walks.into_iter().sum();
        for (vertex, air) in lit.stations.vertices.iter().zip(&lit.air) {
            let leg = Leg { origin: vertex.origin, dir: -direction, length: f32::INFINITY };
            let cos = vertex.normal_shading.dot(-direction);
            let [_, more @ ..] = responses.distant_of_all(&leg, self.paths.media.depth(&leg), cos);
            flux.looked_up.iter_mut().zip(more).for_each(|(s, e)| *s += e * light.color * lit.stations.area * *air);
        }
        flux
    }

    /// A box around all surfaces and the air that has an end.
    pub(super) fn region_of(&self, stations: &Stations) -> [Vec3; 2] {
        let mut region = stations.bounds();
        for medium in &self.paths.media.set().media {
            let [a, b] = medium.bounds.bounding_box();
            if a.is_finite() && b.is_finite() {
                region = [region[0].min(a.as_vec3()), region[1].max(b.as_vec3())];
            }
        }
        region
    }
}

/// An emitter as seen from a receiver.
pub(super) struct Seen {
    /// Axis of its distribution.
    pub axis: Vec3,
    /// Intensity, or radiance times area, after the surfaces on the way.
    pub strength: Vec3,
}

/// A direction in which a lamp sends light, with its intensity as a share of its colour over the density.
fn lamp_direction(light: &Light, u: f32, v: f32) -> (Vec3, f32) {
    if let LightKind::Spot { direction, cos_outer, profile: None, .. } = light.kind {
        let angle = cos_outer.clamp(-1.0, 1.0).acos();
        let dir = warp::about(direction, warp::cone(u, v, angle));
        return (dir, TAU * (1.0 - cos_outer) * punctual::shape(light, dir));
    }
    let dir = warp::uniform_sphere(u, v);
    (dir, 2.0 * TAU * punctual::shape(light, dir))
}
