//! What a package holds, in the shape that a device takes: one vertex and one index list, placements grouped by shape.

mod charts;
mod images;
mod lamps;
mod terms;

pub use charts::page_charts;
pub use images::{LatticeData, Page};
pub use terms::{PageContent, Reading, TermPages};

use std::collections::BTreeMap;

use bake_formats::Package;
use bake_formats::baked_scene::{BakedScene, Geometry, Node};
use bake_formats::glb::document as gltf;
use bake_formats::manifest::{EnvironmentRecord, LightRecord};
use bake_formats::metrics::luminance;
use bake_optics::medium::Medium;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::air::records;
use crate::error::{Result, RuntimeError};
use crate::layout::{Instance, Surface};
use crate::prune;
use crate::sky::SkyPicture;

/// A vertex of the one list.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct Vertex {
    /// Object space, metres.
    pub position: [f32; 3],
    /// Object space, unit.
    pub normal: [f32; 3],
    /// First coordinate set.
    pub uv_0: [f32; 2],
    /// Second and third set.
    pub uv_more: [f32; 4],
    /// Vertex colour, linear.
    pub color: [f32; 4],
}

/// A decoded texture.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// sRGB with linear opacity, four bytes a texel.
    pub rgba: Vec<u8>,
    /// How it is sampled.
    pub sampler: gltf::Sampler,
    /// Whether it holds numbers (normals) instead of sRGB colours.
    pub linear: bool,
}

/// How opacity is treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Opacity {
    /// Ignored.
    Opaque,
    /// Cut at the material's cutoff.
    Mask,
    /// Blended, back to front.
    Blend,
}

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Numbers.
    pub surface: Surface,
    /// Index of the base-colour texture.
    pub base_texture: Option<u32>,
    /// Index of the emission texture.
    pub emission_texture: Option<u32>,
    /// Index of the texture that bends normals; baked scenes name none, a host may.
    pub normal_texture: Option<u32>,
    /// Whether it emits at all.
    pub emits: bool,
    /// How opacity is treated.
    pub opacity: Opacity,
    /// Whether it shows a highlight of lights that were not baked.
    pub shines: bool,
    /// Whether its back is seen.
    pub double_sided: bool,
}

/// Triangles with one material, placed by a run of instances that share shape, page and handedness.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    /// Run of the index list.
    pub indices: std::ops::Range<u32>,
    /// Index into the materials.
    pub material: u32,
    /// Lightmap page.
    pub page: Option<u32>,
    /// Run of the instance list.
    pub instances: std::ops::Range<u32>,
    /// Whether the placements mirror.
    pub mirrored: bool,
    /// Middle of the placements' boxes, metres: the depth order of blended draws.
    pub centre: Vec3,
    /// Box around the placements' origins, metres.
    pub origins: [Vec3; 2],
}

/// A placement's name and page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlacedNode {
    /// Path of node names in the original scene.
    pub path: String,
    /// Lightmap page.
    pub page: Option<u32>,
}

/// A package ready for a device.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneData {
    /// All vertices.
    pub vertices: Vec<Vertex>,
    /// Triangles.
    pub indices: Vec<u32>,
    /// Page coordinates, placement by placement.
    pub page_uvs: Vec<[f32; 2]>,
    /// Placements by the baked scene's node numbers.
    pub nodes: Vec<PlacedNode>,
    /// Placements, in runs.
    pub instances: Vec<Instance>,
    /// What is drawn.
    pub draws: Vec<Draw>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Lightmap pages.
    pub pages: Vec<Page>,
    /// Lights of the bake.
    pub lights: Vec<LightRecord>,
    /// Lights that were not baked: they shine on surfaces and air alike, and may change from picture to picture.
    pub dynamic_lights: Vec<LightRecord>,
    /// Light stored in space by the bake, for surfaces without lightmap.
    pub probes: Option<LatticeData>,
    /// The same for the air, without what comes straight from `lights`: from the fog volume, else from the probes.
    pub air_light: Option<LatticeData>,
    /// The air, places in the world; may change from picture to picture.
    pub media: Vec<Medium>,
    /// What of the package is not drawn, in words.
    pub notes: Vec<String>,
    /// Light from infinitely far away.
    pub environment: Option<EnvironmentRecord>,
    /// Its picture, where it is not uniform.
    pub sky: Option<SkyPicture>,
    /// Box around everything, metres.
    pub bounds: [Vec3; 2],
}

