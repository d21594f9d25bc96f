//! A floor under a tilted rectangular lamp, whose back part of the floor sees.

use crate::build::{Content, Glb, Material, Patch, Place};
use crate::{SceneFiles, analytic};
use glam::DVec3;
use std::f64::consts::PI;

/// Radiance of the lamp, cd/m².
const RADIANCE: DVec3 = DVec3::new(900.0, 700.0, 500.0);
/// The lamp's corner and edges; its front faces down and towards +X.
const LAMP: [DVec3; 3] = [DVec3::new(-0.4, 0.8, -0.5), DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.0, 1.2)];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let grey = glb.material("grey", Material::diffuse([0.5; 3]));
    let lamp = glb.material("lamp", Material::emitter(RADIANCE.to_array()));
    let floor = glb.lightmapped_mesh("floor", &[Patch::floor(4.0, grey)]);
    glb.node(None, "floor", Place::ORIGIN, Content::Mesh(floor));
    let [corner, u, v] = LAMP;
    let panel = glb.lightmapped_mesh("lamp", &[Patch::quad(corner, u, v, lamp)]);
    glb.node(None, "lamp", Place::ORIGIN, Content::Mesh(panel));
    SceneFiles { name: "plane_rect", glb: glb.finish(), settings: None }
}

/// Irradiance of a floor point, lux: E = πL F; the lamp reflects nothing back.
pub fn irradiance(point: DVec3) -> DVec3 {
    let [corner, u, v] = LAMP;
    let front = [corner, corner + u, corner + u + v, corner + v];
    PI * RADIANCE * analytic::form_factor(&front, point, DVec3::Y)
}
