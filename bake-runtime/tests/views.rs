//! What a viewer asks beyond the picture: texels under the cursor, parts of the light, colours for numbers, two pictures in one.

mod common;

use bake_formats::Term;
use bake_formats::glb::document as gltf;
use bake_runtime::palette::{DIVERGING, SEQUENTIAL};
use bake_runtime::scene::{PageContent, TermPages, page_charts};
use bake_runtime::{Camera, Model, Onto, Renderer, SceneData, Settings, Show};
use common::{Fixture, front, headless, picture};
use glam::{Affine3A, DVec3, Vec2, Vec3};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

fn plain() -> Settings {
    Settings { exposure: 1.0, filmic: false, ..Settings::default() }
}

/// A square with its whole page at z = 0, and one behind it that the upper right quarter of the page lights.
fn two_squares(cut: bool) -> Fixture {
    let mut fixture = Fixture::new([64, 64], [1.0; 3]);
    let hole = fixture.texture(2, 1, &[255, 255, 255, 255, 255, 255, 255, 0]);
    let front = fixture.material(|material| {
        if cut {
            material.alpha_mode = gltf::AlphaMode::Mask;
            material.pbr_metallic_roughness.base_color_texture = Some(hole);
        }
    });
    let square = fixture.square(front);
    let plain = fixture.material(|_| {});
    let back = fixture.square(plain);
    fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
    fixture.place(back, Affine3A::from_translation(Vec3::NEG_Z), Vec2::new(0.5, 0.0), Vec2::splat(0.5));
    fixture
}

#[test]
fn what_is_picked_is_the_place_that_the_texel_shows() {
    let Some(host) = headless() else { return };
    let (camera, size) = (front(2.0), [120, 80]);
    for cut in [false, true] {
        let model = Model::new(&host.device, &host.queue, two_squares(cut).load()).expect("a small scene fits");
        let mut renderer = Renderer::new(&host.device, &host.queue, FORMAT);
        let mut pick = |texel| renderer.pick(&model, &camera, &plain(), (size, texel)).expect("texels come back");
        for texel in [[60, 40], [30, 10], [89, 79], [75, 22]] {
            // At the square the picture is 3 m x 2 m wide; the one behind lies 3 m off, half as far again.
            let on_front = Vec2::new((texel[0] as f32 + 0.5) / 40.0 - 1.5, 1.0 - (texel[1] as f32 + 0.5) / 40.0);
            let through = cut && on_front.x > 0.0;
            let (node, place, z) = if through { (1, on_front * 1.5, -1.0) } else { (0, on_front, 0.0) };
            if through && place.abs().max_element() > 1.0 {
                assert_eq!(pick(texel), None, "through the hole and past the square behind");
                continue;
            }
            let hit = pick(texel).expect("a square is there");
            assert_eq!(hit.node, node, "{texel:?}");
            assert_eq!(model.scene.nodes[hit.node as usize].path, format!("node {node}"));
            let wanted = DVec3::new(place.x.into(), place.y.into(), z);
            assert!((hit.place - wanted).length() < 1e-5, "{texel:?}: {} instead of {wanted}", hit.place);
            let uv = Vec2::new(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y);
            let uv = if through { Vec2::new(0.5, 0.0) + 0.5 * uv } else { uv };
            let (page, found) = hit.page.expect("both have a lightmap");
            assert!(page == 0 && (found - uv).length() < 1e-5, "{texel:?}: {found} instead of {uv}");
            // Negative control: a neighbour is another place.
            let beside = pick([texel[0] - 1, texel[1]]).expect("the square is there too");
            assert!((beside.place - wanted).length() > 0.01);
        }
        assert_eq!(pick([2, 40]), None, "beside the squares");
        assert_eq!(pick([120, 0]), None, "beyond the picture");
    }
}

