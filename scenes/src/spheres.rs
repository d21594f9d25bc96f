//! A glowing black sphere inside a white one. Both are polyhedra of the same shape; closed forms hold for their means
//! over all directions to about 0.2 %, and exactly for the share of light that each sends to the other.

use crate::build::{Content, Glb, Material, MaterialId, Patch, Place, lathe};
use crate::{SceneFiles, analytic};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Albedo of the outer sphere.
pub const ALBEDO: DVec3 = DVec3::new(0.2, 0.5, 0.8);
/// Radiance of the inner sphere, cd/m².
const RADIANCE: DVec3 = DVec3::new(1000.0, 800.0, 600.0);
/// Radii of the inner and the outer sphere, metres.
pub const RADII: [f64; 2] = [0.5, 2.0];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let lamp = glb.material("lamp", Material::emitter(RADIANCE.to_array()));
    let white = glb.material("white", Material::diffuse(ALBEDO.to_array()));
    let inner = glb.lightmapped_mesh("inner", &[sphere(RADII[0], lamp)]);
    glb.node(None, "inner", Place::ORIGIN, Content::Mesh(inner));
    let outer = glb.lightmapped_mesh("outer", &[sphere(RADII[1], white).flipped()]);
    glb.node(None, "outer", Place::ORIGIN, Content::Mesh(outer));
    SceneFiles { name: "spheres", glb: glb.finish(), settings: None }
}

/// A sphere about the origin, facing outward.
fn sphere(radius: f64, material: MaterialId) -> Patch {
    let rings = 24;
    let arc = |i: i32| DVec2::from_angle(PI * (f64::from(i) / f64::from(rings) - 0.5)) * radius;
    let profile: Vec<DVec2> = (0..=rings).map(arc).collect();
    lathe(&profile, 48, material)
}

/// Irradiance of the outer sphere, lux, after so many reflections.
pub fn outer_irradiance(bounces: Option<i32>) -> DVec3 {
    analytic::concentric_spheres(RADIANCE, RADII[0] / RADII[1], ALBEDO, bounces)
}

/// Irradiance of the inner sphere, lux, without a limit of reflections.
pub fn inner_irradiance() -> DVec3 {
    ALBEDO * outer_irradiance(None)
}
