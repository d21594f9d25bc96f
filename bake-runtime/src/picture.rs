//! What the passes of one picture share: its plan, and the buffers and textures that shaders bind by name.

use std::ops::Range;

use bake_formats::manifest::LightRecord;
use wgpu::util::DeviceExt;

use crate::air::{AirBuffers, AirPlan, Sources, light_effects};
use crate::camera::Camera;
use crate::layout::{Frame, Lattice};
use crate::model::Model;
use crate::prune;
use crate::renderer::{Settings, Show};
use crate::scene::{Draw, LatticeData, Opacity};
use crate::sky;
use crate::variant::{Pass, Variant};

/// One picture in the making.
pub(crate) struct Picture<'a> {
    pub model: &'a Model,
    pub camera: &'a Camera,
    pub settings: &'a Settings,
    pub plan: Option<AirPlan>,
    pub buffers: AirBuffers,
    /// Columns that are drawn.
    pub columns: Range<u32>,
    height: u32,
    frame: wgpu::Buffer,
    probes: wgpu::Buffer,
    air_lattice: wgpu::Buffer,
    tables: Tables<'a>,
}

/// Textures that outlive a picture.
#[derive(Clone, Copy, Default)]
pub(crate) struct Tables<'a> {
    pub tails: Option<&'a wgpu::TextureView>,
    pub surfaces: Option<&'a wgpu::TextureView>,
    pub shadows: Option<&'a wgpu::TextureView>,
    pub glow: Option<&'a wgpu::TextureView>,
}

/// The plan of a picture's air.
pub(crate) fn air_plan(model: &Model, settings: &Settings) -> Option<AirPlan> {
    let scene = &model.scene;
    let lights: Vec<&LightRecord> = scene.lights.iter().chain(&scene.dynamic_lights).collect();
    let plan = AirPlan::shadowed(settings.air, &scene.media, &lights, settings.shadow_size.is_some());
    plan.map(|mut plan| {
        plan.variant = plan.variant.with("LATTICE_AIR", settings.baked_in_air && scene.air_light.is_some());
        plan.variant = plan.variant.with("SKY_FOGGED", settings.air.sky_distance_m.is_some());
        plan
    })
}

impl<'a> Picture<'a> {
    pub fn new(
        device: &wgpu::Device,
        (model, camera, settings): (&'a Model, &'a Camera, &'a Settings),
        (size, columns): ([u32; 2], Range<u32>),
        tables: Tables<'a>,
    ) -> Self {
        let scene = &model.scene;
        let (media, baked, dynamic) = (&scene.media, &scene.lights, &scene.dynamic_lights);
        let shadowed = settings.shadow_size.map(|_| scene.bounds);
        let buffers = AirBuffers::new(device, Sources { media, baked, dynamic, eye: camera.eye, shadowed });
        let plan = air_plan(model, settings);
        let [lamp_count, sun_count] = buffers.counts;
        let sky_rotation = scene.sky.as_ref().map_or(0.0, |sky| sky.rotation);
        let sky = sky_level(model, settings);
        let frame = Frame { lamp_count, sun_count, sky, sky_rotation, ..frame(camera, settings, size) };
        let frame = uniform(device, "frame", &frame);
        let probes = uniform(device, "probes", &lattice(scene.probes.as_ref(), camera));
        let air_lattice = uniform(device, "air lattice", &lattice(scene.air_light.as_ref(), camera));
        Self { model, camera, settings, plan, buffers, columns, height: size[1], frame, probes, air_lattice, tables }
    }

    /// Draws nothing beside the picture's columns.
    pub fn keep_to_columns(&self, pass: &mut wgpu::RenderPass) {
        pass.set_scissor_rect(self.columns.start, 0, self.columns.end.saturating_sub(self.columns.start), self.height);
    }

    /// What is bound under a name.
    pub fn resource<'b>(&'b self, name: &str) -> wgpu::BindingResource<'b> {
        let texture = |view: Option<&'b wgpu::TextureView>| {
            wgpu::BindingResource::TextureView(view.expect("tables that a plan calls for are made with it"))
        };
        match name {
            "frame" => self.frame.as_entire_binding(),
            "instances" => self.model.instances.as_entire_binding(),
            "page_uvs" => self.model.page_uvs.as_entire_binding(),
            "page_charts" => {
                self.model.page_charts.as_ref().expect("asked for where they are known").as_entire_binding()
            }
            "media" => self.buffers.media.as_entire_binding(),
            "lamps" => self.buffers.lamps.as_entire_binding(),
            "suns" => self.buffers.suns.as_entire_binding(),
            "coefficients" => self.buffers.coefficients.as_entire_binding(),
            "moments" => self.buffers.moments.as_entire_binding(),
            "shadow_views" => self.buffers.shadow_views.as_entire_binding(),
            "probes" => self.probes.as_entire_binding(),
            "probe_texels" => texture(self.model.probes.as_ref()),
            "air_lattice" => self.air_lattice.as_entire_binding(),
            "air_texels" => texture(self.model.air_light.as_ref()),
            "tail_texels" => texture(self.tables.tails),
            "surface_texels" => texture(self.tables.surfaces),
            "shadow_map" => texture(self.tables.shadows),
            "sky_texels" => texture(self.model.sky.as_ref()),
            "glow_texels" => texture(self.tables.glow),
            _ => unreachable!("no resource is called '{name}'"),
        }
    }

    /// Which effects a draw calls for.
    pub fn surface_variant(&self, draw: &Draw) -> Variant {
        let scene = &self.model.scene;
        let material = &scene.materials[draw.material as usize];
        let show = self.settings.show;
        let lit = show == Show::Light;
        let charted = draw.page.is_some() && self.model.has_charts();
        let variant = Variant::new(Pass::Surface)
            .with("LIGHTMAP", draw.page.is_some())
            .with("PROBES", draw.page.is_none() && scene.probes.is_some())
            .with("BASE_TEXTURE", material.base_texture.is_some())
            .with("EMISSION", material.emits && lit)
            .with("EMISSION_TEXTURE", material.emits && lit && material.emission_texture.is_some())
            .with("NORMAL_MAP", material.normal_texture.is_some())
            .with("SH1", material.normal_texture.is_some() && self.model.has_sh1(draw))
            .with("PRUNED", self.settings.prune_start_m.is_some() && draw.instances.len() >= prune::LEAST)
            .with("MASK", material.opacity == Opacity::Mask)
            .with("BLEND", material.opacity == Opacity::Blend)
            .with("SHOW_PAGE", matches!(show, Show::Irradiance | Show::Texels))
            .with("SHOW_TEXELS", show == Show::Texels && draw.page.is_some())
            .with("SHOW_NODES", show == Show::Nodes)
            .with("SHOW_DENSITY", show == Show::Density && draw.page.is_some())
            .with("SHOW_CHARTS", show == Show::Charts && charted)
            .with("SHOW_GREY", show == Show::Charts && !charted || show == Show::Density && draw.page.is_none());
        let dynamic = lit && !scene.dynamic_lights.is_empty();
        let variant = if dynamic { self.lit(variant.with("SPECULAR", material.shines)) } else { variant };
        let blended = self.plan.as_ref().filter(|_| lit && material.opacity == Opacity::Blend);
        blended.map_or(variant.clone(), |plan| variant.and(&plan.variant).with("AIR", true))
    }

    /// With lights that were not baked, through the air where there is any.
    fn lit(&self, variant: Variant) -> Variant {
        let scene = &self.model.scene;
        let lights: Vec<&LightRecord> = scene.lights.iter().chain(&scene.dynamic_lights).collect();
        let variant = light_effects(&lights).into_iter().fold(variant, |v, (effect, on)| v.with(effect, on));
        let variant = variant.with("LIGHTS", true).with("SHADOWS", self.settings.shadow_size.is_some());
        match &self.plan {
            Some(plan) => variant.and(&plan.passage).with("FOGGED", true).with("SOFTENED", plan.softens),
            None => variant,
        }
    }
}

