//! Light of emitters at the nodes, straight and scattered once: for each node the mean over the air that looks it up, because
//! beside a lamp both are far from even within a cell.
//!
//! Light of point and spot lights is followed from the lamp outwards. Over the air of a cell ∫ I/r² dV = ∫∫ I dr dω: the
//! inverse square is gone, and a narrow beam is met by all of its rays. Points drawn in the cell would have no finite variance
//! beside a lamp and would miss beams. Light of all other emitters is bounded and is drawn at points in the cell.
//! Lamps' light that was scattered once, which falls with 1/r, is followed from the lamp too.

use super::{LightGrid, Sh9};
use crate::progress::{Interrupted, Progress};
use crate::scene::{Light, LightKind};
use crate::solve::emitters::punctual;
use crate::solve::media::{Leg, Media};
use crate::solve::path::{Arrival, Counters, Paths};
use crate::solve::sampler::{MAX_SAMPLES, Sampler, hash};
use crate::solve::sphere::harmonics;
use crate::solve::warp;
use glam::{UVec3, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Rays of a lamp for one sample of a node.
const RAYS_A_SAMPLE: u32 = 128;
/// Rays of all lamps together at most; each has [`FEWEST_RAYS`] nevertheless.
const MOST_RAYS: u32 = 1 << 20;
const FEWEST_RAYS: u32 = 256;
/// Steps of a ray over the distance of two nodes.
const STEPS_A_CELL: f32 = 2.0;
/// Parts of a lamp's rays, each summed by itself, so that sums do not depend on threads.
const PARTS: u32 = 8;

/// Light that goes one way.
struct Beam {
    origin: Vec3,
    /// Unit vector.
    dir: Vec3,
    /// Luminous flux, lm.
    flux: Vec3,
}

/// Light of emitters at a node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Emitted {
    /// Straight.
    pub straight: Sh9,
    /// Of lamps, scattered once; other emitters' is found by paths.
    pub scattered: Sh9,
    /// Order 0 of what is straight and not of lamps.
    pub drawn: Vec3,
}

impl LightGrid {
    /// Light of emitters, for each node.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop.
    pub(super) fn emitted<M: Media>(
        &self,
        paths: &Paths<M>,
        samples: u32,
        seed: u32,
        counters: &mut [u64; 3],
        progress: &dyn Progress,
    ) -> Result<Vec<Emitted>, Interrupted> {
        let beams = self.beams(paths, samples, hash(seed, 0), counters, progress)?;
        let nodes = (0..self.node_count()).into_par_iter().map(|index| {
            progress.advance(1);
            if progress.is_cancelled() {
                return Err(Interrupted);
            }
            let counters = Counters::default();
            let (air, straight) = self.drawn(paths, index, samples, hash(hash(seed, 1), index), &counters);
            let mut light = Emitted { straight, drawn: straight[0], ..Emitted::default() };
            if let Some(beam) = beams.get(index as usize).filter(|_| air > 0.0) {
                light.add_scaled(beam, 1.0 / air);
            }
            Ok((light, counters))
        });
        let (nodes, counts): (Vec<_>, Vec<_>) = nodes.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        counts.iter().for_each(|count: &Counters| count.add_to(counters));
        Ok(nodes)
    }

    /// Volume of the air that looks a node up, m³, and the means over it of light that is drawn at points.
    fn drawn<M: Media>(
        &self,
        paths: &Paths<M>,
        index: u32,
        samples: u32,
        seed: u32,
        counters: &Counters,
    ) -> (f32, Sh9) {
        let (at, mut light, mut weights) = (self.lattice_point(index), Sh9::default(), 0.0);
        if !self.free[index as usize] {
            return (0.0, light);
        }
        for sample in 0..samples {
            let mut sampler = Sampler::new(sample, seed);
            let [x, y, z, _] = sampler.next4();
            let (point, weight) = self.around(paths.tracer, at, Vec3::new(x, y, z));
            if weight == 0.0 {
                continue;
            }
            weights += weight;
            if let Some((irradiance, dir)) = paths.emitter_at(point, &mut sampler, counters) {
                for (sum, y) in light.iter_mut().zip(harmonics(dir)) {
                    *sum += irradiance * (weight * y);
                }
            }
        }
        let light = light.map(|sum| sum / f32::max(weights, f32::MIN_POSITIVE));
        (self.kernel_volume(at) * weights / samples as f32, light)
    }

