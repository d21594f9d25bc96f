//! The runtime's scene file `NAME.baked.glb`: geometry with page coordinates, materials, textures and lights.
//!
//! Every lightmapped instance is a node with its own mesh object, which shares all accessors with its siblings except
//! TEXCOORD_1, the final page coordinates. A material is repeated once for each page that its surfaces lie on; its
//! MOZ_lightmap (intensity 1) names the page's EXR by relative URI, and in `extras` an embedded 8-bit preview.
//! The record of an instance stands in its node's `extras.bake`.

use crate::error::{FormatError, Result};
use crate::glb::document as gltf;
use crate::glb::{Builder, Reader};
use crate::manifest::{LightKind, LightRecord};
use glam::{Affine3A, Mat4, Quat, Vec2, Vec3, Vec4};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// A scene with lightmaps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BakedScene {
    /// Name of the scene.
    pub name: String,
    /// Shapes, each once however often it is placed.
    pub geometries: Vec<Geometry>,
    /// Placements; the index is the node's index in the file.
    pub nodes: Vec<Node>,
    /// Materials without lightmap, in glTF's form; their texture indices mean `textures`, their coordinate set 0
    /// [`Geometry::texcoord_0`], and k ≥ 1 entry k − 1 of [`Geometry::texcoords_material`].
    pub materials: Vec<gltf::Material>,
    /// Images with their samplers.
    pub textures: Vec<Texture>,
    /// Lightmap pages.
    pub pages: Vec<PageImage>,
    /// Lights in world space; written, not read: the manifest has them.
    pub lights: Vec<LightRecord>,
}

/// A shape in object space; all vertex arrays have the length of `positions`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Geometry {
    /// For people.
    pub name: String,
    /// Metres.
    pub positions: Vec<Vec3>,
    /// Shading normals, unit.
    pub normals: Vec<Vec3>,
    /// TEXCOORD_0.
    pub texcoord_0: Vec<Vec2>,
    /// Further coordinate sets that textures use, two at most; TEXCOORD_2 and 3 of the file, since 1 is the lightmap's.
    pub texcoords_material: Vec<Vec<Vec2>>,
    /// Vertex colours, where not all white.
    pub colors: Option<Vec<Vec4>>,
    /// Triangles by material.
    pub primitives: Vec<Primitive>,
}

/// Triangles with one material.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Primitive {
    /// Vertex indices, counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index into the scene's materials.
    pub material: u32,
}

/// A placement of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Path of node names in the original scene.
    pub path: String,
    /// Index of the node in the original scene.
    pub source_node: u32,
    /// Object to world; may mirror.
    pub world_from_object: Affine3A,
    /// Index into the scene's geometries.
    pub geometry: u32,
    /// Lightmap, if it has one.
    pub lightmap: Option<Lightmap>,
}

/// Where a placement's light lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Lightmap {
    /// Index of the page.
    pub page: u32,
    /// Page coordinate of each vertex of the geometry.
    pub uv: Vec<Vec2>,
}

/// An image with its sampler.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Texture {
    /// PNG bytes. Equal images are stored once.
    pub png: Vec<u8>,
    /// How it is sampled.
    pub sampler: gltf::Sampler,
}

/// A lightmap page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PageImage {
    /// Relative URI of the EXR image.
    pub uri: String,
    /// sRGB PNG of irradiance / `preview_white`, clipped.
    pub preview: Vec<u8>,
    /// Irradiance (lux) of the preview's white.
    pub preview_white: f32,
}

impl BakedScene {
    /// The file's bytes. Errors when they pass GLB's limit of 4 GiB.
    pub fn to_bytes(&self, path: &Path) -> Result<Vec<u8>> {
        let mut writer = Writer { scene: self, builder: Builder::default(), materials: BTreeMap::new() };
        writer.textures();
        let accessors: Vec<_> = self.geometries.iter().map(|geometry| writer.geometry(geometry)).collect();
        let mut plain_meshes = BTreeMap::new();
        for node in &self.nodes {
            let shared = &accessors[node.geometry as usize];
            let mesh = match &node.lightmap {
                Some(lightmap) => writer.mesh(node, shared, Some(lightmap)),
                None => *plain_meshes.entry(node.geometry).or_insert_with(|| writer.mesh(node, shared, None)),
            };
            writer.node(node, mesh);
        }
        self.lights.iter().for_each(|light| writer.light(light));
        writer.finish().ok_or_else(|| {
            FormatError::invalid(path, "size", "over 4 GiB", "less: split the scene, or make its textures smaller")
        })
    }

