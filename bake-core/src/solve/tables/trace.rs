//! Paths over surfaces, recorded without air.

use super::fold::Fold;
use super::medium::Tabled;
use super::record::{Link, Lobe, Look, Once, Path, Step, Straight, Sunlit, Visit, Way};
use super::stations::Stations;
use super::{Ahead, View};
use crate::solve::air::{Around, LitPoint};
use crate::solve::emitters::{Strategy, Target};
use crate::solve::media::Leg;
use crate::solve::path::{Counters, Draw, Drawn, Vertex, mixed_pdf};
use crate::solve::sampler::Sampler;
use crate::trace::Ray;
use glam::Vec3;

/// One sample of so many looks at the own plane of a path's first vertex.
const BESIDE_EVERY: f32 = 3.0;
/// Share of later vertices at which a path goes on from the own plane.
const BESIDE_SHARE: f32 = 0.2;
/// Reflections after which Russian roulette may end a path.
const ROULETTE_FROM: u32 = 2;
/// Reflections after which a path is cut even when nothing absorbs.
const LONGEST_PATH: u32 = 1024;
/// Share of a stretch up to which points by the logarithm of the distance lie evenly.
const NEAR: f32 = 1e-3;
/// What air about as thick as walls are wide scatters, in the middle of a closed room a quarter of all: what Russian roulette
/// goes by.
const NOMINAL: f32 = 0.06;

/// Records paths; vertices learn which station speaks for them.
pub(super) struct Recorder<'t, 'a, 's> {
    pub view: &'t View<'a, 's>,
    pub stations: &'t Stations,
    pub counters: &'t Counters,
    /// The air that will fold paths; without it they go on long enough for any.
    pub fold: Option<Fold<'t>>,
}

