//! The sphere unfolded into a square (Meyer et al. 2010, "On floating-point normal vectors"): +z in the middle, −z in the corners.

use glam::{Vec2, Vec3};

/// Place in [−1, 1]² of a direction, which need not be of unit length.
#[cfg(any(test, feature = "media"))]
pub fn fold(dir: Vec3) -> Vec2 {
    let p = Vec2::new(dir.x, dir.y) / dir.abs().element_sum().max(f32::MIN_POSITIVE);
    if dir.z >= 0.0 { p } else { mirrored(p) }
}

/// Unit direction of a place.
#[inline]
pub fn unfold(p: Vec2) -> Vec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let p = if z >= 0.0 { p } else { mirrored(p) };
    Vec3::new(p.x, p.y, z).normalize()
}

/// Across the nearest edge of the diamond that the upper half fills.
fn mirrored(p: Vec2) -> Vec2 {
    (1.0 - Vec2::new(p.y, p.x).abs()) * Vec2::new(1f32.copysign(p.x), 1f32.copysign(p.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::warp;

    #[test]
    fn directions_come_back() {
        for i in 0..1000 {
            let dir = warp::uniform_sphere((i as f32 + 0.5) / 1000.0, (i as f32 * 0.618_034).fract());
            let place = fold(dir);
            assert!(place.abs().max_element() <= 1.0 && unfold(place).distance(dir) < 1e-6, "{dir}");
            assert!(unfold(place + 1e-3).distance(dir) > 1e-4, "another place is another direction");
        }
    }
}
