//! Images of a package: lightmap pages, and light stored at points in space.

use bake_formats::float_image::FloatImage;
use bake_formats::manifest::ProbeGrid;
use bake_formats::{Manifest, Package};
use glam::Vec3;

use crate::error::{Result, RuntimeError};
use crate::sky::SkyPicture;

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

/// The environment's picture.
pub(super) fn read_sky(package: &Package) -> Result<Option<SkyPicture>> {
    let Some(record) = &package.manifest.environment else { return Ok(None) };
    let Some(file) = &record.file else { return Ok(None) };
    let image = package.image(file)?;
    let radiance = rgb(&image, file, "")?;
    Ok(Some(SkyPicture { width: image.width, height: image.height, radiance, rotation: record.rotation }))
}

/// Light at points in space as `bands`² harmonics, and where each point's light was gathered.
pub(super) fn read_lattice(package: &Package, grid: &ProbeGrid, bands: usize) -> Result<(LatticeData, Vec<Vec3>)> {
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
    let harmonics = (0..bands * bands).map(layer).collect::<Result<_>>()?;
    let offset = |at: usize| {
        Vec3::from(["X", "Y", "Z"].map(|axis| image.channel(&format!("offset.{axis}")).map_or(0.0, |o| o[at])))
    };
    let place = |at: usize| {
        let (x, y) = (at as u32 % image.width, at as u32 / image.width);
        grid.origin + grid.spacing * Vec3::new((x % nx) as f32, y as f32, (x / nx) as f32) + offset(at)
    };
    let places = (0..image.len()).map(place).collect();
    Ok((LatticeData { origin: grid.origin, spacing: grid.spacing, count: grid.count, harmonics }, places))
}

/// The three channels of a prefix.
fn rgb(image: &FloatImage, file: &str, prefix: &str) -> Result<Vec<[f32; 3]>> {
    image.rgb(prefix).ok_or_else(|| RuntimeError::Record {
        field: format!("{file}: channels"),
        value: image.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(" "),
        expected: format!("it must hold {prefix}.R, G and B; bake again"),
    })
}
