//! Pages in memory, and which chart each texel belongs to.

use super::surface::{Surface, Triangle};
use crate::error::{FormatError, Result};
use crate::package::Package;
use glam::{Vec2, Vec3};

/// The images of one page.
#[derive(Debug, Clone)]
pub struct LightmapPage {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Total irradiance, lux.
    pub total: Vec<Vec3>,
    /// The package's terms in their order, lux.
    pub terms: Vec<Vec<Vec3>>,
    /// Variance of the mean of the total, lux².
    pub variance: Vec<Vec3>,
    /// Whether a texel was baked.
    pub valid: Vec<bool>,
}

impl LightmapPage {
    /// All pages of a package.
    pub fn read_all(package: &Package) -> Result<Vec<Self>> {
        (0..package.manifest.pages.len()).map(|index| Self::read(package, index)).collect()
    }

    fn read(package: &Package, index: usize) -> Result<Self> {
        let record = &package.manifest.pages[index];
        let (lightmap, terms) = (package.image(&record.lightmap)?, package.image(&record.terms)?);
        for (file, image) in [(&record.lightmap, &lightmap), (&record.terms, &terms)] {
            if (image.width, image.height) != (record.width, record.height) {
                let (found, expected) = (format!("{} x {}", image.width, image.height), "the size in the manifest");
                return Err(FormatError::invalid(&package.path(file), "size", found, expected));
            }
        }
        let missing = |file: &str, channel: &str| {
            FormatError::invalid(
                &package.path(file),
                format!("channels {channel}"),
                "absent",
                "one of each page; bake again",
            )
        };
        let part = |name: &str| terms.rgb(name).ok_or_else(|| missing(&record.terms, name));
        let validity = terms.channel("validity.Y").ok_or_else(|| missing(&record.terms, "validity.Y"))?;
        Ok(Self {
            width: record.width,
            height: record.height,
            total: lightmap.rgb("").ok_or_else(|| missing(&record.lightmap, "R G B"))?,
            terms: package.manifest.terms.iter().map(|term| part(term.name())).collect::<Result<_>>()?,
            variance: part("variance")?,
            valid: validity.iter().map(|&valid| valid > 0.5).collect(),
        })
    }
}

/// Charts by texel. A texel belongs to a chart when the chart's triangles touch its square; two charts may share one.
#[derive(Debug, Clone)]
pub(super) struct Coverage {
    /// Up to two charts a texel, [`NO_CHART`] where there is none.
    charts: Vec<[u32; 2]>,
}

/// No chart has this number.
const NO_CHART: u32 = u32::MAX;

impl Coverage {
    /// Coverage of pages of the given sizes by a surface.
    pub fn all(surface: &Surface, sizes: &[[u32; 2]]) -> Vec<Self> {
        let mut pages: Vec<_> =
            sizes.iter().map(|[w, h]| Self { charts: vec![[NO_CHART; 2]; *w as usize * *h as usize] }).collect();
        for triangle in &surface.triangles {
            let page = triangle.page as usize;
            pages[page].cover(triangle, sizes[page]);
        }
        pages
    }

    /// Whether a texel belongs to a chart.
    pub fn holds(&self, texel: usize, chart: u32) -> bool {
        self.charts[texel].contains(&chart)
    }

    fn cover(&mut self, triangle: &Triangle, [width, height]: [u32; 2]) {
        let size = Vec2::new(width as f32, height as f32);
        let corners = triangle.uv.map(|uv| uv * size);
        let low = corners[0].min(corners[1]).min(corners[2]).floor().clamp(Vec2::ZERO, size - 1.0).as_uvec2();
        let high = corners[0].max(corners[1]).max(corners[2]).floor().clamp(Vec2::ZERO, size - 1.0).as_uvec2();
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                if touches(corners, Vec2::new(x as f32, y as f32)) {
                    self.add(y as usize * width as usize + x as usize, triangle.chart);
                }
            }
        }
    }

    fn add(&mut self, texel: usize, chart: u32) {
        let charts = &mut self.charts[texel];
        if !charts.contains(&chart)
            && let Some(free) = charts.iter_mut().find(|c| **c == NO_CHART)
        {
            *free = chart;
        }
    }
}

/// Whether a triangle and the unit square at `corner` overlap: no edge normal of the triangle separates them (their
/// bounding boxes overlap already). Separating axis theorem.
fn touches(triangle: [Vec2; 3], corner: Vec2) -> bool {
    let center = corner + 0.5;
    (0..3).all(|i| {
        let (from, to, other) = (triangle[i], triangle[(i + 1) % 3], triangle[(i + 2) % 3]);
        let axis = (to - from).perp();
        let [edge, apex] = [axis.dot(from), axis.dot(other)];
        let (low, high) = (edge.min(apex), edge.max(apex));
        let (middle, reach) = (axis.dot(center), 0.5 * (axis.x.abs() + axis.y.abs()));
        middle - reach <= high && middle + reach >= low
    })
}
