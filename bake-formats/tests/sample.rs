//! Sampling of a box whose six faces are charts of one page; between them the page is poisoned.

use bake_formats::baked_scene::{BakedScene, Geometry, Lightmap, Node, PageImage, Primitive};
use bake_formats::float_image::{FloatImage, PixelFormat, Quantity};
use bake_formats::glb::document as gltf;
use bake_formats::manifest::{Manifest, PageRecord, Settings, Source};
use bake_formats::sample::{PointsError, Sampler, sample_csv};
use bake_formats::{Package, PackageWriter, Term};
use glam::{Affine3A, Vec2, Vec3, Vec4};
use testkit::compare::Worst;

/// Texels across a page; faces are squares of 16 with a gutter of 4.
const SIZE: u32 = 64;
const FACE: f32 = 16.0;

/// Irradiance on the unit box, linear on each face and different on all of them.
fn irradiance(face: usize, point: Vec3) -> Vec3 {
    Vec3::new(100.0 * (face + 1) as f32, 50.0, 10.0) + Vec3::new(3.0 * point.x, 5.0 * point.y, 7.0 * point.z)
}

/// Unit normal and tangents of a face.
fn frame(face: usize) -> [Vec3; 3] {
    let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    let n = Vec3::AXES[face / 2] * sign;
    let t = Vec3::AXES[(face / 2 + 1) % 3];
    [n, t, n.cross(t)]
}

fn corner_texel(face: usize) -> Vec2 {
    Vec2::new((face % 3) as f32, (face / 3) as f32) * (FACE + 4.0) + 2.0
}

/// Face and place of a texel's centre.
fn surface_at(x: u32, y: u32) -> Option<(usize, Vec3)> {
    let texel = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    (0..6).find_map(|face| {
        let at = (texel - corner_texel(face)) / FACE;
        let [n, t, b] = frame(face);
        (at.min_element() > 0.0 && at.max_element() < 1.0)
            .then(|| (face, 0.5 * n + (at.x - 0.5) * t + (at.y - 0.5) * b))
    })
}

fn box_scene() -> BakedScene {
    let mut geometry = Geometry { name: "box".into(), ..Default::default() };
    let (mut uv, mut triangles) = (Vec::new(), Vec::new());
    for face in 0..6 {
        let [n, t, b] = frame(face);
        let first = geometry.positions.len() as u32;
        for corner in [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y] {
            geometry.positions.push(0.5 * n + (corner.x - 0.5) * t + (corner.y - 0.5) * b);
            geometry.normals.push(n);
            uv.push((corner_texel(face) + corner * FACE) / SIZE as f32);
        }
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    geometry.texcoord_0 = vec![Vec2::ZERO; geometry.positions.len()];
    geometry.primitives = vec![Primitive { triangles, material: 0 }];
    let material = gltf::Material {
        name: "m".into(),
        pbr_metallic_roughness: gltf::Pbr {
            base_color_factor: Vec4::ONE.to_array(),
            base_color_texture: None,
            metallic_factor: 0.0,
            roughness_factor: 1.0,
        },
        emissive_factor: None,
        emissive_texture: None,
        alpha_mode: gltf::AlphaMode::Opaque,
        alpha_cutoff: None,
        double_sided: false,
        extensions: Default::default(),
    };
    BakedScene {
        name: "box".into(),
        geometries: vec![geometry],
        nodes: vec![Node {
            path: "a, \"box\"".into(),
            source_node: 0,
            world_from_object: Affine3A::IDENTITY,
            geometry: 0,
            lightmap: Some(Lightmap { page: 0, uv }),
        }],
        materials: vec![material],
        pages: vec![PageImage { uri: "box.lightmap.00.exr".into(), preview: vec![1], preview_white: 1.0 }],
        ..Default::default()
    }
}

/// A sampler over the box; `invalid` texels hold poison and are marked as not baked.
fn sampler(invalid: impl Fn(u32, u32) -> bool) -> Sampler {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = PackageWriter::create(folder.path(), "box").unwrap();
    let count = (SIZE * SIZE) as usize;
    let (mut total, mut valid) = (vec![Vec3::splat(1e9); count], vec![0.0; count]);
    for (index, (total, valid)) in total.iter_mut().zip(&mut valid).enumerate() {
        let (x, y) = (index as u32 % SIZE, index as u32 / SIZE);
        if let Some((face, point)) = surface_at(x, y).filter(|_| !invalid(x, y)) {
            (*total, *valid) = (irradiance(face, point), 1.0);
        }
    }
    let mut lightmap = FloatImage::new(SIZE, SIZE);
    lightmap.push_rgb("", Quantity::Irradiance, &total);
    let mut terms = FloatImage::new(SIZE, SIZE);
    terms.push_rgb("direct", Quantity::Irradiance, &total);
    terms.push_rgb("variance", Quantity::IrradianceVariance, &vec![Vec3::splat(4.0); count]);
    terms.push("validity.Y", Quantity::Validity, valid);
    let lightmap = writer.add_image("lightmap.00.exr", &lightmap, PixelFormat::F32).unwrap();
    let terms = writer.add_image("terms.00.exr", &terms, PixelFormat::F32).unwrap();
    let source = Source { file: "box.glb".into(), blake3: String::new() };
    let mut manifest = Manifest::new("box", source, Settings::new(serde_json::Value::Null));
    manifest.terms = vec![Term::Direct];
    manifest.pages.push(PageRecord { width: SIZE, height: SIZE, lightmap, terms, sh1: None, raw: None });
    writer.add_bytes("baked.glb", &box_scene().to_bytes(folder.path()).unwrap()).unwrap();
    writer.finish(manifest).unwrap();
    Sampler::open(&Package::open(folder.path()).unwrap()).unwrap()
}

/// Half a texel of the steepest face, where a border texel's centre stands for the border.
const BORDER_ERROR: f32 = 0.5 / FACE * (7.0 + 5.0) + 1e-3;

#[test]
fn linear_light_comes_back_inside_and_nothing_bleeds_at_borders() {
    let sampler = sampler(|_, _| false);
    let mut inside = Worst::new("linear light inside a chart, lux", 2e-3);
    let mut border = Worst::new("linear light at a chart's border, lux", f64::from(BORDER_ERROR));
    for face in 0..6 {
        let [n, t, b] = frame(face);
        for i in 0..=64 {
            for j in 0..=64 {
                let at = Vec2::new(i as f32, j as f32) / 64.0;
                let point = 0.5 * n + (at.x - 0.5) * t + (at.y - 0.5) * b;
                let sample = sampler.sample(point, n).unwrap();
                let error = (sample.irradiance - irradiance(face, point)).abs().max_element();
                let margin = at.min(1.0 - at).min_element();
                let worst = if margin * FACE >= 0.5 { &mut inside } else { &mut border };
                worst.record(error.into(), || format!("face {face} at {at}"));
                assert_eq!(sample.terms, [sample.irradiance]);
                assert!(sample.distance < 1e-6);
            }
        }
    }
    inside.check();
    border.check();
}

#[test]
fn edges_and_corners_belong_to_the_face_that_the_normal_names() {
    let sampler = sampler(|_, _| false);
    for face in 0..6 {
        let n = frame(face)[0];
        for corner in 0..8 {
            let point = Vec3::from_array([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 }));
            // A corner of the box that lies on this face, a bit off it too, the normal tilted by 20 degrees.
            if n.dot(point) < 0.0 {
                continue;
            }
            for offset in [0.0, 0.01, -0.01] {
                let normal = n + 0.36 * frame(face)[1];
                let sample = sampler.sample(point + offset * n, normal).unwrap();
                let error = (sample.irradiance - irradiance(face, point)).abs().max_element();
                assert!(error <= BORDER_ERROR, "face {face} at {point}: {error}");
                assert!((sample.distance - f32::abs(offset)).abs() < 1e-6);
            }
        }
    }
    // Nothing lightmapped faces inwards.
    assert!(sampler.sample(Vec3::new(0.5, 0.0, 0.0), Vec3::NEG_X).is_some(), "the far face, one metre away");
    assert!(sampler.sample(Vec3::ZERO, Vec3::ZERO).is_none());
    assert!(sampler.sample(Vec3::NAN, Vec3::X).is_none());
}

