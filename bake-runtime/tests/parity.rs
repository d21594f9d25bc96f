//! Every WGSL function that has a twin in `bake-optics`: computed on the adapter over a grid and awkward inputs, compared with the
//! twin in f64. Each has its limit; a constant changed on one side must break it.

mod common;
#[path = "parity/harness.rs"]
mod harness;

#[path = "parity/air.rs"]
mod air;

use bake_optics::emitter::spot_cone;
use bake_optics::harmonics::real_sh;
use bake_optics::phase::{self, Deflection};
use bake_optics::special;
use bake_runtime::prune;
use bake_runtime::variant::{Pass, Variant};
use harness::{Case, Harness};

/// Both signs of 10^from … 10^to, `count` of each.
fn decades(from: f64, to: f64, count: usize) -> Vec<f64> {
    let step = |i: usize| 10f64.powf(from + (to - from) * i as f64 / (count - 1) as f64);
    (0..count).map(step).flat_map(|x| [x, -x]).map(|x| f64::from(x as f32)).collect()
}

fn plain() -> Variant {
    Variant::new(Pass::Air)
}

/// 10^-6 … 10^6 and a zero's neighbour.
fn positive() -> Vec<f64> {
    decades(-6.0, 6.0, 13).into_iter().filter(|y| *y > 0.0).chain([1e-30]).collect()
}

/// One argument, one result.
fn unary(
    name: &'static str,
    roots: &'static [&'static str],
    inputs: Vec<f64>,
    limit: f64,
    twin: fn(f64) -> f64,
) -> Case {
    Case {
        name,
        variant: plain(),
        roots,
        call: format!("vec4f({name}(a.x), 0.0, 0.0, 0.0)"),
        inputs: inputs.into_iter().map(|x| vec![x]).collect(),
        limit,
        twin: Box::new(move |row| (vec![twin(row[0])], 0.0)),
        ..Case::default()
    }
}

fn special_cases() -> Vec<Case> {
    let above = |least: f64| decades(-8.0, 6.0, 300).into_iter().filter(|x| *x > least).collect::<Vec<_>>();
    let mut near: Vec<f64> = decades(-8.0, 1.9, 400);
    near.extend([0.0, 0.5, -0.5, 0.499_999, 80.0]);
    vec![
        // The adapter's own exp errs by 4e-6.
        unary("phi1", &["arithmetic"], near.clone(), 1e-5, special::phi1::<f64>),
        unary("expm1", &["arithmetic"], near.into_iter().filter(|x| *x != 0.0).collect(), 1e-5, f64::exp_m1),
        unary("lam", &["arithmetic"], above(-0.999), 1e-5, special::lam::<f64>),
        unary("log1p", &["arithmetic"], above(-0.999), 1e-5, f64::ln_1p),
        unary(
            "fall",
            &["arithmetic"],
            decades(-8.0, 1.9, 200).into_iter().filter(|x| *x >= 0.0).collect(),
            1e-5,
            |x| (-x).exp(),
        ),
        Case {
            name: "angle_of",
            variant: plain(),
            roots: &["arithmetic"],
            call: "vec4f(angle_of(a.x, a.y), 0.0, 0.0, 0.0)".into(),
            inputs: pairs(&positive(), &decades(-6.0, 6.0, 61)),
            limit: 4e-7,
            twin: Box::new(|row| (vec![row[0].atan2(row[1])], 0.0)),
            ..Case::default()
        },
        Case {
            // Nearly equal products: plain arithmetic has no digit here.
            name: "difference_of_products",
            variant: plain(),
            roots: &["arithmetic"],
            call: "vec4f(difference_of_products(a.x, a.y, a.z, a.w), 0.0, 0.0, 0.0)".into(),
            inputs: (0..500u32)
                .map(|i| {
                    let (a, b) = (1.0 + f64::from(i) * 0.001_37, 2.0 + f64::from(i) * 0.000_73);
                    [a, b, a * (1.0 + 1e-6), b * (1.0 - 3e-7)].map(|x| f64::from(x as f32)).to_vec()
                })
                .collect(),
            // Against the larger product: the result itself is 1e-6 of it.
            limit: 1e-12,
            twin: Box::new(|row| (vec![row[0] * row[1] - row[2] * row[3]], row[0] * row[1])),
            ..Case::default()
        },
        Case {
            name: "scaled_e1",
            variant: plain(),
            roots: &["exponential_integral"],
            call: "vec4f(scaled_e1(a.xy), 0.0, 0.0)".into(),
            inputs: pairs(
                &[0.0, 1e-6, 1e-3, 0.1, 0.5, 1.0, 1.4, 1.6, 2.9, 3.1, 10.0, 1e3, 1e6],
                &[1e-6, 1e-3, 0.1, 0.7, 1.0, 1.5, 2.0, 3.5, 20.0, 1e4],
            ),
            limit: 2e-5,
            twin: Box::new(|row| {
                let s = special::scaled_exponential_integral(1, num_complex::Complex::new(row[0], row[1]));
                (vec![s.re, s.im], s.norm())
            }),
            ..Case::default()
        },
    ]
}

