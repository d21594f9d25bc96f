//! One look from a surface point into the scene: what lies ahead, and with which weights its radiance arrives, through
//! the air (attenuated) and by way of it (scattered).

use super::View;
use super::responses::{Lobe, ORDERS, Responses, Sight};
use crate::scene::surface::Surface;
use crate::solve::media::Leg;
use crate::solve::path::{Arrival, Counters, Vertex};
use crate::solve::warp;
use crate::trace::{Hit, Place, Ray};
use ::tables::Geometry;
use glam::Vec3;
use std::f32::consts::TAU;

/// Smallest cosine at the emitter; only keeps a quotient finite.
const SMALLEST_COSINE: f32 = 1e-3;
/// Cosine between the normals of a point and of one on its own plane.
const SAME_PLANE: f32 = 0.866;
/// Height above the plane from which its points are looked for, in units of their distance's mean.
const PLANE_HEIGHT: f32 = 0.05;

/// A direction drawn at a vertex, half by cosine and half uniformly, and what lies there.
pub(super) struct Ahead {
    pub dir: Vec3,
    pub pdf: f32,
    /// Cosine at the vertex.
    pub cos: f32,
    pub leg: Leg,
    /// Optical depth of the leg.
    pub depth: Vec3,
    pub arrival: Arrival,
}

/// A point of the plane on which a vertex lies: scattered light of it comes back.
pub(super) struct Beside {
    pub hit: Hit,
    pub place: Place,
    leg: Leg,
    depth: Vec3,
    /// Inverse density per area, m².
    weight: f32,
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
        let depth = self.paths.media.depth(&leg);
        Some(Ahead { dir, pdf, cos, leg, depth, arrival })
    }

    /// Draws a point of the vertex's own plane: distance with density `lambda e^(−lambda rho)`, any angle.
    pub(super) fn beside(&self, vertex: &Vertex, [u, v]: [f32; 2], counters: &Counters) -> Option<Beside> {
        let span = self.span(vertex.origin);
        let rho = -span * (-u).ln_1p();
        let (sin, cos) = (TAU * v).sin_cos();
        let normal = vertex.normal_geom;
        let aside = warp::about(normal, Vec3::new(cos, sin, 0.0));
        let height = PLANE_HEIGHT * span;
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
        let length = way.length();
        let leg = Leg { origin: vertex.origin, dir: way.try_normalize()?, length };
        let weight = TAU * rho * span * (rho / span).exp() / cos;
        Some(Beside { hit, place, depth: self.paths.media.depth(&leg), leg, weight })
    }

    /// Mean distance at which points of an own plane are drawn: the mean free path, or half of the walls' size.
    fn span(&self, point: Vec3) -> f32 {
        let sigma_t = self.paths.media.set().sigma_t(point.as_dvec3());
        let sigma_t = sigma_t.into_iter().fold(0.0, f64::max) as f32;
        1.0 / sigma_t.max(2.0 / self.wall)
    }
}

impl Ahead {
    /// Share of light that passes the leg and the surfaces on it.
    pub fn passed(&self) -> Vec3 {
        self.arrival.passed * self.depth.map(|d| (-d).exp())
    }

    /// The surface element that was hit as an emitter, and the inverse density per area: `s²/(c p)`.
    pub fn element(&self, vertex: &Vertex) -> Option<(Sight<'_>, f32)> {
        let (_, place, _) = self.arrival.hit.as_ref()?;
        let cos = -place.normal_geom.dot(self.dir);
        let axis = place.normal_geom * cos.signum();
        let geometry = Geometry::new(vertex.normal_shading, self.dir, axis);
        let weight = self.leg.length * self.leg.length / (cos.abs().max(SMALLEST_COSINE) * self.pdf);
        Some((Sight { leg: &self.leg, depth: self.depth, geometry }, weight))
    }

    /// Weights of the radiance that leaves the surface ahead, scattered; not normalised.
    pub fn scattered(&self, vertex: &Vertex, responses: &Responses) -> Lobe {
        self.element(vertex)
            .map_or([Vec3::ZERO; 2], |(sight, weight)| responses.area(&sight).map(|r| weight * r * self.arrival.passed))
    }
}

impl Beside {
    fn sight(&self, vertex: &Vertex) -> Sight<'_> {
        let axis = self.place.normal_geom * if self.hit.back_face { -1.0 } else { 1.0 };
        Sight { leg: &self.leg, depth: self.depth, geometry: Geometry::new(vertex.normal_shading, self.leg.dir, axis) }
    }

    /// Weights of the radiance that leaves the point beside; not normalised.
    pub fn scattered(&self, vertex: &Vertex, responses: &Responses) -> Lobe {
        responses.area(&self.sight(vertex)).map(|r| self.weight * r)
    }

    /// The same for all sums.
    pub fn scattered_of_all(&self, vertex: &Vertex, responses: &Responses) -> [Vec3; 1 + ORDERS.len()] {
        responses.area_of_all(&self.sight(vertex)).map(|r| self.weight * r)
    }

    /// The surface there.
    pub fn surface(&self, scene: &crate::scene::Scene) -> Surface {
        Surface::at(scene, self.hit.instance, self.hit.triangle, self.hit.barycentric)
    }
}
