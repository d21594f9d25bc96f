//! A closed room lit by one spot light, aimed at a block; most surfaces see only what others reflect.

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, Place, cuboid, room};
use glam::DVec3;

/// Half angles of the spot: full intensity inside the first, none outside the second, radians.
const CONE: [f64; 2] = [0.35, 0.6];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let white = glb.material("white", Material::diffuse([0.75, 0.74, 0.70]));
    let wood = glb.material("wood", Material::diffuse([0.45, 0.28, 0.15]));
    let blue = glb.material("blue", Material::diffuse([0.10, 0.20, 0.55]));
    let size = DVec3::new(5.0, 2.8, 4.0);
    let walls = glb.lightmapped_mesh("room", &room(DVec3::ZERO, size, white));
    glb.node(None, "room", Place::ORIGIN, Content::Mesh(walls));
    for (name, size, material, place) in [
        ("table", DVec3::new(1.4, 0.75, 0.8), wood, Place::at(3.2, 0.0, 1.5).turned_deg(15.0)),
        ("shelf", DVec3::new(0.4, 1.9, 1.2), blue, Place::at(0.4, 0.0, 2.4)),
        ("crate", DVec3::new(0.5, 0.5, 0.5), white, Place::at(1.6, 0.0, 0.7).turned_deg(-35.0)),
    ] {
        let half = DVec3::new(size.x / 2.0, 0.0, size.z / 2.0);
        let mesh = glb.lightmapped_mesh(name, &cuboid(-half, half + DVec3::Y * size.y, material));
        glb.node(None, name, place, Content::Mesh(mesh));
    }
    let [inner, outer] = CONE;
    let spot = glb.light("spot", Light::Spot { intensity: [2400.0, 2100.0, 1600.0], inner, outer });
    let aim = Place::at(1.2, 2.6, 3.4).looking_at(DVec3::new(3.0, 0.6, 1.4));
    glb.node(None, "spot", aim, Content::Light(spot));
    SceneFiles { name: "spot_room", glb: glb.finish(), settings: None }
}
