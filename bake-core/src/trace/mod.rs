//! Rays against the scene: closest hit, and what is left of light along a segment. Watertight.
//!
//! Meshes placed once lie together in world space under one tree; meshes placed more often keep one tree each, and
//! rays are taken into their space. Equal distances are decided by instance and triangle number, so hits do not
//! depend on how the trees were built. A slow twin in double precision stands in [`brute_force`].

pub mod brute_force;
pub mod bvh;
pub mod facet;
pub mod offset;
pub mod passage;
pub mod triangle;

use crate::scene::{AlphaMode, Scene};
use bvh::{Bounds, BoxRay, Bvh, GAP};
use facet::{Facet, Facets};
use glam::{Affine3A, Vec2, Vec3};
use offset::UncertainPoint;
use passage::{Passage, is_cut_away};
use triangle::{LANES, Pack, Shear};

/// A segment in world space.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Start, metres.
    pub origin: Vec3,
    /// Direction of travel; distances are in units of its length.
    pub dir: Vec3,
    /// End of the segment.
    pub t_max: f32,
}

/// The nearest surface along a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray direction's length.
    pub t: f32,
    /// Index of the scene's instance.
    pub instance: u32,
    /// Index of the mesh's triangle.
    pub triangle: u32,
    /// Weights of the second and third vertex.
    pub barycentric: Vec2,
    /// Whether the ray comes from behind the triangle's front side.
    pub back_face: bool,
}

/// The place of a hit or texel point in the world.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Position with its rounding error.
    pub point: UncertainPoint,
    /// Unit geometric normal of the front side.
    pub normal_geom: Vec3,
}

/// Triangles under one tree: a pack for each leaf.
struct Blas {
    bvh: Bvh,
    packs: Vec<(Pack, [TriangleId; LANES])>,
}

#[derive(Debug, Clone, Copy, Default)]
struct TriangleId {
    /// Of the scene, or unused in shared meshes.
    instance: u32,
    triangle: u32,
    /// The vertices run the other way round in world space.
    mirrored: bool,
    /// Light may pass: masked, blended or transmissive.
    permeable: bool,
}

/// A shared mesh in the world.
struct Placed {
    instance: u32,
    blas: usize,
    object_from_world: Affine3A,
}

/// The scene, ready for rays.
pub struct Tracer<'s> {
    scene: &'s Scene,
    world: Blas,
    shared: Vec<Blas>,
    placed: Vec<Placed>,
    top: Bvh,
    object_from_world: Vec<Affine3A>,
    facets: Facets,
}

impl<'s> Tracer<'s> {
    /// Builds the trees.
    pub fn new(scene: &'s Scene) -> Self {
        let mut uses = vec![0u32; scene.meshes.len()];
        for instance in &scene.instances {
            uses[instance.mesh as usize] += 1;
        }
        let shared_meshes: Vec<usize> = (0..uses.len()).filter(|&mesh| uses[mesh] > 1).collect();
        let shared: Vec<Blas> = shared_meshes.iter().map(|&mesh| Blas::of_mesh(scene, mesh)).collect();
        let object_from_world: Vec<_> = scene.instances.iter().map(|i| i.world_from_object.inverse()).collect();
        let mut placed: Vec<Placed> = Vec::new();
        for (index, instance) in scene.instances.iter().enumerate() {
            if let Ok(blas) = shared_meshes.binary_search(&(instance.mesh as usize)) {
                let object_from_world = object_from_world[index];
                placed.push(Placed { instance: index as u32, blas, object_from_world });
            }
        }
        let boxes: Vec<Bounds> = placed.iter().map(|p| world_bounds(scene, p.instance)).collect();
        let top = Bvh::build(&boxes, 1);
        let world = Blas::of_single_use(scene, &uses);
        let facets = Facets::new(scene);
        Self { scene, world, shared, placed, top, object_from_world, facets }
    }

