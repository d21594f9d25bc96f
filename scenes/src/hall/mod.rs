//! A vaulted hall in evening sun, 12.8 m wide and 20.4 m long: the picture of the README.
//!
//! Six bays of arcade and windows on each side, one set of meshes placed twelve times, the left side by a mirrored
//! parent. Coordinates: the nave runs from z = 0 to −[`LENGTH`], x = 0 is its axis. Surfaces are single-sided and face
//! the inside; the mesh has no lightmap coordinates, so that the baker makes them.

mod furnishing;
mod masonry;

use crate::SceneFiles;
use crate::build::{Content, Glb, Light, LightId, Material, MaterialId, MeshId, NodeId, Place};
use glam::DVec3;

/// Length of a bay along the nave, metres.
const BAY: f64 = 3.4;
/// Bays on each side.
const BAYS: u32 = 6;
/// Length of the hall.
const LENGTH: f64 = BAY * BAYS as f64;
/// Half the clear width of the nave, the radius of its vault.
const NAVE: f64 = 3.2;
/// Thickness of the walls on the arcades.
const WALL: f64 = 0.6;
/// Half the clear width of nave and aisles.
const AISLE: f64 = 6.4;
/// Height of the columns, where the arches begin.
const COLUMN: f64 = 3.2;
/// Height of the aisles' ceiling.
const AISLE_CEILING: f64 = 4.9;
/// Height at which the vault begins.
const VAULT: f64 = 6.5;
/// Intensity of a chandelier's point light (eight lamps of 800 lm), cd.
const CHANDELIER: [f64; 3] = [520.0, 400.0, 250.0];
/// Intensity of an aisle lamp's spot on its axis, cd.
const PENDANT: [f64; 3] = [900.0, 640.0, 360.0];

const SETTINGS: &str = "\
// Evening: a low sun through the right-hand windows, and the sky's blue. Coarse, so that it bakes in minutes on two cores.
Bake(
    texels_per_m: 8,
    samples: 512,
    sky: (1000, 1350, 2100),
    sun: Sun(azimuth_deg: 78, elevation_deg: 22, lux: 38000, colour: (1, 0.76, 0.5), angular_diameter_deg: 0.53),
)
";

/// What things are made of.
struct Materials {
    plaster: MaterialId,
    stone: MaterialId,
    vault: MaterialId,
    tiles: [MaterialId; 2],
    carpet: MaterialId,
    wood: MaterialId,
    bronze: MaterialId,
    bulb: MaterialId,
    cloths: [MaterialId; 2],
    clay: MaterialId,
}

impl Materials {
    fn new(glb: &mut Glb) -> Self {
        let mut paint = |name, albedo| glb.material(name, Material::diffuse(albedo));
        Self {
            plaster: paint("plaster", [0.64, 0.57, 0.47]),
            stone: paint("stone", [0.52, 0.47, 0.40]),
            vault: paint("vault", [0.60, 0.58, 0.54]),
            tiles: [paint("light tile", [0.54, 0.48, 0.40]), paint("dark tile", [0.20, 0.15, 0.12])],
            carpet: paint("carpet", [0.42, 0.04, 0.035]),
            wood: paint("wood", [0.32, 0.18, 0.09]),
            clay: paint("clay", [0.58, 0.27, 0.14]),
            bronze: glb.material("bronze", Material::diffuse([0.20, 0.14, 0.08]).double_sided()),
            bulb: glb.material("bulb", Material::emitter([6000.0, 4600.0, 2900.0])),
            cloths: [[0.08, 0.14, 0.42], [0.55, 0.33, 0.05]]
                .map(|albedo| glb.material("cloth", Material::diffuse(albedo).double_sided())),
        }
    }
}

/// Builds the scene.
pub fn scene() -> SceneFiles {
    let mut glb = Glb::new();
    let materials = Materials::new(&mut glb);
    add_shell(&mut glb, &materials);
    add_sides(&mut glb, &materials);
    add_furnishing(&mut glb, &materials);
    add_chandeliers(&mut glb, &materials);
    let eye = Place::at(1.5, 2.1, -0.4).looking_at(DVec3::new(-0.55, 2.75, -10.0));
    glb.node(None, "camera", eye, Content::Camera(58.0));
    SceneFiles { name: "hall", glb: glb.finish(), settings: Some(SETTINGS) }
}

/// Floor, end walls, vault and its ribs.
fn add_shell(glb: &mut Glb, materials: &Materials) {
    let floor = glb.mesh("floor", &[masonry::floor(materials)]);
    glb.node(None, "floor", Place::ORIGIN, Content::Mesh(floor));
    let far = glb.mesh("far wall", &masonry::end_wall(Some(masonry::FAR_WINDOW), materials));
    glb.node(None, "far wall", Place::at(0.0, 0.0, -LENGTH), Content::Mesh(far));
    let near = glb.mesh("near wall", &masonry::end_wall(None, materials));
    glb.node(None, "near wall", Place::ORIGIN.turned_deg(180.0), Content::Mesh(near));
    let vault = glb.mesh("vault", &[masonry::vault(materials)]);
    let rib = glb.mesh("rib", &masonry::rib(materials));
    for i in 0..BAYS {
        let z = -BAY * f64::from(i);
        glb.node(None, &format!("vault {i}"), Place::at(0.0, 0.0, z), Content::Mesh(vault));
        if i > 0 {
            glb.node(None, &format!("rib {i}"), Place::at(0.0, 0.0, z), Content::Mesh(rib));
        }
    }
}

