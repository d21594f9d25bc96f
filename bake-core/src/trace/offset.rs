//! Where a ray may start so that it does not meet the surface it leaves: offsets scaled to the coordinates.
//!
//! The bound on the rounding error of a point follows Pharr, Jakob and Humphreys, "Physically Based Rendering",
//! 3rd edition, 3.9: γₙ = nε/(1 − nε) times the magnitudes that went into it.

use glam::{Affine3A, Vec3};

/// Largest weight that a point is moved away from an edge, for triangles no larger than their coordinates' error.
const MOST_MARGIN: f32 = 0.1;

/// γₙ in single precision.
const fn gamma(n: f32) -> f32 {
    let epsilon = 0.5 * f32::EPSILON;
    n * epsilon / (1.0 - n * epsilon)
}

/// A point with a bound on its absolute rounding error per coordinate.
#[derive(Debug, Clone, Copy)]
pub struct UncertainPoint {
    /// The point, metres.
    pub position: Vec3,
    /// Bound on the error of each coordinate, metres.
    pub error: Vec3,
}

impl UncertainPoint {
    /// A point of a triangle in world space, by its barycentric weights. Points within their error of an edge are moved
    /// inwards by it: a point on the edge where two walls meet must not come to lie in, or behind, the other wall.
    pub fn on_triangle(vertices: &[Vec3; 3], u: f32, v: f32) -> Self {
        let size = vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        let (e1, e2) = (vertices[1] - vertices[0], vertices[2] - vertices[0]);
        let smallest_height = e1.cross(e2).length() / (e1.length() + e2.length());
        let margin = (4.0 * gamma(7.0) * size / smallest_height).min(MOST_MARGIN);
        let weights = [1.0 - u - v, u, v].map(|w| w.max(margin));
        let scale = 1.0 / weights.iter().sum::<f32>();
        let weights = weights.map(|w| w * scale);
        let sum = |f: fn(Vec3) -> Vec3| (0..3).map(|i| f(vertices[i]) * weights[i].abs()).sum::<Vec3>();
        let position = (0..3).map(|i| vertices[i] * weights[i]).sum();
        Self { position, error: gamma(7.0) * sum(Vec3::abs) }
    }

    /// Adds what placing the triangle, and taking a ray into its object's space and back, can round away.
    pub fn through(mut self, world_from_object: &Affine3A, object_from_world: &Affine3A) -> Self {
        let there = magnitude(object_from_world, self.position);
        let back = world_from_object.matrix3.abs_columns() * there;
        self.error += gamma(5.0) * (back + Vec3::from(world_from_object.translation).abs());
        self
    }

    /// The point moved to the side of the unit `normal`, clear of the surface. The distance is scaled to the largest
    /// coordinate of its triangle: a grazing ray's test against that triangle errs by as much, along any axis.
    pub fn offset_along(&self, normal: Vec3) -> Vec3 {
        let distance = 2.0 * self.error.max_element();
        let moved = self.position + normal * distance;
        let away = |p: f32, n: f32| {
            if n > 0.0 {
                p.next_up()
            } else if n < 0.0 {
                p.next_down()
            } else {
                p
            }
        };
        Vec3::new(away(moved.x, normal.x), away(moved.y, normal.y), away(moved.z, normal.z))
    }
}

/// Sum of the magnitudes that a transform adds up for each coordinate of a point.
fn magnitude(transform: &Affine3A, point: Vec3) -> Vec3 {
    transform.matrix3.abs_columns() * point.abs() + Vec3::from(transform.translation).abs()
}

trait AbsColumns {
    fn abs_columns(&self) -> glam::Mat3;
}

impl AbsColumns for glam::Mat3A {
    fn abs_columns(&self) -> glam::Mat3 {
        glam::Mat3::from_cols(self.x_axis.abs().into(), self.y_axis.abs().into(), self.z_axis.abs().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::triangle::{Pack, Shear};

    #[test]
    fn rays_that_leave_a_triangle_do_not_meet_it_again() {
        for scale in [1e-3f32, 1.0, 1e5] {
            let triangle =
                [Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, -1.0)].map(|p| p * scale);
            let unmoved = |p: &UncertainPoint| p.position + Vec3::Y * f32::MIN_POSITIVE;
            let (mut met, mut met_unmoved) = (0, 0);
            for i in 0..20_000 {
                let f = i as f32;
                let (u, v) = (0.5 * (f * 0.618).fract(), 0.5 * (f * 0.754).fract());
                let point = UncertainPoint::on_triangle(&triangle, u, v);
                let dir = Vec3::new((f * 1.3).cos(), (f * 0.123).fract().powi(4), (f * 1.3).sin());
                let meets = |origin: Vec3| {
                    let mut met = false;
                    Shear::new(origin, dir).intersect(&Pack::new([triangle]), f32::INFINITY, |_, _| met = true);
                    met
                };
                met += u32::from(meets(point.offset_along(Vec3::Y)));
                met_unmoved += u32::from(meets(unmoved(&point)));
            }
            assert_eq!(met, 0, "scale {scale}");
            assert!(met_unmoved > 100, "without an offset the surface shadows itself: {met_unmoved}");
        }
    }

    #[test]
    fn the_offset_point_lies_on_the_side_of_the_normal_at_any_scale() {
        for scale in [1e-3f32, 1.0, 1e4, 1e7] {
            let base = Vec3::new(3.0, -7.0, 11.0) * scale;
            let triangle = [base, base + Vec3::new(1.0, 0.3, 0.1) * scale, base + Vec3::new(-0.2, 0.9, 0.4) * scale];
            let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalize();
            let point = UncertainPoint::on_triangle(&triangle, 0.3, 0.4);
            let [a, b, c] = triangle.map(|p| p.as_dvec3());
            let exact = (b - a).cross(c - a).normalize();
            for side in [1.0f32, -1.0] {
                let height = (point.offset_along(side * normal).as_dvec3() - a).dot(exact) * f64::from(side);
                assert!(height > 0.0, "scale {scale}: {height}");
                assert!(height < 1e-5 * f64::from(scale) * 14.0, "scale {scale}: {height}");
            }
            let unmoved = (point.position.as_dvec3() - a).dot(exact);
            assert!(unmoved.abs() < 1e-5 * f64::from(scale) * 14.0);
        }
    }
}
