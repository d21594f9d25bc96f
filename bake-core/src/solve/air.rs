//! Light in the air along the legs of a path: collisions, and what emitters send to the leg.
//!
//! Surfaces that glow, the sky and the sun are drawn from collisions. Point and spot lights are not, because the
//! inverse square has no bounded variance there: their light is gathered along every leg with distances drawn
//! equi-angularly about the lamp (Kulla and Fajardo 2012), and around the start of a path with directions drawn
//! uniformly in the angle from the lamp, where both singularities cancel (`dω ds / r² ∝ dγ dβ / d`).
//!
//! Where a cache knows the air's light, a leg is looked at as often as its air matters: what it scatters grows with what it stops,
//! so that noise is least for the time spent where the probability of a look does too ([`Media::looks_per_collision`]).

use super::emitters::{LightSample, Strategy, Target, punctual};
use super::media::{Flight, InScattered, Leg, Media};
use super::path::{Arrival, Counters, LastLeg, Paths, Vertex, power_heuristic};
use super::sampler::Sampler;
use super::{LUMINANCE, warp};
use crate::scene::Light;
use crate::trace::Ray;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Stretch over which lamps are compared where the air has no end, metres.
const LONGEST_STRETCH: f32 = 1e6;
/// Largest angle from the foot of a lamp on a leg without end, radians: keeps tangents finite.
const WIDEST: f32 = FRAC_PI_2 - 1e-4;

/// Where a path stands before a leg.
pub(super) struct Step {
    pub vertex: Vertex,
    pub dir: Vec3,
    pub throughput: Vec3,
    pub last_leg: LastLeg,
    /// Since the last surface.
    pub collisions: u32,
    pub is_first: bool,
}

/// How a path comes through the air of a leg.
pub(super) enum Onward {
    /// To the leg's end.
    Through,
    /// From a collision on.
    Collision(Collision),
    /// Absorbed.
    Absorbed,
}

/// Where a path goes on after a collision.
pub(super) struct Collision {
    pub vertex: Vertex,
    pub dir: Vec3,
    pub pdf: f32,
    pub draws: f32,
    pub throughput: Vec3,
    pub crossing: f32,
}

/// Collisions that a path's first leg may look at.
pub(super) const MOST_LOOKS: usize = 4;
/// Looks at a path's first leg for one at a later leg: what they bring is not weakened by a reflection.
const FIRST_LOOKS: f32 = 2.0;
/// The same for looks around the start, of which the whole line is counted, as if nothing stood in its way.
const AROUND_LOOKS: f32 = 0.5;
/// Share of draws that go to any of them.
const EVENLY: f32 = 0.2;

/// Share of light that a stretch stops, of the channel with the most.
fn opacity(passed: Vec3) -> f32 {
    1.0 - passed.min_element()
}

/// A collision at which emitters may be drawn.
#[derive(Clone, Copy, Default)]
struct Look {
    point: Vec3,
    throughput: Vec3,
    /// Roughly the luminance that it brings.
    level: f32,
}

impl Look {
    /// One of them, by level, with its probability; none where nothing collides.
    fn pick(looks: &[Self], mut u: f32) -> Option<(&Self, f32)> {
        let (total, evenly): (f32, f32) = (looks.iter().map(|look| look.level).sum(), 1.0 / looks.len() as f32);
        let share = |look: &Self| {
            let by_level = if total > 0.0 { look.level / total } else { evenly };
            EVENLY * evenly + (1.0 - EVENLY) * by_level
        };
        let taken = looks.iter().find(|look| {
            u -= share(look);
            u < 0.0
        });
        let taken = taken.or(looks.last())?;
        (taken.throughput != Vec3::ZERO).then(|| (taken, share(taken)))
    }
}

