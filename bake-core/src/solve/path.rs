//! One path from a surface point: what arrives straight from emitters, and what arrives after reflections.
//!
//! At every vertex emitters are drawn (next-event estimation) and one direction is followed; what both can find is
//! weighed by the power heuristic (Veach 1997). Surfaces are Lambertian. Blended and transmissive surfaces on the way
//! are crossed at random in proportion to what they let through. What happens in the air stands in [`super::air`].

use super::air::{Onward, Step};
use super::emitters::{Emitters, LightSample, Strategy, Target};
use super::media::{Leg, Media};
use super::sampler::Sampler;
use super::warp;
use crate::scene::surface::Surface;
use crate::trace::passage::Chords;
use crate::trace::{Hit, Place, Ray, Tracer};
use bake_formats::Term;
use glam::Vec3;
use std::cell::Cell;
use std::f32::consts::{PI, TAU};

/// Reflections after which a path is cut even when nothing absorbs.
const LONGEST_PATH: u32 = 1024;
/// Legs after which a path is cut that no collision absorbs.
const LONGEST_WALK: u32 = 1 << 16;
/// Reflections after which Russian roulette may end a path.
const ROULETTE_FROM: u32 = 2;
/// Permeable surfaces that one segment may cross.
const MOST_CROSSINGS: u32 = 128;

/// Where a path starts or goes on: a point with its two normals, on the side from which light arrives.
#[derive(Debug, Clone, Copy)]
pub struct Vertex {
    /// Origin of rays, clear of the surface.
    pub origin: Vec3,
    /// Unit geometric normal; zero for a vertex in the air.
    pub normal_geom: Vec3,
    /// Unit normal of the cosine; zero for a vertex in the air.
    pub normal_shading: Vec3,
}

/// Irradiance (lux) that one path estimates, by term, and its l ≤ 1 harmonics (order 0, y, z, x) of incident radiance.
#[derive(Debug, Clone, Copy, Default)]
pub struct Gathered {
    /// By term, in the order of [`Term`].
    pub terms: [Vec3; 4],
    /// Harmonics, when asked for.
    pub sh1: [Vec3; 4],
}

/// Estimates the light that arrives at a point of a surface.
pub trait Gather: Sync {
    /// The terms into which light falls.
    const TERMS: &'static [Term];

    /// The scene.
    fn tracer(&self) -> &Tracer<'_>;

    /// One sample.
    fn gather(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Gathered;
}

/// Rare and countable things that happened on the way.
#[derive(Debug, Clone, Default)]
pub struct Counters {
    /// Closest-hit rays.
    pub rays: Cell<u64>,
    /// Shadow rays.
    pub shadow_rays: Cell<u64>,
    /// Paths cut at the longest length.
    pub cut_paths: Cell<u64>,
}

impl Counters {
    /// Adds to the sums of rays, shadow rays and cut paths.
    pub fn add_to(&self, sums: &mut [u64; 3]) {
        sums.iter_mut().zip([&self.rays, &self.shadow_rays, &self.cut_paths]).for_each(|(sum, n)| *sum += n.get());
    }
}

/// Follows paths through a scene and its air.
pub struct Paths<'a, 's, M> {
    /// Geometry.
    pub tracer: &'a Tracer<'s>,
    /// Emitters.
    pub emitters: &'a Emitters<'s>,
    /// Air.
    pub media: &'a M,
    /// Most reflections.
    pub bounces: u32,
    /// Whether harmonics are gathered; directions are then drawn half by cosine, half uniformly, so that weights stay bounded.
    pub sh1: bool,
}

/// A draw towards emitters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    pub strategy: Strategy,
    /// Probability with which this strategy was taken among all.
    pub share: f32,
    /// At the start of a path, where directions may be drawn in another way than later.
    pub is_first: bool,
}

impl Draw {
    /// One of the draws of all strategies that the start makes.
    pub fn first(strategy: Strategy) -> Self {
        Self { strategy, share: 1.0, is_first: true }
    }
}

/// Light that a draw sends to a vertex, as it would arrive without air.
pub(super) struct Drawn {
    /// On a surface perpendicular to the way.
    pub irradiance: Vec3,
    /// The way, and its unit direction.
    pub ray: Ray,
    pub dir: Vec3,
    /// At the vertex.
    pub cos: f32,
}

