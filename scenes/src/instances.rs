//! One mesh placed four times, mirrored by its own node, by its parent, and by both, around a point light: irradiance
//! is the same at (±x, y, ±z).

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, Patch, Place};
use glam::DVec3;

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let white = glb.material("white", Material::diffuse([0.7, 0.7, 0.7]));
    let red = glb.material("red", Material::diffuse([0.7, 0.1, 0.05]));
    let blue = glb.material("blue", Material::diffuse([0.05, 0.15, 0.6]));
    // A corner with walls of unequal height and colour, and a low step.
    let low = DVec3::new(0.0, 0.0, 0.0);
    let patches = [
        Patch::quad(low + DVec3::Z, DVec3::X, -DVec3::Z, white),
        Patch::quad(low, DVec3::X, DVec3::Y * 0.8, red),
        Patch::quad(low + DVec3::X, DVec3::Z, DVec3::Y * 1.2, blue),
        Patch::quad(DVec3::new(0.2, 0.2, 0.4), DVec3::X * 0.3, DVec3::Z * -0.2, white),
        Patch::quad(DVec3::new(0.2, 0.0, 0.4), DVec3::X * 0.3, DVec3::Y * 0.2, white),
        Patch::quad(DVec3::new(0.2, 0.0, 0.2), DVec3::Z * 0.2, DVec3::Y * 0.2, white),
    ];
    let corner = glb.lightmapped_mesh("corner", &patches);
    let groups = [("near", Place::ORIGIN), ("far", Place::ORIGIN.scaled(1.0, 1.0, -1.0))];
    for (group, place) in groups {
        let parent = glb.node(None, group, place, Content::Group);
        let right = Place::at(0.5, 0.0, 0.5);
        glb.node(Some(parent), "right", right, Content::Mesh(corner));
        let left = Place::at(-0.5, 0.0, 0.5).scaled(-1.0, 1.0, 1.0);
        glb.node(Some(parent), "left", left, Content::Mesh(corner));
    }
    let lamp = glb.light("lamp", Light::Point([100.0; 3]));
    glb.node(None, "lamp", Place::at(0.0, 1.0, 0.0), Content::Light(lamp));
    SceneFiles { name: "instances", glb: glb.finish(), settings: None }
}
