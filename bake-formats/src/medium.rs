//! Media in a manifest: the settings' record with everything resolved, from which light transport's medium is rebuilt.
//!
//! Names are those of the settings. Bounds are regions of the world; a density grid lies in an image of the package, whose
//! pixel x = i + nx·k, y = j holds value (i, j, k).

use crate::error::{FormatError, Result};
use crate::float_image::{FloatImage, Quantity};
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::mesh::ClosedMesh;
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use glam::{DAffine3, DVec3, DVec4, IVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Name of a density image's only channel.
const CHANNEL: &str = "density.Y";
/// Widest density image, texels; what is wider cannot be read back.
const MAX_WIDTH: u64 = 1 << 16;

/// A medium. Lengths in metres, coefficients in 1/m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MediumRecord {
    /// Name.
    pub name: String,
    /// Where it is.
    pub bounds: BoundsRecord,
    /// Relative density there.
    pub density: DensityRecord,
    /// Coefficients at density 1.
    pub scatter: ScatterRecord,
    /// Phase function.
    pub phase: PhaseRecord,
}

/// A region of the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum BoundsRecord {
    /// Everywhere.
    Unbounded,
    /// An axis-aligned box.
    Box {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner.
        max: DVec3,
    },
    /// A ball.
    Sphere {
        /// Centre.
        centre: DVec3,
        /// Radius.
        radius: f64,
    },
    /// Points x with n·x ≤ d for each plane (n, d).
    Hull {
        /// Planes, n a unit vector.
        planes: Vec<DVec4>,
    },
    /// The inside of a closed mesh.
    Mesh {
        /// Corners.
        positions: Vec<DVec3>,
        /// Indices of corners, counter-clockwise seen from outside.
        triangles: Vec<[u32; 3]>,
    },
}

/// A density.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum DensityRecord {
    /// 1 everywhere.
    Uniform,
    /// max(0, slope (y − zero)).
    Linear {
        /// Height of density 0.
        zero_m: f64,
        /// Growth per metre of height.
        slope_per_m: f64,
    },
    /// exp(−(y − base)/scale height).
    Exponential {
        /// Height of density 1.
        base_m: f64,
        /// Height over which it falls to 1/e.
        scale_height_m: f64,
    },
    /// The same about a ball.
    Planet {
        /// Its centre.
        centre: DVec3,
        /// Its radius.
        radius_m: f64,
        /// Height over which density falls to 1/e.
        scale_height_m: f64,
    },
    /// Trilinear between points; zero one cell beyond the outermost.
    Grid {
        /// Image of the package; absent where the grid is too wide for one.
        file: Option<String>,
        /// Points along the grid's axes.
        size: [u32; 3],
        /// Columns of the placement: images of the grid's axes, then of its point (0, 0, 0).
        world_from_grid: [DVec3; 4],
    },
}

/// Coefficients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ScatterRecord {
    /// Scattering and absorption.
    Sigma {
        /// Scattering.
        s: [f64; 3],
        /// Absorption.
        a: [f64; 3],
    },
}

/// A phase function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum PhaseRecord {
    /// 1/4π.
    Isotropic,
    /// Small particles.
    Rayleigh,
    /// With mean cosine g.
    HenyeyGreenstein(f64),
    /// (1 + a₁ cos θ)/4π.
    Linear(f64),
    /// Legendre coefficients, the first being 1.
    Legendre(Vec<f64>),
    /// Values, 1/sr, at angles, linear in the angle between.
    Table {
        /// Radians from 0 to π.
        angles: Vec<f64>,
        /// One an angle.
        values: Vec<f64>,
    },
}

impl MediumRecord {
    /// The record of a medium; `grid_file` is where [`density_image`] went.
    pub fn new(name: &str, medium: &Medium, grid_file: Option<String>) -> Self {
        let Scatter { sigma_s, sigma_a } = medium.scatter;
        Self {
            name: name.into(),
            bounds: BoundsRecord::new(&medium.bounds),
            density: DensityRecord::new(&medium.density, grid_file),
            scatter: ScatterRecord::Sigma { s: sigma_s, a: sigma_a },
            phase: PhaseRecord::new(&medium.phase),
        }
    }