/// What a ray arrives at.
pub(super) struct Arrival {
    pub(super) hit: Option<(Hit, Place, Surface)>,
    pub(super) distance: f32,
    /// What the surfaces crossed on the way let through.
    pub(super) passed: Vec3,
    /// The same up to each crossing, with its distance; kept where there is air.
    crossings: Vec<(f32, Vec3)>,
}

/// The last leg of light on its way to the start of a path: what names its term.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LastLeg {
    collisions: usize,
    surface: Option<Term>,
}

impl LastLeg {
    /// Light that an emitter sends here.
    fn of_emitter(self) -> usize {
        self.surface.unwrap_or([Term::Direct, Term::Single, Term::Multiple][self.collisions.min(2)]) as usize
    }

    /// Light that comes here with one collision more.
    pub(super) fn of_collision(self) -> usize {
        Self { collisions: self.collisions + 1, ..self }.of_emitter()
    }

    /// Light that comes here with two collisions more, or any number above.
    pub(super) fn of_collisions(self) -> usize {
        self.surface.unwrap_or(Term::Multiple) as usize
    }

    fn meet_surface(&mut self) {
        let reflected = if self.collisions == 0 { Term::Indirect as usize } else { self.of_emitter() };
        self.surface.get_or_insert(Term::ALL[reflected]);
    }
}

impl Vertex {
    /// The vertex at a point of a triangle, on its front (`side` = 1) or back (−1).
    pub fn on(tracer: &Tracer, (instance, triangle, at): (u32, u32, glam::Vec2), place: &Place, side: f32) -> Self {
        let normal_geom = place.normal_geom * side;
        let shading = tracer.shading_normal(instance, triangle, at, place.normal_geom) * side;
        Self { origin: place.point.offset_along(normal_geom), normal_geom, normal_shading: shading }
    }
}

impl<M: Media> Gather for Paths<'_, '_, M> {
    const TERMS: &'static [Term] = M::TERMS;

    fn tracer(&self) -> &Tracer<'_> {
        self.tracer
    }

    fn gather(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Gathered {
        Paths::gather(self, start, sampler, counters)
    }
}