    /// Reads a file written by [`Self::to_bytes`]; lights excepted. `path` is for messages. Never panics.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self> {
        crate::baked_scene_read::read(Reader::new(path, bytes)?)
    }
}

/// Accessors that the mesh objects of a geometry share.
struct Shared {
    attributes: gltf::Attributes,
    /// Index accessor and material of each primitive.
    primitives: Vec<(u32, u32)>,
}

struct Writer<'a> {
    scene: &'a BakedScene,
    builder: Builder,
    /// File index of (material, page).
    materials: BTreeMap<(u32, Option<u32>), u32>,
}

impl Writer<'_> {
    /// Scene textures first, so that material indices hold; then an EXR and a preview texture for each page.
    fn textures(&mut self) {
        let mut images: BTreeMap<&[u8], u32> = BTreeMap::new();
        for texture in &self.scene.textures {
            let source = *images.entry(&texture.png).or_insert_with(|| self.builder.png(None, &texture.png));
            let samplers = &mut self.builder.document.samplers;
            let sampler = samplers.iter().position(|s| *s == texture.sampler).unwrap_or_else(|| {
                samplers.push(texture.sampler.clone());
                samplers.len() - 1
            });
            self.builder.document.textures.push(gltf::Texture { source, sampler: Some(sampler as u32) });
        }
        for page in &self.scene.pages {
            let uri = Some(page.uri.clone());
            self.builder.document.images.push(gltf::Image { uri, ..Default::default() });
            let exr = self.builder.document.images.len() as u32 - 1;
            let preview = self.builder.png(Some(format!("{} preview", page.uri)), &page.preview);
            for source in [exr, preview] {
                self.builder.document.textures.push(gltf::Texture { source, sampler: None });
            }
        }
    }

    fn geometry(&mut self, geometry: &Geometry) -> Shared {
        let builder = &mut self.builder;
        let pair = |values: &[Vec2], builder: &mut Builder| builder.floats(values.iter().map(|v| v.to_array()), false);
        let attributes = gltf::Attributes {
            position: builder.floats(geometry.positions.iter().map(|v| v.to_array()), true),
            normal: builder.floats(geometry.normals.iter().map(|v| v.to_array()), false),
            texcoord_0: pair(&geometry.texcoord_0, builder),
            texcoord_1: None,
            texcoord_2: geometry.texcoords_material.first().map(|values| pair(values, builder)),
            texcoord_3: geometry.texcoords_material.get(1).map(|values| pair(values, builder)),
            color_0: geometry.colors.as_ref().map(|v| builder.floats(v.iter().map(|c| c.to_array()), false)),
        };
        let primitives = geometry
            .primitives
            .iter()
            .map(|primitive| (builder.indices(primitive.triangles.iter().flatten().copied()), primitive.material))
            .collect();
        Shared { attributes, primitives }
    }

    fn mesh(&mut self, node: &Node, shared: &Shared, lightmap: Option<&Lightmap>) -> u32 {
        let mut attributes = shared.attributes.clone();
        match lightmap {
            Some(lightmap) => {
                attributes.texcoord_1 = Some(self.builder.floats(lightmap.uv.iter().map(|v| v.to_array()), false));
            }
            // Coordinate sets must be numbered without gaps.
            None => attributes.texcoord_1 = attributes.texcoord_2,
        }
        let primitives = shared
            .primitives
            .iter()
            .map(|&(indices, material)| gltf::Primitive {
                attributes: attributes.clone(),
                indices,
                material: self.material(material, lightmap.map(|lightmap| lightmap.page)),
            })
            .collect();
        let name = self.scene.geometries[node.geometry as usize].name.clone();
        self.builder.document.meshes.push(gltf::Mesh { name, primitives });
        self.builder.document.meshes.len() as u32 - 1
    }

    fn material(&mut self, material: u32, page: Option<u32>) -> u32 {
        if let Some(&index) = self.materials.get(&(material, page)) {
            return index;
        }
        let mut copy = self.scene.materials[material as usize].clone();
        for info in textures_of(&mut copy).filter(|info| info.tex_coord > 0) {
            info.tex_coord += 1;
        }
        copy.extensions.lightmap = page.map(|page| {
            let index = (self.scene.textures.len() + 2 * page as usize) as u32;
            let preview_white = self.scene.pages[page as usize].preview_white;
            let extras = Some(gltf::LightmapExtras { preview: index + 1, preview_white });
            gltf::Lightmap { index, tex_coord: 1, intensity: 1.0, extras }
        });
        self.builder.document.materials.push(copy);
        let index = self.builder.document.materials.len() as u32 - 1;
        self.materials.insert((material, page), index);
        index
    }

    fn node(&mut self, node: &Node, mesh: u32) {
        let matrix = Mat4::from(node.world_from_object);
        let mut record = json!({ "node": node.source_node, "geometry": node.geometry });
        if let Some(lightmap) = &node.lightmap {
            record["page"] = lightmap.page.into();
        }
        self.builder.document.nodes.push(gltf::Node {
            name: node.path.clone(),
            mesh: Some(mesh),
            matrix: (matrix != Mat4::IDENTITY).then(|| matrix.to_cols_array()),
            extras: Some(json!({ "bake": record })),
            ..Default::default()
        });
    }

    /// KHR_lights_punctual; what it cannot say (radius, profile) stands in `extras.bake`.
    fn light(&mut self, light: &LightRecord) {
        let intensity = light.color.max_element();
        let color = if intensity > 0.0 { light.color / intensity } else { Vec3::ONE };
        let (kind, position, direction, range, spot) = match &light.kind {
            LightKind::Point { position, range, .. } => ("point", *position, Vec3::NEG_Z, *range, None),
            LightKind::Spot { position, direction, inner_angle, outer_angle, range, .. } => {
                let spot = gltf::Spot { inner_cone_angle: *inner_angle, outer_cone_angle: *outer_angle };
                ("spot", *position, *direction, *range, Some(spot))
            }
            LightKind::Directional { direction, .. } => ("directional", Vec3::ZERO, *direction, None, None),
        };
        let lights = self.builder.document.extensions.lights.get_or_insert_default();
        let (kind, color) = (kind.to_owned(), color.to_array());
        lights.lights.push(gltf::Light { name: light.path.clone(), kind, color, intensity, range, spot });
        let index = lights.lights.len() as u32 - 1;
        self.builder.document.nodes.push(gltf::Node {
            name: light.path.clone(),
            translation: Some(position.to_array()),
            rotation: Some(Quat::from_rotation_arc(Vec3::NEG_Z, direction).to_array()),
            extensions: Some(gltf::NodeExtensions { light: gltf::LightIndex { light: index } }),
            extras: Some(json!({ "bake": light.kind })),
            ..Default::default()
        });
    }

    fn finish(mut self) -> Option<Vec<u8>> {
        let document = &mut self.builder.document;
        let nodes = (0..document.nodes.len() as u32).collect();
        document.scenes = vec![gltf::Scene { name: self.scene.name.clone(), nodes }];
        let mut names: Vec<&str> = document.materials.iter().flat_map(|m| m.extensions.names()).collect();
        if document.materials.iter_mut().any(|m| textures_of(m).any(|info| info.extensions.is_some())) {
            names.push("KHR_texture_transform");
        }
        if document.extensions.lights.is_some() {
            names.push("KHR_lights_punctual");
        }
        names.sort_unstable();
        names.dedup();
        document.extensions_used = names.into_iter().map(str::to_owned).collect();
        self.builder.finish()
    }
}

/// All uses of textures by a material, the lightmap's excepted.
pub(crate) fn textures_of(material: &mut gltf::Material) -> impl Iterator<Item = &mut gltf::TextureInfo> {
    let gltf::Material { pbr_metallic_roughness: pbr, emissive_texture, extensions, .. } = material;
    let diffuse = extensions.diffuse_transmission.as_mut();
    let (diffuse, diffuse_color) = diffuse.map_or((None, None), |d| {
        (d.diffuse_transmission_texture.as_mut(), d.diffuse_transmission_color_texture.as_mut())
    });
    let transmission = extensions.transmission.as_mut().and_then(|t| t.transmission_texture.as_mut());
    [pbr.base_color_texture.as_mut(), emissive_texture.as_mut(), transmission, diffuse, diffuse_color]
        .into_iter()
        .flatten()
}