    /// The scene that was given.
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// The nearest hit; masked-out parts are holes, blended and transmissive ones are hits.
    #[inline]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut best = None;
        let box_ray = BoxRay::new(ray.origin, ray.dir);
        self.world.closest(self.scene, None, &box_ray, ray, &mut best);
        if !self.placed.is_empty() {
            let t_max = best.map_or(ray.t_max, |hit: Hit| hit.t);
            self.top.traverse(&box_ray, t_max, |range, reach| {
                for place in range {
                    let placed = &self.placed[self.top.order[place] as usize];
                    let local = placed.to_object(ray);
                    let local_box = BoxRay::new(local.origin, local.dir);
                    self.shared[placed.blas].closest(self.scene, Some(placed.instance), &local_box, &local, &mut best);
                }
                best.map_or(reach, |hit| hit.t)
            });
        }
        best
    }

    /// What is left of light along the segment: 0 behind an opaque surface, the product of what blended and
    /// transmissive surfaces let through, weakened by the absorbing volumes crossed (KHR_materials_volume).
    #[inline]
    pub fn transmittance(&self, ray: &Ray) -> Vec3 {
        let mut passage = Passage::default();
        let box_ray = BoxRay::new(ray.origin, ray.dir);
        self.world.pass(self.scene, None, &box_ray, ray, &mut passage);
        if !self.placed.is_empty() && !passage.blocked {
            self.top.traverse(&box_ray, ray.t_max, |range, reach| {
                for place in range {
                    let placed = &self.placed[self.top.order[place] as usize];
                    let local = placed.to_object(ray);
                    let local_box = BoxRay::new(local.origin, local.dir);
                    self.shared[placed.blas].pass(self.scene, Some(placed.instance), &local_box, &local, &mut passage);
                }
                if passage.blocked { -1.0 } else { reach }
            });
        }
        passage.transmittance(ray)
    }

    /// Where barycentric weights of a triangle lie in the world.
    #[inline]
    pub fn place(&self, instance: u32, triangle: u32, barycentric: Vec2) -> Place {
        let Facet { vertices, normal, margin } = self.facets.of(self.scene, instance, triangle);
        let placement = &self.scene.instances[instance as usize];
        let point = UncertainPoint::within(&vertices, margin, barycentric.x, barycentric.y)
            .through(&placement.world_from_object, &self.object_from_world[instance as usize]);
        Place { point, normal_geom: normal }
    }

    /// The unit interpolated normal on the side of `normal_geom`, turned towards it where the file's normals fold over.
    #[inline]
    pub fn shading_normal(&self, instance: u32, triangle: u32, barycentric: Vec2, normal_geom: Vec3) -> Vec3 {
        let placement = &self.scene.instances[instance as usize];
        let mesh = &self.scene.meshes[placement.mesh as usize];
        let [a, b, c] = mesh.triangles[triangle as usize];
        let (a, b, c) = (mesh.normals[a as usize], mesh.normals[b as usize], mesh.normals[c as usize]);
        let Vec2 { x: u, y: v } = barycentric;
        let local = a * (1.0 - u - v) + b * u + c * v;
        let inverse = &self.object_from_world[instance as usize].matrix3;
        let normal = (inverse.transpose() * local).normalize_or(normal_geom);
        if normal.dot(normal_geom) > 0.0 { normal } else { normal_geom }
    }
}

impl Placed {
    fn to_object(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.object_from_world.transform_point3(ray.origin),
            dir: self.object_from_world.transform_vector3(ray.dir),
            t_max: ray.t_max,
        }
    }
}

impl Blas {
    fn build(triangles: Vec<([Vec3; 3], TriangleId)>) -> Self {
        let boxes: Vec<Bounds> = triangles.iter().map(|(vertices, _)| Bounds::of(*vertices)).collect();
        let bvh = Bvh::build(&boxes, LANES as u32);
        let pack = |leaf: &[u32]| {
            let members = || leaf.iter().filter(|&&index| index != GAP).map(|&index| triangles[index as usize]);
            let mut ids = [TriangleId::default(); LANES];
            ids.iter_mut().zip(members()).for_each(|(id, (_, member))| *id = member);
            (Pack::new(members().map(|(vertices, _)| vertices)), ids)
        };
        let packs = bvh.order.chunks(LANES).map(pack).collect();
        Self { bvh, packs }
    }

