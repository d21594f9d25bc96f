//! Models of glTF-Asset-Generator; each folder's README has the pictures that these numbers stand for.

use crate::oracle::{Texture, Wrap};
use crate::{all_world_triangles, front, grid, load, shading_normal, world_triangles};
use bake_core::scene::surface::Surface;
use bake_core::scene::{AlphaMode, Scene, WarningKind};
use glam::{DVec2, DVec3, Vec2, Vec4};
use std::path::PathBuf;
use testkit::compare::Worst;
use testkit::reference::shared;

fn model(group: &str, index: usize) -> Option<PathBuf> {
    shared(&format!("assets/asset-generator/{group}/{group}_{index:02}.gltf"))
}

fn area(triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// Texture coordinates (set 0) at a point.
fn uv(scene: &Scene, triangle: usize, at: Vec2) -> Vec2 {
    let mesh = &scene.meshes[0];
    let [a, b, c] = mesh.triangles[triangle].map(|v| mesh.texcoords[0][v as usize]);
    a * (1.0 - at.x - at.y) + b * at.x + c * at.y
}

#[test]
fn every_primitive_mode_draws_the_unit_square_or_is_no_surface() {
    for index in 0..16 {
        let Some(path) = model("Mesh_PrimitiveMode", index) else { return };
        if matches!(index, 0..=3 | 7..=10) {
            // Points, lines, loops and strips of lines: nothing to bake.
            let options = bake_core::scene::LoadOptions { require_light: false, ..Default::default() };
            let error = bake_core::scene::load(&path, &options).expect_err("points and lines");
            assert!(matches!(error.fault, bake_core::scene::Fault::NoTriangles { .. }), "{error}");
            continue;
        }
        let (scene, _) = load(&path);
        let triangles = world_triangles(&scene, 0);
        assert_eq!((triangles.len(), area(&triangles)), (2, 1.0), "{index}");
        // Both halves face +Z and tile the square: their centroids are on opposite sides of the middle.
        for (i, triangle) in triangles.iter().enumerate() {
            assert_eq!(front(&scene, 0, *triangle), DVec3::Z / 2.0, "{index}: triangle {i}");
        }
        let middle = triangles.as_flattened().iter().sum::<DVec3>() / 6.0;
        assert!(middle.length() < 1e-12, "{index}: {middle}");
    }
}

#[test]
fn vertex_colours_of_every_type_are_the_same_colours() {
    // Corner positions and colours of the README's picture; alpha 0.2 where the model has it.
    let want = [
        ([0.5, -0.5], [0.0, 1.0, 0.0]),
        ([-0.5, -0.5], [1.0, 0.0, 0.0]),
        ([-0.5, 0.5], [1.0, 1.0, 0.0]),
        ([0.5, 0.5], [0.0, 0.0, 1.0]),
    ];
    for (group, models) in [("Mesh_PrimitiveVertexColor", 0..6), ("Buffer_Interleaved", 0..5)] {
        for index in models {
            let Some(path) = model(group, index) else { return };
            let (scene, _) = load(&path);
            let mesh = &scene.meshes[0];
            let alpha = if group == "Mesh_PrimitiveVertexColor" && index >= 3 { 0.2 } else { 1.0 };
            let mut seen = [false; 4];
            for (position, color) in mesh.positions.iter().zip(&mesh.colors) {
                let corner = want.iter().position(|(p, _)| *p == [position.x, position.y]).expect("a corner");
                seen[corner] = true;
                let [r, g, b] = want[corner].1;
                // 0.2 is 51/255 and 13107/65535 exactly.
                assert!((*color - Vec4::new(r, g, b, alpha)).abs().max_element() < 1e-7, "{group} {index}: {color}");
            }
            assert_eq!(seen, [true; 4]);
        }
    }
}

#[test]
fn interleaved_buffers_hold_the_same_geometry() {
    for index in 0..5 {
        let Some(path) = model("Buffer_Interleaved", index) else { return };
        let (scene, _) = load(&path);
        let (apart, _) = load(&model("Mesh_PrimitiveVertexColor", 0).expect("lies beside it"));
        assert_eq!(world_triangles(&scene, 0), world_triangles(&apart, 0), "{index}");
        assert_eq!(scene.meshes[0].colors, apart.meshes[0].colors, "{index}");
        if matches!(index, 1 | 2) {
            // The padding after the colours of these two files is misplaced by some bytes from the second vertex on.
            continue;
        }
        for (position, uv) in scene.meshes[0].positions.iter().zip(&scene.meshes[0].texcoords[0]) {
            assert_eq!(*uv, Vec2::new(position.x + 0.5, 0.5 - position.y), "{index}");
        }
    }
}

#[test]
fn primitives_keep_their_own_texture_coordinates_and_materials() {
    // Which primitive has UV 0, UV 1: the README's table, left primitive first.
    let table: [[(bool, bool); 2]; 9] = [
        [(false, false), (false, false)],
        [(true, false), (false, false)],
        [(false, false), (true, false)],
        [(true, false), (true, false)],
        [(true, true), (false, false)],
        [(false, false), (true, true)],
        [(true, false), (true, true)],
        [(true, true), (true, false)],
        [(true, true), (true, true)],
    ];
    for (index, primitives) in table.iter().enumerate() {
        let Some(path) = model("Mesh_PrimitivesUV", index) else { return };
        let (scene, _) = load(&path);
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.has_texcoord_1, primitives.iter().all(|p| p.1), "{index}");
        for (primitive, &(first, second)) in mesh.primitives.iter().zip(primitives) {
            let texture = scene.materials[primitive.material as usize].base_color_texture.as_ref();
            assert_eq!(texture.map(|t| t.texcoord), first.then_some(u8::from(second)), "{index}");
            for v in primitive.vertices.clone().map(|v| v as usize) {
                // The pictures: UV 0 covers the texture, UV 1 its upper right quarter.
                let whole = Vec2::new(mesh.positions[v].x + 0.5, 0.5 - mesh.positions[v].y);
                let quarter = Vec2::new(0.5 + whole.x / 2.0, whole.y / 2.0);
                assert_eq!(mesh.texcoords[0][v], if first { whole } else { Vec2::ZERO }, "{index}");
                assert_eq!(mesh.texcoords[1][v], if second { quarter } else { Vec2::ZERO }, "{index}");
            }
        }
    }
}

