//! Runs every method over the rays of a case.

use std::hint::black_box;
use std::time::Instant;

use bake_optics::airlight::wide::{Lanes, WidePhase, WideRays, radiance};
use bake_optics::airlight::{
    Airlight, ClosedForm, IsotropicLamp, Lut, Oracle, Quadrature, RayMarch, Sight, UniformAir, Vacuum,
};
use bake_optics::emitter::Emitter;
use bake_optics::phase::Phase;
use bake_optics::quadrature::GaussLegendre;
use wide::{f32x8, f32x16};

use crate::rays::{Case, Shot, shots};

/// Rays a case; a multiple of 16 for the vector forms.
pub const RAYS: usize = 512;

/// Passes over all rays, of which the fastest counts: what other programs disturb is left out.
const PASSES: usize = 60;

/// The same in words.
pub const PASSES_TEXT: &str = "Times are those of the fastest of 60 passes, one thread.";

/// One method on one case.
pub struct Point {
    pub method: &'static str,
    /// Nodes per side, steps, table size; 0 where there is none.
    pub effort: usize,
    pub nanoseconds: f64,
    pub median: f64,
    pub p95: f64,
    pub max: f64,
}

/// All methods on one case.
pub struct Result {
    pub case: &'static str,
    pub points: Vec<Point>,
}

pub fn measure(case: &Case) -> Result {
    let shots = shots(RAYS, &case.phase);
    let truth: Vec<f64> = shots.iter().map(|s| Oracle::default().radiance(&s.sight, &case.lamp, &s.air)).collect();
    let mut bench = Bench { methods: Vec::new() };
    scalar(&mut bench, case, &shots);
    single(&mut bench, case, &shots);
    if let (Emitter::Isotropic, Some(phase)) = (&case.lamp, wide_phase(&case.phase)) {
        vector(&mut bench, "quadrature f32, 8 rays at once", phase, &shots, f32x8::new, |v| v.to_array());
        vector(&mut bench, "quadrature f32, 16 rays at once", phase, &shots, f32x16::new, |v| v.to_array());
    }
    Result { case: case.name, points: bench.run(&truth) }
}

/// Fills one radiance per ray.
type Evaluate<'a> = Box<dyn FnMut(&mut [f64]) + 'a>;

/// A method at one effort.
struct Method<'a> {
    name: &'static str,
    effort: usize,
    all: Evaluate<'a>,
}

struct Bench<'a> {
    methods: Vec<Method<'a>>,
}

impl<'a> Bench<'a> {
    fn add(&mut self, name: &'static str, effort: usize, all: impl FnMut(&mut [f64]) + 'a) {
        self.methods.push(Method { name, effort, all: Box::new(all) });
    }

    /// Times the methods in turns, so that what disturbs the machine disturbs all; rays in the lamp's dark do not count as errors.
    fn run(mut self, truth: &[f64]) -> Vec<Point> {
        let mut got = vec![0.0; truth.len()];
        let mut best = vec![f64::INFINITY; self.methods.len()];
        for _ in 0..PASSES {
            for (best, method) in best.iter_mut().zip(&mut self.methods) {
                let start = Instant::now();
                (method.all)(black_box(&mut got));
                *best = best.min(start.elapsed().as_secs_f64());
            }
        }
        let point = |(best, mut method): (f64, Method)| {
            (method.all)(&mut got);
            let lit = got.iter().zip(truth).filter(|(_, want)| **want > 0.0);
            let mut errors: Vec<f64> = lit.map(|(got, want)| (got / want - 1.0).abs()).collect();
            errors.sort_by(f64::total_cmp);
            let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
            let nanoseconds = best * 1e9 / truth.len() as f64;
            let Method { name, effort, .. } = method;
            Point { method: name, effort, nanoseconds, median: at(0.5), p95: at(0.95), max: at(1.0) }
        };
        best.into_iter().zip(self.methods).map(point).collect()
    }
}

