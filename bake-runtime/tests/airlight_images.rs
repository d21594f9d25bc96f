//! Pictures of air alone, black walls behind it, against the f64 oracle pixel by pixel.

mod common;

use bake_formats::manifest::{LightKind, LightRecord, ProfileRecord};
use bake_optics::airlight::{Airlight, MediumAlong, Oracle, Quadrature};
use bake_optics::emitter::Emitter;
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::{Bounds, Density, Medium, MediumSet, Ray, Scatter};
use bake_optics::phase::Phase;
use bake_runtime::air::AirSettings;
use bake_runtime::{Camera, Headless, Method, Model, Renderer, SceneData, Settings};
use common::{Fixture, headless, radiance};
use glam::{Affine3A, DAffine3, DQuat, DVec3, EulerRot, IVec3, Vec2, Vec3};
use std::sync::Arc;
use testkit::compare::Worst;

const SIZE: [u32; 2] = [64, 32];

/// A black wall at z = −4, 16 m wide.
fn wall() -> SceneData {
    let mut fixture = Fixture::new([2, 2], [1.0; 3]);
    let black = fixture.material(|m| m.pbr_metallic_roughness.base_color_factor = [0.0, 0.0, 0.0, 1.0]);
    let square = fixture.square(black);
    let map = Affine3A::from_translation(Vec3::new(0.0, 0.0, -4.0)) * Affine3A::from_scale(Vec3::splat(8.0));
    fixture.place(square, map, Vec2::ZERO, Vec2::ONE);
    fixture.load()
}

fn lamp(color: [f32; 3], kind: LightKind) -> LightRecord {
    LightRecord { path: "lamp".into(), color: color.into(), kind }
}

fn point(x: f32, y: f32, z: f32) -> LightKind {
    LightKind::Point { position: Vec3::new(x, y, z), radius: 0.001, range: None, profile: None }
}

fn air(sigma_s: [f64; 3], sigma_a: [f64; 3], phase: Phase<f64>) -> Medium {
    let bounds = Bounds::Box { min: DVec3::new(-8.0, -6.0, -5.0), max: DVec3::new(8.0, 6.0, 6.0) };
    Medium { bounds, density: Density::Uniform, scatter: Scatter { sigma_s, sigma_a }, phase }
}

/// A camera of dyadic numbers: the rays of its pixels are exact in f32, so that the oracle sees the shader's own rays.
fn camera(eye: [f64; 3]) -> Camera {
    let mut camera = Camera::look_at(DVec3::from(eye), DVec3::from(eye) - DVec3::Z);
    camera.fov_y = 2.0 * 0.5f32.atan();
    camera
}

/// The ray of a pixel: unit direction and distance to the wall.
fn ray(camera: &Camera, index: usize) -> Ray {
    let (x, y) = (index % SIZE[0] as usize, index / SIZE[0] as usize);
    let share = |at: usize, side: u32| (2.0 * at as f64 + 1.0) / f64::from(side) - 1.0;
    let (right, up) = camera.half_extents(SIZE[0] as f32 / SIZE[1] as f32);
    let dir = camera.forward.as_dvec3() + share(x, SIZE[0]) * right.as_dvec3() - share(y, SIZE[1]) * up.as_dvec3();
    let at_wall = camera.eye + dir * (camera.eye.z + 4.0);
    let length = if at_wall.x.abs() < 8.0 && at_wall.y.abs() < 8.0 { dir.length() * (camera.eye.z + 4.0) } else { 1e9 };
    Ray::new(camera.eye, dir.normalize(), length)
}

