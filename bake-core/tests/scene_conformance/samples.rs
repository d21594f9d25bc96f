//! Models of glTF-Sample-Assets: nodes, textures and colours.

use crate::oracle::{Texture, linear};
use crate::{front, grid, instance_named, load, shading_normal, world_triangles};
use bake_core::scene::surface::Surface;
use bake_core::scene::{AlphaMode, LoadOptions, Scene};
use glam::{DVec3, Vec2, Vec3, Vec4};
use testkit::compare::Worst;
use testkit::reference::shared;

#[test]
fn mirrored_spheres_stay_outside_out() {
    let Some(path) = shared("assets/NegativeScaleTest/NegativeScaleTest.glb") else { return };
    let (scene, _) = load(&path);
    // Two of the three parents mirror too, so there the mirrored child is the one with positive scale.
    for (name, mirrored) in [
        ("NotShiny1", false),
        ("NotShinyMinus1", true),
        ("Shiny1", true),
        ("ShinyMinus1", false),
        ("Dark1", true),
        ("DarkMinus1", false),
    ] {
        let instance = instance_named(&scene, name);
        assert_eq!(scene.instances[instance].is_mirrored(), mirrored, "{name}");
        let triangles = world_triangles(&scene, instance);
        let centre = triangles.as_flattened().iter().sum::<DVec3>() / (3 * triangles.len()) as f64;
        let mut outward = Worst::new(format!("{name}: 1 − cosine to the outside"), 0.01);
        for (i, triangle) in triangles.iter().enumerate() {
            let out = (triangle[0] - centre).normalize();
            // A corner stands off its flat triangle's normal by up to the triangle's angular size.
            let normal = front(&scene, instance, *triangle).normalize();
            outward.record((1.0 - normal.dot(out)).max(0.0), || format!("triangle {i}"));
            assert!(shading_normal(&scene, instance, i).dot(normal) > 0.99, "{name}: triangle {i}");
        }
        outward.check();
    }
    for name in ["PositiveScaleTest", "NegativeScaleFront"] {
        let instance = instance_named(&scene, name);
        let facing: DVec3 = world_triangles(&scene, instance).into_iter().map(|t| front(&scene, instance, t)).sum();
        assert!(facing.normalize().z > 0.99, "{name} shows its check mark: {facing}");
    }
}

#[test]
fn arrows_point_at_the_targets_of_their_colour() {
    let Some(path) = shared("assets/OrientationTest/OrientationTest.glb") else { return };
    let (scene, _) = load(&path);
    for (axis, names) in [(DVec3::X, ["X1", "X2"]), (DVec3::Y, ["Y1", "Y2"]), (DVec3::Z, ["Z1", "Z2"])] {
        for name in names {
            // Seen along the axis around which the arrow is turned.
            let flat = |p: DVec3| p - axis * p.dot(axis);
            let corners = |part: &str| {
                let triangles = world_triangles(&scene, instance_named(&scene, &format!("{part}{name}")));
                triangles.as_flattened().iter().copied().map(flat).collect::<Vec<_>>()
            };
            let arrow = corners("Arrow");
            let tip = arrow.into_iter().max_by(|a, b| a.length().total_cmp(&b.length())).expect("corners");
            let target = corners("Target");
            let target = target.iter().sum::<DVec3>() / target.len() as f64;
            let degrees = tip.angle_between(target).to_degrees();
            // The targets' rings are about 10 degrees wide.
            assert!(degrees < 3.0, "Arrow{name} is {degrees} degrees off");
        }
    }
}

/// Texture coordinates of a quad from −0.5 to 0.5 at a marker's place.
fn marked(scene: &Scene, parent: &str, marker: &str) -> Vec2 {
    let at = |name: &str| scene.instances[instance_named(scene, name)].world_from_object.translation;
    let place = at(&format!("{parent} - {marker}")) - at(parent);
    Vec2::new(place.x + 0.5, 0.5 - place.y)
}

