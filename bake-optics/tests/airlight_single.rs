//! Air-light and its parts in f32: against the f64 form at the same (rounded) inputs, over the rows of the reference tables,
//! which the f64 forms have met. Limits: a few ulp times the condition of what is exponentiated, or what the doc promises.

use bake_optics::Real;
use bake_optics::airlight::{
    Airlight, ClosedForm, IsotropicLamp, Lut, Oracle, Quadrature, Sight, UniformAir, Vacuum, macklin, sun,
};
use bake_optics::emitter::Emitter;
use bake_optics::phase::Phase;
use bake_optics::{psf, surface};
use testkit::compare::Worst;
use testkit::reference::{Row, read_csv};

fn rows(file: &str) -> Vec<Row> {
    read_csv(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(file))
}

/// The row's numbers rounded to f32.
fn numbers<const N: usize>(row: &Row, columns: [&str; N]) -> [f32; N] {
    columns.map(|column| row.number(column) as f32)
}

/// Values that f32 holds as normal numbers with room for the factors on the way.
fn in_range(value: f64) -> bool {
    value > 1e-30 && value < 1e30
}

/// Compares `single` with `double` over a table at rounded inputs; `scale` is what the error is relative to, as a multiple of the
/// value at least 1 (conditioning).
fn check<const N: usize>(
    (file, what, allowed): (&str, &str, f64),
    columns: [&str; N],
    single: impl Fn([f32; N]) -> f32,
    double: impl Fn([f64; N]) -> f64,
    condition: impl Fn([f64; N]) -> f64,
) {
    let mut worst = Worst::new(format!("{what} f32"), allowed);
    for row in rows(file) {
        let inputs = numbers(&row, columns);
        let wide = inputs.map(f64::from);
        let want = double(wide);
        if in_range(want) {
            let error = (f64::from(single(inputs)) / want - 1.0).abs() / condition(wide);
            worst.record(error, || format!("{inputs:?}: {} want {want}", single(inputs)));
        }
    }
    worst.check();
}

#[test]
fn difference_of_f_in_single_precision() {
    check(
        ("sun_fdiff.csv", "dF(u, t1, t2), per unit of u t1", 1e-6),
        ["u", "t1", "t2"],
        |[u, a, b]| sun::f_difference(u, a, b),
        |[u, a, b]| sun::f_difference(u, a, b),
        |[u, a, _]| 1.0 + u * a,
    );
    // Tangents of the table's angles, rounded; an f32 angle next to π/2 would have none.
    let mut even = Worst::new("F_k f32, of F_0", 1e-6);
    for row in rows("sun_fk.csv") {
        let (k, u, t) = (row.number("k") as u32, row.number("u") as f32, row.number("v_rad").tan() as f32);
        let wide = |k| sun::f_k_difference(k, f64::from(u), 0.0, f64::from(t));
        let error = (f64::from(sun::f_k_difference(k, u, 0.0, t)) - wide(k)).abs() / wide(0);
        even.record(error, || format!("k {k} u {u} t {t}"));
    }
    even.check();
}

#[test]
fn moments_in_single_precision() {
    for k in 0..5 {
        check(
            ("vacuum_series.csv", &format!("M_{k}"), 1e-6),
            ["z_a", "h", "z_b"],
            |[z, h, end]| macklin::extinction_moments(z, h, end - z)[k],
            |[z, h, end]| macklin::extinction_moments(z, h, end - z)[k],
            |_| 1.0,
        );
    }
}

