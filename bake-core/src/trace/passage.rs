//! What light meets on a straight segment: coverage of masked and blended surfaces, tint of transmissive ones,
//! and absorption along the chords inside closed volumes.

use super::{Hit, Ray};
use crate::scene::surface::Surface;
use crate::scene::{AlphaMode, Scene};
use glam::Vec3;

/// Whether a hit lies in a part that an alpha mask cuts away.
pub fn is_cut_away(scene: &Scene, hit: &Hit) -> bool {
    let material = scene.material_at(hit.instance, hit.triangle);
    match material.alpha_mode {
        AlphaMode::Mask(cutoff) => scene.alpha_at(hit.instance, hit.triangle, hit.barycentric) < cutoff,
        _ => false,
    }
}

/// Light's way through permeable surfaces, gathered in any order.
#[derive(Debug, Clone, Copy)]
pub struct Passage {
    /// An opaque surface was met.
    pub blocked: bool,
    /// Product of what the surfaces let through.
    tint: Vec3,
    /// Absorption along the chords, see [`Chords`].
    chords: Chords,
}

impl Default for Passage {
    fn default() -> Self {
        Self { blocked: false, tint: Vec3::ONE, chords: Chords::default() }
    }
}

impl Passage {
    /// Adds one permeable surface.
    pub fn cross(&mut self, scene: &Scene, hit: &Hit) {
        if is_cut_away(scene, hit) {
            return;
        }
        let surface = Surface::at(scene, hit.instance, hit.triangle, hit.barycentric);
        self.tint *= surface.through;
        self.blocked = self.tint == Vec3::ZERO;
        self.chords.cross(scene.material_at(hit.instance, hit.triangle).volume_sigma_a, hit);
    }

    /// What is left of light at the end of the segment.
    pub fn transmittance(&self, ray: &Ray) -> Vec3 {
        if self.blocked {
            return Vec3::ZERO;
        }
        self.tint * self.chords.transmittance(ray.t_max, ray.dir)
    }
}

/// Optical depth of absorbing closed volumes: every exit at t adds σ t, every entry takes σ t away; a volume still
/// open at the end adds σ t_max. A segment that lies inside a volume altogether meets no surface and is not weakened.
#[derive(Debug, Clone, Copy, Default)]
pub struct Chords {
    /// Σ ±σ t, in units of the ray direction's length.
    depth: Vec3,
    /// Σ ±σ: negative while more volumes were entered than left.
    open: Vec3,
}

impl Chords {
    /// Adds the boundary of a volume with absorption `sigma_a` (1/m).
    pub fn cross(&mut self, sigma_a: Vec3, hit: &Hit) {
        let side = if hit.back_face { 1.0 } else { -1.0 };
        self.depth += side * sigma_a * hit.t;
        self.open += side * sigma_a;
    }

    /// What the volumes leave of light along a ray that ends at `t_end`.
    pub fn transmittance(&self, t_end: f32, dir: Vec3) -> Vec3 {
        if self.depth == Vec3::ZERO && self.open == Vec3::ZERO {
            return Vec3::ONE;
        }
        let still_open = (-self.open).max(Vec3::ZERO);
        let open_end = if still_open == Vec3::ZERO { Vec3::ZERO } else { still_open * t_end };
        let depth = ((self.depth + open_end) * dir.length()).max(Vec3::ZERO);
        depth.map(|d| (-d).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn boundary(t: f32, back_face: bool) -> Hit {
        Hit { t, instance: 0, triangle: 0, barycentric: Vec2::ZERO, back_face }
    }

    #[test]
    fn chords_from_outside_from_inside_and_to_inside() {
        let sigma = Vec3::splat(0.5);
        let transmittance = |crossings: &[(f32, bool)]| {
            let mut chords = Chords::default();
            for &(t, back) in crossings {
                chords.cross(sigma, &boundary(t, back));
            }
            chords.transmittance(10.0, Vec3::X).x
        };
        assert_eq!(transmittance(&[]), 1.0);
        assert!((transmittance(&[(2.0, false), (5.0, true)]) - (-1.5f32).exp()).abs() < 1e-6);
        assert!((transmittance(&[(5.0, true), (2.0, false)]) - (-1.5f32).exp()).abs() < 1e-6);
        assert!((transmittance(&[(3.0, true)]) - (-1.5f32).exp()).abs() < 1e-6);
        assert!((transmittance(&[(4.0, false)]) - (-3.0f32).exp()).abs() < 1e-6);
    }
}