    /// The medium again. `image` opens an image of the package; `path` is the manifest, for messages.
    ///
    /// # Errors
    /// Values that make no medium, and grids that the package does not hold.
    pub fn medium(&self, path: &Path, image: impl FnOnce(&str) -> Result<FloatImage>) -> Result<Medium> {
        let refuse = |what: &str, reason: String| {
            FormatError::invalid(path, format!("medium {}: {what}", self.name), reason, "a valid medium; bake again")
        };
        let ScatterRecord::Sigma { s, a } = self.scatter;
        if s.iter().chain(&a).any(|sigma| !(sigma.is_finite() && *sigma >= 0.0)) {
            return Err(refuse("scatter", format!("{s:?} {a:?}")));
        }
        let phase = self.phase.phase().map_err(|reason| refuse("phase", reason))?;
        let bounds = self.bounds.bounds().map_err(|reason| refuse("bounds", reason))?;
        let density = match &self.density {
            DensityRecord::Grid { file, size, world_from_grid } => {
                let file = file.as_ref().ok_or_else(|| refuse("density", "a grid that was not stored".into()))?;
                let grid = read_grid(&image(file)?, *size, *world_from_grid);
                Density::Grid(Arc::new(grid.map_err(|reason| refuse("density", reason))?))
            }
            formula => formula.formula().ok_or_else(|| refuse("density", format!("{formula:?}")))?,
        };
        Ok(Medium { bounds, density, scatter: Scatter { sigma_s: s, sigma_a: a }, phase })
    }
}

impl BoundsRecord {
    fn new(bounds: &Bounds) -> Self {
        match bounds {
            Bounds::Unbounded => Self::Unbounded,
            Bounds::Box { min, max } => Self::Box { min: *min, max: *max },
            Bounds::Sphere { centre, radius } => Self::Sphere { centre: *centre, radius: *radius },
            Bounds::Hull(planes) => Self::Hull { planes: planes.to_vec() },
            Bounds::Mesh(mesh) => {
                Self::Mesh { positions: mesh.positions().to_vec(), triangles: mesh.triangles().to_vec() }
            }
        }
    }

    fn bounds(&self) -> std::result::Result<Bounds, String> {
        let bounds = match self {
            Self::Unbounded => Bounds::Unbounded,
            Self::Box { min, max } => Bounds::Box { min: *min, max: *max },
            Self::Sphere { centre, radius } => Bounds::Sphere { centre: *centre, radius: *radius },
            Self::Hull { planes } => Bounds::Hull(planes.as_slice().into()),
            Self::Mesh { positions, triangles } => {
                Bounds::Mesh(Arc::new(ClosedMesh::new(positions, triangles).map_err(|error| error.to_string())?))
            }
        };
        let usable = match &bounds {
            Bounds::Box { min, max } => min.is_finite() && max.is_finite() && min.cmple(*max).all(),
            Bounds::Sphere { centre, radius } => centre.is_finite() && (0.0..f64::INFINITY).contains(radius),
            Bounds::Hull(planes) => planes.iter().all(|p| p.is_finite() && (p.truncate().length() - 1.0).abs() < 1e-6),
            Bounds::Unbounded | Bounds::Mesh(_) => true,
        };
        if usable { Ok(bounds) } else { Err(format!("{bounds:?}")) }
    }
}

impl DensityRecord {
    fn new(density: &Density, grid_file: Option<String>) -> Self {
        match *density {
            Density::Uniform => Self::Uniform,
            Density::Linear { zero_m, slope_per_m } => Self::Linear { zero_m, slope_per_m },
            Density::Exponential { base_m, scale_height_m } => Self::Exponential { base_m, scale_height_m },
            Density::Planet { centre, radius_m, scale_height_m } => Self::Planet { centre, radius_m, scale_height_m },
            Density::Grid(ref grid) => {
                let placed = grid.world_from_grid();
                let [x, y, z] = placed.matrix3.to_cols_array_2d().map(DVec3::from);
                let world_from_grid = [x, y, z, placed.translation];
                let size = grid.size().to_array().map(|side| side as u32);
                Self::Grid { file: grid_file, size, world_from_grid }
            }
        }
    }

