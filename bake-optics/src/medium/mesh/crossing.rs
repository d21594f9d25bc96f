//! Whether and where a line crosses a triangle, watertight: Woop, Benthin and Wald 2013 with exact signs.

use glam::{DVec2, DVec3};
use std::cmp::Ordering;

use crate::medium::Ray;

/// Space in which the ray is the third axis: the direction's largest axis, and the other two sheared.
pub struct Sheared {
    origin: DVec3,
    axes: [usize; 3],
    shear: DVec2,
    /// Distance along the ray per step along its largest axis.
    scale: f64,
}

impl Sheared {
    /// For a ray with a unit direction.
    pub fn new(ray: &Ray) -> Self {
        let z = ray.dir.abs().max_position();
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let scale = 1.0 / ray.dir[z];
        Self { origin: ray.origin, axes: [x, y, z], shear: DVec2::new(ray.dir[x], ray.dir[y]) * scale, scale }
    }

    /// Signed distance of the crossing, and +1 where the ray leaves through the front, −1 where it enters.
    pub fn crossing(&self, corners: [DVec3; 3]) -> Option<(f64, i32)> {
        let [(a, a_z), (b, b_z), (c, c_z)] = corners.map(|corner| self.point(corner));
        let turn = side(b, c);
        if turn == Ordering::Equal || side(c, a) != turn || side(a, b) != turn {
            return None;
        }
        let (u, v, w) = (b.perp_dot(c), c.perp_dot(a), a.perp_dot(b));
        let depth = (u * a_z + v * b_z + w * c_z) / (u + v + w);
        // Rounding may cancel all of a sliver's area: then any of its points will do.
        let depth = if depth.is_finite() { depth } else { a_z };
        let depth = depth.clamp(a_z.min(b_z).min(c_z), a_z.max(b_z).max(c_z));
        let front = (turn == Ordering::Greater) == (self.scale > 0.0);
        Some((depth * self.scale, if front { 1 } else { -1 }))
    }

    fn point(&self, corner: DVec3) -> (DVec2, f64) {
        let from_origin = corner - self.origin;
        let [x, y, z] = self.axes.map(|axis| from_origin[axis]);
        (DVec2::new(x, y) - self.shear * z, z)
    }
}

/// On which side of the edge from `a` to `b` the origin lies, moved aside by (ε, ε²): the exact sign of
/// `a × b + ε (a.y − b.y) + ε² (b.x − a.x)`; equal only where a = b.
///
/// Rounding is monotone, so that unequal rounded products are ordered as the exact ones; equal ones differ by their
/// rounding errors, which a fused multiplication gives exactly.
fn side(a: DVec2, b: DVec2) -> Ordering {
    let (p, q) = (a.x * b.y, a.y * b.x);
    p.total_order(q)
        .then_with(|| a.x.mul_add(b.y, -p).total_order(a.y.mul_add(b.x, -q)))
        .then_with(|| a.y.total_order(b.y))
        .then_with(|| b.x.total_order(a.x))
}

/// Order of finite numbers in which 0 = −0.
trait FiniteOrder {
    fn total_order(self, other: Self) -> Ordering;
}

impl FiniteOrder for f64 {
    fn total_order(self, other: Self) -> Ordering {
        self.partial_cmp(&other).unwrap_or(Ordering::Equal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Crossings of the whole line through an octahedron, with signs by `side`.
    fn sum_of_turns(ray: &Ray, side: impl Fn(DVec2, DVec2) -> Ordering) -> i32 {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let sheared = Sheared::new(ray);
        let turn = |face: [usize; 3]| {
            let [(a, _), (b, _), (c, _)] = face.map(|corner| sheared.point(corners[corner]));
            match [side(a, b), side(b, c), side(c, a)] {
                [Ordering::Greater, Ordering::Greater, Ordering::Greater] => 1,
                [Ordering::Less, Ordering::Less, Ordering::Less] => -1,
                _ => 0,
            }
        };
        faces.into_iter().map(turn).sum()
    }

    /// What enters leaves, at vertices, edges and faces alike; the usual test, which leaves edges out, loses crossings.
    #[test]
    fn crossings_of_a_line_sum_to_zero() {
        let usual = |a: DVec2, b: DVec2| a.perp_dot(b).total_order(0.0);
        let mut lost = 0;
        for i in 0..300 {
            let t = f64::from(i);
            let target = match i % 3 {
                0 => DVec3::AXES[i as usize / 3 % 3],
                1 => DVec3::new(0.25, 0.75, 0.0),
                _ => DVec3::new(0.3, 0.3, 0.4),
            };
            let origin = DVec3::new((0.7 * t).sin(), (1.3 * t).cos() + 2.0, (2.1 * t).sin()) * 3.0;
            let ray = Ray::between(if i % 2 == 0 { origin } else { target * 3.0 }, target);
            assert_eq!(sum_of_turns(&ray, side), 0, "{ray:?}");
            lost += usize::from(sum_of_turns(&ray, usual) != 0);
        }
        assert!(lost > 0, "the usual test loses a crossing on {lost} of 300 lines");
    }

    #[test]
    fn sides_are_antisymmetric_and_exact() {
        let tiny = f64::EPSILON;
        let points = [
            DVec2::ZERO,
            DVec2::X,
            DVec2::NEG_X,
            DVec2::new(1.0, tiny),
            DVec2::new(1.0 + tiny, tiny),
            DVec2::new(3.0, 3.0 * tiny),
            DVec2::new(0.1, 0.3),
            DVec2::new(0.2, 0.6),
        ];
        for a in points {
            for b in points {
                assert_eq!(side(a, b), side(b, a).reverse(), "{a} {b}");
                assert_eq!(side(a, b) == Ordering::Equal, a == b, "{a} {b}");
            }
        }
        // (1 + ε)² − (1 + 2ε) = ε²: rounded products are equal, exact ones are not.
        let (a, b) = (DVec2::new(1.0 + tiny, 1.0 + 2.0 * tiny), DVec2::new(1.0, 1.0 + tiny));
        assert_eq!(a.perp_dot(b), 0.0);
        assert_eq!(side(a, b), Ordering::Greater);
    }
}