impl<M: Media> Paths<'_, '_, M> {
    /// Follows one path from a vertex.
    pub fn gather(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Gathered {
        let mut gathered = Gathered::default();
        for &strategy in self.emitters.strategies() {
            let [u, v, w, _] = sampler.next4();
            if let Some((irradiance, dir, cos)) = self.draw(Draw::first(strategy), start, [u, v, w], counters) {
                gathered.terms[Term::Direct as usize] += irradiance * cos;
                self.project(&mut gathered.sh1, dir, irradiance);
            }
        }
        // The air draws from a sequence of its own: without it surfaces get the same numbers.
        let mut air = sampler.fork();
        if let Some((radiance, dir, cos)) = self.lamps_around(start, &mut air, counters) {
            gathered.terms[Term::Single as usize] += radiance * cos;
            self.project(&mut gathered.sh1, dir, radiance);
        }
        let [u, v, crossing, lobe] = sampler.next4();
        let (dir, pdf) = self.first_direction(start, u, v);
        let cos = dir.dot(start.normal_shading);
        if cos <= 0.0 || dir.dot(start.normal_geom) <= 0.0 {
            return gathered;
        }
        let radiance = self.follow(start, dir, pdf, [crossing, lobe], (sampler, &mut air), counters);
        gathered.terms.iter_mut().zip(radiance).for_each(|(sum, part)| *sum += part * (cos / pdf));
        self.project(&mut gathered.sh1, dir, radiance.into_iter().sum::<Vec3>() / pdf);
        gathered
    }

    /// Radiance by term that arrives at `start` from `dir`, whose density is `pdf`: from the emitter straight ahead
    /// (weighed against next-event estimation), from whatever reflects there, and from the air before.
    ///
    /// Light of point and spot lights that the first leg scatters is left to [`Self::lamps_around`].
    pub(super) fn follow(
        &self,
        start: &Vertex,
        dir: Vec3,
        pdf: f32,
        [crossing, lobe]: [f32; 2],
        (sampler, air): (&mut Sampler, &mut Sampler),
        counters: &Counters,
    ) -> [Vec3; 4] {
        let mut radiance = [Vec3::ZERO; 4];
        let (mut vertex, mut dir, mut pdf, mut crossing, mut lobe) = (*start, dir, pdf, crossing, lobe);
        let mut throughput = Vec3::ONE;
        let mut draws = 1.0; // share of the strategies that were drawn at the vertex
        let (mut bounce, mut last_leg, mut collisions) = (0, LastLeg::default(), 0);
        for leg in 0.. {
            let mut arrival = self.travel(vertex.origin, dir, crossing, counters);
            if M::PRESENT {
                let step = Step { vertex, dir, throughput, last_leg, collisions, is_first: leg == 0 };
                match self.cross_air(&step, &mut arrival, &mut radiance, air, counters) {
                    Onward::Collision(collision) if leg < LONGEST_WALK => {
                        (vertex, dir, pdf, draws) = (collision.vertex, collision.dir, collision.pdf, collision.draws);
                        (throughput, crossing) = (collision.throughput, collision.crossing);
                        last_leg.collisions += 1;
                        collisions += 1;
                        continue;
                    }
                    Onward::Collision(_) => {
                        counters.cut_paths.set(counters.cut_paths.get() + 1);
                        break;
                    }
                    Onward::Absorbed => break,
                    Onward::Through => {}
                }
            }
            throughput *= arrival.passed;
            radiance[last_leg.of_emitter()] += throughput * self.emitted(&vertex, dir, pdf, draws, &arrival);
            let Some((hit, place, surface)) = arrival.hit else { break };
            if bounce >= self.bounces {
                break;
            }
            if bounce >= LONGEST_PATH {
                counters.cut_paths.set(counters.cut_paths.get() + 1);
                break;
            }
            let Some((next, weight)) = self.scatter(&hit, &place, &surface, lobe) else { break };
            vertex = next;
            throughput *= weight;
            last_leg.meet_surface();
            collisions = 0;

            let [pick, u, v, survive] = sampler.next4();
            let (light, share) = self.reflect_emitters(&vertex, bounce, [pick, u, v], sampler, counters);
            radiance[last_leg.of_emitter()] += throughput * light;
            draws = share;
            if bounce + 1 >= ROULETTE_FROM {
                let survival = throughput.max_element().min(1.0);
                if survive >= survival {
                    break;
                }
                throughput /= survival;
            }
            bounce += 1;
            let numbers = sampler.next4();
            dir = warp::about(vertex.normal_shading, warp::cosine_hemisphere(numbers[0], numbers[1]));
            pdf = warp::cosine_pdf(dir.dot(vertex.normal_shading));
            (crossing, lobe) = (numbers[2], numbers[3]);
            if pdf <= 0.0 || dir.dot(vertex.normal_geom) <= 0.0 {
                break;
            }
        }
        radiance
    }

    /// Radiance that a vertex of albedo 1 reflects straight from emitters, and the share of the strategies that were drawn:
    /// all at the first reflection, which brings most of indirect light and most of its noise, one of them later on.
    fn reflect_emitters(
        &self,
        vertex: &Vertex,
        bounce: u32,
        [pick, u, v]: [f32; 3],
        sampler: &mut Sampler,
        counters: &Counters,
    ) -> (Vec3, f32) {
        let strategies = self.emitters.strategies();
        let reflect = |strategy, share, u| {
            let drawn = self.draw(Draw { strategy, share, is_first: false }, vertex, u, counters);
            drawn.map_or(Vec3::ZERO, |(irradiance, _, cos)| irradiance * (cos / PI))
        };
        let Some((&first, others)) = strategies.split_first() else { return (Vec3::ZERO, 1.0) };
        if bounce > 0 {
            let share = 1.0 / strategies.len() as f32;
            let place = pick * strategies.len() as f32;
            let strategy = strategies[(place as usize).min(others.len())];
            return (reflect(strategy, share, [place.fract(), u, v]), share);
        }
        let mut light = reflect(first, 1.0, [pick, u, v]);
        for &strategy in others {
            let [u, v, w, _] = sampler.next4();
            light += reflect(strategy, 1.0, [u, v, w]);
        }
        (light, 1.0)
    }

    /// Direction at the first vertex with its density.
    pub(super) fn first_direction(&self, start: &Vertex, u: f32, v: f32) -> (Vec3, f32) {
        if !self.sh1 && !M::MIXED {
            let dir = warp::about(start.normal_shading, warp::cosine_hemisphere(u, v));
            return (dir, warp::cosine_pdf(dir.dot(start.normal_shading)));
        }
        let local =
            if u < 0.5 { warp::cosine_hemisphere(2.0 * u, v) } else { warp::uniform_hemisphere(2.0 * u - 1.0, v) };
        let dir = warp::about(start.normal_shading, local);
        let cos = dir.dot(start.normal_shading);
        (dir, mixed_pdf(cos))
    }

    /// Radiance that the arrival emits towards `dir`'s origin, weighed against the draws made at `vertex`.
    pub(super) fn emitted(&self, vertex: &Vertex, dir: Vec3, pdf: f32, draws: f32, arrival: &Arrival) -> Vec3 {
        match &arrival.hit {
            None => {
                let radiance = self.emitters.environment(dir);
                if radiance == Vec3::ZERO {
                    return Vec3::ZERO;
                }
                radiance * power_heuristic(pdf, draws * self.emitters.environment_pdf(dir))
            }
            Some((hit, place, surface)) if surface.emission != Vec3::ZERO => {
                let drawn =
                    self.emitters.finite_pdf(vertex.origin, vertex.normal_shading, dir, arrival.distance, hit, place);
                surface.emission * power_heuristic(pdf, draws * drawn)
            }
            Some(_) => Vec3::ZERO,
        }
    }

    /// One draw of a strategy: irradiance on a surface perpendicular to the way, the direction, and the cosine at the
    /// vertex.
    pub(super) fn draw(
        &self,
        draw: Draw,
        vertex: &Vertex,
        u: [f32; 3],
        counters: &Counters,
    ) -> Option<(Vec3, Vec3, f32)> {
        let Drawn { irradiance, ray, dir, cos } = self.draw_clear(draw, vertex, u, counters)?;
        Some((irradiance * self.through_air(&ray, dir), dir, cos))
    }

    /// The same without air.
    pub(super) fn draw_clear(
        &self,
        Draw { strategy, share, is_first }: Draw,
        vertex: &Vertex,
        u: [f32; 3],
        counters: &Counters,
    ) -> Option<Drawn> {
        let LightSample { target, irradiance, pdf } =
            self.emitters.sample(self.tracer, strategy, vertex.origin, vertex.normal_shading, u)?;
        let (ray, dir) = match target {
            Target::Point(point) => {
                let way = point - vertex.origin;
                (Ray { origin: vertex.origin, dir: way, t_max: 1.0 }, way.try_normalize()?)
            }
            Target::Direction(dir) => (Ray { origin: vertex.origin, dir, t_max: f32::INFINITY }, dir),
        };
        let cos = dir.dot(vertex.normal_shading);
        if cos <= 0.0 || dir.dot(vertex.normal_geom) <= 0.0 || irradiance == Vec3::ZERO {
            return None;
        }
        counters.shadow_rays.set(counters.shadow_rays.get() + 1);
        let passed = self.tracer.transmittance(&ray);
        if passed == Vec3::ZERO {
            return None;
        }
        let weight = pdf.map_or(1.0, |pdf| power_heuristic(share * pdf, self.direction_pdf(cos, is_first)));
        Some(Drawn { irradiance: irradiance * passed * (weight / share), ray, dir, cos })
    }

    /// Density with which the other strategy would have followed a direction at `cos` from the normal.
    fn direction_pdf(&self, cos: f32, is_first: bool) -> f32 {
        if M::MIXED || (self.sh1 && is_first) { mixed_pdf(cos) } else { warp::cosine_pdf(cos) }
    }

    /// Straight on to the next surface that does not let the ray through.
    pub(super) fn travel(&self, mut origin: Vec3, dir: Vec3, mut crossing: f32, counters: &Counters) -> Arrival {
        let (mut passed, mut distance, mut chords, mut crossings) = (Vec3::ONE, 0.0, Chords::default(), vec![]);
        for _ in 0..MOST_CROSSINGS {
            counters.rays.set(counters.rays.get() + 1);
            let Some(mut hit) = self.tracer.closest_hit(&Ray { origin, dir, t_max: f32::INFINITY }) else {
                let passed = passed * chords.transmittance(f32::INFINITY, dir);
                return Arrival { hit: None, distance: f32::INFINITY, passed, crossings };
            };
            distance += hit.t;
            hit.t = distance;
            let place = self.tracer.place(hit.instance, hit.triangle, hit.barycentric);
            let scene = self.tracer.scene();
            let surface = Surface::at(scene, hit.instance, hit.triangle, hit.barycentric);
            if surface.through != Vec3::ZERO {
                let through = surface.through.max_element();
                let through = through / (through + surface.reflect.max_element() + surface.transmit.max_element());
                if crossing < through {
                    crossing = (crossing / through).min(1.0 - f32::EPSILON);
                    passed *= surface.through / through;
                    if M::PRESENT {
                        crossings.push((distance, passed));
                    }
                    chords.cross(scene.material_at(hit.instance, hit.triangle).volume_sigma_a, &hit);
                    let ahead = place.normal_geom * if dir.dot(place.normal_geom) > 0.0 { 1.0 } else { -1.0 };
                    origin = place.point.offset_along(ahead);
                    continue;
                }
                passed /= 1.0 - through;
            }
            let passed = passed * chords.transmittance(distance, dir);
            return Arrival { hit: Some((hit, place, seen_from(surface, scene, &hit))), distance, passed, crossings };
        }
        Arrival { hit: None, distance: f32::INFINITY, passed: Vec3::ZERO, crossings }
    }

    /// The vertex on the side from which reflected (or diffusely transmitted) light comes, and albedo over the
    /// probability of that side.
    pub(super) fn scatter(&self, hit: &Hit, place: &Place, surface: &Surface, lobe: f32) -> Option<(Vertex, Vec3)> {
        let (reflect, transmit) = (surface.reflect.max_element(), surface.transmit.max_element());
        if reflect + transmit <= 0.0 {
            return None;
        }
        let reflecting = reflect / (reflect + transmit);
        let same_side = lobe < reflecting;
        let weight = if same_side { surface.reflect / reflecting } else { surface.transmit / (1.0 - reflecting) };
        let side = if hit.back_face == same_side { -1.0 } else { 1.0 };
        Some((self.vertex(hit.instance, hit.triangle, hit.barycentric, place, side), weight))
    }

    /// The vertex at a surface point, on its front (`side` = 1) or back (−1).
    pub fn vertex(&self, instance: u32, triangle: u32, barycentric: glam::Vec2, place: &Place, side: f32) -> Vertex {
        Vertex::on(self.tracer, (instance, triangle, barycentric), place, side)
    }

    /// What the air leaves of light along a shadow ray with unit direction `dir`.
    pub(super) fn through_air(&self, ray: &Ray, dir: Vec3) -> Vec3 {
        if !M::PRESENT {
            return Vec3::ONE;
        }
        self.media.transmittance(&Leg { origin: ray.origin, dir, length: ray.t_max * ray.dir.length() })
    }

    pub(super) fn project(&self, sh1: &mut [Vec3; 4], dir: Vec3, radiance: Vec3) {
        if self.sh1 {
            let basis = [0.282_094_8, 0.488_602_5 * dir.y, 0.488_602_5 * dir.z, 0.488_602_5 * dir.x];
            for (coefficient, y) in sh1.iter_mut().zip(basis) {
                *coefficient += radiance * y;
            }
        }
    }
}

impl Arrival {
    /// What the surfaces crossed before `distance` let through.
    pub(super) fn passed_before(&self, distance: f32) -> Vec3 {
        self.crossings.iter().rev().find(|(at, _)| *at < distance).map_or(Vec3::ONE, |(_, passed)| *passed)
    }

    /// Weakens what arrives from beyond the air.
    pub(super) fn weaken(&mut self, by: Vec3) {
        self.passed *= by;
    }
}

/// A single-sided surface seen from behind neither reflects nor emits, it only blocks (and lets through what it did).
fn seen_from(surface: Surface, scene: &crate::scene::Scene, hit: &Hit) -> Surface {
    if hit.back_face && !scene.material_at(hit.instance, hit.triangle).double_sided {
        return Surface { reflect: Vec3::ZERO, transmit: Vec3::ZERO, emission: Vec3::ZERO, ..surface };
    }
    surface
}

/// Density of a direction at `cos` from the normal that is drawn half by cosine and half uniformly.
pub(super) fn mixed_pdf(cos: f32) -> f32 {
    0.5 * warp::cosine_pdf(cos) + 0.5 / TAU
}

/// Weight of a strategy with density `own` beside one with density `other`.
pub(super) fn power_heuristic(own: f32, other: f32) -> f32 {
    if other <= 0.0 {
        return 1.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