impl Recorder<'_, '_, '_> {
    /// One path from a vertex.
    pub fn record(&self, start: &Vertex, sampler: &mut Sampler) -> Path {
        let paths = &self.view.paths;
        let straight = paths.emitters.strategies().iter().filter_map(|&strategy| {
            let [u, v, w, _] = sampler.next4();
            paths.draw_clear(Draw::first(strategy), start, [u, v, w], self.counters).map(|drawn| Straight::from(&drawn))
        });
        let mut path = Path { straight: straight.collect(), start: Visit::at(start, None), ..Path::default() };
        let mut air = sampler.fork();
        self.see_emitters(start, &mut path.start, true, &mut air);
        let [u, v, crossing, lobe] = sampler.next4();
        let ahead = self.view.look(start, [u, v, crossing], self.counters);
        path.start.look = ahead.as_ref().map(|ahead| self.seen(start, ahead, 1.0, &mut air));
        if paths.bounces > 0
            && let Some(next) = ahead.and_then(|ahead| ahead.onward(self.view, lobe))
        {
            self.follow(&path.start, next, &mut path.chains[0], sampler, &mut air);
        }
        let mut second = air.fork();
        let [choice, a, b, lobe] = second.next4();
        if self.view.own_plane
            && choice * BESIDE_EVERY < 1.0
            && paths.bounces > 0
            && let Some(beside) = self.view.beside(start, [a, b], self.counters)
            && let Some((step, vertex, albedo)) = beside.onward(self.view, lobe)
        {
            let mut more_air = second.fork();
            let next = (step.times(BESIDE_EVERY), vertex, albedo);
            self.follow(&path.start, next, &mut path.chains[1], &mut second, &mut more_air);
        }
        path
    }

    /// Follows a path on from its second vertex.
    fn follow(
        &self,
        start: &Visit,
        (mut step, mut vertex, albedo): (Step, Vertex, Vec3),
        chain: &mut Vec<Link>,
        sampler: &mut Sampler,
        air: &mut Sampler,
    ) {
        let paths = &self.view.paths;
        // In closed rooms other surfaces stand for the own plane: it is one among many there, and far from the texel.
        let share = if self.view.own_plane && !self.view.is_closed { BESIDE_SHARE } else { 0.0 };
        let mut carried = self.weight(start, &step, albedo);
        for bounce in 1u32.. {
            let [pick, u, v, survive] = sampler.next4();
            let mut visit = Visit::at(&vertex, self.stations.nearest(&vertex));
            let strategies = paths.emitters.strategies();
            let draws = 1.0 / strategies.len().max(1) as f32;
            let place = pick * strategies.len() as f32;
            visit.straight = strategies.get((place as usize).min(strategies.len().saturating_sub(1))).and_then(|&s| {
                let draw = Draw { strategy: s, share: draws, is_first: false };
                paths
                    .draw_clear(draw, &vertex, [place.fract(), u, v], self.counters)
                    .map(|drawn| Straight::from(&drawn))
            });
            self.see_emitters(&vertex, &mut visit, false, air);
            let [a, b, crossing, lobe] = sampler.next4();
            let ahead = self.view.look(&vertex, [a, b, crossing], self.counters);
            visit.look = ahead.as_ref().map(|ahead| self.seen(&vertex, ahead, draws, air));
            chain.push(Link { step, visit });
            if bounce >= paths.bounces {
                return;
            }
            if bounce >= LONGEST_PATH {
                self.counters.cut_paths.set(self.counters.cut_paths.get() + 1);
                return;
            }
            let [choice, e, f, _] = air.next4();
            let (next, probability) = if choice < share {
                let beside = self.view.beside(&vertex, [e, f], self.counters);
                (beside.and_then(|beside| beside.onward(self.view, lobe)), share)
            } else {
                (ahead.and_then(|ahead| ahead.onward(self.view, lobe)), 1.0 - share)
            };
            let Some((onward, at, albedo)) = next else { return };
            carried *= self.weight(&visit, &onward, albedo) / probability;
            // One heavy step must not keep all that follow alive.
            carried /= carried.max_element().max(1.0);
            let survival = if bounce >= ROULETTE_FROM { carried.max_element().min(1.0) } else { 1.0 };
            if survive >= survival {
                return;
            }
            carried /= survival;
            step = onward.times(1.0 / (probability * survival));
            vertex = at;
        }
    }

    /// What a step weighs: paths that matter go on.
    fn weight(&self, visit: &Visit, step: &Step, albedo: Vec3) -> Vec3 {
        match &self.fold {
            Some(fold) => fold.weight(visit, step),
            None => albedo * self.nominal(visit, step),
        }
    }

    /// What a step weighs in air about as thick as walls are wide, π times and up to the albedo: that much readier paths go on,
    /// as other air may be thicker. Scattering is taken as `e^(−x)/x` times the inverse square.
    fn nominal(&self, visit: &Visit, step: &Step) -> f32 {
        let scattered = |x: f32| NOMINAL * step.weight / (self.view.wall * self.view.wall) * (-x).exp() / x;
        let weight = match (step.way, &visit.look) {
            (Way::Beside { length, .. }, _) => scattered(length / self.view.wall),
            (Way::Ahead, Some(look)) => {
                let (x, cos) = (look.length / self.view.wall, look.dir.dot(visit.normal));
                (-x).exp() * cos / mixed_pdf(cos) + scattered(x)
            }
            (Way::Ahead, None) => 0.0,
        };
        // Also of no number, where points coincide.
        if weight > 0.0 { weight.min(f32::MAX) } else { 0.0 }
    }

    /// What a vertex receives of finite emitters through the air. A path's later vertices draw one of two estimates.
    fn see_emitters(&self, vertex: &Vertex, visit: &mut Visit, is_first: bool, air: &mut Sampler) {
        let numbers = air.next4();
        let (around, finite) = match (is_first, self.view.paths.emitters.has_lamps()) {
            (false, true) if numbers[3] < 0.5 => (2.0, 0.0),
            (false, true) => (0.0, 2.0),
            _ => (1.0, 1.0),
        };
        if around > 0.0 {
            visit.once = self.once(vertex, around, air);
        }
        if finite > 0.0 {
            visit.lobe = self.lobe(vertex, finite, numbers);
        }
    }

    /// A lamp's light by way of one point of a direction around the vertex.
    fn once(&self, vertex: &Vertex, factor: f32, air: &mut Sampler) -> Option<Once> {
        let paths = &self.view.paths;
        if !paths.emitters.has_lamps() {
            return None;
        }
        let ([pick, polar, azimuth, crossing], [a, b, c, _]) = (air.next4(), air.next4());
        let (lamp, probability) = paths.emitters.lamp_along(vertex.origin, vertex.origin, pick)?;
        let Around { dir, cos, sin } = Around::draw(vertex, lamp, [polar, azimuth])?;
        let arrival = paths.travel(vertex.origin, dir, crossing, self.counters);
        let leg = Leg { origin: vertex.origin, dir, length: arrival.distance };
        let LitPoint { distance, target, irradiance, aperture, offset } =
            LitPoint::draw(&leg, (0.0, leg.length), lamp, [a, b, c])?;
        let origin = leg.at(distance);
        let way = target - origin;
        let passed = self.shadow(&Ray { origin, dir: way, t_max: 1.0 })? * arrival.passed_before(distance);
        let over_density = aperture * Around::over_density(sin, offset) / probability;
        let strength = irradiance * passed * (cos * over_density * factor);
        let (towards, rest) = (way.try_normalize()?, way.length());
        Some(Once { dir, distance, towards, rest, strength })
    }

    /// An emitter in sight.
    fn lobe(&self, vertex: &Vertex, factor: f32, [u, v, w, _]: [f32; 4]) -> Option<Lobe> {
        let paths = &self.view.paths;
        let (emitter, probability) = paths.emitters.around(vertex.origin, u)?;
        let source = paths.emitters.source(paths.tracer, emitter, v, w);
        self.counters.shadow_rays.set(self.counters.shadow_rays.get() + 1);
        let (seen, Leg { dir, length, .. }) = self.view.sees(vertex, &source)?;
        Some(Lobe { emitter, dir, length, axis: seen.axis, strength: seen.strength * (factor / probability) })
    }

    /// The emitters along a look.
    fn seen(&self, vertex: &Vertex, ahead: &Ahead, draws: f32, air: &mut Sampler) -> Look {
        let Ahead { leg, pdf, cos, arrival } = ahead;
        let paths = &self.view.paths;
        let glow = arrival.passed * paths.emitted(vertex, leg.dir, *pdf, draws, arrival) * (cos / pdf);
        let escapes = arrival.hit.is_none();
        let sky = if escapes { paths.emitters.environment(leg.dir) * arrival.passed / *pdf } else { Vec3::ZERO };
        let sun = self.sunlit(ahead, air);
        Look { dir: leg.dir, length: leg.length, glow, sky, sun }
    }

    /// A point of the look that a sun shines on.
    fn sunlit(&self, ahead: &Ahead, air: &mut Sampler) -> Option<Sunlit> {
        let paths = &self.view.paths;
        let is_sun = |s: &&Strategy| matches!(s, Strategy::Directional(_));
        let mut suns = paths.emitters.strategies().iter().filter(is_sun);
        let count = suns.clone().count();
        if count == 0 {
            return None;
        }
        let [pick, u, b, c] = air.next4();
        let place = pick * count as f32;
        let strategy = *suns.nth((place as usize).min(count - 1))?;
        let Strategy::Directional(light) = strategy else { return None };
        let likely = self.view.likely_stretch(&ahead.leg);
        let spread = Spread::new(paths.media, &ahead.leg, self.view.extent, likely);
        let (distance, over_density) = spread.draw([place.fract(), u])?;
        let origin = ahead.leg.at(distance);
        let drawn = paths.emitters.sample(paths.tracer, strategy, origin, Vec3::ZERO, [0.0, b, c])?;
        let Target::Direction(dir) = drawn.target else { return None };
        let passed = self.shadow(&Ray { origin, dir, t_max: f32::INFINITY })? * ahead.arrival.passed_before(distance);
        let weight = ahead.cos / ahead.pdf * count as f32 * over_density;
        Some(Sunlit { light, distance, strength: drawn.irradiance * passed * weight })
    }

    /// What surfaces leave of light along a shadow ray; `None` where it is blocked.
    fn shadow(&self, ray: &Ray) -> Option<Vec3> {
        self.counters.shadow_rays.set(self.counters.shadow_rays.get() + 1);
        let passed = self.view.paths.tracer.transmittance(ray);
        (passed != Vec3::ZERO).then_some(passed)
    }
}

