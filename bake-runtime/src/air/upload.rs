//! Media and lights as the shader reads them: places relative to the eye, formed in double precision.

use std::collections::{BTreeSet, HashMap};

use bake_formats::manifest::{LightKind, LightRecord, ProfileRecord};
use bake_optics::airlight::Lut;
use bake_optics::medium::mesh::{ClosedMesh, MeshBox};
use bake_optics::medium::{self, Bounds, Density};
use bake_optics::phase::Phase;
use bake_optics::surface::SurfaceTable;
use glam::{DVec3, DVec4, Vec3};
use wgpu::util::DeviceExt;

use super::LUT_ORDERS;
use crate::layout::{Lamp, MOST_MEDIA, Medium, NO_SHADOW, ShadowView, Sun};
use crate::shadows;

/// Largest coefficient, 1/m: light passes a micrometre. Beyond it products of lamp, air and lobe overflow.
const DENSEST: f64 = 1e6;

/// Side of the table of tails.
const LUT_SIZE: usize = 256;

/// Buffers of one picture.
#[derive(Debug)]
pub(crate) struct AirBuffers {
    pub media: wgpu::Buffer,
    pub lamps: wgpu::Buffer,
    pub suns: wgpu::Buffer,
    pub coefficients: wgpu::Buffer,
    pub moments: wgpu::Buffer,
    pub shadow_views: wgpu::Buffer,
    /// The same, for drawing the maps; empty without shadows.
    pub views: Vec<ShadowView>,
    /// Number of lamps and suns.
    pub counts: [u32; 2],
}

/// What a picture's lights and air are packed from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sources<'a> {
    pub media: &'a [medium::Medium],
    pub baked: &'a [LightRecord],
    pub dynamic: &'a [LightRecord],
    pub eye: DVec3,
    /// Box around everything that casts shadows; none without shadows.
    pub shadowed: Option<[Vec3; 2]>,
}

/// Lights and media in the shader's form.
#[derive(Debug, Default)]
struct Packed {
    media: Vec<Medium>,
    lamps: Vec<Lamp>,
    suns: Vec<Sun>,
    coefficients: Vec<f32>,
}

impl AirBuffers {
    /// Lights and media as seen from the eye.
    pub fn new(device: &wgpu::Device, sources: Sources) -> Self {
        let Sources { media, baked, dynamic, eye, shadowed } = sources;
        let mut packed = Packed::default();
        let media = &media[..media.len().min(MOST_MEDIA)];
        media.iter().for_each(|medium| packed.medium(medium, eye));
        baked.iter().for_each(|light| packed.light(light, eye, false));
        dynamic.iter().for_each(|light| packed.light(light, eye, true));
        let relative = |place: Vec3| (place.as_dvec3() - eye).as_vec3();
        let views = shadowed.map(|bounds| shadows::assign(&mut packed.lamps, &mut packed.suns, bounds.map(relative)));
        let views = views.unwrap_or_default();
        let moments: Vec<f32> =
            media.iter().flat_map(|m| (0..LUT_ORDERS).map(|l| m.phase.moment(l as usize) as f32)).collect();
        let counts = [packed.lamps.len() as u32, packed.suns.len() as u32];
        let buffer = |label, bytes: &[u8], usage| {
            let contents = if bytes.is_empty() { &[0; 128] } else { bytes };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            media: buffer("media", bytemuck::cast_slice(&packed.media), wgpu::BufferUsages::UNIFORM),
            lamps: buffer("lamps", bytemuck::cast_slice(&packed.lamps), storage),
            suns: buffer("suns", bytemuck::cast_slice(&packed.suns), storage),
            coefficients: buffer("coefficients", bytemuck::cast_slice(&packed.coefficients), storage),
            moments: buffer("moments", bytemuck::cast_slice(&moments), storage),
            shadow_views: buffer("shadow_views", bytemuck::cast_slice(&views), storage),
            views,
            counts,
        }
    }
}

impl Packed {
    /// Appends numbers; the index of the first.
    fn numbers(&mut self, numbers: impl IntoIterator<Item = f32>) -> u32 {
        let first = self.coefficients.len() as u32;
        self.coefficients.extend(numbers);
        first
    }

    fn medium(&mut self, source: &medium::Medium, eye: DVec3) {
        let mut packed = Medium::default();
        self.bounds(&mut packed, source, eye);
        self.density(&mut packed, &source.density, eye);
        self.phase(&mut packed, &source.phase);
        let coefficients = |sigma: [f64; 3]| sigma.map(|s| s.clamp(0.0, DENSEST) as f32);
        packed.sigma_s = coefficients(source.scatter.sigma_s);
        packed.sigma_t = coefficients(source.scatter.sigma_t());
        self.media.push(packed);
    }

