//! How far the two sides of the seams differ.

use super::seams::{self, Seam};
use crate::atlas::{Atlas, Bilinear};
use crate::solve::buffers::PageBuffers;
use bake_formats::metrics::luminance;
use glam::Vec3;

/// Relative difference of the total irradiance's luminance across seams.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeamScore {
    /// Mean over the places compared.
    pub mean: f64,
    /// Largest.
    pub max: f64,
    /// Places compared.
    pub samples: usize,
}

/// Places compared per texel of an edge: twice as many as [`stitch`](super::stitch()) fits, none of them the same.
const PER_TEXEL: f32 = 4.0;
/// Share of the mean below which a value counts as this share, as in the project's relative RMSE.
const FLOOR: f64 = 0.01;

/// Mean and largest |a − b| / max((a + b)/2, 0.01 · mean), a and b the bilinear values on the two sides of a seam, the
/// mean that over all of them. Places that read a texel without value are left out. Zero without any seam.
pub fn seam_score(seams: &[Seam], atlas: &Atlas, pages: &[PageBuffers]) -> SeamScore {
    let pairs: Vec<[f64; 2]> = seams
        .iter()
        .flat_map(|seam| seam.samples(atlas, PER_TEXEL))
        .filter(|sides| sides.iter().all(|side| seams::is_readable(pages, side)))
        .map(|sides| sides.map(|side| luminance(total(pages, &side))))
        .collect();
    if pairs.is_empty() {
        return SeamScore::default();
    }
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / pairs.len() as f64;
    let floor = FLOOR * mean(&mut pairs.iter().map(|[a, b]| 0.5 * (a + b)));
    let relative = |[a, b]: &[f64; 2]| (a - b).abs() / (0.5 * (a + b)).max(floor).max(f64::MIN_POSITIVE);
    SeamScore {
        mean: mean(&mut pairs.iter().map(relative)),
        max: pairs.iter().map(relative).fold(0.0, f64::max),
        samples: pairs.len(),
    }
}

fn total(pages: &[PageBuffers], (page, lookup): &(u32, Bilinear)) -> Vec3 {
    lookup.used().map(|(texel, weight)| pages[*page as usize].total(texel) * weight).sum()
}
