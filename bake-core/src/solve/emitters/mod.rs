//! Everything that emits, and how a receiver draws from it: finite emitters (punctual lights, glowing triangles)
//! through a light tree, directional lights one by one, the environment by its luminance.

pub mod environment;
pub mod punctual;
pub mod spherical;
pub mod tree;

use crate::scene::surface::Surface;
use crate::scene::{Light, LightKind, Scene};
use crate::solve::{LUMINANCE, warp};
use crate::trace::{Hit, Place, Tracer};
use environment::EnvironmentSampler;
use glam::{Vec2, Vec3};
use spherical::SphericalTriangle;
use std::collections::HashMap;
use tree::{LightBounds, LightTree};

/// Points per glowing triangle at which its mean radiance is measured.
const EMISSION_PROBES: u32 = 16;

/// One draw towards an emitter.
#[derive(Debug, Clone, Copy)]
pub struct LightSample {
    /// Where the segment from the receiver ends; for distant emitters the unit direction instead.
    pub target: Target,
    /// Irradiance on a surface perpendicular to the way, divided by the probability of the draw, lux.
    pub irradiance: Vec3,
    /// Density per solid angle of the draw; `None` for emitters that no other strategy can find.
    pub pdf: Option<f32>,
}

/// Where a shadow ray goes.
#[derive(Debug, Clone, Copy)]
pub enum Target {
    /// To a point, metres.
    Point(Vec3),
    /// To infinity along a unit direction.
    Direction(Vec3),
}

/// Kinds of draw that a receiver can make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// Through the light tree of all finite emitters.
    Finite,
    /// Through the light tree of point and spot lights.
    Lamp,
    /// Through the light tree of glowing surfaces.
    Glow,
    /// A directional light, by its index in the scene.
    Directional(u32),
    /// The environment.
    Environment,
}

/// A finite emitter as the air sees it.
#[derive(Debug, Clone, Copy)]
pub enum Source<'s> {
    /// A point or spot light.
    Lamp {
        /// The light.
        light: &'s Light,
        /// Its index in the scene.
        index: u32,
    },
    /// A point of a glowing triangle.
    Patch {
        /// Instance that glows.
        instance: u32,
        /// The point.
        place: Place,
        /// cd/m².
        radiance: Vec3,
        /// Of the whole triangle, m².
        area: f32,
        /// Glows on both sides.
        two_sided: bool,
    },
}

#[derive(Debug, Clone, Copy)]
enum Finite {
    Light(u32),
    Triangle { instance: u32, triangle: u32, vertices: [Vec3; 3], area: f32, two_sided: bool },
}

/// All emitters of a scene.
pub struct Emitters<'s> {
    scene: &'s Scene,
    finite: Vec<Finite>,
    /// Point and spot lights come first in `finite`.
    lamp_count: usize,
    triangles: HashMap<(u32, u32), u32>,
    tree: LightTree,
    /// Point and spot lights alone, and glowing triangles alone: the air meets the two in different ways.
    lamps: LightTree,
    glow: LightTree,
    environment: Option<EnvironmentSampler<'s>>,
    strategies: Vec<Strategy>,
    strategies_in_air: Vec<Strategy>,
}

impl<'s> Emitters<'s> {
    /// Finds what emits in the scene.
    pub fn new(tracer: &Tracer<'s>) -> Self {
        let scene = tracer.scene();
        let mut finite = Vec::new();
        let mut bounds = Vec::new();
        for (index, light) in scene.lights.iter().enumerate() {
            if let Some((position, _)) = punctual::ball(light) {
                finite.push(Finite::Light(index as u32));
                bounds.push(light_bounds(position, light.color.dot(LUMINANCE), &light.kind));
            }
        }
        let lamp_count = finite.len();
        let mut triangles = HashMap::new();
        for instance in 0..scene.instances.len() as u32 {
            for (triangle, glow) in glowing_triangles(tracer, instance) {
                triangles.insert((instance, triangle), finite.len() as u32);
                finite.push(glow.0);
                bounds.push(glow.1);
            }
        }
        let tree = LightTree::build(&bounds);
        let lamps = LightTree::build(&bounds[..lamp_count]);
        let glow = LightTree::build(&bounds[lamp_count..]);
        let environment = scene.environment.as_ref().and_then(EnvironmentSampler::new);
        let mut strategies = Vec::new();
        for (index, light) in scene.lights.iter().enumerate() {
            if matches!(light.kind, LightKind::Directional { .. }) && light.color != Vec3::ZERO {
                strategies.push(Strategy::Directional(index as u32));
            }
        }
        if environment.is_some() {
            strategies.push(Strategy::Environment);
        }
        let with = |finite: &[Strategy]| finite.iter().chain(&strategies).copied().collect();
        let strategies_in_air = with(if glow.is_empty() { &[] } else { &[Strategy::Glow] });
        let strategies = with(if tree.is_empty() { &[] } else { &[Strategy::Finite] });
        Self { scene, finite, lamp_count, triangles, tree, lamps, glow, environment, strategies, strategies_in_air }
    }

