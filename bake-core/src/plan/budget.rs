//! The scene's light in bulk: what its emitters send out, what its surfaces keep going, and what a texel gets of it.
//!
//! All powers are luminous flux in lm: luminance weights over the linear channels.

use crate::air::{Air, limits};
use crate::scene::surface::srgb_to_linear;
use crate::scene::{Environment, Instance, Light, LightKind, Material, Scene};
use crate::solve::LUMINANCE;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Light by where it comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Emitted {
    /// Point and spot lights.
    pub lamps: f64,
    /// Directional lights.
    pub suns: f64,
    /// Glowing surfaces.
    pub glow: f64,
    /// Sky or environment image.
    pub environment: f64,
}

impl Emitted {
    /// Sum of all.
    pub fn total(&self) -> f64 {
        self.lamps + self.suns + self.glow + self.environment
    }
}

/// Light of a scene in bulk; upper limits but for [`Self::median`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Flux into the box around surfaces and air, lm.
    pub emitted: Emitted,
    /// Share that the brightest material reflects or diffuses, averaged over its texture.
    pub albedo: f64,
    /// Lightmapped surface, m².
    pub area: f64,
    /// Median irradiance of texels, lux: a lower limit.
    pub median: f64,
}

impl Budget {
    /// Of a scene whose median texel irradiance is at least `median`.
    pub fn new(scene: &Scene, air: &Air, median: f64) -> Self {
        let lightmapped = scene.instances.iter().filter(|instance| instance.lightmapped);
        Self {
            emitted: emitted(scene, size(scene, air)),
            albedo: scene.materials.iter().map(|material| albedo(scene, material)).fold(0.0, f64::max),
            area: lightmapped.map(|instance| triangles(scene, instance).map(|(_, area)| area).sum::<f64>()).sum(),
            median,
        }
    }

    /// Mean irradiance over the lightmapped surface that `flux` would give there, in medians; infinite in the dark.
    pub fn level(&self, flux: f64) -> f64 {
        if flux == 0.0 { 0.0 } else { flux / (self.area * self.median) }
    }
}

/// Size of the box around surfaces and air.
fn size(scene: &Scene, air: &Air) -> DVec3 {
    let [mut min, mut max] = scene.bounds().map(|corner| corner.as_dvec3());
    for medium in &air.media.media {
        let [low, high] = limits::own_box(medium);
        (min, max) = (min.min(low), max.max(high));
    }
    (max - min).max(DVec3::ZERO)
}

fn emitted(scene: &Scene, size: DVec3) -> Emitted {
    let sides = DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
    let mut emitted = Emitted::default();
    for light in &scene.lights {
        let color = luminance(light.color);
        match &light.kind {
            LightKind::Directional { direction, .. } => emitted.suns += color * sides.dot(direction.as_dvec3().abs()),
            _ => emitted.lamps += color * solid_angle(light),
        }
    }
    // No shadow of a box is larger than that along the diagonal of its sides.
    emitted.environment = scene.environment.as_ref().map_or(0.0, total_radiance) * sides.length();
    let glowing = |material: &Material| material.emission != Vec3::ZERO && !material.unlit;
    if scene.materials.iter().any(glowing) {
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            for (triangle, area) in triangles(scene, instance) {
                let material = &scene.materials[mesh.material_of(triangle) as usize];
                let faces = if material.double_sided { 2.0 } else { 1.0 };
                emitted.glow += faces * PI * area * luminance(material.emission);
            }
        }
    }
    emitted
}

/// Steradians that would take a lamp's flux at its largest intensity.
fn solid_angle(light: &Light) -> f64 {
    match light.kind {
        LightKind::Spot { profile: None, cos_outer, .. } => TAU * (1.0 - f64::from(cos_outer)),
        _ => 2.0 * TAU,
    }
}

/// Integral of radiance over all directions, cd/m² sr. Rows weigh as the solid angle of their band.
fn total_radiance(environment: &Environment) -> f64 {
    let (rows, columns) = (f64::from(environment.height), f64::from(environment.width));
    let row = |(y, row): (usize, &[Vec3])| {
        let [above, below] = [y as f64, y as f64 + 1.0].map(|edge| (PI * edge / rows).cos());
        (above - below) * TAU / columns * row.iter().map(|&radiance| luminance(radiance)).sum::<f64>()
    };
    environment.radiance.chunks(environment.width as usize).enumerate().map(row).sum()
}

/// Share of stopped light that goes on, of the channel with the most.
fn albedo(scene: &Scene, material: &Material) -> f64 {
    if material.unlit {
        return 0.0;
    }
    let factor = material.base_color.truncate();
    let base = match &material.base_color_texture {
        None => factor,
        Some(texture) => factor * mean_color(&scene.images[texture.image as usize].rgba),
    };
    let diffused = if material.diffuse_transmission > 0.0 { material.diffuse_transmission_color } else { Vec3::ZERO };
    f64::from(base.max(diffused).max_element()).clamp(0.0, 1.0)
}

/// Mean of sRGB texels, linear.
fn mean_color(texels: &[[u8; 4]]) -> Vec3 {
    let mut counts = [[0u32; 256]; 3];
    for texel in texels {
        (0..3).for_each(|c| counts[c][usize::from(texel[c])] += 1);
    }
    let mean = |counts: &[u32; 256]| {
        let sum: f64 = (0..=255u8).map(|v| f64::from(counts[usize::from(v)]) * f64::from(srgb_to_linear(v))).sum();
        (sum / texels.len().max(1) as f64) as f32
    };
    Vec3::from_array(std::array::from_fn(|c| mean(&counts[c])))
}

/// Triangles of a placement with their area, m².
fn triangles<'a>(scene: &'a Scene, instance: &'a Instance) -> impl Iterator<Item = (u32, f64)> + 'a {
    let mesh = &scene.meshes[instance.mesh as usize];
    let corner = |v: u32| instance.world_from_object.transform_point3(mesh.positions[v as usize]).as_dvec3();
    mesh.triangles.iter().enumerate().map(move |(index, triangle)| {
        let [a, b, c] = triangle.map(corner);
        (index as u32, 0.5 * (b - a).cross(c - a).length())
    })
}

fn luminance(color: Vec3) -> f64 {
    f64::from(color.dot(LUMINANCE))
}
