//! The solver against closed forms: laws, analytic values, furnaces with their partial sums, each with a wrong twin.

#[cfg(feature = "media")]
mod air_laws;
#[cfg(feature = "media")]
mod fog;
#[cfg(feature = "media")]
mod kept;
#[cfg(feature = "media")]
mod paper;
mod points;
#[cfg(feature = "media")]
mod situations;
#[cfg(feature = "media")]
mod tables;

use super::*;
use crate::progress::Silent;
use crate::scene::{Environment, Light, LightKind, Scene};
#[cfg(feature = "media")]
use crate::solve::media::Fog;
use crate::test_scenes::{closed_box, matte, point_light, quad, quad_atlas, scene};
use glam::Affine3A;
use std::f32::consts::PI;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use testkit::compare::Worst;

const SIZE: u32 = 8;

/// A 2 m × 2 m floor about the origin, looking up.
fn floor(material: u32) -> crate::scene::Mesh {
    quad(Vec3::new(-1.0, 0.0, 1.0), Vec3::X * 2.0, Vec3::NEG_Z * 2.0, material)
}

/// World position of a texel of [`floor`].
fn floor_point(x: u32, y: u32) -> Vec3 {
    let at = |i: u32| (i as f32 + 0.5) / SIZE as f32 * 2.0 - 1.0;
    Vec3::new(at(x), 0.0, -at(y))
}

fn solve(scene: &Scene, samples: u32, bounces: Option<u32>) -> Lightmap {
    let settings = LightmapSettings {
        target_error: 0.0,
        min_samples: samples,
        max_samples: samples,
        bounces,
        ..Default::default()
    };
    lightmap(&Tracer::new(scene), &MediumSet::default(), &quad_atlas(SIZE), &settings, &Silent).unwrap()
}

/// Compares each texel of the first page with `truth(x, y)`: relative error beyond four standard errors.
fn worst(name: &str, page: &PageBuffers, allowed: f64, truth: impl Fn(u32, u32) -> f64) -> Worst {
    let mut worst = Worst::new(name, allowed);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let at = (y * SIZE + x) as usize;
            let (got, want) = (f64::from(page.total(at).x), truth(x, y));
            let noise = 4.0 * f64::from(page.variance[at].x).sqrt();
            worst.record(((got - want).abs() - noise).max(0.0) / want.abs().max(1e-12), || {
                format!("texel {x}, {y}: {got} against {want}")
            });
        }
    }
    worst
}

#[test]
fn a_point_light_follows_the_inverse_square_and_cosine() {
    let lamp = Vec3::new(0.3, 1.5, -0.2);
    let mut scene = scene(vec![floor(0)], vec![matte(0.5)]);
    scene.lights = vec![point_light(lamp, 100.0)];
    let lightmap = solve(&scene, 64, None);
    let exact = |x: u32, y: u32, power: i32| {
        let way = (lamp - floor_point(x, y)).as_dvec3();
        100.0 * way.y / way.length().powi(power)
    };
    worst("point light", &lightmap.pages[0], 2e-5, |x, y| exact(x, y, 3)).check();
    assert!(!worst("forgotten cosine", &lightmap.pages[0], 2e-5, |x, y| exact(x, y, 3) / 1.5).holds());
    assert!(
        lightmap.pages[0].terms[1].irradiance.iter().all(|e| *e == Vec3::ZERO),
        "nothing reflects onto a lone floor"
    );
}

#[test]
fn sun_and_sky_add_up() {
    let mut scene = scene(vec![floor(0)], vec![matte(0.5)]);
    let direction = Vec3::new(1.0, -2.0, 0.5).normalize();
    scene.lights = vec![Light {
        path: "sun".into(),
        color: Vec3::splat(1000.0),
        kind: LightKind::Directional { direction, angular_radius: 0.005 },
    }];
    scene.environment = Some(Environment { width: 1, height: 1, radiance: vec![Vec3::splat(20.0)], rotation: 0.0 });
    let lightmap = solve(&scene, 256, None);
    let exact = f64::from(1000.0 * -direction.y) + 20.0 * std::f64::consts::PI;
    worst("sun and sky", &lightmap.pages[0], 2e-3, |_, _| exact).check();
    assert!(!worst("sky without π", &lightmap.pages[0], 2e-3, |_, _| exact - 42.8).holds());
}

