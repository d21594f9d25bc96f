//! Thinned clutter in pictures: fewer pieces, as much light.

mod common;

use bake_runtime::{Model, Renderer, SceneData, Settings};
use common::{Fixture, front, headless, radiance};
use glam::{Affine3A, Vec2, Vec3};

/// A square is 4.6 texels wide: what falls between texels is below a percent of the light.
const SIZE: [u32; 2] = [1024, 1024];

/// 4096 glowing squares of 0.3 m, a metre apart, in the plane z = 0.
fn clutter() -> SceneData {
    let mut fixture = Fixture::new([2, 2], [100.0; 3]);
    let grey = fixture.material(|_| {});
    let square = fixture.square(grey);
    for i in 0..4096 {
        let place = Vec3::new((i % 64) as f32 - 31.5, (i / 64) as f32 - 31.5, 0.0);
        let map = Affine3A::from_translation(place) * Affine3A::from_scale(Vec3::splat(0.15));
        fixture.place(square, map, Vec2::ZERO, Vec2::ONE);
    }
    fixture.load()
}

#[test]
fn a_thinned_picture_is_another_one_of_the_same_brightness() {
    let Some(headless) = headless() else { return };
    let model = Model::new(&headless.device, &headless.queue, clutter()).expect("a small scene fits");
    assert_eq!(model.scene.draws.len(), 1);
    assert_eq!(model.scene.draws[0].instances.len(), 4096);
    let mut renderer = Renderer::new(&headless.device, &headless.queue, wgpu::TextureFormat::Rgba8Unorm);
    let target = headless.target(SIZE, wgpu::TextureFormat::Rgba8Unorm).create_view(&Default::default());
    let mut draw = |prune_start_m| {
        let settings = Settings { prune_start_m, ..Settings::default() };
        // 66 m high where the squares are.
        renderer.draw(&model, &front(66.0), &settings, &target, SIZE);
        radiance(&headless, &renderer).iter().map(|pixel| pixel[0]).collect::<Vec<f32>>()
    };
    let mean = |pixels: &[f32]| pixels.iter().map(|&v| f64::from(v)).sum::<f64>() / pixels.len() as f64;
    // Squares' left edges: dark pixels with a bright one beside them.
    let edges = |pixels: &[f32]| pixels.windows(2).filter(|pair| pair[0] == 0.0 && pair[1] > 0.0).count();
    let (whole, near) = (draw(None), draw(Some(80.0)));
    assert!(whole == near, "nothing is thinned nearer than the start");
    // At 66 to 80 m with all of them up to 22 m: some 3 of 10 are left, each as much larger.
    let thinned = draw(Some(22.0));
    let (light, pieces) = (mean(&thinned) / mean(&whole), edges(&thinned) as f64 / edges(&whole) as f64);
    println!("thinned clutter: {light:.3} of the light, {pieces:.2} of the edges");
    // 1200 pieces in a random order; each edge is as much longer as the square.
    assert!((light - 1.0).abs() < 0.03, "{light}");
    assert!((0.4..0.7).contains(&pieces), "{pieces}");
    // Wrong twin: the same pieces at their own size would leave their number's share of the light.
    assert!(pieces.powi(2) < 0.5, "pieces that do not grow lose half the light");
}
