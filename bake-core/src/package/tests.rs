//! A package made of two placements of a quad, read back: pixels, coordinates, materials, lights.

use super::*;
use crate::atlas::{Atlas, Layout, Page, Placement};
use crate::scene::{AlphaMode, Image, Instance, Light, LightKind, Material, Mesh, Primitive, TextureRef, Wrap};
use crate::solve::buffers::{TermImage, Validity};
use bake_formats::glb::document as gltf;
use bake_formats::{BakedScene, Package};
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::{Bounds, Density, Medium, MediumSet, Ray, Scatter};
use bake_optics::phase::Phase;
use glam::{Affine3A, DAffine3, DQuat, DVec3, IVec3, Vec2, Vec4};
use std::sync::Arc;
use testkit::compare::Worst;

mod reload;

fn quad() -> Mesh {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    Mesh {
        name: "quad".into(),
        positions: corners.iter().map(|c| c.extend(0.0)).collect(),
        normals: vec![Vec3::Z; 4],
        texcoords: [1.0, 0.5, 0.75].map(|scale| corners.map(|c| scale * c).to_vec()),
        colors: vec![Vec4::ONE; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        primitives: vec![Primitive { triangles: 0..2, vertices: 0..4, material: 0 }],
        has_texcoord_1: true,
    }
}

fn scene() -> Scene {
    let texture = |texcoord, transform| {
        let wrap = [Wrap::Repeat, Wrap::Clamp];
        Some(TextureRef { image: 0, texcoord, wrap, linear: true, transform })
    };
    let (sin, cos) = 0.3f32.sin_cos();
    let turned = [Vec3::new(cos * 2.0, sin * 3.0, 0.1), Vec3::new(-sin * 2.0, cos * 3.0, 0.2)];
    let material = Material {
        name: "paint".into(),
        base_color: Vec4::new(0.5, 0.25, 0.125, 0.75),
        base_color_texture: texture(1, [Vec3::X, Vec3::Y]),
        emission: Vec3::new(0.0, 500.0, 1000.0),
        emission_texture: texture(0, turned),
        alpha_mode: AlphaMode::Mask(0.25),
        double_sided: true,
        transmission: 0.5,
        volume_sigma_a: Vec3::new(0.0, 1.0, 2.0),
        ..Default::default()
    };
    let instance = |path: &str, x: f32, lightmapped| Instance {
        path: path.into(),
        node: 7,
        mesh: 0,
        world_from_object: Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)),
        lightmapped,
    };
    let texel = |i: u8| [10 + 15 * i, 200 - 7 * i, 30 + 3 * i, 100 + 10 * i];
    let image = Image { width: 4, height: 4, rgba: (0..16).map(|i| texel((i * 5) % 16)).collect() };
    let position = Vec3::new(1.0, 2.0, 3.0);
    let (radius, range) = (0.001, Some(4.0));
    let spot = LightKind::Spot {
        position,
        direction: Vec3::NEG_Y,
        cos_inner: 0.9,
        cos_outer: 0.5,
        radius,
        range,
        profile: None,
    };
    Scene {
        name: "quads".into(),
        meshes: vec![quad()],
        instances: vec![instance("root/a", 0.0, true), instance("root/b", 5.0, true), instance("plain", 9.0, false)],
        materials: vec![material],
        images: vec![Arc::new(image)],
        lights: vec![Light { path: "lamp".into(), color: Vec3::new(10.0, 5.0, 0.0), kind: spot }],
        environment: None,
        ..Scene::default()
    }
}

fn atlas() -> Atlas {
    // Vertices of the diagonal are split, as unwrapping may do.
    let layout = Layout {
        mesh: 0,
        source_vertex: vec![0, 1, 2, 0, 2, 3],
        uv: [0, 1, 2, 0, 2, 3].map(|v| quad().texcoords[0][v]).to_vec(),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        chart: vec![0, 0],
        charts: 1,
    };
    let placement = |page, x| {
        let (offset, scale) = (Vec2::new(x, 0.25), Vec2::splat(0.5));
        Some(Placement { layout: 0, page, offset, scale, first_chart: 0 })
    };
    let page = Page { width: 4, height: 4, ..Default::default() };
    Atlas {
        pages: vec![page.clone(), page],
        layouts: vec![layout],
        placements: vec![placement(0, 0.0), placement(1, 0.5), None],
    }
}

fn buffers(seed: f32) -> PageBuffers {
    let image = |scale: f32| (0..16).map(|i| scale * Vec3::new(i as f32, seed, 1.0)).collect();
    PageBuffers {
        width: 4,
        height: 4,
        terms: vec![
            TermImage { term: Term::Direct, irradiance: image(1.0) },
            TermImage { term: Term::Indirect, irradiance: image(0.3) },
        ],
        variance: vec![Vec3::splat(0.01); 16],
        samples: vec![64; 16],
        validity: vec![Validity::Good; 16],
        sh1: Some(vec![[Vec3::ONE; 4]; 16]),
    }
}

