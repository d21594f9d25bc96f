//! The checked scene: SI units, world axes of the glTF file, instances kept as instances.
//!
//! Whatever a file may get wrong is refused by the loader; code after it relies on these invariants:
//! every index is in range, every number is finite, directions are unit vectors, albedos lie in [0, 1],
//! every mesh has at least one triangle, transforms are invertible.

mod accessor;
mod buffers;
mod container;
mod document;
mod draco;
mod environment;
mod error;
mod extensions;
mod files;
mod ies;
mod image;
mod light;
mod light_units;
mod load;
mod material;
mod mesh;
mod nodes;
mod options;
mod primitive;
mod references;
pub mod surface;
mod warning;

pub use error::{Fault, LoadError};
pub use load::{load, load_from_bytes};
pub use options::{Env, Ies, LightUnits, LoadOptions, SceneChoice, Sun, UnlitMode};
pub use warning::{Warning, WarningKind};

use glam::{Affine3A, Vec2, Vec3, Vec4};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything that the bake knows about the world.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Stem of the scene file.
    pub name: String,
    /// BLAKE3 of all that was read: of the file alone where it names no others, else of its bytes followed by the hash of each
    /// file that it names, in the order of reading. Lower-case hexadecimal.
    pub blake3: String,
    /// Geometry in object space, each mesh once however often it is placed.
    pub meshes: Vec<Mesh>,
    /// Placements of meshes.
    pub instances: Vec<Instance>,
    /// Materials; the glTF default material is appended when a primitive names none.
    pub materials: Vec<Material>,
    /// Decoded images.
    pub images: Vec<Arc<Image>>,
    /// Point, spot and directional lights in world space.
    pub lights: Vec<Light>,
    /// Light from infinitely far away, if any.
    pub environment: Option<Environment>,
    /// What the glTF scene says about the air.
    pub media_extras: Option<MediaExtras>,
}

/// `extras.bake_media` of a glTF scene, as it stands there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MediaExtras {
    /// JSON.
    pub json: String,
    /// Folder of the scene file, to which file names are relative.
    pub folder: PathBuf,
}

/// Triangles in object space. Vertex arrays have equal length; absent attributes are filled with their glTF default.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Name in the file, or `mesh N`.
    pub name: String,
    /// Positions, metres in object space.
    pub positions: Vec<Vec3>,
    /// Shading normals, unit; the geometric normal where the file has none.
    pub normals: Vec<Vec3>,
    /// Texture coordinate sets 0 to 2; zero where absent. Baked scenes carry the lightmap's coordinates as set 1, a
    /// material's further ones as set 2.
    pub texcoords: [Vec<Vec2>; 3],
    /// Vertex colour (linear, with alpha); white where absent.
    pub colors: Vec<Vec4>,
    /// Vertex indices per triangle, counter-clockwise seen from the front in object space.
    pub triangles: Vec<[u32; 3]>,
    /// The glTF primitives, in order, covering `triangles` exactly.
    pub primitives: Vec<Primitive>,
    /// Whether every primitive of the file carried TEXCOORD_1.
    pub has_texcoord_1: bool,
}

/// A run of triangles with one material.
#[derive(Debug, Clone)]
pub struct Primitive {
    /// Range in the mesh's triangles.
    pub triangles: Range<u32>,
    /// Range in the mesh's vertex arrays that these triangles use.
    pub vertices: Range<u32>,
    /// Index into the scene's materials.
    pub material: u32,
}

impl Mesh {
    /// Material index of a triangle.
    pub fn material_of(&self, triangle: u32) -> u32 {
        let at = self.primitives.partition_point(|p| p.triangles.end <= triangle);
        self.primitives[at].material
    }
}

/// A mesh placed in the world.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Path of node names from the scene root, `/`-separated.
    pub path: String,
    /// Index of the glTF node.
    pub node: u32,
    /// Index into the scene's meshes.
    pub mesh: u32,
    /// Object to world; may mirror.
    pub world_from_object: Affine3A,
    /// Whether it is to take a lightmap (instances of EXT_mesh_gpu_instancing do not unless asked).
    pub lightmapped: bool,
}

impl Instance {
    /// Whether the transform turns the winding of triangles around.
    pub fn is_mirrored(&self) -> bool {
        self.world_from_object.matrix3.determinant() < 0.0
    }
}

/// How alpha is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Cut away where alpha is below the cutoff.
    Mask(f32),
    /// The share 1 − alpha passes straight through.
    Blend,
}

/// A Lambertian surface. Colours are linear Rec.709.
#[derive(Debug, Clone)]
pub struct Material {
    /// Name in the file, or `material N`.
    pub name: String,
    /// Base colour factor with alpha, each in [0, 1].
    pub base_color: Vec4,
    /// Base colour texture (sRGB, alpha linear).
    pub base_color_texture: Option<TextureRef>,
    /// Emitted radiance factor, cd/m² (strength multiplied in).
    pub emission: Vec3,
    /// Emission texture (sRGB).
    pub emission_texture: Option<TextureRef>,
    /// Use of alpha.
    pub alpha_mode: AlphaMode,
    /// Whether the back side reflects and emits too.
    pub double_sided: bool,
    /// Share of light that passes straight through, coloured by base colour (KHR_materials_transmission).
    pub transmission: f32,
    /// Transmission texture (channel R).
    pub transmission_texture: Option<TextureRef>,
    /// Share of light scattered to the far side (KHR_materials_diffuse_transmission).
    pub diffuse_transmission: f32,
    /// Diffuse transmission texture (channel A).
    pub diffuse_transmission_texture: Option<TextureRef>,
    /// Colour of diffusely transmitted light.
    pub diffuse_transmission_color: Vec3,
    /// Texture of that colour (sRGB).
    pub diffuse_transmission_color_texture: Option<TextureRef>,
    /// Absorption of the closed volume behind the surface, 1/m per channel (KHR_materials_volume); zero when thin.
    pub volume_sigma_a: Vec3,
    /// Neither reflects nor emits (KHR_materials_unlit), unless the settings ask for it.
    pub unlit: bool,
    /// Reflection is spread: metallic, or nearly mirror-like, in the file (only counted for the report).
    pub is_specular: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            transmission: 0.0,
            transmission_texture: None,
            diffuse_transmission: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color: Vec3::ONE,
            diffuse_transmission_color_texture: None,
            volume_sigma_a: Vec3::ZERO,
            unlit: false,
            is_specular: false,
        }
    }
}

