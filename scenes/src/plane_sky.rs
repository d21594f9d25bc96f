//! A floor under a uniform sky, with a black wall that covers part of it.

use crate::build::{Content, Glb, Material, Patch, Place};
use crate::{SceneFiles, analytic};
use glam::DVec3;
use std::f64::consts::PI;

/// Radiance of the sky, cd/m²; the settings repeat it.
const SKY: DVec3 = DVec3::new(1000.0, 2000.0, 3000.0);
const SETTINGS: &str = "Bake(sky: Some((1000, 2000, 3000)))\n";
/// The wall's lower corner, its edges along the floor and upwards.
const WALL: [DVec3; 3] = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.0, 1.5, 0.0)];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let grey = glb.material("grey", Material::diffuse([0.5; 3]));
    let black = glb.material("black", Material::diffuse([0.0; 3]).double_sided());
    let floor = glb.lightmapped_mesh("floor", &[Patch::floor(4.0, grey)]);
    glb.node(None, "floor", Place::ORIGIN, Content::Mesh(floor));
    let [corner, u, v] = WALL;
    let wall = glb.lightmapped_mesh("wall", &[Patch::quad(corner, u, v, black)]);
    glb.node(None, "wall", Place::ORIGIN, Content::Mesh(wall));
    SceneFiles { name: "plane_sky", glb: glb.finish(), settings: Some(SETTINGS) }
}

/// Irradiance of a floor point, lux: E = πL (1 − F), F the wall's form factor from the side the point is on.
pub fn irradiance(point: DVec3) -> DVec3 {
    let [corner, u, v] = WALL;
    let front = [corner, corner + u, corner + u + v, corner + v];
    let mut back = front;
    back.reverse();
    let covered = [front, back].map(|wall| analytic::form_factor(&wall, point, DVec3::Y));
    PI * SKY * (1.0 - covered[0] - covered[1])
}