    /// Integral of the trilinear weight of a node over the lattice's box, m³.
    pub(super) fn kernel_volume(&self, at: UVec3) -> f32 {
        let on_border = at.cmpeq(UVec3::ZERO) | at.cmpeq(self.size - 1);
        Vec3::select(on_border, 0.5 * self.spacing, self.spacing).element_product()
    }

    /// Integral of lamps' light over the air that looks each node up, lm m; empty without lamps.
    fn beams<M: Media>(
        &self,
        paths: &Paths<M>,
        samples: u32,
        seed: u32,
        counters: &mut [u64; 3],
        progress: &dyn Progress,
    ) -> Result<Vec<Emitted>, Interrupted> {
        let lamps: Vec<&Light> = paths.emitters.lamps().collect();
        if lamps.is_empty() {
            return Ok(vec![]);
        }
        let share = MOST_RAYS / lamps.len() as u32;
        let rays = (RAYS_A_SAMPLE * samples).min(MAX_SAMPLES).min(share).max(FEWEST_RAYS);
        let part = |part: u32| {
            let (mut sums, counters) = (vec![Emitted::default(); self.node_count() as usize], Counters::default());
            for (number, lamp) in lamps.iter().enumerate() {
                if progress.is_cancelled() {
                    return Err(Interrupted);
                }
                for ray in (part..rays).step_by(PARTS as usize) {
                    let sampler = Sampler::new(ray, hash(seed, number as u32));
                    self.follow_beam(paths, lamp, 1.0 / rays as f32, sampler, &mut sums, &counters);
                }
            }
            Ok((sums, counters))
        };
        let parts = (0..PARTS).into_par_iter().map(part).collect::<Result<Vec<_>, Interrupted>>()?;
        parts.iter().for_each(|(_, count)| count.add_to(counters));
        let mut sums = vec![Emitted::default(); self.node_count() as usize];
        for (part, _) in &parts {
            sums.iter_mut().zip(part).for_each(|(sum, light)| sum.add_scaled(light, 1.0));
        }
        Ok(sums)
    }

    /// One ray of a lamp, which stands for a share of all its directions, and a ray that it scatters.
    fn follow_beam<M: Media>(
        &self,
        paths: &Paths<M>,
        lamp: &Light,
        share: f32,
        mut sampler: Sampler,
        sums: &mut [Emitted],
        counters: &Counters,
    ) {
        let Some((centre, radius)) = punctual::ball(lamp) else { return };
        let [u, v, a, b] = sampler.next4();
        let (dir, solid_angle) = emitted(lamp, u, v);
        let flux = lamp.color * (punctual::shape(lamp, dir) * solid_angle * share);
        if flux == Vec3::ZERO {
            return;
        }
        let origin = centre + warp::about(dir, (warp::concentric_disk(a, b) * radius).extend(0.0));
        // Inside the ball irradiance does not grow any more.
        let shape = |at: f32| punctual::reach(lamp, at) * if at < radius { (at / radius).powi(2) } else { 1.0 };
        let numbers = sampler.next4();
        let beam = Beam { origin, dir, flux };
        let arrival =
            self.shine(paths, &beam, &shape, numbers, counters, |node, i, light| sums[node].straight[i] += light);
        if !paths.media.scatters_again(1) {
            return;
        }
        let ([u, v, along, choice], [crossing, jitter, corner, lead]) = (sampler.next4(), sampler.next4());
        let leg = Leg { origin, dir, length: arrival.distance };
        let Some((distance, weight)) = paths.media.collide(&leg, flux, [lead, along]) else { return };
        let point = leg.at(distance);
        let Some(deflected) = paths.media.deflect(point, dir, [u, v, choice]) else { return };
        let flux = flux * weight * arrival.passed_before(distance) * deflected.weight * shape(distance);
        let beam = Beam { origin: point, dir: deflected.dir, flux };
        self.shine(paths, &beam, &|_| 1.0, [crossing, jitter, corner, 0.0], counters, |node, i, light| {
            sums[node].scattered[i] += light;
        });
    }

