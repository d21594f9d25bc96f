//! The smallest host: opens a package and writes a picture of it. `cargo run -p bake-runtime --example embed -- room.bake room.png`

use bake_formats::Package;
use bake_runtime::{Camera, Headless, Model, Renderer, SceneData, Settings};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, picture] = &arguments[..] else { return Err("give a package's folder and a PNG file".into()) };

    // An engine has a device of its own; this one draws to no window.
    let host = Headless::open()?;
    let scene = SceneData::load(&Package::open(Path::new(folder))?)?;
    let camera = Camera::overview(scene.bounds[0], scene.bounds[1]);
    let model = Model::new(&host.device, &host.queue, scene)?;

    // Any texture view of this format will do: a window's, a portal's, a picture's.
    let (size, format) = ([640, 360], wgpu::TextureFormat::Rgba8Unorm);
    let target = host.target(size, format);
    let mut renderer = Renderer::new(&host.device, &host.queue, format);
    let settings = Settings::for_model(&model);
    renderer.draw(&model, &camera, &settings, &target.create_view(&Default::default()), size);

    let bytes = host.read_texture(&target)?;
    image::save_buffer(picture, &bytes, size[0], size[1], image::ExtendedColorType::Rgba8)?;
    println!("drawn by {}", host.info.name);
    Ok(())
}
