//! Every index in the document points at something, used by the chosen scene or not.

use super::document::{Document, MaterialRecord, MeshRecord, Node, TextureInfo};
use super::error::{Place, Refusal, lookup};

/// Checks all indices but those that buffers, accessors and the node tree check themselves.
pub(super) fn check(document: &Document) -> Result<(), Refusal> {
    for (i, image) in document.images.iter().enumerate() {
        find(&document.buffer_views, "bufferViews", image.buffer_view, &Place::entry("images", i).field("bufferView"))?;
    }
    for (i, texture) in document.textures.iter().enumerate() {
        let at = Place::entry("textures", i);
        find(&document.samplers, "samplers", texture.sampler, &at.field("sampler"))?;
        find(&document.images, "images", texture.source, &at.field("source"))?;
        let webp = texture.extensions.webp.as_ref().map(|webp| webp.source);
        find(&document.images, "images", webp, &at.field("extensions.EXT_texture_webp.source"))?;
    }
    for (i, material) in document.materials.iter().enumerate() {
        check_material(document, material, &Place::entry("materials", i))?;
    }
    for (i, mesh) in document.meshes.iter().enumerate() {
        check_mesh(document, mesh, &Place::entry("meshes", i))?;
    }
    for (i, node) in document.nodes.iter().enumerate() {
        check_node(document, node, &Place::entry("nodes", i))?;
    }
    find(&document.scenes, "scenes", document.scene, &Place::root("scene"))
}

fn find<T>(list: &[T], name: &'static str, index: Option<u32>, place: &Place) -> Result<(), Refusal> {
    index.map_or(Ok(()), |index| lookup(list, name, index, place).map(|_| ()))
}

fn check_material(document: &Document, material: &MaterialRecord, at: &Place) -> Result<(), Refusal> {
    let pbr = &material.pbr_metallic_roughness;
    let transmission = material.extensions.transmission.as_ref();
    let diffuse = material.extensions.diffuse_transmission.as_ref();
    let textures: [(&Option<TextureInfo>, &str); 5] = [
        (&pbr.base_color_texture, "pbrMetallicRoughness.baseColorTexture.index"),
        (&material.emissive_texture, "emissiveTexture.index"),
        (
            transmission.map_or(&None, |t| &t.transmission_texture),
            "extensions.KHR_materials_transmission.transmissionTexture.index",
        ),
        (
            diffuse.map_or(&None, |d| &d.diffuse_transmission_texture),
            "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionTexture.index",
        ),
        (
            diffuse.map_or(&None, |d| &d.diffuse_transmission_color_texture),
            "extensions.KHR_materials_diffuse_transmission.diffuseTransmissionColorTexture.index",
        ),
    ];
    for (info, field) in textures {
        find(&document.textures, "textures", info.as_ref().map(|info| info.index), &at.field(field))?;
    }
    Ok(())
}

fn check_mesh(document: &Document, mesh: &MeshRecord, at: &Place) -> Result<(), Refusal> {
    for (i, primitive) in mesh.primitives.iter().enumerate() {
        let at = at.item("primitives", i);
        let attributes = at.field("attributes");
        for (name, &index) in &primitive.attributes {
            lookup(&document.accessors, "accessors", index, &attributes.field(name))?;
        }
        find(&document.accessors, "accessors", primitive.indices, &at.field("indices"))?;
        find(&document.materials, "materials", primitive.material, &at.field("material"))?;
    }
    Ok(())
}

fn check_node(document: &Document, node: &Node, at: &Place) -> Result<(), Refusal> {
    find(&document.meshes, "meshes", node.mesh, &at.field("mesh"))?;
    let lights = document.extensions.lights.as_ref().map(|list| list.lights.as_slice()).unwrap_or_default();
    let light = node.extensions.light.as_ref().map(|light| light.light);
    let field = at.field("extensions.KHR_lights_punctual.light");
    find(lights, "extensions.KHR_lights_punctual.lights", light, &field)
}
