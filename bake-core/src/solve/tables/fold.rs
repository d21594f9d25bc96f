//! Recorded paths with air: what it lets through, what it scatters once, and what the tables say that it scatters more often.

use super::factors::{Factors, Local};
use super::medium::Tabled;
use super::record::{Link, Lobe, Look, Once, Path, Step, Straight, Sunlit, Visit, Way};
use super::responses::{Responses, Sight};
use crate::scene::{Light, LightKind};
use crate::solve::emitters::Emitters;
use crate::solve::media::{Leg, Media};
use crate::solve::path::mixed_pdf;
use ::tables::Geometry;
use bake_formats::Term;
use glam::Vec3;

/// Where the tables are read for a step from a surface with `normal` along `leg`.
pub(super) fn sight<'l>(normal: Vec3, leg: &'l Leg, depth: Vec3, step: &Step) -> Sight<'l> {
    Sight { leg, depth, geometry: Geometry::new(normal, leg.dir, step.axis) }
}

/// What folds paths: air, its tables, and what brings them to the scene.
pub(super) struct Fold<'a> {
    pub air: &'a Tabled<'a>,
    pub emitters: &'a Emitters<'a>,
    pub lights: &'a [Light],
    pub responses: &'a Responses<'a>,
    pub factors: &'a Factors,
}

