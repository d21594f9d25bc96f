//! What the loader is told besides the scene file: choice of scene, units, lights from the settings.

use glam::Vec3;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How a scene is loaded. The default follows glTF to the letter and adds no light.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// Which scene of the file; none takes the file's default scene, else the first.
    pub scene: Option<SceneChoice>,
    /// What the numbers of punctual lights mean.
    pub light_units: LightUnits,
    /// Factor on punctual lights after the conversion of units.
    pub light_scale: f32,
    /// Smallest radius of point and spot lights, metres; keeps irradiance finite.
    pub min_light_radius: f32,
    /// Radiance from every direction, cd/m² per linear RGB channel. Excludes `env`.
    pub sky: Option<Vec3>,
    /// A sun besides the lights of the file.
    pub sun: Option<Sun>,
    /// An environment image. Excludes `sky`.
    pub env: Option<Env>,
    /// IES profiles, keyed by light name, node name or node path.
    pub ies: BTreeMap<String, Ies>,
    /// Whether instances of EXT_mesh_gpu_instancing take lightmaps.
    pub bake_instanced: bool,
    /// What unlit materials do.
    pub unlit: UnlitMode,
    /// Whether a scene without any light is refused.
    pub require_light: bool,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            scene: None,
            light_units: LightUnits::default(),
            light_scale: 1.0,
            min_light_radius: 1e-3,
            sky: None,
            sun: None,
            env: None,
            ies: BTreeMap::new(),
            bake_instanced: false,
            unlit: UnlitMode::default(),
            require_light: true,
        }
    }
}

/// A scene of the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneChoice {
    /// By position in the file's `scenes`.
    Index(u32),
    /// By name.
    Name(String),
}

/// What the `intensity` of a punctual light means in the file.
///
/// Exporters turn watts into photometric units with 683 lm/W, the value at 555 nm that Blender's glTF exporter uses too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LightUnits {
    /// Candela for point and spot lights, lux for directional ones, as KHR_lights_punctual says.
    #[default]
    Gltf,
    /// Radiant: watts for point and spot lights (spread over the whole sphere, as Blender counts spots too) and W/m²
    /// for directional ones; Blender's export option "Raw (Deprecated)".
    Watts,
    /// Radiant without 683 lm/W: W/sr and W/m²; Blender's export option "Unitless".
    Unitless,
}

/// Luminous efficacy of radiation at 555 nm, lm/W.
const LUMENS_PER_WATT: f32 = 683.0;

impl LightUnits {
    /// Factor from the file's number to candela.
    pub fn candela_factor(self) -> f32 {
        match self {
            Self::Gltf => 1.0,
            Self::Watts => LUMENS_PER_WATT / (4.0 * std::f32::consts::PI),
            Self::Unitless => LUMENS_PER_WATT,
        }
    }

    /// Factor from the file's number to lux.
    pub fn lux_factor(self) -> f32 {
        match self {
            Self::Gltf => 1.0,
            Self::Watts | Self::Unitless => LUMENS_PER_WATT,
        }
    }
}

/// A sun given by the settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Where it stands: degrees from −Z turning towards +X.
    pub azimuth_deg: f32,
    /// Height above the horizon, degrees in [−90, 90].
    pub elevation_deg: f32,
    /// Illuminance on a plane facing it, lux.
    pub lux: f32,
    /// Linear RGB factor on `lux`.
    pub color: Vec3,
    /// Diameter of its disk, degrees in [0, 90]; 0 is a point.
    pub angular_diameter_deg: f32,
}

impl Default for Sun {
    fn default() -> Self {
        Self { azimuth_deg: 0.0, elevation_deg: 45.0, lux: 80_000.0, color: Vec3::ONE, angular_diameter_deg: 0.53 }
    }
}

/// An environment image given by the settings: longitude across, latitude down, Radiance HDR or OpenEXR.
#[derive(Debug, Clone, PartialEq)]
pub struct Env {
    /// The image.
    pub file: PathBuf,
    /// Turn about +Y, degrees, added to the azimuth.
    pub rotation_deg: f32,
    /// cd/m² per unit of the image.
    pub scale: f32,
}

/// A light profile given by the settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Ies {
    /// The IES LM-63 file.
    pub file: PathBuf,
    /// Factor on the file's candela, which replace the light's intensity; the light's colour still multiplies.
    pub scale: f32,
}

/// What KHR_materials_unlit surfaces do.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum UnlitMode {
    /// Neither reflect nor emit, but block light.
    #[default]
    Black,
    /// Reflect as if they were lit.
    Reflect,
    /// Emit their base colour times this radiance, cd/m², and reflect nothing.
    Emit(f32),
}
