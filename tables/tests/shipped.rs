//! The tables that ship with the program, through their look-up, against references, anchors and direct evaluation.

use bake_optics::phase::Phase;
use tables::axial::HARMONICS;
use tables::transport::phase_basis::PhaseBasis;
use tables::{Air, Scatter, TableSet, ZonalResponse, area};
use testkit::compare::Worst;
use testkit::reference::{self, Row};

fn hg(g: f64) -> Air {
    Air { albedo: 1.0, phase: if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } } }
}

/// Compares a response with rows of equal distance: errors of l = 0.
fn compare(worst: &mut Worst, response: &ZonalResponse, group: &[Row], column: &str, what: &str) {
    let d = group[0].number("d");
    let mut got = [0.0f32; 11];
    response.coefficients(1.0, d as f32, &mut got);
    for row in group {
        let l = row.number("l") as usize;
        let error = (f64::from(got[l]) - row.number(column)).abs() / group[0].number(column);
        worst.record(error, || format!("{what} d {d} l {l}"));
    }
}

#[test]
fn order_one_of_point_and_directional_light_meets_the_references() {
    let set = TableSet::embedded();
    for (file, directional) in [("zh_point_single.csv", false), ("zh_directional_single.csv", true)] {
        let Some(path) = reference::shared(&format!("reference/{file}")) else { return };
        let mut worst = Worst::new(format!("shipped tables against {file}, of l = 0"), 1e-3);
        let rows = reference::read_csv(&path);
        for group in rows.chunk_by(|a, b| a.text("d") == b.text("d") && a.text("g") == b.text("g")) {
            let air = hg(group[0].number("g"));
            let response =
                if directional { set.directional(&air, Scatter::Single) } else { set.point(&air, Scatter::Single) };
            compare(&mut worst, &response, group, "L_scatter", &format!("g {}", group[0].text("g")));
        }
        worst.check();
    }
}

#[test]
fn higher_orders_of_a_point_light_meet_the_references() {
    let Some(path) = reference::shared("reference/zh_point_multi.csv") else { return };
    let mut worst = Worst::new("shipped tables against zh_point_multi.csv, of l = 0", 3e-3);
    let curves = TableSet::embedded().table("point.orders");
    let rows: Vec<_> = reference::read_csv(&path).into_iter().filter(|r| r.number("k") >= 2.0).collect();
    for group in rows.chunk_by(|a, b| a.text("d") == b.text("d") && a.text("k") == b.text("k")) {
        let (d, k) = (group[0].number("d"), group[0].number("k") as usize);
        let got = curves.look_up(d);
        for row in group {
            let l = row.number("l") as usize;
            let error = (f64::from(got[(k - 2) * 11 + l]) - row.number("L_kl")).abs() / group[0].number("L_kl");
            worst.record(error, || format!("d {d} k {k} l {l}"));
        }
    }
    worst.check();
}

#[test]
fn area_coefficients_agree_with_direct_evaluation_at_every_angle() {
    let set = TableSet::embedded();
    // At g = 0.5 twenty tables of 16 bits add up to a small number where the emitter faces away: 5e-3 of that number.
    for (g, allowed) in [(0.0, 3e-3), (0.5, 6e-3)] {
        let mut worst = Worst::new(format!("area order 1, g = {g}, of l = 0 at the same angle"), allowed);
        let response = set.area(&hg(g), Scatter::Single);
        let basis = PhaseBasis::Functions(vec![hg(g).phase]);
        for d in [1e-3, 0.0137, 0.1, 0.71, 2.3, 6.1] {
            for degrees in [0.0, 7.0, 31.0, 58.0, 77.0, 86.0, 90.0, 93.0, 101.0, 127.0, 161.0, 180.0f64] {
                let theta = degrees.to_radians();
                let want = &area::compute_exact(d, theta, &basis, &HARMONICS, 48)[0];
                let got = response.coefficients(1.0, d as f32, theta.cos() as f32);
                for (h, &(l, m)) in HARMONICS.iter().enumerate() {
                    let full = f64::from(got[h]) * theta.sin().powi(m as i32) * d * d.exp();
                    worst.record((full - want[h]).abs() / want[0], || format!("d {d} theta {degrees} l {l} m {m}"));
                }
            }
        }
        worst.check();
    }
}

#[test]
fn all_orders_integrate_to_the_fluence_of_the_anchors() {
    let set = TableSet::embedded();
    let mut worst = Worst::new("fluence of all orders at r = 1", 1e-3);
    for (albedo, want) in [(1.0, 2.912150), (0.7, 0.704525), (0.5, 0.369705)] {
        let air = Air::isotropic(albedo);
        let fluence: f32 = [Scatter::Single, Scatter::AllMultiple]
            .map(|scatter| {
                let mut c = [0.0f32; 11];
                set.point(&air, scatter).coefficients(1.0, 1.0, &mut c);
                c[0] * (4.0 * std::f32::consts::PI).sqrt()
            })
            .iter()
            .sum();
        worst.relative(f64::from(fluence), want, || format!("albedo {albedo}"));
    }
    worst.check();
}
