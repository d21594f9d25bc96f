//! Draws a baked package from a camera: `picture PACKAGE_DIR OUT.png [WIDTHxHEIGHT] [EYE TARGET]`, points as `x,y,z`.
//!
//! Every pixel's light is albedo/π × the baked irradiance, found through the package alone, plus what surfaces emit.

use bake_core::scene::surface::Surface;
use bake_core::scene::{LoadOptions, Scene, load};
use bake_core::trace::{Ray, Tracer};
use bake_formats::Package;
use bake_formats::sample::Sampler;
use glam::Vec3;
use rayon::prelude::*;
use std::error::Error;
use std::f32::consts::PI;
use std::path::Path;

/// Rays per pixel along each axis.
const RAYS: u32 = 3;
/// Vertical field of view, radians.
const FIELD_OF_VIEW: f32 = 1.1;
/// Luminance that the picture's mean is brought to before the tone curve.
const MIDDLE_GREY: f32 = 0.16;

struct Camera {
    eye: Vec3,
    forward: Vec3,
    width: u32,
    height: u32,
}

impl Camera {
    fn ray(&self, x: f32, y: f32) -> Ray {
        let right = self.forward.cross(Vec3::Y).normalize();
        let up = right.cross(self.forward);
        let scale = (FIELD_OF_VIEW / 2.0).tan();
        let (u, v) = ((2.0 * x - self.width as f32) / self.height as f32, 1.0 - 2.0 * y / self.height as f32);
        let dir = (self.forward + scale * (u * right + v * up)).normalize();
        Ray { origin: self.eye, dir, t_max: f32::INFINITY }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, out, rest @ ..] = arguments.as_slice() else {
        return Err("usage: picture PACKAGE_DIR OUT.png [WIDTHxHEIGHT] [EYE TARGET]".into());
    };
    let package = Package::open(Path::new(folder))?;
    let options = LoadOptions { sky: Some(Vec3::ZERO), ..LoadOptions::default() };
    let (scene, _) = load(&package.path(&package.baked_scene()), &options)?;
    let sampler = Sampler::open(&package)?;
    let camera = camera(&scene, rest)?;
    let background = background(&package);
    let tracer = Tracer::new(&scene);
    let rows: Vec<Vec<Vec3>> = (0..camera.height)
        .into_par_iter()
        .map(|y| (0..camera.width).map(|x| pixel(&tracer, &sampler, &camera, background, x, y)).collect())
        .collect();
    let pixels: Vec<Vec3> = rows.into_iter().flatten().collect();
    save(Path::new(out), &camera, &pixels)
}

/// The camera of the arguments, or one that looks along the scene's longest horizontal side.
fn camera(scene: &Scene, arguments: &[String]) -> Result<Camera, Box<dyn Error>> {
    let (width, height) = match arguments.first() {
        Some(size) => {
            let (width, height) = size.split_once('x').ok_or("the size is WIDTHxHEIGHT")?;
            (width.parse()?, height.parse()?)
        }
        None => (1280, 720),
    };
    let point = |text: &String| -> Result<Vec3, Box<dyn Error>> {
        let numbers = text.split(',').map(str::parse).collect::<Result<Vec<f32>, _>>()?;
        Ok(Vec3::from_array(numbers.try_into().map_err(|_| "a point is x,y,z")?))
    };
    let (eye, target) = match arguments.get(1..3) {
        Some([eye, target]) => (point(eye)?, point(target)?),
        _ => default_view(scene),
    };
    Ok(Camera { eye, forward: (target - eye).normalize(), width, height })
}

fn default_view(scene: &Scene) -> (Vec3, Vec3) {
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for instance in &scene.instances {
        for &position in &scene.meshes[instance.mesh as usize].positions {
            let position = instance.world_from_object.transform_point3(position);
            (min, max) = (min.min(position), max.max(position));
        }
    }
    let (centre, size) = (0.5 * (min + max), max - min);
    let along = if size.x > size.z { Vec3::X } else { Vec3::Z };
    let eye_height = min.y + (0.3 * size.y).min(1.7);
    (Vec3 { y: eye_height, ..centre } + 0.45 * size * along, Vec3 { y: eye_height + 0.05 * size.y, ..centre })
}

/// Mean radiance of the environment; the package does not hold its image.
fn background(package: &Package) -> Vec3 {
    package.manifest.environment.as_ref().map_or(Vec3::ZERO, |environment| environment.mean_radiance)
}

fn pixel(tracer: &Tracer, sampler: &Sampler, camera: &Camera, background: Vec3, x: u32, y: u32) -> Vec3 {
    let offset = |i: u32| (i as f32 + 0.5) / RAYS as f32;
    let rays = (0..RAYS * RAYS).map(|i| camera.ray(x as f32 + offset(i % RAYS), y as f32 + offset(i / RAYS)));
    let light = rays.map(|ray| radiance(tracer, sampler, background, ray).min(Vec3::splat(1e6)));
    light.sum::<Vec3>() / (RAYS * RAYS) as f32
}

/// Radiance along a ray, through whatever lets it pass.
fn radiance(tracer: &Tracer, sampler: &Sampler, background: Vec3, mut ray: Ray) -> Vec3 {
    let (mut seen, mut passed) = (Vec3::ZERO, Vec3::ONE);
    for _ in 0..16 {
        let Some(hit) = tracer.closest_hit(&ray) else { return seen + passed * background };
        let place = tracer.place(hit.instance, hit.triangle, hit.barycentric);
        let surface = Surface::at(tracer.scene(), hit.instance, hit.triangle, hit.barycentric);
        let side = if ray.dir.dot(place.normal_geom) > 0.0 { -1.0 } else { 1.0 };
        if !hit.back_face || tracer.scene().material_at(hit.instance, hit.triangle).double_sided {
            let baked = sampler.sample(place.point.position, side * place.normal_geom);
            let irradiance = baked.map_or(Vec3::ZERO, |sample| sample.irradiance);
            seen += passed * (surface.emission + surface.reflect * irradiance / PI);
        }
        passed *= surface.through;
        if passed == Vec3::ZERO {
            return seen;
        }
        ray.origin = place.point.offset_along(-side * place.normal_geom);
    }
    seen
}

/// Exposes by the logarithmic mean, applies Narkowicz' 2015 fit of the ACES curve, encodes as sRGB.
fn save(path: &Path, camera: &Camera, pixels: &[Vec3]) -> Result<(), Box<dyn Error>> {
    let luminance = |c: &Vec3| c.dot(bake_core::solve::LUMINANCE);
    let log_mean = pixels.iter().map(|c| f64::from(luminance(c).max(1e-4)).ln()).sum::<f64>() / pixels.len() as f64;
    let exposure = MIDDLE_GREY / log_mean.exp() as f32;
    let encode = |value: f32| {
        let x = value * exposure;
        let shown = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
        let srgb = if shown <= 0.003_130_8 { 12.92 * shown } else { 1.055 * shown.powf(1.0 / 2.4) - 0.055 };
        (255.0 * srgb + 0.5) as u8
    };
    let bytes = pixels.iter().flat_map(|c| c.to_array().map(encode)).collect();
    let image =
        image::RgbImage::from_raw(camera.width, camera.height, bytes).ok_or("as many pixels as the size says")?;
    Ok(image.save(path)?)
}
