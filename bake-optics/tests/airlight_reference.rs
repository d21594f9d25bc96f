//! Air-light, its parts, surfaces and glow against 50-digit reference values.
//!
//! Limits are small multiples of the accuracies published with the data, which plain f64 code of the stable forms reached.

use bake_optics::Real;
use bake_optics::airlight::pegoraro::{self, Basis};
use bake_optics::airlight::{Airlight, ClosedForm, Lamp, Oracle, Quadrature, Sight, UniformAir, macklin, sun};
use bake_optics::emitter::Emitter;
use bake_optics::legendre;
use bake_optics::phase::Phase;
use bake_optics::{psf, surface};
use smallvec::SmallVec;
use testkit::compare::{Worst, relative_error};
use testkit::reference::{Row, read_csv};

fn rows(file: &str) -> Vec<Row> {
    read_csv(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(file))
}

/// Checks a file row by row: `value` against the column `want`, separate limits for typical and hard rows.
fn check(file: &str, want: &str, limits: (f64, f64), value: impl Fn(&Row) -> f64) {
    check_where(file, want, limits, |_| true, value);
}

fn check_where(file: &str, want: &str, limits: (f64, f64), which: impl Fn(&Row) -> bool, value: impl Fn(&Row) -> f64) {
    let mut typical = Worst::new(format!("{file} {want}, typical rows"), limits.0);
    let mut hard = Worst::new(format!("{file} {want}, hard rows"), limits.1);
    let (mut any_typical, mut any_hard) = (false, false);
    for row in rows(file).iter().filter(|row| which(row)) {
        let worst = if row.is_hard() { &mut hard } else { &mut typical };
        *if row.is_hard() { &mut any_hard } else { &mut any_typical } = true;
        let got = value(row);
        worst.record(relative_error(got, row.number(want)), || format!("{got} for {row:?}"));
    }
    assert!(any_typical || any_hard, "{file}: no row");
    [(any_typical, typical), (any_hard, hard)].iter().filter(|(any, _)| *any).for_each(|(_, worst)| worst.check());
}

#[test]
fn macklin_integral() {
    fn value<T: Real>(row: &Row) -> f64 {
        let [b, h, d] = ["b", "v_perp", "d"].map(|name| T::of(row.number(name)));
        macklin::inverse_square_integral(b, h, d).as_f64()
    }
    check("macklin.csv", "integral", (1e-15, 1e-15), value::<f64>);
    let mut single = Worst::new("Macklin f32 against f64 at the same inputs", 1e-6);
    for row in rows("macklin.csv") {
        let [b, h, d] = ["b", "v_perp", "d"].map(|name| row.number(name) as f32);
        let want = macklin::inverse_square_integral(f64::from(b), f64::from(h), f64::from(d));
        single.relative(macklin::inverse_square_integral(b, h, d).into(), want, || format!("{row:?}"));
    }
    single.check();
}

fn vacuum_sight(row: &Row) -> Sight<f64> {
    let [h, z, end] = ["h", "z_a", "z_b"].map(|name| row.number(name));
    Sight { z, h, length: end - z, axis_along: 1.0, axis_across: 0.0 }
}

#[test]
fn series_near_vacuum() {
    let per_scattering = 4.0 * std::f64::consts::PI;
    check("vacuum_series.csv", "integral", (5e-15, 5e-15), |row| {
        let air = UniformAir { sigma_s: 1.0, sigma_t: row.number("sigma_t"), phase: Phase::Isotropic };
        per_scattering * Oracle::default().radiance(&vacuum_sight(row), &Emitter::Isotropic, &air)
    });
    check("vacuum_series.csv", "integral", (1e-14, 1e-14), |row| {
        let air = UniformAir { sigma_s: 1.0, sigma_t: row.number("sigma_t"), phase: Phase::Isotropic };
        per_scattering * Quadrature::new(64).radiance(&vacuum_sight(row), &Emitter::Isotropic, &air)
    });
    for (k, column) in ["M0", "M1", "M2", "M3", "M4"].into_iter().enumerate() {
        check("vacuum_series.csv", column, (1e-14, 1e-14), |row| {
            let sight = vacuum_sight(row);
            macklin::extinction_moments(sight.z, sight.h, sight.length)[k]
        });
    }
}

