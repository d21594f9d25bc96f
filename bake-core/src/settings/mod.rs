//! What the user may decide about a bake: the record `Bake(...)` of a `.bake.ron` file.
//!
//! A file states only what differs from the default; flags of the command line are laid over it afterwards and
//! [`Settings::check`] judges the result. Keys with a unit carry it in their name, all others are named with their
//! unit below. What a key means to the scene, the atlas or the solver is theirs to say.

mod check;
mod effect;
mod error;
mod file;
mod media;
mod stages;
mod template;

pub use effect::EffectName;
pub use error::{SettingsError, Syntax, suggest};
pub(crate) use file::media_of_scene;
pub use file::{from_json, read, sidecar};
pub use media::{Bounds, Density, Medium, Phase, Place, Scatter, Values};
pub use template::TEMPLATE;

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Linear Rec.709 triple, or one value per channel.
pub type Rgb = [f32; 3];

/// Everything that can be set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Bake", default, deny_unknown_fields)]
pub struct Settings {
    /// Preset of accuracy.
    pub quality: Quality,
    /// Standard error to reach, as a share of the page's median; overrides the preset's.
    pub target_error: Option<f32>,
    /// Samples per texel, exactly; overrides any target.
    pub samples: Option<u32>,
    /// Reflections followed; unlimited under Russian roulette when absent, 0 is direct light only.
    pub bounces: Option<u32>,
    /// Seed of all random numbers.
    pub seed: u32,
    /// Seconds after which sampling ends, whatever the error; such bakes do not repeat bit for bit.
    pub time_budget: Option<f64>,

    /// Lightmap texels per metre of surface.
    pub texels_per_m: f32,
    /// Width and height of a page, texels.
    pub page_size: u32,
    /// At most so many pages; the density is scaled down until all fits.
    pub max_pages: Option<u32>,
    /// Texels between charts.
    pub padding: u32,

    /// The glTF scene to bake, by name or number; the file's default when absent.
    pub scene: Option<String>,
    /// Radiance from every direction that meets nothing, cd/m².
    pub sky: Option<Rgb>,
    /// A sun.
    pub sun: Option<Sun>,
    /// An environment image.
    pub env: Option<Env>,
    /// Unit of the file's light intensities.
    pub light_units: LightUnits,
    /// Factor on the file's lights, after the conversion of units.
    pub light_scale: f32,
    /// Smallest radius of point and spot lights, metres.
    pub light_radius_m: f32,
    /// IES profile files by the name or path of the light's node.
    pub ies: BTreeMap<String, PathBuf>,
    /// What unlit materials do.
    pub unlit: Unlit,
    /// Instances of EXT_mesh_gpu_instancing take lightmaps too.
    pub bake_instanced: bool,

    /// Bound on its contribution, as a share of the median irradiance, below which the plan leaves an effect out.
    pub tolerance: f32,
    /// Effects that are simulated, or left out, whatever the plan would choose.
    pub force_effect: BTreeMap<EffectName, bool>,
    /// How light in the air is solved.
    pub mode: Mode,
    /// The air; that of the glTF scene's `extras.bake_media` when absent, none when empty.
    pub media: Option<Vec<Medium>>,
    /// A grid of probes.
    pub probes: Option<Probes>,
    /// Light in the air at the cells of a box around it.
    pub fog_volume: Option<FogVolume>,
    /// Also bake without the air, and keep that total beside the terms.
    pub keep_vacuum: bool,

    /// Also write l ≤ 1 spherical harmonics of incident radiance.
    pub sh1: bool,
    /// Write 16-bit floats.
    pub half: bool,
    /// Also keep the paths, so that other air can be given to the bake; solves by tables.
    pub keep_paths: bool,
    /// Also write what the solver returned before seams were stitched and gaps filled.
    pub keep_raw: bool,