/// The lattice's harmonics, four at a time.
fn harmonic_cases() -> Vec<Case> {
    let directions = || {
        (0..64).map(|i| {
            let (turn, z) = (2.4 * f64::from(i), -1.0 + f64::from(i) / 32.0);
            let r = (1.0 - z * z).max(0.0).sqrt();
            [r * turn.cos(), r * turn.sin(), z].map(|x| f64::from(x as f32)).to_vec()
        })
    };
    let case = |first: usize| Case {
        name: "real_harmonic",
        roots: &["lattice"],
        call: format!(
            "vec4f({})",
            (first..first + 4).map(|k| format!("real_harmonic({k}u, a.xyz)")).collect::<Vec<_>>().join(", ")
        ),
        inputs: directions().collect(),
        // Absolute: harmonics pass through 0.
        limit: 1e-6,
        twin: Box::new(move |row| (real_sh([row[0], row[1], row[2]], 3)[first..first + 4].to_vec(), 1.0)),
        ..Case::default()
    };
    vec![case(0), case(4), case(5)]
}

/// Thinning of clutter; ranks and shares whose differences are exact.
fn pruning_case() -> Case {
    let ranks: Vec<f64> = (0..64).map(|i| f64::from(i) / 64.0).collect();
    Case {
        name: "scale_of_rank",
        variant: Variant::new(Pass::Surface).with("PRUNED", true),
        roots: &["pruning"],
        call: "vec4f(scale_of_rank(a.x, a.y), 0.0, 0.0, 0.0)".into(),
        inputs: pairs(&ranks, &[1.0, 0.984_375, 0.75, 0.5, 0.25, 0.125, 0.015_625]),
        limit: 1e-5,
        twin: Box::new(|row| (vec![prune::scale(row[0] as f32, row[1] as f32).into()], 1.0)),
        ..Case::default()
    }
}

fn pairs(a: &[f64], b: &[f64]) -> Vec<Vec<f64>> {
    a.iter().flat_map(|&x| b.iter().map(move |&y| vec![f64::from(x as f32), f64::from(y as f32)])).collect()
}

const ANGLES: [f64; 15] =
    [0.0, 1e-6, 1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0, 1.57, 2.0, 2.6, 3.0, 3.13, 3.1405, std::f64::consts::PI];

/// Deflections as the shader takes them: rounded parts.
fn deflection_row(angle: f64, parameter: f64) -> Vec<f64> {
    let d = Deflection::from_angle(angle);
    [d.cos_theta, d.one_minus_cos, d.one_plus_cos, parameter].map(|x| f64::from(x as f32)).to_vec()
}

fn deflection(row: &[f64]) -> Deflection<f64> {
    Deflection { cos_theta: row[0], one_minus_cos: row[1], one_plus_cos: row[2] }
}

fn phase_cases() -> Vec<Case> {
    let grid = |parameters: &[f64]| {
        ANGLES.iter().flat_map(|&a| parameters.iter().map(move |&p| deflection_row(a, p))).collect()
    };
    let call = |text: &str| format!("vec4f({text}, 0.0, 0.0, 0.0)");
    vec![
        Case {
            name: "henyey_greenstein",
            variant: plain(),
            roots: &["phase"],
            call: call("henyey_greenstein(a.w, Deflection(a.x, a.y, a.z))"),
            inputs: grid(&[-0.99, -0.5, 0.0, 1e-4, 0.3, 0.85, 0.99, 0.999]),
            limit: 1e-5,
            twin: Box::new(|row| (vec![phase::henyey_greenstein_deflected(row[3], deflection(row))], 0.0)),
            ..Case::default()
        },
        Case {
            name: "linear_phase",
            variant: plain(),
            roots: &["phase"],
            call: call("linear_phase(a.w, Deflection(a.x, a.y, a.z))"),
            inputs: grid(&[-1.0, -0.5, 0.0, 0.3, 1.0]),
            limit: 1e-6,
            twin: Box::new(|row| (vec![phase::linear_deflected(row[3], deflection(row))], 0.0)),
            ..Case::default()
        },
        Case {
            name: "rayleigh",
            variant: plain(),
            roots: &["phase"],
            call: call("rayleigh(a.x)"),
            inputs: grid(&[0.0]),
            limit: 1e-6,
            twin: Box::new(|row| (vec![phase::rayleigh(row[0])], 0.0)),
            ..Case::default()
        },
        Case {
            name: "spot_cone",
            variant: plain(),
            roots: &["emitter"],
            call: call("spot_cone(a.x, a.y, a.z)"),
            inputs: [[0.9, 0.7], [0.7, 0.7], [1.0, -0.5]]
                .iter()
                .flat_map(|c| {
                    (0..=80).map(move |i| {
                        vec![
                            f64::from(c[0] as f32),
                            f64::from(c[1] as f32),
                            f64::from((-1.0 + 0.025 * f64::from(i)) as f32),
                        ]
                    })
                })
                .collect(),
            // Absolute: the ramp begins at 0.
            limit: 1e-6,
            twin: Box::new(|row| (vec![spot_cone(row[0], row[1], row[2])], 1.0)),
            ..Case::default()
        },
    ]
}

