//! Writes binary glTF: materials, meshes, punctual lights, cameras and nodes, in the order they are added.
//!
//! Bytes depend on the input alone: JSON keys are sorted, numbers are rounded (positions to
//! [`GRID_M`](super::GRID_M), texture coordinates to [`GRID_UV`](super::GRID_UV)), so that neither hash order nor the last bit of a platform's sine shows.

use super::arrays::{Arrays, round};
use super::lightmap;
use super::material::{Material, MaterialId, TextureId};
use super::node::{Content, Light, LightId, MeshId, Place};
use super::patch::Patch;
use super::png::Pixels;
use glam::{DQuat, DVec3};
use serde_json::{Map, Value, json};

/// A node of a [`Glb`].
#[derive(Debug, Clone, Copy)]
pub struct NodeId(u32);

/// A binary glTF file under construction.
#[derive(Debug, Default)]
pub struct Glb {
    json: Map<String, Value>,
    binary: Vec<u8>,
    roots: Vec<u32>,
}

impl Glb {
    /// An empty file.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a material.
    pub fn material(&mut self, name: &str, material: Material) -> MaterialId {
        let (value, extensions) = material.json(name);
        extensions.into_iter().for_each(|extension| self.use_extension(extension));
        MaterialId(self.push("materials", value))
    }

    /// Adds a texture that repeats and shows each texel as a square.
    pub fn texture(&mut self, name: &str, pixels: &Pixels) -> TextureId {
        let view = self.view(&pixels.png(), None);
        let image = self.push("images", json!({ "name": name, "bufferView": view, "mimeType": "image/png" }));
        let nearest = 9728;
        let sampler = self.push("samplers", json!({ "magFilter": nearest, "minFilter": nearest }));
        TextureId(self.push("textures", json!({ "name": name, "sampler": sampler, "source": image })))
    }

    /// Adds a mesh without lightmap coordinates.
    pub fn mesh(&mut self, name: &str, patches: &[Patch]) -> MeshId {
        self.add_mesh(name, patches, None)
    }

    /// Adds a mesh with lightmap coordinates: each patch a chart, as TEXCOORD_1.
    pub fn lightmapped_mesh(&mut self, name: &str, patches: &[Patch]) -> MeshId {
        self.add_mesh(name, patches, Some(&lightmap::layout(patches)))
    }

