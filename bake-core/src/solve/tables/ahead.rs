//! One look from a surface point into the scene, and the points beside it on its own plane: where a path may go on.

use super::View;
use super::record::{Step, Way};
use crate::scene::surface::Surface;
use crate::solve::media::Leg;
use crate::solve::path::{Arrival, Counters, Vertex};
use crate::solve::warp;
use crate::trace::{Hit, Place, Ray};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Smallest cosine at the emitter; only keeps a quotient finite.
const SMALLEST_COSINE: f32 = 1e-3;
/// Cosine between the normals of a point and of one on its own plane.
const SAME_PLANE: f32 = 0.866;
/// Height above the plane from which its points are looked for, in units of the walls' size.
const PLANE_HEIGHT: f32 = 0.025;
/// Mean distances at which points of an own plane are drawn besides the mean free path of the air at hand, in units of the
/// walls' size: near ones count in thicker air. With the shares of all four.
const SPANS: [f32; 3] = [0.5, 0.5 / 8.0, 0.5 / 64.0];
const SHARES: [f32; 4] = [0.6, 0.2, 0.1, 0.1];
/// Most of the mean free path that counts as a mean distance, in units of the scene's size: at night bright ground far away is
/// what lights dark ground.
const FAR: f32 = 0.25;

/// A direction drawn at a vertex, half by cosine and half uniformly, and what lies there.
pub(super) struct Ahead {
    pub leg: Leg,
    pub pdf: f32,
    /// Cosine at the vertex.
    pub cos: f32,
    pub arrival: Arrival,
}

/// A point of the plane on which a vertex lies: scattered light of it comes back.
pub(super) struct Beside {
    pub leg: Leg,
    /// Inverse density per area, m².
    weight: f32,
    hit: Hit,
    place: Place,
}

impl View<'_, '_> {
    /// Draws a direction and looks there.
    pub(super) fn look(&self, vertex: &Vertex, [u, v, crossing]: [f32; 3], counters: &Counters) -> Option<Ahead> {
        let (dir, pdf) = self.paths.first_direction(vertex, u, v);
        let cos = dir.dot(vertex.normal_shading);
        if cos <= 0.0 || dir.dot(vertex.normal_geom) <= 0.0 {
            return None;
        }
        let arrival = self.paths.travel(vertex.origin, dir, crossing, counters);
        let leg = Leg { origin: vertex.origin, dir, length: arrival.distance };
        Some(Ahead { leg, pdf, cos, arrival })
    }

    /// Draws a point of the vertex's own plane: any angle, the distance by a mean of exponentials.
    pub(super) fn beside(&self, vertex: &Vertex, [u, v]: [f32; 2], counters: &Counters) -> Option<Beside> {
        let [wide, middle, narrow] = SPANS.map(|span| span * self.wall);
        let spans = [self.free_path(vertex.origin).min(FAR * self.extent), wide, middle, narrow];
        let mut rest = u;
        let chosen = SHARES.iter().position(|share| {
            rest -= share;
            rest < 0.0
        });
        let chosen = chosen.unwrap_or(SHARES.len() - 1);
        let rho = -spans[chosen] * (-(1.0 + rest / SHARES[chosen]).clamp(0.0, 1.0 - f32::EPSILON)).ln_1p();
        let (sin, cos) = (TAU * v).sin_cos();
        let normal = vertex.normal_geom;
        let aside = warp::about(normal, Vec3::new(cos, sin, 0.0));
        let height = PLANE_HEIGHT * self.wall;
        let origin = vertex.origin + rho * aside + height * normal;
        counters.rays.set(counters.rays.get() + 1);
        let hit = self.paths.tracer.closest_hit(&Ray { origin, dir: -normal, t_max: 2.0 * height })?;
        let place = self.paths.tracer.place(hit.instance, hit.triangle, hit.barycentric);
        let cos = place.normal_geom.dot(normal) * if hit.back_face { -1.0 } else { 1.0 };
        let is_dark = hit.back_face && !self.paths.tracer.scene().material_at(hit.instance, hit.triangle).double_sided;
        if cos < SAME_PLANE || is_dark {
            return None;
        }
        let way = place.point.position - vertex.origin;
        let leg = Leg { origin: vertex.origin, dir: way.try_normalize()?, length: way.length() };
        let pdf: f32 = spans.iter().zip(SHARES).map(|(span, share)| share * (-rho / span).exp() / span).sum();
        let weight = TAU * rho / (pdf * cos);
        weight.is_finite().then_some(Beside { leg, weight, hit, place })
    }

    /// The mean free path at a point, metres.
    fn free_path(&self, point: Vec3) -> f32 {
        let sigma_t = self.paths.media.set().sigma_t(point.as_dvec3());
        1.0 / sigma_t.into_iter().fold(0.0, f64::max).max(f64::from(f32::MIN_POSITIVE)) as f32
    }
}

impl Ahead {
    /// The way to the surface ahead, which is not asked what it reflects.
    pub fn step(&self) -> Option<Step> {
        let (_, place, _) = self.arrival.hit.as_ref()?;
        let cos = place.normal_geom.dot(self.leg.dir);
        let weight = self.leg.length * self.leg.length / (cos.abs().max(SMALLEST_COSINE) * self.pdf);
        Some(Step { way: Way::Ahead, weight, axis: place.normal_geom * -cos.signum(), reflect: self.arrival.passed })
    }

    /// On to the surface ahead, and the vertex there.
    pub fn onward(&self, view: &View, lobe: f32) -> Option<(Step, Vertex, Vec3)> {
        let (hit, place, surface) = self.arrival.hit.as_ref()?;
        let (vertex, albedo) = view.paths.scatter(hit, place, surface, lobe)?;
        let step = self.step()?;
        Some((Step { reflect: step.reflect * albedo / PI, ..step }, vertex, albedo))
    }
}

impl Beside {
    /// The way there; the surface is not asked what it reflects.
    pub fn step(&self) -> Step {
        let Leg { dir, length, .. } = self.leg;
        let axis = self.place.normal_geom * if self.hit.back_face { -1.0 } else { 1.0 };
        Step { way: Way::Beside { dir, length }, weight: self.weight, axis, reflect: Vec3::ONE }
    }

    /// On to the point beside, and the vertex there.
    pub fn onward(&self, view: &View, lobe: f32) -> Option<(Step, Vertex, Vec3)> {
        let surface =
            Surface::at(view.paths.tracer.scene(), self.hit.instance, self.hit.triangle, self.hit.barycentric);
        let (vertex, albedo) = view.paths.scatter(&self.hit, &self.place, &surface, lobe)?;
        Some((Step { reflect: albedo / PI, ..self.step() }, vertex, albedo))
    }
}
