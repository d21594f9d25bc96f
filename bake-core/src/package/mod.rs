//! From scene, atlas and solved buffers to a package on disk.
//!
//! Nothing is computed here but what a record asks for (an error estimate, a preview, a light profile as Legendre
//! polynomials); pixels go out as they came in.

mod baked;
mod images;
mod lights;
mod material;

use crate::air::Air;
use crate::atlas::Atlas;
use crate::scene::{Environment, Scene};
use crate::solve::PageReport;
use crate::solve::buffers::PageBuffers;
use crate::solve::kept_size::FILE_SUFFIX;
use crate::solve::lattice::Lattice;
use crate::solve::points::LatticeLight;
use bake_formats::error::Result;
use bake_formats::float_image::{FloatImage, PixelFormat};
use bake_formats::manifest::{EnvironmentRecord, ErrorEstimate, Manifest, PageRecord, ProbeGrid, Settings, Source};
use bake_formats::medium::{MediumRecord, density_image};
use bake_formats::{PackageWriter, Term};
use glam::Vec3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// What was baked.
#[derive(Debug, Clone, Copy)]
pub struct Bake<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The air in it.
    pub air: &'a Air,
    /// Where its surfaces lie.
    pub atlas: &'a Atlas,
    /// One a page of the atlas, after post-processing.
    pub pages: &'a [PageBuffers],
    /// How these went.
    pub reports: &'a [PageReport],
    /// The same before post-processing, when they are to be kept.
    pub raw: Option<&'a [PageBuffers]>,
    /// Pages of the scene without air, after post-processing, when their total is to be kept.
    pub vacuum: Option<&'a [PageBuffers]>,
    /// Light at probes.
    pub probes: Option<&'a LatticeLight>,
    /// Light at the cells of the fog volume.
    pub fog_volume: Option<&'a LatticeLight>,
}

/// What the manifest says about how it was baked.
#[derive(Debug, Clone)]
pub struct Record {
    /// File name and BLAKE3 of the scene.
    pub source: Source,
    /// All settings.
    pub settings: Value,
    /// Which effects were simulated, and why.
    pub plan: Value,
    /// What should be looked at.
    pub warnings: Vec<String>,
    /// False under a time budget.
    pub reproducible: bool,
    /// Number format of images.
    pub pixels: PixelFormat,
}

/// Writes the package into `folder`; returns the manifest's path. Files appear under their names only when all could
/// be written. Panics unless `bake.pages` fits the atlas.
pub fn write(folder: &Path, bake: Bake, record: &Record) -> Result<PathBuf> {
    write_with(folder, bake, record, None)
}

/// The same with a file of kept paths, which lies in `folder` already.
pub fn write_with(folder: &Path, bake: Bake, record: &Record, paths: Option<NamedTempFile>) -> Result<PathBuf> {
    assert_eq!(bake.pages.len(), bake.atlas.pages.len(), "one set of buffers a page");
    let mut writer = PackageWriter::create(folder, &bake.scene.name)?;
    let mut manifest = Manifest::new(&bake.scene.name, record.source.clone(), Settings::new(record.settings.clone()));
    for (index, page) in bake.pages.iter().enumerate() {
        let beside = [bake.raw, bake.vacuum].map(|pages| pages.map(|pages| &pages[index]));
        manifest.pages.push(write_page(&mut writer, index, page, beside, record.pixels)?);
    }
    let mut lattice = |kind: &str, light: Option<&LatticeLight>, coefficients| {
        light.map(|light| write_lattice(&mut writer, kind, &images::lattice(light, coefficients), light, record.pixels))
    };
    manifest.probes = lattice("probes", bake.probes, 9).transpose()?;
    manifest.fog_volume = lattice("fog", bake.fog_volume, 4).transpose()?;
    paths.map(|paths| writer.add_file(FILE_SUFFIX, paths)).transpose()?;
    let (baked, instances) = baked::scene(bake, &manifest.pages, lights::records(&bake.scene.lights));
    let path = folder.join(writer.file_name("baked.glb"));
    writer.add_bytes("baked.glb", &baked.to_bytes(&path)?)?;
    manifest.lights = baked.lights;
    manifest.instances = instances;
    manifest.terms = terms(bake.pages);
    manifest.environment =
        bake.scene.environment.as_ref().map(|e| write_environment(&mut writer, e, record.pixels)).transpose()?;
    manifest.error_estimate = error_estimate(bake.reports);
    manifest.reproducible = record.reproducible;
    manifest.plan = record.plan.clone();
    manifest.media = write_media(&mut writer, bake.air)?;
    manifest.warnings = record.warnings.clone();
    writer.finish(manifest)
}

