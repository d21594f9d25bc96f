//! The fixed set of rays and cases on which methods are compared.

use bake_optics::airlight::{Sight, UniformAir};
use bake_optics::emitter::Emitter;
use bake_optics::phase::Phase;

/// One ray with its air.
pub struct Shot {
    pub sight: Sight<f64>,
    pub air: UniformAir<f64>,
}

/// Air and lamp of one comparison.
pub struct Case {
    pub name: &'static str,
    pub phase: Phase<f64>,
    pub lamp: Emitter<f64>,
}

/// Isotropic, Rayleigh, Henyey–Greenstein 0.9, a spot cos^10 and a "light ball" 1 + P_10 in isotropic air.
pub fn cases() -> Vec<Case> {
    let ball = Emitter::Legendre([vec![1.0], vec![0.0; 9], vec![1.0]].concat());
    let case = |name, phase, lamp| Case { name, phase, lamp };
    vec![
        case("isotropic", Phase::Isotropic, Emitter::Isotropic),
        case("Rayleigh", Phase::Rayleigh, Emitter::Isotropic),
        case("HG 0.9", Phase::HenyeyGreenstein { g: 0.9 }, Emitter::Isotropic),
        case("spot", Phase::Isotropic, Emitter::CosinePower { exponent: 10.0 }),
        case("ball", Phase::Isotropic, ball),
    ]
}

/// Numbers in [0, 1) without correlation: the R4 sequence (Roberts 2018), powers of the root of x^5 = x + 1.
fn quasi_random(i: usize, dimension: i32) -> f64 {
    const ROOT: f64 = 1.167_303_978_261_418_7;
    (0.5 + (i + 1) as f64 * ROOT.powi(-dimension)).fract()
}

/// `count` rays: extinction 0.01 to 1/m, lamp 0.5 to 30 m away at any angle from 1° to 179°, length 1 to 100 m, every
/// eighth endless; albedo 0.8; the lamp's axis turns with the ray's number.
pub fn shots(count: usize, phase: &Phase<f64>) -> Vec<Shot> {
    let log = |x: f64, from: f64, to: f64| from * (to / from).powf(x);
    (0..count)
        .map(|i| {
            let sigma_t = log(quasi_random(i, 1), 0.01, 1.0);
            let gamma = (1.0 + 178.0 * quasi_random(i, 3)).to_radians();
            let length = if i % 8 == 7 { f64::INFINITY } else { log(quasi_random(i, 4), 1.0, 100.0) };
            let axis = 2.399_963 * i as f64;
            let sight = Sight::from_angle(gamma, log(quasi_random(i, 2), 0.5, 30.0), length);
            let sight = Sight { axis_along: 0.9 * axis.cos(), axis_across: 0.9 * axis.sin(), ..sight };
            Shot { sight, air: UniformAir { sigma_s: 0.8 * sigma_t, sigma_t, phase: phase.clone() } }
        })
        .collect()
}
