//! Lights that were not baked, their shadows, light shafts, and light stored in space.

mod common;

use bake_formats::manifest::{EnvironmentRecord, LightKind, LightRecord, ProfileRecord};
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use bake_optics::surface::scattered_irradiance;
use bake_runtime::air::AirSettings;
use bake_runtime::scene::LatticeData;
use bake_runtime::sky::SkyPicture;
use bake_runtime::{Camera, Headless, Method, SceneData, Settings};
use common::{Fixture, front, headless, picture};
use glam::{Affine3A, DVec3, Vec2, Vec3};
use std::f32::consts::PI;
use testkit::compare::Worst;

const SIZE: [u32; 2] = [32, 32];

fn lamp(position: Vec3) -> LightRecord {
    let kind = LightKind::Point { position, radius: 0.001, range: None, profile: None };
    LightRecord { path: "lamp".into(), color: Vec3::new(10.0, 20.0, 30.0), kind }
}

fn air(sigma_s: f64, sigma_a: f64) -> Medium {
    let bounds = Bounds::Box { min: DVec3::splat(-50.0), max: DVec3::splat(50.0) };
    let scatter = Scatter { sigma_s: [sigma_s; 3], sigma_a: [sigma_a; 3] };
    Medium { bounds, density: Density::Uniform, scatter, phase: Phase::Isotropic }
}

/// A wall of a given grey at z = 0 without baked light.
fn wall(grey: f32) -> SceneData {
    let mut fixture = Fixture::new([2, 2], [0.0; 3]);
    let material = fixture.material(|m| m.pbr_metallic_roughness.base_color_factor = [grey, grey, grey, 1.0]);
    let square = fixture.square(material);
    fixture.place(square, Affine3A::from_scale(Vec3::splat(2.0)), Vec2::ZERO, Vec2::ONE);
    fixture.load()
}

/// Place on the wall that a pixel of `front(2)` sees.
fn seen(index: usize) -> DVec3 {
    let share = |at: usize| (2.0 * at as f64 + 1.0) / 32.0 - 1.0;
    DVec3::new(share(index % 32), -share(index / 32), 0.0)
}

fn plain() -> Settings {
    Settings { filmic: false, ..Settings::default() }
}

/// A photometric profile, 1 + c/2 + (3c² - 1)/8 about its axis: Legendre coefficients 1, 1/2, 1/4.
#[test]
fn a_measured_lamp_that_was_not_baked_lights_a_wall_by_its_profile() {
    let Some(headless) = headless() else { return };
    let (position, axis) = (DVec3::new(0.25, 0.5, 1.0), DVec3::new(0.6, 0.0, -0.8));
    let profile = Some(ProfileRecord { axis: axis.as_vec3(), legendre: vec![1.0, 0.5, 0.25] });
    let kind = LightKind::Point { position: position.as_vec3(), radius: 0.001, range: None, profile };
    let light = LightRecord { kind, ..lamp(position.as_vec3()) };
    let scene = SceneData { dynamic_lights: vec![light], ..wall(0.6) };
    let (pixels, _) = picture(&headless, scene, &front(2.0), &plain(), SIZE);
    let mut worst = Worst::new("a measured lamp on a wall", 1e-5);
    let mut even = Worst::new("as if it shone alike in all directions (negative control)", 1e-5);
    for (index, pixel) in pixels.iter().enumerate() {
        let offset = position - seen(index);
        let cosine = axis.dot(-offset.normalize());
        let share = 1.0 + 0.5 * cosine + 0.125 * (3.0 * cosine * cosine - 1.0);
        let lambert = 0.6 / f64::from(PI) * 10.0 * offset.z / offset.length().powi(3);
        worst.relative(pixel[0].into(), share * lambert, || format!("pixel {index}"));
        even.relative(pixel[0].into(), lambert, String::new);
    }
    worst.check();
    assert!(!even.holds(), "{:.2e}", even.measured());
}

#[test]
fn a_lamp_that_was_not_baked_lights_a_wall_as_lambert_says() {
    let Some(headless) = headless() else { return };
    let position = DVec3::new(0.25, 0.5, 1.0);
    let scene = SceneData { dynamic_lights: vec![lamp(position.as_vec3())], ..wall(0.6) };
    let (pixels, _) = picture(&headless, scene, &front(2.0), &plain(), SIZE);
    let mut worst = Worst::new("a lamp on a wall", 1e-5);
    for (index, pixel) in pixels.iter().enumerate() {
        let offset = position - seen(index);
        let want = 0.6 / f64::from(PI) * 10.0 * offset.z / offset.length().powi(3);
        worst.relative(pixel[0].into(), want, || format!("pixel {index}"));
    }
    worst.check();
}

