//! Triangles in the world with what every point on them asks for, kept for as many as fit.
//!
//! Cost: 52 bytes a triangle of an instance; those beyond the first [`MOST_KEPT`] are worked out at each call.

use super::offset::edge_margin;
use super::world_triangle;
use crate::scene::Scene;
use glam::Vec3;

/// A triangle in the world.
#[derive(Debug, Clone, Copy)]
pub struct Facet {
    /// Corners, metres.
    pub vertices: [Vec3; 3],
    /// Unit geometric normal of the front side.
    pub normal: Vec3,
    /// See [`edge_margin`].
    pub margin: f32,
}

/// Triangles that are kept.
const MOST_KEPT: usize = 1 << 21;

/// The triangles of a scene's instances.
pub struct Facets {
    facets: Vec<Facet>,
    /// Place of each instance's first triangle, or [`NOT_KEPT`].
    first: Vec<usize>,
}

const NOT_KEPT: usize = usize::MAX;

impl Facet {
    /// A triangle of an instance.
    pub fn new(scene: &Scene, instance: u32, triangle: u32) -> Self {
        let vertices = world_triangle(scene, instance, triangle);
        let winding = if scene.instances[instance as usize].is_mirrored() { -1.0 } else { 1.0 };
        let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]).normalize_or(Vec3::Y) * winding;
        Self { vertices, normal, margin: edge_margin(&vertices) }
    }
}

impl Facets {
    /// Keeps the triangles of all instances that fit.
    pub fn new(scene: &Scene) -> Self {
        Self::keeping(scene, MOST_KEPT)
    }

    fn keeping(scene: &Scene, most: usize) -> Self {
        let (mut facets, mut first) = (Vec::new(), Vec::new());
        for (instance, placement) in scene.instances.iter().enumerate() {
            let count = scene.meshes[placement.mesh as usize].triangles.len();
            if facets.len() + count > most {
                first.push(NOT_KEPT);
                continue;
            }
            first.push(facets.len());
            facets.extend((0..count as u32).map(|triangle| Facet::new(scene, instance as u32, triangle)));
        }
        Self { facets, first }
    }

    /// A triangle of an instance.
    #[inline]
    pub fn of(&self, scene: &Scene, instance: u32, triangle: u32) -> Facet {
        match self.first[instance as usize] {
            NOT_KEPT => Facet::new(scene, instance, triangle),
            first => self.facets[first + triangle as usize],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::{closed_box, instance, matte, scene};

    #[test]
    fn what_does_not_fit_is_worked_out() {
        let mut scene = scene(vec![closed_box(Vec3::ZERO, Vec3::ONE, true, 0)], vec![matte(0.5)]);
        scene.instances.push(instance(0, glam::Affine3A::from_translation(Vec3::X)));
        let count = scene.meshes[0].triangles.len();
        let (all, one) = (Facets::new(&scene), Facets::keeping(&scene, count));
        assert_eq!((all.facets.len(), one.facets.len()), (2 * count, count));
        for (instance, triangle) in (0..2).flat_map(|i| (0..count as u32).map(move |t| (i, t))) {
            let [kept, again] = [&all, &one].map(|facets| facets.of(&scene, instance, triangle));
            assert_eq!(kept.vertices, world_triangle(&scene, instance, triangle));
            assert_eq!((kept.vertices, kept.normal, kept.margin), (again.vertices, again.normal, again.margin));
        }
        assert_ne!(all.of(&scene, 0, 0).vertices, all.of(&scene, 1, 0).vertices);
    }
}