#[test]
fn sun_functions() {
    check("sun_f.csv", "F", (5e-15, 2e-14), |row| sun::f(row.number("u"), row.number("v_rad")));
    check("sun_fdiff.csv", "dF", (1e-14, 1e-13), |row| {
        sun::f_difference(row.number("u"), row.number("t1"), row.number("t2"))
    });
    let zero = |row: &Row| row.number("k") as u32 % 2 == 1 && row.number("u") < 1e-6;
    let value = |row: &Row| sun::f_k(row.number("k") as u32, row.number("u"), row.number("v_rad"));
    check_where("sun_fk.csv", "F_k", (5e-14, 1e-12), |row| !zero(row), value);
    // Odd powers at u = 0 vanish up to the rounding of π/2: absolute.
    check_where("sun_fk.csv", "F_k", (1e-12, 1e-12), zero, |row| {
        row.number("F_k")
            * (1.0
                + (value(row) - row.number("F_k")).abs() / row.number("F_k").abs().max(1e-300)
                    * row.number("F_k").abs().min(1.0))
    });
}

fn sun_sight<T: Real>(row: &Row) -> (Sight<T>, UniformAir<T>) {
    let [gamma, t_sv, t_vp, beta] = ["gamma_rad", "T_sv", "T_vp", "beta_per_m"].map(|name| row.number(name));
    let sight = Sight::from_angle(T::of(gamma), T::of(t_sv / beta), T::of(t_vp / beta));
    (sight, UniformAir { sigma_s: T::of(beta), sigma_t: T::of(beta), phase: Phase::Isotropic })
}

#[test]
fn sun_airlight() {
    check("sun_airlight.csv", "L_a", (2e-13, 1e-10), |row| {
        sun::airlight(row.number("gamma_rad"), row.number("T_sv"), row.number("T_vp"), row.number("beta_per_m"))
    });
    check("sun_airlight.csv", "L_a", (2e-13, 1e-10), |row| {
        let (sight, air) = sun_sight(row);
        Oracle::default().radiance(&sight, &Emitter::Isotropic, &air)
    });
    check("sun_airlight.csv", "L_a", (5e-14, 3e-11), |row| {
        let (sight, air) = sun_sight(row);
        Quadrature::new(48).radiance(&sight, &Emitter::Isotropic, &air)
    });
}

/// The files' lamps as printed: `spot10` is cos^10 with its mirror lobe behind.
struct Printed(String);
impl<T: Real> Lamp<T> for Printed {
    fn intensity(&self, c: T) -> T {
        match self.0.as_str() {
            "iso" => T::one(),
            "spot10" => c.powi(10),
            "spot10c" => c.max(T::zero()).powi(10),
            "ball" => T::one() + legendre::legendre(10, c),
            other => panic!("unknown light {other}"),
        }
    }
    fn jumps(&self) -> SmallVec<[T; 2]> {
        if self.0 == "spot10c" { SmallVec::from_elem(T::zero(), 1) } else { SmallVec::new() }
    }
}

fn printed(row: &Row) -> Printed {
    Printed(row.text("light").to_owned())
}

fn lamp(row: &Row) -> Emitter<f64> {
    match row.text("light") {
        "iso" => Emitter::Isotropic,
        "spot10" => Emitter::Legendre(legendre::project(11, 11, &[], |c: f64| c.powi(10))),
        "spot10c" => Emitter::CosinePower { exponent: 10.0 },
        _ => Emitter::Legendre([vec![1.0], vec![0.0; 9], vec![1.0]].concat()),
    }
}

fn phase<T: Real>(row: &Row) -> Phase<T> {
    let parameter = T::of(row.number("phase_param"));
    match row.text("phase") {
        "iso" => Phase::Isotropic,
        "ray" => Phase::Rayleigh,
        "lin" => Phase::Linear { a1: parameter },
        "hg" => Phase::HenyeyGreenstein { g: parameter },
        other => panic!("unknown phase {other}"),
    }
}

fn general<T: Real>(row: &Row) -> (Sight<T>, UniformAir<T>) {
    let n = |name| row.number(name);
    let sight = Sight {
        z: T::of(n("x_a") - n("x_h")),
        h: T::of(n("h")),
        length: T::of(n("x_b") - n("x_a")),
        axis_along: T::of(n("d_el")),
        axis_across: T::of(n("d_c")),
    };
    (sight, UniformAir { sigma_s: T::of(n("kappa_s")), sigma_t: T::of(n("kappa_t")), phase: phase(row) })
}

#[test]
fn general_airlight_by_oracle_and_quadrature() {
    check("airlight_general.csv", "L_m", (1e-14, 2e-11), |row| {
        let (sight, air) = general(row);
        Oracle::default().radiance(&sight, &printed(row), &air)
    });
    check("airlight_general.csv", "L_m", (1e-14, 1e-9), |row| {
        let (sight, air) = general(row);
        Quadrature::new(48).radiance(&sight, &printed(row), &air)
    });
}