/// Irradiance under a parallel rectangle of radiance 1 at height h: the sum over its four corner rectangles of
/// (X/√(1+X²) atan(Y/√(1+X²)) + Y/√(1+Y²) atan(X/√(1+Y²)))/2, X and Y the sides over h (radiometry texts; the
/// differential-to-finite form factor of Howell's catalogue, B-4, times π).
fn rectangle_irradiance(point: Vec3, min: Vec3, max: Vec3) -> f64 {
    let h = f64::from(min.y - point.y);
    let corner = |x: f64, y: f64| {
        let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        0.5 * (x / rx * (y / rx).atan() + y / ry * (x / ry).atan())
    };
    let (x0, x1) = (f64::from(min.x - point.x) / h, f64::from(max.x - point.x) / h);
    let (z0, z1) = (f64::from(min.z - point.z) / h, f64::from(max.z - point.z) / h);
    corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0)
}

#[test]
fn a_glowing_rectangle_gives_its_form_factor() {
    let (min, max) = (Vec3::new(-0.4, 1.0, -0.3), Vec3::new(0.7, 1.0, 0.5));
    let mut glow = matte(0.0);
    glow.emission = Vec3::splat(50.0);
    let lamp = quad(min, Vec3::X * 1.1, Vec3::Z * 0.8, 1); // x × z looks down
    let scene = scene(vec![floor(0), lamp], vec![matte(0.5), glow]);
    let lightmap = solve(&scene, 1024, None);
    let exact = |x: u32, y: u32| 50.0 * rectangle_irradiance(floor_point(x, y), min, max);
    worst("rectangle", &lightmap.pages[0], 2e-3, exact).check();
    assert!(!worst("rectangle, 3 % off", &lightmap.pages[0], 2e-3, |x, y| 1.03 * exact(x, y)).holds());
}

#[test]
fn both_strategies_alone_agree_with_their_mixture() {
    // A lamp so large and near that followed directions find it often, and drawn points often: a wrong weight shows.
    let mut glow = matte(0.0);
    glow.emission = Vec3::splat(3.0);
    let (min, max) = (Vec3::new(-4.0, 0.2, -4.0), Vec3::new(4.0, 0.2, 4.0));
    let scene = scene(vec![floor(0), quad(min, Vec3::X * 8.0, Vec3::Z * 8.0, 1)], vec![matte(0.5), glow]);
    let lightmap = solve(&scene, 1024, None);
    worst("near lamp", &lightmap.pages[0], 2e-3, |x, y| 3.0 * rectangle_irradiance(floor_point(x, y), min, max))
        .check();
}

/// A closed box whose walls all emit 1 and reflect `albedo`: after n bounces the irradiance is π Σₖ₌₀ⁿ albedoᵏ.
#[test]
fn a_furnace_gives_its_partial_sums() {
    let albedo = 0.6;
    let mut wall = matte(albedo);
    wall.emission = Vec3::ONE;
    let room = closed_box(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0), true, 0);
    let scene = scene(vec![floor(1), room], vec![wall, wall_floor(albedo)]);
    let partial = |n: i32| f64::from(PI) * (0..=n).map(|k| f64::from(albedo).powi(k)).sum::<f64>();
    for n in [0, 1, 3] {
        let lightmap = solve(&lifted(&scene), 1024, Some(n as u32));
        worst(&format!("{n} bounces"), &lightmap.pages[0], 2e-3, |_, _| partial(n)).check();
        assert!(!worst("one bounce more", &lightmap.pages[0], 2e-3, |_, _| partial(n + 1)).holds());
    }
    let lightmap = solve(&lifted(&scene), 2048, None);
    worst("all bounces", &lightmap.pages[0], 2e-3, |_, _| f64::from(PI) / (1.0 - f64::from(albedo))).check();
}

/// Harmonics change how the first direction is drawn, and that alone.
#[test]
fn a_furnace_with_harmonics_gives_the_same_sum() {
    let albedo = 0.6;
    let mut wall = matte(albedo);
    wall.emission = Vec3::ONE;
    let room = closed_box(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0), true, 0);
    let scene = lifted(&scene(vec![floor(1), room], vec![wall, wall_floor(albedo)]));
    let settings =
        LightmapSettings { target_error: 0.0, min_samples: 2048, max_samples: 2048, sh1: true, ..Default::default() };
    let air = MediumSet::default();
    let lightmap = lightmap(&Tracer::new(&scene), &air, &quad_atlas(SIZE), &settings, &Silent).unwrap();
    let exact = f64::from(PI) / (1.0 - f64::from(albedo));
    worst("furnace with harmonics", &lightmap.pages[0], 2e-3, |_, _| exact).check();
    assert!(!worst("2 % off", &lightmap.pages[0], 2e-3, |_, _| 1.02 * exact).holds());
}

