//! Which surface points of a texel light can be gathered from.
//!
//! A point most of whose rays meet back faces lies inside other geometry; a point that does not see the texel's middle
//! one lies on the other side of a wall. Neither is used, so that no light passes through closed walls, and
//! a texel without any good point is buried.

use super::path::Vertex;
use super::sampler::hash;
use super::warp;
use crate::atlas::{Page, SurfacePoint, Texel};
use crate::trace::{Hit, Ray, Tracer};
use glam::{Vec2, Vec3};

/// Rays per surface point.
const RAYS: u32 = 16;
/// Share of rays that must meet a back face for a point to be buried.
const BURIED_SHARE: f32 = 0.5;

/// A usable point: where paths start, and the cumulative share of samples up to it.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// Where the path starts.
    pub vertex: Vertex,
    /// Shares of this and all points before it; the last is 1.
    pub cumulative: f32,
}

/// The usable points of a texel; empty when it is buried.
pub fn starts(tracer: &Tracer, page: &Page, texel: &Texel) -> Vec<Start> {
    let seed = hash(u32::from(texel.x), u32::from(texel.y));
    let points = page.points_of(texel).iter().enumerate();
    let mut good: Vec<(Vertex, f32)> = points
        .map(|(index, point)| (index as u32, vertex_at(tracer, point), point.weight))
        .filter(|(index, vertex, _)| !is_buried(tracer, vertex, hash(seed, *index)))
        .map(|(_, vertex, weight)| (vertex, weight))
        .collect();
    if let Some(middle) = middle(&good) {
        good.retain(|(vertex, _)| sees(tracer, &middle, vertex));
    }
    let total: f32 = good.iter().map(|(_, weight)| weight).sum();
    let mut sum = 0.0;
    good.iter()
        .map(|&(vertex, weight)| {
            sum += weight;
            Start { vertex, cumulative: sum / total }
        })
        .collect()
}

/// The point nearest to the mean of all.
fn middle(points: &[(Vertex, f32)]) -> Option<Vertex> {
    let total: f32 = points.iter().map(|(_, weight)| weight).sum();
    let mean = points.iter().map(|(vertex, weight)| vertex.origin * *weight).sum::<Vec3>() / total;
    let distance = |vertex: &Vertex| vertex.origin.distance_squared(mean);
    points.iter().map(|(vertex, _)| *vertex).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Index of the start that a number in [0, 1) falls on.
pub fn pick(starts: &[Start], u: f32) -> usize {
    starts.partition_point(|start| start.cumulative <= u).min(starts.len() - 1)
}

fn vertex_at(tracer: &Tracer, point: &SurfacePoint) -> Vertex {
    let SurfacePoint { instance, triangle, barycentric, .. } = *point;
    let place = tracer.place(instance, triangle, barycentric);
    Vertex::on(tracer, (instance, triangle, barycentric), &place, 1.0)
}

/// Whether the way between two points of a texel is free. Points are lifted by a share of their distance, so that
/// the texel's own curvature does not stand between them.
fn sees(tracer: &Tracer, a: &Vertex, b: &Vertex) -> bool {
    let lift = 0.25 * a.origin.distance(b.origin);
    let (from, to) = (a.origin + lift * a.normal_geom, b.origin + lift * b.normal_geom);
    let free = |origin: Vec3, end: Vec3| {
        let dir = end - origin;
        dir == Vec3::ZERO || tracer.transmittance(&Ray { origin, dir, t_max: 1.0 }) != Vec3::ZERO
    };
    free(a.origin, from) && free(from, to) && free(to, b.origin)
}

/// Whether most rays from a point meet the back of single-sided surfaces.
fn is_buried(tracer: &Tracer, vertex: &Vertex, seed: u32) -> bool {
    let turn = hash(seed, 1) as f32 / u32::MAX as f32;
    let backs = (0..RAYS)
        .filter(|&i| {
            let Vec2 { x: u, y: v } = Vec2::new((i as f32 + 0.5) / RAYS as f32, (i as f32 * 0.618_034 + turn).fract());
            let dir = warp::about(vertex.normal_geom, warp::cosine_hemisphere(u, v));
            meets_back(tracer, &Ray { origin: vertex.origin, dir, t_max: f32::INFINITY })
        })
        .count();
    backs as f32 > BURIED_SHARE * RAYS as f32
}

/// Whether a ray meets the back of a single-sided surface.
pub fn meets_back(tracer: &Tracer, ray: &Ray) -> bool {
    tracer.closest_hit(ray).is_some_and(|hit| is_back(tracer, &hit))
}

/// Whether a hit is the back of a single-sided surface.
pub fn is_back(tracer: &Tracer, hit: &Hit) -> bool {
    let material = tracer.scene().material_at(hit.instance, hit.triangle);
    hit.back_face && !material.double_sided && material.transmission == 0.0
}