    /// Adds a punctual light; the direction of a spot or directional light is its node's −Z.
    pub fn light(&mut self, name: &str, light: Light) -> LightId {
        let (kind, color) = match light {
            Light::Point(color) => ("point", color),
            Light::Spot { intensity, .. } => ("spot", intensity),
            Light::Directional(color) => ("directional", color),
        };
        let strength = color.into_iter().fold(0.0, f64::max);
        let mut value =
            json!({ "name": name, "type": kind, "intensity": strength, "color": color.map(|c| c / strength) });
        if let Light::Spot { inner, outer, .. } = light {
            value["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        }
        let extension = "KHR_lights_punctual";
        self.use_extension(extension);
        let extensions = self.json.entry("extensions").or_insert_with(|| json!({ extension: { "lights": [] } }));
        let lights = extensions[extension]["lights"].as_array_mut().expect("made above");
        lights.push(value);
        LightId(lights.len() as u32 - 1)
    }

    /// Adds a node to the scene's root, or below a parent.
    pub fn node(&mut self, parent: Option<NodeId>, name: &str, place: Place, content: Content) -> NodeId {
        let mut value = json!({ "name": name });
        if place.translation != DVec3::ZERO {
            value["translation"] = json!(place.translation.to_array());
        }
        if place.rotation != DQuat::IDENTITY {
            value["rotation"] = json!(place.rotation.to_array().map(|q| round(q, 1e-9)));
        }
        if place.scale != DVec3::ONE {
            value["scale"] = json!(place.scale.to_array());
        }
        match content {
            Content::Group => {}
            Content::Mesh(mesh) => value["mesh"] = json!(mesh.0),
            Content::Light(light) => value["extensions"] = json!({ "KHR_lights_punctual": { "light": light.0 } }),
            Content::Camera(degrees) => {
                let lens = json!({ "yfov": round(degrees.to_radians(), 1e-6), "znear": 0.05 });
                value["camera"] = json!(self.push("cameras", json!({ "type": "perspective", "perspective": lens })));
            }
        }
        let index = self.push("nodes", value);
        match parent {
            None => self.roots.push(index),
            Some(NodeId(parent)) => append(&mut self.json["nodes"][parent as usize]["children"], json!(index)),
        }
        NodeId(index)
    }

    /// The finished file.
    pub fn finish(mut self) -> Vec<u8> {
        self.json.insert("asset".into(), json!({ "version": "2.0", "generator": "scenes" }));
        self.json.insert("scene".into(), json!(0));
        self.json.insert("scenes".into(), json!([{ "nodes": self.roots }]));
        self.json.insert("buffers".into(), json!([{ "byteLength": self.binary.len() }]));
        let mut value = Value::Object(self.json);
        value.sort_all_objects();
        let mut text = value.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() + 8 + self.binary.len();
        let mut file = Vec::with_capacity(total);
        let words = |file: &mut Vec<u8>, words: [&[u8]; 2]| words.iter().for_each(|word| file.extend_from_slice(word));
        words(&mut file, [b"glTF", &2u32.to_le_bytes()]);
        file.extend_from_slice(&(total as u32).to_le_bytes());
        words(&mut file, [&(text.len() as u32).to_le_bytes(), b"JSON"]);
        file.extend_from_slice(&text);
        words(&mut file, [&(self.binary.len() as u32).to_le_bytes(), b"BIN\0"]);
        file.extend_from_slice(&self.binary);
        file
    }

    fn add_mesh(&mut self, name: &str, patches: &[Patch], layout: Option<&lightmap::Layout>) -> MeshId {
        let mut materials: Vec<MaterialId> = Vec::new();
        for (_, material) in patches.iter().flat_map(|patch| &patch.triangles) {
            if !materials.contains(material) {
                materials.push(*material);
            }
        }
        let primitives: Vec<Value> =
            materials.iter().map(|&material| self.primitive(patches, layout, material)).collect();
        MeshId(self.push("meshes", json!({ "name": name, "primitives": primitives })))
    }

    /// The triangles of one material, with the vertices they use.
    fn primitive(&mut self, patches: &[Patch], layout: Option<&lightmap::Layout>, material: MaterialId) -> Value {
        let mut arrays = Arrays::default();
        for (index, patch) in patches.iter().enumerate() {
            arrays.append(patch, material, layout.map(|layout| (layout.scale, layout.offsets[index])));
        }
        let mut attributes = json!({
            "POSITION": self.accessor(&arrays.positions, "VEC3", true),
            "NORMAL": self.accessor(&arrays.normals, "VEC3", false),
        });
        if layout.is_some() {
            attributes["TEXCOORD_0"] = json!(self.accessor(&arrays.texcoords[0], "VEC2", false));
            attributes["TEXCOORD_1"] = json!(self.accessor(&arrays.texcoords[1], "VEC2", false));
        }
        json!({ "attributes": attributes, "indices": self.indices(&arrays.indices), "material": material.0 })
    }

    fn accessor<const N: usize>(&mut self, values: &[[f32; N]], kind: &str, bounds: bool) -> u32
    where
        [f32; N]: bytemuck::Pod,
    {
        let view = self.view(bytemuck::cast_slice(values), Some(34962));
        let mut value = json!({ "bufferView": view, "componentType": 5126, "count": values.len(), "type": kind });
        if bounds {
            let fold = |f: fn(f32, f32) -> f32| {
                values.iter().copied().reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).expect("not empty")
            };
            value["min"] = json!(fold(f32::min).as_slice());
            value["max"] = json!(fold(f32::max).as_slice());
        }
        self.push("accessors", value)
    }

    fn indices(&mut self, indices: &[u16]) -> u32 {
        let view = self.view(bytemuck::cast_slice(indices), Some(34963));
        let count = indices.len();
        self.push("accessors", json!({ "bufferView": view, "componentType": 5123, "count": count, "type": "SCALAR" }))
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> u32 {
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.push("bufferViews", view)
    }

    fn push(&mut self, list: &str, value: Value) -> u32 {
        let list = self.json.entry(list).or_insert_with(|| json!([]));
        append(list, value);
        list.as_array().map_or(0, Vec::len) as u32 - 1
    }

    fn use_extension(&mut self, name: &str) {
        let used = self.json.entry("extensionsUsed").or_insert_with(|| json!([]));
        if !used.as_array().is_some_and(|used| used.iter().any(|extension| extension == name)) {
            append(used, json!(name));
        }
    }
}

/// Appends to a JSON array, which null becomes.
fn append(list: &mut Value, value: Value) {
    match list {
        Value::Array(list) => list.push(value),
        _ => *list = json!([value]),
    }
}