impl Fold<'_> {
    /// Irradiance by term of one path whose start knows `local`.
    pub fn path(&self, path: &Path, local: &Local) -> [Vec3; 4] {
        let mut terms = self.visit(&path.start, local);
        for straight in &path.straight {
            terms[Term::Direct as usize] += self.straight(path.start.origin, straight);
        }
        for chain in &path.chains {
            self.chain(&path.start, local, chain, &mut terms);
        }
        terms
    }

    /// Irradiance at a vertex per irradiance at the next, by a factor of its surroundings at large.
    pub fn weight(&self, visit: &Visit, step: &Step) -> Vec3 {
        let weight: Vec3 = self.step(visit, step, self.factors.of_station(visit.station).surfaces).into_iter().sum();
        // Also of no number, where points coincide.
        if weight.is_finite() { weight } else { Vec3::ZERO }
    }

    fn chain(&self, start: &Visit, local: &Local, chain: &[Link], terms: &mut [Vec3; 4]) {
        let Some(first) = chain.first() else { return };
        let prefix = self.step(start, &first.step, local.surfaces);
        let mut throughput = Vec3::ONE;
        for (i, Link { visit, .. }) in chain.iter().enumerate() {
            let local = self.factors.of_station(visit.station);
            let arrived = self.visit(visit, local).into_iter().sum::<Vec3>();
            terms.iter_mut().zip(prefix).for_each(|(t, p)| *t += p * throughput * arrived);
            let Some(Link { step, .. }) = chain.get(i + 1) else { return };
            let closed = self.factors.report.escaped == 0.0;
            let nu = if closed { local.surfaces_ahead } else { local.surfaces };
            throughput *= self.step(visit, step, nu).into_iter().sum::<Vec3>();
        }
    }

    /// What arrives at a vertex from emitters, by term.
    fn visit(&self, visit: &Visit, local: &Local) -> [Vec3; 4] {
        let mut terms = [Vec3::ZERO; 4];
        let mut scattered = [Vec3::ZERO, self.suns(visit)];
        if let Some(straight) = &visit.straight {
            terms[Term::Direct as usize] = self.straight(visit.origin, straight);
        }
        if let Some(once) = &visit.once {
            scattered[0] += self.once(visit.origin, once);
        }
        if let Some(lobe) = &visit.lobe {
            let found = self.lobe(visit, lobe);
            scattered.iter_mut().zip(found).for_each(|(sum, part)| *sum += part);
        }
        if let Some(look) = &visit.look {
            self.look(visit, look, local.sky, &mut terms);
        }
        terms[Term::Single as usize] += scattered[0] * local.air;
        terms[Term::Multiple as usize] += scattered[1] * local.air;
        terms
    }

    fn straight(&self, origin: Vec3, straight: &Straight) -> Vec3 {
        let Straight { dir, length, irradiance } = *straight;
        irradiance * self.air.transmittance(&Leg { origin, dir, length })
    }

    fn once(&self, origin: Vec3, once: &Once) -> Vec3 {
        let Once { dir, distance, towards, rest, strength } = *once;
        let leg = Leg { origin, dir, length: distance };
        let point = origin + dir * distance;
        let scatter = self.air.scatter(point, dir, towards);
        if scatter == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let onward = Leg { origin: point, dir: towards, length: rest };
        strength * scatter * self.air.transmittance(&leg) * self.air.transmittance(&onward)
    }

    /// Light of a finite emitter scattered by any way, once and more often: of lamps from the second collision on.
    fn lobe(&self, visit: &Visit, lobe: &Lobe) -> [Vec3; 2] {
        let Lobe { emitter, dir, length, axis, strength } = *lobe;
        let leg = Leg { origin: visit.origin, dir, length };
        let sight = Sight { leg: &leg, depth: self.air.depth(&leg), geometry: Geometry::new(visit.normal, dir, axis) };
        let strength = strength * self.factors.emitters[emitter as usize];
        match self.emitters.light_of(emitter) {
            Some(light) => [Vec3::ZERO, strength * self.responses.lamp(&sight, light as usize)],
            None => self.responses.area(&sight).map(|r| strength * r),
        }
    }

    /// Light of the suns that scatters onto a vertex from the second collision on.
    fn suns(&self, visit: &Visit) -> Vec3 {
        let of = |(light, factor): (&Light, &Vec3)| {
            let LightKind::Directional { direction, .. } = light.kind else { return Vec3::ZERO };
            let leg = Leg { origin: visit.origin, dir: -direction, length: f32::INFINITY };
            let lobe = self.responses.distant(&leg, self.air.depth(&leg), visit.normal.dot(-direction));
            lobe[1] * light.color * *factor
        };
        self.lights.iter().zip(&self.factors.suns).map(of).sum()
    }

    /// What arrives along a look straight from emitters: attenuated, and scattered from a sun on the way or from the sky
    /// where the look escapes.
    fn look(&self, visit: &Visit, look: &Look, nu_sky: Vec3, terms: &mut [Vec3; 4]) {
        let leg = Leg { origin: visit.origin, dir: look.dir, length: look.length };
        if look.glow != Vec3::ZERO {
            terms[Term::Direct as usize] += look.glow * self.air.transmittance(&leg);
        }
        if let Some(sun) = &look.sun {
            terms[Term::Single as usize] += self.sunlit(&leg, sun);
        }
        if look.sky != Vec3::ZERO {
            let [once, more] = self.responses.distant(&leg, self.air.depth(&leg), look.dir.dot(visit.normal));
            terms[Term::Single as usize] += nu_sky * once * look.sky;
            terms[Term::Multiple as usize] += nu_sky * more * look.sky;
        }
    }

    fn sunlit(&self, leg: &Leg, sun: &Sunlit) -> Vec3 {
        let LightKind::Directional { direction, .. } = self.lights[sun.light as usize].kind else { return Vec3::ZERO };
        let point = leg.at(sun.distance);
        let scatter = self.air.scatter(point, leg.dir, -direction);
        if scatter == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let onward = Leg { origin: point, dir: -direction, length: f32::INFINITY };
        let before = Leg { length: sun.distance, ..*leg };
        sun.strength * scatter * self.air.transmittance(&before) * self.air.transmittance(&onward)
    }

    /// Irradiance at a vertex per irradiance at the next, by term.
    fn step(&self, visit: &Visit, step: &Step, nu: Vec3) -> [Vec3; 4] {
        let (dir, length) = match (step.way, &visit.look) {
            (Way::Beside { dir, length }, _) => (dir, length),
            (Way::Ahead, Some(look)) => (look.dir, look.length),
            (Way::Ahead, None) => return [Vec3::ZERO; 4],
        };
        let leg = Leg { origin: visit.origin, dir, length };
        let depth = self.air.depth(&leg);
        let attenuated = match step.way {
            Way::Ahead => {
                let cos = dir.dot(visit.normal).max(0.0);
                depth.map(|d| (-d).exp()) * (cos / mixed_pdf(cos))
            }
            Way::Beside { .. } => Vec3::ZERO,
        };
        let scattered = self.responses.area(&sight(visit.normal, &leg, depth, step));
        let [once, more] = scattered.map(|lobe| nu * lobe * step.weight);
        [Vec3::ZERO, attenuated, once, more].map(|w| w * step.reflect)
    }
}
