//! Records of lights; measured distributions shrink to Legendre polynomials about their axis.

use crate::scene::{Light, LightKind, Profile};
use bake_formats::manifest::{self, LightRecord, ProfileRecord};

/// Polynomials kept of a measured distribution.
const LEGENDRE_COUNT: usize = 17;

/// Gauss–Legendre nodes between two angles of a distribution.
const NODES: usize = 8;

/// The lights as manifest and baked scene hold them.
pub(super) fn records(lights: &[Light]) -> Vec<LightRecord> {
    lights.iter().map(record).collect()
}

fn record(light: &Light) -> LightRecord {
    let kind = match light.kind {
        LightKind::Point { position, radius, range, ref profile } => {
            manifest::LightKind::Point { position, radius, range, profile: profile.as_ref().map(reduce) }
        }
        LightKind::Spot { position, direction, cos_inner, cos_outer, radius, range, ref profile } => {
            manifest::LightKind::Spot {
                position,
                direction,
                inner_angle: cos_inner.clamp(-1.0, 1.0).acos(),
                outer_angle: cos_outer.clamp(-1.0, 1.0).acos(),
                radius,
                range,
                profile: profile.as_ref().map(reduce),
            }
        }
        LightKind::Directional { direction, angular_radius } => {
            manifest::LightKind::Directional { direction, angular_radius }
        }
    };
    LightRecord { path: light.path.clone(), color: light.color, kind }
}

/// Mean over the horizontal angle, projected: c_j = (2j+1)/2 ∫ f P_j d cos θ.
fn reduce(profile: &Profile) -> ProfileRecord {
    let mut breaks: Vec<f64> = profile.vertical.iter().rev().map(|angle| f64::from(*angle).cos()).collect();
    breaks.retain(|cosine| cosine.abs() < 1.0 - 1e-9);
    let legendre = bake_optics::legendre::project(LEGENDRE_COUNT, NODES, &breaks, |x: f64| mean_at(profile, x.acos()));
    ProfileRecord { axis: profile.axis, legendre: legendre.into_iter().map(|c| c as f32).collect() }
}

/// Mean of all rows at a vertical angle, linear between angles, zero outside of them.
fn mean_at(profile: &Profile, angle: f64) -> f64 {
    let angles = &profile.vertical;
    let above = angles.partition_point(|&a| f64::from(a) < angle);
    let rows = profile.relative.chunks(angles.len().max(1));
    let count = rows.len().max(1) as f64;
    let sum_at = |at: usize| rows.clone().filter_map(|row| row.get(at)).map(|&v| f64::from(v)).sum::<f64>() / count;
    match above {
        0 if angles.first().is_some_and(|&a| f64::from(a) - angle < 1e-6) => sum_at(0),
        0 => 0.0,
        at if at == angles.len() => 0.0,
        at => {
            let (low, high) = (f64::from(angles[at - 1]), f64::from(angles[at]));
            let t = (angle - low) / (high - low).max(1e-12);
            sum_at(at - 1) * (1.0 - t) + sum_at(at) * t
        }
    }
}