#[test]
fn texture_transforms_bring_the_arrow_to_the_correct_marker() {
    let Some(path) = shared("assets/TextureTransformTest/TextureTransformTest.gltf") else { return };
    let (scene, _) = load(&path);
    let transformed = |name: &str, uv: Vec2| {
        let triangle = scene.material_at(instance_named(&scene, name) as u32, 0);
        let [u, v] = triangle.base_color_texture.as_ref().expect("textured").transform;
        Vec2::new(u.dot(uv.extend(1.0)), v.dot(uv.extend(1.0)))
    };
    // The arrow's tip in the image: where it shows when nothing is transformed.
    let tip = marked(&scene, "Rotation", "Not Supported");
    let mut off = Worst::new("distance of the arrow's tip to the correct marker", 1e-6);
    for name in ["Rotation", "Scale"] {
        off.record((transformed(name, marked(&scene, name, "Correct")) - tip).length().into(), || name.into());
    }
    off.check();
    // This marker is placed by eye, with a radius of 0.05.
    let all = transformed("All", marked(&scene, "All", "Correct"));
    assert!((all - tip).length() < 0.05, "{all}");
    // Control: the model marks where a rotation of the wrong sign would end.
    let wrong = transformed("Rotation", marked(&scene, "Rotation", "Error"));
    assert!((wrong - tip).length() > 0.5, "{wrong}");

    // T · R · S of the extension by hand, all three at once: offset (−0.2, −0.1), rotation 0.3, scale 1.5.
    let (sin, cos) = 0.3f32.sin_cos();
    let scaled = Vec2::new(0.43, 0.75) * 1.5;
    let rotated = Vec2::new(cos * scaled.x + sin * scaled.y, -sin * scaled.x + cos * scaled.y);
    let by_hand = rotated + Vec2::new(-0.2, -0.1);
    assert!((transformed("All", Vec2::new(0.43, 0.75)) - by_hand).length() < 1e-6, "{by_hand}");
}

#[test]
fn texture_offsets_show_the_ticked_tiles() {
    let Some(path) = shared("assets/TextureTransformTest/TextureTransformTest.gltf") else { return };
    let (scene, _) = load(&path);
    // Tile colours of UV.png as sRGB; yellow means that the offset was not applied.
    for (name, color) in [("Offset U", [0, 192, 0]), ("Offset V", [0, 0, 192]), ("Offset UV", [0, 192, 192])] {
        let instance = instance_named(&scene, name) as u32;
        let want = Vec3::from(color.map(|c: u8| linear(f64::from(c) / 255.0) as f32));
        let points: Vec<Vec3> = grid(16).map(|at| Surface::at(&scene, instance, 0, at).reflect).collect();
        let same = points.iter().filter(|c| (**c - want).abs().max_element() < 0.02).count();
        assert!(2 * same > points.len(), "{name}: {same} of {} points have {want}, not {:?}", points.len(), points[0]);
    }
}

#[test]
fn sparse_values_replace_those_of_the_base() {
    let (low, high) = (|x: u8| [f32::from(x), 0.0], |x: u8| [f32::from(x), 1.0]);
    // The base is a strip of six squares; vertices 8, 10 and 12 are lifted by the sparse part.
    let mut upper: Vec<[f32; 2]> = (0..7).map(high).collect();
    (upper[1], upper[3], upper[5]) = ([1.0, 2.0], [3.0, 3.0], [5.0, 4.0]);
    let mut want = Vec::new();
    for x in 0..6u8 {
        let at = usize::from(x);
        want.push([low(x), upper[at + 1], upper[at]]);
        want.push([low(x), low(x + 1), upper[at + 1]]);
    }
    for form in ["glTF", "glTF-Embedded"] {
        let Some(path) = shared(&format!("assets/SimpleSparseAccessor/{form}/SimpleSparseAccessor.gltf")) else {
            return;
        };
        let (scene, _) = load(&path);
        let got = world_triangles(&scene, 0);
        let got: Vec<_> = got.iter().map(|t| t.map(|p| [p.x as f32, p.y as f32])).collect();
        assert_eq!(got, want, "{form}");
    }
}

