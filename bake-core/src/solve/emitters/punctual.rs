//! Intensity of point and spot lights, and points on them.

use crate::scene::{Light, LightKind, Profile};
use crate::solve::warp::concentric_disk;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Intensity (cd) that leaves a point or spot light along the unit vector `dir` and is to be felt at `distance`.
/// Cone and range follow KHR_lights_punctual; directional lights have none.
pub fn intensity(light: &Light, dir: Vec3, distance: f32) -> Vec3 {
    match &light.kind {
        LightKind::Point { range, profile, .. } => {
            let shape = profile.as_ref().map_or(1.0, |p| relative(p, dir));
            light.color * shape * window(*range, distance)
        }
        LightKind::Spot { direction, cos_inner, cos_outer, range, profile, .. } => {
            let shape = match profile {
                Some(profile) => relative(profile, dir),
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

/// Relative intensity of a measured profile, bilinear in its angles. Horizontal angles that end at 90° or 180° are
/// mirrored (IES LM-63); vertical angles outside the measured range are dark.
fn relative(profile: &Profile, dir: Vec3) -> f32 {
    let side = profile.axis.cross(profile.horizontal);
    let cos = dir.dot(profile.axis);
    let (x, y) = (dir.dot(profile.horizontal), dir.dot(side));
    let vertical = x.hypot(y).atan2(cos);
    let (low, high) = (profile.vertical[0], profile.vertical[profile.vertical.len() - 1]);
    const SLACK: f32 = 1e-4;
    if vertical < low - SLACK || vertical > high + SLACK {
        return 0.0;
    }
    let last = profile.horizontal_angles[profile.horizontal_angles.len() - 1];
    let horizontal = fold(y.atan2(x).rem_euclid(TAU), last);
    let (row, across) = bracket(&profile.horizontal_angles, horizontal);
    let (column, down) = bracket(&profile.vertical, vertical);
    let (rows, columns) = (profile.horizontal_angles.len(), profile.vertical.len());
    let at = |r: usize, c: usize| profile.relative[r.min(rows - 1) * columns + c.min(columns - 1)];
    let along = |r: usize| at(r, column) + (at(r, column + 1) - at(r, column)) * down;
    along(row) + (along(row + 1) - along(row)) * across
}

/// Brings a horizontal angle into the measured range by its symmetry.
fn fold(angle: f32, last: f32) -> f32 {
    let mirror = |angle: f32| if angle > PI { TAU - angle } else { angle };
    if last < 0.75 * PI {
        let half = mirror(angle);
        if half > 0.5 * PI { PI - half } else { half }
    } else if last < 1.5 * PI {
        mirror(angle)
    } else {
        angle
    }
}

/// The interval of an ascending list that holds `x`, and where in it.
fn bracket(list: &[f32], x: f32) -> (usize, f32) {
    let upper = list.partition_point(|&v| v <= x).min(list.len() - 1);
    let lower = upper.saturating_sub(1);
    let width = list[upper] - list[lower];
    (lower, if width > 0.0 { ((x - list[lower]) / width).clamp(0.0, 1.0) } else { 0.0 })
}
