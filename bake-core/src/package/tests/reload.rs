//! The written scene loaded as any other: the same geometry, materials and lights, and coordinates that lead to the
//! package's texels.

use super::*;
use crate::scene::surface::Surface;
use crate::scene::{LoadOptions, Warning, load};
use bake_formats::sample::Sampler;
use glam::Mat2;

fn reload(package: &Package) -> (Scene, Vec<Warning>) {
    load(&package.path(&package.baked_scene()), &LoadOptions::default()).unwrap()
}

/// Position, normal and set 0 of every corner of a mesh's triangles.
fn corners(scene: &Scene, instance: &Instance) -> Vec<(Vec3, Vec3, Vec2)> {
    let mesh = &scene.meshes[instance.mesh as usize];
    let vertices = mesh.triangles.iter().flatten().map(|&vertex| vertex as usize);
    vertices.map(|v| (mesh.positions[v], mesh.normals[v], mesh.texcoords[0][v])).collect()
}

#[track_caller]
fn close(got: Vec3, want: Vec3) {
    assert!((got - want).abs().max_element() <= 1e-5 * want.abs().max_element().max(1.0), "{got} against {want}");
}

/// What surfaces do with light, at points of every triangle.
fn same_surfaces(a: &Scene, b: &Scene) {
    for instance in 0..a.instances.len() as u32 {
        for (triangle, at) in (0..2).flat_map(|t| [(0.2, 0.2), (0.1, 0.7), (0.6, 0.3)].map(|at| (t, Vec2::from(at)))) {
            let [a, b] = [a, b].map(|scene| Surface::at(scene, instance, triangle, at));
            close(b.reflect, a.reflect);
            close(b.transmit, a.transmit);
            close(b.through, a.through);
            close(b.emission, a.emission);
        }
    }
}

#[test]
fn geometry_materials_and_lights_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let (original, (read, warnings)) = (scene(), reload(&write_quads(folder.path(), PixelFormat::F32)));
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(read.instances.len(), 3);
    for (index, (ours, theirs)) in original.instances.iter().zip(&read.instances).enumerate() {
        assert_eq!((&theirs.path, theirs.world_from_object), (&ours.path, ours.world_from_object));
        assert_eq!(corners(&read, theirs), corners(&original, ours));
        if let Some(placement) = atlas().placements[index] {
            let mesh = &read.meshes[theirs.mesh as usize];
            // The quad's layout coordinates are its positions.
            let expected = mesh.positions.iter().map(|p| placement.offset + placement.scale * p.truncate());
            assert_eq!(mesh.texcoords[1], expected.collect::<Vec<_>>());
        }
    }
    same_surfaces(&original, &read);
    let (ours, theirs) = (&original.materials[0], read.material_at(0, 0));
    assert_eq!((theirs.alpha_mode, theirs.double_sided), (ours.alpha_mode, ours.double_sided));
    assert_eq!(theirs.transmission, ours.transmission);
    close(theirs.volume_sigma_a, ours.volume_sigma_a);
    let [ours, theirs] = [&original, &read].map(|scene| &scene.lights[0]);
    close(theirs.color, ours.color);
    let parts = |light: &Light| match light.kind {
        LightKind::Spot { position, direction, cos_inner, cos_outer, radius, range, .. } => {
            (position, direction, Vec3::new(cos_inner, cos_outer, radius), range)
        }
        _ => panic!("{light:?}"),
    };
    let (ours, theirs) = (parts(ours), parts(theirs));
    assert_eq!((theirs.0, theirs.3), (ours.0, ours.3));
    close(theirs.1, ours.1);
    close(theirs.2, ours.2);
}

