//! A picture without a window.

use bake_formats::{FormatError, Package};
use bake_runtime::air::AirSettings;
use bake_runtime::scene::PageContent;
use bake_runtime::{Camera, Headless, Model, Renderer, RuntimeError, SceneData, Settings, Show};

use crate::options::{Options, View};

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
    /// What of the package is not drawn, in words.
    pub notes: Vec<String>,
}

/// Draws a package.
pub fn screenshot(package: &Package, options: &Options) -> Result<Screenshot, ViewError> {
    let mut scene = SceneData::load(package)?;
    let white = scene.typical_radiance();
    if let Some(content) = page_content(options) {
        scene.fill_pages(package, &content)?;
    }
    let headless = Headless::open()?;
    let camera = options.camera.unwrap_or_else(|| Camera::overview(scene.bounds[0], scene.bounds[1]));
    let model = Model::new(&headless.device, &headless.queue, scene)?;
    let settings = settings(&model, white, options);
    let mut rgba = draw(&headless, (&model, &camera, &settings), options.size)?;
    if let Some(method) = options.compare {
        let air = AirSettings { method, ..settings.air };
        let other = draw(&headless, (&model, &camera, &Settings { air, ..settings }), options.size)?;
        join(&mut rgba, &other, options.size[0] as usize);
    }
    let png = encode(options.size, rgba)?;
    Ok(Screenshot { png, adapter: headless.info.name, notes: model.scene.notes })
}

/// What lies on the pages instead of the total.
fn page_content(options: &Options) -> Option<PageContent> {
    match options.show {
        View::Error => Some(PageContent::RelativeError),
        View::Validity => Some(PageContent::Validity),
        View::Show(_) => options.terms.clone().map(PageContent::Terms),
    }
}

/// `white`: a brightness of the whole light, so that single terms keep their share of it.
fn settings(model: &Model, white: f32, options: &Options) -> Settings {
    let stops = options.exposure_stops.exp2();
    let plain = Settings::for_model(model);
    let air = AirSettings { method: options.air, ..plain.air };
    let settings = Settings { air, exposure: 0.5 / white * stops, ..plain };
    let pages = Settings { show: Show::Irradiance, filmic: false, ..settings.clone() };
    match options.show {
        View::Show(Show::Irradiance) => Settings { exposure: settings.exposure / std::f32::consts::PI, ..pages },
        View::Show(Show::Nodes) => Settings { show: Show::Nodes, exposure: stops, filmic: false, ..settings },
        View::Show(show) => Settings { show, ..settings },
        View::Error => Settings { exposure: 10.0 * stops, ..pages },
        View::Validity => Settings { exposure: stops, ..pages },
    }
}

/// The picture's bytes.
fn draw(
    headless: &Headless,
    (model, camera, settings): (&Model, &Camera, &Settings),
    size: [u32; 2],
) -> Result<Vec<u8>, ViewError> {
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let mut renderer = Renderer::new(&headless.device, &headless.queue, format);
    let target = headless.target(size, format);
    renderer.draw(model, camera, settings, &target.create_view(&Default::default()), size);
    Ok(headless.read_texture(&target)?)
}

/// Puts the right half of `other` onto a picture, with a white line between.
fn join(rgba: &mut [u8], other: &[u8], width: usize) {
    for (row, other) in rgba.chunks_exact_mut(4 * width).zip(other.chunks_exact(4 * width)) {
        let middle = 4 * (width / 2);
        row[middle..].copy_from_slice(&other[middle..]);
        row[middle..middle + 4].fill(255);
    }
}

fn encode([width, height]: [u32; 2], rgba: Vec<u8>) -> Result<Vec<u8>, ViewError> {
    let rgb = rgba.chunks_exact(4).flat_map(|texel| [texel[0], texel[1], texel[2]]).collect();
    let image = image::RgbImage::from_raw(width, height, rgb).expect("three bytes a texel");
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