#[test]
fn surface_and_glow_in_single_precision() {
    let columns = ["cos_power", "T_sp", "theta_s_rad"];
    let g = |[n, t, theta]: [f64; 3]| surface::g(n, t, theta);
    let against_front = |[n, t, theta]: [f64; 3]| (0.01 * g([n, t, 0.0]) / g([n, t, theta])).max(1.0) + t;
    check(("sun_g.csv", "G_n, per unit of T", 4e-6), columns, |[n, t, th]| surface::g(n, t, th), g, against_front);
    let columns = ["gamma_rad", "T_sv"];
    check(
        ("sun_npsf.csv", "PSF, per unit of T", 2e-6),
        columns,
        |[g, t]| psf::psf(g, t),
        |[g, t]| psf::psf(g, t),
        |[_, t]| 1.0 + t,
    );
    check(("sun_npsf.csv", "NPSF", 2e-6), columns, |[g, _]| psf::npsf(g), |[g, _]| psf::npsf(g), |_| 1.0);
    let mut worst = Worst::new("glow factors f32, of the first, per unit of T", 1e-6);
    for t in [1e-3f32, 0.3, 1.3, 8.0] {
        let (single, double) = (psf::convolution_factors(t, 16), psf::convolution_factors(f64::from(t), 16));
        for l in 0..16 {
            let error = (f64::from(single[l]) - double[l]).abs() / double[0] / (1.0 + f64::from(t));
            worst.record(error, || format!("t {t} l {l}"));
        }
    }
    worst.check();
}

fn widen(sight: &Sight<f32>) -> Sight<f64> {
    let Sight { z, h, length, axis_along, axis_across } = *sight;
    let [z, h, length, axis_along, axis_across] = [z, h, length, axis_along, axis_across].map(f64::from);
    Sight { z, h, length, axis_along, axis_across }
}

fn widen_air(air: &UniformAir<f32>) -> UniformAir<f64> {
    let phase = match &air.phase {
        Phase::Isotropic => Phase::Isotropic,
        Phase::Rayleigh => Phase::Rayleigh,
        Phase::Linear { a1 } => Phase::Linear { a1: f64::from(*a1) },
        Phase::HenyeyGreenstein { g } => Phase::HenyeyGreenstein { g: f64::from(*g) },
        other => panic!("{other:?} is not in the tables"),
    };
    UniformAir { sigma_s: air.sigma_s.into(), sigma_t: air.sigma_t.into(), phase }
}

/// The rays and air of both air-light tables that have an isotropic lamp.
fn shots() -> Vec<(Sight<f32>, UniformAir<f32>)> {
    let sun = rows("sun_airlight.csv").into_iter().map(|row| {
        let [gamma, t_sv, t_vp, beta] = ["gamma_rad", "T_sv", "T_vp", "beta_per_m"].map(|name| row.number(name));
        let Sight { z, h, length, .. } = Sight::from_angle(gamma, t_sv / beta, t_vp / beta);
        let sight = Sight { z: z as f32, h: h as f32, length: length as f32, axis_along: 1.0, axis_across: 0.0 };
        (sight, UniformAir { sigma_s: beta as f32, sigma_t: beta as f32, phase: Phase::Isotropic })
    });
    let general = rows("airlight_general.csv").into_iter().filter(|row| row.text("light") == "iso").map(|row| {
        let n = |name| row.number(name);
        let length = (n("x_b") - n("x_a")) as f32;
        let z = (n("x_a") - n("x_h")) as f32;
        let sight = Sight { z, h: n("h") as f32, length, axis_along: 1.0, axis_across: 0.0 };
        let parameter = n("phase_param") as f32;
        let phase = match row.text("phase") {
            "iso" => Phase::Isotropic,
            "ray" => Phase::Rayleigh,
            "lin" => Phase::Linear { a1: parameter },
            _ => Phase::HenyeyGreenstein { g: parameter },
        };
        (sight, UniformAir { sigma_s: n("kappa_s") as f32, sigma_t: n("kappa_t") as f32, phase })
    });
    sun.chain(general).collect()
}

fn peak<T: Real>(phase: &Phase<T>) -> f64 {
    if let Phase::HenyeyGreenstein { g } = phase { g.as_f64().abs() } else { 0.0 }
}

/// What an error is relative to.
#[derive(Clone, Copy)]
enum Scale {
    /// The value itself.
    Value,
    /// The larger of the value and that of isotropic air: sums of Legendre terms cancel where the phase function is dark.
    Isotropic,
}

