//! A floor under a point light.

use crate::build::{Content, Glb, Light, Material, Patch, Place};
use crate::{SceneFiles, analytic};
use glam::DVec3;

/// The light's intensity, cd.
const INTENSITY: [f64; 3] = [400.0, 300.0, 200.0];
/// Where the light is.
const LIGHT: DVec3 = DVec3::new(0.3, 1.5, -0.2);

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let grey = glb.material("grey", Material::diffuse([0.5; 3]));
    let floor = glb.lightmapped_mesh("floor", &[Patch::floor(4.0, grey)]);
    glb.node(None, "floor", Place::ORIGIN, Content::Mesh(floor));
    let lamp = glb.light("lamp", Light::Point(INTENSITY));
    glb.node(None, "lamp", Place::at(LIGHT.x, LIGHT.y, LIGHT.z), Content::Light(lamp));
    SceneFiles { name: "plane_point", glb: glb.finish(), settings: None }
}

/// Irradiance of a floor point, lux.
pub fn irradiance(point: DVec3) -> DVec3 {
    analytic::point_light(INTENSITY.into(), LIGHT, point, DVec3::Y)
}
