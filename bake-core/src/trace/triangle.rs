//! Watertight ray–triangle test, four triangles at once.
//!
//! A ray that passes through a vertex or an edge shared by two triangles hits at least one of them, because both see
//! exactly the same rounded edge function there. Source: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle
//! Intersection", with their double-precision fallback where an edge function is zero.

use glam::Vec3;
use wide::f32x4;

/// Triangles tested together.
pub const LANES: usize = 4;

/// Up to four triangles by vertex, axis and lane. Empty lanes are NaN and never hit.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub struct Pack {
    vertices: [[[f32; LANES]; 3]; 3],
}

impl Pack {
    /// Packs up to four triangles.
    pub fn new(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut vertices = [[[f32::NAN; LANES]; 3]; 3];
        for (lane, triangle) in triangles.into_iter().enumerate() {
            for (vertex, position) in triangle.iter().enumerate() {
                for axis in 0..3 {
                    vertices[vertex][axis][lane] = position[axis];
                }
            }
        }
        Self { vertices }
    }
}

/// The shear that turns a ray into +z through the origin, made once a ray.
#[derive(Debug, Clone, Copy)]
pub struct Shear {
    origin: [f32x4; 3],
    axes: [usize; 3],
    shear: [f32x4; 3],
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
    #[inline]
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
        let splat = |axis: usize| f32x4::splat(origin[axis]);
        let shear = [f32x4::splat(dir[x] / dir[z]), f32x4::splat(dir[y] / dir[z]), f32x4::splat(1.0 / dir[z])];
        Self { origin: [splat(x), splat(y), splat(z)], axes: [x, y, z], shear }
    }

    /// A vertex of every lane in the ray's sheared frame.
    #[inline(always)]
    fn place(&self, vertex: &[[f32; LANES]; 3]) -> [f32x4; 3] {
        let from_origin = |i: usize| f32x4::new(vertex[self.axes[i]]) - self.origin[i];
        let z = from_origin(2);
        [from_origin(0) - self.shear[0] * z, from_origin(1) - self.shear[1] * z, self.shear[2] * z]
    }

    /// Calls `found` for every lane hit with 0 < t ≤ `t_max`, from either side; degenerate triangles are never hit.
    #[inline(always)]
    pub fn intersect(&self, pack: &Pack, t_max: f32, mut found: impl FnMut(usize, TriangleHit)) {
        let [a, b, c] = &pack.vertices;
        let (a, b, c) = (self.place(a), self.place(b), self.place(c));
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        let zero = f32x4::ZERO;
        if (u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero)).any() {
            [u, v, w] = [edges(c, b), edges(a, c), edges(b, a)];
        }
        let one_side = u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero);
        let other_side = u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero);
        let det = u + v + w;
        let inside = (one_side | other_side) & det.simd_ne(zero);
        if !inside.any() {
            return;
        }
        let t = (u * a[2] + v * b[2] + w * c[2]) / det;
        let hits = (inside & t.simd_gt(zero) & t.simd_le(f32x4::splat(t_max))).to_bitmask();
        if hits == 0 {
            return;
        }
        let (t, u, v, det) = (t.to_array(), (v / det).to_array(), (w / det).to_array(), det.to_array());
        for lane in 0..LANES {
            if hits >> lane & 1 == 1 {
                found(lane, TriangleHit { t: t[lane], u: u[lane], v: v[lane], clockwise: det[lane] < 0.0 });
            }
        }
    }
}

/// Edge functions p × q of every lane with products in double precision, where they are exact.
#[cold]
fn edges(p: [f32x4; 3], q: [f32x4; 3]) -> f32x4 {
    let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(f32x4::to_array);
    f32x4::new(std::array::from_fn(|i| edge(px[i], py[i], qx[i], qy[i])))
}

/// A zero only where the exact value is zero.
fn edge(px: f32, py: f32, qx: f32, qy: f32) -> f32 {
    let exact = f64::from(px) * f64::from(qy) - f64::from(py) * f64::from(qx);
    let rounded = exact as f32;
    if rounded == 0.0 && exact != 0.0 { f32::MIN_POSITIVE * exact.signum() as f32 } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    /// The hit of one triangle, whatever lane it is in.
    fn meet(origin: Vec3, dir: Vec3, triangle: &[Vec3; 3], t_max: f32) -> Option<TriangleHit> {
        let far = triangle.map(|p| p + Vec3::splat(1e3));
        let mut hits = Vec::new();
        for lane in 0..LANES {
            let mut triangles = [far; LANES];
            triangles[lane] = *triangle;
            Shear::new(origin, dir)
                .intersect(&Pack::new(triangles), t_max, |at, hit| hits.push((at == lane).then_some(hit)));
        }
        Shear::new(origin, dir)
            .intersect(&Pack::new([*triangle]), t_max, |at, hit| hits.push((at == 0).then_some(hit)));
        assert!(hits.is_empty() || hits.len() == LANES + 1);
        assert!(hits.windows(2).all(|pair| pair[0] == pair[1]));
        hits.first().copied().map(|hit| hit.expect("the lane that was given"))
    }

    #[test]
    fn barycentrics_and_winding() {
        let hit = meet(Vec3::new(0.25, 0.5, 2.0), Vec3::NEG_Z, &TRIANGLE, 10.0).unwrap();
        assert_eq!(hit, TriangleHit { t: 2.0, u: 0.25, v: 0.5, clockwise: false });
        let back = meet(Vec3::new(0.25, 0.5, -2.0), Vec3::Z, &TRIANGLE, 10.0).unwrap();
        assert_eq!(back, TriangleHit { t: 2.0, u: 0.25, v: 0.5, clockwise: true });
    }

    #[test]
    fn winding_holds_along_every_axis() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let (e1, e2) = axis.any_orthonormal_pair();
            let triangle = if e1.cross(e2).dot(axis) > 0.0 { [Vec3::ZERO, e1, e2] } else { [Vec3::ZERO, e2, e1] };
            let above = 0.2 * e1 + 0.2 * e2 + axis;
            assert!(!meet(above, -axis, &triangle, 2.0).unwrap().clockwise);
            let below = 0.2 * e1 + 0.2 * e2 - axis;
            assert!(meet(below, axis, &triangle, 2.0).unwrap().clockwise);
        }
    }

    #[test]
    fn nothing_behind_or_beyond() {
        assert!(meet(Vec3::new(0.2, 0.2, -1.0), Vec3::NEG_Z, &TRIANGLE, 10.0).is_none());
        assert!(meet(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z, &TRIANGLE, 0.5).is_none());
        assert!(meet(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z, &[Vec3::X; 3], 9.0).is_none());
    }
}
