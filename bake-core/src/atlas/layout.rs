//! A flat mesh brought onto whole texels at a density.
//!
//! Each island (what packing moves as one) is scaled so that its bounding rectangle is a whole number n of texels
//! wide and high, and laid from texel centre to texel centre, covering n + 1 texels. So the outline of a rectangular
//! chart, a wall's, lies on bilinear nodes, and a bilinear lookup anywhere on a chart stays inside the n + 1 texels
//! of its rectangle: padding only has to take up rounding. Islands under half a texel keep their size in one texel.

use super::Layout;
use super::flatten::FlatMesh;
use super::pack::{self, Size, Spot};
use glam::{DVec2, Vec2};

/// Bounding rectangles of a flat mesh's islands, metres.
#[derive(Debug, Clone)]
pub(super) struct Islands {
    /// Lower corner and extent of each.
    bounds: Vec<(DVec2, DVec2)>,
}

/// A layout in texels: its rectangle and the places of its islands.
#[derive(Debug, Clone)]
pub(super) struct Arrangement {
    /// Texels of the layout's rectangle.
    pub size: Size,
    spots: Vec<Spot>,
}

/// Texels spanned between the outermost texel centres at a density; 0 for what stays inside one texel.
fn span(metres: f64, density: f64) -> u32 {
    // Beyond any page either way; packing then refuses it.
    (metres * density).round().min(1e6) as u32
}

impl Islands {
    pub fn of(flat: &FlatMesh) -> Self {
        let mut bounds = vec![(DVec2::INFINITY, DVec2::NEG_INFINITY); flat.islands() as usize];
        for (t, triangle) in flat.triangles.iter().enumerate() {
            let (low, high) = &mut bounds[flat.island(t)];
            for &v in triangle {
                let p = flat.position[v as usize].as_dvec2();
                (*low, *high) = (low.min(p), high.max(p));
            }
        }
        Self { bounds: bounds.into_iter().map(|(low, high)| (low, high - low)).collect() }
    }

    /// Texels of each island's rectangle.
    fn sizes(&self, density: f64) -> Vec<Size> {
        self.bounds.iter().map(|(_, extent)| [span(extent.x, density) + 1, span(extent.y, density) + 1]).collect()
    }

    /// Packs the islands into one rectangle no larger than `limit`; `None` where they do not fit.
    pub fn arrange(&self, density: f64, padding: u32, limit: u32) -> Option<Arrangement> {
        let (size, spots) = pack::enclose(&self.sizes(density), padding, limit)?;
        Some(Arrangement { size, spots })
    }

    /// The highest density up to `density` at which the islands fit, to 1 %; `None` where none does.
    pub fn arrange_at_most(&self, density: f64, padding: u32, limit: u32) -> Option<(f64, Arrangement)> {
        highest(density, |density| self.arrange(density, padding, limit))
    }

    /// Texture coordinates of the arrangement.
    pub fn layout(&self, flat: &FlatMesh, mesh: u32, density: f64, arrangement: &Arrangement) -> Layout {
        let size = DVec2::new(f64::from(arrangement.size[0]), f64::from(arrangement.size[1]));
        let mut uv = vec![Vec2::ZERO; flat.position.len()];
        for (t, triangle) in flat.triangles.iter().enumerate() {
            let island = flat.island(t);
            let (low, extent) = self.bounds[island];
            let at = arrangement.spots[island];
            let corner = DVec2::new(f64::from(at.x), f64::from(at.y));
            for &v in triangle {
                let p = flat.position[v as usize].as_dvec2() - low;
                let texel = corner + DVec2::new(along(p.x, extent.x, density), along(p.y, extent.y, density));
                uv[v as usize] = (texel / size).as_vec2();
            }
        }
        Layout {
            mesh,
            source_vertex: flat.source_vertex.clone(),
            uv,
            triangles: flat.triangles.clone(),
            chart: flat.chart.clone(),
            charts: flat.charts,
        }
    }
}

/// Texel coordinate within an island, along one axis.
fn along(offset: f64, extent: f64, density: f64) -> f64 {
    match span(extent, density) {
        0 => 0.5 + (offset - 0.5 * extent) * density,
        texels => 0.5 + offset / extent * f64::from(texels),
    }
}

/// The highest scale up to `most` that `attempt` accepts, to 1 %. The first accepted one on a falling ladder is
/// refined by bisection; that acceptance is nearly monotone is enough, as every answer was tried.
pub(super) fn highest<T>(most: f64, attempt: impl Fn(f64) -> Option<T>) -> Option<(f64, T)> {
    if let Some(found) = attempt(most) {
        return Some((most, found));
    }
    let (mut high, mut low) = (most, most * 0.5);
    let mut best = loop {
        match attempt(low) {
            Some(found) => break (low, found),
            // Thirty octaves down every island is one texel; lower changes nothing.
            None if low < most * 1e-9 => return None,
            None => (high, low) = (low, low * 0.5),
        }
    };
    while high > 1.01 * low {
        let middle = (low * high).sqrt();
        match attempt(middle) {
            Some(found) => (low, best) = (middle, (middle, found)),
            None => high = middle,
        }
    }
    Some(best)
}