    /// What differs for single nodes, by name or path.
    pub nodes: BTreeMap<String, Node>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            quality: Quality::Medium,
            target_error: None,
            samples: None,
            bounces: None,
            seed: 0,
            time_budget: None,
            texels_per_m: 16.0,
            page_size: 1024,
            max_pages: None,
            padding: 2,
            scene: None,
            sky: None,
            sun: None,
            env: None,
            light_units: LightUnits::Gltf,
            light_scale: 1.0,
            light_radius_m: 0.001,
            ies: BTreeMap::new(),
            unlit: Unlit::Black,
            bake_instanced: false,
            tolerance: 0.001,
            force_effect: BTreeMap::new(),
            mode: Mode::Auto,
            media: None,
            probes: None,
            fog_volume: None,
            keep_vacuum: false,
            sh1: false,
            half: false,
            keep_paths: false,
            keep_raw: false,
            nodes: BTreeMap::new(),
        }
    }
}

impl Settings {
    /// The standard error to reach, as a share of the page's median.
    pub fn relative_error(&self) -> f32 {
        self.target_error.unwrap_or_else(|| self.quality.relative_error())
    }

    /// What was set for a node. A key is a node's name, or consecutive names of a path joined by `/`; it holds for
    /// the node and all below it, and the longest that fits decides.
    pub fn node(&self, path: &str) -> Option<&Node> {
        let fitting = self.nodes.iter().filter(|(key, _)| Self::key_fits(key, path));
        fitting.max_by_key(|(key, _)| key.len()).map(|(_, node)| node)
    }

    /// Whether a path of node names contains the names of `key` in a row.
    pub(crate) fn key_fits(key: &str, path: &str) -> bool {
        format!("/{path}/").contains(&format!("/{}/", key.trim_matches('/')))
    }

    /// Makes file names relative to `folder` instead of the settings file.
    fn resolve_files(&mut self, folder: &Path) {
        for file in self.files_mut() {
            *file = folder.join(&*file);
        }
    }

    /// All files that the settings name.
    pub(crate) fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let media = self.media.iter_mut().flatten().flat_map(Medium::files_mut);
        self.env.iter_mut().map(|env| &mut env.file).chain(self.ies.values_mut()).chain(media)
    }
}

/// Presets of accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Quality {
    /// 10 % standard error.
    Preview,
    /// 4 % standard error.
    #[default]
    Medium,
    /// 2 % standard error.
    High,
    /// 1 % standard error.
    Final,
}

impl Quality {
    /// All, from coarse to fine, by the name of their flag value.
    pub const ALL: [(&str, Self); 4] =
        [("preview", Self::Preview), ("medium", Self::Medium), ("high", Self::High), ("final", Self::Final)];

    /// The standard error to reach, as a share of the page's median irradiance.
    pub fn relative_error(self) -> f32 {
        match self {
            Self::Preview => 0.10,
            Self::Medium => 0.04,
            Self::High => 0.02,
            Self::Final => 0.01,
        }
    }
}

/// How light in the air is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Mode {
    /// Chosen by the plan from what the air is like.
    #[default]
    Auto,
    /// Volumetric path tracing: unbiased, slow.
    Walk,
    /// A grid of light in the air, looked up along paths over surfaces.
    Grid,
    /// Tables of an infinite medium, looked up along paths over surfaces and brought to the scene by factors.
    Tables,
    /// The same as published in 2019, without any correction: too bright in closed rooms, here for comparison.
    Paper,
}

impl Mode {
    /// All, by the name of their flag value.
    pub const ALL: [(&str, Self); 5] = [
        ("auto", Self::Auto),
        ("walk", Self::Walk),
        ("grid", Self::Grid),
        ("tables", Self::Tables),
        ("paper", Self::Paper),
    ];
}

/// A sun: parallel light but for its disk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    /// Direction to the sun, degrees from −Z towards +X.
    pub azimuth_deg: f32,
    /// Height above the horizon, degrees.
    pub elevation_deg: f32,
    /// Illuminance on a surface that faces it, lux.
    pub lux: f32,
    /// Colour, multiplied with `lux`.
    #[serde(default = "white")]
    pub colour: Rgb,
    /// Diameter of the disk, degrees.
    #[serde(default = "solar_diameter")]
    pub angular_diameter_deg: f32,
}

