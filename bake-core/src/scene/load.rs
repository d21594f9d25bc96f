//! Drives the loading of one scene file; the order of the checks is the order of this file.

use super::accessor::Accessors;
use super::buffers::Buffers;
use super::document::{Document, SceneRecord};
use super::error::{Fault, LoadError, Place, Refusal, lookup};
use super::files::{self, Files};
use super::image::Images;
use super::material::Materials;
use super::nodes::{self, Placed};
use super::options::LoadOptions;
use super::primitive::Source;
use super::warning::{Warning, WarningKind, Warnings};
use super::{
    Instance, Material, MediaExtras, Mesh, Scene, container, environment, extensions, light, mesh, references,
};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Farthest that anything may lie from the origin, metres: squares of distances must stay finite in f32.
const MAX_DISTANCE: f64 = 1e12;

/// Loads a .gltf or .glb file with everything that it and `options` refer to.
///
/// # Errors
/// Everything invalid is refused here, with file, place, value and next step; what can be passed over is a warning.
pub fn load(path: &Path, options: &LoadOptions) -> Result<(Scene, Vec<Warning>), LoadError> {
    let bytes = files::read(path).map_err(|fault| fault.in_file(path).into_error(path))?;
    load_from_bytes(&bytes, path, options)
}

/// Loads a scene whose file has been read already; `path` says where relative URIs start, and is named in errors.
///
/// # Errors
/// As [`load`].
pub fn load_from_bytes(bytes: &[u8], path: &Path, options: &LoadOptions) -> Result<(Scene, Vec<Warning>), LoadError> {
    let mut warnings = Warnings::default();
    match build(bytes, path, options, &mut warnings) {
        Ok(scene) => Ok((scene, warnings.into_vec())),
        Err(refusal) => Err(refusal.into_error(path)),
    }
}

fn build(bytes: &[u8], path: &Path, options: &LoadOptions, warnings: &mut Warnings) -> Result<Scene, Refusal> {
    check_options(options)?;
    let whole = |fault: Fault| fault.in_file(path);
    let parts = container::split(bytes).map_err(whole)?;
    let document = parse(&bytes[parts.json]).map_err(|(object, fault)| whole(fault).object(object))?;
    extensions::check(&document, warnings)?;
    let files = Files::new(path, bytes);
    let buffers = Buffers::new(&document, parts.bin.map(|range| &bytes[range]), &files)?;
    let accessors = Accessors::new(&document, &buffers)?;
    references::check(&document)?;
    nodes::check_tree(&document)?;
    let scene_index = nodes::choose(&document, options.scene.as_ref())?;
    let placed = nodes::flatten(&document, scene_index, &files.geometry)?;
    let source = Source { document: &document, accessors: &accessors, buffers: &buffers, files: &files };
    let media_extras = media_extras(&document.scenes[scene_index], path);
    let mut scene = Scene { name: stem(path), media_extras, ..Scene::default() };
    let slots = load_meshes(&source, &placed, &mut scene, warnings)?;
    place_instances(&source, &placed, &slots, options, &mut scene, warnings)?;
    if scene.instances.is_empty() {
        let name = document.scenes[scene_index].name.clone().unwrap_or_else(|| scene_index.to_string());
        return Err(whole(Fault::NoTriangles { scene: name }));
    }
    load_materials(&source, options, &mut scene, warnings)?;
    scene.lights = light::load(&document, &placed, options, warnings)?;
    scene.environment = environment::load(options, warnings)?;
    scene.blake3 = files.hash();
    if options.require_light && !shines(&scene) {
        return Err(whole(Fault::NoLight));
    }
    Ok(scene)
}

fn check_options(options: &LoadOptions) -> Result<(), Refusal> {
    let positive = |name: &'static str, value: f32| match value.is_finite() && value > 0.0 {
        true => Ok(()),
        false => Err(Fault::value(value, "above 0").at(&Place::root(name))),
    };
    positive("min_light_radius", options.min_light_radius)?;
    positive("light_scale", options.light_scale)
}

/// Parses the JSON part; a fault comes with its JSON path.
fn parse(json: &[u8]) -> Result<Document, (String, Fault)> {
    let mut parser = serde_json::Deserializer::from_slice(json);
    let document: Document = serde_path_to_error::deserialize(&mut parser).map_err(|error| {
        let path = error.path().to_string();
        (if path == "." { String::new() } else { path }, Fault::Json(error.into_inner().to_string()))
    })?;
    parser.end().map_err(|error| (String::new(), Fault::Json(error.to_string())))?;
    Ok(document)
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}

/// What the scene says about the air. Editors whose custom properties hold only text write the record as a string.
fn media_extras(record: &SceneRecord, path: &Path) -> Option<MediaExtras> {
    let json = match record.extras.as_ref()?.get("bake_media")? {
        Value::String(json) => json.clone(),
        record => record.to_string(),
    };
    Some(MediaExtras { json, folder: path.parent().map(Path::to_owned).unwrap_or_default() })
}