    /// Adds a beam's light to the nodes along its way. `shape` is a share of its flux by distance.
    fn shine<M: Media>(
        &self,
        paths: &Paths<M>,
        &Beam { origin, dir, flux }: &Beam,
        shape: &dyn Fn(f32) -> f32,
        [crossing, jitter, corner, _]: [f32; 4],
        counters: &Counters,
        mut add: impl FnMut(usize, usize, Vec3),
    ) -> Arrival {
        let arrival = paths.travel(origin, dir, crossing, counters);
        let Some((near, far)) = self.stretch(origin, dir) else { return arrival };
        let (y, far) = (harmonics(-dir), far.min(arrival.distance));
        let count = ((far - near) * STEPS_A_CELL / self.spacing.min_element()).ceil().max(1.0);
        let step = (far - near).max(0.0) / count;
        let (mut passed, mut at) = (Vec3::ONE, 0.0);
        for i in 0..count as u32 {
            let distance = near + (i as f32 + jitter) * step;
            passed *= paths.media.transmittance(&Leg { origin: origin + at * dir, dir, length: distance - at });
            at = distance;
            // Steps take the corners of their cells in turn (golden ratio).
            let corner = (corner + i as f32 * 0.618_034).fract();
            let Some(node) = self.draw_corner(paths.tracer, origin + at * dir, corner) else { continue };
            let light = flux * passed * arrival.passed_before(at) * (shape(at) * step);
            y.into_iter().enumerate().for_each(|(i, y)| add(node, i, light * y));
        }
        arrival
    }

    /// The stretch of a ray inside the lattice's box, m.
    fn stretch(&self, origin: Vec3, dir: Vec3) -> Option<(f32, f32)> {
        let (a, b) = ((self.min - origin) / dir, (self.max() - origin) / dir);
        let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
        (near < far).then_some((near, far))
    }
}

/// A direction in which a lamp may shine, and the solid angle over which such directions are spread evenly, sr.
fn emitted(lamp: &Light, u: f32, v: f32) -> (Vec3, f32) {
    match lamp.kind {
        LightKind::Spot { direction, cos_outer, profile: None, .. } => {
            (warp::about(direction, warp::cone(u, v, cos_outer.acos())), 2.0 * PI * (1.0 - cos_outer))
        }
        _ => (warp::uniform_sphere(u, v), 4.0 * PI),
    }
}

impl Emitted {
    fn add_scaled(&mut self, other: &Self, scale: f32) {
        let pairs =
            self.straight.iter_mut().chain(&mut self.scattered).zip(other.straight.iter().chain(&other.scattered));
        pairs.for_each(|(sum, light)| *sum += *light * scale);
    }
}

impl<M: Media> Paths<'_, '_, M> {
    /// One sample of the light straight from emitters other than lamps, drawn from one kind of them: irradiance on a
    /// surface perpendicular to the direction, lux.
    fn emitter_at(&self, point: Vec3, sampler: &mut Sampler, counters: &Counters) -> Option<(Vec3, Vec3)> {
        let [pick, u, v, w] = sampler.next4();
        let strategies = self.emitters.strategies_in_air();
        let strategy = *strategies.get((pick * strategies.len() as f32) as usize)?;
        let (irradiance, dir, _) = self.draw_at(point, strategy, [u, v, w], counters)?;
        Some((irradiance * strategies.len() as f32, dir))
    }
}