/// Largest error of a method over the shots for which `which` holds, e^{−T} sensitivity to the rounding of T taken out.
fn method(
    (what, allowed, scale): (&str, f64, Scale),
    which: impl Fn(&Sight<f32>, &UniformAir<f32>) -> bool,
    single: impl Fn(&Sight<f32>, &UniformAir<f32>) -> f32,
) -> Worst {
    let mut worst = Worst::new(format!("{what}, f32"), allowed);
    for (sight, air) in shots().iter().filter(|(sight, air)| which(sight, air)) {
        let truth = |air: &UniformAir<f64>| Oracle::default().radiance(&widen(sight), &Emitter::Isotropic, air);
        let want = truth(&widen_air(air));
        let scale = match scale {
            Scale::Value => want,
            Scale::Isotropic => want.max(truth(&UniformAir { phase: Phase::Isotropic, ..widen_air(air) })),
        };
        if in_range(want) && want.is_finite() {
            let ulp = f64::from(f32::EPSILON) * f64::from(air.sigma_t * sight.eye_distance());
            let error = (f64::from(single(sight, air)) - want).abs() / scale;
            worst.record((error - ulp).max(0.0), || format!("{sight:?} {air:?} want {want}"));
        }
    }
    worst
}

#[test]
fn quadrature_in_single_precision() {
    let by = |nodes: usize| {
        move |sight: &Sight<f32>, air: &UniformAir<f32>| {
            Quadrature::new(nodes).radiance(sight, &Emitter::Isotropic, air)
        }
    };
    let smooth = |_: &Sight<f32>, air: &UniformAir<f32>| peak(&air.phase) <= 0.5;
    let moderate = |_: &Sight<f32>, air: &UniformAir<f32>| (0.5..0.85).contains(&peak(&air.phase));
    method(("24+24 nodes, smooth phase functions", 1e-5, Scale::Value), smooth, by(24)).check();
    method(("24+24 nodes, |g| = 0.75", 1e-5, Scale::Value), moderate, by(24)).check();
    method(("16+16 nodes, smooth phase functions", 3e-5, Scale::Value), smooth, by(16)).check();
    assert!(!method(("4+4 nodes (negative control)", 3e-5, Scale::Value), smooth, by(4)).holds());
}

#[test]
fn closed_form_in_single_precision() {
    let low = |_: &Sight<f32>, air: &UniformAir<f32>| peak(&air.phase) == 0.0;
    let ours = |sight: &Sight<f32>, air: &UniformAir<f32>| ClosedForm::default().radiance(sight, &IsotropicLamp, air);
    method(("closed form, degree 0 to 2", 3e-5, Scale::Isotropic), low, ours).check();
    // Phase functions that f32 cannot expand go to quadrature: no worse than it.
    let peaked = |_: &Sight<f32>, air: &UniformAir<f32>| (0.1..0.85).contains(&peak(&air.phase));
    method(("closed form, Henyey-Greenstein", 1e-5, Scale::Value), peaked, ours).check();
    let plain = |sight: &Sight<f32>, air: &UniformAir<f32>| two_ends(sight, air);
    let isotropic = |s: &Sight<f32>, air: &UniformAir<f32>| air.phase == Phase::Isotropic && s.h > 0.0;
    assert!(!method(("two E_1 everywhere (negative control)", 1e-3, Scale::Value), isotropic, plain).holds());
}

/// Isotropic air-light as two exponential integrals and no fallback (Sun et al. 2005, eq. 11, scaled).
fn two_ends(sight: &Sight<f32>, air: &UniformAir<f32>) -> f32 {
    use bake_optics::special::{Complex, scaled_exponential_integral};
    let (h, eye) = (air.sigma_t * sight.h, sight.eye_distance());
    let end = |v: f32| -scaled_exponential_integral(1, Complex::new(h * v, h)).im;
    let excess = sight.excess(sight.length.min(f32::MAX));
    let start = sight.behind() / sight.h;
    let near = (-air.sigma_t * eye).exp() * end(start);
    let far = (-air.sigma_t * (eye + excess)).exp();
    let far = if far > 0.0 { far * end(start + excess / sight.h) } else { 0.0 };
    air.sigma_s / (2.0 * std::f32::consts::PI * sight.h) * (near - far)
}