#[test]
fn shader_functions_agree_with_their_twins() {
    let Some(harness) = Harness::open() else { return };
    let cases = special_cases()
        .into_iter()
        .chain(phase_cases())
        .chain(harmonic_cases())
        .chain([pruning_case()])
        .chain(air::cases());
    let results: Vec<_> = cases.map(|case| harness.compare(&case, |text| text)).collect();
    // Those that hold print first.
    let (held, broken): (Vec<_>, Vec<_>) = results.iter().partition(|worst| worst.holds());
    held.into_iter().chain(broken).for_each(|worst| worst.check());
}

/// Negative control: a constant changed on the shader's side only is found by the case that covers it.
#[test]
fn a_constant_changed_on_one_side_only_is_found() {
    let Some(harness) = Harness::open() else { return };
    let cases: Vec<Case> = special_cases()
        .into_iter()
        .chain(phase_cases())
        .chain(harmonic_cases())
        .chain([pruning_case()])
        .chain(air::cases())
        .collect();
    for (name, from, to) in [
        ("phi1", "x / 3.0", "x / 3.001"),
        ("lam", "1.0 / 5.0", "1.0 / 5.1"),
        ("angle_of", "1.0 / 7.0 - square", "1.0 / 7.3 - square"),
        ("difference_of_products", "0xfffff000u", "0xffffffffu"),
        ("scaled_e1", "0.5772156649", "0.5772"),
        ("henyey_greenstein", "0.0795774715459477", "0.0795"),
        ("rayleigh", "0.75", "0.7501"),
        ("real_harmonic", "0.488602512 * d.z", "0.4887 * d.z"),
        ("scale_of_rank", "0.2 *", "0.201 *"),
        ("spot_cone", "ramp * ramp", "ramp * ramp * 1.00001"),
        ("quadrature, cone", "(kept(ah * bh) - product)", "0.0 * (kept(ah * bh) - product)"),
        ("quadrature, cone", "let lead = ", "let lead = 1.0001 * "),
        ("quadrature, isotropic", "weight * 2.0 / (1.0", "weight * 2.001 / (1.0"),
        ("hull", "dot(plane.xyz, ray.origin)", "1.0001 * dot(plane.xyz, ray.origin)"),
        // Rays through edges: a tie that is no side loses a crossing.
        ("mesh", "return sign(a.y - b.y)", "return 0.0"),
        ("mesh", "winding -= list.at[i].y;", "winding = list.at[i].y - winding;"),
        ("density in a mesh", "list.winding += crossing.y", "list.winding += abs(crossing.y)"),
        ("density in a hull", "dot(plane.xyz, place)", "1.01 * dot(plane.xyz, place)"),
        ("density in a box", "place.y - medium.base", "place.y - 1.0001 * medium.base"),
        ("grid", "0.28867513459", "0.2887"),
        ("planet", "r0 * (1.0 + 2.0", "r0 * (1.0001 + 2.0"),
        ("lut", "h * (1.0 + v * v)", "h * (1.001 + v * v)"),
        ("closed form, Rayleigh", "1.5 * third.y", "1.51 * third.y"),
        ("vacuum, isotropic", "1.0 / 3.0 - square", "1.0 / 3.01 - square"),
    ] {
        let case = cases.iter().find(|case| case.name == name).expect("a case of this name");
        let changed = harness.compare(case, |text| {
            assert!(text.contains(from), "{name}: '{from}' is not in the shader");
            text.replace(from, to)
        });
        assert!(!changed.holds(), "{name}: '{from}' → '{to}' was not noticed: {:.3e}", changed.measured());
    }
}
