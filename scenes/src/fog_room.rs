//! A closed cube of 1 m with walls of different albedo, lit by a point light or by a square lamp in its ceiling: to be
//! baked in fog, for which independent truth exists.

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, MaterialId, Patch, Place};
use glam::{DVec2, DVec3};

/// Albedo of the walls −x, +x, +z, −z, floor and ceiling.
const ALBEDO: [f64; 6] = [0.3, 0.7, 0.5, 0.5, 0.4, 0.6];
/// Radiance of the lamp, cd/m².
const RADIANCE: f64 = 10.0;
/// The lamp in the ceiling, shares of its sides.
const LAMP: [DVec2; 2] = [DVec2::splat(0.35), DVec2::splat(0.65)];

/// With a point light of 1 cd.
pub fn with_point() -> SceneFiles {
    let mut glb = Glb::new();
    let ceiling = |material| vec![Patch::quad(DVec3::Y, DVec3::X, -DVec3::Z, material).flipped()];
    add_room(&mut glb, ceiling);
    let light = glb.light("point", Light::Point([1.0; 3]));
    glb.node(None, "point", Place::at(0.45, 0.7, -0.4), Content::Light(light));
    SceneFiles { name: "fog_room_point", glb: glb.finish(), settings: None }
}

/// With a lamp that glows with 10 cd/m² and reflects as the ceiling around it does.
pub fn with_lamp() -> SceneFiles {
    let mut glb = Glb::new();
    let albedo = [ALBEDO[5]; 3];
    let glow = glb.material("lamp", Material { emission: [RADIANCE; 3], ..Material::diffuse(albedo) });
    add_room(&mut glb, |material| {
        let lamp = Patch::quad(DVec3::new(LAMP[0].x, 1.0, -LAMP[0].y), DVec3::X * 0.3, -DVec3::Z * 0.3, glow);
        vec![Patch::quad_with_hole(DVec3::Y, DVec3::X, -DVec3::Z, LAMP, material).flipped(), lamp.flipped()]
    });
    SceneFiles { name: "fog_room_lamp", glb: glb.finish(), settings: None }
}

/// The cube from (0, 0, −1) to (1, 1, 0).
fn add_room(glb: &mut Glb, ceiling: impl Fn(MaterialId) -> Vec<Patch>) {
    let names = ["left", "right", "front", "back", "floor", "ceiling"];
    let materials = [0, 1, 2, 3, 4, 5].map(|i| glb.material(names[i], Material::diffuse([ALBEDO[i]; 3])));
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut patches = vec![
        Patch::quad(DVec3::ZERO, -z, y, materials[0]),
        Patch::quad(x, y, -z, materials[1]),
        Patch::quad(DVec3::ZERO, y, x, materials[2]),
        Patch::quad(-z, x, y, materials[3]),
        Patch::quad(DVec3::ZERO, x, -z, materials[4]),
    ];
    patches.extend(ceiling(materials[5]));
    let mesh = glb.lightmapped_mesh("room", &patches);
    glb.node(None, "room", Place::ORIGIN, Content::Mesh(mesh));
}