#[test]
fn primitives_of_one_mesh_have_materials_of_their_own() {
    let Some(path) = model("Mesh_Primitives", 0) else { return };
    let (scene, _) = load(&path);
    assert_eq!(scene.material_at(0, 0).base_color, Vec4::new(0.0, 1.0, 0.0, 1.0));
    assert_eq!(scene.material_at(0, 1).base_color, Vec4::new(0.0, 0.0, 1.0, 1.0));
    for index in 0..3 {
        let (scene, warnings) = load(&model("Material_Mixed", index).expect("lies beside it"));
        assert!(scene.materials.iter().all(|m| m.base_color_texture.is_some()), "the fallback of specular glossiness");
        assert!(warnings.iter().any(|w| w.kind == WarningKind::IgnoredExtension), "{index}");
    }
}

#[test]
fn mirrored_nodes_stay_solid() {
    let Some(path) = model("Node_NegativeScale", 0) else { return };
    let (control, _) = load(&path);
    let straight = world_triangles(&control, 1);
    let volume = enclosed(&control, &straight);
    assert!(volume > 0.1, "the model is solid: {volume}");
    let mut facing = Worst::new("Node_NegativeScale: 1 − cosine of geometric and shading normals", 1e-6);
    for index in 1..13 {
        let (scene, _) = load(&model("Node_NegativeScale", index).expect("lies beside it"));
        // The README's table: by matrix, by scale, then with normals, then with tangents; one to three mirrors.
        let mirrors = (index - 1) % 3 + 1;
        let scale = [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(-1.0, -1.0, 1.0), DVec3::NEG_ONE][mirrors - 1];
        assert_eq!(scene.instances.len(), 2);
        assert!(!scene.instances[0].is_mirrored());
        assert_eq!(scene.instances[1].is_mirrored(), mirrors != 2, "{index}");
        let triangles = world_triangles(&scene, 1);
        let up = DVec3::Y * 2.0;
        let want: Vec<_> = straight.iter().map(|t| t.map(|p| scale * (p - up) + up)).collect();
        assert_eq!(triangles, want, "{index}");
        assert!((enclosed(&scene, &triangles) / volume - 1.0).abs() < 1e-9, "{index}: front faces lie outside");
        for (i, triangle) in triangles.into_iter().enumerate() {
            let normal = front(&scene, 1, triangle).normalize();
            facing.record(1.0 - normal.dot(shading_normal(&scene, 1, i)), || format!("{index}: triangle {i}"));
        }
    }
    facing.check();
}