#[test]
fn terms_sum_and_are_read_as_they_are_drawn() {
    let mut fixture = two_squares(false);
    fixture.irradiance = (0..64 * 64).map(|i| [(i % 64) as f32, (i / 64) as f32, 5.0]).collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let pages = TermPages::open(&fixture.write(folder.path())).expect("a package that was just written");
    let sum = |terms: &[Term]| pages.texels(0, &PageContent::Terms(terms.to_vec()));
    assert_eq!(sum(&Term::ALL), fixture.irradiance);
    assert_eq!(sum(&[Term::Direct])[64 + 3], [2.25, 0.75, 3.75]);
    assert_eq!(sum(&[])[64 + 3], [0.0; 3]);
    let error = pages.texels(0, &PageContent::RelativeError)[64 + 3][0];
    assert!((error - 0.1 * (9.0f32 + 1.0 + 25.0).sqrt() / 9.0 * 3f32.sqrt()).abs() < 1e-3, "{error}");
    let valid = pages.texels(0, &PageContent::Validity);
    assert_eq!((valid[0], valid[64 * 64 - 1]), ([1.0; 3], [0.0; 3]));

    // A texel's middle is the texel; half way to the next one is the mean.
    let reading = pages.read(0, Vec2::new(3.5, 1.5) / 64.0).expect("on the page");
    assert_eq!((reading.texel, reading.irradiance, reading.valid), ([3, 1], Vec3::new(3.0, 1.0, 5.0), true));
    assert_eq!(reading.terms[1], (Term::Indirect, Vec3::new(0.75, 0.25, 1.25)));
    assert!((reading.standard_error - Vec3::new(0.3, 0.1, 0.5)).length() < 1e-6);
    let between = pages.read(0, Vec2::new(4.0, 1.5) / 64.0).expect("on the page");
    assert_eq!(between.irradiance, Vec3::new(3.5, 1.0, 5.0));
    assert!(!pages.read(0, Vec2::splat(1.0)).expect("the last corner").valid);
    assert_eq!(pages.read(0, Vec2::new(1.1, 0.5)), None);
    assert_eq!(pages.read(1, Vec2::splat(0.5)), None);
}

#[test]
fn pages_take_other_light_without_a_new_model() {
    let Some(host) = headless() else { return };
    let model = Model::new(&host.device, &host.queue, two_squares(false).load()).expect("a small scene fits");
    let mut renderer = Renderer::new(&host.device, &host.queue, FORMAT);
    let view = host.target([32, 32], FORMAT).create_view(&Default::default());
    let mut middle = || {
        renderer.draw(&model, &front(2.0), &plain(), &view, [32, 32]);
        common::radiance(&host, &renderer)[16 * 32 + 16][1]
    };
    let before = middle();
    model.set_irradiance(&host.queue, 0, &[[3.0; 3]; 64 * 64]);
    let after = middle();
    assert!((after / before - 3.0).abs() < 1e-5, "{before} {after}");
}

#[test]
fn densities_and_charts_have_their_colours() {
    let Some(host) = headless() else { return };
    let fixture = two_squares(false);
    let scene = || SceneData { dynamic_lights: Vec::new(), ..fixture.load() };
    let camera = common::front(2.0);
    // 64 texels over 2 m: the fifth octave. The squares of the pattern have the colour, or 0.4 of it.
    let settings = Settings { show: Show::Density, ..plain() };
    let (pixels, _) = picture(&host, scene(), &camera, &settings, [256, 256]);
    let wanted = SEQUENTIAL.color(5.0 / (SEQUENTIAL.len() - 1) as f32);
    let close = |pixel: &[f32; 3], wanted: Vec3| (Vec3::from(*pixel) - wanted).length() < 1e-3;
    let bright = pixels.iter().filter(|pixel| close(pixel, wanted)).count();
    let dark = pixels.iter().filter(|pixel| close(pixel, 0.4 * wanted)).count();
    assert_eq!(bright + dark, 256 * 256, "all have the colour of 32 texels a metre");
    assert!(bright.abs_diff(dark) < 4000, "{bright} {dark}");
    assert!(!close(&pixels[0], SEQUENTIAL.color(0.5)), "16 texels a metre look the same");

    let folder = tempfile::tempdir().expect("a temporary folder");
    let package = fixture.write(folder.path());
    let scene = SceneData::load(&package).expect("a package that was just written");
    let charts = page_charts(&package, &scene.instances).expect("a package that was just written");
    assert_eq!(charts, [0, 0, 0, 0, 1, 1, 1, 1]);
    let mut model = Model::new(&host.device, &host.queue, scene).expect("a small scene fits");
    let mut renderer = Renderer::new(&host.device, &host.queue, FORMAT);
    let view = host.target([64, 64], FORMAT).create_view(&Default::default());
    let mut colors = |model: &Model| {
        // From aside, so that the square behind shows beside the one in front.
        let camera = Camera::look_at(DVec3::new(3.0, 0.0, 6.0), DVec3::ZERO);
        renderer.draw(model, &camera, &Settings { show: Show::Charts, ..plain() }, &view, [64, 64]);
        let mut seen = common::radiance(&host, &renderer);
        seen.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        seen.dedup();
        seen
    };
    assert_eq!(colors(&model), [[0.0; 3], [0.2; 3]], "grey while charts are unknown");
    model.set_charts(&host.device, &charts);
    assert_eq!(colors(&model).len(), 3, "two charts and nothing");
}

