//! A picture without a window.

use bake_formats::Package;
use bake_runtime::{Camera, Headless};

use crate::error::ViewError;
use crate::look::Look;
use crate::options::{Compare, Options};
use crate::stage::{FORMAT, Stage};

/// A picture and what drew it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Screenshot {
    /// The file's bytes.
    pub png: Vec<u8>,
    /// Name of the adapter.
    pub adapter: String,
    /// What of the package is not drawn, in words.
    pub notes: Vec<String>,
}

/// Draws a package.
pub fn screenshot(package: Package, options: &Options) -> Result<Screenshot, ViewError> {
    let mut stage = open(package, options, Headless::open()?)?;
    let [low, high] = stage.bounds();
    let camera = options.camera.unwrap_or_else(|| Camera::overview(low, high));
    let target = stage.host.target(options.size, FORMAT);
    let view = target.create_view(&Default::default());
    stage.draw(&camera, &Look::new(options), (&view, options.size), false)?;
    let png = png(&stage.host, &target)?;
    Ok(Screenshot { png, adapter: stage.host.info.name.clone(), notes: stage.notes() })
}

/// The shaders that a picture of a package calls for, one a line: pass and effects.
pub fn variants(package: Package, options: &Options) -> Result<Vec<String>, ViewError> {
    let mut stage = open(package, options, Headless::open()?)?;
    let [low, high] = stage.bounds();
    let camera = options.camera.unwrap_or_else(|| Camera::overview(low, high));
    let view = stage.host.target([16, 16], FORMAT).create_view(&Default::default());
    stage.draw(&camera, &Look::new(options), (&view, [16, 16]), false)?;
    Ok(stage.variants().into_iter().collect())
}

/// A package, and the one that it is compared with, on a device.
pub(crate) fn open(package: Package, options: &Options, host: Headless) -> Result<Stage, ViewError> {
    let other = match &options.compare {
        Some(Compare::Package(folder)) => Some(Package::open(folder)?),
        _ => None,
    };
    Stage::new(host, package, other)
}

/// A target's texels as a PNG file's bytes, without opacity.
pub(crate) fn png(host: &Headless, target: &wgpu::Texture) -> Result<Vec<u8>, ViewError> {
    let rgba = host.read_texture(target)?;
    let rgb = rgba.chunks_exact(4).flat_map(|texel| [texel[0], texel[1], texel[2]]).collect();
    let image = image::RgbImage::from_raw(target.width(), target.height(), rgb).expect("three bytes a texel");
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