fn wall_floor(albedo: f32) -> crate::scene::Material {
    let mut floor = matte(albedo);
    floor.emission = Vec3::ONE;
    floor
}

/// The floor raised a little, so that it hides the bottom of the box below it and not its own light.
fn lifted(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.instances[0].world_from_object = Affine3A::from_translation(Vec3::Y * 0.001);
    scene
}

#[test]
fn harmonics_of_a_uniform_sky() {
    // Radiance 1 over the hemisphere about y: c₀ = 2π·0.282095, c_y = 0.488603·π, the others 0.
    let mut scene = scene(vec![floor(0)], vec![matte(0.5)]);
    scene.environment = Some(Environment { width: 1, height: 1, radiance: vec![Vec3::ONE], rotation: 0.0 });
    let settings = LightmapSettings {
        target_error: 0.0,
        min_samples: 16_384,
        max_samples: 16_384,
        sh1: true,
        ..Default::default()
    };
    let lightmap =
        lightmap(&Tracer::new(&scene), &MediumSet::default(), &quad_atlas(SIZE), &settings, &Silent).unwrap();
    let mut worst = Worst::new("l ≤ 1 of a half sky", 5e-3);
    for c in lightmap.pages[0].sh1.as_ref().unwrap() {
        for (got, want) in c.iter().zip([1.772_454, 1.534_990, 0.0, 0.0]) {
            worst.record(f64::from((got.x - want).abs()), || format!("{got} against {want}"));
        }
    }
    worst.check();
}

#[test]
fn no_light_enters_a_closed_room() {
    let room = closed_box(Vec3::new(-1.5, -0.1, -1.5), Vec3::new(1.5, 2.0, 1.5), true, 0);
    let mut scene = scene(vec![floor(0), room], vec![matte(0.8)]);
    scene.environment = Some(Environment { width: 1, height: 1, radiance: vec![Vec3::splat(1e6)], rotation: 0.0 });
    scene.lights = vec![point_light(Vec3::new(0.0, 4.0, 0.0), 1e6)];
    let page = &solve(&scene, 512, None).pages[0];
    assert!((0..page.validity.len()).all(|at| page.total(at) == Vec3::ZERO));
    let (_, open) = scene.meshes.split_first_mut().unwrap();
    open[0].triangles.truncate(11);
    open[0].primitives[0].triangles.end = 11;
    let page = &solve(&scene, 512, None).pages[0];
    assert!((0..page.validity.len()).any(|at| page.total(at) != Vec3::ZERO), "a hole must be seen");
}

#[test]
fn texels_inside_a_block_are_buried() {
    let block = closed_box(Vec3::new(-0.5, -0.1, -0.5), Vec3::new(0.5, 0.5, 0.5), false, 0);
    let mut scene = scene(vec![floor(0), block], vec![matte(0.5)]);
    scene.lights = vec![point_light(Vec3::new(0.0, 3.0, 0.0), 10.0)];
    let page = &solve(&scene, 16, None).pages[0];
    for y in 0..SIZE {
        for x in 0..SIZE {
            let p = floor_point(x, y);
            let inside = p.x.abs() < 0.5 && p.z.abs() < 0.5;
            let expected = if inside { Validity::Buried } else { Validity::Good };
            assert_eq!(page.validity[(y * SIZE + x) as usize], expected, "texel {x}, {y}");
        }
    }
}

/// A room with a lamp and a block: something of everything.
fn busy_scene() -> Scene {
    let mut glow = matte(0.2);
    glow.emission = Vec3::new(8.0, 6.0, 4.0);
    let room = closed_box(Vec3::new(-1.2, -0.01, -1.2), Vec3::new(1.2, 2.0, 1.2), true, 0);
    let block = closed_box(Vec3::new(0.1, 0.0, 0.1), Vec3::new(0.6, 0.7, 0.5), false, 0);
    let lamp = quad(Vec3::new(-0.3, 1.99, -0.3), Vec3::X * 0.6, Vec3::Z * 0.6, 1);
    let mut scene = scene(vec![floor(0), room, block, lamp], vec![matte(0.7), glow]);
    scene.lights = vec![point_light(Vec3::new(-0.8, 1.0, 0.8), 2.0)];
    scene
}