/// Arcades, outer walls and what belongs to one side, right and mirrored left.
fn add_sides(glb: &mut Glb, materials: &Materials) {
    let arcade = glb.mesh("arcade", &masonry::arcade(materials));
    let outer = glb.mesh("outer wall", &masonry::outer_wall(materials));
    let column = glb.mesh("column", &masonry::column(materials));
    let pilaster = glb.mesh("pilaster", &masonry::pilaster(materials));
    let cornice = glb.mesh("cornices", &masonry::cornices(materials));
    let pendant = glb.mesh("pendant", &furnishing::pendant(materials));
    let spot = glb.light("pendant", Light::Spot { intensity: PENDANT, inner: 0.5, outer: 0.95 });
    let banners = materials.cloths.map(|cloth| glb.mesh("banner", &[furnishing::banner(cloth)]));
    for (name, mirror) in [("right", 1.0), ("left", -1.0)] {
        let side = glb.node(None, name, Place::ORIGIN.scaled(mirror, 1.0, 1.0), Content::Group);
        let mut add = |name: &str, place: Place, content| glb.node(Some(side), name, place, content);
        add("cornices", Place::ORIGIN, Content::Mesh(cornice));
        for i in 0..BAYS {
            let z = -BAY * (f64::from(i) + 0.5);
            add(&format!("arcade {i}"), Place::at(NAVE, 0.0, z).turned_deg(-90.0), Content::Mesh(arcade));
            add(&format!("outer wall {i}"), Place::at(AISLE, 0.0, z).turned_deg(-90.0), Content::Mesh(outer));
        }
        for i in 1..BAYS {
            let z = -BAY * f64::from(i);
            add(&format!("column {i}"), Place::at(NAVE + WALL / 2.0, 0.0, z), Content::Mesh(column));
            let banner = banners[(i % 2) as usize];
            add(&format!("banner {i}"), Place::at(NAVE - 0.2, 0.0, z), Content::Mesh(banner));
        }
        for (name, z) in [("near pilaster", -0.175), ("far pilaster", 0.175 - LENGTH)] {
            add(name, Place::at(NAVE + WALL / 2.0, 0.0, z), Content::Mesh(pilaster));
        }
        add_pendants(glb, side, pendant, spot);
    }
}

/// Lamps in every second bay of an aisle.
fn add_pendants(glb: &mut Glb, side: NodeId, mesh: MeshId, light: LightId) {
    for i in (0..BAYS).step_by(2) {
        let place = Place::at(5.1, 3.3, -BAY * (f64::from(i) + 0.5));
        let lamp = glb.node(Some(side), &format!("pendant {i}"), place, Content::Mesh(mesh));
        let down = Place::at(0.0, -0.02, 0.0).looking_at(DVec3::NEG_Y);
        glb.node(Some(lamp), "light", down, Content::Light(light));
    }
}

/// Benches, the dais with its urn, and things that stand about.
fn add_furnishing(glb: &mut Glb, materials: &Materials) {
    let bench = glb.mesh("bench", &furnishing::bench(materials));
    for row in 0..4 {
        let z = -9.4 - 1.7 * f64::from(row);
        for (side, x) in [("right", 1.95), ("left", -1.95)] {
            glb.node(None, &format!("bench {row} {side}"), Place::at(x, 0.0, z), Content::Mesh(bench));
        }
    }
    let dais = glb.mesh("dais", &furnishing::dais(materials));
    glb.node(None, "dais", Place::at(0.0, 0.0, -LENGTH), Content::Mesh(dais));
    let urn = glb.mesh("urn", &[furnishing::urn(materials)]);
    let ball = glb.mesh("ball", &[furnishing::ball(materials)]);
    let block = glb.mesh("block", &furnishing::block(materials));
    let mut add =
        |name: &str, place: Place, mesh: MeshId| -> NodeId { glb.node(None, name, place, Content::Mesh(mesh)) };
    add("urn on the dais", Place::at(0.0, 1.06, -19.0), urn);
    add("urn", Place::at(-2.3, 0.0, -5.3), urn);
    add("ball", Place::at(-1.3, 0.38, -4.3), ball);
    add("block", Place::at(2.3, 0.0, -5.6).turned_deg(24.0), block);
    add("block on top", Place::at(2.28, 0.55, -5.58).turned_deg(-8.0).scaled(0.6, 0.6, 0.6), block);
}

/// Chandeliers on the nave's axis.
fn add_chandeliers(glb: &mut Glb, materials: &Materials) {
    let chandelier = glb.mesh("chandelier", &furnishing::chandelier(materials));
    let light = glb.light("chandelier", Light::Point(CHANDELIER));
    for i in [1, 3, 5] {
        let place = Place::at(0.0, furnishing::CHANDELIER_HEIGHT, -BAY * (f64::from(i) + 0.5));
        let lamp = glb.node(None, &format!("chandelier {i}"), place, Content::Mesh(chandelier));
        glb.node(Some(lamp), "light", Place::ORIGIN, Content::Light(light));
    }
}