#[test]
fn vertex_colours_blank_the_crosses() {
    let Some(path) = shared("assets/VertexColorTest/VertexColorTest.glb") else { return };
    let (mut scene, _) = load(&path);
    let instance = instance_named(&scene, "VertexColorTest");
    let mesh = scene.instances[instance].mesh as usize;
    let pure = [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, 1.0), Vec4::new(0.0, 0.0, 1.0, 1.0)];
    let quads = |scene: &Scene| {
        let colors = |t: &[u32; 3]| t.map(|v| scene.meshes[mesh].colors[v as usize]);
        let mut out = Vec::new();
        for (i, triangle) in scene.meshes[mesh].triangles.iter().enumerate() {
            let [a, b, c] = colors(triangle);
            out.extend(pure.iter().position(|p| a == *p && b == *p && c == *p).map(|channel| (i as u32, channel)));
        }
        out
    };
    let quads = quads(&scene);
    assert_eq!(quads.len(), 6, "three squares");
    // Light of other colours than the square's own, and of its own.
    let sums = |scene: &Scene| {
        let (mut other, mut own) = (0.0f32, 0.0f32);
        for &(triangle, channel) in &quads {
            for at in grid(40) {
                let color = Surface::at(scene, instance as u32, triangle, at).reflect;
                own += color[channel];
                other += color[(channel + 1) % 3] + color[(channel + 2) % 3];
            }
        }
        (other, own)
    };
    let (other, own) = sums(&scene);
    assert!(other == 0.0 && own > 100.0, "{other}, {own}");
    // Control: without vertex colours the crosses show.
    scene.meshes[mesh].colors.fill(Vec4::ONE);
    assert!(sums(&scene).0 > 100.0);
}

#[test]
fn the_second_texture_coordinates_show_the_logo_and_no_complaint() {
    let Some(path) = shared("assets/MultiUVTest/MultiUVTest.glb") else { return };
    let (mut scene, _) = load(&path);
    // The emission image has a green logo where UV 1 leads, and white words of complaint where UV 0 leads.
    let shows = |scene: &Scene| {
        let triangles = 0..scene.meshes[0].triangles.len() as u32;
        let points = triangles.flat_map(|t| grid(60).map(move |at| (t, at)));
        let colors: Vec<Vec3> = points.map(|(t, at)| Surface::at(scene, 0, t, at).emission).collect();
        (colors.iter().any(|c| c.y > 0.5 && c.z < 0.2), colors.iter().any(|c| c.min_element() > 0.9))
    };
    assert_eq!(shows(&scene), (true, false));
    let set = |scene: &Scene| {
        let material = &scene.materials[0];
        (
            material.base_color_texture.as_ref().map(|t| t.texcoord),
            material.emission_texture.as_ref().map(|t| t.texcoord),
        )
    };
    assert_eq!(set(&scene), (Some(0), Some(1)));
    scene.meshes[0].texcoords[1] = scene.meshes[0].texcoords[0].clone();
    assert!(shows(&scene).1, "control: with UV 0 the words show");
}

#[test]
fn gamma_chunks_and_profiles_of_images_are_ignored() {
    let Some(path) = shared("assets/TextureEncodingTest/TextureEncodingTest.glb") else { return };
    let (scene, _) = load(&path);
    // Plain factor; then a PNG that says nothing, one with gAMA and cHRM, one with a profile. First reflecting, then
    // emitting. 0.2462 is 136/255 in sRGB.
    let want = Vec3::new(0.0, 0.246_201_33, 0.0);
    let mut worst = Worst::new("decoded colour", 1e-7);
    for node in 1..9 {
        let instance = scene.instances.iter().position(|i| i.node == node).expect("a patch");
        let surface = Surface::at(&scene, instance as u32, 0, Vec2::splat(0.3));
        let got = if node < 5 { surface.reflect } else { surface.emission };
        worst.record((got - want).abs().max_element().into(), || format!("node {node}: {got}"));
    }
    worst.check();
    assert!((linear(136.0 / 255.0) - f64::from(want.y)).abs() < 1e-7);
}

