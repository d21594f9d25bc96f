//! A closed room of one albedo with blocks and a point light: the mean irradiance over all surfaces is known exactly,
//! whatever the shapes.

use crate::build::{Content, Glb, Light, Material, Place, cuboid, room};
use crate::{SceneFiles, analytic};
use glam::DVec3;
use std::f64::consts::PI;

/// The surfaces' albedo.
pub const ALBEDO: DVec3 = DVec3::new(0.3, 0.6, 0.8);
/// The light's intensity, cd.
const INTENSITY: DVec3 = DVec3::new(300.0, 300.0, 200.0);
/// The room's edges, metres.
const ROOM: DVec3 = DVec3::new(4.0, 2.5, 3.0);
/// The floating blocks' edges, metres, and centres.
const BLOCKS: [(DVec3, DVec3); 2] = [
    (DVec3::new(0.6, 1.2, 0.6), DVec3::new(-0.9, -0.3, 0.2)),
    (DVec3::new(1.0, 0.4, 0.8), DVec3::new(0.8, -0.5, -0.4)),
];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let paint = glb.material("paint", Material::diffuse(ALBEDO.to_array()));
    let walls = glb.lightmapped_mesh("room", &room(-ROOM / 2.0, ROOM / 2.0, paint));
    glb.node(None, "room", Place::ORIGIN, Content::Mesh(walls));
    for (i, (size, centre)) in BLOCKS.into_iter().enumerate() {
        let name = format!("block {i}");
        let block = glb.lightmapped_mesh(&name, &cuboid(-size / 2.0, size / 2.0, paint));
        glb.node(None, &name, Place::at(centre.x, centre.y, centre.z).turned_deg(25.0), Content::Mesh(block));
    }
    let lamp = glb.light("lamp", Light::Point(INTENSITY.to_array()));
    glb.node(None, "lamp", Place::at(0.4, 0.7, 0.5), Content::Light(lamp));
    SceneFiles { name: "lit_room", glb: glb.finish(), settings: None }
}

/// Mean irradiance over all surfaces, lux, after so many reflections.
pub fn mean_irradiance(bounces: Option<i32>) -> DVec3 {
    let box_area = |edges: DVec3| 2.0 * (edges.x * edges.y + edges.y * edges.z + edges.z * edges.x);
    let area = box_area(ROOM) + BLOCKS.iter().map(|(edges, _)| box_area(*edges)).sum::<f64>();
    analytic::closed_room_mean(4.0 * PI * INTENSITY, area, ALBEDO, bounces)
}