    /// The same with a black sky.
    pub fn without_environment(mut self) -> Self {
        self.environment = None;
        for strategies in [&mut self.strategies, &mut self.strategies_in_air] {
            strategies.retain(|&strategy| strategy != Strategy::Environment);
        }
        self
    }

    /// The draws that together reach every emitter.
    pub fn strategies(&self) -> &[Strategy] {
        &self.strategies
    }

    /// The draws that a collision in the air makes: every emitter but point and spot lights, whose light in the air is
    /// gathered along whole legs instead ([`Self::lamp_along`]), where their inverse square is sampled.
    pub fn strategies_in_air(&self) -> &[Strategy] {
        &self.strategies_in_air
    }

    /// Draws a point or spot light for the air along a segment; with its probability.
    pub fn lamp_along(&self, a: Vec3, b: Vec3, u: f32) -> Option<(&Light, f32)> {
        let (index, probability) = self.lamps.sample_segment(a, b, u)?;
        let Finite::Light(light) = self.finite[index as usize] else { return None };
        Some((&self.scene.lights[light as usize], probability))
    }

    /// Point and spot lights.
    pub fn lamps(&self) -> impl Iterator<Item = &'s Light> {
        self.scene.lights.iter().filter(|light| punctual::ball(light).is_some())
    }

    /// Whether there are point or spot lights.
    pub fn has_lamps(&self) -> bool {
        !self.lamps.is_empty()
    }

    /// Number of finite emitters: point and spot lights first, then glowing triangles.
    pub fn finite_count(&self) -> usize {
        self.finite.len()
    }

    /// The scene's light that a finite emitter is; `None` for a glowing triangle.
    pub fn light_of(&self, emitter: u32) -> Option<u32> {
        match self.finite[emitter as usize] {
            Finite::Light(light) => Some(light),
            Finite::Triangle { .. } => None,
        }
    }

    /// Draws a finite emitter for the air around a point, whatever its direction of emission; returns its index with its
    /// probability.
    pub fn around(&self, point: Vec3, u: f32) -> Option<(u32, f32)> {
        self.tree.sample_segment(point, point, u)
    }

    /// The finite emitter `index`; of a glowing triangle a point of it, uniform over its area.
    pub fn source(&self, tracer: &Tracer, index: u32, u: f32, v: f32) -> Source<'s> {
        match self.finite[index as usize] {
            Finite::Light(index) => Source::Lamp { light: &self.scene.lights[index as usize], index },
            Finite::Triangle { instance, triangle, area, two_sided, .. } => {
                let barycentric = warp::triangle(u, v);
                let place = tracer.place(instance, triangle, barycentric);
                let radiance = Surface::at(self.scene, instance, triangle, barycentric).emission;
                Source::Patch { instance, place, radiance, area, two_sided }
            }
        }
    }

    /// Radiance (cd/m²) of the environment along a unit direction.
    pub fn environment(&self, dir: Vec3) -> Vec3 {
        self.environment.as_ref().map_or(Vec3::ZERO, |e| e.radiance(dir))
    }

    /// Density with which [`Strategy::Environment`] draws a direction.
    pub fn environment_pdf(&self, dir: Vec3) -> f32 {
        self.environment.as_ref().map_or(0.0, |e| e.pdf(dir))
    }

    /// Draws towards an emitter for a receiver at `point` with unit `normal`.
    pub fn sample(
        &self,
        tracer: &Tracer,
        strategy: Strategy,
        point: Vec3,
        normal: Vec3,
        u: [f32; 3],
    ) -> Option<LightSample> {
        match strategy {
            Strategy::Finite => self.sample_finite(tracer, self.tree.sample(point, normal, u[0])?, point, u),
            Strategy::Lamp => self.sample_finite(tracer, self.lamps.sample(point, normal, u[0])?, point, u),
            Strategy::Glow => {
                let (index, probability) = self.glow.sample(point, normal, u[0])?;
                self.sample_finite(tracer, (index + self.lamp_count as u32, probability), point, u)
            }
            Strategy::Directional(index) => self.sample_directional(index, u),
            Strategy::Environment => {
                let environment = self.environment.as_ref()?;
                let (dir, pdf) = environment.sample(u[1], u[2]);
                let irradiance = environment.radiance(dir) / pdf;
                Some(LightSample { target: Target::Direction(dir), irradiance, pdf: Some(pdf) })
            }
        }
    }

    /// Density per solid angle with which [`Strategy::Finite`], or [`Strategy::Glow`] in the air, where `normal` is
    /// zero, would have drawn the surface that a ray from `point` with unit direction `dir` has hit at `distance`.
    pub fn finite_pdf(&self, point: Vec3, normal: Vec3, dir: Vec3, distance: f32, hit: &Hit, place: &Place) -> f32 {
        let Some(&index) = self.triangles.get(&(hit.instance, hit.triangle)) else { return 0.0 };
        let Finite::Triangle { area, vertices, .. } = self.finite[index as usize] else { return 0.0 };
        let cos = dir.dot(place.normal_geom).abs();
        if cos <= 0.0 {
            return 0.0;
        }
        let probability = if normal == Vec3::ZERO {
            self.glow.probability(index - self.lamp_count as u32, point, normal)
        } else {
            self.tree.probability(index, point, normal)
        };
        match SphericalTriangle::new(point, vertices) {
            Some(triangle) => probability / triangle.solid_angle as f32,
            None => probability * distance * distance / (area * cos),
        }
    }

    fn sample_finite(
        &self,
        tracer: &Tracer,
        (index, probability): (u32, f32),
        point: Vec3,
        u: [f32; 3],
    ) -> Option<LightSample> {
        match self.finite[index as usize] {
            Finite::Light(light) => {
                let (target, irradiance) = punctual::sample(&self.scene.lights[light as usize], point, u[1], u[2])?;
                Some(LightSample { target: Target::Point(target), irradiance: irradiance / probability, pdf: None })
            }
            Finite::Triangle { instance, triangle, vertices, area, two_sided } => {
                let near = SphericalTriangle::new(point, vertices);
                let barycentric = match &near {
                    Some(near) => near.sample(u[1], u[2])?,
                    None => warp::triangle(u[1], u[2]),
                };
                let place = tracer.place(instance, triangle, barycentric);
                let way = place.point.position - point;
                let distance2 = way.length_squared();
                let cos = -way.dot(place.normal_geom) / distance2.sqrt();
                if (cos <= 0.0 && !two_sided) || cos == 0.0 || distance2 == 0.0 {
                    return None;
                }
                let emission = Surface::at(self.scene, instance, triangle, barycentric).emission;
                let pdf = match near {
                    Some(near) => probability / near.solid_angle as f32,
                    None => probability * distance2 / (area * cos.abs()),
                };
                let target = place.point.offset_along(place.normal_geom * cos.signum());
                Some(LightSample { target: Target::Point(target), irradiance: emission / pdf, pdf: Some(pdf) })
            }
        }
    }

    fn sample_directional(&self, index: u32, u: [f32; 3]) -> Option<LightSample> {
        let light = &self.scene.lights[index as usize];
        let LightKind::Directional { direction, angular_radius } = light.kind else { return None };
        let dir = if angular_radius > 0.0 {
            warp::about(-direction, warp::cone(u[1], u[2], angular_radius))
        } else {
            -direction
        };
        Some(LightSample { target: Target::Direction(dir), irradiance: light.color, pdf: None })
    }
}

