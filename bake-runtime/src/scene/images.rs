//! Images of a package: lightmap pages and what else can lie on them, and light stored at points in space.

use bake_formats::float_image::FloatImage;
use bake_formats::manifest::ProbeGrid;
use bake_formats::{Manifest, Package, Term};
use glam::Vec3;

use super::SceneData;
use crate::error::{Result, RuntimeError};

/// A lightmap page.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Irradiance, lux.
    pub irradiance: Vec<[f32; 3]>,
    /// Harmonics l ≤ 1 of incident radiance, four lists.
    pub sh1: Option<Vec<Vec<[f32; 3]>>>,
}

/// Light at the points of a lattice; point (ix, iy, iz) is texel x = ix + nx·iz, y = iy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LatticeData {
    /// Position of the first point, metres.
    pub origin: Vec3,
    /// Distance of neighbours, metres.
    pub spacing: Vec3,
    /// Points along each axis.
    pub count: [u32; 3],
    /// One list a harmonic, 4 or 9 of them: incident radiance, cd/m², and 1 where the point was baked, else 0.
    pub harmonics: Vec<Vec<[f32; 4]>>,
}

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

impl PageContent {
    /// Texels from the terms' image `file`; `total` is the page's irradiance.
    fn texels(&self, image: &FloatImage, file: &str, total: &[[f32; 3]]) -> Result<Vec<[f32; 3]>> {
        let mean = |[r, g, b]: [f32; 3]| (r + g + b) / 3.0;
        Ok(match self {
            Self::Terms(terms) => {
                let known = terms.iter().filter_map(|term| image.rgb::<Vec3>(term.name()));
                let sum = known.fold(vec![Vec3::ZERO; image.len()], |sum, texels| {
                    sum.iter().zip(texels).map(|(a, b)| *a + b).collect()
                });
                sum.into_iter().map(Vec3::into).collect()
            }
            Self::RelativeError => {
                let variance = rgb(image, file, "variance")?;
                let share = |(v, e): (&[f32; 3], &[f32; 3])| [mean(*v).max(0.0).sqrt() / mean(*e).max(1e-20); 3];
                variance.iter().zip(total).map(share).collect()
            }
            Self::Validity => {
                let valid = image.channel("validity.Y").map(<[f32]>::to_vec);
                valid.unwrap_or_else(|| vec![1.0; image.len()]).into_iter().map(|v| [v; 3]).collect()
            }
        })
    }
}

impl SceneData {
    /// Puts something else on the lightmap pages than the total.
    pub fn fill_pages(&mut self, package: &Package, content: &PageContent) -> Result<()> {
        for (page, record) in self.pages.iter_mut().zip(&package.manifest.pages) {
            page.irradiance = content.texels(&package.image(&record.terms)?, &record.terms, &page.irradiance)?;
        }
        Ok(())
    }
}

/// All pages of a package.
pub(super) fn read_pages(package: &Package) -> Result<Vec<Page>> {
    let manifest: &Manifest = &package.manifest;
    manifest
        .pages
        .iter()
        .map(|record| {
            let image = package.image(&record.lightmap)?;
            let sh1 = record.sh1.as_ref().map(|file| -> Result<_> {
                let image = package.image(file)?;
                (0..4).map(|index| rgb(&image, file, &format!("c{index}"))).collect::<Result<Vec<_>>>()
            });
            let irradiance = rgb(&image, &record.lightmap, "")?;
            Ok(Page { width: image.width, height: image.height, irradiance, sh1: sh1.transpose()? })
        })
        .collect()
}

/// The probes of a package.
pub(super) fn read_probes(package: &Package, grid: &ProbeGrid) -> Result<LatticeData> {
    let image = package.image(&grid.file)?;
    let [nx, ny, nz] = grid.count;
    if u64::from(image.width) != u64::from(nx) * u64::from(nz) || image.height != ny {
        let value = format!("{} x {}", image.width, image.height);
        let expected = format!("{nx} x {ny} x {nz} points fill {} x {ny}; bake again", u64::from(nx) * u64::from(nz));
        return Err(RuntimeError::Record { field: format!("{}: size", grid.file), value, expected });
    }
    let valid = image.channel("validity.Y");
    let layer = |index: usize| -> Result<Vec<[f32; 4]>> {
        let values = rgb(&image, &grid.file, &format!("c{index}"))?;
        let alpha = |at: usize| valid.map_or(1.0, |valid| valid[at]);
        Ok(values.iter().enumerate().map(|(at, &[r, g, b])| [r, g, b, alpha(at)]).collect())
    };
    let harmonics = (0..9).map(layer).collect::<Result<_>>()?;
    Ok(LatticeData { origin: grid.origin, spacing: grid.spacing, count: grid.count, harmonics })
}

/// The three channels of a prefix.
fn rgb(image: &FloatImage, file: &str, prefix: &str) -> Result<Vec<[f32; 3]>> {
    image.rgb(prefix).ok_or_else(|| RuntimeError::Record {
        field: format!("{file}: channels"),
        value: image.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(" "),
        expected: format!("it must hold {prefix}.R, G and B; bake again"),
    })
}
