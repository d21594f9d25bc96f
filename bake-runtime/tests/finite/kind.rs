//! What decides a picture's shaders: kinds of lights and media, and what is switched on; scenes of random numbers of a kind.

use bake_formats::manifest::{LightKind, LightRecord, ProfileRecord};
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use bake_runtime::air::AirSettings;
use bake_runtime::{Camera, Method, SceneData, Settings};
use glam::{DAffine3, DQuat, DVec3, IVec3, Vec3};
use rand::rngs::SmallRng;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use std::sync::Arc;

/// Where a medium is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    Everywhere,
    Box,
    Ball,
    Hull,
    Mesh,
}

/// How its density goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layers {
    Uniform,
    Exponential,
    Linear,
    Planet,
    Grid,
}

/// Its phase function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lobe {
    Isotropic,
    Linear,
    Rayleigh,
    HenyeyGreenstein,
    Legendre,
}

/// A light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shine {
    Point,
    Cone,
    Measured,
    Sun,
}

/// What decides a picture's shaders.
#[derive(Debug, Clone)]
pub struct Kind {
    pub method: Method,
    pub media: Vec<(Extent, Layers, Lobe)>,
    pub baked: Vec<Shine>,
    pub dynamic: Vec<Shine>,
    pub shadows: bool,
    pub sky: bool,
    /// Baked light in the air.
    pub lattice: bool,
    /// A pane in front of the wall, with the air before it.
    pub pane: bool,
    pub nodes: u32,
}

fn any<T: Copy>(random: &mut SmallRng, of: &[T]) -> T {
    *of.choose(random).expect("not empty")
}

fn some<T: Copy>(random: &mut SmallRng, of: &[T], least: usize) -> Vec<T> {
    let count = random.random_range(least..=of.len());
    of.sample(random, count).copied().collect()
}

impl Kind {
    /// A kind within a random method's domain.
    pub fn random(random: &mut SmallRng) -> Self {
        use {Extent::*, Layers::*, Lobe::*, Shine::*};
        let method = Method::ALL[random.random_range(1..6)];
        let simple = matches!(method, Method::Lut | Method::ClosedForm);
        let lobes: &[Lobe] = if simple {
            &[Isotropic, Lobe::Linear, Rayleigh, Legendre]
        } else {
            &[Isotropic, Lobe::Linear, Rayleigh, HenyeyGreenstein, Legendre]
        };
        let shines: &[Shine] = if simple { &[Point, Sun] } else { &[Point, Cone, Measured, Sun] };
        let even = simple || random.random_bool(0.3);
        let lobes = some(random, lobes, 1);
        let extent = any(random, &[Everywhere, Box, Ball, Hull]);
        let layers = [Uniform, Exponential, Layers::Linear, Planet, Grid];
        let media = |random: &mut SmallRng| -> Vec<_> {
            let extents = [Everywhere, Box, Ball, Hull, Mesh];
            lobes.iter().map(|&lobe| (any(random, &extents), any(random, &layers), lobe)).collect()
        };
        let media = match even {
            true => lobes.iter().map(|&lobe| (extent, Uniform, lobe)).collect(),
            // Told from even air by what it is, not by numbers.
            false => loop {
                let media = media(random);
                if media.iter().any(|&(extent, layers, _)| layers != Uniform || extent == Mesh) {
                    break media;
                }
            },
        };
        let mut baked = some(random, shines, 1);
        let dynamic =
            if random.random_bool(0.5) { baked.split_off(random.random_range(0..baked.len())) } else { vec![] };
        let mut half = || random.random_bool(0.5);
        let (shadows, sky, lattice, pane) = (half(), half(), half(), half());
        let nodes = any(random, &[1, 16, 24, 32]);
        Self { method, media, baked, dynamic, shadows, sky, lattice, pane, nodes }
    }

    /// How a picture of it is made.
    pub fn settings(&self, random: &mut SmallRng) -> Settings {
        let sky_distance_m = self.sky.then(|| any(random, &[1, 100, 1_000_000]));
        let (method, nodes) = (self.method, self.nodes);
        let air = AirSettings { method, nodes, sky_distance_m, steps: 16, shaft_steps: 8 };
        let shadow_size = self.shadows.then_some(16);
        Settings { air, shadow_size, baked_in_air: self.lattice, ..Settings::default() }
    }

    /// A camera, lights and media of random numbers in `base`, whose last draw is the pane: the eye in a lamp, a ray straight
    /// at one, no air and air as thick as rock are often among them.
    pub fn scene(&self, random: &mut SmallRng, base: &SceneData) -> (SceneData, Camera) {
        let eye = place(random).as_dvec3();
        let mut camera = Camera::look_at(eye, place(random).as_dvec3());
        camera.fov_y = random.random_range(0.1..2.5);
        // Lamps lie within air that is even everywhere.
        let even = !self.media.iter().any(|&(extent, layers, _)| layers != Layers::Uniform || extent == Extent::Mesh);
        let half_width = if even { 12.0 } else { any(random, &[0.1, 1.5, 12.0]) };
        let medium = |&(extent, layers, lobe): &_| Medium {
            bounds: bounds(extent, half_width),
            density: density(random, layers),
            scatter: scatter(random),
            phase: phase(random, lobe),
        };
        let mut scene = base.clone();
        scene.media = self.media.iter().map(medium).collect();
        scene.lights = self.baked.iter().map(|&shine| light(random, shine, &camera)).collect();
        scene.dynamic_lights = self.dynamic.iter().map(|&shine| light(random, shine, &camera)).collect();
        if !self.pane {
            scene.draws.pop();
        }
        (scene, camera)
    }
}