    /// Grids without bounds of their own end where their density does.
    fn bounds(&mut self, packed: &mut Medium, source: &medium::Medium, eye: DVec3) {
        let relative = |place: DVec3| (place - eye).clamp(DVec3::splat(-1e15), DVec3::splat(1e15)).as_vec3().to_array();
        let (kind, low, high) = match (&source.bounds, &source.density) {
            (Bounds::Box { min, max }, _) => (1, relative(*min), relative(*max)),
            (Bounds::Sphere { centre, radius }, _) => (2, relative(*centre), [*radius as f32, 0.0, 0.0]),
            (Bounds::Hull(planes), _) => {
                let numbers = |p: &DVec4| p.truncate().extend(p.w - p.truncate().dot(eye)).as_vec4().to_array();
                packed.planes = self.numbers(planes.iter().flat_map(numbers));
                packed.plane_count = planes.len() as u32;
                (3, [0.0; 3], [0.0; 3])
            }
            (Bounds::Mesh(mesh), _) => {
                let [min, max] = mesh.bounding_box();
                packed.planes = self.numbers(mesh_numbers(mesh, eye));
                packed.plane_count = mesh.boxes().len() as u32;
                let edges = sharp_edges(mesh);
                packed.edge_count = edges.len() as u32;
                packed.edges = self.numbers(edges.iter().flatten().flat_map(|place| relative(*place)));
                (4, relative(min), relative(max))
            }
            (_, Density::Grid(grid)) => {
                let [min, max] = grid.bounding_box();
                (1, relative(min), relative(max))
            }
            _ => (0, [0.0; 3], [0.0; 3]),
        };
        (packed.bounds, packed.low, packed.high) = (kind, low, high);
    }

    fn density(&mut self, packed: &mut Medium, source: &Density, eye: DVec3) {
        let (kind, base, slope) = match source {
            Density::Uniform => (0, 0.0, 0.0),
            Density::Exponential { base_m, scale_height_m } => (1, base_m - eye.y, 1.0 / scale_height_m),
            Density::Linear { zero_m, slope_per_m } => (2, zero_m - eye.y, *slope_per_m),
            Density::Planet { centre, radius_m, scale_height_m } => {
                let from_eye = *centre - eye;
                packed.grid_x = from_eye.extend(from_eye.length()).as_vec4().to_array();
                (3, from_eye.length() - radius_m, 1.0 / scale_height_m)
            }
            Density::Grid(grid) => {
                let grid_from_world = grid.world_from_grid().inverse();
                let origin = grid_from_world.transform_point3(eye);
                let row = |r: usize| grid_from_world.matrix3.row(r).extend(origin[r]).as_vec4().to_array();
                (packed.grid_x, packed.grid_y, packed.grid_z) = (row(0), row(1), row(2));
                [packed.count_x, packed.count_y, packed.count_z] = grid.size().as_uvec3().to_array();
                packed.values = self.numbers(grid.values().iter().copied());
                (4, 0.0, 0.0)
            }
        };
        (packed.density, packed.base, packed.slope) = (kind, base as f32, slope as f32);
    }

    fn phase(&mut self, packed: &mut Medium, source: &Phase<f64>) {
        let (kind, asymmetry) = match source {
            Phase::Linear { a1 } => (1, *a1),
            Phase::Rayleigh => (2, 0.0),
            Phase::HenyeyGreenstein { g } => (3, *g),
            Phase::Legendre(terms) => {
                packed.first = self.numbers(terms.iter().map(|&c| c as f32));
                packed.count = terms.len() as u32;
                (4, 0.0)
            }
            _ => (0, 0.0),
        };
        (packed.phase, packed.asymmetry) = (kind, asymmetry as f32);
    }

