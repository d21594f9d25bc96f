//! A closed room with a block floating in it, where every surface emits ε cd/m² and reflects ρ = 1 − ε: radiance is 1
//! everywhere.

use crate::build::{Content, Glb, Material, Place, cuboid, room};
use crate::{SceneFiles, analytic};
use glam::DVec3;
use std::f64::consts::PI;

/// The surfaces' albedo ρ, another one in each channel.
pub const ALBEDO: DVec3 = DVec3::new(0.2, 0.5, 0.9);

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let emission = (1.0 - ALBEDO).to_array();
    let glowing = glb.material("glowing", Material { emission, ..Material::diffuse(ALBEDO.to_array()) });
    let half = DVec3::new(1.5, 1.2, 1.0);
    let walls = glb.lightmapped_mesh("room", &room(-half, half, glowing));
    glb.node(None, "room", Place::at(3.0, -2.0, 1.0).turned_deg(27.0), Content::Mesh(walls));
    let half = DVec3::new(0.3, 0.5, 0.4);
    let block = glb.lightmapped_mesh("block", &cuboid(-half, half, glowing));
    glb.node(None, "block", Place::at(3.3, -2.2, 0.9).turned_deg(-40.0), Content::Mesh(block));
    SceneFiles { name: "furnace", glb: glb.finish(), settings: None }
}

/// Irradiance everywhere, lux, after so many reflections: E = π ε Σ ρ^i = π (1 − ρ^(bounces + 1)); π without a limit.
pub fn irradiance(bounces: Option<i32>) -> DVec3 {
    PI * (1.0 - ALBEDO) * analytic::bounce_sum(ALBEDO, bounces)
}