/// Loads the meshes that nodes place; returns where each mesh of the document went.
fn load_meshes(
    source: &Source,
    placed: &[Placed],
    scene: &mut Scene,
    warnings: &mut Warnings,
) -> Result<BTreeMap<u32, Option<u32>>, Refusal> {
    let mut slots = BTreeMap::new();
    for node in placed {
        let Some(index) = node.node.mesh else { continue };
        let at = Place::entry("nodes", node.index as usize);
        let record = lookup(&source.document.meshes, "meshes", index, &at.field("mesh"))?;
        if node.node.skin.is_some() {
            warnings.push(WarningKind::Deformation, &at, "skins are not applied: the mesh bakes in its bind pose");
        }
        if slots.contains_key(&index) {
            continue;
        }
        let mesh = mesh::load(source, index as usize, record, warnings)?;
        slots.insert(index, mesh.map(|mesh| push(&mut scene.meshes, mesh)));
    }
    Ok(slots)
}

fn push<T>(list: &mut Vec<T>, item: T) -> u32 {
    list.push(item);
    list.len() as u32 - 1
}

fn place_instances(
    source: &Source,
    placed: &[Placed],
    slots: &BTreeMap<u32, Option<u32>>,
    options: &LoadOptions,
    scene: &mut Scene,
    warnings: &mut Warnings,
) -> Result<(), Refusal> {
    let bounds: Vec<[DVec3; 8]> = scene.meshes.iter().map(corners).collect();
    for node in placed {
        let Some(mesh) = node.node.mesh.and_then(|mesh| slots[&mesh]) else { continue };
        let transforms = nodes::instance_transforms(node, source.accessors, &source.files.geometry)?;
        let instanced = transforms.is_some();
        let at = Place::entry("nodes", node.index as usize);
        for transform in transforms.unwrap_or_else(|| vec![DAffine3::IDENTITY]) {
            let world = node.world * transform;
            let Some(world_from_object) = invertible(world, &bounds[mesh as usize], &at)? else {
                let message = "the transform squeezes the mesh flat; it is left out";
                warnings.push(WarningKind::FlatInstance, &at, message);
                continue;
            };
            scene.instances.push(Instance {
                path: node.path.clone(),
                node: node.index,
                mesh,
                world_from_object,
                lightmapped: !instanced || options.bake_instanced,
            });
        }
    }
    Ok(())
}

/// The corners of a mesh's bounding box.
fn corners(mesh: &Mesh) -> [DVec3; 8] {
    let low = mesh.positions.iter().copied().fold(Vec3::INFINITY, Vec3::min).as_dvec3();
    let high = mesh.positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max).as_dvec3();
    std::array::from_fn(|i| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low))
}

/// The transform in f32; none when it, or its inverse, is not usable there.
fn invertible(world: DAffine3, corners: &[DVec3; 8], at: &Place) -> Result<Option<Affine3A>, Refusal> {
    for corner in corners {
        let point = world.transform_point3(*corner);
        if !point.is_finite() || point.abs().max_element() > MAX_DISTANCE {
            let value = format!("a mesh corner at {point} in the world");
            return Err(Fault::value(value, format!("within {MAX_DISTANCE:e} m of the origin")).at(at));
        }
    }
    let single = Affine3A::from_mat4(glam::DMat4::from(world).as_mat4());
    let usable = single.matrix3.determinant().is_normal() && single.is_finite() && single.inverse().is_finite();
    Ok(usable.then_some(single))
}

/// Converts the materials that triangles use; others keep only their name, so that indices stay those of the file.
fn load_materials(
    source: &Source,
    options: &LoadOptions,
    scene: &mut Scene,
    warnings: &mut Warnings,
) -> Result<(), Refusal> {
    let records = &source.document.materials;
    let mut used = vec![false; records.len() + 1];
    for primitive in scene.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        used[primitive.material as usize] = true;
    }
    let mut images = Images::new(source.document, source.buffers, source.files);
    let mut materials = Materials { document: source.document, images: &mut images, warnings, unlit: options.unlit };
    for (index, record) in records.iter().enumerate() {
        scene.materials.push(match used[index] {
            true => materials.convert(index, record)?,
            false => Material { name: record.name.clone().unwrap_or_default(), ..Material::default() },
        });
    }
    if used[records.len()] {
        scene.materials.push(Material::default());
    }
    scene.images = images.decoded;
    Ok(())
}

/// Whether anything in the scene gives light.
fn shines(scene: &Scene) -> bool {
    let emits = |material: u32| {
        let material = &scene.materials[material as usize];
        !material.unlit && material.emission.max_element() > 0.0
    };
    scene.lights.iter().any(|light| light.color.max_element() > 0.0)
        || scene.environment.iter().any(|e| e.radiance.iter().any(|texel| texel.max_element() > 0.0))
        || scene.instances.iter().any(|i| scene.meshes[i.mesh as usize].primitives.iter().any(|p| emits(p.material)))
}