    fn of_mesh(scene: &Scene, index: usize) -> Self {
        let mesh = &scene.meshes[index];
        Self::build(
            (0..mesh.triangles.len() as u32)
                .map(|triangle| {
                    let vertices = mesh.triangles[triangle as usize].map(|v| mesh.positions[v as usize]);
                    let permeable = is_permeable(scene, mesh.material_of(triangle));
                    (vertices, TriangleId { instance: 0, triangle, mirrored: false, permeable })
                })
                .collect(),
        )
    }

    fn of_single_use(scene: &Scene, uses: &[u32]) -> Self {
        let mut triangles = Vec::new();
        for (instance, placement) in scene.instances.iter().enumerate() {
            if uses[placement.mesh as usize] != 1 {
                continue;
            }
            let (mesh, mirrored) = (&scene.meshes[placement.mesh as usize], placement.is_mirrored());
            for triangle in 0..mesh.triangles.len() as u32 {
                let permeable = is_permeable(scene, mesh.material_of(triangle));
                let id = TriangleId { instance: instance as u32, triangle, mirrored, permeable };
                triangles.push((world_triangle(scene, instance as u32, triangle), id));
            }
        }
        Self::build(triangles)
    }

    /// Improves `best` by what this tree holds. `instance` overrides the stored one for shared meshes.
    #[inline(always)]
    fn closest(&self, scene: &Scene, instance: Option<u32>, box_ray: &BoxRay, ray: &Ray, best: &mut Option<Hit>) {
        let shear = Shear::new(ray.origin, ray.dir);
        let t_max = best.map_or(ray.t_max, |hit| hit.t);
        self.bvh.traverse(box_ray, t_max, |range, mut reach| {
            let (pack, ids) = &self.packs[range.start / LANES];
            shear.intersect(pack, reach, |lane, at| {
                let hit = ids[lane].hit(instance, at);
                let nearer = best.is_none_or(|b| {
                    hit.t < b.t || (hit.t == b.t && (hit.instance, hit.triangle) < (b.instance, b.triangle))
                });
                if nearer && !(ids[lane].permeable && is_cut_away(scene, &hit)) {
                    *best = Some(hit);
                    reach = hit.t;
                }
            });
            reach
        });
    }

    /// Collects what light meets within this tree.
    #[inline(always)]
    fn pass(&self, scene: &Scene, instance: Option<u32>, box_ray: &BoxRay, ray: &Ray, passage: &mut Passage) {
        let shear = Shear::new(ray.origin, ray.dir);
        self.bvh.traverse(box_ray, ray.t_max, |range, reach| {
            let (pack, ids) = &self.packs[range.start / LANES];
            shear.intersect(pack, reach, |lane, at| {
                if ids[lane].permeable {
                    passage.cross(scene, &ids[lane].hit(instance, at));
                } else {
                    passage.blocked = true;
                }
            });
            if passage.blocked { -1.0 } else { reach }
        });
    }
}

impl TriangleId {
    fn hit(&self, instance: Option<u32>, at: triangle::TriangleHit) -> Hit {
        Hit {
            t: at.t,
            instance: instance.unwrap_or(self.instance),
            triangle: self.triangle,
            barycentric: Vec2::new(at.u, at.v),
            back_face: at.clockwise != self.mirrored,
        }
    }
}

/// The world-space corners of an instance's triangle: the one place where they are computed.
pub fn world_triangle(scene: &Scene, instance: u32, triangle: u32) -> [Vec3; 3] {
    let placement = &scene.instances[instance as usize];
    let mesh = &scene.meshes[placement.mesh as usize];
    let at = |v: u32| placement.world_from_object.transform_point3(mesh.positions[v as usize]);
    let [a, b, c] = mesh.triangles[triangle as usize];
    [at(a), at(b), at(c)]
}

fn world_bounds(scene: &Scene, instance: u32) -> Bounds {
    let placement = &scene.instances[instance as usize];
    let mesh = &scene.meshes[placement.mesh as usize];
    Bounds::of(mesh.positions.iter().map(|&p| placement.world_from_object.transform_point3(p)))
}

fn is_permeable(scene: &Scene, material: u32) -> bool {
    let material = &scene.materials[material as usize];
    material.alpha_mode != AlphaMode::Opaque || material.transmission > 0.0
}

#[cfg(test)]
mod tests;