#[test]
fn columns_are_drawn_apart_and_differences_have_their_colours() {
    let Some(host) = headless() else { return };
    let size = [64, 48];
    let model = |light: f32| {
        let mut fixture = Fixture::new([4, 4], [light; 3]);
        let material = fixture.material(|m| m.pbr_metallic_roughness.base_color_factor = [1.0; 4]);
        let square = fixture.square(material);
        fixture.place(square, Affine3A::IDENTITY, Vec2::ZERO, Vec2::ONE);
        Model::new(&host.device, &host.queue, fixture.load()).expect("a small scene fits")
    };
    let models = [model(std::f32::consts::PI), model(1.5 * std::f32::consts::PI)];
    let mut renderers = [(); 2].map(|()| Renderer::new(&host.device, &host.queue, FORMAT));
    let target = host.target(size, FORMAT);
    let view = target.create_view(&Default::default());
    let settings = Settings { exposure: 0.5, ..plain() };
    let mut whole = || -> Vec<Vec<u8>> {
        let pairs = renderers.iter_mut().zip(&models);
        let draw = |(renderer, model): (&mut Renderer, &Model)| {
            renderer.draw(model, &front(2.0), &settings, &view, size);
            host.read_texture(&target).expect("bytes come back")
        };
        pairs.map(draw).collect()
    };
    let pictures = whole();
    let mut draw = |side: usize, columns| {
        let onto = Onto { view: &view, size, columns };
        renderers[side].draw_columns(&models[side], &front(2.0), &settings, &onto);
    };
    draw(0, 0..20);
    draw(1, 20..64);
    let both = host.read_texture(&target).expect("bytes come back");
    for (at, byte) in both.iter().enumerate() {
        let column = at / 4 % 64;
        assert_eq!(*byte, pictures[usize::from(column >= 20)][at], "byte {at}, column {column}");
    }

    // 0.5 cd/m² more, of 1 that has the strongest colour; the other way round as much less.
    renderers.iter_mut().zip(&models).for_each(|(r, model)| r.draw(model, &front(2.0), &settings, &view, size));
    let [left, right] = &mut renderers;
    for (more, wanted) in [(true, 0.75), (false, 0.25)] {
        let (a, b) = if more { (&mut *left, &*right) } else { (&mut *right, &*left) };
        a.draw_difference(b, 1.0, &view);
        let bytes = host.read_texture(&target).expect("bytes come back");
        let middle = &bytes[4 * (24 * 64 + 32)..][..3];
        let srgb = |c: f32| (1.055 * c.powf(1.0 / 2.4) - 0.055) * 255.0;
        let wanted = DIVERGING.color(wanted).to_array().map(srgb);
        let far = middle.iter().zip(wanted).map(|(byte, want)| (f32::from(*byte) - want).abs()).fold(0.0, f32::max);
        assert!(far < 1.0, "{middle:?} instead of {wanted:?}");
    }
}