fn light_bounds(position: Vec3, intensity: f32, kind: &LightKind) -> LightBounds {
    let everywhere = LightBounds {
        min: position,
        max: position,
        axis: Vec3::Y,
        cos_spread: -1.0,
        cos_emission: 0.0,
        intensity,
        two_sided: false,
    };
    match kind {
        LightKind::Spot { direction, cos_outer, profile: None, .. } => {
            LightBounds { axis: *direction, cos_spread: 1.0, cos_emission: *cos_outer, ..everywhere }
        }
        _ => everywhere,
    }
}

/// The triangles of an instance that glow, with their bounds in the light tree.
fn glowing_triangles(tracer: &Tracer, instance: u32) -> Vec<(u32, (Finite, LightBounds))> {
    let scene = tracer.scene();
    let mesh = &scene.meshes[scene.instances[instance as usize].mesh as usize];
    let mut glowing = Vec::new();
    for primitive in &mesh.primitives {
        let material = &scene.materials[primitive.material as usize];
        if material.emission == Vec3::ZERO {
            continue;
        }
        for triangle in primitive.triangles.clone() {
            let vertices @ [a, b, c] = crate::trace::world_triangle(scene, instance, triangle);
            let area = 0.5 * (b - a).cross(c - a).length();
            let intensity = area * mean_emission(scene, instance, triangle);
            if intensity <= 0.0 {
                continue;
            }
            let bounds = LightBounds {
                min: a.min(b).min(c),
                max: a.max(b).max(c),
                axis: tracer.place(instance, triangle, Vec2::splat(1.0 / 3.0)).normal_geom,
                cos_spread: 1.0,
                cos_emission: 0.0,
                intensity,
                two_sided: material.double_sided,
            };
            let two_sided = material.double_sided;
            glowing.push((triangle, (Finite::Triangle { instance, triangle, vertices, area, two_sided }, bounds)));
        }
    }
    glowing
}

/// Mean luminance over a triangle, cd/m².
fn mean_emission(scene: &Scene, instance: u32, triangle: u32) -> f32 {
    let material = scene.material_at(instance, triangle);
    let probes = if material.emission_texture.is_some() { EMISSION_PROBES } else { 1 };
    let at = |i: u32| warp::triangle((i as f32 + 0.5) / probes as f32, ((i + 1) as f32 * 0.618_034).fract());
    (0..probes).map(|i| Surface::at(scene, instance, triangle, at(i)).emission.dot(LUMINANCE)).sum::<f32>()
        / probes as f32
}