impl SceneData {
    /// Reads everything that is drawn from a package.
    pub fn load(package: &Package) -> Result<Self> {
        let file = package.baked_scene();
        let baked = BakedScene::from_bytes(&package.path(&file), &package.read(&file)?)?;
        let mut scene = Self {
            textures: decode_textures(&file, &baked)?,
            materials: baked.materials.iter().map(material).collect(),
            pages: images::read_pages(package)?,
            lights: package.manifest.lights.clone(),
            environment: package.manifest.environment.clone(),
            ..Self::default()
        };
        scene.sky = images::read_sky(package)?;
        scene.place(&baked);
        let placed = |node: &Node| PlacedNode { path: node.path.clone(), page: node.lightmap.as_ref().map(|l| l.page) };
        scene.nodes = baked.nodes.iter().map(placed).collect();
        let manifest = &package.manifest;
        let read = |grid, bands| images::read_lattice(package, grid, bands);
        let probes = manifest.probes.as_ref().map(|grid| read(grid, 3)).transpose()?;
        let cells = manifest.fog_volume.as_ref().map(|grid| read(grid, 2)).transpose()?;
        if let (Some(mut light), false) = (cells.or_else(|| probes.clone()), manifest.media.is_empty()) {
            // A grid too wide to be stored is told by the notes; what it would take away is then left in.
            let media = package.media().map(|(media, _)| media).unwrap_or_default();
            lamps::take_out(&mut light.data, &light.places, &manifest.lights, &media);
            scene.air_light = Some(light.into_even());
        }
        scene.probes = probes.map(images::Stored::into_even);
        (scene.media, scene.notes) = records::media(package)?;
        Ok(scene)
    }

    /// A brightness that the scene's surfaces have: the 90th percentile of irradiance/π, cd/m²; 1 in a dark scene.
    pub fn typical_radiance(&self) -> f32 {
        let texels = self.pages.iter().flat_map(|page| &page.irradiance);
        let mut levels: Vec<f32> = texels.map(|e| (luminance(Vec3::from(*e)) as f32).max(0.0)).collect();
        levels.retain(|level| *level > 0.0);
        if levels.is_empty() {
            return 1.0;
        }
        let at = levels.len() * 9 / 10;
        *levels.select_nth_unstable_by(at, f32::total_cmp).1 / std::f32::consts::PI
    }

    /// Vertices, placements and draws of a baked scene.
    fn place(&mut self, baked: &BakedScene) {
        let first_vertices: Vec<u32> = baked.geometries.iter().map(|geometry| self.push_vertices(geometry)).collect();
        let mut groups: BTreeMap<(u32, Option<u32>, bool), Vec<usize>> = BTreeMap::new();
        for (index, node) in baked.nodes.iter().enumerate() {
            let page = node.lightmap.as_ref().map(|lightmap| lightmap.page);
            groups.entry((node.geometry, page, is_mirrored(node))).or_default().push(index);
        }
        let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for ((geometry, page, mirrored), mut nodes) in groups {
            let clutter = nodes.len() >= prune::LEAST;
            if clutter {
                nodes.sort_by_key(|&index| (prune::scrambled(index as u32), index));
            }
            let (shape, first_vertex) = (&baked.geometries[geometry as usize], first_vertices[geometry as usize]);
            let start = self.instances.len() as u32;
            let mut around = [Vec3::INFINITY, Vec3::NEG_INFINITY];
            let mut origins = [Vec3::INFINITY, Vec3::NEG_INFINITY];
            for (place, &index) in nodes.iter().enumerate() {
                let rank = if clutter { (place as f32 + 0.5) / nodes.len() as f32 } else { -1.0 };
                self.push_instance(&baked.nodes[index], index, first_vertex, rank);
                grow(&mut around, shape, &baked.nodes[index]);
                let origin = Vec3::from(baked.nodes[index].world_from_object.translation);
                origins = [origins[0].min(origin), origins[1].max(origin)];
            }
            bounds = [bounds[0].min(around[0]), bounds[1].max(around[1])];
            let instances = start..self.instances.len() as u32;
            let centre = (around[0] + around[1]) * 0.5;
            for primitive in &shape.primitives {
                let indices = self.push_triangles(&primitive.triangles, first_vertex);
                let (instances, material) = (instances.clone(), primitive.material);
                self.draws.push(Draw { indices, material, page, instances, mirrored, centre, origins });
            }
        }
        self.bounds = if bounds[0].is_finite() { bounds } else { [Vec3::ZERO, Vec3::ONE] };
    }

    fn push_vertices(&mut self, geometry: &Geometry) -> u32 {
        let first = self.vertices.len() as u32;
        let set =
            |index: usize, at: usize| geometry.texcoords_material.get(index).map_or([0.0; 2], |s| s[at].to_array());
        self.vertices.extend((0..geometry.positions.len()).map(|at| {
            let ([a, b], [c, d]) = (set(0, at), set(1, at));
            Vertex {
                position: geometry.positions[at].to_array(),
                normal: geometry.normals[at].to_array(),
                uv_0: geometry.texcoord_0[at].to_array(),
                uv_more: [a, b, c, d],
                color: geometry.colors.as_ref().map_or([1.0; 4], |colors| colors[at].to_array()),
            }
        }));
        first
    }

