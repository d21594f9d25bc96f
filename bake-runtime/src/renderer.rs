//! Draws a model to a texture view.
//!
//! ```text
//! shadow maps ─► sky, opaque and cut surfaces ─► radiance, depth ─► air in front of them ─► blended surfaces, each with its own air ─► tone curve
//! ```
//!
//! Blending α over what lies behind is right in air: with L(s) and T(s) the air's light and transmittance as far as s, and B(s) the
//! light that arrives there from behind, L(s) + T(s) (α C + (1 − α) B(s)) = α (L(s) + T(s) C) + (1 − α) (L(s) + T(s) B(s)).

use crate::air::{AirPlan, AirSettings, Medium, Method, surface_texels, tail_texels};
use crate::camera::Camera;
use crate::error::Result;
use crate::model::{Model, upload_texels};
use crate::passes::{Key, Pipelines};
use crate::picture::{Picture, Tables, air_plan, seen_frame, sky_distance};
use crate::prune;
use crate::scene::{Draw, Opacity};
use crate::shadows::MOST_MAPS;
use crate::sky;
use crate::timing::Timer;
use crate::variant::{Pass, Variant};

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Show {
    /// Light.
    #[default]
    Light,
    /// What the lightmap pages hold, as it is.
    Irradiance,
    /// The same as a pattern of its texels.
    Texels,
    /// A colour for each placement.
    Nodes,
    /// Texels per metre, in [`crate::palette::SEQUENTIAL`]'s colours from 1, a stop an octave; grey: no lightmap.
    Density,
    /// A colour for each chart; grey: no lightmap.
    Charts,
}

/// How a picture is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// 1/(cd/m²): radiance times this is what the tone curve takes.
    pub exposure: f32,
    /// Filmic curve; off: clipped at 1.
    pub filmic: bool,
    /// The air.
    pub air: AirSettings,
    /// Side of the shadow maps, texels; none: light passes through everything.
    pub shadow_size: Option<u32>,
    /// Whether light stored in the package's probes lights the air too.
    pub baked_in_air: bool,
    /// Distance from which on clutter is thinned ([`crate::prune`]), metres; none: everything is drawn.
    pub prune_start_m: Option<f32>,
    /// What is shown.
    pub show: Show,
    /// Whether passes are timed, where the device can: [`Renderer::milliseconds`].
    pub timed: bool,
}

impl Default for Settings {
    fn default() -> Self {
        let (exposure, filmic, air) = (1.0, true, AirSettings::default());
        let (shadow_size, prune_start_m, show) = (None, None, Show::Light);
        Self { exposure, filmic, air, shadow_size, baked_in_air: true, prune_start_m, show, timed: false }
    }
}

impl Settings {
    /// Exposure that suits the model, and shadows where its air or lights call for them.
    pub fn for_model(model: &Model) -> Self {
        let shadows = !model.scene.media.is_empty() || !model.scene.dynamic_lights.is_empty();
        let exposure = 0.5 / model.scene.typical_radiance();
        Self { exposure, shadow_size: shadows.then_some(1024), ..Self::default() }
    }
}

/// Where a picture goes.
#[derive(Debug, Clone)]
pub struct Onto<'a> {
    /// A view of a texture of the renderer's format.
    pub view: &'a wgpu::TextureView,
    /// Its width and height, texels: the whole picture's.
    pub size: [u32; 2],
    /// Columns that are drawn.
    pub columns: std::ops::Range<u32>,
}

/// Draws models with one device to targets of one format.
#[derive(Debug)]
pub struct Renderer {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) format: wgpu::TextureFormat,
    radiance_format: wgpu::TextureFormat,
    pub(crate) pipelines: Pipelines,
    images: Option<Images>,
    tails: Option<wgpu::TextureView>,
    surfaces: Option<(Vec<f32>, wgpu::TextureView)>,
    shadows: Option<wgpu::Texture>,
    glow: Option<Glow>,
    timer: Option<Timer>,
}

/// Images between the passes.
#[derive(Debug)]
struct Images {
    size: [u32; 2],
    /// Before and after the air.
    radiance: [wgpu::Texture; 2],
    depth: wgpu::Texture,
    /// Which of the two holds the picture.
    shown: usize,
}

/// What the air blurs of a picture of the sky, and what it was made from.
#[derive(Debug)]
struct Glow {
    media: Vec<Medium>,
    distance: u32,
    harmonics: Vec<[f64; 3]>,
    view: wgpu::TextureView,
}

impl Images {
    fn radiance(&self, index: usize) -> wgpu::TextureView {
        self.radiance[index].create_view(&Default::default())
    }
}

