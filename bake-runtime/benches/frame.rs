//! Milliseconds a frame by method and number of lamps, on whatever adapter is there, with the picture's error beside them.
//!
//! `cargo bench -p bake-runtime --bench frame [-- WIDTHxHEIGHT LAMPS...]`, default 1280x720 and 1 4 16 64. The scene is air alone before
//! a black wall: what surfaces cost is not shown. Times are those of whole frames, device idle before and after, the fastest of three, or
//! of as many as begin within two seconds. CPU times are those of all threads of this process (Linux): of a software adapter what a frame
//! costs whatever else the machine does, and then what the ratios are of. Errors are relative to 64 nodes on each side of a lamp's foot,
//! as a share of the mean.

use std::time::Instant;

use bake_formats::manifest::{LightKind, LightRecord};
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use bake_runtime::air::AirSettings;
use bake_runtime::headless::read_texture;
use bake_runtime::{Camera, Headless, Method, Model, Renderer, SceneData, Settings};
use glam::{DVec3, Vec3};

/// Lamps on a spiral in front of the camera.
fn lamps(count: usize) -> Vec<LightRecord> {
    let place = |i: usize| {
        let (turn, share) = (i as f32 * 2.4, (i as f32 + 0.5) / count as f32);
        Vec3::new(4.0 * share.sqrt() * turn.cos(), 2.0 * share.sqrt() * turn.sin(), -6.0 * share)
    };
    let kind = |i| LightKind::Point { position: place(i), radius: 0.01, range: None, profile: None };
    (0..count).map(|i| LightRecord { path: String::new(), color: Vec3::splat(100.0), kind: kind(i) }).collect()
}

fn haze() -> Medium {
    let bounds = Bounds::Box { min: DVec3::splat(-20.0), max: DVec3::splat(20.0) };
    let scatter = Scatter { sigma_s: [0.08, 0.09, 0.1], sigma_a: [0.01; 3] };
    Medium { bounds, density: Density::Uniform, scatter, phase: Phase::Isotropic }
}

/// Frames of which the fastest counts.
const MOST_FRAMES: usize = 3;

/// Seconds after which no more begin.
const ENOUGH_S: f64 = 2.0;

/// Seconds by the clock, and of all threads of this process.
#[derive(Debug, Clone, Copy)]
struct Cost {
    wall: f64,
    cpu: f64,
}

/// Seconds that threads of this process ran so far (Linux: proc_pid_schedstat); 0 where it cannot be told.
fn cpu_seconds() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let text = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("schedstat")).ok());
    text.filter_map(|text| text.split(' ').next()?.parse::<f64>().ok()).sum::<f64>() * 1e-9
}

struct Bench {
    host: Headless,
    renderer: Renderer,
    model: Model,
    size: [u32; 2],
}

impl Bench {
    /// What one frame of a size costs.
    fn draw(&mut self, air: AirSettings, size: [u32; 2]) -> Cost {
        let target = self.host.target(size, wgpu::TextureFormat::Rgba8Unorm).create_view(&Default::default());
        let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO);
        let settings = Settings { air, ..Settings::default() };
        let (begin, cpu) = (Instant::now(), cpu_seconds());
        self.renderer.draw(&self.model, &camera, &settings, &target, size);
        self.host.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        Cost { wall: begin.elapsed().as_secs_f64(), cpu: cpu_seconds() - cpu }
    }

    /// What the cheapest frame costs, and the last one's radiance.
    fn frame(&mut self, air: AirSettings) -> (Cost, Vec<f32>) {
        // A small frame, with whole tiles and cut ones, makes all of the shader; one that shows nothing the images of the full size.
        self.draw(air, [144, 80]);
        self.draw(AirSettings { method: Method::None, ..air }, self.size);
        let mut costs: Vec<Cost> = Vec::new();
        while costs.len() < MOST_FRAMES && costs.iter().map(|cost| cost.wall).sum::<f64>() < ENOUGH_S {
            let cost = self.draw(air, self.size);
            costs.push(cost);
        }
        let least = |of: fn(&Cost) -> f64| costs.iter().map(of).fold(f64::INFINITY, f64::min);
        let best = Cost { wall: least(|cost| cost.wall), cpu: least(|cost| cost.cpu) };
        let Headless { device, queue, .. } = &self.host;
        let radiance = self.renderer.radiance().expect("a picture was drawn");
        let bytes = read_texture(device, queue, radiance).expect("the picture comes back");
        (best, bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect())
    }
}

/// Largest and root-mean-square difference as shares of the truth's mean.
fn errors(picture: &[f32], truth: &[f32]) -> (f64, f64) {
    let mean = truth.iter().map(|&v| f64::from(v)).sum::<f64>() / truth.len() as f64;
    let differences = || picture.iter().zip(truth).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs() / mean);
    let square = differences().map(|d| d * d).sum::<f64>() / truth.len() as f64;
    (differences().fold(0.0, f64::max), square.sqrt())
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let side = |text: &str| text.parse().ok();
    let size = arguments.first().and_then(|text| text.split_once('x')).and_then(|(w, h)| Some([side(w)?, side(h)?]));
    let counts: Vec<usize> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    let counts = if counts.is_empty() { vec![1, 4, 16, 64] } else { counts };
    let host = match Headless::open() {
        Ok(host) => host,
        Err(error) => return println!("nothing measured: {error}"),
    };
    println!("adapter: {} ({:?}), size {:?}", host.info.name, host.info.backend, size.unwrap_or([1280, 720]));
    println!("| lamps | method | nodes or steps | ms | CPU ms | of quadrature 16 | largest error | RMS error |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let renderer = Renderer::new(&host.device, &host.queue, wgpu::TextureFormat::Rgba8Unorm);
    let scene = SceneData { media: vec![haze()], ..SceneData::default() };
    let model = Model::new(&host.device, &host.queue, scene).expect("an empty scene fits");
    let mut bench = Bench { host, renderer, model, size: size.unwrap_or([1280, 720]) };
    for count in counts {
        bench.model.scene.lights = lamps(count);
        table(&mut bench, count);
    }
}

fn table(bench: &mut Bench, lamps: usize) {
    let air = |method, nodes, steps| AirSettings { method, nodes, steps, ..AirSettings::default() };
    let (_, truth) = bench.frame(air(Method::Quadrature, 64, 1));
    let (unit, _) = bench.frame(air(Method::Quadrature, 16, 1));
    for (method, number) in [
        (Method::None, 0),
        (Method::Vacuum, 4),
        (Method::Lut, 0),
        (Method::ClosedForm, 8),
        (Method::Quadrature, 4),
        (Method::Quadrature, 8),
        (Method::Quadrature, 16),
        (Method::RayMarch, 16),
        (Method::RayMarch, 64),
    ] {
        let (cost, picture) = bench.frame(air(method, number, number.max(1)));
        let (largest, rms) = errors(&picture, &truth);
        let (name, ms, cpu) = (method.name(), cost.wall * 1e3, cost.cpu * 1e3);
        let software = bench.host.info.device_type == wgpu::DeviceType::Cpu && unit.cpu > 0.0;
        let ratio = if software { cost.cpu / unit.cpu } else { cost.wall / unit.wall };
        println!("| {lamps} | {name} | {number} | {ms:.1} | {cpu:.1} | {ratio:.2} | {largest:.1e} | {rms:.1e} |");
    }
}
