//! Two packages of one layout compared: errors of the total and of each term, the worst texels, a false-colour image.

use crate::error::{FormatError, Result};
use crate::metrics::{self, Metrics};
use crate::package::Package;
use crate::sample::LightmapPage;
use glam::Vec3;
use serde::Serialize;

/// Number of worst texels reported.
const WORST: usize = 10;

/// Relative error of luminance that the false-colour image shows as pure red (more) or blue (less).
pub const FULL_COLOR: f64 = 0.2;

/// How a package differs from a truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diff {
    /// Of the total irradiance, all pages together.
    pub total: Metrics,
    /// Of each term that both have.
    pub terms: Vec<TermDiff>,
    /// The texels of largest error, largest first.
    pub worst: Vec<TexelDiff>,
}

/// How a term differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TermDiff {
    /// Name of the term.
    pub term: &'static str,
    /// Its errors.
    pub metrics: Metrics,
}

/// A texel's difference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TexelDiff {
    /// Index of the page.
    pub page: usize,
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Error of luminance over the truth's, floored as in [`metrics`].
    pub relative_error: f64,
    /// Total of the first package, lux.
    pub bake: Vec3,
    /// Total of the second, lux.
    pub truth: Vec3,
}

/// A comparison in the making.
pub struct Comparison {
    bake: Vec<LightmapPage>,
    truth: Vec<LightmapPage>,
    names: Vec<(&'static str, usize, usize)>,
    mean: f64,
}

impl Comparison {
    /// Reads both packages. Errors: other pages, or no texel that both baked.
    pub fn open(bake: &Package, truth: &Package) -> Result<Self> {
        let pages = |package: &Package| {
            package
                .manifest
                .pages
                .iter()
                .map(|page| format!("{}x{}", page.width, page.height))
                .collect::<Vec<_>>()
                .join(", ")
        };
        if pages(bake) != pages(truth) {
            let expected = format!("{}, as in the other package; bake both with the same texel density", pages(truth));
            return Err(FormatError::invalid(&bake.path(""), "pages", pages(bake), expected));
        }
        let terms = &bake.manifest.terms;
        let names = terms.iter().enumerate().filter_map(|(at, term)| {
            let other = truth.manifest.terms.iter().position(|other| other == term)?;
            Some((term.name(), at, other))
        });
        let names = names.collect();
        let mut comparison =
            Self { bake: LightmapPage::read_all(bake)?, truth: LightmapPage::read_all(truth)?, names, mean: 0.0 };
        let levels: Vec<f64> =
            comparison.texels().map(|(page, at)| metrics::luminance(comparison.truth[page].total[at])).collect();
        if levels.is_empty() {
            return Err(FormatError::invalid(
                &bake.path(""),
                "texels",
                "none in common",
                "texels that both packages baked",
            ));
        }
        comparison.mean = levels.iter().sum::<f64>() / levels.len() as f64;
        Ok(comparison)
    }

    /// Page and index of every texel that both baked.
    fn texels(&self) -> impl Iterator<Item = (usize, usize)> {
        let pages = self.bake.iter().zip(&self.truth).enumerate();
        pages.flat_map(|(page, (bake, truth))| {
            let both = (0..bake.valid.len()).filter(|&at| bake.valid[at] && truth.valid[at]);
            both.map(move |at| (page, at))
        })
    }

    fn relative_error(&self, page: usize, at: usize) -> f64 {
        let [b, t] = [&self.bake, &self.truth].map(|pages| metrics::luminance(pages[page].total[at]));
        let floor = t.max(metrics::FLOOR * self.mean);
        if b == t { 0.0 } else { (b - t) / floor }
    }

    /// The numbers. With `subtract_noise` the variance that the truth states is taken off the total's squared error.
    pub fn diff(&self, subtract_noise: bool) -> Diff {
        let gather = |pages: &[LightmapPage], pick: &dyn Fn(&LightmapPage) -> &[Vec3]| -> Vec<Vec3> {
            self.texels().map(|(page, at)| pick(&pages[page])[at]).collect()
        };
        let valid = vec![true; self.texels().count()];
        let variance = subtract_noise.then(|| gather(&self.truth, &|page| &page.variance));
        let [bake, truth] = [&self.bake, &self.truth].map(|pages| gather(pages, &|page| &page.total));
        let total = metrics::compare(&bake, &truth, &valid, variance.as_deref());
        let terms = self.names.iter().map(|&(term, a, b)| {
            let (bake, truth) =
                (gather(&self.bake, &|page| &page.terms[a]), gather(&self.truth, &|page| &page.terms[b]));
            TermDiff { term, metrics: metrics::compare(&bake, &truth, &valid, None) }
        });
        Diff { total, terms: terms.collect(), worst: self.worst() }
    }

    fn worst(&self) -> Vec<TexelDiff> {
        let mut errors: Vec<_> = self.texels().map(|(page, at)| (self.relative_error(page, at), page, at)).collect();
        errors.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()).then((a.1, a.2).cmp(&(b.1, b.2))));
        errors.truncate(WORST);
        let texel = |(relative_error, page, at): (f64, usize, usize)| {
            let (bake, truth) = (&self.bake[page], &self.truth[page]);
            let (x, y) = (at as u32 % bake.width, at as u32 / bake.width);
            TexelDiff { page, x, y, relative_error, bake: bake.total[at], truth: truth.total[at] }
        };
        errors.into_iter().map(texel).collect()
    }

    /// Number of pages.
    pub fn pages(&self) -> usize {
        self.bake.len()
    }

    /// PNG of a page: see [`false_color`].
    pub fn false_color(&self, page: usize) -> Vec<u8> {
        let (bake, truth) = (&self.bake[page], &self.truth[page]);
        let error = |at: usize| (bake.valid[at] && truth.valid[at]).then(|| self.relative_error(page, at));
        false_color(bake.width, bake.height, &(0..bake.valid.len()).map(error).collect::<Vec<_>>())
    }
}

/// PNG of signed relative errors, row by row: white is equal, red too bright, blue too dark, full at [`FULL_COLOR`];
/// black was not compared. Panics unless there is one entry a texel.
pub fn false_color(width: u32, height: u32, errors: &[Option<f64>]) -> Vec<u8> {
    let texels = errors.iter().flat_map(|error| {
        let Some(error) = error else { return [0; 3] };
        let share = (error / FULL_COLOR).clamp(-1.0, 1.0);
        let rest = (255.0 * (1.0 - share.abs())).round() as u8;
        if share > 0.0 { [255, rest, rest] } else { [rest, rest, 255] }
    });
    let image = image::RgbImage::from_raw(width, height, texels.collect()).expect("three bytes a texel");
    let mut png = std::io::Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).expect("memory takes a PNG");
    png.into_inner()
}
