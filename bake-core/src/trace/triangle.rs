//! Watertight ray–triangle test.
//!
//! A ray that passes through a vertex or an edge shared by two triangles hits at least one of them, because both see
//! exactly the same rounded edge function there. Source: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle
//! Intersection", with their double-precision fallback where an edge function is zero.

use glam::Vec3;

/// The shear that turns a ray into +z through the origin, made once a ray.
#[derive(Debug, Clone, Copy)]
pub struct Shear {
    origin: Vec3,
    axes: [usize; 3],
    shear: Vec3,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter, in units of the direction's length.
    pub t: f32,
    /// Weight of the second vertex.
    pub u: f32,
    /// Weight of the third vertex.
    pub v: f32,
    /// Whether the vertices run clockwise seen from the ray's origin.
    pub clockwise: bool,
}

impl Shear {
    /// Prepares a ray. The direction need not be unit, but not zero.
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        let size = dir.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if dir[z] < 0.0 {
            std::mem::swap(&mut x, &mut y); // keeps the winding
        }
        Self { origin, axes: [x, y, z], shear: Vec3::new(dir[x] / dir[z], dir[y] / dir[z], 1.0 / dir[z]) }
    }

    /// A vertex in the ray's sheared frame.
    #[inline(always)]
    fn place(&self, vertex: Vec3) -> Vec3 {
        let p = vertex - self.origin;
        let [x, y, z] = self.axes;
        let (px, py, pz) = (p[x], p[y], p[z]);
        Vec3::new(px - self.shear.x * pz, py - self.shear.y * pz, self.shear.z * pz)
    }

    /// The hit with 0 < t ≤ `t_max`, from either side; degenerate triangles are never hit.
    #[inline(always)]
    pub fn intersect(&self, triangle: &[Vec3; 3], t_max: f32) -> Option<TriangleHit> {
        let (a, b, c) = (self.place(triangle[0]), self.place(triangle[1]), self.place(triangle[2]));
        let mut u = c.x * b.y - c.y * b.x;
        let mut v = a.x * c.y - a.y * c.x;
        let mut w = b.x * a.y - b.y * a.x;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            u = edge(c, b);
            v = edge(a, c);
            w = edge(b, a);
        }
        let (low, high) = (u.min(v).min(w), u.max(v).max(w));
        if low < 0.0 && high > 0.0 {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let t = (u * a.z + v * b.z + w * c.z) / det;
        (t > 0.0 && t <= t_max).then(|| TriangleHit { t, u: v / det, v: w / det, clockwise: det < 0.0 })
    }
}

/// Edge function p × q with products in double precision, where they are exact.
#[cold]
fn edge(p: Vec3, q: Vec3) -> f32 {
    (f64::from(p.x) * f64::from(q.y) - f64::from(p.y) * f64::from(q.x)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn barycentrics_and_winding() {
        let hit = Shear::new(Vec3::new(0.25, 0.5, 2.0), Vec3::NEG_Z).intersect(&TRIANGLE, 10.0).unwrap();
        assert_eq!(hit, TriangleHit { t: 2.0, u: 0.25, v: 0.5, clockwise: false });
        let back = Shear::new(Vec3::new(0.25, 0.5, -2.0), Vec3::Z).intersect(&TRIANGLE, 10.0).unwrap();
        assert_eq!(back, TriangleHit { t: 2.0, u: 0.25, v: 0.5, clockwise: true });
    }

    #[test]
    fn winding_holds_along_every_axis() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let (e1, e2) = axis.any_orthonormal_pair();
            let triangle = if e1.cross(e2).dot(axis) > 0.0 { [Vec3::ZERO, e1, e2] } else { [Vec3::ZERO, e2, e1] };
            let above = 0.2 * e1 + 0.2 * e2 + axis;
            assert!(!Shear::new(above, -axis).intersect(&triangle, 2.0).unwrap().clockwise);
            let below = 0.2 * e1 + 0.2 * e2 - axis;
            assert!(Shear::new(below, axis).intersect(&triangle, 2.0).unwrap().clockwise);
        }
    }

    #[test]
    fn nothing_behind_or_beyond() {
        assert!(Shear::new(Vec3::new(0.2, 0.2, -1.0), Vec3::NEG_Z).intersect(&TRIANGLE, 10.0).is_none());
        assert!(Shear::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z).intersect(&TRIANGLE, 0.5).is_none());
        assert!(Shear::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z).intersect(&[Vec3::X; 3], 9.0).is_none());
    }
}