#[test]
fn air_weakens_and_softens_a_lamps_light_on_a_wall() {
    let Some(headless) = headless() else { return };
    let position = DVec3::new(0.25, 0.5, 1.0);
    let (sigma_s, sigma_t) = (0.5, 0.6);
    let draw = |grey| {
        let scene =
            SceneData { dynamic_lights: vec![lamp(position.as_vec3())], media: vec![air(sigma_s, 0.1)], ..wall(grey) };
        picture(&headless, scene, &front(2.0), &plain(), SIZE).0
    };
    // What a black wall shows is the air in front; the rest is the wall's.
    let (grey, black) = (draw(0.6), draw(0.0));
    let mut worst = Worst::new("a lamp on a wall in air", 3e-3);
    let mut unsoftened = Worst::new("without what the air sends to the wall (negative control)", 3e-3);
    for index in 0..grey.len() {
        let (place, eye) = (seen(index), DVec3::new(0.0, 0.0, 2.0));
        let offset = position - place;
        let (away, cosine) = (offset.length(), offset.z / offset.length());
        let direct = (-sigma_t * away).exp() * cosine / (away * away);
        let softened = scattered_irradiance(sigma_s, sigma_t, away, cosine.acos());
        let want =
            |irradiance: f64| 0.6 / f64::from(PI) * 20.0 * irradiance * (-sigma_t * (eye - place).length()).exp();
        let got = f64::from(grey[index][1] - black[index][1]);
        worst.relative(got, want(direct + softened), || format!("pixel {index}"));
        unsoftened.relative(got, want(direct), || format!("pixel {index}"));
    }
    worst.check();
    assert!(!unsoftened.holds());
}

/// A wall, and in front of it a plate that hides the lamp from its right half.
fn plated() -> SceneData {
    let mut fixture = Fixture::new([2, 2], [0.0; 3]);
    let material = fixture.material(|m| m.double_sided = true);
    let square = fixture.square(material);
    fixture.place(square, Affine3A::from_scale(Vec3::splat(4.0)), Vec2::ZERO, Vec2::ONE);
    // In the plane z = 1, from x = 0.5 to 1.5: as seen from the lamp it covers x from 1 to 3 of the wall.
    let plate = Affine3A::from_translation(Vec3::new(1.0, 0.0, 1.0)) * Affine3A::from_scale(Vec3::new(0.5, 4.0, 1.0));
    fixture.place(square, plate, Vec2::ZERO, Vec2::ONE);
    fixture.load()
}

#[test]
fn a_plate_throws_its_shadow_on_the_wall_behind_it() {
    let Some(headless) = headless() else { return };
    let scene = SceneData { dynamic_lights: vec![lamp(Vec3::new(0.0, 0.0, 2.0))], ..plated() };
    // From below the plate: x of the wall from −2 to 2 at y = −1.
    let mut camera = front(2.0);
    camera.eye = DVec3::new(0.0, 0.0, 0.9);
    camera.fov_y = 2.0 * 1.5f32.atan();
    let lit = Settings { shadow_size: Some(512), ..plain() };
    let (shadowed, _) = picture(&headless, scene.clone(), &camera, &lit, SIZE);
    let (open, _) = picture(&headless, scene, &camera, &plain(), SIZE);
    let row = 16 * 32;
    for column in 0..32 {
        let x = 0.9 * 1.5 * ((2.0 * column as f32 + 1.0) / 32.0 - 1.0);
        let (with, without) = (shadowed[row + column][0], open[row + column][0]);
        if (x - 1.0).abs() > 0.1 {
            let want = if x > 1.0 { 0.0 } else { without };
            assert!((with - want).abs() <= 1e-5 * without, "x {x}: {with}, not {want}");
        }
    }
}

#[test]
fn light_shafts_by_lit_intervals_beat_marching_at_equal_cost() {
    let Some(headless) = headless() else { return };
    let sun = LightKind::Directional { direction: Vec3::new(0.25, 0.0, -1.0).normalize(), angular_radius: 0.0 };
    let sun = LightRecord { kind: sun, ..lamp(Vec3::ZERO) };
    for (name, light) in [("lamp", lamp(Vec3::new(0.0, 0.0, 2.0))), ("sun", sun)] {
        shafts(&headless, name, SceneData { lights: vec![light], media: vec![air(0.2, 0.05)], ..plated() });
    }
}

