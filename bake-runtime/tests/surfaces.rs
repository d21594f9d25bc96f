//! Surfaces: lightmaps to f32's own precision, instances, mirrors, cut and blended opacity, emission, tone curve.

mod common;

use bake_formats::glb::document as gltf;
use bake_formats::manifest::{LightKind, LightRecord};
use bake_runtime::scene::Texture;
use bake_runtime::{Model, Renderer, Settings};
use common::{Fixture, front, headless, picture};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::PI;
use testkit::compare::Worst;

const SIZE: [u32; 2] = [64, 64];

fn plain() -> Settings {
    Settings { exposure: 1.0, filmic: false, ..Settings::default() }
}

/// Place on the square z = 0 that a texel of `front(2)` sees.
fn seen(index: usize) -> Vec2 {
    let (x, y) = (index % SIZE[0] as usize, index / SIZE[0] as usize);
    let share = |at: usize, side: u32| (2.0 * at as f32 + 1.0) / side as f32 - 1.0;
    Vec2::new(share(x, SIZE[0]), -share(y, SIZE[1]))
}

fn at(pixels: &[[f32; 3]], place: Vec2) -> [f32; 3] {
    let x = ((place.x * 0.5 + 0.5) * SIZE[0] as f32) as usize;
    let y = ((0.5 - place.y * 0.5) * SIZE[1] as f32) as usize;
    pixels[y * SIZE[0] as usize + x]
}

#[test]
fn a_lightmap_is_interpolated_bilinearly_and_reflected_as_lambert_says() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([8, 8], [0.0; 3]);
    let value = |x: usize, y: usize| [(x * x) as f32, (3 * y + x) as f32, 1.0 + (x * y) as f32];
    fixture.irradiance = (0..64).map(|i| value(i % 8, i / 8)).collect();
    let material = fixture.material(|m| m.pbr_metallic_roughness.base_color_factor = [0.8, 0.5, 0.25, 1.0]);
    let square = fixture.square(material);
    fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
    let (pixels, _) = picture(&headless, fixture.load(), &front(2.0), &plain(), SIZE);

    let expected = |place: Vec2| {
        let texel = Vec2::new(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y) * 8.0 - 0.5;
        let (low, share) = (texel.floor(), texel - texel.floor());
        let corner = |dx: f32, dy: f32| {
            let at = (low + Vec2::new(dx, dy)).clamp(Vec2::ZERO, Vec2::splat(7.0));
            Vec3::from(value(at.x as usize, at.y as usize))
        };
        let row = |dy: f32| corner(0.0, dy) * (1.0 - share.x) + corner(1.0, dy) * share.x;
        (row(0.0) * (1.0 - share.y) + row(1.0) * share.y) * Vec3::new(0.8, 0.5, 0.25) / PI
    };
    // A sampler's eight-bit weights would leave 1/256 of a texel's difference, 0.004 and more.
    let mut worst = Worst::new("lightmap radiance (absolute, of values up to 12)", 5e-4);
    for (index, pixel) in pixels.iter().enumerate() {
        let want = expected(seen(index));
        (0..3)
            .for_each(|c| worst.record((pixel[c] - want[c]).abs().into(), || format!("{:?} channel {c}", seen(index))));
    }
    worst.check();
}

#[test]
fn instances_of_one_shape_keep_their_own_light() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([8, 4], [0.0; 3]);
    fixture.irradiance = (0..32).map(|i| if i % 8 < 4 { [PI, 0.0, 0.0] } else { [0.0, 2.0 * PI, 0.0] }).collect();
    let material = fixture.material(|_| {});
    let square = fixture.square(material);
    let half =
        |x: f32| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)) * Affine3A::from_scale(Vec3::new(0.5, 1.0, 1.0));
    fixture.place(square, half(-0.5), Vec2::ZERO, Vec2::new(0.375, 1.0));
    fixture.place(square, half(0.5), Vec2::new(0.625, 0.0), Vec2::new(0.375, 1.0));
    let scene = fixture.load();
    assert_eq!((scene.draws.len(), scene.draws[0].instances.clone()), (1, 0..2), "one draw of two instances");
    let (pixels, _) = picture(&headless, scene, &front(2.0), &plain(), SIZE);
    let close = |got: [f32; 3], want: [f32; 3]| Vec3::from(got).abs_diff_eq(want.into(), 1e-5);
    assert!(close(at(&pixels, Vec2::new(-0.5, 0.0)), [0.5, 0.0, 0.0]), "{:?}", at(&pixels, Vec2::new(-0.5, 0.0)));
    assert!(close(at(&pixels, Vec2::new(0.5, 0.0)), [0.0, 1.0, 0.0]), "{:?}", at(&pixels, Vec2::new(0.5, 0.0)));
}

