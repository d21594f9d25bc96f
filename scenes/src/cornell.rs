//! A room like Cornell's box, 3 m wide, open in front: red and green side walls, two turned blocks, a ceiling lamp.
//!
//! All surfaces are single-sided and have their own lightmap coordinates. The blocks have no bottom and stand on the
//! floor, whose texels below them no light reaches.

use crate::SceneFiles;
use crate::build::{Content, Glb, Material, MaterialId, Patch, Place, cuboid};
use glam::{DVec2, DVec3};

/// Half the room's width and depth, metres.
const HALF: f64 = 1.5;
/// The room's height, metres.
const HEIGHT: f64 = 3.0;
/// Corners of the lamp as shares of the ceiling.
const LAMP: [DVec2; 2] = [DVec2::new(0.35, 0.375), DVec2::new(0.65, 0.625)];
/// Radiance of the lamp, cd/m².
const LAMP_RADIANCE: [f64; 3] = [3400.0, 2700.0, 1800.0];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let white = glb.material("white", Material::diffuse([0.73, 0.73, 0.73]));
    let red = glb.material("red", Material::diffuse([0.63, 0.065, 0.05]));
    let green = glb.material("green", Material::diffuse([0.14, 0.45, 0.091]));
    let lamp = glb.material("lamp", Material::emitter(LAMP_RADIANCE));

    let room = glb.lightmapped_mesh("room", &room(white, red, green));
    glb.node(None, "room", Place::ORIGIN, Content::Mesh(room));

    let (corner, x, z) = ceiling();
    let panel = Patch::quad(corner + x * LAMP[0].x + z * LAMP[0].y, x * size().x, z * size().y, lamp);
    let panel = glb.lightmapped_mesh("lamp", &[panel]);
    glb.node(None, "lamp", Place::ORIGIN, Content::Mesh(panel));

    let short = glb.lightmapped_mesh("short block", &block(DVec3::new(0.9, 0.9, 0.9), white));
    glb.node(None, "short block", Place::at(0.5, 0.0, 0.55).turned_deg(-17.0), Content::Mesh(short));
    let tall = glb.lightmapped_mesh("tall block", &block(DVec3::new(0.9, 1.8, 0.9), white));
    glb.node(None, "tall block", Place::at(-0.5, 0.0, -0.45).turned_deg(20.0), Content::Mesh(tall));

    let eye = Place::at(0.0, 1.5, 6.2).looking_at(DVec3::new(0.0, 1.5, 0.0));
    glb.node(None, "camera", eye, Content::Camera(38.0));
    SceneFiles { name: "cornell", glb: glb.finish(), settings: None }
}

/// Corner and edges of the ceiling, facing down.
fn ceiling() -> (DVec3, DVec3, DVec3) {
    (DVec3::new(-HALF, HEIGHT, -HALF), DVec3::X * 2.0 * HALF, DVec3::Z * 2.0 * HALF)
}

/// Size of the lamp as shares of the ceiling.
fn size() -> DVec2 {
    LAMP[1] - LAMP[0]
}

/// Floor, ceiling with a hole for the lamp, back, left and right wall.
fn room(white: MaterialId, red: MaterialId, green: MaterialId) -> [Patch; 5] {
    let low = DVec3::new(-HALF, 0.0, -HALF);
    let (x, y, z) = (DVec3::X * 2.0 * HALF, DVec3::Y * HEIGHT, DVec3::Z * 2.0 * HALF);
    let (corner, ceiling_x, ceiling_z) = ceiling();
    [
        Patch::quad(low + z, x, -z, white),
        Patch::quad_with_hole(corner, ceiling_x, ceiling_z, LAMP, white),
        Patch::quad(low, x, y, white),
        Patch::quad(low + z, -z, y, red),
        Patch::quad(low + x, z, y, green),
    ]
}

/// A block without bottom, standing on the origin.
fn block(size: DVec3, material: MaterialId) -> Vec<Patch> {
    let half = DVec3::new(size.x / 2.0, 0.0, size.z / 2.0);
    let [left, right, _, top, back, front] = cuboid(-half, half + DVec3::Y * size.y, material);
    vec![left, right, top, back, front]
}
