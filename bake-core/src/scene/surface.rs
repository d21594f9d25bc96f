//! What a surface does to light at a point.

use super::Scene;
use glam::{Vec2, Vec3};

/// Shares are per linear RGB channel.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Diffusely reflected.
    pub reflect: Vec3,
    /// Diffusely transmitted to the far side.
    pub transmit: Vec3,
    /// Passes straight through.
    pub through: Vec3,
    /// Emitted radiance, cd/m².
    pub emission: Vec3,
}

impl Surface {
    /// At barycentric weights of a triangle, seen from the front.
    pub fn at(scene: &Scene, instance: u32, triangle: u32, _barycentric: Vec2) -> Self {
        let m = scene.material_at(instance, triangle);
        let alpha = if m.alpha_mode == super::AlphaMode::Blend { m.base_color.w } else { 1.0 };
        Self {
            reflect: alpha * m.base_color.truncate(),
            transmit: Vec3::ZERO,
            through: Vec3::splat(1.0 - alpha),
            emission: m.emission,
        }
    }
}
