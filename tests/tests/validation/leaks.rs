//! Light where no emitter reaches, in scenes whose right answer nobody knows: the leak score.
//!
//! Points of the surfaces from which draws towards every emitter all end at something opaque, there and two texels around,
//! must have no direct light. Their mean direct light as a share of all points' mean is the score. Points whose texel lies
//! buried in other geometry are left out: nobody sees them, and they were filled from around.

use bake_core::scene::Scene;
use bake_core::solve::emitters::{Emitters, Strategy, Target};
use bake_core::solve::sampler::Sampler as Numbers;
use bake_core::trace::{Ray, Tracer};
use bake_formats::Term;
use bake_formats::sample::LightmapPage;
use bake_tests::points::{Point, on_surfaces};
use bake_tests::program::Baked;
use glam::Vec3;

/// Points on the surfaces.
const POINTS: u32 = 4000;
/// Draws of every kind at a point, and at each place around it.
const DRAWS: u32 = 64;
/// Texels from the edge of a shadow within which a texel, or a look-up, also covers lit surface.
const REACH: f64 = 2.0;

/// What was found.
pub struct Leaks {
    /// Points that no emitter reaches.
    pub dark_points: u32,
    /// Mean direct light there, as a share of the mean at all points.
    pub score: f64,
    /// The same of points that emitters do reach: what a leak would look like.
    pub lit_score: f64,
}

/// Compares a package and its pages with its scene.
pub fn measure(scene: &Scene, baked: &Baked, pages: &[LightmapPage]) -> Leaks {
    let tracer = Tracer::new(scene);
    let emitters = Emitters::new(&tracer);
    let sampler = baked.sampler();
    let direct = sampler.terms().iter().position(|&term| term == Term::Direct).expect("every bake has direct light");
    let (mut dark, mut lit) = ((0.0, 0), (0.0, 0));
    for point in on_surfaces(&baked.package, POINTS) {
        let normal = point.normal.as_vec3();
        let Some(sample) = sampler.sample(point.position.as_vec3(), normal) else { continue };
        let page = &pages[sample.page as usize];
        let [x, y] = sample.texel;
        if !page.valid[(y * page.width + x) as usize] {
            continue;
        }
        let is_dark = places(&point).all(|place| !is_reached(&tracer, &emitters, place, normal));
        let sum = if is_dark { &mut dark } else { &mut lit };
        *sum = (sum.0 + f64::from(sample.terms[direct].max_element()), sum.1 + 1);
    }
    let mean = (dark.0 + lit.0) / f64::from(dark.1 + lit.1);
    let score = |(sum, count): (f64, u32)| if count > 0 { sum / f64::from(count) / mean } else { 0.0 };
    Leaks { dark_points: dark.1, score: score(dark), lit_score: score(lit) }
}

/// The point and places around it, a little above the surface.
fn places(point: &Point) -> impl Iterator<Item = Vec3> + '_ {
    let above = 1e-3 * point.texel * point.normal;
    let around = point.around(REACH).chain(point.around(0.5 * REACH));
    std::iter::once(point.position).chain(around).map(move |place| (place + above).as_vec3())
}

/// Whether any draw towards any emitter arrives.
fn is_reached(tracer: &Tracer, emitters: &Emitters, place: Vec3, normal: Vec3) -> bool {
    let arrives = |strategy: Strategy, draw: u32| {
        let [u, v, w, _] = Numbers::new(draw, 0).next4();
        let Some(light) = emitters.sample(tracer, strategy, place, normal, [u, v, w]) else { return false };
        let (dir, t_max) = match light.target {
            Target::Point(point) => (point - place, 1.0),
            Target::Direction(dir) => (dir, f32::INFINITY),
        };
        dir.dot(normal) > 0.0 && tracer.transmittance(&Ray { origin: place, dir, t_max }) != Vec3::ZERO
    };
    emitters.strategies().iter().any(|&strategy| (0..DRAWS).any(|draw| arrives(strategy, draw)))
}
