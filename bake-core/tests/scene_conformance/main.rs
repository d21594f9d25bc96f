//! Khronos' conformance models: what their pages say must be seen, as numbers.
//!
//! `generator` holds the generated models of glTF-Asset-Generator, `samples` those of glTF-Sample-Assets, `lights` what
//! is emitted and absorbed, `lantern` one mesh in three encodings. `oracle` reads textures in another way.

mod generator;
mod lantern;
mod lights;
mod oracle;
mod samples;

use bake_core::scene::{self, LoadOptions, Scene, Warning};
use glam::{DMat3, DVec3, Vec2};
use std::path::Path;

/// Loads an asset that may bring no light of its own.
fn load(path: &Path) -> (Scene, Vec<Warning>) {
    let options = LoadOptions { require_light: false, ..LoadOptions::default() };
    scene::load(path, &options).unwrap_or_else(|error| panic!("{error}"))
}

/// Corners of an instance's triangles in the world, in the file's winding.
fn world_triangles(scene: &Scene, instance: usize) -> Vec<[DVec3; 3]> {
    let instance = &scene.instances[instance];
    let mesh = &scene.meshes[instance.mesh as usize];
    let to_world = instance.world_from_object;
    let corner = |v: u32| to_world.transform_point3(mesh.positions[v as usize]).as_dvec3();
    mesh.triangles.iter().map(|t| t.map(corner)).collect()
}

fn all_world_triangles(scene: &Scene) -> Vec<[DVec3; 3]> {
    (0..scene.instances.len()).flat_map(|i| world_triangles(scene, i)).collect()
}

/// Area vector by the winding in the world, turned around where the node mirrors (glTF 2.0, section 3.7.4).
fn front(scene: &Scene, instance: usize, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let area = (b - a).cross(c - a) / 2.0;
    if scene.instances[instance].is_mirrored() { -area } else { area }
}

/// The mean shading normal of a triangle in the world: transformed by the inverse transpose.
fn shading_normal(scene: &Scene, instance: usize, triangle: usize) -> DVec3 {
    let instance = &scene.instances[instance];
    let mesh = &scene.meshes[instance.mesh as usize];
    let linear: DMat3 = glam::Mat3::from(instance.world_from_object.matrix3).as_dmat3();
    let sum: DVec3 = mesh.triangles[triangle].iter().map(|&v| mesh.normals[v as usize].as_dvec3()).sum();
    (linear.inverse().transpose() * sum).normalize()
}

/// Points spread over a triangle as weights of its second and third corner.
fn grid(n: u32) -> impl Iterator<Item = Vec2> {
    (0..n).flat_map(move |i| (0..n - i).map(move |j| (Vec2::new(i as f32, j as f32) + 1.0 / 3.0) / n as f32))
}

fn instance_named(scene: &Scene, name: &str) -> usize {
    let ends = |path: &str| path.rsplit('/').next() == Some(name);
    scene.instances.iter().position(|i| ends(&i.path)).unwrap_or_else(|| panic!("no instance {name}"))
}
