//! Light astray: random walks through the air from a first collision to the next surface or out of the scene, without any
//! look-up of light. They count what tables of an infinite medium cannot know.

use super::View;
use crate::solve::media::{Flight, Leg, Media};
use crate::solve::path::{Arrival, Counters};
use crate::solve::sampler::Sampler;
use glam::Vec3;

/// Collisions after which a walk is cut.
const LONGEST: u32 = 256;
/// Share of the first weight below which a walk may end at random.
const ROULETTE_BELOW: f32 = 0.1;

/// How a walk ends.
pub(super) struct Stray {
    /// Probability of all collisions, per channel, over that of this walk.
    pub weight: Vec3,
    /// At least one.
    pub collisions: u32,
    /// Direction in which the scene was left; `None` at a surface.
    pub exit: Option<Vec3>,
}

impl View<'_, '_> {
    /// A walk whose first collision lies on `leg`; `None` where none is possible or all is absorbed.
    pub(super) fn stray(&self, leg: &Leg, arrival: &Arrival, walk: &mut Sampler, counters: &Counters) -> Option<Stray> {
        let media = self.paths.media;
        let [u, v, ..] = walk.next4();
        let (distance, weight) = media.collide(leg, Vec3::ONE, [u, v])?;
        let mut weight = weight * arrival.passed_before(distance);
        let (mut point, mut dir, mut first) = (leg.at(distance), leg.dir, 0.0);
        for collisions in 1..LONGEST {
            let ([a, b, c, survive], [crossing, d, e, _]) = (walk.next4(), walk.next4());
            let deflected = media.deflect(point, dir, [a, b, c])?;
            weight *= deflected.weight;
            dir = deflected.dir;
            first = if collisions == 1 { weight.max_element() } else { first };
            let survival = (weight.max_element() / (ROULETTE_BELOW * first)).min(1.0);
            if survive >= survival {
                return None;
            }
            weight /= survival;
            let arrival = self.paths.travel(point, dir, crossing, counters);
            let leg = Leg { origin: point, dir, length: arrival.distance };
            match media.fly(&leg, weight, [d, e]) {
                Flight::Through(passed) => {
                    weight *= passed * arrival.passed;
                    return Some(Stray { weight, collisions, exit: arrival.hit.is_none().then_some(dir) });
                }
                Flight::Collision { distance, weight: passed } => {
                    weight *= passed * arrival.passed_before(distance);
                    point = leg.at(distance);
                }
            }
        }
        None
    }
}