impl<M: Media> Paths<'_, '_, M> {
    /// Takes a path over one leg of air; what passes to the leg's end is weakened in `arrival`.
    pub(super) fn cross_air(
        &self,
        step: &Step,
        arrival: &mut Arrival,
        radiance: &mut [Vec3; 4],
        air: &mut Sampler,
        counters: &Counters,
    ) -> Onward {
        let leg = Leg { origin: step.vertex.origin, dir: step.dir, length: arrival.distance };
        if !self.media.scatters_again(step.collisions) {
            arrival.weaken(self.media.transmittance(&leg));
            return Onward::Through;
        }
        let numbers = air.next4();
        if !M::CACHED && self.emitters.has_lamps() && !step.is_first {
            let lit = self.lamps_along(&leg, arrival, air.next4(), counters);
            radiance[step.last_leg.of_collision()] += step.throughput * lit;
        }
        if M::CACHED {
            let passed = self.media.transmittance(&leg);
            if step.is_first {
                self.look_along(step, (&leg, opacity(passed)), arrival, radiance, (numbers, air), counters);
            } else {
                self.look_up(step, (&leg, opacity(passed)), arrival, radiance, numbers);
            }
            arrival.weaken(passed);
            return Onward::Through;
        }
        match self.media.fly(&leg, step.throughput, [numbers[0], numbers[1]]) {
            Flight::Through(weight) => {
                arrival.weaken(weight);
                Onward::Through
            }
            Flight::Collision { distance, weight } => {
                let throughput = step.throughput * weight * arrival.passed_before(distance);
                let point = leg.at(distance);
                let draws = 1.0 / self.emitters.strategies_in_air().len().max(1) as f32;
                if let Some(lit) = self.draw_in_air(point, step.dir, air.next4(), counters) {
                    radiance[step.last_leg.of_collision()] += throughput * lit;
                }
                let deflected = self.deflect(point, step.dir, throughput, draws, [numbers[2], numbers[3]], air);
                deflected.map_or(Onward::Absorbed, Onward::Collision)
            }
        }
    }

    fn deflect(
        &self,
        point: Vec3,
        dir: Vec3,
        throughput: Vec3,
        draws: f32,
        [u, v]: [f32; 2],
        air: &mut Sampler,
    ) -> Option<Collision> {
        let [choice, survive, crossing, _] = air.next4();
        let deflected = self.media.deflect(point, dir, [u, v, choice])?;
        let throughput = throughput * deflected.weight;
        let survival = throughput.max_element().min(1.0);
        (survive < survival).then(|| Collision {
            vertex: Vertex { origin: point, normal_geom: Vec3::ZERO, normal_shading: Vec3::ZERO },
            dir: deflected.dir,
            pdf: deflected.pdf,
            draws,
            throughput: throughput / survival,
            crossing,
        })
    }

    /// In-scattered radiance from one collision on the leg, from the cache.
    fn look_up(
        &self,
        step: &Step,
        (leg, opacity): (&Leg, f32),
        arrival: &Arrival,
        radiance: &mut [Vec3; 4],
        numbers: [f32; 4],
    ) {
        let share = (self.media.looks_per_collision() * opacity).min(1.0);
        if numbers[3] >= share {
            return;
        }
        let Some((distance, weight)) = self.media.collide(leg, step.throughput, [numbers[0], numbers[1]]) else {
            return;
        };
        let throughput = step.throughput * (weight / share) * arrival.passed_before(distance);
        let scattered = self.media.cached_whole(leg.at(distance), step.dir, numbers[2]);
        radiance[step.last_leg.of_collision()] += throughput * scattered;
    }