fn scalar<'a>(bench: &mut Bench<'a>, case: &'a Case, shots: &'a [Shot]) {
    let nodes = [4, 6, 8, 12, 16, 24, 32, 48];
    nodes.into_iter().for_each(|n| each(bench, "quadrature", n, Quadrature::new(n), case, shots));
    let steps = [8, 16, 32, 64, 128, 256, 1024];
    steps.into_iter().for_each(|steps| each(bench, "ray march", steps, RayMarch { steps }, case, shots));
    each(bench, "closed form", 0, ClosedForm::default(), case, shots);
    each(bench, "vacuum", 16, Vacuum::default(), case, shots);
    if case.lamp == Emitter::Isotropic && !matches!(case.phase, Phase::HenyeyGreenstein { .. }) {
        for size in [32, 128] {
            let lut = Lut::new(size, 3);
            bench.add("table", size, move |out| {
                let value = |s: &Shot| lut.radiance(&s.sight, &IsotropicLamp, &s.air);
                out.iter_mut().zip(shots).for_each(|(out, s)| *out = value(s));
            });
        }
    }
}

fn each<'a, M>(bench: &mut Bench<'a>, name: &'static str, effort: usize, method: M, case: &'a Case, shots: &'a [Shot])
where
    M: Airlight<f64, UniformAir<f64>> + 'a,
{
    bench.add(name, effort, move |out| {
        out.iter_mut().zip(shots).for_each(|(out, s)| *out = method.radiance(&s.sight, &case.lamp, &s.air));
    });
}

/// The scalar form in f32. Rounding the rays is part of its error.
fn single(bench: &mut Bench<'_>, case: &Case, shots: &[Shot]) {
    let round = |s: &Shot| {
        let Sight { z, h, length, axis_along, axis_across } = s.sight;
        let sight = Sight {
            z: z as f32,
            h: h as f32,
            length: length as f32,
            axis_along: axis_along as f32,
            axis_across: axis_across as f32,
        };
        let phase = match case.phase {
            Phase::Rayleigh => Phase::Rayleigh,
            Phase::HenyeyGreenstein { g } => Phase::HenyeyGreenstein { g: g as f32 },
            _ => Phase::Isotropic,
        };
        (sight, UniformAir { sigma_s: s.air.sigma_s as f32, sigma_t: s.air.sigma_t as f32, phase })
    };
    let lamp: Emitter<f32> = match &case.lamp {
        Emitter::CosinePower { exponent } => Emitter::CosinePower { exponent: *exponent as f32 },
        Emitter::Legendre(c) => Emitter::Legendre(c.iter().map(|&c| c as f32).collect()),
        _ => Emitter::Isotropic,
    };
    let rounded: Vec<_> = shots.iter().map(round).collect();
    for nodes in [8, 24] {
        let (lamp, rounded) = (lamp.clone(), rounded.clone());
        bench.add("quadrature f32", nodes, move |out| {
            let value =
                |(sight, air): &(Sight<f32>, UniformAir<f32>)| Quadrature::new(nodes).radiance(sight, &lamp, air);
            out.iter_mut().zip(&rounded).for_each(|(out, ray)| *out = value(ray).into());
        });
    }
}

fn wide_phase(phase: &Phase<f64>) -> Option<WidePhase> {
    match phase {
        Phase::Isotropic => Some(WidePhase::Isotropic),
        Phase::Rayleigh => Some(WidePhase::Rayleigh),
        Phase::HenyeyGreenstein { g } => Some(WidePhase::HenyeyGreenstein(*g as f32)),
        _ => None,
    }
}

fn vector<'a, V: Lanes + 'a, const N: usize>(
    bench: &mut Bench<'a>,
    name: &'static str,
    phase: WidePhase,
    shots: &[Shot],
    pack: impl Fn([f32; N]) -> V,
    unpack: impl Fn(V) -> [f32; N] + Copy + 'a,
) {
    let rays = |chunk: &[Shot]| {
        let column = |f: &dyn Fn(&Shot) -> f64| pack(std::array::from_fn(|lane| f(&chunk[lane]) as f32));
        WideRays {
            z: column(&|s| s.sight.z),
            h: column(&|s| s.sight.h),
            length: column(&|s| s.sight.length),
            sigma_s: column(&|s| s.air.sigma_s),
            sigma_t: column(&|s| s.air.sigma_t),
        }
    };
    let packed: Vec<WideRays<V>> = shots.chunks_exact(N).map(rays).collect();
    for nodes in [8, 24] {
        let rule = GaussLegendre::<f32>::cached(nodes);
        let packed = packed.clone();
        bench.add(name, nodes, move |out| {
            for (out, rays) in out.chunks_exact_mut(N).zip(&packed) {
                out.iter_mut().zip(unpack(radiance(rays, phase, rule))).for_each(|(out, value)| *out = value.into());
            }
        });
    }
}
