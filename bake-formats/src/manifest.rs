//! The manifest `NAME.bake.json`: what was baked from what, and where everything lies. It is the last file written.

use crate::error::{FormatError, Result};
use crate::float_image::{ChannelGroup, PixelFormat};
use crate::term::Term;
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// Version of the package format that this program writes and reads.
pub const FORMAT_VERSION: u32 = 1;

/// Value of the manifest's first field.
pub const FORMAT_NAME: &str = "bake package";

/// Everything about a package but its pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Always [`FORMAT_NAME`].
    pub format: String,
    /// Version of the package format.
    pub format_version: u32,
    /// Version of the program that baked.
    pub tool_version: String,
    /// NAME of all files: the scene file's stem.
    pub name: String,
    /// The scene file.
    pub scene: Source,
    /// The settings.
    pub settings: Settings,
    /// False when bytes do not repeat, as under a time budget.
    pub reproducible: bool,
    /// Which effects were simulated, and why.
    pub plan: Value,
    /// Terms in the images; they sum to the total irradiance.
    pub terms: Vec<Term>,
    /// Media as in the settings, everything resolved: [`MediumRecord`](crate::MediumRecord)s.
    pub media: Vec<Value>,
    /// Punctual lights in world space.
    pub lights: Vec<LightRecord>,
    /// Light from infinitely far away.
    pub environment: Option<EnvironmentRecord>,
    /// Pages of the atlas.
    pub pages: Vec<PageRecord>,
    /// Surfaces with a lightmap.
    pub instances: Vec<InstanceRecord>,
    /// Grid of light probes.
    pub probes: Option<ProbeGrid>,
    /// Cells of light in the air.
    pub fog_volume: Option<ProbeGrid>,
    /// Error of the bake by its own estimate.
    pub error_estimate: Option<ErrorEstimate>,
    /// What should be looked at.
    pub warnings: Vec<String>,
    /// All hashed files but this one.
    pub files: Vec<FileRecord>,
}

/// The file that was baked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// File name without folder.
    pub file: String,
    /// BLAKE3 of everything that the scene was read from: the file, followed by the BLAKE3 of each file that it names;
    /// lower-case hexadecimal.
    pub blake3: String,
}

/// The settings after defaults, side file and flags.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// BLAKE3 of the values as compact JSON with sorted keys, lower-case hexadecimal.
    pub blake3: String,
    /// Every setting.
    pub values: Value,
}

impl Settings {
    /// The record of a set of values.
    pub fn new(values: Value) -> Self {
        let text = serde_json::to_string(&values).expect("a JSON value becomes text");
        Self { blake3: blake3::hash(text.as_bytes()).to_hex().to_string(), values }
    }
}

/// A light that is no surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightRecord {
    /// Path of the node that carries it.
    pub path: String,
    /// cd for point and spot, lux for directional, per linear Rec.709 channel.
    pub color: Vec3,
    /// Shape and placement.
    pub kind: LightKind,
}

/// Kinds of light; lengths in metres, angles in radians, directions along the light's travel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum LightKind {
    /// From a small ball into all directions.
    Point {
        /// Centre.
        position: Vec3,
        /// Radius of the ball.
        radius: f32,
        /// Distance at which light ends, where the file says so.
        range: Option<f32>,
        /// Measured distribution reduced to Legendre polynomials about an axis.
        profile: Option<ProfileRecord>,
    },
    /// From a small ball into a cone.
    Spot {
        /// Centre.
        position: Vec3,
        /// Axis.
        direction: Vec3,
        /// Angle up to which intensity is full.
        inner_angle: f32,
        /// Angle beyond which it is zero.
        outer_angle: f32,
        /// Radius of the ball.
        radius: f32,
        /// Distance at which light ends, where the file says so.
        range: Option<f32>,
        /// Measured distribution, which replaces the cone.
        profile: Option<ProfileRecord>,
    },
    /// From infinitely far.
    Directional {
        /// Along the light's travel.
        direction: Vec3,
        /// Angular radius of the source.
        angular_radius: f32,
    },
}

/// Relative intensity as a sum over j of `legendre[j]` · P_j(cos of the angle to the axis).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileRecord {
    /// Unit axis of vertical angle 0.
    pub axis: Vec3,
    /// Coefficients from j = 0.
    pub legendre: Vec<f32>,
}

/// Light from all directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentRecord {
    /// Texels of the latitude-longitude image; 1 × 1 is a uniform sky.
    pub size: [u32; 2],
    /// Turn about +Y, radians.
    pub rotation: f32,
    /// Mean radiance over the sphere, cd/m².
    pub mean_radiance: Vec3,
    /// Its picture, radiance in cd/m², `size` or halved as often as 1024 texels across ask for; none of a uniform sky.
    pub file: Option<String>,
}

/// One page of the atlas.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PageRecord {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Image of the total irradiance.
    pub lightmap: String,
    /// Image of the terms, variance, samples and validity.
    pub terms: String,
    /// Image of l ≤ 1 harmonics.
    pub sh1: Option<String>,
    /// Image of the terms before seams were stitched and gaps filled.
    pub raw: Option<String>,
}

/// A surface with a lightmap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstanceRecord {
    /// Index of the node in the baked scene file `NAME.baked.glb`.
    pub baked_node: u32,
    /// Index of the node in the scene file.
    pub node: u32,
    /// Path of node names from the scene root.
    pub path: String,
    /// Name of the mesh.
    pub name: String,
    /// Index of the page.
    pub page: u32,
    /// Corner of the rectangle on the page that is nearest to the origin, in [0, 1].
    pub uv_offset: Vec2,
    /// Size of the rectangle.
    pub uv_scale: Vec2,
}