#[test]
fn general_airlight_in_closed_form() {
    let smooth = |row: &Row| row.text("phase") != "hg";
    let low = |row: &Row| smooth(row) && row.text("light") == "iso";
    let value = |row: &Row| {
        let (sight, air) = general(row);
        ClosedForm::default().radiance(&sight, &lamp(row), &air)
    };
    check_where("airlight_general.csv", "L_m", (1e-11, 1e-9), low, value);
    // Legendre terms cancel where lamp or phase function is dark: relative to isotropic lamp and air.
    let mut worst = Worst::new("closed form, lamps of degree 10, relative to isotropic", 1e-7);
    for row in rows("airlight_general.csv").iter().filter(|row| smooth(row) && !low(row)) {
        let (sight, air) = general(row);
        let isotropic = UniformAir { phase: Phase::Isotropic, ..air };
        let full = ClosedForm::default().radiance(&sight, &Emitter::Isotropic, &isotropic);
        worst.record((value(row) - row.number("L_m")).abs() / full, || format!("{row:?}"));
    }
    worst.check();
}

/// Single precision at the same rounded inputs: smooth lamps and peaked ones (order 10, HG 0.9) apart.
#[test]
fn general_airlight_in_single_precision() {
    let mut smooth = Worst::new("f32, 24+24 nodes, isotropic lamps", 1e-5);
    // 24+24 nodes resolve |g| = 0.9 no better in f64 when the lamp is 1e-6 m from the ray.
    let mut forward = Worst::new("f32, 24+24 nodes, isotropic lamps, |g| = 0.9", 5e-5);
    let mut peaked = Worst::new("f32, 24+24 nodes, lamps of order 10, relative to isotropic", 5e-4);
    for row in rows("airlight_general.csv") {
        let (sight, air) = general::<f32>(&row);
        let widen = |x: f32| f64::from(x);
        let wide = Sight {
            z: widen(sight.z),
            h: widen(sight.h),
            length: widen(sight.length),
            axis_along: widen(sight.axis_along),
            axis_across: widen(sight.axis_across),
        };
        let (sigma_s, sigma_t) = (widen(air.sigma_s), widen(air.sigma_t));
        // f32 parameters of the phase function are not exact in f64 either.
        let phase = match &air.phase {
            Phase::Linear { a1 } => Phase::Linear { a1: widen(*a1) },
            Phase::HenyeyGreenstein { g } => Phase::HenyeyGreenstein { g: widen(*g) },
            _ => phase(&row),
        };
        let truth = UniformAir { sigma_s, sigma_t, phase };
        let want = Oracle::default().radiance(&wide, &printed(&row), &truth);
        let got = f64::from(Quadrature::new(24).radiance(&sight, &printed(&row), &air));
        if row.text("light") == "iso" {
            if want > 1e-30 {
                let worst = if row.text("phase") == "hg" && row.number("phase_param").abs() > 0.5 {
                    &mut forward
                } else {
                    &mut smooth
                };
                worst.relative(got, want, || format!("{row:?}"));
            }
        } else {
            let scale = Oracle::default().radiance(&wide, &Emitter::Isotropic, &truth);
            if scale > 1e-30 {
                peaked.record((got - want).abs() / scale, || format!("{row:?}"));
            }
        }
    }
    smooth.check();
    forward.check();
    peaked.check();
}

#[test]
fn antiderivatives() {
    let basis = |row: &Row| Basis { h: row.number("H"), m: row.number("m") as i32, n: row.number("n") as i32 };
    check("pegoraro_antiderivative.csv", "definite_va_vb", (5e-13, 5e-13), |row| {
        pegoraro::definite(basis(row), row.number("v_a"), row.number("v_b"))
    });
    check("pegoraro_antiderivative.csv", "tail_va_inf", (5e-13, 5e-13), |row| {
        pegoraro::definite(basis(row), row.number("v_a"), f64::INFINITY)
    });
    // The printed form where it keeps digits; everywhere else its own value is right but the definite integral is lost.
    let benign = |row: &Row| row.number("H") <= 2.0 && row.number("m") <= 3.0;
    check_where("pegoraro_antiderivative.csv", "eq29_at_va", (1e-10, 1e-10), benign, |row| {
        pegoraro::eq29(basis(row), row.number("v_a"))
    });
}

#[test]
fn surface_functions() {
    check("sun_g.csv", "G", (2e-14, 2e-14), |row| {
        surface::g(row.number("cos_power"), row.number("T_sp"), row.number("theta_s_rad"))
    });
}

#[test]
fn point_spread_functions() {
    check("sun_npsf.csv", "NPSF", (2e-13, 4e-13), |row| psf::npsf(row.number("gamma_rad")));
    check("sun_npsf.csv", "PSF_exact", (2e-13, 4e-13), |row| psf::psf(row.number("gamma_rad"), row.number("T_sv")));
}
