//! The slow twin of the trees: every triangle of every instance, in world space and double precision.

use super::world_triangle;
use crate::scene::Scene;
use glam::DVec3;

/// The nearest hit of a ray from `origin` along `dir` by Möller–Trumbore over all triangles:
/// distance, instance, triangle. Alpha is ignored.
pub fn closest_hit(scene: &Scene, origin: DVec3, dir: DVec3) -> Option<(f64, u32, u32)> {
    let mut best: Option<(f64, u32, u32)> = None;
    for (instance, placement) in scene.instances.iter().enumerate() {
        for triangle in 0..scene.meshes[placement.mesh as usize].triangles.len() as u32 {
            let vertices = world_triangle(scene, instance as u32, triangle).map(|p| p.as_dvec3());
            let Some(t) = distance(&vertices, origin, dir) else { continue };
            if best.is_none_or(|(nearest, ..)| t < nearest) {
                best = Some((t, instance as u32, triangle));
            }
        }
    }
    best
}

fn distance([a, b, c]: &[DVec3; 3], origin: DVec3, dir: DVec3) -> Option<f64> {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = dir.cross(ac);
    let det = ab.dot(p);
    if det == 0.0 {
        return None;
    }
    let from_a = origin - *a;
    let u = from_a.dot(p) / det;
    let q = from_a.cross(ab);
    let v = dir.dot(q) / det;
    let t = ac.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}