    fn light(&mut self, light: &LightRecord, eye: DVec3, dynamic: bool) {
        let relative =
            |place: &Vec3| (place.as_dvec3() - eye).as_vec3().clamp(Vec3::splat(-1e15), Vec3::splat(1e15)).to_array();
        let mut lamp = Lamp {
            intensity: light.color.to_array(),
            axis: [0.0, 0.0, -1.0],
            cos_outer: -1.0,
            cos_inner: -1.0,
            dynamic: dynamic.into(),
            shadow: NO_SHADOW,
            ..Lamp::default()
        };
        match &light.kind {
            LightKind::Point { position, radius, range, profile } => {
                lamp = Lamp { position: relative(position), radius: *radius, range: range.unwrap_or(0.0), ..lamp };
                self.profile(&mut lamp, profile.as_ref());
            }
            LightKind::Spot { position, direction, inner_angle, outer_angle, radius, range, profile } => {
                lamp = Lamp { position: relative(position), radius: *radius, range: range.unwrap_or(0.0), ..lamp };
                lamp.axis = direction.try_normalize().unwrap_or(Vec3::NEG_Z).to_array();
                (lamp.shape, lamp.cos_inner, lamp.cos_outer) = (1, inner_angle.cos(), outer_angle.cos());
                self.profile(&mut lamp, profile.as_ref());
            }
            LightKind::Directional { direction, .. } => {
                let direction = direction.try_normalize().unwrap_or(Vec3::NEG_Y).to_array();
                let irradiance = light.color.to_array();
                self.suns.push(Sun { direction, dynamic: dynamic.into(), irradiance, shadow: NO_SHADOW });
                return;
            }
        }
        self.lamps.push(lamp);
    }

    /// A measured distribution replaces the cone.
    fn profile(&mut self, lamp: &mut Lamp, profile: Option<&ProfileRecord>) {
        let Some(profile) = profile else { return };
        lamp.axis = profile.axis.try_normalize().unwrap_or(Vec3::NEG_Y).to_array();
        (lamp.shape, lamp.count) = (2, profile.legendre.len() as u32);
        lamp.first = self.numbers(profile.legendre.iter().copied());
    }
}

/// A mesh as `mesh.wgsl` reads it, for shaders of one's own too: eight numbers for each of its boxes, then nine for each
/// triangle, places relative to the eye.
pub fn mesh_numbers(mesh: &ClosedMesh, eye: DVec3) -> Vec<f32> {
    let corners: Vec<[f32; 3]> = mesh.positions().iter().map(|place| (*place - eye).as_vec3().to_array()).collect();
    let mut numbers = Vec::new();
    for MeshBox { min, max, next, triangles } in mesh.boxes() {
        numbers.extend((min - eye).as_vec3().extend(next as f32).to_array());
        numbers.extend((max - eye).as_vec3().extend((8 * triangles.start + triangles.len() as u32) as f32).to_array());
    }
    numbers.extend(mesh.triangles().iter().flatten().flat_map(|&corner| corners[corner as usize]));
    numbers
}

/// Meshes of more triangles are taken for smooth: a ray is not cut where the way to a lamp passes their edges.
const MOST_SHARP: usize = 1024;

/// Edges at which two triangles' normals differ by more than 8 degrees, as pairs of places.
fn sharp_edges(mesh: &ClosedMesh) -> Vec<[DVec3; 2]> {
    let place = |corner: u32| mesh.positions()[corner as usize];
    let mut first: HashMap<(u32, u32), DVec3> = HashMap::new();
    let mut sharp = BTreeSet::new();
    for &[a, b, c] in mesh.triangles().iter().filter(|_| mesh.triangles().len() <= MOST_SHARP) {
        let normal = (place(b) - place(a)).cross(place(c) - place(a)).normalize_or_zero();
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let edge = (from.min(to), from.max(to));
            let bent = first.insert(edge, normal).is_some_and(|other| other.dot(normal) < 0.99);
            if bent {
                sharp.insert(edge);
            }
        }
    }
    sharp.into_iter().map(|(a, b)| [place(a), place(b)]).collect()
}

/// The tables of [`super::Method::Lut`] as layers of a texture, for shaders of one's own too.
pub fn tail_texels(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
    let table = Lut::new(LUT_SIZE, LUT_ORDERS as usize);
    let layers: Vec<Vec<[f32; 4]>> =
        table.layers().iter().map(|layer| layer.iter().map(|&value| [value; 4]).collect()).collect();
    crate::model::upload_texels(device, queue, [LUT_SIZE as u32; 2], &layers, true)
}

/// Side of the tables of light that air sends to surfaces.
const SURFACE_SIZE: usize = 48;

/// Tables of G_n as layers of a texture: the Lambertian one, then one for each Phong exponent.
pub(crate) fn surface_texels(device: &wgpu::Device, queue: &wgpu::Queue, exponents: &[f32]) -> wgpu::TextureView {
    let powers = std::iter::once(1.0).chain(exponents.iter().map(|&n| f64::from(n)));
    let layer = |power: f64| {
        let table = SurfaceTable::new(SURFACE_SIZE, power);
        table.texels().iter().map(|&value| [value; 4]).collect()
    };
    let layers: Vec<Vec<[f32; 4]>> = powers.map(layer).collect();
    crate::model::upload_texels(device, queue, [SURFACE_SIZE as u32; 2], &layers, true)
}
