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