/// Oracle's radiance of all lamps along a ray, and how near the ray passes to one, as a share of the lamp's distance.
fn truth(scene: &SceneData, ray: &Ray) -> ([f64; 3], f64) {
    let set = MediumSet { media: scene.media.clone() };
    let (mut sum, mut nearest) = ([0.0; 3], f64::INFINITY);
    for light in &scene.lights {
        let (position, axis, emitter) = match &light.kind {
            LightKind::Point { position, profile: None, .. } => (*position, Vec3::NEG_Y, Emitter::Isotropic),
            LightKind::Point { position, profile: Some(profile), .. } => {
                (*position, profile.axis, Emitter::Legendre(profile.legendre.iter().map(|&c| f64::from(c)).collect()))
            }
            LightKind::Spot { position, direction, inner_angle, outer_angle, .. } => {
                let [cos_inner, cos_outer] = [inner_angle, outer_angle].map(|angle| f64::from(angle.cos()));
                (*position, *direction, Emitter::SpotCone { cos_inner, cos_outer })
            }
            LightKind::Directional { .. } => unreachable!("suns have a test of their own"),
        };
        for (channel, sum) in sum.iter_mut().enumerate() {
            let along = MediumAlong::new(&set, channel, *ray, position.as_dvec3());
            let sight = along.sight(axis.as_dvec3().normalize());
            nearest = nearest.min(sight.h / sight.eye_distance());
            *sum += f64::from(light.color[channel]) * Oracle::default().radiance(&sight, &emitter, &along);
        }
    }
    (sum, nearest)
}

fn draw(
    headless: &Headless,
    renderer: &mut Renderer,
    model: &Model,
    camera: &Camera,
    air: AirSettings,
) -> Vec<[f32; 3]> {
    let target = headless.target(SIZE, wgpu::TextureFormat::Rgba8Unorm);
    let settings = Settings { air, ..Settings::default() };
    renderer.draw(model, camera, &settings, &target.create_view(&Default::default()), SIZE);
    radiance(headless, renderer)
}

fn renderer(headless: &Headless) -> Renderer {
    Renderer::new(&headless.device, &headless.queue, wgpu::TextureFormat::Rgba8Unorm)
}

