//! The air: records of participating media, in a settings file or in the glTF scene's `extras.bake_media`.

use super::Rgb;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A region of air with one composition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Medium {
    /// For reports.
    #[serde(default)]
    pub name: String,
    /// Where it is.
    #[serde(default)]
    pub bounds: Bounds,
    /// How its density varies there; a factor on the coefficients of `scatter`.
    #[serde(default)]
    pub density: Density,
    /// Its coefficients at density 1.
    pub scatter: Scatter,
    /// How it turns light.
    #[serde(default)]
    pub phase: Phase,
}

/// The region of a medium.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Bounds {
    /// The scene's bounding box.
    #[default]
    Scene,
    /// Everywhere; only for densities whose optical depth to infinity is finite.
    Unbounded,
    /// An axis-aligned box, metres.
    Box {
        /// Smallest corner.
        min: [f32; 3],
        /// Largest corner.
        max: [f32; 3],
    },
    /// A ball, metres.
    Sphere {
        /// Its centre.
        centre: [f32; 3],
        /// Its radius.
        radius: f32,
    },
    /// The inside of the closed meshes of a node and all below it, by name or path; they then are no surfaces.
    Node(String),
}

/// Relative density over the region.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Density {
    /// 1 everywhere.
    #[default]
    Uniform,
    /// `slope_per_m · (height − zero_m)`, never below zero.
    Linear {
        /// Height of density 0, metres.
        zero_m: f32,
        /// Growth per metre of height.
        slope_per_m: f32,
    },
    /// `exp(−(height − base_m) / scale_height_m)`.
    Exponential {
        /// Height of density 1, metres.
        base_m: f32,
        /// Height over which density falls to 1/e, metres.
        scale_height_m: f32,
    },
    /// The same about a ball: height is the distance to its surface.
    Planet {
        /// Its centre, metres.
        centre: [f32; 3],
        /// Its radius, metres.
        radius_m: f32,
        /// Height over which density falls to 1/e, metres.
        scale_height_m: f32,
    },
    /// A voxel grid.
    Grid {
        /// An OpenVDB fog volume, a KTX2 3-D texture, OpenEXR slices, or bare numbers; told apart by the first bytes.
        file: PathBuf,
        /// Name of the grid (OpenVDB) or channel (OpenEXR); needed where the file has several.
        #[serde(default)]
        name: Option<String>,
        /// Points along x, y and z: of bare numbers, and of slices side by side in one image.
        #[serde(default)]
        size: Option<[u32; 3]>,
        /// Type of bare numbers, little-endian.
        #[serde(default)]
        values: Values,
        /// Where the grid lies.
        #[serde(default)]
        place: Place,
        /// The grid's third axis points up, instead of its second.
        #[serde(default)]
        z_up: bool,
    },
}

/// Type of bare numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Values {
    /// 32-bit floats.
    #[default]
    F32,
    /// 16-bit floats.
    F16,
    /// 16-bit integers; 65535 is density 1.
    U16,
    /// Bytes; 255 is density 1.
    U8,
}

/// Where a grid lies in the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Place {
    /// Where its file says (OpenVDB), else filling the medium's bounds.
    #[default]
    Auto,
    /// Where its file says.
    File,
    /// Filling the bounding box of the medium's bounds.
    Fill,
}

/// Coefficients at density 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Scatter {
    /// Scattering `sigma_s` and absorption `sigma_a`, 1/m.
    Sigma {
        /// Scattering.
        s: Rgb,
        /// Absorption.
        a: Rgb,
    },
    /// By look: mean free path and single-scattering albedo.
    Look {
        /// Mean free path 1/`sigma_t`, metres.
        mean_free_path_m: f32,
        /// `sigma_s / sigma_t`.
        albedo: Rgb,
    },
}

/// Phase function over the cosine between propagation directions.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Phase {
    /// 1/4π.
    #[default]
    Isotropic,
    /// Small particles.
    Rayleigh,
    /// With mean cosine g.
    HenyeyGreenstein(f32),
    /// (1 + a₁ cos θ)/4π.
    Linear(f32),
    /// Legendre coefficients, the first being 1.
    Legendre(Vec<f32>),
    /// A file of angles and values.
    Table(PathBuf),
}

impl Medium {
    /// The files that it names.
    pub(super) fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let grid = match &mut self.density {
            Density::Grid { file, .. } => Some(file),
            _ => None,
        };
        let table = match &mut self.phase {
            Phase::Table(file) => Some(file),
            _ => None,
        };
        grid.into_iter().chain(table)
    }
}
