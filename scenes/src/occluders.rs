//! A black floor under a sun in the zenith, with black sheets between: blended, masked, transmitting, and a blended one
//! above another.

use crate::SceneFiles;
use crate::build::{Alpha, Content, Glb, Light, Material, Patch, Pixels, Place};
use glam::{DVec2, DVec3};

/// Illuminance from the sun, lux.
const LUX: DVec3 = DVec3::new(10_000.0, 9_000.0, 8_000.0);
/// Opacity of the blended sheets.
const ALPHA: [f64; 2] = [0.25, 0.6];
/// Share that the transmitting sheet lets through, and its colour.
const TRANSMISSION: (f64, DVec3) = (0.5, DVec3::new(0.8, 0.4, 0.2));
/// Texels across the mask.
const MASK: u32 = 4;
/// Centre of each sheet on the floor's plane; sheets are 1 m wide.
pub const SHEETS: [DVec2; 4] =
    [DVec2::new(-2.25, 0.0), DVec2::new(-0.75, 0.0), DVec2::new(0.75, 0.0), DVec2::new(2.25, 0.0)];

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let black = || Material::diffuse([0.0; 3]).double_sided();
    let checkers = glb.texture("checkers", &checkers());
    let floor = glb.material("floor", Material::diffuse([0.0; 3]));
    let thin = glb.material("thin", Material { alpha: Alpha::Blend(ALPHA[0]), ..black() });
    let dense = glb.material("dense", Material { alpha: Alpha::Blend(ALPHA[1]), ..black() });
    let mask = glb.material("mask", Material { alpha: Alpha::Mask(checkers), ..black() });
    let (transmission, colour) = TRANSMISSION;
    let glass = Material { albedo: colour.to_array(), transmission, ..black() };
    let glass = glb.material("glass", glass);

    let floor = glb.lightmapped_mesh("floor", &[Patch::floor(7.0, floor)]);
    glb.node(None, "floor", Place::ORIGIN, Content::Mesh(floor));
    for (name, material, height, centre) in [
        ("thin", thin, 0.5, SHEETS[0]),
        ("mask", mask, 0.5, SHEETS[1]),
        ("glass", glass, 0.5, SHEETS[2]),
        ("thin above dense", thin, 0.9, SHEETS[3]),
        ("dense", dense, 0.5, SHEETS[3]),
    ] {
        let sheet = glb.lightmapped_mesh(name, &[Patch::floor(1.0, material)]);
        glb.node(None, name, Place::at(centre.x, height, centre.y), Content::Mesh(sheet));
    }
    let sun = glb.light("sun", Light::Directional(LUX.to_array()));
    glb.node(None, "sun", Place::at(0.0, 5.0, 0.0).looking_at(DVec3::ZERO), Content::Light(sun));
    SceneFiles { name: "occluders", glb: glb.finish(), settings: None }
}

/// Opaque and clear texels by turns, the first one clear.
fn checkers() -> Pixels {
    let alpha = |i: u32| if is_clear(i % MASK, i / MASK) { 0 } else { 255 };
    Pixels { width: MASK, rgba: (0..MASK * MASK).map(|i| [255, 255, 255, alpha(i)]).collect() }
}

/// Whether a texel of the mask is a hole.
fn is_clear(x: u32, y: u32) -> bool {
    (x + y).is_multiple_of(2)
}

/// Direct irradiance of a floor point, lux; all there is but for the glass, whose lower side sees a black floor.
pub fn irradiance(point: DVec3) -> DVec3 {
    let inside = |sheet: DVec2| {
        let local = point.xz_plane() - sheet;
        (local.abs().max_element() < 0.5).then_some(local + 0.5)
    };
    let through = match SHEETS.map(inside) {
        [Some(_), ..] => DVec3::splat(1.0 - ALPHA[0]),
        [_, Some(local), ..] => {
            // u runs along +X, v along −Z from the near edge.
            let texel = |s: f64| (s * f64::from(MASK)) as u32;
            if is_clear(texel(local.x), texel(1.0 - local.y)) { DVec3::ONE } else { DVec3::ZERO }
        }
        [_, _, Some(_), _] => TRANSMISSION.0 * TRANSMISSION.1,
        [.., Some(_)] => DVec3::splat((1.0 - ALPHA[0]) * (1.0 - ALPHA[1])),
        [None, None, None, None] => DVec3::ONE,
    };
    LUX * through
}

/// The coordinates along the ground.
trait Ground {
    fn xz_plane(self) -> DVec2;
}

impl Ground for DVec3 {
    fn xz_plane(self) -> DVec2 {
        DVec2::new(self.x, self.z)
    }
}
