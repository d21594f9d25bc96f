//! Why a density grid is refused. The messages continue a sentence that begins with medium and file.

use bake_optics::medium::grid::GridError;
use thiserror::Error;

/// What is wrong with a grid's file, or with what the settings say about it.
#[derive(Debug, Error)]
pub enum GridFault {
    /// Bytes of no known form, and no size for bare numbers.
    #[error("is neither OpenVDB, KTX2 nor OpenEXR; bare numbers need `size: (x, y, z)`")]
    Unknown,
    /// A file that does not keep to its format.
    #[error("is a damaged {format} file ({reason}); export or copy it again")]
    Damaged {
        /// Name of the format.
        format: &'static str,
        /// What was met.
        reason: String,
    },
    /// Something that its format allows and that is not read.
    #[error("holds {what}; {way_out}")]
    Unsupported {
        /// What was met.
        what: String,
        /// The way out.
        way_out: &'static str,
    },
    /// Distances instead of densities.
    #[error(
        "holds a level set, `{name}`: distances to a surface, no densities; convert it to a fog volume first (in Houdini \"Convert VDB\", in OpenVDB `sdfToFogVolume`)"
    )]
    LevelSet {
        /// Name of the grid.
        name: String,
    },
    /// Which of several?
    #[error("holds several {what}s; choose one by `name`: {}", names.join(", "))]
    Several {
        /// `grid` or `channel`.
        what: &'static str,
        /// What there is.
        names: Vec<String>,
    },
    /// A name that is not there.
    #[error("has no {what} `{name}`; it has {}", names.join(", "))]
    NoSuch {
        /// `grid` or `channel`.
        what: &'static str,
        /// As set.
        name: String,
        /// What there is.
        names: Vec<String>,
    },
    /// Too many points.
    #[error(
        "has {points} points, more than the {allowed} that a file of this size may have; resample it more coarsely"
    )]
    TooLarge {
        /// Points.
        points: u64,
        /// Allowed.
        allowed: u64,
    },
    /// Another number of bytes or texels than the size asks for.
    #[error("has {found} {unit}, and `size` asks for {expected}; correct `size` or `values`")]
    Size {
        /// Found.
        found: u64,
        /// Bytes or texels.
        unit: &'static str,
        /// Product of the size.
        expected: u64,
    },
    /// Numbers that are no densities.
    #[error("{0}; export it again")]
    Values(#[from] GridError),
    /// Densities well below zero.
    #[error("has densities down to {lowest}; densities are 0 or more: is it a level set, or another quantity?")]
    Negative {
        /// The lowest.
        lowest: f32,
    },
    /// Air without end.
    #[error("is {background} beyond its voxels; a fog volume's background is 0")]
    Background {
        /// The value.
        background: f32,
    },
    /// No voxel.
    #[error("holds no active voxel in `{name}`; choose another grid")]
    Empty {
        /// Name of the grid.
        name: String,
    },
    /// A placement that cannot be.
    #[error("{0}")]
    Place(&'static str),
}

impl GridFault {
    /// A damaged file.
    pub fn damaged(format: &'static str, reason: impl ToString) -> Self {
        Self::Damaged { format, reason: reason.to_string() }
    }
}