/// Where on a leg a sun is looked for: where the air at hand scatters, or would if it were of any other thickness, evenly and by
/// the logarithm of the distance over the stretch where air is likely; and now and then anywhere, on a leg without end
/// thinning out as the inverse square beyond `extent`. The shares decide on noise alone, in this air and in any other.
struct Spread<'l, 'a> {
    air: &'l Tabled<'a>,
    leg: &'l Leg,
    extent: f32,
    likely: Option<(f32, f32)>,
    /// Shares of the air at hand, of both ways over the likely stretch, and of anywhere.
    shares: [f32; 3],
}

impl<'l, 'a> Spread<'l, 'a> {
    fn new(air: &'l Tabled<'a>, leg: &'l Leg, extent: f32, likely: Option<(f32, f32)>) -> Self {
        let has_air = air.depth(leg).max_element() > 0.0;
        let shares = match (has_air, likely.is_some()) {
            (true, true) => [0.6, 0.35, 0.05],
            (true, false) => [0.9, 0.0, 0.1],
            (false, true) => [0.0, 0.9, 0.1],
            (false, false) => [0.0, 0.0, 1.0],
        };
        Self { air, leg, extent, likely, shares }
    }

    /// A point, metres from the leg's start, and one over its density.
    fn draw(&self, [u, v]: [f32; 2]) -> Option<(f32, f32)> {
        let [own, likely, _] = self.shares;
        let distance = if u < own {
            self.air.draw_collision(self.leg, [u / own, v])?
        } else if u < own + likely {
            let ((from, to), u) = (self.likely?, (u - own) / likely);
            let by_logarithm = NEAR * (v * (1.0 / NEAR).ln_1p()).exp_m1();
            (from + (to - from) * if u < 0.5 { v } else { by_logarithm }).min(to)
        } else if self.leg.length.is_infinite() {
            self.extent * v / (1.0 - v)
        } else {
            self.leg.length * v
        };
        Some((distance, 1.0 / self.density(distance)))
    }

