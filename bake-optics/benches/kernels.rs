//! Nanoseconds per call of the crate's small functions: special functions, phase functions, harmonics.
//!
//! Inputs run through a fixed list so that no branch is always right. Shows cost alone; accuracy is in `docs/stability.md`. Does not show
//! vectorised use.

use std::hint::black_box;

use bake_optics::Real;
use bake_optics::harmonics::{clamped_cosine, irradiance, real_sh_into, zonal_dot, zonal_to_sh};
use bake_optics::phase::{Deflection, Phase};
use bake_optics::special::{Complex, chapman, chapman_large_z, erfcx, phi1, scaled_exponential_integral};
use criterion::{Criterion, criterion_group, criterion_main};

const COUNT: usize = 256;

/// Numbers in (0, 1), fixed.
fn numbers<T: Real>() -> Vec<T> {
    (1..=COUNT).map(|i| T::of((i as f64 * 0.618_033_988_749_895).fract())).collect()
}

fn bench_one<T: Real>(c: &mut Criterion, precision: &str) {
    let numbers = numbers::<T>();
    let mut next = 0;
    let mut x = move || {
        next = (next + 1) % COUNT;
        black_box(numbers[next])
    };
    let one = T::one();
    let mut group = c.benchmark_group(precision);
    group.bench_function("phi1", |b| b.iter(|| phi1(x())));
    group.bench_function("erfcx", |b| b.iter(|| erfcx(x() * T::of(10.0))));
    group
        .bench_function("S_1, |z| < 2 (series)", |b| b.iter(|| scaled_exponential_integral(1, Complex::new(x(), x()))));
    group.bench_function("S_1, |z| > 4 (fraction)", |b| {
        b.iter(|| scaled_exponential_integral(1, Complex::new(x() * T::of(20.0), T::of(4.0) + x())))
    });
    group.bench_function("chapman, z = 800", |b| b.iter(|| chapman(T::of(800.0), x())));
    group.bench_function("chapman_large_z, z = 800", |b| b.iter(|| chapman_large_z(T::of(800.0), x())));
    let lobe = Phase::HenyeyGreenstein { g: T::of(0.8) };
    let series = lobe.to_legendre(16);
    group.bench_function("Henyey-Greenstein", |b| b.iter(|| lobe.eval_deflected(Deflection::from_half_tangent(x()))));
    group.bench_function("Henyey-Greenstein sample", |b| b.iter(|| lobe.sample(x())));
    group.bench_function("16 Legendre terms", |b| b.iter(|| series.eval(x())));
    let mut out = vec![T::zero(); 256];
    for bands in [3, 5, 16] {
        group.bench_function(format!("real SH, {bands} bands"), |b| {
            b.iter(|| {
                real_sh_into([x(), x(), one], bands, &mut out);
                black_box(out[0])
            })
        });
    }
    let (zonal, cosine) = (vec![T::of(0.3); 11], clamped_cosine::<T>(11));
    group.bench_function("double product, 11 bands", |b| b.iter(|| zonal_dot(black_box(&zonal), &cosine, x())));
    group.bench_function("irradiance, 11 bands", |b| b.iter(|| irradiance(black_box(&zonal), x())));
    group.bench_function("rotate 11 bands to an axis", |b| b.iter(|| zonal_to_sh(black_box(&zonal), [x(), x(), one])));
    group.finish();
}

fn kernels(c: &mut Criterion) {
    bench_one::<f32>(c, "f32");
    bench_one::<f64>(c, "f64");
}

criterion_group!(benches, kernels);
criterion_main!(benches);