    fn push_instance(&mut self, node: &Node, index: usize, first_vertex: u32, rank: f32) {
        let map = node.world_from_object;
        let row = |r: usize| map.matrix3.row(r).extend(map.translation[r]).to_array();
        let page_uv_first = (self.page_uvs.len() as u32).wrapping_sub(first_vertex);
        self.page_uvs.extend(node.lightmap.iter().flat_map(|lightmap| lightmap.uv.iter().map(|uv| uv.to_array())));
        self.instances.push(Instance {
            row_x: row(0),
            row_y: row(1),
            row_z: row(2),
            page_uv_first,
            node: index as u32,
            handedness: if is_mirrored(node) { -1.0 } else { 1.0 },
            rank,
        });
    }

    fn push_triangles(&mut self, triangles: &[[u32; 3]], first_vertex: u32) -> std::ops::Range<u32> {
        let start = self.indices.len() as u32;
        self.indices.extend(triangles.iter().flatten().map(|index| index + first_vertex));
        start..self.indices.len() as u32
    }
}

fn is_mirrored(node: &Node) -> bool {
    node.world_from_object.matrix3.determinant() < 0.0
}

fn grow(around: &mut [Vec3; 2], shape: &Geometry, node: &Node) {
    for &position in &shape.positions {
        let world = node.world_from_object.transform_point3(position);
        *around = [around[0].min(world), around[1].max(world)];
    }
}

fn material(source: &gltf::Material) -> Material {
    let pbr = &source.pbr_metallic_roughness;
    let strength = source.extensions.emissive_strength.as_ref().map_or(1.0, |s| s.emissive_strength);
    let emission = Vec3::from(source.emissive_factor.unwrap_or([0.0; 3])) * strength;
    let opacity = match source.alpha_mode {
        gltf::AlphaMode::Opaque => Opacity::Opaque,
        gltf::AlphaMode::Mask => Opacity::Mask,
        gltf::AlphaMode::Blend => Opacity::Blend,
    };
    let (base_u, base_v) = rows(pbr.base_color_texture.as_ref());
    let (emission_u, emission_v) = rows(source.emissive_texture.as_ref());
    let surface = Surface {
        base_color: pbr.base_color_factor,
        emission: emission.to_array(),
        alpha_cutoff: source.alpha_cutoff.unwrap_or(0.5),
        base_u,
        base_v,
        emission_u,
        emission_v,
        exponent: phong_exponent(pbr.roughness_factor),
        ..Surface::default()
    };
    Material {
        surface,
        base_texture: pbr.base_color_texture.as_ref().map(|info| info.index),
        emission_texture: source.emissive_texture.as_ref().map(|info| info.index),
        normal_texture: None,
        emits: emission.max_element() > 0.0,
        opacity,
        shines: pbr.roughness_factor < 1.0,
        double_sided: source.double_sided,
    }
}

/// The Phong lobe as wide as a microfacet one of the roughness: 2/α² − 2 with α = roughness² (Walter et al. 2007, eq. 35 ff.).
fn phong_exponent(roughness: f32) -> f32 {
    let alpha = (roughness * roughness).clamp(0.02, 1.0);
    2.0 / (alpha * alpha) - 2.0
}

/// Rows of translation · rotation · scale (KHR_texture_transform); w of the first is the coordinate set.
fn rows(info: Option<&gltf::TextureInfo>) -> ([f32; 4], [f32; 4]) {
    let set = info.map_or(0, |info| info.tex_coord) as f32;
    let Some(transform) = info.and_then(|info| info.extensions.as_ref()).map(|extensions| &extensions.transform) else {
        return ([1.0, 0.0, 0.0, set], [0.0, 1.0, 0.0, 0.0]);
    };
    let (sin, cos) = transform.rotation.sin_cos();
    let ([x, y], [sx, sy]) = (transform.offset, transform.scale);
    ([sx * cos, sy * sin, x, set], [-sx * sin, sy * cos, y, 0.0])
}

fn decode_textures(file: &str, baked: &BakedScene) -> Result<Vec<Texture>> {
    let decode = |(index, texture): (usize, &bake_formats::baked_scene::Texture)| {
        let image = image::load_from_memory_with_format(&texture.png, image::ImageFormat::Png);
        let image =
            image.map_err(|error| RuntimeError::Texture { file: file.into(), index, reason: error.to_string() })?;
        let rgba = image.into_rgba8();
        let (width, height) = rgba.dimensions();
        Ok(Texture { width, height, rgba: rgba.into_raw(), sampler: texture.sampler.clone(), linear: false })
    };
    baked.textures.iter().enumerate().map(decode).collect()
}
