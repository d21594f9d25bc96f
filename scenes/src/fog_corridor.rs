//! A corridor with pillars under three spot lights, two of them coloured: to be baked in haze, where most of the floor sees
//! a lamp only through what the air scatters.

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, Place, cuboid, room};
use glam::DVec3;

/// Half angles of the spots: full intensity inside the first, none outside the second, radians.
const CONE: [f64; 2] = [0.25, 0.45];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let plaster = glb.material("plaster", Material::diffuse([0.6, 0.58, 0.55]));
    let stone = glb.material("stone", Material::diffuse([0.35, 0.35, 0.38]));
    let walls = glb.lightmapped_mesh("corridor", &room(DVec3::ZERO, DVec3::new(3.0, 3.0, 12.0), plaster));
    glb.node(None, "corridor", Place::ORIGIN, Content::Mesh(walls));
    let pillar = glb.lightmapped_mesh("pillar", &cuboid(DVec3::new(-0.2, 0.0, -0.2), DVec3::new(0.2, 3.0, 0.2), stone));
    for i in 0..8 {
        let (x, z) = (if i % 2 == 0 { 0.6 } else { 2.4 }, 1.5 + 3.0 * f64::from(i / 2));
        glb.node(
            None,
            &format!("pillar {i}"),
            Place::at(x, 0.0, z).turned_deg(10.0 * f64::from(i)),
            Content::Mesh(pillar),
        );
    }
    let [inner, outer] = CONE;
    for (name, intensity, at, aim) in [
        ("white spot", [300.0, 290.0, 260.0], DVec3::new(1.5, 2.9, 2.0), DVec3::new(1.5, 0.0, 3.5)),
        ("red spot", [240.0, 60.0, 40.0], DVec3::new(0.3, 2.7, 6.0), DVec3::new(2.6, 0.4, 6.5)),
        ("blue spot", [60.0, 90.0, 280.0], DVec3::new(1.5, 2.8, 11.5), DVec3::new(1.5, 1.0, 7.0)),
    ] {
        let light = glb.light(name, Light::Spot { intensity, inner, outer });
        glb.node(None, name, Place::at(at.x, at.y, at.z).looking_at(aim), Content::Light(light));
    }
    SceneFiles { name: "fog_corridor", glb: glb.finish(), settings: None }
}
