//! Intensity of point and spot lights, and points on them.

use crate::scene::{Light, LightKind};
use crate::solve::warp::concentric_disk;
use glam::Vec3;

/// Intensity (cd) that leaves a point or spot light along the unit vector `dir` and is to be felt at `distance`.
/// Cone and range follow KHR_lights_punctual; directional lights have none.
pub fn intensity(light: &Light, dir: Vec3, distance: f32) -> Vec3 {
    match &light.kind {
        LightKind::Point { range, profile, .. } => {
            let shape = profile.as_ref().map_or(1.0, |p| p.relative_towards(dir));
            light.color * shape * window(*range, distance)
        }
        LightKind::Spot { direction, cos_inner, cos_outer, range, profile, .. } => {
            let shape = match profile {
                Some(profile) => profile.relative_towards(dir),
                None => cone(direction.dot(dir), *cos_inner, *cos_outer),
            };
            light.color * shape * window(*range, distance)
        }
        LightKind::Directional { .. } => Vec3::ZERO,
    }
}

/// KHR_lights_punctual: saturate((cos θ − cos outer)/max(0.001, cos inner − cos outer))².
fn cone(cos: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    ((cos - cos_outer) / (cos_inner - cos_outer).max(0.001)).clamp(0.0, 1.0).powi(2)
}

/// KHR_lights_punctual: max(min(1 − (d/range)⁴, 1), 0).
fn window(range: Option<f32>, distance: f32) -> f32 {
    range.map_or(1.0, |range| (1.0 - (distance / range).powi(4)).clamp(0.0, 1.0))
}

/// Position and radius (m) of a point or spot light.
pub fn ball(light: &Light) -> Option<(Vec3, f32)> {
    match light.kind {
        LightKind::Point { position, radius, .. } | LightKind::Spot { position, radius, .. } => {
            Some((position, radius))
        }
        LightKind::Directional { .. } => None,
    }
}

/// A point of the ball's disk that faces the receiver, and the intensity towards it over the squared distance (lux
/// on a surface perpendicular to the way). The distance is never taken below the radius.
pub fn sample(light: &Light, receiver: Vec3, u: f32, v: f32) -> Option<(Vec3, Vec3)> {
    let (centre, radius) = ball(light)?;
    let away = receiver - centre;
    let distance = away.length().max(radius);
    let axis = away.try_normalize()?;
    let disk = concentric_disk(u, v) * radius;
    let (x, y) = axis.any_orthonormal_pair();
    let target = centre + disk.x * x + disk.y * y;
    Some((target, intensity(light, axis, distance) / (distance * distance)))
}
