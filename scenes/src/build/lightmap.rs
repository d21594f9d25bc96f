//! Lightmap coordinates of a mesh: its patches' charts laid out in the unit square without overlap.

use super::patch::Patch;
use glam::DVec2;

/// Room around each chart as a share of the square: 2 texels where the mesh gets 64.
pub const GUTTER: f64 = 1.0 / 32.0;

/// Place of each patch's chart: multiply chart coordinates by `scale` and add `offset`.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Square widths per metre, the same for all charts.
    pub scale: f64,
    /// Offset of each chart, in the order of the patches.
    pub offsets: Vec<DVec2>,
}

/// Lays out charts on shelves, tallest first, at the largest scale that fits.
pub fn layout(patches: &[Patch]) -> Layout {
    let bounds: Vec<_> = patches.iter().map(Patch::chart_bounds).collect();
    let sizes: Vec<DVec2> = bounds.iter().map(|(min, max)| *max - *min).collect();
    let (mut fits, mut fails) = (0.0, 1.0 / sizes.iter().map(|s| s.max_element()).fold(f64::MIN_POSITIVE, f64::max));
    for _ in 0..40 {
        let scale = 0.5 * (fits + fails);
        if shelves(&sizes, scale).is_some() { fits = scale } else { fails = scale }
    }
    let corners = shelves(&sizes, fits).expect("too many charts for the gutter");
    let offsets = corners.iter().zip(&bounds).map(|(corner, (min, _))| *corner - *min * fits).collect();
    Layout { scale: fits, offsets }
}

/// Lower corner of each chart, or nothing when they do not fit at this scale.
fn shelves(sizes: &[DVec2], scale: f64) -> Option<Vec<DVec2>> {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&a, &b| sizes[b].y.total_cmp(&sizes[a].y));
    let mut corners = vec![DVec2::ZERO; sizes.len()];
    let (mut cursor, mut shelf_top) = (DVec2::splat(GUTTER), GUTTER);
    for index in order {
        let size = sizes[index] * scale + GUTTER;
        if cursor.x + size.x > 1.0 {
            cursor = DVec2::new(GUTTER, shelf_top);
        }
        if cursor.x + size.x > 1.0 || cursor.y + size.y > 1.0 {
            return None;
        }
        corners[index] = cursor;
        cursor.x += size.x;
        shelf_top = shelf_top.max(cursor.y + size.y);
    }
    Some(corners)
}
