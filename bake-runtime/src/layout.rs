//! Structs that shaders and Rust share: written once here, from which both texts are made.
//!
//! A test compares every offset with what the shader compiler reflects, so a forgotten padding word cannot pass.

#![allow(non_camel_case_types, reason = "field types are WGSL's own names")]

use bytemuck::{Pod, Zeroable};

type mat4x4f = [[f32; 4]; 4];
type vec4f = [f32; 4];
type vec3f = [f32; 3];
type u32w = u32;

/// Name, WGSL text, offsets and size of a shared struct.
#[derive(Debug, Clone, Copy)]
pub struct Shared {
    /// Its name in both languages.
    pub name: &'static str,
    /// Its declaration in WGSL.
    pub wgsl: &'static str,
    /// Offset of each field, bytes.
    pub offsets: &'static [(&'static str, usize)],
    /// Its size, bytes.
    pub size: usize,
}

macro_rules! shared {
    ($($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident: $ty:ident,)* })*) => {
        $(
            $(#[$meta])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
            pub struct $name { $($(#[$field_meta])* pub $field: rust!($ty),)* }
        )*
        /// All shared structs.
        pub const SHARED: &[Shared] = &[$(Shared {
            name: stringify!($name),
            wgsl: concat!("struct ", stringify!($name), " {\n", $("    ", stringify!($field), ": ", stringify!($ty), ",\n",)* "}\n"),
            offsets: &[$((stringify!($field), std::mem::offset_of!($name, $field)),)*],
            size: size_of::<$name>(),
        },)*];
    };
}

macro_rules! rust {
    (mat4x4f) => {
        mat4x4f
    };
    (vec4f) => {
        vec4f
    };
    (vec3f) => {
        vec3f
    };
    (u32) => {
        u32w
    };
    (f32) => {
        f32
    };
}

shared! {
    /// What all shaders of a picture see. Directions are unit vectors in world axes; lengths in metres.
    Frame {
        /// Clip space from positions relative to the eye; depth near/distance.
        clip_from_relative: mat4x4f,
        /// Position of the eye.
        eye: vec3f,
        /// Distance of the near plane.
        near: f32,
        /// Direction of view.
        forward: vec3f,
        /// 1/cd·m²: radiance times this is 1 at the curve's white.
        exposure: f32,
        /// From the picture's middle to its right edge, at distance 1.
        right: vec3f,
        /// Number of lamps that shine from a place.
        lamp_count: u32,
        /// From the picture's middle to its upper edge, at distance 1.
        up: vec3f,
        /// Number of lights from infinitely far.
        sun_count: u32,
        /// Uniform sky, cd/m²; of a picture the share that the air leaves.
        sky: vec3f,
        /// Distance from which on clutter is thinned, metres.
        prune_start: f32,
        /// Width and height, texels; left edge and width of the part that is drawn.
        viewport: vec4f,
        /// Turn of the sky's picture about +Y, radians.
        sky_rotation: f32,
        /// Not used.
        padding: f32,
        /// Not used.
        padding_2: f32,
        /// Not used.
        padding_3: f32,
    }
    /// A placement. Rows of the affine map object → world.
    Instance {
        /// x row.
        row_x: vec4f,
        /// y row.
        row_y: vec4f,
        /// z row.
        row_z: vec4f,
        /// Index into the page coordinates minus the first vertex (wrapping).
        page_uv_first: u32,
        /// Index of the node in the baked scene.
        node: u32,
        /// Sign of the map's determinant: −1 mirrors.
        handedness: f32,
        /// Its rank in [0, 1) in the order in which clutter goes; below 0: it never goes.
        rank: f32,
    }
    /// How a surface reflects and emits.
    Surface {
        /// Base colour and opacity.
        base_color: vec4f,
        /// Emission, cd/m².
        emission: vec3f,
        /// Opacity below which MASK cuts.
        alpha_cutoff: f32,
        /// Exponent of the Phong lobe.
        exponent: f32,
        /// Layer of the lobe's table.
        lobe: u32,
        /// Not used.
        padding_y: f32,
        /// Not used.
        padding_z: f32,
        /// Map of base-colour coordinates: u row (u, v, 1, set).
        base_u: vec4f,
        /// v row.
        base_v: vec4f,
        /// Map of emission coordinates: u row (u, v, 1, set).
        emission_u: vec4f,
        /// v row.
        emission_v: vec4f,
    }
    /// A lamp that shines from a place; positions relative to the eye.
    Lamp {
        /// Centre, relative to the eye, metres.
        position: vec3f,
        /// Radius, metres: nothing comes nearer to the centre.
        radius: f32,
        /// Unit axis along which it shines.
        axis: vec3f,
        /// Cosine of the outer half angle.
        cos_outer: f32,
        /// Intensity, cd.
        intensity: vec3f,
        /// Cosine of the inner half angle.
        cos_inner: f32,
        /// Shape of the distribution: 0 all directions, 1 cone, 2 Legendre series.
        shape: u32,
        /// First of its coefficients.
        first: u32,
        /// Number of its coefficients.
        count: u32,
        /// 1: it lights surfaces here, 0: that was baked.
        dynamic: u32,
        /// Layer of its first shadow map; 0xffffffff: none.
        shadow: u32,
        /// Number of its shadow maps: 1 (cone) or 6.
        shadow_count: u32,
        /// Distance at which light ends; 0: never.
        range: f32,
        /// Not used.
        padding: u32,
    }
    /// A light from infinitely far.
    Sun {
        /// Unit direction of travel.
        direction: vec3f,
        /// 1: it lights surfaces here, 0: that was baked.
        dynamic: u32,
        /// Irradiance on a plane that faces it, lux.
        irradiance: vec3f,
        /// Layer of its shadow map; 0xffffffff: none.
        shadow: u32,
    }
    /// A region of air, in world axes; places relative to the eye.
    Medium {
        /// Lowest corner, or the ball's centre, metres.
        low: vec3f,
        /// Bounds: 0 none, 1 box, 2 ball, 3 hull, 4 mesh.
        bounds: u32,
        /// Highest corner; x: the ball's radius.
        high: vec3f,
        /// Density: 0 uniform, 1 exponential, 2 linear in height, 3 about a planet, 4 grid.
        density: u32,
        /// Scattering at density 1, 1/m.
        sigma_s: vec3f,
        /// Height of density 1 (exponential) or 0 (linear), metres; the eye's altitude above a planet's density 1.
        base: f32,
        /// Extinction at density 1, 1/m.
        sigma_t: vec3f,
        /// 1/scale height, or slope, 1/m.
        slope: f32,
        /// Phase: 0 isotropic, 1 linear, 2 Rayleigh, 3 Henyey–Greenstein, 4 Legendre series.
        phase: u32,
        /// Mean cosine (Henyey–Greenstein) or slope (linear).
        asymmetry: f32,
        /// First of its coefficients.
        first: u32,
        /// Number of its coefficients.
        count: u32,
        /// Map of places to the grid's points: x row. Of a planet: its centre, and the eye's distance from it, metres.
        grid_x: vec4f,
        /// y row.
        grid_y: vec4f,
        /// z row.
        grid_z: vec4f,
        /// Points of the grid along its x.
        count_x: u32,
        /// Along its y.
        count_y: u32,
        /// Along its z.
        count_z: u32,
        /// First of its values among the coefficients, x fastest.
        values: u32,
        /// First of the hull's planes among the coefficients, normal and offset of each; of a mesh's boxes, its triangles behind them.
        planes: u32,
        /// Number of the planes or boxes.
        plane_count: u32,
        /// First of a mesh's sharp edges among the coefficients, two corners each.
        edges: u32,
        /// Number of them.
        edge_count: u32,
    }
    /// A shadow map: clip space from positions relative to the eye.
    ShadowView {
        /// Depth is reversed: near/distance, or linear for suns.
        clip_from_relative: mat4x4f,
    }
    /// A lattice of harmonics: probes, or cells of fog.
    Lattice {
        /// Position of the first point, relative to the eye, metres.
        origin: vec3f,
        /// Points along x.
        count_x: u32,
        /// 1/distance of neighbours, 1/m.
        inverse_spacing: vec3f,
        /// Points along y.
        count_y: u32,
        /// Points along z.
        count_z: u32,
        /// Harmonics a point: 4 or 9.
        harmonics: u32,
        /// Not used.
        padding: u32,
        /// Not used.
        padding_2: u32,
    }
}

/// Marks a lamp without shadow map.
pub const NO_SHADOW: u32 = u32::MAX;

/// Most media that a picture sums.
pub const MOST_MEDIA: usize = 8;
