//! Where the light grid lies and how fine it may be: what settings and plan know of it without solving any air.

use bake_optics::medium::MediumSet;
use glam::{DVec3, Vec3};

/// Largest distance of nodes, in mean free paths. Under four of them, albedo 0.8 and a sky, 0.45 (impulse responses, section 12.5)
/// is 1.9 % too bright on the ground, this 1.5 %: the quadrature of the grid's border.
pub const MOST_FREE_PATHS: f64 = 0.4;
/// Side of the cube that holds as many cells as there may be.
pub const MOST_CELLS: u32 = 40;

/// How fine the grid is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridSettings {
    /// Cells at least, along the side of a cube of the region's volume.
    pub cells: u32,
    /// Samples a node.
    pub samples: u32,
}

/// Side of a cube of a region's volume, m: what cells are counted along, so that halls and yards take as many as rooms. A
/// region much thinner one way counts as a twentieth thick.
pub(crate) fn side(size: DVec3) -> f64 {
    size.max(DVec3::splat(0.05 * size.max_element())).element_product().cbrt()
}

/// The box in which light is gathered: around what scatters, or around the scene where that has no end.
pub(crate) fn region(set: &MediumSet, [low, high]: [Vec3; 2]) -> (Vec3, Vec3) {
    // Air that goes on much farther than the scene is lit there as on the border.
    let margin = (high - low).max_element();
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for medium in set.media.iter().filter(|m| m.scatter.sigma_s.iter().any(|&s| s > 0.0)) {
        let [a, b] = medium.bounds.bounding_box().map(|corner| corner.as_vec3());
        min = min.min(a.max(low - margin));
        max = max.max(b.min(high + margin));
    }
    (min, max.max(min + 1e-3))
}
