//! A closed, turned room without light in bright sun and sky, on lit ground: inside it is exactly dark.

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, Material, Patch, Place, room};
use glam::{DQuat, DVec3, EulerRot};

const SETTINGS: &str = "Bake(sky: Some((5000, 6000, 8000)))\n";

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let white = glb.material("white", Material::diffuse([0.8; 3]));
    let walls = glb.lightmapped_mesh("room", &room(DVec3::new(-1.5, -1.0, -1.0), DVec3::new(1.5, 1.0, 1.0), white));
    let rotation = DQuat::from_euler(EulerRot::YXZ, 0.5, 0.3, 0.2);
    glb.node(None, "room", Place { rotation, ..Place::at(0.0, 2.0, 0.0) }, Content::Mesh(walls));
    let ground = glb.lightmapped_mesh("ground", &[Patch::floor(6.0, white)]);
    glb.node(None, "ground", Place::ORIGIN, Content::Mesh(ground));
    let sun = glb.light("sun", Light::Directional([90_000.0, 85_000.0, 80_000.0]));
    glb.node(None, "sun", Place::at(2.0, 5.0, 3.0).looking_at(DVec3::ZERO), Content::Light(sun));
    SceneFiles { name: "sealed_room", glb: glb.finish(), settings: Some(SETTINGS) }
}
