//! What nodes carry and where they are.

use glam::{DQuat, DVec3};

/// A mesh of a [`Glb`].
#[derive(Debug, Clone, Copy)]
pub struct MeshId(pub(super) u32);

/// A punctual light of a [`Glb`].
#[derive(Debug, Clone, Copy)]
pub struct LightId(pub(super) u32);

/// A punctual light; all emit along the node's −Z where they have a direction.
#[derive(Debug, Clone, Copy)]
pub enum Light {
    /// Intensity, cd.
    Point([f64; 3]),
    /// Intensity (cd) on the axis; half angles in radians.
    Spot {
        /// Intensity on the axis, cd.
        intensity: [f64; 3],
        /// Full intensity up to this angle.
        inner: f64,
        /// None beyond this angle.
        outer: f64,
    },
    /// Illuminance across the beam, lux.
    Directional([f64; 3]),
}

/// Where a node is relative to its parent.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Metres.
    pub translation: DVec3,
    /// Unit quaternion.
    pub rotation: DQuat,
    /// Factor per axis; negative mirrors.
    pub scale: DVec3,
}

impl Place {
    /// Where the parent is.
    pub const ORIGIN: Self = Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// Moved only.
    pub fn at(x: f64, y: f64, z: f64) -> Self {
        Self { translation: DVec3::new(x, y, z), ..Self::ORIGIN }
    }

    /// With a factor per axis.
    pub fn scaled(self, x: f64, y: f64, z: f64) -> Self {
        Self { scale: DVec3::new(x, y, z), ..self }
    }

    /// Turned about +Y, counter-clockwise seen from above.
    pub fn turned_deg(mut self, degrees: f64) -> Self {
        self.rotation = DQuat::from_rotation_y(degrees.to_radians());
        self
    }

    /// With −Z, the way lights and cameras look, pointing at a target.
    pub fn looking_at(mut self, target: DVec3) -> Self {
        let z = (self.translation - target).normalize();
        let up = if z.y.abs() > 0.999 { DVec3::Z } else { DVec3::Y };
        let x = up.cross(z).normalize();
        self.rotation = DQuat::from_mat3(&glam::DMat3::from_cols(x, z.cross(x), z));
        self
    }
}

/// What a node carries.
#[derive(Debug, Clone, Copy)]
pub enum Content {
    /// Only its children.
    Group,
    /// A mesh.
    Mesh(MeshId),
    /// A punctual light.
    Light(LightId),
    /// A perspective camera with this vertical field of view, degrees.
    Camera(f64),
}