/// Volume within the front faces of instance 1, by the divergence theorem; negative inside out.
fn enclosed(scene: &Scene, triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|t| front(scene, 1, *t).dot(t[0]) / 3.0).sum()
}

#[test]
fn shared_parts_are_used_by_both() {
    let Some(path) = model("Instancing", 6) else { return };
    let (scene, _) = load(&path);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2), "a mesh placed twice is kept once");
    let x: Vec<f32> = scene.instances.iter().map(|i| i.world_from_object.translation.x).collect();
    assert_eq!(x, [-0.6, 0.6]);
    // Differences of the README's table: which image and which wrap a half has, 0 to 5.
    for (index, images) in [(0, [0, 0]), (1, [0, 1]), (2, [0, 0]), (3, [0, 0]), (4, [0, 1]), (5, [0, 1])] {
        let (scene, _) = load(&model("Instancing", index).expect("lies beside it"));
        let mut halves = Vec::new();
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            halves.extend(mesh.primitives.iter().map(|p| &scene.materials[p.material as usize]));
        }
        let textures: Vec<_> = halves.iter().map(|m| m.base_color_texture.as_ref().expect("textured")).collect();
        assert_eq!(textures.iter().map(|t| t.image).collect::<Vec<_>>(), images, "{index}");
        assert_eq!(scene.images.len() as u32, 1 + images[1], "an image is decoded once");
        assert_eq!(textures[0].wrap != textures[1].wrap, index == 0);
        assert_eq!(halves[1].base_color.x, if index == 2 { 0.5 } else { 1.0 });
        assert!((area(&all_world_triangles(&scene)) - 2.0).abs() < 1e-6, "{index}: two squares of one metre");
    }
    for index in 7..13 {
        let (scene, warnings) = load(&model("Instancing", index).expect("lies beside it"));
        assert_eq!(scene.instances.len(), 2, "{index}");
        let skinned = warnings.iter().any(|w| w.kind == WarningKind::Deformation);
        assert_eq!(skinned, index < 10, "{index}: skins are not applied");
    }
}

/// Compares a whole model with the oracle: base colour times coverage on a grid of points.
fn against_oracle(name: &str, scene: &Scene, texture: Option<&Texture>) {
    // Texture coordinates in f32 are off by up to 1e-4 texels of 1024, but these images have soft edges.
    let mut worst = Worst::new(name, 1e-5);
    let material = &scene.materials[0];
    let mesh = &scene.meshes[0];
    for triangle in 0..mesh.triangles.len() {
        for at in grid(40) {
            let [a, b, c] = mesh.triangles[triangle].map(|v| mesh.colors[v as usize]);
            let vertex = a * (1.0 - at.x - at.y) + b * at.x + c * at.y;
            let uv = uv(scene, triangle, at);
            let texel = texture.map_or(glam::DVec4::ONE, |t| t.at(uv));
            let base = texel * vertex.as_dvec4() * material.base_color.as_dvec4();
            let cover = match material.alpha_mode {
                AlphaMode::Opaque => 1.0,
                AlphaMode::Blend => base.w,
                // Too close to the cutoff for f32.
                AlphaMode::Mask(cutoff) if (base.w - f64::from(cutoff)).abs() < 1e-5 && cutoff > 0.0 => continue,
                AlphaMode::Mask(cutoff) => f64::from(u8::from(base.w >= f64::from(cutoff))),
            };
            let got = Surface::at(scene, 0, triangle as u32, at);
            let reflect = got.reflect.as_dvec3() - cover * base.truncate();
            let through = got.through.as_dvec3() - (1.0 - cover);
            worst.record(reflect.abs().max(through.abs()).max_element(), || format!("{uv}"));
        }
    }
    worst.check();
}