fn place(random: &mut SmallRng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-3.0f32..3.0)))
}

/// 10^from … 10^to.
fn decades(random: &mut impl Rng, from: f64, to: f64) -> f64 {
    10f64.powf(random.random_range(from..to))
}

fn scatter(random: &mut SmallRng) -> Scatter {
    let mut sigma = || match random.random_range(0..6) {
        0 => 0.0,
        1 => 1e-12,
        2 => 1e9,
        _ => decades(random, -4.0, 3.0),
    };
    match sigma() {
        grey if grey > 1.0 => Scatter { sigma_s: [grey; 3], sigma_a: [sigma(), 0.0, 1e-3] },
        first => Scatter { sigma_s: [first, sigma(), 0.1], sigma_a: [sigma(), 0.0, 1e-3] },
    }
}

fn phase(random: &mut SmallRng, lobe: Lobe) -> Phase<f64> {
    match lobe {
        Lobe::Isotropic => Phase::Isotropic,
        Lobe::Linear => Phase::Linear { a1: random.random_range(-1.0..=1.0) },
        Lobe::Rayleigh => Phase::Rayleigh,
        Lobe::HenyeyGreenstein => {
            let moderate = random.random_range(-0.9..0.9);
            Phase::HenyeyGreenstein { g: any(random, &[0.0, -0.999, 0.999, moderate]) }
        }
        Lobe::Legendre => Phase::Legendre(vec![1.0, random.random_range(-1.0..1.0), random.random_range(0.0..1.0)]),
    }
}

fn bounds(extent: Extent, half_width: f64) -> Bounds {
    match extent {
        Extent::Everywhere => Bounds::Unbounded,
        Extent::Box => Bounds::Box { min: DVec3::splat(-half_width), max: DVec3::splat(half_width) },
        Extent::Ball => Bounds::Sphere { centre: DVec3::ZERO, radius: half_width },
        Extent::Hull => {
            let planes = [DVec3::X, DVec3::NEG_Y, DVec3::new(-0.6, 0.8, 0.0)].map(|normal| normal.extend(half_width));
            Bounds::Hull(planes.into())
        }
        Extent::Mesh => {
            let angle = crate::common::angle(2, |place| half_width * (place - DVec3::new(1.0, 1.0, 0.5)));
            Bounds::Mesh(Arc::new(angle))
        }
    }
}

fn density(random: &mut SmallRng, layers: Layers) -> Density {
    let scale_height_m = decades(random, -2.0, 3.0);
    match layers {
        Layers::Uniform => Density::Uniform,
        Layers::Exponential => Density::Exponential { base_m: random.random_range(-5.0..5.0), scale_height_m },
        Layers::Linear => {
            let slope_per_m = decades(random, -6.0, 3.0) * any(random, &[-1.0, 1.0]);
            Density::Linear { zero_m: random.random_range(-5.0..5.0), slope_per_m }
        }
        Layers::Planet => {
            let radius_m = decades(random, -1.0, 8.0);
            let centre = place(random).as_dvec3().normalize_or(DVec3::Y) * radius_m * random.random_range(0.0..1.1);
            Density::Planet { centre, radius_m, scale_height_m }
        }
        Layers::Grid => grid(random),
    }
}

/// A grid of 3 x 1 x 2 points with densities of 0 to 1e6, flat along one axis in one of four.
fn grid(random: &mut SmallRng) -> Density {
    let values = (0..6).map(|_| any(random, &[0.0, 1.0, 1e-6, 1e6])).collect();
    let flat = if random.random_bool(0.25) { 1e-6 } else { 1.0 };
    let turn = DQuat::from_rotation_x(random.random_range(0.0..6.3));
    let placed = DAffine3::from_scale_rotation_translation(DVec3::new(1.0, flat, 2.0), turn, DVec3::splat(-1.0));
    Density::Grid(Arc::new(DensityGrid::new(IVec3::new(3, 1, 2), values, placed).expect("valid")))
}

fn light(random: &mut SmallRng, shine: Shine, camera: &Camera) -> LightRecord {
    let (eye, ahead) = (camera.eye.as_vec3(), 2.0 * camera.forward);
    let elsewhere = place(random);
    let position = any(random, &[eye, eye + ahead, eye - ahead, elsewhere]);
    let radius = any(random, &[0.0, 0.001, 0.5]);
    let outer_angle = random.random_range(0.0..1.57);
    let inner_angle = outer_angle * any(random, &[0.0, 0.5, 1.0]);
    let (direction, range) = (place(random), None);
    let profile =
        || Some(ProfileRecord { axis: direction.normalize_or(Vec3::Y), legendre: vec![1.0, 0.5, -0.25, 0.125] });
    let kind = match shine {
        Shine::Point => LightKind::Point { position, radius, range, profile: None },
        Shine::Measured => LightKind::Point { position, radius, range, profile: profile() },
        Shine::Cone => LightKind::Spot { position, direction, inner_angle, outer_angle, radius, range, profile: None },
        Shine::Sun => LightKind::Directional { direction, angular_radius: 0.0 },
    };
    LightRecord { path: "light".into(), color: Vec3::new(1.0, 100.0, 1e4), kind }
}
