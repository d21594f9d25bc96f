//! A triangle seen from a point, drawn uniformly over its solid angle: light from near surfaces then has bounded weights,
//! where points drawn over the area meet cos/r². Source: Arvo 1995, "Stratified Sampling of Spherical Triangles"; solid
//! angle after Van Oosterom and Strackee 1983. In double precision, as thin triangles need.

use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;

/// Solid angles, sr, for which it pays and keeps its digits; smaller ones are as well drawn by area.
const WORTHWHILE: std::ops::Range<f64> = 1e-3..6.2;

/// A triangle around a point.
#[derive(Debug, Clone, Copy)]
pub struct SphericalTriangle {
    origin: DVec3,
    vertices: [DVec3; 3],
    /// Unit vectors towards the vertices.
    towards: [DVec3; 3],
    /// Their triple product's magnitude.
    volume: f64,
    /// Solid angle, sr.
    pub solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle as seen from `origin`, where that is worth while.
    pub fn new(origin: Vec3, vertices: [Vec3; 3]) -> Option<Self> {
        let (origin, vertices) = (origin.as_dvec3(), vertices.map(Vec3::as_dvec3));
        let [a, b, c] = vertices;
        let (a, b, c) =
            ((a - origin).normalize_or_zero(), (b - origin).normalize_or_zero(), (c - origin).normalize_or_zero());
        let volume = a.dot(b.cross(c)).abs();
        let solid_angle = 2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let towards = [a, b, c];
        WORTHWHILE.contains(&solid_angle).then_some(Self { origin, vertices, towards, volume, solid_angle })
    }

    /// Weights of the second and third vertex of the point met in a direction drawn uniformly.
    pub fn sample(&self, u: f32, v: f32) -> Option<Vec2> {
        let [a, b, c] = self.towards;
        // The angle at a is that between the normals of the planes of ab and ca: (a × b) × (c × a) = a (a · b × c).
        let (across_ab, across_ca) = (a.cross(b), c.cross(a));
        let (sin2_ab, sin2_ca) = (across_ab.length_squared(), across_ca.length_squared());
        let over_sines = 1.0 / (sin2_ab * sin2_ca).sqrt();
        if !over_sines.is_finite() {
            return None;
        }
        let (cos_alpha, sin_alpha) = (-across_ab.dot(across_ca) * over_sines, self.volume * over_sines);
        // The part of the area left of the arc from b through the drawn point on ac; π more, as the angles' sum has it.
        let (sin_s, cos_s) = (PI + f64::from(u) * self.solid_angle).sin_cos();
        let sin_phi = sin_s * cos_alpha - cos_s * sin_alpha;
        let cos_phi = cos_s * cos_alpha + sin_s * sin_alpha;
        let k1 = cos_phi + cos_alpha;
        let k2 = sin_phi - sin_alpha * a.dot(b);
        let cos_arc = ((k2 + (k2 * cos_phi - k1 * sin_phi) * cos_alpha) / ((k2 * sin_phi + k1 * cos_phi) * sin_alpha))
            .clamp(-1.0, 1.0);
        let on_ac = turned(a, c, cos_arc)?;
        let dir = turned(b, on_ac, 1.0 - f64::from(v) * (1.0 - on_ac.dot(b)))?;
        self.met(dir)
    }

    /// Where a ray from the origin meets the triangle's plane, held to the triangle.
    fn met(&self, dir: DVec3) -> Option<Vec2> {
        let [a, b, c] = self.vertices;
        let (ab, ac, from_a) = (b - a, c - a, self.origin - a);
        let p = dir.cross(ac);
        let over_determinant = 1.0 / ab.dot(p);
        let (second, third) = (from_a.dot(p) * over_determinant, dir.dot(from_a.cross(ab)) * over_determinant);
        if !(second.is_finite() && third.is_finite()) {
            return None;
        }
        let (second, third) = (second.clamp(0.0, 1.0), third.clamp(0.0, 1.0));
        let excess = (second + third).max(1.0);
        Some(Vec2::new((second / excess) as f32, (third / excess) as f32))
    }
}

/// The unit vector at an angle from `from` on the arc towards `to`.
fn turned(from: DVec3, to: DVec3, cos: f64) -> Option<DVec3> {
    let across = (to - from * to.dot(from)).normalize_or_zero();
    let dir = from * cos + across * (1.0 - cos * cos).max(0.0).sqrt();
    (dir != DVec3::ZERO).then_some(dir)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangle with a right angle at the pole and legs of 90° covers an eighth of the sphere.
    fn octant() -> SphericalTriangle {
        SphericalTriangle::new(Vec3::ZERO, [Vec3::X, Vec3::Y, Vec3::Z]).unwrap()
    }

    fn point(triangle: &SphericalTriangle, weights: Vec2) -> DVec3 {
        let [a, b, c] = triangle.vertices;
        let (second, third) = (f64::from(weights.x), f64::from(weights.y));
        a * (1.0 - second - third) + b * second + c * third - triangle.origin
    }

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere_and_is_drawn_evenly() {
        let triangle = octant();
        assert!((triangle.solid_angle - 0.5 * PI).abs() < 1e-12);
        // Mean direction of a uniform octant: 1/2 along each axis. Drawn by area its middle would weigh more.
        let n = 256;
        let at = |i: u32| (i as f32 + 0.5) / n as f32;
        let mean = |sample: &dyn Fn(f32, f32) -> Vec2| {
            let dirs = (0..n * n).map(|i| point(&triangle, sample(at(i % n), at(i / n))).normalize());
            dirs.sum::<DVec3>() / f64::from(n * n)
        };
        let even = mean(&|u, v| triangle.sample(u, v).unwrap());
        let by_area = mean(&|u, v| crate::solve::warp::triangle(u, v));
        println!("mean {even}, by area {by_area}");
        assert!((even - DVec3::splat(0.5)).abs().max_element() < 1e-4);
        assert!((by_area - DVec3::splat(0.5)).abs().max_element() > 1e-2);
    }

    #[test]
    fn slivers_and_grazing_views_stay_in_the_triangle() {
        let corner = Vec3::new(0.0, 0.0, 1e-3);
        for vertices in [
            [corner, corner + Vec3::X, corner + Vec3::new(1.0, 1e-3, 0.0)],
            [corner - Vec3::X, corner + Vec3::X, corner + Vec3::Y * 5.0],
            [corner, corner + Vec3::X * 1e3, corner + Vec3::Y * 1e3],
        ] {
            let Some(triangle) = SphericalTriangle::new(Vec3::ZERO, vertices) else { continue };
            for i in 0..1000 {
                let weights = triangle.sample((i as f32 * 0.618_034).fract(), (i as f32 + 0.5) / 1000.0).unwrap();
                assert!(weights.min_element() >= 0.0 && weights.element_sum() <= 1.0 + 1e-6, "{weights}");
            }
        }
        assert!(SphericalTriangle::new(Vec3::ZERO, [Vec3::X, Vec3::X, Vec3::Y]).is_none(), "no area");
    }
}