fn shafts(headless: &Headless, name: &str, scene: SceneData) {
    let mut camera = front(2.0);
    camera.eye = DVec3::new(-3.0, 0.0, 1.5);
    camera.forward = Vec3::new(1.0, 0.0, -0.25).normalize();
    let draw = |air: AirSettings, shadows: bool| {
        let settings = Settings { air, shadow_size: shadows.then_some(512), ..plain() };
        picture(headless, scene.clone(), &camera, &settings, SIZE).0
    };
    let march = |steps| AirSettings { method: Method::RayMarch, steps, ..AirSettings::default() };
    let truth = draw(march(4096), true);
    let mean = truth.iter().map(|p| f64::from(p[0])).sum::<f64>() / truth.len() as f64;
    let error = |pixels: &[[f32; 3]]| {
        let square = pixels.iter().zip(&truth).map(|(a, b)| (f64::from(a[0] - b[0]) / mean).powi(2)).sum::<f64>();
        (square / truth.len() as f64).sqrt()
    };
    // 32 look-ups, a border's 6 and twice 16 nodes on two or three intervals: some 100 evaluations.
    let (intervals, marched) = (error(&draw(AirSettings::default(), true)), error(&draw(march(100), true)));
    let unshadowed = error(&draw(AirSettings::default(), false));
    println!(
        "{name}, RMS error of the mean: intervals {intervals:.2e}, 100 steps {marched:.2e}, without shadows {unshadowed:.2e}"
    );
    assert!(unshadowed > 20.0 * intervals, "the plate must matter: {unshadowed}");
    assert!(intervals < 0.1 * marched && intervals < 2e-3, "{intervals:.2e} against {marched:.2e}");
}

#[test]
fn the_sky_glows_through_a_stated_distance_of_air() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([2, 2], [0.0; 3]);
    fixture.material(|_| {});
    let mean_radiance = Vec3::new(100.0, 200.0, 300.0);
    fixture.edit = Box::new(move |manifest| {
        manifest.environment = Some(EnvironmentRecord { size: [1, 1], rotation: 0.0, mean_radiance, file: None });
    });
    let scene = SceneData { media: vec![air(0.02, 0.005)], ..fixture.load() };
    let draw = |sky_distance_m| {
        let settings = Settings { air: AirSettings { sky_distance_m, ..AirSettings::default() }, ..plain() };
        picture(&headless, scene.clone(), &front(2.0), &settings, SIZE).0[16 * 32 + 16]
    };
    // Unstated: what is left behind the air's own extent, 52 m straight ahead, and no glow.
    let extent = 200.0 * (-0.025f32 * 52.0).exp();
    assert!((draw(None)[1] / extent - 1.0).abs() < 1e-3, "{:?}, not {extent}", draw(None));
    let t = 0.025 * 80.0;
    let glow = bake_optics::psf::convolution_factors::<f64>(t, 1)[0] * 0.8;
    let want = 200.0 * ((-t).exp() + glow);
    assert!((f64::from(draw(Some(80))[1]) / want - 1.0).abs() < 1e-5, "{:?}, not {want}", draw(Some(80)));
    assert!(glow > 0.1 * (-t).exp(), "the glow is what is tested: {glow}");
}