fn white() -> Rgb {
    [1.0; 3]
}

fn solar_diameter() -> f32 {
    Sun::SOLAR_DIAMETER_DEG
}

impl Sun {
    /// The Sun's mean apparent diameter seen from Earth, degrees.
    pub const SOLAR_DIAMETER_DEG: f32 = 0.53;
}

/// An environment image in equirectangular layout, +Y at the top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Env {
    /// A Radiance .hdr or OpenEXR .exr file.
    pub file: PathBuf,
    /// Turn about +Y, degrees.
    #[serde(default)]
    pub rotation_deg: f32,
    /// cd/m² of the value 1.
    #[serde(default = "one")]
    pub scale: f32,
}

fn one() -> f32 {
    1.0
}

/// What the numbers of a file's punctual lights mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum LightUnits {
    /// As glTF says: candela, and lux for directional lights.
    #[default]
    Gltf,
    /// Radiant watts, and W/m² for directional lights.
    Watts,
    /// W/sr, and W/m² for directional lights; what Blender calls "Unitless".
    Unitless,
}

impl LightUnits {
    /// All, by the name of their flag value.
    pub const ALL: [(&str, Self); 3] = [("gltf", Self::Gltf), ("watts", Self::Watts), ("unitless", Self::Unitless)];
}

/// What surfaces of KHR_materials_unlit do.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Unlit {
    /// Block light.
    #[default]
    Black,
    /// Reflect as if they were lit.
    Reflect,
    /// Emit their base colour times this radiance, cd/m².
    Emit(f32),
}

/// Probes: a regular grid in the middles of equal cells that fill a box, or by hand from `origin` on; or a list of points.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probes {
    /// Distance between probes, metres; in a box at most that, so that cells fill it evenly. Of listed ones the size of the cell
    /// around each, within which it may leave walls.
    pub spacing_m: f32,
    /// The box: `Scene` or `Box`.
    #[serde(default)]
    pub bounds: Bounds,
    /// By hand: position of the probe with the smallest coordinates, metres.
    #[serde(default)]
    pub origin: Option<Rgb>,
    /// By hand: probes along x, y and z.
    #[serde(default)]
    pub count: Option<[u32; 3]>,
    /// By hand, one by one: positions, metres.
    #[serde(default)]
    pub points: Vec<Rgb>,
    /// Whether maps of how far each probe sees are stored.
    #[serde(default)]
    pub visibility: bool,
}

/// A box of cells around the air, with light in their middles.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FogVolume {
    /// Size of a cell at most, metres; 1/32 of the longest side when absent.
    pub spacing_m: Option<f32>,
}

/// What differs for one node and its children.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Node {
    /// Lightmap texels per metre of its surface.
    pub texels_per_m: Option<f32>,
    /// Whether it takes a lightmap; without one it still blocks and reflects light.
    pub lightmap: Option<bool>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_run_of_names_decides() {
        let node = |density| Node { texels_per_m: Some(density), lightmap: None };
        let nodes = BTreeMap::from([("Bolt".to_owned(), node(1.0)), ("Roof/Bolt".to_owned(), node(2.0))]);
        let settings = Settings { nodes, ..Settings::default() };
        let cases = [
            ("House/Wall/Bolt", Some(1.0)),
            ("House/Roof/Bolt", Some(2.0)),
            ("House/Roof/Bolt/Head", Some(2.0)),
            ("House/Bolts", None),
            ("Roof", None),
        ];
        for (path, density) in cases {
            assert_eq!(settings.node(path).and_then(|node| node.texels_per_m), density, "{path}");
        }
    }

    #[test]
    fn a_target_overrides_the_preset() {
        let preset = Settings { quality: Quality::High, ..Settings::default() };
        assert_eq!(preset.relative_error(), 0.02);
        assert_eq!(Settings { target_error: Some(0.3), ..preset }.relative_error(), 0.3);
    }
}
