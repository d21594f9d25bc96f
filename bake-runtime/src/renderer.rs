//! Draws a model to a texture view.
//!
//! ```text
//! sky, opaque and cut surfaces ─► radiance, depth ─► air in front of them ─► blended surfaces, each with its own air ─► tone curve
//! ```
//!
//! Blending α over what lies behind is right in air: with L(s) and T(s) the air's light and transmittance as far as s, and B(s) the
//! light that arrives there from behind, L(s) + T(s) (α C + (1 − α) B(s)) = α (L(s) + T(s) C) + (1 − α) (L(s) + T(s) B(s)).

use wgpu::util::DeviceExt;

use bake_formats::manifest::LightRecord;

use crate::air::{AirBuffers, AirPlan, AirSettings, Method, tail_texels};
use crate::camera::Camera;
use crate::layout::Frame;
use crate::model::Model;
use crate::passes::{Key, Pipelines};
use crate::scene::{Draw, Opacity};
use crate::variant::{Pass, Variant};

/// How a picture is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// 1/(cd/m²): radiance times this is what the tone curve takes.
    pub exposure: f32,
    /// Filmic curve; off: clipped at 1.
    pub filmic: bool,
    /// The air.
    pub air: AirSettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self { exposure: 1.0, filmic: true, air: AirSettings::default() }
    }
}

impl Settings {
    /// An exposure that suits the model.
    pub fn for_model(model: &Model) -> Self {
        Self { exposure: 0.5 / model.scene.typical_radiance(), ..Self::default() }
    }
}

/// Draws models with one device to targets of one format.
#[derive(Debug)]
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    format: wgpu::TextureFormat,
    radiance_format: wgpu::TextureFormat,
    pipelines: Pipelines,
    images: Option<Images>,
    tails: Option<wgpu::TextureView>,
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

impl Images {
    fn radiance(&self, index: usize) -> wgpu::TextureView {
        self.radiance[index].create_view(&Default::default())
    }
}

/// What the passes of one picture share.
struct Picture<'a> {
    model: &'a Model,
    camera: &'a Camera,
    settings: &'a Settings,
    frame: wgpu::Buffer,
    buffers: AirBuffers,
    plan: Option<AirPlan>,
}