/// A ball of haze, and smoke on a grid of 3 × 2 × 4 points.
fn air() -> Air {
    let grid = DensityGrid::new(
        IVec3::new(3, 2, 4),
        (0..24).map(|i| i as f32 / 8.0).collect(),
        DAffine3::from_scale_rotation_translation(
            DVec3::new(0.5, 0.25, 1.0),
            DQuat::from_rotation_y(0.5),
            DVec3::new(1.0, 2.0, 3.0),
        ),
    );
    let haze = Medium {
        bounds: Bounds::Sphere { centre: DVec3::Y, radius: 20.0 },
        phase: Phase::HenyeyGreenstein { g: 0.5 },
        scatter: Scatter { sigma_s: [0.5, 0.25, 0.125], sigma_a: [0.0, 0.5, 1.0] },
        ..Medium::default()
    };
    let smoke = Medium { density: Density::Grid(Arc::new(grid.unwrap())), ..haze.clone() };
    let names = vec!["haze".into(), "smoke".into()];
    Air { media: MediumSet { media: vec![haze, smoke] }, names, ..Air::default() }
}

/// Column 1 is brighter than the others, so that a turned or mirrored picture would show.
fn stripes(width: u32, height: u32) -> Environment {
    let value = |at: u32| if at % width / (width / 8).max(1) == 1 { 9.0 } else { 1.0 };
    let radiance = (0..width * height).map(|at| Vec3::new(value(at), 2.0, (at / width) as f32)).collect();
    Environment { width, height, radiance, rotation: 0.5 }
}

#[test]
fn an_environments_picture_is_kept_and_a_wide_one_halved() {
    let narrow = images::environment(&stripes(8, 4)).rgb("").unwrap();
    assert_eq!(
        (narrow.len(), narrow[0], narrow[1], narrow[8]),
        (32, [1.0, 2.0, 0.0], [9.0, 2.0, 0.0], [1.0, 2.0, 1.0])
    );
    let wide = images::environment(&stripes(4096, 8));
    assert_eq!((wide.width, wide.height), (1024, 2));
    let texels = wide.rgb("").unwrap();
    assert_eq!((texels[0], texels[128], texels[1024]), ([1.0, 2.0, 1.5], [9.0, 2.0, 1.5], [1.0, 2.0, 5.5]));
}

/// The runtime rebuilds the media from the package alone.
#[test]
fn media_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let (media, names) = write_quads(folder.path(), PixelFormat::F16).media().unwrap();
    let written = air();
    assert_eq!((&media.media[0], names), (&written.media.media[0], written.names.clone()));
    let mut worst = Worst::new("optical depth through the package, relative", 1e-12);
    for i in 0..50 {
        let target = DVec3::new(0.4 + 0.1 * f64::from(i % 7), 2.1, 3.0 + 0.07 * f64::from(i));
        let ray = Ray::between(DVec3::new(-3.0, 0.1 * f64::from(i), 9.0), target);
        let (got, want) = (media.optical_depth(&ray), written.media.optical_depth(&ray));
        (0..3).for_each(|c| worst.relative(got[c], want[c], || format!("ray {i}")));
        assert!(want[0] > 0.0);
    }
    worst.check();
}

fn write_quads(folder: &Path, pixels: PixelFormat) -> Package {
    write_scene(folder, &scene(), pixels)
}

fn write_scene(folder: &Path, scene: &Scene, pixels: PixelFormat) -> Package {
    let (atlas, pages) = (atlas(), [buffers(1.0), buffers(2.0)]);
    let report =
        |error| PageReport { samples: 64, error, noisiest: 0.5, median: 1.0, good_texels: 15, buried_texels: 1 };
    let record = Record {
        source: Source { file: "quads.glb".into(), blake3: "0".repeat(64) },
        settings: serde_json::json!({ "bounces": null }),
        plan: Value::Null,
        warnings: vec!["one".into()],
        reproducible: true,
        pixels,
    };
    write(
        folder,
        Bake {
            scene,
            air: &air(),
            atlas: &atlas,
            pages: &pages,
            reports: &[report(0.02), report(0.01)],
            raw: None,
            vacuum: None,
            probes: None,
            fog_volume: None,
        },
        &record,
    )
    .unwrap();
    Package::open(folder).unwrap()
}

#[test]
fn pixels_come_back_and_terms_sum_to_the_total() {
    let folder = tempfile::tempdir().unwrap();
    let package = write_quads(folder.path(), PixelFormat::F32);
    assert_eq!(package.manifest.terms, [Term::Direct, Term::Indirect]);
    let page = &package.manifest.pages[1];
    let total: Vec<Vec3> = package.image(&page.lightmap).unwrap().rgb("").unwrap();
    let terms = package.image(&page.terms).unwrap();
    let [direct, indirect] = ["direct", "indirect"].map(|term| terms.rgb::<Vec3>(term).unwrap());
    for i in 0..16 {
        assert_eq!(total[i], buffers(2.0).total(i));
        assert_eq!(total[i], direct[i] + indirect[i]);
    }
    assert_eq!(terms.channel("samples.Y").unwrap()[3], 64.0);
    assert_eq!(terms.channel("validity.Y").unwrap()[3], 1.0);
    assert_eq!(package.image(page.sh1.as_ref().unwrap()).unwrap().channels.len(), 12);
    let estimate = package.manifest.error_estimate.as_ref().unwrap();
    assert_eq!((estimate.relative_standard_error, estimate.unbaked_share), (0.02, 1.0 / 16.0));
}