/// The lightmap is set 1; a material's set 1, or 2, moves behind it and is still the one that is sampled.
#[test]
fn a_materials_further_coordinate_set_survives_the_lightmap() {
    for set in [1, 2] {
        let mut original = scene();
        original.materials[0].base_color_texture.as_mut().unwrap().texcoord = set;
        let folder = tempfile::tempdir().unwrap();
        let (read, warnings) = reload(&write_scene(folder.path(), &original, PixelFormat::F32));
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(read.material_at(0, 0).base_color_texture.as_ref().unwrap().texcoord, 2);
        same_surfaces(&original, &read);
    }
    // Another set gives other surfaces, else nothing was shown.
    let [mut a, mut b] = [scene(), scene()];
    for (scene, set) in [(&mut a, 1), (&mut b, 2)] {
        scene.materials[0].base_color_texture.as_mut().unwrap().texcoord = set;
    }
    assert!(std::panic::catch_unwind(|| same_surfaces(&a, &b)).is_err());
}

/// With two sets besides the lightmap's the file has four, for readers that read so many; ours says what it leaves out.
#[test]
fn two_further_sets_are_written_in_order() {
    let mut original = scene();
    original.materials[0].emission_texture.as_mut().unwrap().texcoord = 2;
    let folder = tempfile::tempdir().unwrap();
    let package = write_scene(folder.path(), &original, PixelFormat::F32);
    let file = package.baked_scene();
    let baked = BakedScene::from_bytes(&package.path(&file), &package.read(&file).unwrap()).unwrap();
    let (material, mesh) = (&baked.materials[0], quad());
    let sets = [&material.pbr_metallic_roughness.base_color_texture, &material.emissive_texture];
    assert_eq!(sets.map(|info| info.as_ref().unwrap().tex_coord), [1, 2]);
    for (index, geometry) in baked.geometries.iter().enumerate() {
        let [one, two] = geometry.texcoords_material.as_slice() else { panic!("{geometry:?}") };
        assert_eq!((one[2], two[2]), (mesh.texcoords[1][2], mesh.texcoords[2][2]), "geometry {index}");
    }
    let (_, warnings) = reload(&package);
    assert!(warnings.iter().any(|warning| warning.to_string().contains("set 3 is not read")), "{warnings:?}");
}

/// World point of an instance's surface at a page coordinate.
fn world_at(scene: &Scene, instance: usize, uv: Vec2) -> Option<Vec3> {
    let instance = &scene.instances[instance];
    let mesh = &scene.meshes[instance.mesh as usize];
    mesh.triangles.iter().find_map(|triangle| {
        let [a, b, c] = triangle.map(|v| mesh.texcoords[1][v as usize]);
        let weights = Mat2::from_cols(b - a, c - a).inverse() * (uv - a);
        let inside = weights.min_element() >= -1e-6 && weights.element_sum() <= 1.0 + 1e-6;
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        inside.then(|| instance.world_from_object.transform_point3(a + weights.x * (b - a) + weights.y * (c - a)))
    })
}

/// Three ways to a texel: the page's pixel, the scene's coordinates, the sampler's look-up at the point in space.
#[test]
fn pixel_coordinate_and_sample_agree() {
    let folder = tempfile::tempdir().unwrap();
    let package = write_quads(folder.path(), PixelFormat::F32);
    let (scene, sampler) = (reload(&package).0, Sampler::open(&package).unwrap());
    let pages: Vec<Vec<Vec3>> =
        package.manifest.pages.iter().map(|page| package.image(&page.lightmap).unwrap().rgb("").unwrap()).collect();
    let mut texels = 0;
    for (page, y, x) in (0..2usize).flat_map(|page| (0..16).map(move |at| (page, at / 4, at % 4))) {
        let center = (Vec2::new(x as f32, y as f32) + 0.5) / 4.0;
        let Some(point) = world_at(&scene, page, center) else { continue };
        let sample = sampler.sample(point, Vec3::Z).unwrap();
        assert_eq!((sample.page as usize, sample.texel), (page, [x as u32, y as u32]));
        let at = y * 4 + x;
        close(sample.irradiance, pages[page][at]);
        let wrong = [pages[1 - page][at], pages[page][15 - at]];
        assert!(wrong.iter().all(|wrong| (sample.irradiance - *wrong).length() > 0.1), "all texels are alike");
        texels += 1;
    }
    assert_eq!(texels, 8, "two by two texels a placement");
}