    /// The same for a path's first leg, from several collisions. Emitters are drawn at one of them, if at all: what the cache knows of
    /// them is blurred, which only another reflection hides, but it tells where they matter (resampled importance sampling,
    /// Talbot, Cline and Egbert 2005, with strata for candidates and a share for each of them).
    fn look_along(
        &self,
        step: &Step,
        (leg, opacity): (&Leg, f32),
        arrival: &Arrival,
        radiance: &mut [Vec3; 4],
        (numbers, air): ([f32; 4], &mut Sampler),
        counters: &Counters,
    ) {
        let mut looks = [Look::default(); MOST_LOOKS];
        let drawing = (self.media.looks_per_collision() * opacity).min(1.0);
        let wanted = FIRST_LOOKS * self.media.looks_per_collision() * opacity;
        let share = wanted.min(1.0);
        if numbers[3] >= share {
            air.skip();
            return;
        }
        let count = (wanted.ceil() as usize).clamp(1, self.media.most_looks().min(MOST_LOOKS));
        let (looks, strata) = (&mut looks[..count], count as f32);
        for (index, look) in looks.iter_mut().enumerate() {
            let u = (index as f32 + numbers[1]) / strata;
            let Some((distance, weight)) = self.media.collide(leg, step.throughput, [numbers[0], u]) else { continue };
            let throughput = step.throughput * weight * arrival.passed_before(distance) / (strata * share);
            let point = leg.at(distance);
            let corner = (numbers[2] + index as f32 * 0.618_034).fract();
            let InScattered { reflected, collided, drawn } = self.media.cached(point, step.dir, corner);
            radiance[step.last_leg.of_collision()] += throughput * reflected;
            if self.media.scatters_again(1) {
                radiance[step.last_leg.of_collisions()] += throughput * collided;
            }
            *look = Look { point, throughput, level: drawn * throughput.dot(LUMINANCE) };
        }
        if numbers[3] >= drawing {
            air.skip();
            return;
        }
        let Some((look, probability)) = Look::pick(looks, numbers[3] / drawing) else { return };
        let probability = probability * drawing / share;
        if let Some(straight) = self.draw_in_air(look.point, step.dir, air.next4(), counters) {
            radiance[step.last_leg.of_collision()] += look.throughput * straight / probability;
        }
    }

    /// `sigma_s` × phase function × irradiance of one emitter other than lamps at a point in the air, 1/m, for a path that
    /// came along `dir`.
    fn draw_in_air(&self, point: Vec3, dir: Vec3, [pick, u, v, _]: [f32; 4], counters: &Counters) -> Option<Vec3> {
        let strategies = self.emitters.strategies_in_air();
        let draws = 1.0 / strategies.len() as f32;
        let place = pick * strategies.len() as f32;
        let strategy = *strategies.get((place as usize).min(strategies.len().checked_sub(1)?))?;
        let (irradiance, towards, pdf) = self.draw_at(point, strategy, [place.fract(), u, v], counters)?;
        let weight = match pdf {
            Some(pdf) if !M::CACHED => power_heuristic(draws * pdf, self.media.deflect_pdf(point, dir, towards)),
            _ => 1.0,
        };
        Some(irradiance * self.media.scatter(point, dir, towards) * (weight / draws))
    }

    /// Irradiance on a surface perpendicular to the way from one emitter at a point in the air; with the direction
    /// towards it and its density.
    pub(super) fn draw_at(
        &self,
        point: Vec3,
        strategy: Strategy,
        u: [f32; 3],
        counters: &Counters,
    ) -> Option<(Vec3, Vec3, Option<f32>)> {
        let LightSample { target, irradiance, pdf } =
            self.emitters.sample(self.tracer, strategy, point, Vec3::ZERO, u)?;
        let (ray, towards) = match target {
            Target::Point(target) => {
                let way = target - point;
                (Ray { origin: point, dir: way, t_max: 1.0 }, way.try_normalize()?)
            }
            Target::Direction(dir) => (Ray { origin: point, dir, t_max: f32::INFINITY }, dir),
        };
        if irradiance == Vec3::ZERO {
            return None;
        }
        Some((irradiance * self.visibility(&ray, towards, counters)?, towards, pdf))
    }

    /// What surfaces and air leave of light along a shadow ray; `None` where it is blocked.
    fn visibility(&self, ray: &Ray, dir: Vec3, counters: &Counters) -> Option<Vec3> {
        counters.shadow_rays.set(counters.shadow_rays.get() + 1);
        let passed = self.tracer.transmittance(ray);
        (passed != Vec3::ZERO).then(|| passed * self.through_air(ray, dir))
    }