#[test]
fn the_environments_picture_stands_where_its_directions_say() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([2, 2], [0.0; 3]);
    fixture.material(|_| {});
    let (width, height, rotation) = (8, 4, 0.5f32);
    let radiance: Vec<[f32; 3]> = (0..32).map(|i| [1.0 + i as f32, 40.0 - i as f32, 2.0]).collect();
    let sky = SkyPicture { width, height, radiance: radiance.clone(), rotation };
    let scene = SceneData { sky: Some(sky), ..fixture.load() };
    let view = |texel: u32| {
        let azimuth = 2.0 * PI * ((texel % width) as f32 + 0.5) / width as f32 + rotation;
        let polar = PI * ((texel / width) as f32 + 0.5) / height as f32;
        // From −Z towards +X, from +Y down.
        let dir = Vec3::new(polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos());
        Camera { fov_y: 1e-3, ..Camera::look_at(DVec3::ZERO, dir.as_dvec3()) }
    };
    let see = |camera: &Camera, scene: &SceneData, sky_distance_m| {
        let settings = Settings { air: AirSettings { sky_distance_m, ..AirSettings::default() }, ..plain() };
        picture(&headless, scene.clone(), camera, &settings, [2, 2]).0[0]
    };
    for texel in [0, 7, 8, 13, 22, 31] {
        let (got, want) = (see(&view(texel), &scene, None), radiance[texel as usize]);
        (0..3).for_each(|c| assert!((got[c] / want[c] - 1.0).abs() < 0.01, "texel {texel}: {got:?}, not {want:?}"));
        // Negative control: the texel beside is another colour.
        assert!((got[0] / radiance[(texel as usize + 1) % 32][0] - 1.0).abs() > 0.02);
    }
    // Through air that only takes away, all is darker alike; through air that scatters, what is dark glows.
    let fogged = |sigma_s, sigma_a| SceneData { media: vec![air(sigma_s, sigma_a)], ..scene.clone() };
    let (dark, bright) = (view(0), view(31));
    let t = 0.02f32 * 50.0;
    for camera in [&dark, &bright] {
        let (plain, dimmed) = (see(camera, &scene, None), see(camera, &fogged(0.0, 0.02), Some(50)));
        assert!((dimmed[0] / (plain[0] * (-t).exp()) - 1.0).abs() < 1e-4, "{dimmed:?} of {plain:?}");
        let hazy = see(camera, &fogged(0.02, 0.0), Some(50));
        assert!(hazy[0] > dimmed[0] + 0.2 * (1.0 - (-t).exp()), "{hazy:?} of {dimmed:?}");
    }
    let contrast =
        |sigma_s| see(&bright, &fogged(sigma_s, 0.0), Some(50))[0] / see(&dark, &fogged(sigma_s, 0.0), Some(50))[0];
    assert!(contrast(0.04) < 0.8 * contrast(0.001), "haze takes contrast away: {} {}", contrast(0.04), contrast(0.001));
}

/// A lattice around the origin in which light L comes from everywhere, and more of it from above.
fn lattice(even: f32, above: f32) -> LatticeData {
    let constant = |value: f32| vec![[value, 2.0 * value, 0.0, 1.0]; 27];
    let mut harmonics = vec![constant(0.0); 9];
    harmonics[0] = constant(even * (4.0 * PI).sqrt());
    harmonics[1] = constant(above);
    LatticeData { origin: Vec3::splat(-5.0), spacing: Vec3::splat(5.0), count: [3, 3, 3], harmonics }
}

#[test]
fn probes_light_what_has_no_lightmap() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([2, 2], [100.0; 3]);
    let material = fixture.material(|_| {});
    let square = fixture.square(material);
    fixture.place(square, Affine3A::from_rotation_x(-0.5), Vec2::ZERO, Vec2::ONE);
    fixture.scene.nodes[0].lightmap = None;
    fixture.edit = Box::new(|manifest| manifest.instances.clear());
    let scene = SceneData { probes: Some(lattice(3.0, 2.0)), ..fixture.load() };
    assert_eq!(scene.draws[0].page, None);
    let (pixels, _) = picture(&headless, scene, &front(2.0), &plain(), SIZE);
    // E = pi L + (2 pi/3) c_1 Y_1(n), n_y = sin 0.5.
    let irradiance = PI * 3.0 + 2.0 * PI / 3.0 * 2.0 * 0.488_602_5 * 0.5f32.sin();
    let (got, want) = (pixels[16 * 32 + 16], 0.5 / PI * irradiance);
    assert!((got[0] / want - 1.0).abs() < 1e-5 && (got[1] / want - 2.0).abs() < 1e-5, "{got:?}, not {want}");
}

#[test]
fn light_stored_in_space_lights_the_air() {
    let Some(headless) = headless() else { return };
    let media = vec![air(0.3, 0.1)];
    let scene = SceneData { air_light: Some(lattice(3.0, 0.0)), media, ..wall(0.0) };
    let (pixels, _) = picture(&headless, scene.clone(), &front(2.0), &plain(), SIZE);
    let mut worst = Worst::new("air in even light", 1e-3);
    for (index, pixel) in pixels.iter().enumerate() {
        let away = (seen(index) - DVec3::new(0.0, 0.0, 2.0)).length();
        worst.relative(pixel[0].into(), 0.3 / 0.4 * 3.0 * (1.0 - (-0.4 * away).exp()), || format!("pixel {index}"));
    }
    worst.check();
    let dark = Settings { baked_in_air: false, ..plain() };
    let (pixels, _) = picture(&headless, scene, &front(2.0), &dark, SIZE);
    assert!(pixels.iter().all(|pixel| *pixel == [0.0; 3]), "switched off, it leaves nothing");
}