    fn density(&self, distance: f32) -> f32 {
        let [own, likely, anywhere] = self.shares;
        let mut density = anywhere
            * if self.leg.length.is_infinite() {
                self.extent / (self.extent + distance).powi(2)
            } else {
                1.0 / self.leg.length
            };
        if own > 0.0 {
            density += own * self.air.collision_pdf(self.leg, distance);
        }
        if let Some((from, to)) = self.likely.filter(|&(from, to)| distance >= from && distance <= to) {
            let size = to - from;
            let by_logarithm = 1.0 / ((NEAR * size + distance - from) * (1.0 / NEAR).ln_1p());
            density += 0.5 * likely * (1.0 / size + by_logarithm);
        }
        density
    }
}

impl From<&Drawn> for Straight {
    fn from(Drawn { irradiance, ray, dir, cos }: &Drawn) -> Self {
        Self { dir: *dir, length: ray.t_max * ray.dir.length(), irradiance: irradiance * *cos }
    }
}

impl Step {
    /// With `reflect` times a factor.
    fn times(self, factor: f32) -> Self {
        Self { reflect: self.reflect * factor, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, Medium, MediumSet, Scatter};
    use glam::DVec3;

    /// Exponentials of any steepness are met, on legs with and without end, whatever air is at hand.
    #[test]
    fn points_of_a_leg_follow_their_density() {
        let bounds = Bounds::Box { min: DVec3::splat(-1.0), max: DVec3::new(1.5, 1.0, 1.0) };
        let scatter = Scatter { sigma_s: [0.5, 1.0, 2.0], sigma_a: [0.1; 3] };
        let fog = MediumSet { media: vec![Medium { bounds, scatter, ..Medium::default() }] };
        let airs = [MediumSet::default(), fog];
        let legs = [(2.0, None), (2.0, Some((0.0, 2.0))), (f32::INFINITY, Some((0.5, 1.5))), (f32::INFINITY, None)];
        for (air, (length, likely)) in airs.iter().flat_map(|air| legs.map(|leg| (air, leg))) {
            let (tabled, leg) = (Tabled::new(air), Leg { origin: Vec3::ZERO, dir: Vec3::X, length });
            let spread = Spread::new(&tabled, &leg, 3.0, likely);
            let mean = |f: &dyn Fn(f64) -> f64| {
                // All shares are whole numbers of the first.
                let (n, m) = (200, 512);
                let one = |i: i32, j: i32| {
                    let u = [(i as f32 + 0.5) / n as f32, (j as f32 + 0.5) / m as f32];
                    spread.draw(u).map_or(0.0, |(t, over_density)| f(f64::from(t)) * f64::from(over_density))
                };
                (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| one(i, j)).sum::<f64>() / f64::from(n * m)
            };
            for sigma in [0.3, 5.0, 40.0] {
                let got = mean(&|t| sigma * (-sigma * t).exp());
                let want = 1.0 - (-sigma * f64::from(length)).exp();
                assert!((got / want - 1.0).abs() < 0.01, "{length} {likely:?} sigma {sigma}: {got}, {want}");
                assert!((1.03 * got / want - 1.0).abs() > 0.01, "3 % too many are told apart");
            }
        }
    }
}