/// Name, lamps, air and cameras.
type Scene = (&'static str, Vec<LightRecord>, Vec<Medium>, Vec<Camera>);

/// The scenes of the comparison.
fn scenes() -> Vec<Scene> {
    let warm = [400.0, 300.0, 200.0];
    let spot = |x: f32, inner_angle: f32, outer_angle: f32| LightKind::Spot {
        position: Vec3::new(x, 2.0, -1.5),
        direction: Vec3::new(0.25, -1.0, 0.125).normalize(),
        inner_angle,
        outer_angle,
        radius: 0.001,
        range: None,
        profile: None,
    };
    let profile = Some(ProfileRecord { axis: Vec3::NEG_Y, legendre: vec![1.0, 0.5, 0.25] });
    let measured = LightKind::Point { position: Vec3::new(-1.0, 0.5, -2.0), radius: 0.001, range: None, profile };
    let haze = |phase| air([0.05, 0.06, 0.08], [0.01, 0.0, 0.02], phase);
    let thick = air([0.5, 0.75, 1.0], [0.1, 0.1, 0.1], Phase::Isotropic);
    let low = Medium {
        density: Density::Exponential { base_m: -1.0, scale_height_m: 1.5 },
        ..air([0.3, 0.3, 0.4], [0.05; 3], Phase::HenyeyGreenstein { g: 0.5 })
    };
    let cameras = || vec![camera([0.0, 0.0, 2.0]), camera([0.75, 0.5, 0.25])];
    // One camera looks straight past a lamp: a pixel's ray passes it at 1/1000 of its distance.
    let near = || vec![camera([0.0, 0.0, 2.0]), camera([0.015625 + 0.002, 0.015625, 2.0])];
    vec![
        (
            "isotropic haze",
            vec![lamp(warm, point(0.5, 0.25, -1.0)), lamp(warm, point(-1.0, 0.5, 3.0))],
            vec![haze(Phase::Isotropic)],
            cameras(),
        ),
        ("thick air", vec![lamp(warm, point(0.5, 0.25, -1.0))], vec![thick], cameras()),
        ("past a lamp", vec![lamp(warm, point(0.0, 0.0, -2.0))], vec![haze(Phase::Rayleigh)], near()),
        (
            "forward haze",
            vec![lamp(warm, point(0.5, 0.25, -1.0))],
            vec![haze(Phase::HenyeyGreenstein { g: 0.85 })],
            cameras(),
        ),
        (
            "two media",
            vec![lamp(warm, point(0.5, 0.25, -1.0))],
            vec![haze(Phase::Rayleigh), haze(Phase::HenyeyGreenstein { g: 0.3 })],
            cameras(),
        ),
        (
            "spots",
            vec![lamp(warm, spot(0.5, 0.25, 0.5)), lamp(warm, spot(-1.0, 0.4, 0.4))],
            vec![haze(Phase::Isotropic)],
            cameras(),
        ),
        ("measured lamp", vec![lamp(warm, measured)], vec![haze(Phase::Isotropic)], cameras()),
        (
            "ground fog",
            vec![lamp(warm, point(0.5, 0.25, -1.0)), lamp(warm, spot(-1.0, 0.2, 0.6))],
            vec![haze(Phase::Isotropic), low],
            cameras(),
        ),
        ("wedge of fog", vec![lamp(warm, point(0.5, 0.25, -1.0))], vec![wedge()], cameras()),
        ("corner of fog", vec![lamp(warm, point(0.5, 0.25, -1.0))], vec![corner(1)], cameras()),
        ("air of a planet", vec![lamp(warm, point(0.5, 0.25, -1.0))], vec![planet()], cameras()),
    ]
}

/// Haze between six planes that the lamp and some rays lie outside of.
fn wedge() -> Medium {
    let plane = |x: f64, y: f64, z: f64, d: f64| DVec3::new(x, y, z).normalize().extend(d);
    let roof = [plane(0.25, 1.0, 0.125, 0.0), plane(0.0, -1.0, 0.0, 4.0)];
    let sides = [plane(1.0, 0.0, 0.25, 2.0), plane(-1.0, 0.0, 0.5, 3.0), plane(0.0, 0.0, 1.0, 0.5)];
    let planes = roof.into_iter().chain(sides).chain([plane(0.0, 0.25, -1.0, 3.5)]);
    Medium {
        bounds: Bounds::Hull(planes.collect()),
        ..air([0.2, 0.25, 0.3], [0.05; 3], Phase::HenyeyGreenstein { g: 0.3 })
    }
}

/// Haze in an L, and in a block that overlaps it where there are two shells; the lamp lies inside, one camera outside.
fn corner(shells: usize) -> Medium {
    let mesh = common::angle(shells, |place| 2.0 * place - DVec3::new(1.0, 1.0, 2.5));
    Medium { bounds: Bounds::Mesh(Arc::new(mesh)), ..air([0.2, 0.25, 0.3], [0.05; 3], Phase::Isotropic) }
}

/// The air of the Earth 2 m above its ground, five thousand times as dense.
fn planet() -> Medium {
    let density = Density::Planet { centre: DVec3::NEG_Y * 6.371e6, radius_m: 6.371e6 - 2.0, scale_height_m: 8e3 };
    let bounds = Bounds::Unbounded;
    Medium { bounds, density, ..air([0.03, 0.07, 0.16], [0.0, 0.01, 0.0], Phase::Rayleigh) }
}

/// A smooth cloud of 10 x 8 x 9 points, turned.
fn cloud() -> Medium {
    let size = IVec3::new(10, 8, 9);
    let value = |index: i32| {
        let at = IVec3::new(index % 10, index / 10 % 8, index / 80).as_dvec3() / (size - 1).as_dvec3();
        let from_middle = (at - 0.5).length();
        ((1.0 - 1.5 * from_middle).max(0.0) * (1.0 + 0.5 * (9.0 * at.x + 4.0 * at.z).sin())) as f32
    };
    let turn = DQuat::from_euler(EulerRot::YXZ, 0.5, 0.25, 0.125);
    let placed = DAffine3::from_scale_rotation_translation(DVec3::splat(0.5), turn, DVec3::new(-2.0, -1.5, -4.0));
    let grid = DensityGrid::new(size, (0..size.element_product()).map(value).collect(), placed).expect("valid");
    let (bounds, density) = (Bounds::Unbounded, Density::Grid(Arc::new(grid)));
    Medium { bounds, density, ..air([0.6, 0.5, 0.4], [0.1; 3], Phase::HenyeyGreenstein { g: 0.5 }) }
}

#[test]
fn quadrature_agrees_with_the_oracle_pixel_by_pixel() {
    let Some(headless) = headless() else { return };
    let mut renderer = renderer(&headless);
    let mut far = Worst::new("air-light of pixels, lamps 1e-3 away or more", 1e-4);
    let mut near = Worst::new("air-light of pixels, nearer lamps", 1e-2);
    for (name, lights, media, cameras) in scenes() {
        let model =
            Model::new(&headless.device, &headless.queue, SceneData { lights, media, ..wall() }).expect("small");
        for camera in cameras {
            let pixels = draw(&headless, &mut renderer, &model, &camera, AirSettings::default());
            // Every pixel where rays graze cones. A planet's optical length is a sum of its own,
            // a mesh is walked: the oracle takes its time.
            let stride = match name {
                "spots" => 1,
                "air of a planet" | "corner of fog" => 15,
                _ => 3,
            };
            let want: Vec<_> =
                (0..pixels.len()).step_by(stride).map(|index| truth(&model.scene, &ray(&camera, index))).collect();
            let largest = want.iter().flat_map(|(value, _)| *value).fold(0.0, f64::max);
            let mut worst = Worst::new(format!("  {name}"), f64::INFINITY);
            for (index, (pixel, (value, nearest))) in pixels.iter().step_by(stride).zip(&want).enumerate() {
                for channel in 0..3 {
                    let error = (f64::from(pixel[channel]) - value[channel]).abs() / value[channel].max(1e-6 * largest);
                    let place = || {
                        format!(
                            "{name}, eye {}, pixel {}, channel {channel}: {} not {}",
                            camera.eye,
                            stride * index,
                            pixel[channel],
                            value[channel]
                        )
                    };
                    worst.record(error, place);
                    if *nearest >= 1e-3 {
                        far.record(error, place);
                    } else {
                        near.record(error, place);
                    }
                }
            }
            worst.check();
        }
    }
    far.check();
    if near.measured() > 0.0 {
        near.check();
    }
}

/// Where shells overlap, shadows of their edges are no cuts of a ray.
#[test]
fn air_in_overlapping_shells_agrees_with_the_oracle() {
    let Some(headless) = headless() else { return };
    let (view, mut renderer) = (camera([0.75, 0.5, 0.25]), renderer(&headless));
    let scene = |shells| {
        let lights = vec![lamp([400.0, 300.0, 200.0], point(0.5, 0.25, -1.0))];
        SceneData { lights, media: vec![corner(shells)], ..wall() }
    };
    let mut pixels = |shells| {
        let model = Model::new(&headless.device, &headless.queue, scene(shells)).expect("small");
        draw(&headless, &mut renderer, &model, &view, AirSettings::default())
    };
    let (both, one, both_scene) = (pixels(2), pixels(1), scene(2));
    let indices: Vec<usize> = (0..both.len()).step_by(11).collect();
    let want: Vec<f64> = indices.iter().map(|&index| truth(&both_scene, &ray(&view, index)).0[0]).collect();
    let mean = want.iter().sum::<f64>() / want.len() as f64;
    let mut worst = Worst::new("air-light in overlapping shells, of the pixel or the mean", 1e-4);
    let mut without = Worst::new("the same with one shell left out (negative control)", 1e-2);
    for (&index, want) in indices.iter().zip(&want) {
        let error = |got: [f32; 3]| (f64::from(got[0]) - want).abs() / want.max(mean);
        worst.record(error(both[index]), || format!("pixel {index}: {} not {want}", both[index][0]));
        without.record(error(one[index]), || format!("pixel {index}"));
    }
    worst.check();
    assert!(!without.holds(), "{:.2e}", without.measured());
}

/// Cells of a grid are no cuts of a ray: nodes meet kinks.
#[test]
fn a_cloud_on_a_grid_agrees_with_a_sum_over_short_parts_of_the_ray() {
    let Some(headless) = headless() else { return };
    let lights = vec![lamp([400.0, 300.0, 200.0], point(0.5, 0.25, -1.0))];
    let scene = SceneData { lights, media: vec![cloud()], ..wall() };
    let model = Model::new(&headless.device, &headless.queue, scene).expect("small");
    let (view, mut renderer) = (camera([0.0, 0.0, 2.0]), renderer(&headless));
    let pixels = draw(&headless, &mut renderer, &model, &view, AirSettings::default());
    let marched = AirSettings { method: Method::RayMarch, steps: 32, ..AirSettings::default() };
    let marched = draw(&headless, &mut renderer, &model, &view, marched);
    let set = MediumSet { media: vec![cloud()] };
    let want = |ray: &Ray| {
        let step = ray.length / 48.0;
        let part = |i: u32| {
            let part = ray.part(step * f64::from(i), step * f64::from(i + 1));
            let along = MediumAlong::new(&set, 0, part, DVec3::new(0.5, 0.25, -1.0));
            let before = set.transmittance(&Ray { length: step * f64::from(i), ..*ray })[0];
            before * Quadrature::new(8).radiance(&along.sight(DVec3::NEG_Y), &Emitter::Isotropic, &along)
        };
        400.0 * (0..48).map(part).sum::<f64>()
    };
    let indices: Vec<usize> = (0..pixels.len()).step_by(31).collect();
    let truth: Vec<f64> = indices.iter().map(|&index| want(&ray(&view, index))).collect();
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let mut worst = Worst::new("a cloud on a grid", 1e-3);
    let mut march = Worst::new("a cloud marched in 32 steps (negative control)", 1e-3);
    for (&index, want) in indices.iter().zip(&truth) {
        let error = |got: f32| (f64::from(got) - want).abs() / want.max(0.1 * mean);
        worst.record(error(pixels[index][0]), || format!("pixel {index}"));
        march.record(error(marched[index][0]), || format!("pixel {index}"));
    }
    worst.check();
    assert!(!march.holds() && mean > 0.0, "{:.2e}", march.measured());
}

#[test]
fn too_few_nodes_are_noticed() {
    let Some(headless) = headless() else { return };
    let (_, lights, media, cameras) = scenes().remove(0);
    let model = Model::new(&headless.device, &headless.queue, SceneData { lights, media, ..wall() }).expect("small");
    let air = AirSettings { nodes: 3, ..AirSettings::default() };
    let pixels = draw(&headless, &mut renderer(&headless), &model, &cameras[0], air);
    let mut worst = Worst::new("3 nodes (negative control)", 1e-4);
    for (index, pixel) in pixels.iter().enumerate() {
        worst.relative(pixel[0].into(), truth(&model.scene, &ray(&cameras[0], index)).0[0], String::new);
    }
    assert!(!worst.holds(), "{:.2e}", worst.measured());
}

#[test]
fn the_table_stays_within_two_percent_of_the_mean_over_the_hemisphere() {
    let Some(headless) = headless() else { return };
    let mut renderer = renderer(&headless);
    let mut worst = Worst::new("table, of the picture's mean (Sun et al. 2005)", 0.02);
    for (name, lights, media, cameras) in scenes() {
        let model =
            Model::new(&headless.device, &headless.queue, SceneData { lights, media, ..wall() }).expect("small");
        let air = AirSettings { method: Method::Lut, ..AirSettings::default() };
        let plan = renderer.air_plan(&model, &Settings { air, ..Settings::default() }).expect("there is air");
        if plan.method != Method::Lut {
            assert!(plan.note.is_some(), "{name}: another method without a reason");
            continue;
        }
        let pixels = draw(&headless, &mut renderer, &model, &cameras[0], air);
        let want: Vec<f64> =
            (0..pixels.len()).step_by(3).map(|index| truth(&model.scene, &ray(&cameras[0], index)).0[1]).collect();
        let mean = want.iter().sum::<f64>() / want.len() as f64;
        for (index, (pixel, want)) in pixels.iter().step_by(3).zip(&want).enumerate() {
            worst.record((f64::from(pixel[1]) - want).abs() / mean, || format!("{name}, pixel {index}"));
        }
    }
    worst.check();
}

#[test]
fn light_behind_the_air_is_weakened_per_channel() {
    let Some(headless) = headless() else { return };
    let mut fixture = Fixture::new([2, 2], [std::f32::consts::PI; 3]);
    let white = fixture.material(|m| m.pbr_metallic_roughness.base_color_factor = [1.0; 4]);
    let square = fixture.square(white);
    fixture.place(square, Affine3A::from_scale(Vec3::splat(40.0)), Vec2::ZERO, Vec2::ONE);
    let bounds = Bounds::Box { min: DVec3::new(-9.0, -9.0, 0.5), max: DVec3::new(9.0, 9.0, 1.5) };
    let medium = Medium { bounds, ..air([0.5, 1.0, 0.0], [0.5, 1.0, 0.25], Phase::Isotropic) };
    let scene = SceneData { media: vec![medium.clone()], ..fixture.load() };
    let model = Model::new(&headless.device, &headless.queue, scene).expect("small");
    let view = camera([0.0, 0.0, 2.0]);
    let pixels = draw(&headless, &mut renderer(&headless), &model, &view, AirSettings::default());
    let mut worst = Worst::new("transmittance of a slab", 1e-5);
    for (index, pixel) in pixels.iter().enumerate() {
        let slant = 1.0 / -ray(&view, index).dir.z;
        (0..3).for_each(|c| {
            worst.relative(pixel[c].into(), (-medium.scatter.sigma_t()[c] * slant).exp(), || format!("{index}"))
        });
    }
    worst.check();
}

#[test]
fn the_sun_enters_bounds_at_their_border() {
    let Some(headless) = headless() else { return };
    let direction = Vec3::new(0.5, -1.0, -0.25).normalize();
    let sun = lamp([1000.0, 900.0, 800.0], LightKind::Directional { direction, angular_radius: 0.0 });
    let medium = air([0.05, 0.1, 0.2], [0.0, 0.05, 0.0], Phase::HenyeyGreenstein { g: 0.4 });
    let scene = SceneData { lights: vec![sun.clone()], media: vec![medium.clone()], ..wall() };
    let model = Model::new(&headless.device, &headless.queue, scene).expect("small");
    let view = camera([0.0, 0.0, 2.0]);
    let pixels = draw(&headless, &mut renderer(&headless), &model, &view, AirSettings::default());
    let set = MediumSet { media: vec![medium.clone()] };
    let mut worst = Worst::new("air-light of a sun", 1e-4);
    for (index, pixel) in pixels.iter().enumerate().step_by(7) {
        let ray = ray(&view, index);
        let ray = medium.bounds.clip(&ray).map(|(enter, leave)| ray.part(enter, leave)).expect("inside");
        let cos_theta = -direction.as_dvec3().normalize().dot(ray.dir);
        let steps = 4000;
        for (channel, got) in pixel.iter().enumerate() {
            let sigma_s = medium.scatter.sigma_s[channel];
            let value = |i: usize| {
                let s = ray.length * (i as f64 + 0.5) / f64::from(steps);
                let towards = Ray::new(ray.at(s), -direction.as_dvec3().normalize(), 1e3);
                let depth = set.optical_depth(&ray.part(0.0, s))[channel] + set.optical_depth(&towards)[channel];
                (-depth).exp()
            };
            let integral = (0..steps as usize).map(value).sum::<f64>() * ray.length / f64::from(steps);
            let want = f64::from(sun.color[channel]) * sigma_s * medium.phase.eval(cos_theta) * integral;
            worst.relative(f64::from(*got), want, || format!("pixel {index} channel {channel}"));
        }
    }
    worst.check();
}

#[test]
fn uniform_air_and_air_point_by_point_are_the_same_air() {
    let Some(headless) = headless() else { return };
    let mut renderer = renderer(&headless);
    let (_, lights, media, cameras) = scenes().remove(4);
    let scene = SceneData { lights, media, ..wall() };
    let mut model = Model::new(&headless.device, &headless.queue, scene).expect("small");
    let uniform = draw(&headless, &mut renderer, &model, &cameras[0], AirSettings::default());
    // A scale height of 1e7 m: uniform to 1e-6, but taken point by point.
    model.scene.media.iter_mut().for_each(|m| m.density = Density::Exponential { base_m: 0.0, scale_height_m: 1e7 });
    let layered = draw(&headless, &mut renderer, &model, &cameras[0], AirSettings::default());
    let mut worst = Worst::new("uniform against point by point", 5e-5);
    for (index, (a, b)) in uniform.iter().zip(&layered).enumerate() {
        (0..3).for_each(|c| worst.relative(a[c].into(), b[c].into(), || format!("pixel {index}")));
    }
    worst.check();
    assert!(uniform != layered, "both took the same way");
}
