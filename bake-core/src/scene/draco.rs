//! KHR_draco_mesh_compression: decodes one primitive's attributes and indices.

use super::accessor::{Accessors, Component, View};
use super::buffers::Buffers;
use super::document::{DracoRecord, PrimitiveRecord};
use super::error::{Fault, Place, Refusal};
use super::files::Allowance;
use draco_gltf::{ComponentType, DracoPrimitiveContract, DracoPrimitiveExtension, JsonValue, PackedGeometry};

/// Decodes the geometry of a compressed primitive. The caller has looked the buffer view up.
pub(super) fn decode(
    record: &PrimitiveRecord,
    draco: &DracoRecord,
    accessors: &Accessors,
    buffers: &Buffers,
    allowance: &Allowance,
    primitive: &Place,
) -> Result<PackedGeometry, Refusal> {
    let place = primitive.field("extensions.KHR_draco_mesh_compression");
    let refuse = |reason: String| Fault::Decode { format: "Draco", reason }.at(&place);
    let contract = contract(record, accessors, allowance, primitive)?;
    let extension = extension(draco).map_err(|e| refuse(e.to_string()))?;
    let geometry = extension.decode(buffers.view(draco.buffer_view), &contract).map_err(|e| refuse(e.to_string()))?;
    let attributes: usize = geometry.attributes().iter().map(|a| a.bytes().len()).sum();
    let indices = geometry.indices().map_or(0, |indices| indices.bytes().len());
    allowance.take((attributes + indices) as u64, 1).map_err(|fault| fault.at(&place))?;
    Ok(geometry)
}

fn extension(draco: &DracoRecord) -> draco_gltf::Result<DracoPrimitiveExtension> {
    let json = serde_json::json!({ "bufferView": draco.buffer_view, "attributes": draco.attributes });
    DracoPrimitiveExtension::from_json(&JsonValue::parse(json.to_string().as_bytes()).map_err(draco_gltf::Error::Json)?)
}

/// What the document's accessors say about the stream, and how much it may decode to.
fn contract(
    record: &PrimitiveRecord,
    accessors: &Accessors,
    allowance: &Allowance,
    place: &Place,
) -> Result<DracoPrimitiveContract, Refusal> {
    // Twelve bytes are a position or a triangle.
    let elements = allowance.left() / 12;
    let mut limits = draco_gltf::DecodeLimits::default();
    (limits.max_points, limits.max_faces, limits.max_decoded_bytes) = (elements, elements, allowance.left());
    let mut contract = DracoPrimitiveContract::new().with_limits(limits);
    for (name, &index) in &record.attributes {
        let (count, normalized) = accessors.declared(index, &place.field("attributes").field(name))?;
        contract = contract.with_attribute(name.as_str(), count, normalized);
    }
    if let Some(index) = record.indices {
        contract = contract.with_indices(accessors.declared(index, &place.field("indices"))?.0);
    }
    Ok(contract)
}

/// One decoded attribute.
pub(super) fn attribute<'a>(geometry: &'a PackedGeometry, name: &str) -> Option<View<'a>> {
    let attribute = geometry.attributes().iter().find(|a| a.semantic() == name)?;
    let component = component(attribute.component_type())?;
    let width = usize::from(attribute.components());
    Some(View::packed(attribute.bytes(), attribute.count(), width, component, attribute.normalized()))
}

/// The decoded indices.
pub(super) fn indices(geometry: &PackedGeometry) -> Option<View<'_>> {
    let indices = geometry.indices()?;
    Some(View::packed(indices.bytes(), indices.count(), 1, component(indices.component_type())?, false))
}

fn component(kind: ComponentType) -> Option<Component> {
    Some(match kind {
        ComponentType::I8 => Component::I8,
        ComponentType::U8 => Component::U8,
        ComponentType::I16 => Component::I16,
        ComponentType::U16 => Component::U16,
        ComponentType::U32 => Component::U32,
        ComponentType::F32 => Component::F32,
        _ => return None,
    })
}
