//! A floor and a ramp under the sun, which is a directional light of the file. The ramp is black and one-sided, its
//! underside shadows the floor.

use crate::build::{Content, Glb, Light, Material, Patch, Place};
use crate::{SceneFiles, analytic};
use glam::DVec3;

/// Illuminance across the sun's rays, lux.
const LUX: [f64; 3] = [80_000.0, 76_000.0, 70_000.0];
/// Towards the sun, not normalised.
const TO_SUN: DVec3 = DVec3::new(1.0, 2.0, 0.5);
/// The ramp's lowest corner and edges.
const RAMP: [DVec3; 3] = [DVec3::new(-0.5, 0.2, 0.5), DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.6, -1.0)];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let grey = glb.material("grey", Material::diffuse([0.5; 3]));
    let black = glb.material("black", Material::diffuse([0.0; 3]));
    let floor = glb.lightmapped_mesh("floor", &[Patch::floor(4.0, grey)]);
    glb.node(None, "floor", Place::ORIGIN, Content::Mesh(floor));
    let [corner, u, v] = RAMP;
    let ramp = glb.lightmapped_mesh("ramp", &[Patch::quad(corner, u, v, black)]);
    glb.node(None, "ramp", Place::ORIGIN, Content::Mesh(ramp));
    let sun = glb.light("sun", Light::Directional(LUX));
    let place = Place::at(TO_SUN.x, TO_SUN.y, TO_SUN.z).looking_at(DVec3::ZERO);
    glb.node(None, "sun", place, Content::Light(sun));
    SceneFiles { name: "plane_sun", glb: glb.finish(), settings: None }
}

/// Irradiance of a floor point, lux. The ramp reflects nothing, so its shadow is black.
pub fn irradiance(point: DVec3) -> DVec3 {
    let [corner, u, v] = RAMP;
    let normal = u.cross(v);
    let hit = point + TO_SUN * ((corner - point).dot(normal) / TO_SUN.dot(normal));
    let along = |edge: DVec3| (hit - corner).dot(edge) / edge.length_squared();
    let shadowed = (0.0..=1.0).contains(&along(u)) && (0.0..=1.0).contains(&along(v));
    if shadowed { DVec3::ZERO } else { analytic::sun(LUX.into(), TO_SUN.normalize(), DVec3::Y) }
}

/// Irradiance of the ramp's upper side, lux, from the sun alone: the floor lies below its horizon only in part, so the
/// `direct` term is what this is.
pub fn ramp_direct() -> DVec3 {
    analytic::sun(LUX.into(), TO_SUN.normalize(), RAMP[1].cross(RAMP[2]).normalize())
}