#[test]
fn the_baked_scene_holds_page_coordinates_materials_and_lights() {
    let folder = tempfile::tempdir().unwrap();
    let package = write_quads(folder.path(), PixelFormat::F16);
    let file = package.baked_scene();
    let bytes = package.read(&file).unwrap();
    let baked = BakedScene::from_bytes(&package.path(&file), &bytes).unwrap();
    assert_eq!(baked.nodes.len(), 3);
    let lightmaps: Vec<_> = baked.nodes.iter().map(|node| node.lightmap.as_ref()).collect();
    assert_eq!(lightmaps[1].unwrap().page, 1);
    assert_eq!(lightmaps[1].unwrap().uv[2], Vec2::new(1.0, 0.75));
    assert!(lightmaps[2].is_none());
    // One shape for both lightmapped placements, one for the plain one.
    assert_eq!([0, 1, 2].map(|i| baked.nodes[i].geometry), [0, 0, 1]);
    assert_eq!(baked.geometries[0].positions.len(), 6);
    assert_eq!(baked.geometries[0].texcoords_material[0][2], Vec2::splat(0.5));
    assert_eq!(baked.geometries[1].texcoords_material[0][2], Vec2::splat(0.5));
    // Three copies in the file (page 0, page 1, none) are one material.
    let [material] = baked.materials.as_slice() else { panic!("{} materials", baked.materials.len()) };
    assert_eq!(material.emissive_factor, Some([0.0, 0.5, 1.0]));
    assert_eq!(material.extensions.emissive_strength.as_ref().unwrap().emissive_strength, 1000.0);
    assert_eq!(
        (material.alpha_mode, material.alpha_cutoff, material.double_sided),
        (gltf::AlphaMode::Mask, Some(0.25), true)
    );
    let transform = &material.emissive_texture.as_ref().unwrap().extensions.as_ref().unwrap().transform;
    assert!((transform.rotation - 0.3).abs() < 1e-6 && (transform.scale[1] - 3.0).abs() < 1e-5, "{transform:?}");
    assert_eq!(baked.textures.len(), 1, "the image is embedded once");
    assert_eq!(baked.pages[1].uri, "quads.lightmap.01.exr");
    assert!(baked.pages[1].preview.starts_with(b"\x89PNG"));
}

#[test]
fn damaged_baked_scenes_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let package = write_quads(folder.path(), PixelFormat::F32);
    let path = package.path(&package.baked_scene());
    let good = package.read(&package.baked_scene()).unwrap();
    let rounds = if std::env::var_os("BAKE_LONG").is_some() { 500_000 } else { 10_000 };
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize
    };
    let mut refused = 0;
    for round in 0..rounds {
        let mut bad = good.clone();
        if round % 8 == 0 {
            bad.truncate(next() % bad.len());
        } else {
            let at = next() % bad.len();
            bad[at] = next() as u8;
        }
        refused += usize::from(BakedScene::from_bytes(&path, &bad).is_err());
    }
    println!("{refused} of {rounds} mutated baked scenes refused");
    assert!(refused > rounds / 8);
}

#[test]
fn packages_repeat_bit_for_bit() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let manifests = folders.each_ref().map(|folder| write_quads(folder.path(), PixelFormat::F32).manifest);
    // Hashes of all files are part of the manifest.
    assert_eq!(manifests[0], manifests[1]);
}

/// Relative intensity cos θ in the lower hemisphere: c_0 = 1/4, c_1 = 1/2, c_2 = 5/16 (half-range moments of x).
#[test]
fn profiles_shrink_to_known_legendre_coefficients() {
    let angles: Vec<f32> = (0..=900).map(|i| (i as f32 * 0.1).to_radians()).collect();
    let profile = crate::scene::Profile {
        axis: Vec3::NEG_Y,
        horizontal: Vec3::X,
        relative: Arc::new(angles.iter().map(|a| a.cos()).collect()),
        vertical: Arc::new(angles),
        horizontal_angles: Arc::new(vec![0.0]),
    };
    let position = Vec3::ZERO;
    let kind = LightKind::Point { position, radius: 0.001, range: None, profile: Some(profile) };
    let records = lights::records(&[Light { path: "ies".into(), color: Vec3::ONE, kind }]);
    let bake_formats::manifest::LightKind::Point { profile: Some(profile), .. } = &records[0].kind else { panic!() };
    for (got, want) in profile.legendre.iter().zip([0.25, 0.5, 0.3125, 0.0]) {
        // Linear interpolation over 0.1 degrees errs by (0.1 π/180)²/8 = 4e-7 at most.
        assert!((got - want).abs() < 2e-6, "{got} against {want}");
    }
}