#[test]
fn samplers_wrap_and_filter_as_the_book_says() {
    use Wrap::{Clamp, Mirror, Repeat};
    let Some(folder) = shared("assets/asset-generator/Texture_Sampler") else { return };
    let mut texture = Texture::open(&folder.join("Textures/BaseColor_Plane.png"));
    for index in 0..14 {
        let (scene, _) = load(&model("Texture_Sampler", index).expect("lies beside it"));
        // Wrap S, wrap T and magnification filter of the README's table.
        texture.wrap = match index {
            1 => [Repeat, Clamp],
            2 => [Repeat, Mirror],
            3 => [Clamp, Repeat],
            4 => [Mirror, Repeat],
            13 => [Clamp, Clamp],
            _ => [Repeat; 2],
        };
        texture.nearest = matches!(index, 5 | 13);
        let outside = scene.meshes[0].texcoords[0].iter().all(|uv| (uv - 0.5).abs().min_element() > 0.79);
        assert!(outside, "the models reach 0.3 beyond the texture");
        against_oracle(&format!("Texture_Sampler {index}"), &scene, Some(&texture));
    }
}

#[test]
fn alpha_modes_cover_as_texture_factor_and_vertex_colour_say() {
    let Some(folder) = shared("assets/asset-generator/Material_AlphaMask") else { return };
    let texture = Texture::open(&folder.join("Textures/BaseColor_Plane.png"));
    let cutoffs = [0.5, 0.4, 0.7, 1.1, 0.0, 0.4, 0.6];
    for (index, cutoff) in cutoffs.into_iter().enumerate() {
        let (scene, _) = load(&model("Material_AlphaMask", index).expect("lies beside it"));
        assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Mask(cutoff));
        assert_eq!(scene.materials[0].base_color.w, if index >= 5 { 0.7 } else { 1.0 });
        against_oracle(&format!("Material_AlphaMask {index}"), &scene, Some(&texture));
        // 1.1 cuts all away, 0 nothing.
        let through = |at| Surface::at(&scene, 0, 0, at).through.x;
        let (least, most) = grid(20).map(through).fold((1.0f32, 0.0f32), |(l, m), t| (l.min(t), m.max(t)));
        match index {
            3 => assert_eq!((least, most), (1.0, 1.0)),
            4 => assert_eq!((least, most), (0.0, 0.0)),
            _ => assert_eq!((least, most), (0.0, 1.0), "{index}: cut in part"),
        }
    }
    for index in 0..7 {
        let (scene, _) = load(&model("Material_AlphaBlend", index).expect("lies beside it"));
        assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
        assert_eq!(scene.materials[0].base_color.w, if matches!(index, 2 | 4..=6) { 0.7 } else { 1.0 });
        let textured = matches!(index, 1 | 3 | 5 | 6);
        assert_eq!(scene.materials[0].base_color_texture.is_some(), textured, "{index}");
        let colored = matches!(index, 0 | 3 | 4 | 6);
        assert_eq!(scene.meshes[0].colors.iter().any(|c| c.w < 1.0), colored, "{index}");
        against_oracle(&format!("Material_AlphaBlend {index}"), &scene, textured.then_some(&texture));
    }
}

#[test]
#[should_panic(expected = "measured")]
fn the_oracle_tells_mirrored_from_repeated() {
    let Some(path) = model("Texture_Sampler", 2) else { panic!("nothing measured without the collection") };
    let (scene, _) = load(&path);
    let texture = Texture::open(&path.with_file_name("Textures/BaseColor_Plane.png"));
    against_oracle("mirrored against repeated", &scene, Some(&texture));
}

#[test]
fn models_without_positions_have_nothing_to_bake() {
    for index in 0..2 {
        let file = format!("assets/asset-generator/Negative_Mesh_NoPosition/Mesh_NoPosition_{index:02}.gltf");
        let Some(path) = shared(&file) else { return };
        let options = bake_core::scene::LoadOptions { require_light: false, ..Default::default() };
        let error = bake_core::scene::load(&path, &options).expect_err("no POSITION");
        assert!(matches!(error.fault, bake_core::scene::Fault::NoTriangles { .. }), "{error}");
    }
}

#[test]
fn compatible_models_read_as_version_2() {
    // 04 and 05 must be refused; that is checked with the other refusals. All others are the control's unit square.
    for index in [0, 1, 2, 3, 6] {
        let Some(path) = model("Compatibility", index) else { return };
        let (scene, _) = load(&path);
        let triangles = world_triangles(&scene, 0);
        assert_eq!((triangles.len(), area(&triangles)), (2, 1.0), "{index}");
        let extent = triangles.as_flattened().iter().map(|p| DVec2::new(p.x, p.y).abs().max_element());
        assert_eq!(extent.fold(0.0, f64::max), 0.5);
    }
}
