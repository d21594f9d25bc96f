//! What lies under a texel of the picture: the same triangles, drawn to a target of that texel alone.

use glam::{DVec3, Mat4, Vec2, Vec4};

use crate::camera::Camera;
use crate::error::{Result, RuntimeError};
use crate::headless::read_texture;
use crate::model::Model;
use crate::passes::Key;
use crate::picture::seen_frame;
use crate::prune;
use crate::renderer::{Renderer, Settings, depth_attachment, seen_instances};
use crate::scene::{Draw, Opacity};
use crate::variant::{Pass, Variant};

/// A place on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Position, metres; right to about 1e-6 of the distance from the eye.
    pub place: DVec3,
    /// Index into [`crate::SceneData::nodes`].
    pub node: u32,
    /// Lightmap page and coordinate on it.
    pub page: Option<(u32, Vec2)>,
}

/// Bits that fragments write.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

impl Renderer {
    /// The nearest surface under the middle of a texel of a picture of `size`; what is blended counts, what is cut out does
    /// not. Waits for the device. `None`: sky, or a texel beyond the picture.
    pub fn pick(
        &mut self,
        model: &Model,
        camera: &Camera,
        settings: &Settings,
        (size, texel): ([u32; 2], [u32; 2]),
    ) -> Result<Option<Hit>> {
        if texel[0] >= size[0] || texel[1] >= size[1] {
            return Ok(None);
        }
        let clip = texel_clip(size, texel) * camera.clip_from_relative(size[0] as f32 / size[1] as f32);
        let bits = self.draw_texel((model, camera, settings), clip)?;
        let Some(node) = bits[3].checked_sub(1) else { return Ok(None) };
        let direction = ray(camera, size, texel);
        let place = camera.eye + direction * f64::from(f32::from_bits(bits[0]));
        let page = model.scene.nodes.get(node as usize).and_then(|node| node.page);
        let uv = Vec2::new(f32::from_bits(bits[1]), f32::from_bits(bits[2]));
        Ok(Some(Hit { place, node, page: page.map(|page| (page, uv)) }))
    }

    /// Draws everything to one texel and reads it.
    fn draw_texel(&mut self, (model, camera, settings): (&Model, &Camera, &Settings), clip: Mat4) -> Result<[u32; 4]> {
        let texture = |format| {
            self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("pick"),
                size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let (target, depth) = (texture(FORMAT), texture(wgpu::TextureFormat::Depth32Float));
        let (view, depth) = (target.create_view(&Default::default()), depth.create_view(&Default::default()));
        let prune_start = settings.prune_start_m.unwrap_or(0.0);
        let frame = seen_frame(&self.device, camera, clip.to_cols_array_2d(), prune_start);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
        let color = wgpu::RenderPassColorAttachment { view: &view, depth_slice: None, resolve_target: None, ops };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("pick"),
            color_attachments: &[Some(color)],
            depth_stencil_attachment: Some(depth_attachment(&depth, wgpu::LoadOp::Clear(0.0))),
            ..Default::default()
        });
        model.bind_lists(&mut pass);
        for draw in &model.scene.draws {
            let pipeline = self.pipelines.get(&self.device, key(model, draw, settings));
            pass.set_pipeline(&pipeline.pipeline);
            pipeline.bind(&self.device, &mut pass, 0, |name| match name {
                "frame" => frame.as_entire_binding(),
                "instances" => model.instances.as_entire_binding(),
                _ => model.page_uvs.as_entire_binding(),
            });
            pipeline.bind(&self.device, &mut pass, 1, |_| unreachable!("no page is read"));
            pipeline.bind(&self.device, &mut pass, 2, |name| model.material_resource(draw, name));
            pass.draw_indexed(draw.indices.clone(), 0, seen_instances(draw, camera, settings));
        }
        drop(pass);
        self.queue.submit([encoder.finish()]);
        let bytes = read_texture(&self.device, &self.queue, &target)?;
        bytemuck::try_pod_read_unaligned(&bytes).map_err(|error| RuntimeError::ReadBack { reason: error.to_string() })
    }
}

fn key(model: &Model, draw: &Draw, settings: &Settings) -> Key {
    let material = &model.scene.materials[draw.material as usize];
    let mask = material.opacity == Opacity::Mask;
    let variant = Variant::new(Pass::Pick)
        .with("LIGHTMAP", draw.page.is_some())
        .with("PRUNED", settings.prune_start_m.is_some() && draw.instances.len() >= prune::LEAST)
        .with("MASK", mask)
        .with("BASE_TEXTURE", mask && material.base_texture.is_some());
    let (mirrored, double_sided) = (draw.mirrored, material.double_sided);
    Key { variant, format: FORMAT, mirrored, double_sided, blended: false }
}

/// Middle of a texel in clip space, x to the right, y up, −1 to 1.
fn middle(size: [u32; 2], texel: [u32; 2]) -> Vec2 {
    let share = |axis: usize| (2.0 * texel[axis] as f32 + 1.0) / size[axis] as f32 - 1.0;
    Vec2::new(share(0), -share(1))
}

/// From the picture's clip space to that of one of its texels.
fn texel_clip(size: [u32; 2], texel: [u32; 2]) -> Mat4 {
    let (scale, at) = (Vec2::new(size[0] as f32, size[1] as f32), middle(size, texel));
    let shift = -scale * at;
    Mat4::from_cols(
        Vec4::new(scale.x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, scale.y, 0.0, 0.0),
        Vec4::Z,
        Vec4::new(shift.x, shift.y, 0.0, 1.0),
    )
}

/// Unit direction through a texel's middle.
fn ray(camera: &Camera, size: [u32; 2], texel: [u32; 2]) -> DVec3 {
    let (right, up) = camera.half_extents(size[0] as f32 / size[1] as f32);
    let at = middle(size, texel);
    (camera.forward + right * at.x + up * at.y).as_dvec3().normalize()
}