    /// The density that a formula states, if its numbers allow one.
    fn formula(&self) -> Option<Density> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        match *self {
            Self::Uniform => Some(Density::Uniform),
            Self::Linear { zero_m, slope_per_m } => {
                (zero_m.is_finite() && slope_per_m.is_finite()).then_some(Density::Linear { zero_m, slope_per_m })
            }
            Self::Exponential { base_m, scale_height_m } => (base_m.is_finite() && positive(scale_height_m))
                .then_some(Density::Exponential { base_m, scale_height_m }),
            Self::Planet { centre, radius_m, scale_height_m } => (centre.is_finite()
                && positive(radius_m)
                && positive(scale_height_m))
            .then_some(Density::Planet { centre, radius_m, scale_height_m }),
            Self::Grid { .. } => None,
        }
    }
}

impl PhaseRecord {
    fn new(phase: &Phase<f64>) -> Self {
        match phase {
            Phase::Isotropic => Self::Isotropic,
            Phase::Rayleigh => Self::Rayleigh,
            Phase::HenyeyGreenstein { g } => Self::HenyeyGreenstein(*g),
            Phase::Linear { a1 } => Self::Linear(*a1),
            Phase::Legendre(terms) => Self::Legendre(terms.clone()),
            Phase::Table(table) => Self::Table { angles: table.angles().to_vec(), values: table.values().to_vec() },
        }
    }

    fn phase(&self) -> std::result::Result<Phase<f64>, String> {
        let phase = match self {
            Self::Isotropic => Phase::Isotropic,
            Self::Rayleigh => Phase::Rayleigh,
            Self::HenyeyGreenstein(g) => Phase::HenyeyGreenstein { g: *g },
            Self::Linear(a1) => Phase::Linear { a1: *a1 },
            Self::Legendre(terms) => Phase::Legendre(terms.clone()),
            Self::Table { angles, values } => {
                Phase::from_table(angles.clone(), values.clone()).map_err(|error| error.to_string())?
            }
        };
        phase.check().map_err(|error| error.to_string())?;
        Ok(phase)
    }
}

/// The image of a density grid, slices side by side; `None` for other densities, and for grids too wide for an image.
pub fn density_image(density: &Density) -> Option<FloatImage> {
    let Density::Grid(grid) = density else { return None };
    let [nx, ny, nz] = grid.size().to_array().map(|side| side as usize);
    if (nx * nz) as u64 > MAX_WIDTH || ny as u64 > MAX_WIDTH {
        return None;
    }
    let values = grid.values();
    let texel = |y: usize, x: usize| values[x % nx + nx * (y + ny * (x / nx))];
    let mut image = FloatImage::new((nx * nz) as u32, ny as u32);
    image.push(CHANNEL, Quantity::Density, (0..ny).flat_map(|y| (0..nx * nz).map(move |x| texel(y, x))).collect());
    Some(image)
}

fn read_grid(
    image: &FloatImage,
    size: [u32; 3],
    world_from_grid: [DVec3; 4],
) -> std::result::Result<DensityGrid, String> {
    let [nx, ny, nz] = size.map(|side| side as usize);
    let channel = image.channel(CHANNEL).ok_or_else(|| format!("an image without {CHANNEL}"))?;
    if nx.checked_mul(nz) != Some(image.width as usize) || ny != image.height as usize {
        return Err(format!("an image of {} × {} for {size:?} points", image.width, image.height));
    }
    let row = |j: usize, k: usize| &channel[j * nx * nz + k * nx..][..nx];
    let values = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| row(j, k))).copied().collect();
    let [x, y, z, translation] = world_from_grid;
    let placed = DAffine3::from_cols(x, y, z, translation);
    DensityGrid::new(IVec3::from(size.map(|side| side as i32)), values, placed).map_err(|error| error.to_string())
}