#[test]
fn mirrored_nodes_keep_their_front_and_single_sided_ones_hide_their_back() {
    let Some(headless) = headless() else { return };
    // Left: mirrored in x, right: turned away by a mirror in z, far right nothing.
    let mut fixture = Fixture::new([4, 4], [PI; 3]);
    let material = fixture.material(|_| {});
    let square = fixture.square(material);
    let place = |x: f32, scale: Vec3| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)) * Affine3A::from_scale(scale);
    fixture.place(square, place(-0.5, Vec3::new(-0.4, 1.0, 1.0)), Vec2::ZERO, Vec2::ONE);
    fixture.place(square, place(0.5, Vec3::new(0.4, 1.0, -1.0)), Vec2::ZERO, Vec2::ONE);
    let (pixels, _) = picture(&headless, fixture.load(), &front(2.0), &plain(), SIZE);
    assert!((at(&pixels, Vec2::new(-0.5, 0.0))[0] - 0.5).abs() < 1e-5, "the mirrored front is seen");
    assert_eq!(at(&pixels, Vec2::new(0.5, 0.0)), [0.0; 3], "a back is not");
}

#[test]
fn opacity_cuts_and_blends_over_what_lies_behind() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([4, 4], [PI; 3]);
    let wall = fixture.material(|m| m.pbr_metallic_roughness.base_color_factor = [0.25, 0.25, 0.25, 1.0]);
    // Two texels: opaque left, a quarter opaque right.
    let info = fixture.texture(2, 1, &[255, 255, 255, 255, 255, 255, 255, 64]);
    let cut = fixture.material(|m| {
        m.alpha_mode = gltf::AlphaMode::Mask;
        m.alpha_cutoff = Some(0.5);
        m.pbr_metallic_roughness.base_color_factor = [0.75, 0.75, 0.75, 1.0];
        m.pbr_metallic_roughness.base_color_texture = Some(info);
    });
    let glass = fixture.material(|m| {
        m.alpha_mode = gltf::AlphaMode::Blend;
        m.pbr_metallic_roughness.base_color_factor = [1.0, 0.0, 0.0, 0.5];
    });
    let shapes = [wall, cut, glass].map(|material| fixture.square(material));
    // The pane is placed first and drawn last.
    let pane = |y: f32, z: f32| {
        Affine3A::from_translation(Vec3::new(0.0, y, z)) * Affine3A::from_scale(Vec3::new(1.0, 0.5, 1.0))
    };
    fixture.place(shapes[2], pane(0.5, 0.1), Vec2::ZERO, Vec2::ONE);
    fixture.place(shapes[1], pane(-0.5, 0.1), Vec2::ZERO, Vec2::ONE);
    fixture.place(shapes[0], Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
    let (pixels, _) = picture(&headless, fixture.load(), &front(2.0), &plain(), SIZE);
    let close = |place: Vec2, want: [f32; 3]| {
        let got = at(&pixels, place);
        assert!(Vec3::from(got).abs_diff_eq(want.into(), 1e-5), "{place}: {got:?}, not {want:?}");
    };
    close(Vec2::new(-0.5, -0.4), [0.75; 3]);
    close(Vec2::new(0.5, -0.4), [0.25; 3]);
    close(Vec2::new(0.0, 0.4), [0.625, 0.125, 0.125]);
}

#[test]
fn a_normal_map_bends_baked_light_where_the_package_has_harmonics() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([2, 2], [PI; 3]);
    let constant = |value: f32| vec![[value; 3]; 4];
    // More light from above (y) and from the front (z): e(n) = 0.886227 + 1.023328 (0.4 n_y + 0.5 n_z).
    fixture.sh1 = Some(vec![constant(1.0), constant(0.4), constant(0.5), constant(0.0)]);
    let material = fixture.material(|_| {});
    let square = fixture.square(material);
    fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
    let mut scene = fixture.load();
    let (flat, _) = picture(&headless, scene.clone(), &front(2.0), &plain(), SIZE);
    assert!((at(&flat, Vec2::ZERO)[0] - 0.5).abs() < 1e-6, "without a map the light is the page's");
    // The normal (0, 0.6, 0.8): up in the texture is up in the world here.
    let sampler = gltf::Sampler { mag_filter: 9728, min_filter: 9728, wrap_s: 33071, wrap_t: 33071 };
    let rgba = [127.5, 127.5 + 0.6 * 127.5, 127.5 + 0.8 * 127.5, 255.0].map(|v: f32| v.round() as u8).to_vec();
    scene.textures.push(Texture { width: 1, height: 1, rgba: rgba.clone(), sampler, linear: true });
    scene.materials[0].normal_texture = Some(0);
    let (bent, _) = picture(&headless, scene, &front(2.0), &plain(), SIZE);
    let stored = Vec3::new(rgba[0].into(), rgba[1].into(), rgba[2].into()) / 127.5 - 1.0;
    let e = |n: Vec3| 0.886_227 + 1.023_328 * (0.4 * n.y + 0.5 * n.z);
    let want = 0.5 * e(stored.normalize()) / e(Vec3::Z);
    let got = at(&bent, Vec2::ZERO)[0];
    assert!((got / want - 1.0).abs() < 1e-4, "{got}, not {want}");
}