#[test]
fn the_error_falls_with_samples_and_is_what_it_says() {
    let scene = busy_scene();
    let truth = solve(&scene, 16_384, Some(4));
    let (mut x, mut y) = (vec![], vec![]);
    for samples in [64, 256, 1024, 4096] {
        let settings = LightmapSettings {
            target_error: 0.0,
            min_samples: samples,
            max_samples: samples,
            bounces: Some(4),
            seed: 9,
            ..Default::default()
        };
        let bake =
            lightmap(&Tracer::new(&scene), &MediumSet::default(), &quad_atlas(SIZE), &settings, &Silent).unwrap();
        let good = |at: &usize| bake.pages[0].validity[*at] == Validity::Good;
        let median = bake.reports[0].median;
        let squares: Vec<f64> = (0..(SIZE * SIZE) as usize)
            .filter(good)
            .map(|at| {
                let (b, t) = (bake.pages[0].total(at).dot(LUMINANCE), truth.pages[0].total(at).dot(LUMINANCE));
                f64::from((b - t) / t.max(median)).powi(2)
            })
            .collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let said = f64::from(bake.reports[0].error);
        println!("{samples} samples: error {rms:.5}, said {said:.5}");
        assert!(rms < 1.5 * said && said < 1.5 * rms.max(1e-9), "{samples} samples: error {rms}, said {said}");
        x.push(f64::from(samples).ln());
        y.push(rms.ln());
    }
    let slope = testkit::statistics::slope(&x, &y);
    println!("slope {slope:.3}, allowed at most -0.47");
    assert!(slope < -0.47, "{slope}");
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let bake = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&busy_scene(), 128, None))
    };
    let first = bake(1);
    for threads in [2, 7] {
        let other = bake(threads);
        for (a, b) in first.pages[0].terms.iter().zip(&other.pages[0].terms) {
            assert_eq!(a.irradiance, b.irradiance, "{threads} threads");
        }
        assert_eq!(first.pages[0].variance, other.pages[0].variance);
        assert_eq!((first.rays, first.shadow_rays), (other.rays, other.shadow_rays));
    }
}

#[test]
fn a_target_error_is_reached() {
    let settings = LightmapSettings { target_error: 0.02, min_samples: 16, max_samples: 1 << 16, ..Default::default() };
    let bake =
        lightmap(&Tracer::new(&busy_scene()), &MediumSet::default(), &quad_atlas(SIZE), &settings, &Silent).unwrap();
    let report = bake.reports[0];
    println!("{report:?}");
    assert!(report.error <= 0.02 && report.samples > 16 && report.samples < 1 << 16);
}

/// Over rounds and pages there is one stage, whose count never falls behind what is expected and ends where it does.
#[test]
fn progress_goes_on_over_rounds_and_pages() {
    #[derive(Default)]
    struct Record {
        stages: Mutex<Vec<String>>,
        done: AtomicU64,
        expected: Mutex<Vec<u64>>,
    }
    impl Progress for Record {
        fn stage(&self, name: &str, units: u64) {
            self.stages.lock().unwrap().push(name.into());
            self.expect(units);
        }
        fn expect(&self, units: u64) {
            assert!(self.done.load(Ordering::SeqCst) <= units);
            self.expected.lock().unwrap().push(units);
        }
        fn advance(&self, units: u64) {
            let done = self.done.fetch_add(units, Ordering::SeqCst) + units;
            let expected = *self.expected.lock().unwrap().last().unwrap();
            assert!(done <= expected, "{done} of {expected}");
        }
        fn is_cancelled(&self) -> bool {
            false
        }
    }
    let scene = busy_scene();
    let page = quad_atlas(SIZE).pages.remove(0);
    let atlas = Atlas { pages: vec![page.clone(), page], ..quad_atlas(SIZE) };
    let settings = LightmapSettings { target_error: 0.02, min_samples: 16, max_samples: 1 << 16, ..Default::default() };
    let record = Record::default();
    lightmap(&Tracer::new(&scene), &MediumSet::default(), &atlas, &settings, &record).unwrap();
    let (done, expected) = (record.done.into_inner(), record.expected.into_inner().unwrap());
    println!("{done} units; expected {expected:?}");
    assert_eq!(record.stages.into_inner().unwrap(), ["trace"]);
    assert_eq!(expected.last(), Some(&done));
    assert!(expected.len() > 3, "several rounds on two pages: {expected:?}");
}

#[test]
fn interruption_returns_nothing() {
    struct Stop;
    impl Progress for Stop {
        fn stage(&self, _: &str, _: u64) {}
        fn expect(&self, _: u64) {}
        fn advance(&self, _: u64) {}
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let result = lightmap(
        &Tracer::new(&busy_scene()),
        &MediumSet::default(),
        &quad_atlas(SIZE),
        &LightmapSettings::default(),
        &Stop,
    );
    assert_eq!(result.err(), Some(Interrupted));
}