/// Use of an image by a material.
#[derive(Debug, Clone)]
pub struct TextureRef {
    /// Index into the scene's images.
    pub image: u32,
    /// Texture coordinate set, 0 to 2.
    pub texcoord: u8,
    /// Wrapping along u and v.
    pub wrap: [Wrap; 2],
    /// Bilinear, or nearest.
    pub linear: bool,
    /// KHR_texture_transform: rows of the 2×3 matrix on (u, v, 1).
    pub transform: [Vec3; 2],
}

/// Texture wrapping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// Tiles.
    Repeat,
    /// Tiles, every second one mirrored.
    Mirror,
    /// Holds the edge texel.
    Clamp,
}

/// A decoded image; whether texels are sRGB or linear is the use's matter.
#[derive(Debug, Clone)]
pub struct Image {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Row-major from the top, 8 bits a channel.
    pub rgba: Vec<[u8; 4]>,
}

/// A light that is no surface, in world space.
#[derive(Debug, Clone)]
pub struct Light {
    /// Path of the node that carries it.
    pub path: String,
    /// Intensity (cd) of point and spot lights, illuminance (lux) of directional ones, per linear RGB channel.
    pub color: Vec3,
    /// Shape and placement.
    pub kind: LightKind,
}

impl Light {
    /// Whether it shines from infinitely far.
    pub fn is_directional(&self) -> bool {
        matches!(self.kind, LightKind::Directional { .. })
    }
}

/// Kinds of punctual light.
#[derive(Debug, Clone)]
pub enum LightKind {
    /// Same intensity in every direction, or that of a profile.
    Point {
        /// Position, metres.
        position: Vec3,
        /// Radius of the emitting ball, metres; never below the smallest radius of the settings.
        radius: f32,
        /// glTF range, metres; light ends there where the file says so.
        range: Option<f32>,
        /// Measured distribution, if any.
        profile: Option<Profile>,
    },
    /// A cone.
    Spot {
        /// Position, metres.
        position: Vec3,
        /// Unit axis, along the light's travel.
        direction: Vec3,
        /// Cosine of the angle up to which intensity is full.
        cos_inner: f32,
        /// Cosine of the angle beyond which it is zero.
        cos_outer: f32,
        /// Radius of the emitting ball, metres.
        radius: f32,
        /// glTF range, metres.
        range: Option<f32>,
        /// Measured distribution, which then replaces the cone.
        profile: Option<Profile>,
    },
    /// From infinitely far, a disk of the given angular radius.
    Directional {
        /// Unit vector along the light's travel.
        direction: Vec3,
        /// Angular radius of the source, radians; 0 is a point.
        angular_radius: f32,
    },
}

/// An IES profile placed in the world: intensity relative to the light's `color`, which is its maximum.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Unit axis of vertical angle 0.
    pub axis: Vec3,
    /// Unit vector of horizontal angle 0, perpendicular to the axis.
    pub horizontal: Vec3,
    /// Vertical angles, radians, ascending.
    pub vertical: Arc<Vec<f32>>,
    /// Horizontal angles, radians, ascending from 0.
    pub horizontal_angles: Arc<Vec<f32>>,
    /// Relative intensity, `horizontal_angles.len()` rows of `vertical.len()`.
    pub relative: Arc<Vec<f32>>,
}

/// Light from all directions.
#[derive(Debug, Clone)]
pub struct Environment {
    /// Texels across (longitude).
    pub width: u32,
    /// Texels down (latitude, +Y at the top row).
    pub height: u32,
    /// Radiance, cd/m², row-major. A uniform sky is 1×1. Column 0 begins at azimuth 0: direction −Z turning towards +X.
    pub radiance: Vec<Vec3>,
    /// Turn about +Y, radians, added to the azimuth.
    pub rotation: f32,
}

impl Scene {
    /// Lowest and highest corner of the box around all placed vertices, metres; turned inside out where there are none.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.bounds_of(|_| true)
    }

    /// The same of some of the instances.
    pub fn bounds_of(&self, some: impl Fn(&Instance) -> bool) -> [Vec3; 2] {
        let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for instance in self.instances.iter().filter(|instance| some(instance)) {
            for position in &self.meshes[instance.mesh as usize].positions {
                let world = instance.world_from_object.transform_point3(*position);
                bounds = [bounds[0].min(world), bounds[1].max(world)];
            }
        }
        bounds
    }

    /// The material of an instance's triangle.
    pub fn material_at(&self, instance: u32, triangle: u32) -> &Material {
        let mesh = &self.meshes[self.instances[instance as usize].mesh as usize];
        &self.materials[mesh.material_of(triangle) as usize]
    }
}
