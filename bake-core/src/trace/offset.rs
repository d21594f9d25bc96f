//! Where a ray may start so that it does not meet the surface it leaves: offsets scaled to the coordinates.
//!
//! The bound on the rounding error of a point follows Pharr, Jakob and Humphreys, "Physically Based Rendering",
//! 3rd edition, 3.9: γₙ = nε/(1 − nε) times the magnitudes that went into it.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// Largest weight that a point is moved away from an edge, for triangles no larger than their coordinates' error.
const MOST_MARGIN: f32 = 0.1;

/// γₙ in single precision.
const fn gamma(n: f32) -> f32 {
    let epsilon = 0.5 * f32::EPSILON;
    n * epsilon / (1.0 - n * epsilon)
}

/// Weight that a point of a triangle keeps of every vertex, so that it lies as far inside as its position is uncertain.
pub fn edge_margin(vertices: &[Vec3; 3]) -> f32 {
    let size = vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    let (e1, e2) = (vertices[1] - vertices[0], vertices[2] - vertices[0]);
    let smallest_height = e1.cross(e2).length() / (e1.length() + e2.length());
    (4.0 * gamma(7.0) * size / smallest_height).min(MOST_MARGIN)
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
        Self::within(vertices, edge_margin(vertices), u, v)
    }

    /// The same with [`edge_margin`] at hand.
    #[inline]
    pub fn within(&[a, b, c]: &[Vec3; 3], margin: f32, u: f32, v: f32) -> Self {
        let (wa, wb, wc) = ((1.0 - u - v).max(margin), u.max(margin), v.max(margin));
        let scale = 1.0 / (wa + wb + wc);
        let (wa, wb, wc) = (wa * scale, wb * scale, wc * scale);
        let error = a.abs() * wa.abs() + b.abs() * wb.abs() + c.abs() * wc.abs();
        Self { position: a * wa + b * wb + c * wc, error: gamma(7.0) * error }
    }

    /// Adds what placing the triangle, and taking a ray into its object's space and back, can round away.
    #[inline]
    pub fn through(mut self, world_from_object: &Affine3A, object_from_world: &Affine3A) -> Self {
        let there = magnitude(object_from_world, self.position.into());
        let back = absolute(world_from_object) * there;
        self.error += gamma(5.0) * Vec3::from(back + world_from_object.translation.abs());
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
#[inline]
fn magnitude(transform: &Affine3A, point: Vec3A) -> Vec3A {
    absolute(transform) * point.abs() + transform.translation.abs()
}

#[inline]
fn absolute(transform: &Affine3A) -> Mat3A {
    let matrix = &transform.matrix3;
    Mat3A::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs())
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