#[test]
fn passes_are_timed_where_the_device_can() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([2, 2], [PI; 3]);
    let material = fixture.material(|_| {});
    let square = fixture.square(material);
    fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
    let mut model = Model::new(&headless.device, &headless.queue, fixture.load()).expect("small");
    let kind = LightKind::Point { position: Vec3::Z, radius: 0.001, range: None, profile: None };
    model.scene.dynamic_lights = vec![LightRecord { path: "lamp".into(), color: Vec3::ONE, kind }];
    let mut renderer = Renderer::new(&headless.device, &headless.queue, wgpu::TextureFormat::Rgba8Unorm);
    let target = headless.target(SIZE, wgpu::TextureFormat::Rgba8Unorm).create_view(&Default::default());
    for (timed, shadow_size) in [(false, None), (true, None), (true, Some(64))] {
        renderer.draw(&model, &front(2.0), &Settings { timed, shadow_size, ..plain() }, &target, SIZE);
        let able = headless.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let Some(times) = renderer.milliseconds() else {
            assert!(!timed || !able, "timed in vain");
            continue;
        };
        let times = times.expect("timestamps come back");
        // The lamp's six maps count as one.
        let names: Vec<_> = times.iter().map(|(name, _)| *name).collect();
        assert_eq!(
            names,
            if shadow_size.is_some() { vec!["shadows", "surfaces", "tone"] } else { vec!["surfaces", "tone"] }
        );
        assert!(times.iter().all(|(_, ms)| ms.is_finite() && *ms >= 0.0), "{times:?}");
    }
}

#[test]
fn emission_adds_and_the_curve_comes_last() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([4, 4], [PI; 3]);
    let material = fixture.material(|m| m.emissive_factor = Some([0.5, 1.0, 0.25]));
    let square = fixture.square(material);
    fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
    let settings = Settings { exposure: 0.5, filmic: true, ..Settings::default() };
    let (pixels, display) = picture(&headless, fixture.load(), &front(2.0), &settings, SIZE);
    assert!(Vec3::from(at(&pixels, Vec2::ZERO)).abs_diff_eq(Vec3::new(1.0, 1.5, 0.75), 1e-5));
    // Narkowicz 2016, then IEC 61966-2-1, in f64.
    let display_of = |radiance: f64| {
        let x = 0.5 * radiance;
        let y = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
        255.0 * (1.055 * y.powf(1.0 / 2.4) - 0.055)
    };
    for (channel, radiance) in [1.0, 1.5, 0.75].into_iter().enumerate() {
        let got = f64::from(display[channel]);
        assert!((got - display_of(radiance)).abs() < 1.0, "channel {channel}: {got}, not {}", display_of(radiance));
    }
}

#[test]
fn emission_textures_glow_where_they_are_bright_and_as_strong_as_the_material_says() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([4, 4], [0.0; 3]);
    // Left half red, right half half-bright in sRGB; turned upside down and mirrored on the second square.
    let glow = fixture.texture(2, 1, &[255, 0, 0, 255, 188, 188, 188, 255]);
    let mirrored = gltf::TextureInfo {
        extensions: Some(gltf::TextureInfoExtensions {
            transform: gltf::TextureTransform { offset: [1.0, 1.0], rotation: PI, scale: [1.0, 1.0] },
        }),
        ..glow.clone()
    };
    for (info, left_is_red) in [(glow, true), (mirrored, false)] {
        let material = fixture.material(|m| {
            m.emissive_factor = Some([1.0, 0.5, 0.25]);
            m.emissive_texture = Some(info);
            m.extensions.emissive_strength = Some(gltf::EmissiveStrength { emissive_strength: 20.0 });
        });
        let square = fixture.square(material);
        fixture.scene.nodes.clear();
        fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
        let (pixels, _) = picture(&headless, fixture.load(), &front(2.0), &plain(), SIZE);
        let red = Vec3::new(20.0, 0.0, 0.0);
        // 188 of 255 is 0.5029 in linear light (IEC 61966-2-1).
        let grey = Vec3::new(20.0, 10.0, 5.0) * 0.5029;
        let (left, right) = if left_is_red { (red, grey) } else { (grey, red) };
        for (place, want) in [(Vec2::new(-0.5, 0.3), left), (Vec2::new(0.5, -0.3), right)] {
            let got = Vec3::from(at(&pixels, place));
            assert!((got - want).length() < 0.01 * want.length(), "{place}: {got}, not {want}");
        }
    }
}
