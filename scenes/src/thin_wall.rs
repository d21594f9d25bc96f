//! Two rooms on one floor, 2 cm of wall between them, a lamp in the left one: the right one is exactly dark.

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, Place, cuboid, room};
use glam::DVec3;

/// The wall lies between these x, metres; the dark room right of it.
pub const WALL: [f64; 2] = [0.13, 0.15];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let white = glb.material("white", Material::diffuse([0.8; 3]));
    let half = DVec3::new(2.0, 1.2, 1.5);
    let shell = glb.lightmapped_mesh("rooms", &room(-half, half, white));
    glb.node(None, "rooms", Place::ORIGIN, Content::Mesh(shell));
    let [left, right, ..] = cuboid(DVec3 { x: WALL[0], ..-half }, DVec3 { x: WALL[1], ..half }, white);
    let wall = glb.lightmapped_mesh("wall", &[left, right]);
    glb.node(None, "wall", Place::ORIGIN, Content::Mesh(wall));
    let lamp = glb.light("lamp", Light::Point([2000.0; 3]));
    glb.node(None, "lamp", Place::at(-0.6, 0.7, 0.2), Content::Light(lamp));
    SceneFiles { name: "thin_wall", glb: glb.finish(), settings: None }
}