#[test]
fn cutoffs_cut_deeper_the_higher_they_are() {
    let Some(path) = shared("assets/AlphaBlendModeTest/AlphaBlendModeTest.glb") else { return };
    let (scene, _) = load(&path);
    let through = |name: &str| {
        let instance = instance_named(&scene, name);
        let mesh = &scene.meshes[scene.instances[instance].mesh as usize];
        let triangles = 0..mesh.triangles.len() as u32;
        let points: Vec<f32> = triangles
            .flat_map(|t| grid(100).map(move |at| (t, at)))
            .map(|(t, at)| Surface::at(&scene, instance as u32, t, at).through.x)
            .collect();
        points.iter().sum::<f32>() / points.len() as f32
    };
    let mode = |name: &str| scene.material_at(instance_named(&scene, name) as u32, 0).alpha_mode;
    let names = ["TestOpaque", "TestCutoff25", "TestCutoffDefault", "TestCutoff75", "TestBlend"];
    let modes =
        [AlphaMode::Opaque, AlphaMode::Mask(0.25), AlphaMode::Mask(0.5), AlphaMode::Mask(0.75), AlphaMode::Blend];
    assert_eq!(names.map(mode), modes);
    let [opaque, low, half, high, blend] = names.map(through);
    println!("light let through: {opaque}, {low}, {half}, {high}; blended {blend}");
    assert!(opaque == 0.0 && 0.0 < low && low < half && half < high && high < 1.0);
    assert!(low < blend && blend < high, "the mean of a cut at every level");
}

/// A file of one triangle whose texture has a red PNG and a green WebP.
fn webp_scene(folder: &std::path::Path, extension: &str) -> Scene {
    for (name, format, color) in
        [("red.png", image::ImageFormat::Png, [255, 0, 0]), ("green.webp", image::ImageFormat::WebP, [0, 255, 0])]
    {
        let image = image::RgbImage::from_pixel(2, 2, image::Rgb(color));
        image.save_with_format(folder.join(name), format).expect("a writable folder");
    }
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    std::fs::write(folder.join("p.bin"), positions.map(f32::to_le_bytes).as_flattened()).expect("a writable folder");
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["EXT_texture_webp"],"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
        "textures":[{{"source":0{extension}}}],"images":[{{"uri":"red.png"}},{{"uri":"green.webp"}}],
        "buffers":[{{"uri":"p.bin","byteLength":36}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}]}}"#
    );
    let options = LoadOptions { require_light: false, ..LoadOptions::default() };
    bake_core::scene::load_from_bytes(json.as_bytes(), &folder.join("a.gltf"), &options).expect("loads").0
}

#[test]
fn webp_images_are_taken_before_the_png_beside_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let color = |scene: Scene| Surface::at(&scene, 0, 0, Vec2::splat(0.3)).reflect;
    let webp = r#","extensions":{"EXT_texture_webp":{"source":1}}"#;
    assert_eq!(color(webp_scene(folder.path(), webp)), Vec3::Y);
    assert_eq!(color(webp_scene(folder.path(), "")), Vec3::X);
}

#[test]
fn the_oracle_and_the_sampler_meet_on_a_sample_model() {
    let Some(folder) = shared("assets/TextureTransformTest") else { return };
    let (scene, _) = load(&folder.join("TextureTransformTest.gltf"));
    let mut texture = Texture::open(&folder.join("Arrow.png"));
    texture.wrap = [crate::oracle::Wrap::Clamp; 2];
    // The oracle's coordinates differ by f32 rounding, 1e-7 of 128 texels, where black meets white.
    let mut worst = Worst::new("rotated arrow against f64", 5e-5);
    let instance = instance_named(&scene, "Rotation");
    let (sin, cos) = std::f64::consts::FRAC_PI_8.sin_cos();
    for (triangle, corners) in world_triangles(&scene, instance).into_iter().enumerate() {
        let origin = scene.instances[instance].world_from_object.translation.as_dvec3();
        for at in grid(60) {
            let weights = at.as_dvec2();
            let place = corners[0] * (1.0 - weights.x - weights.y) + corners[1] * weights.x + corners[2] * weights.y;
            let (u, v) = (place.x - origin.x + 0.5, 0.5 - (place.y - origin.y));
            let turned = glam::DVec2::new(cos * u + sin * v, -sin * u + cos * v);
            let got = Surface::at(&scene, instance as u32, triangle as u32, at).reflect.as_dvec3();
            let want = texture.at(turned.as_vec2()).truncate();
            worst.record((got - want).abs().max_element(), || format!("{turned}"));
        }
    }
    worst.check();
}