impl Renderer {
    /// A renderer for targets of `format`; sRGB formats and linear 8-bit ones alike receive display-ready colours.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Self {
        // 16-bit floats hold what shows; where the device can blend 32-bit ones, pictures can be measured.
        let exact = device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        let radiance_format = if exact { wgpu::TextureFormat::Rgba32Float } else { wgpu::TextureFormat::Rgba16Float };
        let (device, queue) = (device.clone(), queue.clone());
        let pipelines = Pipelines::default();
        let (images, tails, surfaces, shadows, glow, timer) = (None, None, None, None, None, None);
        Self { device, queue, format, radiance_format, pipelines, images, tails, surfaces, shadows, glow, timer }
    }

    /// Draws `model` as `camera` sees it to the whole of `target`, `size` texels.
    pub fn draw(
        &mut self,
        model: &Model,
        camera: &Camera,
        settings: &Settings,
        target: &wgpu::TextureView,
        size: [u32; 2],
    ) {
        self.draw_columns(model, camera, settings, &Onto { view: target, size, columns: 0..size[0] });
    }

    /// Draws some columns of the picture and leaves the others of the target as they are.
    pub fn draw_columns(&mut self, model: &Model, camera: &Camera, settings: &Settings, onto: &Onto) {
        let size = onto.size.map(|side| side.max(1));
        let columns = onto.columns.start.min(size[0])..onto.columns.end.min(size[0]);
        self.resize(size);
        self.make_tables(model, settings);
        let shadows = self.shadows.as_ref().map(|texture| texture.create_view(&Default::default()));
        let (tails, surfaces) = (self.tails.clone(), self.surfaces.clone());
        let surfaces = surfaces.as_ref().map(|(_, view)| view);
        let glow = self.glow.as_ref().map(|glow| glow.view.clone());
        let tables = Tables { tails: tails.as_ref(), surfaces, shadows: shadows.as_ref(), glow: glow.as_ref() };
        let picture = Picture::new(&self.device, (model, camera, settings), (size, columns), tables);
        self.timer = if settings.timed { self.timer.take().or_else(|| Timer::new(&self.device)) } else { None };
        self.timer.iter_mut().for_each(Timer::begin);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.draw_shadows(&mut encoder, &picture);
        self.draw_opaque(&mut encoder, &picture);
        self.draw_air(&mut encoder, &picture);
        self.draw_blended(&mut encoder, &picture);
        self.draw_tone(&mut encoder, &picture, onto.view);
        self.timer.iter().for_each(|timer| timer.resolve(&mut encoder));
        self.queue.submit([encoder.finish()]);
    }

    /// Radiance of the last picture, cd/m²: what the tone curve was applied to.
    pub fn radiance(&self) -> Option<&wgpu::Texture> {
        self.images.as_ref().map(|images| &images.radiance[images.shown])
    }

    /// Milliseconds that each pass of the last picture took on the device; waits for it. `None` where it was not timed, or
    /// the device has no timestamps.
    pub fn milliseconds(&self) -> Option<Result<Vec<(&'static str, f64)>>> {
        self.timer.as_ref().map(|timer| timer.milliseconds(&self.device, &self.queue))
    }

    /// Shaders made so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.pipelines.variants()
    }

    /// What the air of a picture would be drawn with; `None` where there is none to draw.
    pub fn air_plan(&self, model: &Model, settings: &Settings) -> Option<AirPlan> {
        air_plan(model, settings)
    }

    /// Tables and maps that outlive a picture, where this one calls for them.
    fn make_tables(&mut self, model: &Model, settings: &Settings) {
        let plan = air_plan(model, settings);
        if plan.as_ref().is_some_and(|plan| plan.method == Method::Lut) && self.tails.is_none() {
            self.tails = Some(tail_texels(&self.device, &self.queue));
        }
        let softens = plan.is_some_and(|plan| plan.softens) && !model.scene.dynamic_lights.is_empty();
        if softens && self.surfaces.as_ref().is_none_or(|(exponents, _)| *exponents != model.exponents) {
            let view = surface_texels(&self.device, &self.queue, &model.exponents);
            self.surfaces = Some((model.exponents.clone(), view));
        }
        self.make_glow(model, settings);
        let size = settings.shadow_size.map(|side| side.clamp(16, 8192));
        if let Some(side) = size.filter(|&side| self.shadows.as_ref().is_none_or(|maps| maps.width() != side)) {
            self.shadows = Some(shadow_maps(&self.device, side));
        }
    }

    /// What the air blurs of the environment's picture, anew where air or distance changed.
    fn make_glow(&mut self, model: &Model, settings: &Settings) {
        let Some(distance) = sky_distance(model, settings) else { return };
        let Some(harmonics) = model.sky_harmonics() else { return };
        let media = &model.scene.media;
        let known = |glow: &Glow| glow.distance == distance && glow.media == *media && glow.harmonics == harmonics;
        if self.glow.as_ref().is_some_and(known) {
            return;
        }
        let texels = sky::glow(harmonics, media, distance);
        let view = upload_texels(&self.device, &self.queue, sky::GLOW, &[texels], false);
        self.glow = Some(Glow { media: media.clone(), distance, harmonics: harmonics.to_vec(), view });
    }

    /// Depth as each light with a shadow map sees it.
    fn draw_shadows(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) {
        let Some(maps) = self.shadows.clone() else { return };
        let model = picture.model;
        for (layer, view) in picture.buffers.views.iter().enumerate() {
            let frame = seen_frame(&self.device, picture.camera, view.clip_from_relative, 0.0);
            let target = maps.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer as u32,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let key = Key::screen(Variant::new(Pass::Caster), self.radiance_format);
            let pipeline = self.pipelines.get(&self.device, key);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadows"),
                depth_stencil_attachment: Some(depth_attachment(&target, wgpu::LoadOp::Clear(0.0))),
                timestamp_writes: self.timer.as_mut().and_then(|timer| {
                    timer.writes_part("shadows", layer == 0, layer + 1 == picture.buffers.views.len())
                }),
                ..Default::default()
            });
            pass.set_pipeline(&pipeline.pipeline);
            pipeline.bind(&self.device, &mut pass, 0, |name| match name {
                "frame" => frame.as_entire_binding(),
                _ => picture.resource(name),
            });
            model.bind_lists(&mut pass);
            for draw in model.scene.draws.iter().filter(|draw| !blends(model, draw)) {
                pass.draw_indexed(draw.indices.clone(), 0, draw.instances.clone());
            }
        }
    }

    fn resize(&mut self, size: [u32; 2]) {
        if self.images.as_ref().is_some_and(|images| images.size == size) {
            return;
        }
        let texture = |label, format| {
            self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let radiance = ["radiance", "radiance through air"].map(|label| texture(label, self.radiance_format));
        let depth = texture("depth", wgpu::TextureFormat::Depth32Float);
        self.images = Some(Images { size, radiance, depth, shown: 0 });
    }

    /// Sky, opaque and cut surfaces.
    fn draw_opaque(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) {
        let images = self.images.as_mut().expect("images are made before drawing");
        images.shown = 0;
        let (radiance, depth) = (images.radiance(0), images.depth.create_view(&Default::default()));
        let timed = self.timer.as_mut().and_then(|timer| timer.writes("surfaces"));
        let mut pass = surface_pass(encoder, (&radiance, &depth), true, timed);
        picture.keep_to_columns(&mut pass);
        let sky = picture.model.scene.environment.is_some() || picture.model.sky.is_some();
        if sky && picture.settings.show == Show::Light {
            let fogged = sky_distance(picture.model, picture.settings).is_some();
            let pictured = picture.model.sky.is_some();
            let variant = Variant::new(Pass::Sky).with("SKY_PICTURE", pictured);
            let variant = variant.with("SKY_FOGGED", pictured && fogged);
            let key = Key::screen(variant, self.radiance_format);
            let pipeline = self.pipelines.get(&self.device, key);
            pass.set_pipeline(&pipeline.pipeline);
            pipeline.bind(&self.device, &mut pass, 0, |name| picture.resource(name));
            pass.draw(0..3, 0..1);
        }
        picture.model.bind_lists(&mut pass);
        for draw in picture.model.scene.draws.iter().filter(|draw| !blends(picture.model, draw)) {
            self.draw_one(&mut pass, picture, draw);
        }
    }

    /// The air in front of what was drawn so far.
    fn draw_air(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) {
        let Some(plan) = picture.plan.as_ref().filter(|_| picture.settings.show == Show::Light) else { return };
        let images = self.images.as_mut().expect("images are made before drawing");
        images.shown = 1;
        let (before, after) = (images.radiance(0), images.radiance(1));
        let depth = images.depth.create_view(&Default::default());
        let key = Key::screen(plan.variant.clone(), self.radiance_format);
        let pipeline = self.pipelines.get(&self.device, key);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("air"),
            color_attachments: &[Some(color_attachment(&after, wgpu::LoadOp::Clear(wgpu::Color::BLACK)))],
            timestamp_writes: self.timer.as_mut().and_then(|timer| timer.writes("air")),
            ..Default::default()
        });
        picture.keep_to_columns(&mut pass);
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, &mut pass, 0, |name| match name {
            "radiance_texels" => wgpu::BindingResource::TextureView(&before),
            "depth_map" => wgpu::BindingResource::TextureView(&depth),
            _ => picture.resource(name),
        });
        pass.draw(0..3, 0..1);
    }

    /// Blended surfaces from back to front.
    fn draw_blended(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) {
        let (model, eye) = (picture.model, picture.camera.eye);
        let mut draws: Vec<&Draw> = model.scene.draws.iter().filter(|draw| blends(model, draw)).collect();
        if draws.is_empty() {
            return;
        }
        let distance = |draw: &Draw| (draw.centre.as_dvec3() - eye).length_squared();
        draws.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        let images = self.images.as_ref().expect("images are made before drawing");
        let (radiance, depth) = (images.radiance(images.shown), images.depth.create_view(&Default::default()));
        let timed = self.timer.as_mut().and_then(|timer| timer.writes("blended"));
        let mut pass = surface_pass(encoder, (&radiance, &depth), false, timed);
        picture.keep_to_columns(&mut pass);
        model.bind_lists(&mut pass);
        for draw in draws {
            self.draw_one(&mut pass, picture, draw);
        }
    }

    fn draw_one(&mut self, pass: &mut wgpu::RenderPass, picture: &Picture, draw: &Draw) {
        let model = picture.model;
        let material = &model.scene.materials[draw.material as usize];
        let blended = blends(model, draw);
        let variant = picture.surface_variant(draw);
        let (mirrored, double_sided) = (draw.mirrored, material.double_sided);
        let key = Key { variant, format: self.radiance_format, mirrored, double_sided, blended };
        let pipeline = self.pipelines.get(&self.device, key);
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, pass, 0, |name| picture.resource(name));
        pipeline.bind(&self.device, pass, 1, |name| model.page_resource(draw, name));
        pipeline.bind(&self.device, pass, 2, |name| model.material_resource(draw, name));
        pass.draw_indexed(draw.indices.clone(), 0, seen_instances(draw, picture.camera, picture.settings));
    }

    fn draw_tone(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture, target: &wgpu::TextureView) {
        let images = self.images.as_ref().expect("images are made before drawing");
        let radiance = images.radiance(images.shown);
        let variant =
            Variant::new(Pass::Tone).with("FILMIC", picture.settings.filmic).with("ENCODE", !self.format.is_srgb());
        let pipeline = self.pipelines.get(&self.device, Key::screen(variant, self.format));
        let whole = picture.columns == (0..images.size[0]);
        let load = if whole { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone"),
            color_attachments: &[Some(color_attachment(target, load))],
            timestamp_writes: self.timer.as_mut().and_then(|timer| timer.writes("tone")),
            ..Default::default()
        });
        picture.keep_to_columns(&mut pass);
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, &mut pass, 0, |name| match name {
            "radiance_texels" => wgpu::BindingResource::TextureView(&radiance),
            _ => picture.resource(name),
        });
        pass.draw(0..3, 0..1);
    }
}

