//! The parts of the baked light in memory: what lightmap pages can show instead of the total, and what a texel holds.

use bake_formats::sample::LightmapPage;
use bake_formats::{Package, Term};
use glam::{Vec2, Vec3};

use crate::error::Result;

/// What lightmap pages can hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PageContent {
    /// The sum of some terms; those that were not baked are dark.
    Terms(Vec<Term>),
    /// The standard error as a share of the total, grey.
    RelativeError,
    /// 1 where texels were baked, 0 where they were filled from their neighbours or are empty.
    Validity,
}

/// The pages of a package with their terms.
#[derive(Debug, Clone)]
pub struct TermPages {
    terms: Vec<Term>,
    pages: Vec<LightmapPage>,
}

/// What was baked at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Column and row of the texel that the place falls into.
    pub texel: [u32; 2],
    /// Total irradiance, lux, bilinear as it is drawn.
    pub irradiance: Vec3,
    /// Its terms, lux, likewise.
    pub terms: Vec<(Term, Vec3)>,
    /// Standard error of the texel's total, lux.
    pub standard_error: Vec3,
    /// Whether the texel was baked, not filled from its neighbours.
    pub valid: bool,
}

impl TermPages {
    /// Reads all pages of a package.
    pub fn open(package: &Package) -> Result<Self> {
        Ok(Self { terms: package.manifest.terms.clone(), pages: LightmapPage::read_all(package)? })
    }

    /// Terms that were baked.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Number of pages.
    pub fn len(&self) -> usize {
        self.pages.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pages.is_empty()
    }

    /// Texels of a page that shows `content`.
    pub fn texels(&self, page: usize, content: &PageContent) -> Vec<[f32; 3]> {
        let page = &self.pages[page];
        match content {
            PageContent::Terms(shown) if self.terms.iter().all(|term| shown.contains(term)) => {
                page.total.iter().map(|e| e.to_array()).collect()
            }
            PageContent::Terms(shown) => {
                let parts: Vec<_> =
                    self.terms.iter().zip(&page.terms).filter(|(term, _)| shown.contains(term)).collect();
                let sum = |texel: usize| parts.iter().map(|(_, part)| part[texel]).sum::<Vec3>().to_array();
                (0..page.total.len()).map(sum).collect()
            }
            PageContent::RelativeError => {
                let mean = |v: Vec3| v.element_sum() / 3.0;
                let share = |(v, e): (&Vec3, &Vec3)| [mean(*v).max(0.0).sqrt() / mean(*e).max(1e-20); 3];
                page.variance.iter().zip(&page.total).map(share).collect()
            }
            PageContent::Validity => page.valid.iter().map(|&valid| [f32::from(u8::from(valid)); 3]).collect(),
        }
    }

    /// What was baked at a page coordinate; `None` beyond the page.
    pub fn read(&self, page: usize, uv: Vec2) -> Option<Reading> {
        let page = self.pages.get(page)?;
        let size = Vec2::new(page.width as f32, page.height as f32);
        if !(uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()) {
            return None;
        }
        let texel = (uv * size).as_uvec2().to_array();
        let texel = [texel[0].min(page.width - 1), texel[1].min(page.height - 1)];
        let at = (texel[1] * page.width + texel[0]) as usize;
        let terms = self.terms.iter().zip(&page.terms).map(|(&term, part)| (term, bilinear(page, part, uv)));
        Some(Reading {
            texel,
            irradiance: bilinear(page, &page.total, uv),
            terms: terms.collect(),
            standard_error: page.variance[at].max(Vec3::ZERO).map(f32::sqrt),
            valid: page.valid[at],
        })
    }
}

/// As `shaders/lightmap.wgsl` does it.
fn bilinear(page: &LightmapPage, values: &[Vec3], uv: Vec2) -> Vec3 {
    let last = glam::IVec2::new(page.width as i32 - 1, page.height as i32 - 1);
    let place = uv * (last + 1).as_vec2() - 0.5;
    let low = place.floor();
    let share = place - low;
    let texel = |dx: i32, dy: i32| {
        let at = (low.as_ivec2() + glam::IVec2::new(dx, dy)).clamp(glam::IVec2::ZERO, last);
        values[(at.y * (last.x + 1) + at.x) as usize]
    };
    texel(0, 0).lerp(texel(1, 0), share.x).lerp(texel(0, 1).lerp(texel(1, 1), share.x), share.y)
}
