//! Reading of `NAME.baked.glb` back into a [`BakedScene`].

use crate::baked_scene::{BakedScene, Geometry, Lightmap, Node, PageImage, Primitive, Texture, textures_of};
use crate::error::Result;
use crate::glb::{Reader, document as gltf};
use glam::{Affine3A, Mat4, Vec2, Vec3, Vec4};
use std::collections::BTreeMap;

/// A shape is told apart by its position accessor and primitives.
type GeometryKey = (u32, Vec<(u32, u32)>);

/// Builds the scene from a checked container.
pub(crate) fn read(reader: Reader) -> Result<BakedScene> {
    let (textures, pages) = textures(&reader)?;
    let mut scene = BakedScene { textures, pages, ..Default::default() };
    scene.name = reader.document.scenes.first().map(|scene| scene.name.clone()).unwrap_or_default();
    let materials = materials(&reader, &mut scene)?;
    let mut geometries = BTreeMap::new();
    for (index, node) in reader.document.nodes.iter().enumerate() {
        let Some(mesh) = node.mesh else { continue };
        let read = read_node(&reader, index, node, mesh, &materials, &mut geometries, &mut scene.geometries)?;
        scene.nodes.push(read);
    }
    Ok(scene)
}

/// Textures of embedded images are the scene's; each page has an EXR texture followed by its preview.
fn textures(reader: &Reader) -> Result<(Vec<Texture>, Vec<PageImage>)> {
    let (mut textures, mut pages) = (Vec::new(), Vec::<PageImage>::new());
    let mut preview_follows = false;
    for (index, texture) in reader.document.textures.iter().enumerate() {
        let image = reader.document.images.get(texture.source as usize);
        let field = || format!("texture {index}: source");
        let image = image.ok_or_else(|| reader.invalid(field(), texture.source, "an image"))?;
        if let Some(uri) = &image.uri {
            pages.push(PageImage { uri: uri.clone(), ..Default::default() });
            preview_follows = true;
            continue;
        }
        let view = image.buffer_view.ok_or_else(|| reader.invalid(field(), "empty", "an embedded image"))?;
        let png = reader.view(view)?.to_vec();
        match pages.last_mut() {
            Some(page) if preview_follows => page.preview = png,
            Some(_) => return Err(reader.invalid(field(), texture.source, "an EXR page before each preview")),
            None => {
                let sampler = texture.sampler.and_then(|at| reader.document.samplers.get(at as usize));
                textures.push(Texture { png, sampler: sampler.cloned().unwrap_or_default() });
            }
        }
        preview_follows = false;
    }
    Ok((textures, pages))
}

/// Materials without their lightmaps, each once; returns (material, page) of every material of the file.
fn materials(reader: &Reader, scene: &mut BakedScene) -> Result<Vec<(u32, Option<u32>)>> {
    let mut found = Vec::new();
    for (index, material) in reader.document.materials.iter().enumerate() {
        let mut copy = material.clone();
        let lightmap = copy.extensions.lightmap.take();
        for info in textures_of(&mut copy) {
            if info.index as usize >= scene.textures.len() {
                return Err(reader.invalid(format!("material {index}: texture"), info.index, "a texture"));
            }
            // Set 1 is the lightmap's; the material's further ones begin behind it.
            info.tex_coord = info.tex_coord.min(3) - u32::from(info.tex_coord > 1);
        }
        let at = scene.materials.iter().position(|known| *known == copy).unwrap_or_else(|| {
            scene.materials.push(copy);
            scene.materials.len() - 1
        });
        let page = match &lightmap {
            None => None,
            Some(lightmap) => {
                let page = (lightmap.index as usize).checked_sub(scene.textures.len()).map(|offset| offset / 2);
                let page = page.filter(|&page| page < scene.pages.len());
                let page = page.ok_or_else(|| {
                    reader.invalid(format!("material {index}: MOZ_lightmap.index"), lightmap.index, "a page's texture")
                })?;
                scene.pages[page].preview_white = lightmap.extras.as_ref().map_or(0.0, |extras| extras.preview_white);
                Some(page as u32)
            }
        };
        found.push((at as u32, page));
    }
    Ok(found)
}

