//! Small scenes of our own, each made by code: `cargo run -p scenes` writes `scenes/*.glb` and their settings,
//! `cargo run -p scenes -- --check` (and a test) holds the committed files to the same bytes.
//!
//! A scene is one file with one function that builds it. Where light in it has a closed form, the same file has a
//! function that returns it, made from the formulas in [`analytic`]. Axes, units and colours are glTF's: metres,
//! Y up, counter-clockwise front faces, linear Rec.709, lights in candela, lux and cd/m².

use std::path::{Path, PathBuf};

pub mod analytic;
pub mod build;
pub mod cornell;
pub mod courtyard;
pub mod fog_corridor;
pub mod fog_room;
pub mod fog_yard;
pub mod furnace;
pub mod hall;
pub mod instances;
pub mod lit_room;
pub mod occluders;
pub mod plane_point;
pub mod plane_rect;
pub mod plane_sky;
pub mod plane_sun;
pub mod sealed_room;
pub mod spheres;
pub mod spot_room;
pub mod thin_wall;

/// The files of one scene.
pub struct SceneFiles {
    /// Stem of the files' names.
    pub name: &'static str,
    /// Content of `NAME.glb`.
    pub glb: Vec<u8>,
    /// Content of `NAME.bake.ron`, where the scene needs settings.
    pub settings: Option<&'static str>,
}

impl SceneFiles {
    /// Each file's name with its content.
    pub fn files(&self) -> Vec<(String, &[u8])> {
        let mut files = vec![(format!("{}.glb", self.name), self.glb.as_slice())];
        files.extend(self.settings.map(|text| (format!("{}.bake.ron", self.name), text.as_bytes())));
        files
    }
}

/// Every scene, freshly built.
pub fn all() -> Vec<SceneFiles> {
    vec![
        cornell::scene(),
        courtyard::scene(),
        fog_corridor::scene(),
        fog_room::with_lamp(),
        fog_room::with_point(),
        fog_yard::at_night(),
        fog_yard::by_day(),
        furnace::scene(),
        hall::scene(),
        instances::scene(),
        lit_room::scene(),
        occluders::scene(),
        plane_point::scene(),
        plane_rect::scene(),
        plane_sky::scene(),
        plane_sun::scene(),
        sealed_room::scene(),
        spheres::scene(),
        spot_room::scene(),
        thin_wall::scene(),
    ]
}

/// The folder of the committed files.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}
