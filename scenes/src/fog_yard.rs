//! Ground of 20 m with two walls and a block, under a sun or beside a lamp at night: to be baked in fog, for which
//! independent truth exists.

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, Place, cuboid};
use glam::DVec3;

/// By day: 4 lux from 45 degrees above the horizon.
pub fn by_day() -> SceneFiles {
    let mut glb = yard();
    let sun = glb.light("sun", Light::Directional([4.0; 3]));
    let (azimuth, elevation) = (30f64.to_radians(), 45f64.to_radians());
    let towards = DVec3::new(-elevation.cos() * azimuth.cos(), elevation.sin(), elevation.cos() * azimuth.sin());
    let from = Place { translation: towards, ..Place::ORIGIN }.looking_at(DVec3::ZERO);
    glb.node(None, "sun", from, Content::Light(sun));
    SceneFiles { name: "fog_yard_day", glb: glb.finish(), settings: None }
}

/// At night: a lamp of 100 cd, 2 m above the ground.
pub fn at_night() -> SceneFiles {
    let mut glb = yard();
    let lamp = glb.light("lamp", Light::Point([100.0; 3]));
    glb.node(None, "lamp", Place::at(-1.0, 2.0, -1.0), Content::Light(lamp));
    SceneFiles { name: "fog_yard_night", glb: glb.finish(), settings: None }
}

fn yard() -> Glb {
    let mut glb = Glb::new();
    let ground = glb.material("ground", Material::diffuse([0.4; 3]));
    let wall = glb.material("wall", Material::diffuse([0.5; 3]));
    for (name, min, max, material) in [
        ("ground", DVec3::new(-10.0, -1.0, -10.0), DVec3::new(10.0, 0.0, 10.0), ground),
        ("left wall", DVec3::new(-5.0, 0.0, -5.0), DVec3::new(-4.0, 4.0, 5.0), wall),
        ("far wall", DVec3::new(-4.0, 0.0, -5.0), DVec3::new(5.0, 3.0, -4.0), wall),
        ("block", DVec3::new(1.0, 0.0, 1.0), DVec3::new(3.5, 2.5, 3.5), wall),
    ] {
        let mesh = glb.lightmapped_mesh(name, &cuboid(min, max, material));
        glb.node(None, name, Place::ORIGIN, Content::Mesh(mesh));
    }
    glb
}