fn read_node(
    reader: &Reader,
    index: usize,
    node: &gltf::Node,
    mesh: u32,
    materials: &[(u32, Option<u32>)],
    known: &mut BTreeMap<GeometryKey, u32>,
    geometries: &mut Vec<Geometry>,
) -> Result<Node> {
    let field = |what: &str| format!("node {index} ({}): {what}", node.name);
    let mesh = reader.document.meshes.get(mesh as usize).filter(|mesh| !mesh.primitives.is_empty());
    let mesh = mesh.ok_or_else(|| reader.invalid(field("mesh"), "empty", "a mesh with primitives"))?;
    let material = |primitive: &gltf::Primitive| {
        let found = materials.get(primitive.material as usize).copied();
        found.ok_or_else(|| reader.invalid(field("material"), primitive.material, "a material"))
    };
    let first = &mesh.primitives[0];
    let page = material(first)?.1;
    let mut parts = Vec::new();
    for primitive in &mesh.primitives {
        let (own, its_page) = material(primitive)?;
        if its_page != page || primitive.attributes != first.attributes {
            return Err(reader.invalid(field("primitives"), "mixed", "the same attributes and page in all"));
        }
        parts.push((primitive.indices, own));
    }
    let key = (first.attributes.position, parts);
    let geometry = match known.get(&key) {
        Some(&geometry) => geometry,
        None => {
            geometries.push(read_geometry(reader, mesh, &key.1)?);
            known.insert(key, geometries.len() as u32 - 1);
            geometries.len() as u32 - 1
        }
    };
    let vertices = geometries[geometry as usize].positions.len();
    let lightmap = match (page, first.attributes.texcoord_1) {
        (Some(page), Some(accessor)) => Some(Lightmap { page, uv: array(reader, accessor, vertices)? }),
        (Some(_), None) => return Err(reader.invalid(field("TEXCOORD_1"), "absent", "page coordinates")),
        (None, _) => None,
    };
    let matrix = node.matrix.map_or(Mat4::IDENTITY, |columns| Mat4::from_cols_array(&columns));
    if !matrix.is_finite() {
        return Err(reader.invalid(field("matrix"), matrix, "finite numbers"));
    }
    let source = node.extras.as_ref().and_then(|extras| extras.pointer("/bake/node")).and_then(|v| v.as_u64());
    let source_node = source.and_then(|node| u32::try_from(node).ok()).unwrap_or(index as u32);
    let world_from_object = Affine3A::from_mat4(matrix);
    Ok(Node { path: node.name.clone(), source_node, world_from_object, geometry, lightmap })
}

fn read_geometry(reader: &Reader, mesh: &gltf::Mesh, parts: &[(u32, u32)]) -> Result<Geometry> {
    let attributes = &mesh.primitives[0].attributes;
    let positions: Vec<Vec3> = reader.floats::<3>(attributes.position)?.into_iter().map(Vec3::from).collect();
    let count = positions.len();
    let further = [attributes.texcoord_2, attributes.texcoord_3].into_iter().map_while(|set| set);
    let primitives = parts
        .iter()
        .map(|&(indices, material)| Ok(Primitive { triangles: reader.triangles(indices, count)?, material }))
        .collect::<Result<_>>()?;
    Ok(Geometry {
        name: mesh.name.clone(),
        normals: array::<3, Vec3>(reader, attributes.normal, count)?,
        texcoord_0: array::<2, Vec2>(reader, attributes.texcoord_0, count)?,
        texcoords_material: further.map(|at| array::<2, Vec2>(reader, at, count)).collect::<Result<_>>()?,
        colors: attributes.color_0.map(|at| array::<4, Vec4>(reader, at, count)).transpose()?,
        positions,
        primitives,
    })
}

/// A vertex attribute, one element a vertex.
fn array<const N: usize, T: From<[f32; N]>>(reader: &Reader, accessor: u32, vertices: usize) -> Result<Vec<T>> {
    let values = reader.floats::<N>(accessor)?;
    if values.len() != vertices {
        let field = format!("accessor {accessor}: count");
        return Err(reader.invalid(field, values.len(), &format!("one element for each of {vertices} vertices")));
    }
    Ok(values.into_iter().map(T::from).collect())
}