/// Points with light, probes or the middles of fog cells; point (ix, iy, iz) is pixel x = ix + nx·iz, y = iy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeGrid {
    /// Image of 9 harmonics (fog: 4), of how far each point was moved, and of validity.
    pub file: String,
    /// Image of how far each point sees, where it was asked for.
    pub visibility: Option<String>,
    /// Position of point (0, 0, 0), metres.
    pub origin: Vec3,
    /// Distance of neighbours, metres; of listed points the size of the cell around each.
    pub spacing: Vec3,
    /// Number of points along x, y, z; of listed points their number, 1, 1.
    pub count: [u32; 3],
    /// Positions of points that were listed one by one, metres; none where they lie at equal distances.
    #[serde(default)]
    pub points: Vec<Vec3>,
}

impl ProbeGrid {
    /// Whether the list of points, if there is one, is as long as `count` says.
    fn is_whole(&self) -> bool {
        self.points.is_empty() || self.count == [self.points.len() as u32, 1, 1]
    }
}

/// Error of the bake by its own estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorEstimate {
    /// Root mean square, over all texels of a page but the noisiest hundredth, of the standard error of the total over
    /// max(texel, page's median), in luminance; the page with the largest.
    pub relative_standard_error: f32,
    /// Share of covered texels that could not be baked.
    pub unbaked_share: f32,
}

/// A file of the package.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// Name in the package's folder.
    pub file: String,
    /// BLAKE3 of its bytes, lower-case hexadecimal.
    pub blake3: String,
    /// Size.
    pub bytes: u64,
    /// What images hold.
    pub image: Option<ImageRecord>,
}

/// What an image holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageRecord {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Number format.
    pub pixels: PixelFormat,
    /// Quantity, unit and scale of every channel.
    pub groups: Vec<ChannelGroup>,
}

impl Manifest {
    /// A manifest of nothing, to be filled in.
    pub fn new(name: &str, scene: Source, settings: Settings) -> Self {
        Self {
            format: FORMAT_NAME.into(),
            format_version: FORMAT_VERSION,
            tool_version: env!("CARGO_PKG_VERSION").into(),
            name: name.into(),
            scene,
            settings,
            reproducible: true,
            plan: Value::Null,
            terms: Vec::new(),
            media: Vec::new(),
            lights: Vec::new(),
            environment: None,
            pages: Vec::new(),
            instances: Vec::new(),
            probes: None,
            fog_volume: None,
            error_estimate: None,
            warnings: Vec::new(),
            files: Vec::new(),
        }
    }

    /// The manifest's bytes: JSON, two spaces of indent, final line feed.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = serde_json::to_vec_pretty(self).expect("plain data becomes JSON");
        bytes.push(b'\n');
        bytes
    }

    /// Reads a manifest; strangers and other versions are refused before anything else is looked at. `path` is for
    /// messages.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self> {
        let value: Value =
            serde_json::from_slice(bytes).map_err(|error| FormatError::damaged("manifest", path, error))?;
        let format = value.get("format").and_then(Value::as_str).unwrap_or("absent");
        if format != FORMAT_NAME {
            let (value, expected) = (format!("'{format}'"), format!("'{FORMAT_NAME}'"));
            return Err(FormatError::Foreign { path: path.into(), field: "format", value, expected });
        }
        let version = value.get("format_version").and_then(Value::as_u64).unwrap_or(0);
        if version != u64::from(FORMAT_VERSION) {
            let found = u32::try_from(version).unwrap_or(u32::MAX);
            return Err(FormatError::Version { path: path.into(), found, supported: FORMAT_VERSION });
        }
        // From the text, not the value: messages then carry line and column.
        let manifest: Self =
            serde_json::from_slice(bytes).map_err(|error| FormatError::damaged("manifest", path, error))?;
        manifest.check(path)?;
        Ok(manifest)
    }

    /// References that readers follow without looking.
    fn check(&self, path: &Path) -> Result<()> {
        let invalid = |field: String, value: String, expected: &str| {
            Err(FormatError::invalid(path, field, value, format!("{expected}; bake again")))
        };
        for file in &self.files {
            if !is_plain_name(&file.file) {
                return invalid("files".into(), file.file.clone(), "a file name without folder");
            }
        }
        for (index, page) in self.pages.iter().enumerate() {
            for name in [Some(&page.lightmap), Some(&page.terms), page.sh1.as_ref()].into_iter().flatten() {
                if self.file(name).is_none() {
                    return invalid(format!("page {index}"), name.clone(), "a file listed under files");
                }
            }
        }
        for instance in &self.instances {
            if instance.page as usize >= self.pages.len() {
                let field = format!("instance {}: page", instance.path);
                return invalid(field, instance.page.to_string(), "an index into pages");
            }
        }
        for (name, grid) in [("probes", &self.probes), ("fog_volume", &self.fog_volume)] {
            if let Some(grid) = grid
                && (std::iter::once(&grid.file).chain(&grid.visibility).any(|file| self.file(file).is_none())
                    || grid.count.contains(&0)
                    || !grid.is_whole())
            {
                let found = format!("{} {:?}, {} listed", grid.file, grid.count, grid.points.len());
                return invalid(name.into(), found, "a listed file of 1+ points, as many as are listed if any are");
            }
        }
        Ok(())
    }

    /// The record of a file.
    pub fn file(&self, name: &str) -> Option<&FileRecord> {
        self.files.iter().find(|record| record.file == name)
    }
}

/// Whether a name stays inside the package's folder.
fn is_plain_name(name: &str) -> bool {
    !name.is_empty() && name != "." && name != ".." && !name.contains(['/', '\\', '\0', ':'])
}