/// The placements of a draw that are not thinned out.
pub(crate) fn seen_instances(draw: &Draw, camera: &Camera, settings: &Settings) -> std::ops::Range<u32> {
    let all = draw.instances.len();
    match settings.prune_start_m.filter(|_| all >= prune::LEAST) {
        Some(start) => {
            let count = prune::count(all as u32, draw.origins, camera.eye, start);
            draw.instances.start..draw.instances.start + count
        }
        None => draw.instances.clone(),
    }
}

fn blends(model: &Model, draw: &Draw) -> bool {
    model.scene.materials[draw.material as usize].opacity == Opacity::Blend
}

pub(crate) fn color_attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// A pass over surfaces, on cleared images or on what is there.
fn surface_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    (radiance, depth): (&wgpu::TextureView, &wgpu::TextureView),
    clear: bool,
    timed: Option<wgpu::RenderPassTimestampWrites>,
) -> wgpu::RenderPass<'a> {
    let color = if clear { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    let load = if clear { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surfaces"),
        color_attachments: &[Some(color_attachment(radiance, color))],
        depth_stencil_attachment: Some(depth_attachment(depth, load)),
        timestamp_writes: timed,
        ..Default::default()
    })
}

pub(crate) fn depth_attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<f32>,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}

/// Shadow maps of all lights as layers.
fn shadow_maps(device: &wgpu::Device, side: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadow maps"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: MOST_MAPS as u32 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}