    /// Radiance towards the leg's start of lamps' light that the leg scatters once.
    fn lamps_along(&self, leg: &Leg, arrival: &Arrival, u: [f32; 4], counters: &Counters) -> Vec3 {
        let Some(stretch) = self.media.scattering_stretch(leg) else { return Vec3::ZERO };
        let ends = (leg.at(stretch.0), leg.at(stretch.1.min(stretch.0 + LONGEST_STRETCH)));
        let Some((lamp, probability)) = self.emitters.lamp_along(ends.0, ends.1, u[0]) else { return Vec3::ZERO };
        let scattered = self.scattered_once(leg, stretch, lamp, [u[1], u[2], u[3]], arrival, counters);
        scattered.map_or(Vec3::ZERO, |(radiance, aperture, offset)| radiance * (aperture / (offset * probability)))
    }

    /// The same for all directions around a start: radiance over the density of the direction, the direction, and the
    /// cosine at the start (1 in the air).
    pub(super) fn lamps_around(
        &self,
        start: &Vertex,
        air: &mut Sampler,
        counters: &Counters,
    ) -> Option<(Vec3, Vec3, f32)> {
        if !M::PRESENT || !self.emitters.has_lamps() || !self.media.scatters_again(0) {
            return None;
        }
        let [pick, polar, azimuth, chosen] = air.next4();
        let (lamp, probability) = self.emitters.lamp_along(start.origin, start.origin, pick)?;
        let u = air.next4();
        let Around { dir, cos, sin } = Around::draw(start, lamp, [polar, azimuth])?;
        let share = self.share_around(start.origin, dir);
        if chosen >= share {
            return None;
        }
        let (crossing, probability) = (chosen / share, probability * share);
        let arrival = self.travel(start.origin, dir, crossing, counters);
        let leg = Leg { origin: start.origin, dir, length: arrival.distance };
        let stretch = self.media.scattering_stretch(&leg)?;
        let (radiance, aperture, offset) =
            self.scattered_once(&leg, stretch, lamp, [u[0], u[1], u[2]], &arrival, counters)?;
        Some((radiance * (aperture * Around::over_density(sin, offset) / probability), dir, cos))
    }

    /// Share of paths that look for a lamp's light in a direction around their start, by what the air stops there at most.
    fn share_around(&self, origin: Vec3, dir: Vec3) -> f32 {
        if !M::CACHED {
            return 1.0;
        }
        let stopped = opacity(self.media.transmittance(&Leg { origin, dir, length: f32::INFINITY }));
        (AROUND_LOOKS * self.media.looks_per_collision() * stopped).min(1.0)
    }

    /// One point of the leg, drawn equi-angularly about a lamp: the lamp's light scattered there back along the leg, over
    /// the density up to the factor `aperture / offset` (radians, metres), which is returned beside it.
    fn scattered_once(
        &self,
        leg: &Leg,
        (near, far): (f32, f32),
        lamp: &Light,
        u: [f32; 3],
        arrival: &Arrival,
        counters: &Counters,
    ) -> Option<(Vec3, f32, f32)> {
        let LitPoint { distance, target, irradiance, aperture, offset } = LitPoint::draw(leg, (near, far), lamp, u)?;
        let point = leg.at(distance);
        let ray = Ray { origin: point, dir: target - point, t_max: 1.0 };
        let towards = ray.dir.try_normalize()?;
        let scatter = self.media.scatter(point, leg.dir, towards);
        if scatter == Vec3::ZERO {
            return None;
        }
        let passed = self.media.transmittance(&Leg { length: distance, ..*leg }) * arrival.passed_before(distance);
        let lit = irradiance * self.visibility(&ray, towards, counters)?;
        Some((passed * scatter * lit, aperture, offset))
    }
}

/// A direction at a start, drawn uniformly in the angle from a lamp.
pub(super) struct Around {
    pub dir: Vec3,
    /// At the start; 1 in the air.
    pub cos: f32,
    /// Sine of the angle from the lamp.
    pub sin: f32,
}

