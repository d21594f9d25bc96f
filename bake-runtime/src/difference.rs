//! Two pictures' difference in false colours.

use crate::passes::Key;
use crate::picture::difference_frame;
use crate::renderer::{Renderer, color_attachment};
use crate::variant::{Pass, Variant};

impl Renderer {
    /// Draws how much more luminance `other`'s last picture holds than this renderer's last one: [`crate::palette::DIVERGING`]
    /// from −`full` to +`full`, cd/m². Nothing is drawn where there are not two pictures of the target's size.
    pub fn draw_difference(&mut self, other: &Self, full: f32, target: &wgpu::TextureView) {
        let (Some(ours), Some(theirs)) = (self.radiance(), other.radiance()) else { return };
        if ours.size() != theirs.size() {
            return;
        }
        let [ours, theirs] = [ours, theirs].map(|texture| texture.create_view(&Default::default()));
        let frame = difference_frame(&self.device, 1.0 / full.max(f32::MIN_POSITIVE));
        let variant = Variant::new(Pass::Difference).with("ENCODE", !self.format.is_srgb());
        let pipeline = self.pipelines.get(&self.device, Key::screen(variant, self.format));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("difference"),
            color_attachments: &[Some(color_attachment(target, wgpu::LoadOp::Clear(wgpu::Color::BLACK)))],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline.pipeline);
        pipeline.bind(&self.device, &mut pass, 0, |name| match name {
            "radiance_texels" => wgpu::BindingResource::TextureView(&ours),
            "other_texels" => wgpu::BindingResource::TextureView(&theirs),
            _ => frame.as_entire_binding(),
        });
        pass.draw(0..3, 0..1);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }
}
