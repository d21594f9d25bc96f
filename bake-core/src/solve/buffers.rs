//! What a solver returns: one image per light term, with the variance of the total's mean, samples and validity.

use bake_formats::Term;
use glam::Vec3;

/// State of a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Validity {
    /// No surface lies there.
    #[default]
    Empty,
    /// Baked.
    Good,
    /// On a surface but buried in other geometry: to be filled from its neighbours.
    Buried,
    /// Written by dilation.
    Filled,
}

/// One light term of one page, irradiance in lux per linear RGB channel, row-major.
#[derive(Debug, Clone)]
pub struct TermImage {
    /// Which term.
    pub term: Term,
    /// One value a texel.
    pub irradiance: Vec<Vec3>,
}

/// Everything solved for one page. All images have `width · height` entries; texels that are not `Good` hold zero
/// until post-processing fills them.
#[derive(Debug, Clone)]
pub struct PageBuffers {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// The plan's terms; their sum is the total irradiance.
    pub terms: Vec<TermImage>,
    /// Variance of the mean of the total, lux².
    pub variance: Vec<Vec3>,
    /// Samples taken.
    pub samples: Vec<u32>,
    /// State of each texel.
    pub validity: Vec<Validity>,
    /// l ≤ 1 spherical harmonics of incident radiance over the geometric normal's hemisphere (order: 0, y, z, x), when asked for.
    pub sh1: Option<Vec<[Vec3; 4]>>,
}

impl PageBuffers {
    /// The total irradiance of a texel: the sum of its terms, in their order.
    pub fn total(&self, index: usize) -> Vec3 {
        self.terms.iter().map(|term| term.irradiance[index]).sum()
    }
}
