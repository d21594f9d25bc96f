//! The vector form against the f64 oracle and against the scalar form, lane by lane.

use bake_optics::airlight::wide::{Lanes, WidePhase, WideRays, radiance};
use bake_optics::airlight::{Airlight, Oracle, Sight, UniformAir};
use bake_optics::emitter::Emitter;
use bake_optics::phase::Phase;
use bake_optics::quadrature::GaussLegendre;
use testkit::compare::Worst;
use wide::{f32x8, f32x16};

/// Columns z, h, length, sigma_s, sigma_t of rays over a wide range, exact in f32.
fn rays() -> Vec<[f32; 5]> {
    let mut rays = Vec::new();
    for gamma in [1e-3f32, 0.05, 0.5, 1.5, 2.5, 3.1] {
        for distance in [0.01f32, 1.0, 20.0] {
            for length in [1e-3f32, 0.5, 10.0, f32::INFINITY] {
                for sigma_t in [1e-3f32, 0.3, 4.0] {
                    rays.push([-distance * gamma.cos(), distance * gamma.sin(), length, 0.5 * sigma_t, sigma_t]);
                }
            }
        }
    }
    rays
}

fn truth([z, h, length, sigma_s, sigma_t]: [f32; 5], phase: &Phase<f64>) -> f64 {
    let [z, h, length] = [z, h, length].map(f64::from);
    let sight = Sight { z, h, length, axis_along: 1.0, axis_across: 0.0 };
    let air = UniformAir { sigma_s: sigma_s.into(), sigma_t: sigma_t.into(), phase: phase.clone() };
    Oracle::default().radiance(&sight, &Emitter::Isotropic, &air)
}

fn check<V: Lanes, const N: usize>(pack: impl Fn([f32; N]) -> V, unpack: impl Fn(V) -> [f32; N]) {
    let g = f64::from(0.9f32);
    let phases = [
        (WidePhase::Isotropic, Phase::Isotropic, 1e-5),
        (WidePhase::Rayleigh, Phase::Rayleigh, 1e-5),
        (WidePhase::HenyeyGreenstein(0.9), Phase::HenyeyGreenstein { g }, 5e-5),
    ];
    let rule = GaussLegendre::<f32>::cached(32);
    for (wide_phase, phase, allowed) in phases {
        let mut worst = Worst::new(format!("{N} lanes, 32+32 nodes, {phase:?}"), allowed);
        for chunk in rays().chunks_exact(N) {
            let column = |c: usize| pack(std::array::from_fn(|lane| chunk[lane][c]));
            let rays =
                WideRays { z: column(0), h: column(1), length: column(2), sigma_s: column(3), sigma_t: column(4) };
            let got = unpack(radiance(&rays, wide_phase, rule));
            for (ray, got) in chunk.iter().zip(got) {
                let want = truth(*ray, &phase);
                if want > 1e-30 {
                    worst.relative(got.into(), want, || format!("{ray:?}"));
                } else {
                    assert!((0.0..1e-29).contains(&got), "{ray:?}: {got}");
                }
            }
        }
        worst.check();
    }
}

#[test]
fn eight_lanes_agree_with_the_oracle() {
    check::<f32x8, 8>(f32x8::new, |v| v.to_array());
}

#[test]
fn sixteen_lanes_agree_with_the_oracle() {
    check::<f32x16, 16>(f32x16::new, |v| v.to_array());
}

/// Eight rays that differ from a plain one in one number, against the oracle.
fn with_each(values: [f32; 8], set: impl Fn(&mut WideRays<f32x8>, f32x8), change: impl Fn(&mut [f32; 5], f32)) -> f64 {
    let plain = [-2.0f32, 0.5, 6.0, 0.5, 1.0];
    let column = |c: usize| f32x8::splat(plain[c]);
    let mut rays = WideRays { z: column(0), h: column(1), length: column(2), sigma_s: column(3), sigma_t: column(4) };
    set(&mut rays, f32x8::new(values));
    let got = radiance(&rays, WidePhase::Isotropic, GaussLegendre::<f32>::cached(32)).to_array();
    let mut worst: f64 = 0.0;
    for (value, got) in values.iter().zip(got) {
        let mut ray = plain;
        change(&mut ray, *value);
        let error = (f64::from(got) / truth(ray, &Phase::Isotropic) - 1.0).abs();
        worst = worst.max(if error.is_nan() { f64::INFINITY } else { error });
    }
    worst
}

#[test]
fn the_vector_form_keeps_its_digits_to_the_ends_of_its_domain() {
    let near = with_each([1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-12], |r, v| r.h = v, |r, v| r[1] = v);
    let thin = with_each([1e-1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-15, 1e-30, 0.0], |r, v| r.sigma_t = v, |r, v| r[4] = v);
    let dense = with_each([2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 38.0], |r, v| r.sigma_t = v, |r, v| r[4] = v);
    let along = with_each([-30.0, -10.0, -1.0, 0.0, 1e-3, 1.0, 10.0, 30.0], |r, v| r.z = v, |r, v| r[0] = v);
    let long = [1e-6, 1e-4, 1e-2, 1.9999, 2.0, 2.0001, 1e4, f32::INFINITY];
    let long = with_each(long, |r, v| r.length = v, |r, v| r[2] = v);
    for (what, error) in [("h", near), ("thin", thin), ("dense", dense), ("z", along), ("length", long)] {
        println!("{what}: {error:.1e}");
        // e^{−T} at T = 78 moves by 78 roundings.
        assert!(error < 5e-6, "{what}: {error}");
    }
    // Outside it: an endless ray without extinction has no end to place nodes by, and light below e^{−87} is 0.
    let endless = |r: &mut WideRays<f32x8>, v| {
        r.length = f32x8::splat(f32::INFINITY);
        r.sigma_t = v;
    };
    assert!(with_each([0.0; 8], endless, |r, _| (r[2], r[4]) = (f32::INFINITY, 0.0)) > 1e-3);
    assert_eq!(with_each([60.0; 8], |r, v| r.sigma_t = v, |r, v| r[4] = v), 1.0);
}