impl Picture<'_> {
    /// What is bound in group 0 under a name.
    fn resource<'a>(&'a self, name: &str) -> wgpu::BindingResource<'a> {
        match name {
            "frame" => self.frame.as_entire_binding(),
            "instances" => self.model.instances.as_entire_binding(),
            "page_uvs" => self.model.page_uvs.as_entire_binding(),
            "media" => self.buffers.media.as_entire_binding(),
            "lamps" => self.buffers.lamps.as_entire_binding(),
            "suns" => self.buffers.suns.as_entire_binding(),
            "coefficients" => self.buffers.coefficients.as_entire_binding(),
            "moments" => self.buffers.moments.as_entire_binding(),
            _ => unreachable!("no resource is called '{name}'"),
        }
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
        Self { device, queue, format, radiance_format, pipelines, images: None, tails: None }
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
        let size = size.map(|side| side.max(1));
        self.resize(size);
        let picture = self.picture(model, camera, settings, size);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.draw_opaque(&mut encoder, &picture);
        self.draw_air(&mut encoder, &picture);
        self.draw_blended(&mut encoder, &picture);
        self.draw_tone(&mut encoder, &picture, target);
        self.queue.submit([encoder.finish()]);
    }

    /// Radiance of the last picture, cd/m²: what the tone curve was applied to.
    pub fn radiance(&self) -> Option<&wgpu::Texture> {
        self.images.as_ref().map(|images| &images.radiance[images.shown])
    }

    /// Shaders made so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.pipelines.variants()
    }

    /// What the air of a picture would be drawn with; `None` where there is none to draw.
    pub fn air_plan(&self, model: &Model, settings: &Settings) -> Option<AirPlan> {
        let lights: Vec<&LightRecord> = model.scene.lights.iter().chain(&model.scene.dynamic_lights).collect();
        AirPlan::new(settings.air, &model.scene.media, &lights)
    }

    fn picture<'a>(
        &mut self,
        model: &'a Model,
        camera: &'a Camera,
        settings: &'a Settings,
        size: [u32; 2],
    ) -> Picture<'a> {
        let scene = &model.scene;
        let plan = self.air_plan(model, settings);
        let buffers = AirBuffers::new(&self.device, &scene.media, &scene.lights, &scene.dynamic_lights, camera.eye);
        if plan.as_ref().is_some_and(|plan| plan.method == Method::Lut) && self.tails.is_none() {
            self.tails = Some(tail_texels(&self.device, &self.queue));
        }
        let [lamp_count, sun_count] = buffers.counts;
        let frame = Frame { lamp_count, sun_count, ..frame(model, camera, settings, size) };
        let frame = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("frame"),
            contents: bytemuck::bytes_of(&frame),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        Picture { model, camera, settings, frame, buffers, plan }
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
        let mut pass = surface_pass(encoder, &radiance, &depth, true);
        if picture.model.scene.environment.is_some() {
            let key = Key::screen(Variant::new(Pass::Sky), self.radiance_format);
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
        let Some(plan) = &picture.plan else { return };
        let images = self.images.as_mut().expect("images are made before drawing");
        images.shown = 1;
        let (before, after) = (images.radiance(0), images.radiance(1));
        let depth = images.depth.create_view(&Default::default());
        let key = Key::screen(plan.variant.clone(), self.radiance_format);
        let pipeline = self.pipelines.get(&self.device, key);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("air"),
            color_attachments: &[Some(color_attachment(&after, wgpu::LoadOp::Clear(wgpu::Color::BLACK)))],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, &mut pass, 0, |name| match name {
            "radiance_texels" => wgpu::BindingResource::TextureView(&before),
            "depth_map" => wgpu::BindingResource::TextureView(&depth),
            "tail_texels" => wgpu::BindingResource::TextureView(self.tails.as_ref().expect("made with the picture")),
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
        let mut pass = surface_pass(encoder, &radiance, &depth, false);
        model.bind_lists(&mut pass);
        for draw in draws {
            self.draw_one(&mut pass, picture, draw);
        }
    }

    fn draw_one(&mut self, pass: &mut wgpu::RenderPass, picture: &Picture, draw: &Draw) {
        let model = picture.model;
        let material = &model.scene.materials[draw.material as usize];
        let blended = blends(model, draw);
        let mut variant = surface_variant(model, draw);
        if let Some(plan) = picture.plan.as_ref().filter(|_| blended) {
            variant = variant.and(&plan.variant).with("AIR", true);
        }
        let (mirrored, double_sided) = (draw.mirrored, material.double_sided);
        let key = Key { variant, format: self.radiance_format, mirrored, double_sided, blended };
        let pipeline = self.pipelines.get(&self.device, key);
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, pass, 0, |name| match name {
            "tail_texels" => wgpu::BindingResource::TextureView(self.tails.as_ref().expect("made with the picture")),
            _ => picture.resource(name),
        });
        pipeline.bind(&self.device, pass, 1, |name| model.page_resource(draw, name));
        pipeline.bind(&self.device, pass, 2, |name| model.material_resource(draw, name));
        pass.draw_indexed(draw.indices.clone(), 0, draw.instances.clone());
    }

    fn draw_tone(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture, target: &wgpu::TextureView) {
        let images = self.images.as_ref().expect("images are made before drawing");
        let radiance = images.radiance(images.shown);
        let variant =
            Variant::new(Pass::Tone).with("FILMIC", picture.settings.filmic).with("ENCODE", !self.format.is_srgb());
        let pipeline = self.pipelines.get(&self.device, Key::screen(variant, self.format));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone"),
            color_attachments: &[Some(color_attachment(target, wgpu::LoadOp::Clear(wgpu::Color::BLACK)))],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, &mut pass, 0, |name| match name {
            "radiance_texels" => wgpu::BindingResource::TextureView(&radiance),
            _ => picture.resource(name),
        });
        pass.draw(0..3, 0..1);
    }
}

fn blends(model: &Model, draw: &Draw) -> bool {
    model.scene.materials[draw.material as usize].opacity == Opacity::Blend
}

fn color_attachment(view: &wgpu::TextureView, load: wgpu::LoadOp<wgpu::Color>) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// A pass over surfaces, on cleared images or on what is there.
fn surface_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    radiance: &wgpu::TextureView,
    depth: &wgpu::TextureView,
    clear: bool,
) -> wgpu::RenderPass<'a> {
    let color = if clear { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    let load = if clear { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surfaces"),
        color_attachments: &[Some(color_attachment(radiance, color))],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

fn frame(model: &Model, camera: &Camera, settings: &Settings, [width, height]: [u32; 2]) -> Frame {
    let aspect = width as f32 / height as f32;
    let (right, up) = camera.half_extents(aspect);
    let sky = model.scene.environment.as_ref().map_or([0.0; 3], |sky| sky.mean_radiance.to_array());
    Frame {
        clip_from_relative: camera.clip_from_relative(aspect).to_cols_array_2d(),
        eye: camera.eye.as_vec3().to_array(),
        near: camera.near,
        forward: camera.forward.to_array(),
        exposure: settings.exposure,
        right: right.to_array(),
        up: up.to_array(),
        sky,
        viewport: [width as f32, height as f32, 0.0, 0.0],
        ..Frame::default()
    }
}

/// Which effects a draw calls for.
fn surface_variant(model: &Model, draw: &Draw) -> Variant {
    let material = &model.scene.materials[draw.material as usize];
    Variant::new(Pass::Surface)
        .with("LIGHTMAP", draw.page.is_some())
        .with("BASE_TEXTURE", material.base_texture.is_some())
        .with("EMISSION", material.emits)
        .with("EMISSION_TEXTURE", material.emits && material.emission_texture.is_some())
        .with("MASK", material.opacity == Opacity::Mask)
        .with("BLEND", material.opacity == Opacity::Blend)
}
