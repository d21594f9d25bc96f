//! Images of a package: lightmap pages, and light stored at points in space.

use bake_formats::float_image::FloatImage;
use bake_formats::manifest::ProbeGrid;
use bake_formats::{Manifest, Package};
use glam::{UVec3, Vec3};

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

/// Cells across at most of a lattice that stands for listed points.
const MOST_ACROSS: f32 = 24.0;

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

/// Light at points as it was stored.
#[derive(Debug, Clone)]
pub(super) struct Stored {
    pub data: LatticeData,
    /// Where each point's light was gathered.
    pub places: Vec<Vec3>,
    /// Whether points lie where a list says, not at equal distances.
    is_listed: bool,
}

impl Stored {
    /// A lattice to draw with: of listed points, one over the box around them whose points take the nearest that was baked.
    pub fn into_even(self) -> LatticeData {
        let Self { data, places, is_listed } = self;
        let is_baked = |at: &usize| data.harmonics[0][*at][3] > 0.0;
        let Some(first) = (0..places.len()).find(is_baked).filter(|_| is_listed) else { return data };
        let start = (places[first], places[first]);
        let baked = || (0..places.len()).filter(is_baked);
        let (low, high) = baked().fold(start, |(low, high), at| (low.min(places[at]), high.max(places[at])));
        let cell = data.spacing.max_element().max((high - low).max_element() / MOST_ACROSS);
        let [nx, ny, nz] = ((high - low) / cell).ceil().as_uvec3().to_array().map(|cells| cells + 1);
        let nearest = |at: u32| {
            let step = UVec3::new(at % nx, at / (nx * nz), at / nx % nz);
            let place = low + cell * step.as_vec3();
            let distance = |at: usize| places[at].distance_squared(place);
            baked().min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(first)
        };
        let nearest: Vec<usize> = (0..nx * ny * nz).map(nearest).collect();
        let taken = |layer: &Vec<[f32; 4]>| nearest.iter().map(|&at| layer[at]).collect();
        let harmonics = data.harmonics.iter().map(taken).collect();
        LatticeData { origin: low, spacing: Vec3::splat(cell), count: [nx, ny, nz], harmonics }
    }
}

/// Light at points in space as `bands`² harmonics.
pub(super) fn read_lattice(package: &Package, grid: &ProbeGrid, bands: usize) -> Result<Stored> {
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
        let even = grid.origin + grid.spacing * Vec3::new((x % nx) as f32, y as f32, (x / nx) as f32);
        grid.points.get(at).copied().unwrap_or(even) + offset(at)
    };
    let places = (0..image.len()).map(place).collect();
    let data = LatticeData { origin: grid.origin, spacing: grid.spacing, count: grid.count, harmonics };
    Ok(Stored { data, places, is_listed: !grid.points.is_empty() })
}

/// The three channels of a prefix.
fn rgb(image: &FloatImage, file: &str, prefix: &str) -> Result<Vec<[f32; 3]>> {
    image.rgb(prefix).ok_or_else(|| RuntimeError::Record {
        field: format!("{file}: channels"),
        value: image.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(" "),
        expected: format!("it must hold {prefix}.R, G and B; bake again"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three points, the middle one not baked: every place takes the nearer of the other two.
    #[test]
    fn listed_points_are_spread_over_their_box() {
        let places = vec![Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(4.0, 1.0, 0.0)];
        let harmonics = vec![vec![[1.0, 0.0, 0.0, 1.0], [0.0; 4], [3.0, 0.0, 0.0, 1.0]]];
        let data = LatticeData { origin: Vec3::ZERO, spacing: Vec3::ONE, count: [3, 1, 1], harmonics };
        let stored = Stored { data: data.clone(), places, is_listed: true };
        let even = stored.clone().into_even();
        assert_eq!((even.origin, even.spacing, even.count), (Vec3::ZERO, Vec3::ONE, [5, 2, 1]));
        let reds: Vec<f32> = even.harmonics[0].iter().map(|texel| texel[0]).collect();
        assert_eq!(reds, [1.0, 1.0, 1.0, 3.0, 3.0, 1.0, 1.0, 3.0, 3.0, 3.0]);
        assert_eq!(Stored { is_listed: false, ..stored.clone() }.into_even(), data, "even points stay as they are");
        let mut dark = stored;
        dark.data.harmonics[0].iter_mut().for_each(|texel| texel[3] = 0.0);
        assert_eq!(dark.clone().into_even(), dark.data, "nothing to take");
    }
}
