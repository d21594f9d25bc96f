//! From the unit square to directions and points.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// The unit disk, area-preserving. Source: Shirley and Chiu 1997.
pub fn concentric_disk(u: f32, v: f32) -> Vec2 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return Vec2::ZERO;
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, FRAC_PI_2 - FRAC_PI_4 * (a / b)) };
    radius * Vec2::from_angle(angle)
}

/// A direction about +z with density cos θ/π.
pub fn cosine_hemisphere(u: f32, v: f32) -> Vec3 {
    let d = concentric_disk(u, v);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// A direction about +z with density 1/2π.
pub fn uniform_hemisphere(u: f32, v: f32) -> Vec3 {
    let sin = (1.0 - u * u).max(0.0).sqrt();
    Vec3::new(sin * (TAU * v).cos(), sin * (TAU * v).sin(), u)
}

/// A direction with density 1/4π.
pub fn uniform_sphere(u: f32, v: f32) -> Vec3 {
    let z = 1.0 - 2.0 * u;
    let sin = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(sin * (TAU * v).cos(), sin * (TAU * v).sin(), z)
}

/// Weights of a triangle's second and third vertex, uniform over its area.
pub fn triangle(u: f32, v: f32) -> Vec2 {
    let root = u.sqrt();
    Vec2::new(root * (1.0 - v), root * v)
}

/// A direction within `angle` of +z, uniform in solid angle; `1 − cos` is formed without cancellation.
pub fn cone(u: f32, v: f32, angle: f32) -> Vec3 {
    let drop = u * 2.0 * (0.5 * angle).sin().powi(2);
    let sin = (drop * (2.0 - drop)).max(0.0).sqrt();
    Vec3::new(sin * (TAU * v).cos(), sin * (TAU * v).sin(), 1.0 - drop)
}

/// Density per solid angle of [`cosine_hemisphere`].
pub fn cosine_pdf(cos: f32) -> f32 {
    cos.max(0.0) / PI
}

/// Turns a direction about +z into one about the unit vector `axis`.
pub fn about(axis: Vec3, local: Vec3) -> Vec3 {
    let (x, y) = axis.any_orthonormal_pair();
    local.x * x + local.y * y + local.z * axis
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule over the unit square.
    fn mean(f: impl Fn(f32, f32) -> f64) -> f64 {
        const N: u32 = 256;
        let at = |i: u32| (i as f32 + 0.5) / N as f32;
        (0..N * N).map(|i| f(at(i % N), at(i / N))).sum::<f64>() / f64::from(N * N)
    }

    #[test]
    fn moments_of_the_densities() {
        let z = |f: fn(f32, f32) -> Vec3| mean(move |u, v| f64::from(f(u, v).z));
        let z2 = |f: fn(f32, f32) -> Vec3| mean(move |u, v| f64::from(f(u, v).z).powi(2));
        for (name, got, want) in [
            ("cosine z", z(cosine_hemisphere), 2.0 / 3.0),
            ("cosine z²", z2(cosine_hemisphere), 0.5),
            ("hemisphere z", z(uniform_hemisphere), 0.5),
            ("hemisphere z²", z2(uniform_hemisphere), 1.0 / 3.0),
            ("sphere z", z(uniform_sphere), 0.0),
            ("sphere z²", z2(uniform_sphere), 1.0 / 3.0),
            ("cone z", z(|u, v| cone(u, v, 0.5)), (1.0 + 0.5f64.cos()) / 2.0),
        ] {
            // the midpoint rule errs by n^-1.5 at the rim of the disk, where z has an infinite slope
            assert!((got - want).abs() < 2.5e-4, "{name}: {got} against {want}");
        }
    }

    #[test]
    fn directions_are_unit_and_a_narrow_cone_keeps_its_digits() {
        for (u, v) in [(0.0, 0.0), (0.5, 0.5), (0.999_999, 0.25), (0.25, 0.999_999)] {
            for dir in [cosine_hemisphere(u, v), uniform_hemisphere(u, v), uniform_sphere(u, v), cone(u, v, 1e-4)] {
                assert!((dir.length() - 1.0).abs() < 1e-6);
            }
        }
        let edge = cone(0.999_999, 0.0, 1e-4);
        assert!((edge.x / 1e-4 - 1.0).abs() < 1e-3, "{edge}");
    }

    #[test]
    fn about_keeps_angles() {
        for axis in [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::new(1.0, 2.0, -3.0).normalize()] {
            let dir = about(axis, Vec3::new(0.6, 0.0, 0.8));
            assert!((dir.dot(axis) - 0.8).abs() < 1e-6 && (dir.length() - 1.0).abs() < 1e-6);
        }
    }
}