#[test]
fn texels_that_were_not_baked_do_not_count_where_others_were() {
    let every_third = |x: u32, y: u32| (x + y).is_multiple_of(3);
    let sampler = sampler(every_third);
    let [n, t, b] = frame(2);
    for i in 1..40 {
        let point = 0.5 * n + (i as f32 / 40.0 - 0.5) * t + (0.3 - 0.01 * i as f32) * b;
        let sample = sampler.sample(point, n).unwrap();
        let error = (sample.irradiance - irradiance(2, point)).abs().max_element();
        // One texel, either way.
        assert!(error < 12.0 / FACE * 2.0, "{error}");
    }
}

#[test]
fn variance_is_that_of_the_weighted_mean() {
    let sampler = sampler(|_, _| false);
    let [n, t, b] = frame(0);
    // Halfway between four centres: 4 · 4 · (1/4)² = 1. On a centre: 4.
    let between = sampler.sample(0.5 * n, n).unwrap().variance.x;
    let center = sampler.sample(0.5 * n + (t + b) * (0.5 / FACE), n).unwrap().variance.x;
    assert!((between - 1.0).abs() < 1e-3 && (center - 4.0).abs() < 1e-2, "{between} {center}");
}

#[test]
fn csv_passes_columns_through_and_adds_its_own() {
    let sampler = sampler(|_, _| false);
    let input = "# a comment\nid,x,y,z,nx,ny,nz,note\n# another\n7,0.5,0,0,1,0,0,hello\n\n8,0,0.5,0,0,2,0,x\n";
    let (output, unanswered) = sample_csv(&sampler, input).unwrap();
    let lines: Vec<&str> = output.lines().collect();
    assert_eq!(unanswered, 0);
    assert_eq!(
        lines[0],
        "id,x,y,z,nx,ny,nz,note,E_r,E_g,E_b,direct_r,direct_g,direct_b,var_r,var_g,var_b,node,page,texel_x,texel_y,distance"
    );
    assert!(lines[1].starts_with("7,0.5,0,0,1,0,0,hello,101.5,50,10,"), "{}", lines[1]);
    assert!(lines[1].ends_with(",\"a, \"\"box\"\"\",0,10,10,0"), "{}", lines[1]);
    assert_eq!(lines.len(), 3);
    let error = |text: &str| sample_csv(&sampler, text).unwrap_err();
    assert_eq!(error("# only\n"), PointsError::NoHeader);
    assert!(matches!(error("a,b\n1,2\n"), PointsError::Columns { line: 1, .. }));
    assert!(matches!(error("px,py,pz,nx,ny,nz\n1,2,3\n"), PointsError::Cells { line: 2, found: 3, expected: 6 }));
    let number = error("px,py,pz,nx,ny,nz\n1,2,3,0,nan,0\n");
    assert!(matches!(number, PointsError::Number { line: 2, column: "ny", .. }), "{number}");
}
