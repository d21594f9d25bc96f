//! The baked scene: geometry as the atlas has it, one node an instance.

use super::material::Translator;
use super::{Bake, images};
use crate::atlas::{Layout, Placement};
use crate::scene::{Instance, Material, Mesh};
use bake_formats::baked_scene::{BakedScene, Geometry, Lightmap, Node, PageImage, Primitive};
use bake_formats::manifest::{InstanceRecord, LightRecord, PageRecord};
use glam::Vec4;
use std::collections::{BTreeMap, BTreeSet};

/// The baked scene and the manifest's records of its lightmapped instances.
pub(super) fn scene(bake: Bake, pages: &[PageRecord], lights: Vec<LightRecord>) -> (BakedScene, Vec<InstanceRecord>) {
    let sets = material_sets(&bake.scene.materials);
    let mut translator = Translator::new(bake.scene, &sets);
    let materials = bake.scene.materials.iter().map(|material| translator.material(material)).collect();
    let pages = pages.iter().zip(bake.pages).map(|(record, buffers)| {
        let (preview, preview_white) = images::preview(buffers);
        PageImage { uri: record.lightmap.clone(), preview, preview_white }
    });
    let mut baked = BakedScene {
        name: bake.scene.name.clone(),
        materials,
        textures: translator.textures,
        pages: pages.collect(),
        lights,
        ..Default::default()
    };
    let mut records = Vec::new();
    let mut geometries = BTreeMap::new();
    for (index, instance) in bake.scene.instances.iter().enumerate() {
        let placement = bake.atlas.placements.get(index).copied().flatten();
        let layout = placement.map(|placement| &bake.atlas.layouts[placement.layout as usize]);
        let key = (instance.mesh, placement.map(|placement| placement.layout));
        let geometry = *geometries.entry(key).or_insert_with(|| {
            let mesh = &bake.scene.meshes[instance.mesh as usize];
            baked.geometries.push(geometry(mesh, layout, &sets));
            baked.geometries.len() as u32 - 1
        });
        if let Some(placement) = placement {
            let mesh = &bake.scene.meshes[instance.mesh as usize];
            records.push(record(baked.nodes.len() as u32, instance, mesh, placement));
        }
        baked.nodes.push(Node {
            path: instance.path.clone(),
            source_node: instance.node,
            world_from_object: instance.world_from_object,
            geometry,
            lightmap: placement.zip(layout).map(|(placement, layout)| lightmap(placement, layout)),
        });
    }
    (baked, records)
}

fn record(baked_node: u32, instance: &Instance, mesh: &Mesh, placement: Placement) -> InstanceRecord {
    InstanceRecord {
        baked_node,
        node: instance.node,
        path: instance.path.clone(),
        name: mesh.name.clone(),
        page: placement.page,
        uv_offset: placement.offset,
        uv_scale: placement.scale,
    }
}

fn lightmap(placement: Placement, layout: &Layout) -> Lightmap {
    let uv = layout.uv.iter().map(|&uv| placement.offset + placement.scale * uv).collect();
    Lightmap { page: placement.page, uv }
}

/// The mesh with its vertices as the layout splits them, or as they are.
fn geometry(mesh: &Mesh, layout: Option<&Layout>, sets: &[u8]) -> Geometry {
    let sources = match layout {
        Some(layout) => layout.source_vertex.clone(),
        None => (0..mesh.positions.len() as u32).collect(),
    };
    let triangles = layout.map_or(&mesh.triangles, |layout| &layout.triangles);
    let primitives = mesh.primitives.iter().map(|primitive| Primitive {
        triangles: triangles[primitive.triangles.start as usize..primitive.triangles.end as usize].to_vec(),
        material: primitive.material,
    });
    let colored = mesh.colors.iter().any(|&color| color != Vec4::ONE);
    Geometry {
        name: mesh.name.clone(),
        positions: gather(&mesh.positions, &sources),
        normals: gather(&mesh.normals, &sources),
        texcoord_0: gather(&mesh.texcoords[0], &sources),
        texcoords_material: sets.iter().map(|&set| gather(&mesh.texcoords[usize::from(set)], &sources)).collect(),
        colors: colored.then(|| gather(&mesh.colors, &sources)),
        primitives: primitives.filter(|primitive| !primitive.triangles.is_empty()).collect(),
    }
}

fn gather<T: Copy>(values: &[T], sources: &[u32]) -> Vec<T> {
    sources.iter().map(|&source| values[source as usize]).collect()
}

/// Coordinate sets beyond the first that textures of the materials use, ascending.
fn material_sets(materials: &[Material]) -> Vec<u8> {
    let textures = materials.iter().flat_map(|material| {
        [
            &material.base_color_texture,
            &material.emission_texture,
            &material.transmission_texture,
            &material.diffuse_transmission_texture,
            &material.diffuse_transmission_color_texture,
        ]
    });
    let sets: BTreeSet<u8> = textures.flatten().map(|texture| texture.texcoord).filter(|&set| set > 0).collect();
    sets.into_iter().collect()
}