fn write_page(
    writer: &mut PackageWriter,
    index: usize,
    page: &PageBuffers,
    [raw, vacuum]: [Option<&PageBuffers>; 2],
    pixels: PixelFormat,
) -> Result<PageRecord> {
    let mut add = |kind: &str, image: FloatImage| writer.add_image(&format!("{kind}.{index:02}.exr"), &image, pixels);
    Ok(PageRecord {
        width: page.width,
        height: page.height,
        lightmap: add("lightmap", images::lightmap(page))?,
        terms: add("terms", images::terms(page, vacuum))?,
        sh1: images::sh1(page).map(|image| add("sh1", image)).transpose()?,
        raw: raw.map(|raw| add("raw", images::terms(raw, None))).transpose()?,
    })
}

fn write_lattice(
    writer: &mut PackageWriter,
    kind: &str,
    image: &FloatImage,
    light: &LatticeLight,
    pixels: PixelFormat,
) -> Result<ProbeGrid> {
    let file = writer.add_image(&format!("{kind}.exr"), image, pixels)?;
    let seen =
        images::visibility(light).map(|image| writer.add_image(&format!("{kind}.visibility.exr"), &image, pixels));
    let Lattice { origin, spacing, count, listed } = light.lattice.clone();
    Ok(ProbeGrid { file, visibility: seen.transpose()?, origin, spacing, count: count.to_array(), points: listed })
}

/// Records of the media; density grids go into images, in full precision because they are no result.
fn write_media(writer: &mut PackageWriter, air: &Air) -> Result<Vec<Value>> {
    let mut records = Vec::new();
    for (index, (medium, name)) in air.media.media.iter().zip(&air.names).enumerate() {
        let mut store =
            |image: FloatImage| writer.add_image(&format!("medium.{index:02}.exr"), &image, PixelFormat::F32);
        let grid_file = density_image(&medium.density).map(&mut store).transpose()?;
        let record = MediumRecord::new(name, medium, grid_file);
        records.push(serde_json::to_value(record).expect("plain data becomes JSON"));
    }
    Ok(records)
}

fn terms(pages: &[PageBuffers]) -> Vec<Term> {
    pages.first().map(|page| page.terms.iter().map(|image| image.term).collect()).unwrap_or_default()
}

/// Mean over the sphere (rows weigh as the sine of their polar angle), and the picture of what is not uniform.
fn write_environment(
    writer: &mut PackageWriter,
    environment: &Environment,
    pixels: PixelFormat,
) -> Result<EnvironmentRecord> {
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    for (y, row) in environment.radiance.chunks(environment.width as usize).enumerate() {
        let weight = (std::f32::consts::PI * (y as f32 + 0.5) / environment.height as f32).sin();
        sum += weight * row.iter().sum::<Vec3>();
        total += weight * row.len() as f32;
    }
    let size = [environment.width, environment.height];
    let picture = (size != [1, 1]).then(|| images::environment(environment));
    let file = picture.map(|image| writer.add_image("environment.exr", &image, pixels)).transpose()?;
    Ok(EnvironmentRecord { size, rotation: environment.rotation, mean_radiance: sum / total, file })
}

/// 8-bit sRGB PNG of a page's total irradiance, at most `side` texels wide and high, for reports.
pub fn thumbnail(page: &PageBuffers, side: u32) -> Vec<u8> {
    images::thumbnail(page, side)
}

/// The error of the page with the largest; `None` where no texel is covered.
fn error_estimate(reports: &[PageReport]) -> Option<ErrorEstimate> {
    let buried: u32 = reports.iter().map(|page| page.buried_texels).sum();
    let covered = buried + reports.iter().map(|page| page.good_texels).sum::<u32>();
    (covered > 0).then(|| ErrorEstimate {
        relative_standard_error: reports.iter().map(|page| page.error).fold(0.0, f32::max),
        unbaked_share: buried as f32 / covered as f32,
    })
}

#[cfg(test)]
mod tests;
