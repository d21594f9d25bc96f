//! Baked light at points in space, from a package alone.
//!
//! A point belongs to the triangle nearest to it among those whose normal agrees with the point's. Values are bilinear
//! in that triangle's chart: of the four texels around the point only those count that lie in the chart (and were
//! baked, if any of them was), their weights renormalised, so that no other chart's light bleeds in.

mod csv;
mod page;
mod surface;

pub use csv::{PointsError, sample_csv};
pub use page::LightmapPage;
pub use surface::charts_of;

use crate::baked_scene::BakedScene;
use crate::error::{FormatError, Result};
use crate::package::Package;
use crate::term::Term;
use glam::{Vec2, Vec3};
use page::Coverage;
use surface::{Hit, Surface};

/// A package made ready for look-ups.
pub struct Sampler {
    terms: Vec<Term>,
    pages: Vec<LightmapPage>,
    coverage: Vec<Coverage>,
    surface: Surface,
}

/// Light at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Total irradiance, lux.
    pub irradiance: Vec3,
    /// The terms in the order of [`Sampler::terms`], lux.
    pub terms: Vec<Vec3>,
    /// Variance of the mean of the total, lux²: that of the weighted sum of independent texels.
    pub variance: Vec3,
    /// Path of the node.
    pub node: String,
    /// Index of the page.
    pub page: u32,
    /// Column and row of the texel that the point falls into.
    pub texel: [u32; 2],
    /// Distance of the point from the surface, metres.
    pub distance: f32,
}

impl Sampler {
    /// Reads geometry and pages.
    pub fn open(package: &Package) -> Result<Self> {
        let file = package.baked_scene();
        let path = package.path(&file);
        let scene = BakedScene::from_bytes(&path, &package.read(&file)?)?;
        let pages = LightmapPage::read_all(package)?;
        if let Some(node) =
            scene.nodes.iter().find(|n| n.lightmap.as_ref().is_some_and(|l| l.page as usize >= pages.len()))
        {
            let field = format!("node {}: page", node.path);
            return Err(FormatError::invalid(&path, field, "absent", "a page of the manifest; bake again"));
        }
        let surface = Surface::new(&scene);
        let sizes: Vec<_> = pages.iter().map(|page| [page.width, page.height]).collect();
        let coverage = Coverage::all(&surface, &sizes);
        Ok(Self { terms: package.manifest.terms.clone(), pages, coverage, surface })
    }

    /// The terms that samples have.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Light at `point` (metres, world axes of the glTF file) on a surface that faces along `normal` (need not be unit).
    /// `None` when no lightmapped surface faces that way, or an argument is not finite.
    pub fn sample(&self, point: Vec3, normal: Vec3) -> Option<Sample> {
        let normal = normal.try_normalize()?;
        let hit = point.is_finite().then(|| self.surface.nearest(point, normal)).flatten()?;
        Some(self.read(&hit))
    }

    fn read(&self, hit: &Hit) -> Sample {
        let triangle = &self.surface.triangles[hit.triangle as usize];
        let page = &self.pages[triangle.page as usize];
        let uv = triangle.uv_at(hit.barycentric);
        let texels = self.weights(page, &self.coverage[triangle.page as usize], triangle.chart, uv);
        let sum = |values: &[Vec3]| texels.iter().map(|&(index, weight)| weight * values[index]).sum::<Vec3>();
        let size = Vec2::new(page.width as f32, page.height as f32);
        let texel = (uv * size).clamp(Vec2::ZERO, size - 1.0).as_uvec2().to_array();
        Sample {
            irradiance: sum(&page.total),
            terms: page.terms.iter().map(|values| sum(values)).collect(),
            variance: texels.iter().map(|&(index, weight)| weight * weight * page.variance[index]).sum(),
            node: self.surface.nodes[triangle.node as usize].clone(),
            page: triangle.page,
            texel,
            distance: hit.distance,
        }
    }

    /// Texels around a page coordinate and their weights, which sum to 1.
    fn weights(&self, page: &LightmapPage, coverage: &Coverage, chart: u32, uv: Vec2) -> Vec<(usize, f32)> {
        let (width, height) = (page.width as i64, page.height as i64);
        let place = uv * Vec2::new(page.width as f32, page.height as f32) - 0.5;
        let corner = place.floor();
        let fraction = place - corner;
        let neighbours = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
            let x = (corner.x as i64 + dx).clamp(0, width - 1);
            let y = (corner.y as i64 + dy).clamp(0, height - 1);
            let along = |offset: i64, t: f32| if offset == 1 { t } else { 1.0 - t };
            ((y * width + x) as usize, along(dx, fraction.x) * along(dy, fraction.y))
        });
        let own: Vec<_> = neighbours.into_iter().filter(|&(index, _)| coverage.holds(index, chart)).collect();
        let baked: Vec<_> = own.iter().copied().filter(|&(index, _)| page.valid[index]).collect();
        // Baked texels of the chart; else filled ones; else whatever dilation left around it.
        let candidates = [baked, own, neighbours.to_vec()];
        let chosen = candidates.into_iter().find(|texels| texels.iter().map(|t| t.1).sum::<f32>() > 1e-4);
        let mut chosen = chosen.unwrap_or_else(|| neighbours.to_vec());
        let total: f32 = chosen.iter().map(|texel| texel.1).sum();
        chosen.iter_mut().for_each(|texel| texel.1 /= total);
        chosen
    }
}
