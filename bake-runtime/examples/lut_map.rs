//! Where the table of air-light fails: `cargo run -p bake-runtime --example lut_map -- docs/runtime-lut.png` draws a lamp behind the eye in haze twice, by
//! `lut` and by `quadrature` with 64 nodes, and their difference relative to the pixel, one decade a colour.

use bake_formats::manifest::{LightKind, LightRecord};
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use bake_runtime::air::AirSettings;
use bake_runtime::{Camera, Headless, Method, Model, Renderer, SceneData, Settings};
use glam::{DVec3, Vec3};
use std::error::Error;

const SIZE: [u32; 2] = [480, 270];

/// Below 1e-6 black, then blue, cyan, green, yellow, red, and white above 0.1.
const COLORS: [[u8; 3]; 7] =
    [[0, 0, 0], [30, 60, 160], [30, 150, 190], [40, 160, 60], [230, 210, 50], [210, 50, 40], [255, 255, 255]];

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("give a PNG file")?;
    let host = Headless::open()?;
    let kind = LightKind::Point { position: Vec3::new(0.8, 0.3, 4.5), radius: 0.01, range: None, profile: None };
    // The air ends half a metre before the eye: short rays, whose two look-ups cancel.
    let bounds = Bounds::Box { min: DVec3::new(-20.0, -20.0, 2.5), max: DVec3::splat(20.0) };
    let scatter = Scatter { sigma_s: [0.05; 3], sigma_a: [0.01; 3] };
    let scene = SceneData {
        lights: vec![LightRecord { path: String::new(), color: Vec3::ONE, kind }],
        media: vec![Medium { bounds, density: Density::Uniform, scatter, phase: Phase::Isotropic }],
        ..SceneData::default()
    };
    let model = Model::new(&host.device, &host.queue, scene)?;
    let mut renderer = Renderer::new(&host.device, &host.queue, wgpu::TextureFormat::Rgba8Unorm);
    let target = host.target(SIZE, wgpu::TextureFormat::Rgba8Unorm).create_view(&Default::default());
    let camera = Camera { fov_y: 2.0, ..Camera::look_at(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO) };
    let mut draw = |method, nodes| -> Result<Vec<f32>, Box<dyn Error>> {
        let settings = Settings { air: AirSettings { method, nodes, ..AirSettings::default() }, ..Settings::default() };
        renderer.draw(&model, &camera, &settings, &target, SIZE);
        let bytes = host.read_texture(renderer.radiance().ok_or("no picture")?)?;
        Ok(bytes.chunks_exact(16).map(|texel| bytemuck::pod_read_unaligned(&texel[..4])).collect())
    };
    let (table, truth) = (draw(Method::Lut, 0)?, draw(Method::Quadrature, 64)?);
    let errors: Vec<f32> = table.iter().zip(&truth).map(|(a, b)| (a - b).abs() / b).collect();
    let color = |error: &f32| COLORS[(error.max(1e-9).log10() + 7.0).clamp(0.0, 6.0) as usize];
    let bytes: Vec<u8> = errors.iter().flat_map(color).collect();
    image::save_buffer(&file, &bytes, SIZE[0], SIZE[1], image::ExtendedColorType::Rgb8)?;
    let mean = truth.iter().sum::<f32>() / truth.len() as f32;
    let of_mean = table.iter().zip(&truth).map(|(a, b)| (a - b).abs() / mean).fold(0.0, f32::max);
    println!(
        "largest error: {:.2e} of the pixel, {of_mean:.2e} of the mean",
        errors.iter().copied().fold(0.0, f32::max)
    );
    Ok(())
}