/// A frame that sees through another clip space than the picture's: from a light, or one texel alone.
pub(crate) fn seen_frame(
    device: &wgpu::Device,
    camera: &Camera,
    clip_from_relative: [[f32; 4]; 4],
    prune_start: f32,
) -> wgpu::Buffer {
    let eye = camera.eye.as_vec3().to_array();
    uniform(device, "seen", &Frame { clip_from_relative, eye, prune_start, ..Frame::default() })
}

/// A frame that knows an exposure only.
pub(crate) fn difference_frame(device: &wgpu::Device, exposure: f32) -> wgpu::Buffer {
    uniform(device, "difference", &Frame { exposure, ..Frame::default() })
}

fn uniform(device: &wgpu::Device, label: &str, value: &impl bytemuck::NoUninit) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents: bytemuck::bytes_of(value),
        usage: wgpu::BufferUsages::UNIFORM,
    })
}

fn frame(camera: &Camera, settings: &Settings, [width, height]: [u32; 2]) -> Frame {
    let aspect = width as f32 / height as f32;
    let (right, up) = camera.half_extents(aspect);
    Frame {
        clip_from_relative: camera.clip_from_relative(aspect).to_cols_array_2d(),
        eye: camera.eye.as_vec3().to_array(),
        near: camera.near,
        forward: camera.forward.to_array(),
        exposure: settings.exposure,
        right: right.to_array(),
        up: up.to_array(),
        prune_start: settings.prune_start_m.unwrap_or(0.0),
        viewport: [width as f32, height as f32, 0.0, 0.0],
        ..Frame::default()
    }
}

/// Distance of the sky in air, where there is air to see it through.
pub(crate) fn sky_distance(model: &Model, settings: &Settings) -> Option<u32> {
    settings.air.sky_distance_m.filter(|_| air_plan(model, settings).is_some())
}

/// Radiance of a uniform sky, or what the air leaves of a picture.
fn sky_level(model: &Model, settings: &Settings) -> [f32; 3] {
    let media = &model.scene.media;
    match (&model.scene.environment, &model.sky, sky_distance(model, settings)) {
        (None, None, _) => [0.0; 3],
        (_, Some(_), None) => [1.0; 3],
        (_, Some(_), Some(distance)) => sky::attenuation(media, distance),
        (Some(environment), None, None) => environment.mean_radiance.to_array(),
        (Some(environment), None, Some(distance)) => {
            sky::uniform(environment.mean_radiance.to_array(), media, distance)
        }
    }
}

fn lattice(points: Option<&LatticeData>, camera: &Camera) -> Lattice {
    let Some(points) = points else { return Lattice::default() };
    let [count_x, count_y, count_z] = points.count;
    Lattice {
        origin: (points.origin.as_dvec3() - camera.eye).as_vec3().to_array(),
        count_x,
        inverse_spacing: points.spacing.max(glam::Vec3::splat(1e-6)).recip().to_array(),
        count_y,
        count_z,
        harmonics: points.harmonics.len() as u32,
        ..Lattice::default()
    }
}
