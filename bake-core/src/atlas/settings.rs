//! What the user may ask of the atlas, and what it answers besides the atlas itself.

use std::collections::BTreeMap;
use thiserror::Error;

/// Settings of [`build`](super::build).
#[derive(Debug, Clone, PartialEq)]
pub struct AtlasSettings {
    /// Texel density on the surface, texels per metre, > 0.
    pub texels_per_m: f32,
    /// Width and height of a page, texels, 4 to 16384.
    pub page_size: u32,
    /// `Some(n)` lowers all densities by one factor until everything fits on `n` pages.
    pub max_pages: Option<u32>,
    /// Texels kept free between the bounding rectangles of two charts. Bilinear lookups need 1 for their rounding.
    pub padding: u32,
    /// Texels per metre of the instances at or below the named nodes: a node name, or consecutive names joined by `/`.
    /// The longest name that fits wins.
    pub node_texels_per_m: BTreeMap<String, f32>,
    /// Surface points per covered texel, 1 to 64.
    pub points_per_texel: u32,
    /// Wall-clock limit for unwrapping, seconds, checked between clusters of bounded size; what is left then is
    /// unwrapped by the fallback. A bake that runs into it need not repeat bit for bit (and says so by a warning).
    pub unwrap_seconds: f64,
}

impl Default for AtlasSettings {
    fn default() -> Self {
        Self {
            texels_per_m: 16.0,
            page_size: 1024,
            max_pages: None,
            padding: 1,
            node_texels_per_m: BTreeMap::new(),
            points_per_texel: 4,
            unwrap_seconds: 600.0,
        }
    }
}

impl AtlasSettings {
    /// Refuses values out of range.
    pub(super) fn check(&self) -> Result<(), AtlasError> {
        let refuse = |setting: &str, value: String, allowed: &'static str| {
            Err(AtlasError::Setting { setting: setting.into(), value, allowed })
        };
        let positive = |value: f32| value.is_finite() && value > 0.0;
        if !positive(self.texels_per_m) {
            return refuse("texels_per_m", self.texels_per_m.to_string(), "a number > 0");
        }
        if !(4..=16384).contains(&self.page_size) {
            return refuse("page_size", self.page_size.to_string(), "4 to 16384");
        }
        if self.max_pages == Some(0) {
            return refuse("max_pages", "0".into(), "None, or at least 1");
        }
        if self.padding > self.page_size / 4 {
            return refuse("padding", self.padding.to_string(), "at most a quarter of page_size");
        }
        if !(1..=64).contains(&self.points_per_texel) {
            return refuse("points_per_texel", self.points_per_texel.to_string(), "1 to 64");
        }
        if self.unwrap_seconds.is_nan() {
            return refuse("unwrap_seconds", "NaN".into(), "a number of seconds");
        }
        match self.node_texels_per_m.iter().find(|(_, density)| !positive(**density)) {
            Some((node, density)) => {
                refuse(&format!("nodes: \"{node}\": texels_per_m"), density.to_string(), "a number > 0")
            }
            None => Ok(()),
        }
    }
}

/// Why an atlas cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AtlasError {
    /// A setting is out of range.
    #[error("setting {setting} is {value}; allowed: {allowed}")]
    Setting {
        /// Name in the settings file.
        setting: String,
        /// The value given.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Too many charts for the pages allowed, however low the density.
    #[error(
        "{charts} charts do not fit on {pages} page(s) of {page_size} texels even at the lowest density; \
         raise max_pages or page_size, or give the meshes a lightmap UV set (TEXCOORD_1) with fewer charts"
    )]
    TooManyCharts {
        /// Charts to place.
        charts: u32,
        /// Pages allowed.
        pages: u32,
        /// Texels along a page's side.
        page_size: u32,
    },
}

/// What did not go as asked; the atlas is usable all the same.
#[derive(Debug, Clone, PartialEq)]
pub enum AtlasWarning {
    /// TEXCOORD_1 is there but is no lightmap UV set; the mesh was unwrapped instead.
    OwnUvRejected {
        /// Name of the mesh.
        mesh: String,
        /// Why.
        problem: OwnUvProblem,
    },
    /// `max_pages` lowered all densities.
    DensityScaled {
        /// The setting.
        asked: f32,
        /// Texels per metre reached.
        reached: f32,
    },
    /// An instance alone would exceed a page.
    InstanceScaled {
        /// Path of the instance's node.
        path: String,
        /// Texels per metre asked for.
        asked: f32,
        /// Texels per metre reached.
        reached: f32,
    },
    /// A per-node density names no lightmapped node.
    UnknownNode {
        /// The name as given.
        node: String,
    },
    /// Clusters of triangles that the unwrapper could not flatten in time; they were projected along axes.
    /// Where `timed_out`, another run may cut them differently.
    UnwrapFallback {
        /// Name of the mesh.
        mesh: String,
        /// Triangles projected.
        triangles: u32,
        /// Whether the wall-clock limit was the reason.
        timed_out: bool,
    },
    /// Texels of an own TEXCOORD_1 that triangles of several charts touch: the largest share wins.
    SharedTexels {
        /// Name of the mesh.
        mesh: String,
        /// How many.
        texels: u32,
        /// Of how many covered.
        covered: u32,
    },
}

/// Why a TEXCOORD_1 is no lightmap UV set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OwnUvProblem {
    /// A coordinate lies outside [0, 1].
    Outside {
        /// The coordinate farthest out.
        coordinate: f32,
    },
    /// Triangles with area on the surface but none in UV space.
    Degenerate {
        /// Their share of the mesh's surface.
        share: f32,
    },
    /// Several triangles cover the same texels at the density chosen.
    Overlap {
        /// Their share of the covered texels.
        share: f32,
    },
}

impl std::fmt::Display for OwnUvProblem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Outside { coordinate } => write!(f, "coordinate {coordinate} lies outside [0, 1]"),
            Self::Degenerate { share } => write!(f, "{:.1} % of the surface has no area in it", share * 100.0),
            Self::Overlap { share } => write!(f, "triangles overlap on {:.1} % of its texels", share * 100.0),
        }
    }
}

impl std::fmt::Display for AtlasWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OwnUvRejected { mesh, problem } => {
                write!(f, "mesh '{mesh}': TEXCOORD_1 is no lightmap UV set ({problem}); unwrapped instead")
            }
            Self::DensityScaled { asked, reached } => {
                write!(f, "max_pages lowers texels_per_m from {asked} to {reached}")
            }
            Self::InstanceScaled { path, asked, reached } => {
                write!(f, "'{path}' does not fit on one page: texels_per_m lowered from {asked} to {reached}")
            }
            Self::UnknownNode { node } => write!(f, "settings name node '{node}', which takes no lightmap"),
            Self::UnwrapFallback { mesh, triangles, timed_out } => {
                let why = if *timed_out { "unwrap_seconds was over" } else { "the unwrapper gave up" };
                write!(f, "mesh '{mesh}': {triangles} triangles were projected along axes because {why}")
            }
            Self::SharedTexels { mesh, texels, covered } => {
                write!(f, "mesh '{mesh}': charts of TEXCOORD_1 share {texels} of {covered} texels")
            }
        }
    }
}
