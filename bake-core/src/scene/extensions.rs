//! Which versions and extensions are understood: required strangers are refused, optional ones that could change the
//! bake are warned about.

use super::document::Document;
use super::error::{Fault, Place, Refusal};
use super::files::shorten;
use super::warning::{WarningKind, Warnings};

/// Extensions that the loader understands.
const UNDERSTOOD: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Optional extensions that change nothing a Lambertian bake sees.
const HARMLESS: &[&str] = &[
    "KHR_animation_pointer",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_variants",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_xmp_json_ld",
    "MOZ_lightmap",
];

/// Checks the document's version and extension lists.
pub(super) fn check(document: &Document, warnings: &mut Warnings) -> Result<(), Refusal> {
    let asset = Place::root("asset");
    let Some(record) = &document.asset else {
        return Err(Fault::value("absent", "an object with `version`").at(&asset));
    };
    if major(&record.version) != Some(2) {
        return Err(Fault::value(format!("`{}`", shorten(&record.version)), "2.0").at(&asset.field("version")));
    }
    if let Some(least) = record.min_version.as_deref().filter(|least| *least != "2.0") {
        return Err(Fault::value(format!("`{}`", shorten(least)), "2.0").at(&asset.field("minVersion")));
    }
    for (i, name) in document.extensions_required.iter().enumerate() {
        if !UNDERSTOOD.contains(&name.as_str()) {
            let fault = Fault::RequiredExtension { name: shorten(name) };
            return Err(fault.at(&Place::entry("extensionsRequired", i)));
        }
    }
    for (i, name) in document.extensions_used.iter().enumerate() {
        if !UNDERSTOOD.contains(&name.as_str()) && !HARMLESS.contains(&name.as_str()) {
            let message = format!("the optional extension {} is not known and ignored", shorten(name));
            warnings.push(WarningKind::IgnoredExtension, &Place::entry("extensionsUsed", i), message);
        }
    }
    Ok(())
}

/// The number before the dot; later minor versions stay readable.
fn major(version: &str) -> Option<u32> {
    version.split_once('.').map(|(major, _)| major)?.parse().ok()
}
