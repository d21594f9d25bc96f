//! Intensity of point and spot lights, and points on them.

use crate::scene::{Light, LightKind};
use crate::solve::warp::concentric_disk;
use glam::Vec3;

/// Intensity (cd) that leaves a point or spot light along the unit vector `dir` and is to be felt at `distance`.
/// Cone and range follow KHR_lights_punctual; directional lights have none.
pub fn intensity(light: &Light, dir: Vec3, distance: f32) -> Vec3 {
    light.color * shape(light, dir) * reach(light, distance)
}

/// Intensity along the unit vector `dir` as a share of the light's colour.
pub fn shape(light: &Light, dir: Vec3) -> f32 {
    match &light.kind {
        LightKind::Point { profile: Some(profile), .. } | LightKind::Spot { profile: Some(profile), .. } => {
            profile.relative_towards(dir)
        }
        LightKind::Point { .. } => 1.0,
        LightKind::Spot { direction, cos_inner, cos_outer, .. } => cone(direction.dot(dir), *cos_inner, *cos_outer),
        LightKind::Directional { .. } => 0.0,
    }
}

/// Share of a light that its glTF range leaves at a distance.
pub fn reach(light: &Light, distance: f32) -> f32 {
    match light.kind {
        LightKind::Point { range, .. } | LightKind::Spot { range, .. } => window(range, distance),
        LightKind::Directional { .. } => 0.0,
    }
}

/// Axis about which the light's distribution is taken as symmetric in scattering of higher orders.
pub fn axis(light: &Light) -> Vec3 {
    match &light.kind {
        LightKind::Point { profile: Some(profile), .. } | LightKind::Spot { profile: Some(profile), .. } => {
            profile.axis
        }
        LightKind::Spot { direction, .. } | LightKind::Directional { direction, .. } => *direction,
        LightKind::Point { .. } => Vec3::Y,
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