impl Around {
    /// `None` where it leads below the surface.
    pub fn draw(start: &Vertex, lamp: &Light, [polar, azimuth]: [f32; 2]) -> Option<Self> {
        let way = punctual::ball(lamp)?.0 - start.origin;
        let (sin, cos) = (PI * polar).sin_cos();
        let (sin_phi, cos_phi) = (2.0 * PI * azimuth).sin_cos();
        let dir = warp::about(way.normalize_or(Vec3::Y), Vec3::new(sin * cos_phi, sin * sin_phi, cos)).normalize();
        let is_air = start.normal_geom == Vec3::ZERO;
        let received = if is_air { 1.0 } else { dir.dot(start.normal_shading) };
        let is_above = received > 0.0 && (is_air || dir.dot(start.normal_geom) > 0.0);
        is_above.then_some(Self { dir, cos: received, sin })
    }

    /// One over the density of the direction, divided by the offset of its leg from the lamp: `2π² sin γ / offset`, where
    /// `sin γ / offset` is 1 / distance to the lamp, hence bounded.
    pub fn over_density(sin: f32, offset: f32) -> f32 {
        2.0 * PI * PI * (sin / offset)
    }
}

/// A point of a leg, drawn equi-angularly about a lamp.
pub(super) struct LitPoint {
    pub distance: f32,
    /// On the lamp.
    pub target: Vec3,
    /// Of the lamp there, without air and shadows, over the density of the distance up to the factor `aperture / offset`.
    pub irradiance: Vec3,
    /// Angle under which the lamp sees the leg, radians.
    pub aperture: f32,
    /// Distance of the lamp from the leg's line, metres.
    pub offset: f32,
}

impl LitPoint {
    /// On the stretch from `near` to `far` of the leg.
    pub fn draw(leg: &Leg, (near, far): (f32, f32), lamp: &Light, u: [f32; 3]) -> Option<Self> {
        let (centre, radius) = punctual::ball(lamp)?;
        let way = centre - leg.origin;
        let nearest = way.dot(leg.dir);
        let offset = (way - nearest * leg.dir).length().max(radius);
        let (from, to) = (((near - nearest) / offset).atan(), ((far - nearest) / offset).atan());
        let along = offset * (from + u[0] * (to - from)).min(WIDEST).tan();
        let distance = (nearest + along).clamp(near, far);
        let (target, irradiance) = punctual::sample(lamp, leg.at(distance), u[1], u[2])?;
        // Density of the distance is offset / (aperture · (offset² + along²)).
        let irradiance = irradiance * (offset * offset + along * along);
        (irradiance != Vec3::ZERO).then_some(Self { distance, target, irradiance, aperture: to - from, offset })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_are_picked_as_often_as_told_and_none_is_left_out() {
        let look = |level: f32| Look { point: Vec3::splat(level), throughput: Vec3::ONE, level };
        for levels in [[0.0, 1.0, 3.0, 0.5], [0.0; 4], [2.0; 4]] {
            let (looks, n) = (levels.map(look), 10_000);
            let picked = |i: u32| Look::pick(&looks, (i as f32 + 0.5) / n as f32).expect("all collide");
            for one in &looks {
                let draws = (0..n).map(picked).filter(|(taken, _)| std::ptr::eq(*taken, one));
                let (count, sum) = draws.fold((0u32, 0.0), |(count, sum), (_, p)| (count + 1, sum + 1.0 / p));
                assert!(count as f32 >= 0.99 * EVENLY / 4.0 * n as f32, "level {}: {count} draws", one.level);
                assert!(
                    (sum / n as f32 - 1.0).abs() < 2e-3,
                    "level {}: a mean of 1/p of {}",
                    one.level,
                    sum / n as f32
                );
            }
        }
        assert!(Look::pick(&[Look::default(); 4], 0.3).is_none(), "nothing collides");
    }
}
