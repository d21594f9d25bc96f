//! A picture without a window.

use bake_formats::{FormatError, Package};
use bake_runtime::{Camera, Headless, Model, Renderer, RuntimeError, SceneData, Settings};

use crate::options::Options;

/// What can go wrong between a package and a PNG.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The package cannot be read.
    #[error(transparent)]
    Package(#[from] FormatError),
    /// It cannot be drawn.
    #[error(transparent)]
    Runtime(#[from] RuntimeError),
    /// The picture cannot be encoded.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] image::ImageError),
}

/// A picture and what drew it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Screenshot {
    /// The file's bytes.
    pub png: Vec<u8>,
    /// Name of the adapter.
    pub adapter: String,
}

/// Draws a package.
pub fn screenshot(package: &Package, options: &Options) -> Result<Screenshot, ViewError> {
    let scene = SceneData::load(package)?;
    let headless = Headless::open()?;
    let camera = options.camera.unwrap_or_else(|| Camera::overview(scene.bounds[0], scene.bounds[1]));
    let model = Model::new(&headless.device, &headless.queue, scene)?;
    let mut settings = Settings::for_model(&model);
    settings.exposure *= options.exposure_stops.exp2();
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let mut renderer = Renderer::new(&headless.device, &headless.queue, format);
    let target = headless.target(options.size, format);
    renderer.draw(&model, &camera, &settings, &target.create_view(&Default::default()), options.size);
    let png = encode(options.size, headless.read_texture(&target)?)?;
    Ok(Screenshot { png, adapter: headless.info.name })
}

fn encode([width, height]: [u32; 2], rgba: Vec<u8>) -> Result<Vec<u8>, ViewError> {
    let rgb = rgba.chunks_exact(4).flat_map(|texel| [texel[0], texel[1], texel[2]]).collect();
    let image = image::RgbImage::from_raw(width, height, rgb).expect("three bytes a texel");
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