#[test]
fn sun_airlight_takes_plain_numbers() {
    let columns = ["gamma_rad", "T_sv", "T_vp", "beta_per_m"];
    let away = |[gamma, t, v, _]: [f64; 4]| {
        // Turning the ray by the rounding of γ moves it by ulp/γ, at worst across the lamp.
        let miss = (t * gamma.sin()).hypot((v - t * gamma.cos()).min(0.0)) / t;
        (1.0 + t) * (1.0 + 1e-3 / miss)
    };
    check(
        ("sun_airlight.csv", "isotropic air-light, per unit of T", 1e-5),
        columns,
        |[g, t, v, b]| sun::airlight(g, t, v, b),
        |[g, t, v, b]| sun::airlight(g, t, v, b),
        away,
    );
}

#[test]
fn tables_look_up_alike_in_both_precisions() {
    let (lut, table) = (Lut::new(64, 3), surface::SurfaceTable::new(16, 1.0));
    let mut tail = Worst::new("Lut look-up f32 against f64, same table", 1e-5);
    let mut ground = Worst::new("surface look-up f32 against f64, same table", 1e-5);
    for i in 0..=60 {
        for j in 0..=40 {
            let (h, v) = (10f32.powf(i as f32 * 0.15 - 6.0), 10f32.powf(j as f32 * 0.2 - 4.0));
            for l in 0..3 {
                // Relative to the isotropic one: higher orders change sign.
                let (got, want) = (lut.tail(l, h, v), lut.tail(l, f64::from(h), f64::from(v)));
                let scale = lut.tail(0, f64::from(h), f64::from(v));
                tail.record((f64::from(got) - want).abs() / scale, || format!("l {l} h {h} v {v}"));
            }
            let (t, theta) = (h.min(40.0), j as f32 * 0.078);
            let want = table.look_up(f64::from(t), f64::from(theta));
            let error = (f64::from(table.look_up(t, theta)) / want - 1.0).abs() / f64::from(1.0 + t);
            ground.record(error, || format!("t {t} theta {theta}"));
        }
    }
    tail.check();
    ground.check();
    // Whole rays: as good as the table is where they pass the lamp.
    let passes = |s: &Sight<f32>, air: &UniformAir<f32>| {
        peak(&air.phase) == 0.0
            && s.z < 0.0
            && s.length > 2.0 * s.eye_distance()
            && s.h > 1e-3 * s.eye_distance()
            && air.sigma_t * s.eye_distance() < 30.0
    };
    method(("64² table on long rays", 1e-3, Scale::Isotropic), passes, |s, air| lut.radiance(s, &IsotropicLamp, air))
        .check();
}

#[test]
fn an_endless_ray_in_a_table_without_extinction_is_the_vacuum() {
    let lut = Lut::new(64, 1);
    let air = UniformAir { sigma_s: 1.0f64, sigma_t: 0.0, phase: Phase::Isotropic };
    let single = UniformAir { sigma_s: 1.0f32, sigma_t: 0.0, phase: Phase::Isotropic };
    for (z, h) in [(-3.0, 0.5), (0.0, 1.0), (2.0, 0.3)] {
        let sight = Sight { z, h, length: f64::INFINITY, axis_along: 1.0, axis_across: 0.0 };
        let want = Vacuum::default().radiance(&sight, &IsotropicLamp, &air);
        let got = lut.radiance(&sight, &IsotropicLamp, &air);
        assert!((got / want - 1.0).abs() < 2e-3, "{got} want {want}");
        let sight = Sight { z: z as f32, h: h as f32, length: f32::INFINITY, axis_along: 1.0, axis_across: 0.0 };
        let got = f64::from(lut.radiance(&sight, &IsotropicLamp, &single));
        assert!((got / want - 1.0).abs() < 2e-3, "f32: {got} want {want}");
    }
}
