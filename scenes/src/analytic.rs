//! Closed forms of irradiance in vacuum, per linear RGB channel: lux from cd, lux and cd/m².
//!
//! Points and directions are in metres and world axes; normals are unit vectors. Surfaces are Lambertian.

use glam::DVec3;
use std::f64::consts::PI;

/// Irradiance at a point from a point light of the given intensity (cd): E = I cosθ/d² (Lambert 1760).
pub fn point_light(intensity: DVec3, light: DVec3, point: DVec3, normal: DVec3) -> DVec3 {
    let to_light = light - point;
    intensity * (to_light.dot(normal) / to_light.length().powi(3)).max(0.0)
}

/// Irradiance from the sun: E = lux · cosθ.
///
/// Exact for a sun of any angular diameter that is wholly above the surface's horizon: the mean of a disk's
/// directions, weighted by the disk's own projected solid angle, is its centre.
pub fn sun(lux: DVec3, to_sun: DVec3, normal: DVec3) -> DVec3 {
    lux * to_sun.dot(normal).max(0.0)
}

/// Share of a point's cosine-weighted hemisphere that a polygon covers, 0..1; zero where the point sees its back.
///
/// Corners are counter-clockwise seen from the polygon's front. With unit vectors v_i to the corners of the polygon cut
/// off at the horizon, F = 1/(2π) Σ angle(v_i, v_{i+1}) · n·(v_{i+1} × v_i)/|v_{i+1} × v_i| (Lambert 1760; Baum,
/// Rushmeier, Winget 1989, eq. 6).
pub fn form_factor(corners: &[DVec3], point: DVec3, normal: DVec3) -> f64 {
    let above = clip_to_horizon(corners.iter().map(|corner| *corner - point).collect(), normal);
    let edges = (0..above.len()).map(|i| (above[i], above[(i + 1) % above.len()]));
    let sum: f64 = edges.map(|(a, b)| a.angle_between(b) * normal.dot(b.cross(a).normalize_or_zero())).sum();
    (sum / (2.0 * PI)).max(0.0)
}

/// The part of a polygon above the plane through the origin (Sutherland, Hodgman 1974).
fn clip_to_horizon(corners: Vec<DVec3>, normal: DVec3) -> Vec<DVec3> {
    let mut above = Vec::with_capacity(corners.len() + 1);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (height_a, height_b) = (a.dot(normal), b.dot(normal));
        if height_a >= 0.0 {
            above.push(a);
        }
        if (height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0) {
            above.push(a.lerp(b, height_a / (height_a - height_b)));
        }
    }
    above
}

/// Σ ratio^i for i = 0..=bounces, or to infinity: what `bounces` reflections make of direct light where each
/// reflection returns the same share. 0 bounces is direct light alone. Ratios lie in [0, 1).
pub fn bounce_sum(ratio: DVec3, bounces: Option<i32>) -> DVec3 {
    let last = bounces.map_or(DVec3::ZERO, |bounces| DVec3::from_array(ratio.to_array().map(|r| r.powi(bounces + 1))));
    (1.0 - last) / (1.0 - ratio)
}

/// Mean irradiance over the walls of a closed room of one albedo whose lights give the walls `flux` (lm).
///
/// Whatever leaves a wall arrives at a wall, so each reflection carries the share ρ of the flux before it:
/// mean E = Φ/A · Σ ρ^i. Exact for every shape.
pub fn closed_room_mean(flux: DVec3, area: f64, albedo: DVec3, bounces: Option<i32>) -> DVec3 {
    flux / area * bounce_sum(albedo, bounces)
}

