//! A courtyard in sun and skylight: walls on three sides, one with an arched gate, steps and blocks.

use crate::SceneFiles;
use crate::build::{Content, Glb, Material, MaterialId, Opening, Patch, Place, cuboid, wall};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

const SETTINGS: &str = "\
// Late morning.
Bake(
    sky: (3200, 4300, 6000),
    sun: Sun(azimuth_deg: 140, elevation_deg: 48, lux: 75000, colour: (1, 0.96, 0.9), angular_diameter_deg: 0.53),
)
";
/// The gate in the far wall.
const GATE: Opening = Opening { centre: 1.0, half_width: 0.9, sill: 0.0, spring: 1.9 };
/// Width of the far wall and its height and thickness.
const FAR: [f64; 3] = [9.0, 4.0, 0.5];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let sand = glb.material("sand", Material::diffuse([0.52, 0.44, 0.33]));
    let plaster = glb.material("plaster", Material::diffuse([0.72, 0.68, 0.60]));
    let brick = glb.material("brick", Material::diffuse([0.45, 0.16, 0.10]));
    let ground = glb.lightmapped_mesh("ground", &[Patch::floor(12.0, sand)]);
    glb.node(None, "ground", Place::ORIGIN, Content::Mesh(ground));
    let far = glb.lightmapped_mesh("far wall", &far_wall(plaster));
    glb.node(None, "far wall", Place::at(0.0, 0.0, -3.5), Content::Mesh(far));
    for (name, low, high, material) in [
        ("left wall", DVec3::new(-5.0, 0.0, -4.0), DVec3::new(-4.5, 3.2, 3.0), brick),
        ("right wall", DVec3::new(4.5, 0.0, -4.0), DVec3::new(5.0, 2.4, 1.5), plaster),
        ("step", DVec3::new(-4.5, 0.0, -3.5), DVec3::new(-2.2, 0.3, -1.0), plaster),
        ("upper step", DVec3::new(-4.5, 0.3, -3.5), DVec3::new(-3.2, 0.6, -1.8), plaster),
    ] {
        let mesh = glb.lightmapped_mesh(name, &cuboid(low, high, material));
        glb.node(None, name, Place::ORIGIN, Content::Mesh(mesh));
    }
    let block = glb.lightmapped_mesh("block", &cuboid(DVec3::new(-0.6, 0.0, -0.6), DVec3::new(0.6, 1.2, 0.6), plaster));
    glb.node(None, "block", Place::at(2.2, 0.0, 0.3).turned_deg(33.0), Content::Mesh(block));
    glb.node(
        None,
        "small block",
        Place::at(-0.8, 0.0, 1.2).turned_deg(-20.0).scaled(0.5, 0.5, 0.5),
        Content::Mesh(block),
    );
    SceneFiles { name: "courtyard", glb: glb.finish(), settings: Some(SETTINGS) }
}

/// A wall with a gate, its near face in the plane z = 0.
fn far_wall(material: MaterialId) -> [Patch; 4] {
    let [width, height, thickness] = FAR;
    let sides = [-width / 2.0, width / 2.0];
    let face = |gate: Opening| wall(sides, 0.0, &sides.map(|s| DVec2::new(s, height)), &[gate], material);
    let back = face(Opening { centre: -GATE.centre, ..GATE })
        .moved(DAffine3::from_rotation_y(PI))
        .moved(DAffine3::from_translation(-DVec3::Z * thickness));
    let top = Patch::quad(DVec3::new(sides[0], height, 0.0), DVec3::X * width, -DVec3::Z * thickness, material);
    [face(GATE), back, top, GATE.reveal(thickness, true, material)]
}
