//! Where the eye is and what it sees. Lengths in metres, angles in radians, right-handed, the camera looks along −Z of its own axes.

use glam::{DVec3, Mat4, Vec3, Vec4};

/// A perspective camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position, metres; double precision, because everything is drawn relative to it.
    pub eye: DVec3,
    /// Unit direction of view.
    pub forward: Vec3,
    /// Direction that appears upright; not parallel to `forward`.
    pub up: Vec3,
    /// Vertical angle of view, radians, in (0, π).
    pub fov_y: f32,
    /// Distance of the near plane, metres; there is no far one.
    pub near: f32,
}

impl Camera {
    /// A camera at `eye` that looks at `target`, upright, 50° high.
    pub fn look_at(eye: DVec3, target: DVec3) -> Self {
        let forward = (target - eye).as_vec3().try_normalize().unwrap_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        Self { eye, forward, up, fov_y: 50f32.to_radians(), near: 0.01 }
    }

    /// A camera that sees the whole box, from its front or, where the box holds the camera's way in, from inside.
    pub fn overview(min: Vec3, max: Vec3) -> Self {
        let (centre, size) = ((min + max) * 0.5, (max - min).max(Vec3::splat(1e-3)));
        let eye = centre + Vec3::new(0.15 * size.x, 0.1 * size.y, 0.5 * size.z + 1.2 * size.x.max(size.y));
        Self::look_at(eye.as_dvec3(), centre.as_dvec3())
    }

    /// Unit axes right and up of the picture.
    pub fn axes(&self) -> (Vec3, Vec3) {
        let right = self.forward.cross(self.up).try_normalize().unwrap_or(Vec3::X);
        (right, right.cross(self.forward))
    }

    /// Right and up vectors from the picture's middle to its edges, at distance 1 along `forward`.
    pub fn half_extents(&self, aspect: f32) -> (Vec3, Vec3) {
        let (right, up) = self.axes();
        let half = (0.5 * self.fov_y).tan();
        (right * (half * aspect), up * half)
    }

    /// Clip space from positions relative to the eye; depth is near/distance: 1 at the near plane, 0 at infinity.
    pub fn clip_from_relative(&self, aspect: f32) -> Mat4 {
        let (right, up) = self.axes();
        let scale = 1.0 / (0.5 * self.fov_y).tan();
        let (x, y) = (right * (scale / aspect), up * scale);
        let rows = [x.extend(0.0), y.extend(0.0), Vec4::new(0.0, 0.0, 0.0, self.near), self.forward.extend(0.0)];
        Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_ahead_lands_in_the_middle_with_its_reversed_depth() {
        let camera = Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, -7.0));
        let clip = camera.clip_from_relative(1.5) * Vec3::new(0.0, 0.0, -4.0).extend(1.0);
        assert!(clip.x.abs() < 1e-6 && clip.y.abs() < 1e-6, "{clip}");
        assert!((clip.z / clip.w - camera.near / 4.0).abs() < 1e-7, "{clip}");
        // The picture's edge at distance 1.
        let (right, up) = camera.half_extents(1.5);
        let corner = camera.clip_from_relative(1.5) * (camera.forward + right + up).extend(1.0);
        assert!((corner.x / corner.w - 1.0).abs() < 1e-6 && (corner.y / corner.w - 1.0).abs() < 1e-6, "{corner}");
    }
}