/// Irradiance of the outer of two concentric spheres from the inner, a black emitter of radiance L (cd/m²).
///
/// With f = (r/R)², the outer sphere sees the inner with form factor f and itself with 1 − f (reciprocity), so
/// E = πL f Σ (ρ (1 − f))^i. The inner sphere sees nothing but the outer: its irradiance is ρ E of one bounce less.
pub fn concentric_spheres(radiance: DVec3, radius_ratio: f64, albedo: DVec3, bounces: Option<i32>) -> DVec3 {
    let f = radius_ratio * radius_ratio;
    PI * radiance * f * bounce_sum(albedo * (1.0 - f), bounces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    const SQUARE: [DVec3; 4] =
        [DVec3::new(0.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.7), DVec3::new(0.0, 1.0, 0.7)];

    /// Midpoint rule for F = 1/π ∫ cosθ cosθ' V / d² dA over a parallelogram.
    fn form_factor_by_quadrature(corners: &[DVec3; 4], point: DVec3, normal: DVec3, n: usize) -> f64 {
        let (u, v) = (corners[1] - corners[0], corners[3] - corners[0]);
        let area_vector = u.cross(v) / (n * n) as f64;
        let cell = |i: usize| {
            let (s, t) = ((i % n) as f64 + 0.5, (i / n) as f64 + 0.5);
            let d = corners[0] + u * (s / n as f64) + v * (t / n as f64) - point;
            d.dot(normal).max(0.0) * (-d).dot(area_vector).max(0.0) / (PI * d.length().powi(4))
        };
        (0..n * n).map(cell).sum()
    }

    #[test]
    fn form_factor_agrees_with_quadrature() {
        // The midpoint rule's error falls with the cell's size squared, where the horizon cuts only with its size.
        let mut worst = Worst::new("form factor of a parallelogram", 2e-5);
        let (a, b) = (DVec3::new(-0.5, 0.9, -0.4), DVec3::new(0.6, 1.3, -0.4));
        let tilted = [a, b, b + DVec3::Z, a + DVec3::Z];
        for corners in [SQUARE, tilted] {
            for i in 0..40 {
                let t = f64::from(i) / 40.0;
                let point = DVec3::new(2.0 * t - 1.0, 0.4 * t, 1.0 - 2.0 * t);
                let normal = DVec3::new((7.0 * t).sin(), 0.6 + t, (5.0 * t).cos()).normalize();
                let expected = form_factor_by_quadrature(&corners, point, normal, 600);
                worst.record((form_factor(&corners, point, normal) - expected).abs(), || format!("{point}"));
            }
        }
        worst.check();
    }

    #[test]
    fn form_factor_of_a_parallel_rectangle_over_its_corner() {
        // F = 1/(2π) [x/√(1+x²) atan(y/√(1+x²)) + y/√(1+y²) atan(x/√(1+y²))], x, y = sides over distance
        // (Howell, catalog of configuration factors, B-3).
        let (x, y) = (1.0f64, 0.7f64);
        let half = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
        let expected = (half(x, y) + half(y, x)) / (2.0 * PI);
        assert!((form_factor(&SQUARE, DVec3::ZERO, DVec3::Y) - expected).abs() < 1e-14);
    }

    #[test]
    fn the_form_factors_of_a_rooms_walls_sum_to_one() {
        // The corners of a block's faces in reverse order face inward.
        let faces = crate::build::cuboid(DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0), Default::default());
        let walls = faces.map(|face| face.vertices.iter().rev().map(|v| v.position).collect::<Vec<_>>());
        for (point, normal) in [(DVec3::new(0.3, 0.0, 0.8), DVec3::Y), (DVec3::new(1.0, 1.2, 0.4), DVec3::ONE)] {
            let sum: f64 = walls.iter().map(|wall| form_factor(wall, point, normal.normalize())).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        }
    }

    #[test]
    fn a_polygons_back_is_not_seen() {
        let back: Vec<DVec3> = SQUARE.into_iter().rev().collect();
        assert_eq!(form_factor(&back, DVec3::ZERO, DVec3::Y), 0.0);
    }

    #[test]
    fn bounce_sums_are_partial_sums_of_the_series() {
        let ratio = DVec3::new(0.0, 0.5, 0.9);
        assert_eq!(bounce_sum(ratio, Some(0)), DVec3::ONE);
        assert!((bounce_sum(ratio, Some(2)) - DVec3::new(1.0, 1.75, 2.71)).length() < 1e-14);
        assert!((bounce_sum(ratio, None) - DVec3::new(1.0, 2.0, 10.0)).length() < 1e-14);
    }

    #[test]
    fn concentric_spheres_agree_with_a_quadrature_over_the_inner() {
        // Irradiance of an outer point from the inner sphere's visible cap, ring by ring.
        let (r, n) = (0.4f64, 20_000);
        let ring = |i: usize| {
            let cos_edge = r;
            let c = cos_edge + (1.0 - cos_edge) * (i as f64 + 0.5) / n as f64;
            let d_squared = 1.0 + r * r - 2.0 * r * c;
            let (cos_emitter, cos_receiver) = ((c - r) / d_squared.sqrt(), (1.0 - r * c) / d_squared.sqrt());
            2.0 * PI * r * r * (1.0 - cos_edge) / n as f64 * cos_emitter * cos_receiver / d_squared
        };
        let expected: f64 = (0..n).map(ring).sum();
        let direct = concentric_spheres(DVec3::ONE, r, DVec3::splat(0.5), Some(0)).x;
        assert!((direct - expected).abs() < 1e-8, "{direct} against {expected}");
    }
}
