//! The tables that ship with the program, through their look-up, against references, anchors and direct evaluation.

use bake_formats::table_file::{Precision, TableFile};
use bake_optics::phase::Phase;
use glam::Vec3;
use tables::axial::HARMONICS;
use tables::curves::Grid;
use tables::transport::phase_basis::PhaseBasis;
use tables::transport::slab::SlabSource;
use tables::transport::sources::Source;
use tables::{
    Air, Geometry, Layout, Recipe, Scatter, TableSet, ZonalResponse, ZonalRgb, accuracy, area, axial, directional,
    point,
};
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
    for g in [0.0, 0.5] {
        let mut worst = Worst::new(format!("area order 1, g = {g}, of l = 0 at the same angle"), 3e-3);
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

/// Values of one row of a table of the embedded file as stored.
fn stored_row(file: &TableFile, name: &str, row: usize) -> (Vec<f32>, f32) {
    let table = file.manifest.tables.iter().position(|t| t.name == name).expect("a name of the set");
    let entry = &file.manifest.tables[table];
    let unit = match entry.precision {
        Precision::F16 => 0.5f32.powi(11),
        Precision::F24 => 0.5f32.powi(16),
        // Another machine's exponential may differ in the last bit of f64, and with it the last of f32.
        Precision::F32 => 0.5f32.powi(22),
    };
    (file.values[table][row * entry.columns..(row + 1) * entry.columns].to_vec(), unit)
}

/// A few nodes of every kind of table are computed anew and must be those of the file; the long form makes the whole file, byte for
/// byte.
#[test]
fn the_embedded_file_is_what_its_recipe_makes() {
    let file = TableFile::from_bytes(tables::set::embedded_bytes(), "embedded").expect("the program's own");
    let recipe = Recipe::default();
    assert_eq!(file.manifest.recipe, serde_json::to_value(recipe).expect("plain values"), "the recipe has changed");
    let basis = recipe.basis();
    let (source, slab) = ([Source::order(1)], SlabSource::order(None));
    let mut worst = Worst::new("nodes computed anew, in units of storage (1, and a little for rounding twice)", 1.01);
    let mut control = Worst::new("the same against the next node", 1.01);
    for node in [1usize, 50, 101] {
        let d = recipe.grid.distance(node as f64);
        let computed = [
            ("point.single", point::compute_single(d, &basis, 11).concat()),
            ("point.orders", point::compute_multiple(d, &source[0], 11)),
            ("directional.single", directional::compute_single(d, &basis, 11).concat()),
            ("directional.orders", directional::compute_multiple(d, &slab, 11)),
            ("area.single", area::compute_single(d, &basis, &recipe.angles)),
            ("axial.orders", axial::compute_multiple(d, &source).concat()),
        ];
        for (name, values) in computed {
            let compare = |row: usize, worst: &mut Worst| {
                let (stored, unit) = stored_row(&file, name, row);
                for (i, (a, b)) in stored.iter().zip(&values).enumerate() {
                    // Below 1e-5 of the first value f16 comes near its smallest number.
                    let allowed = f64::from(unit) * b.abs().max(1e-5 * values[0].abs());
                    worst.record((f64::from(*a) - b).abs() / allowed, || format!("{name} node {node} column {i}"));
                }
            };
            compare(node + 1, &mut worst);
            compare(node + 2, &mut control);
        }
    }
    worst.check();
    assert!(!control.holds(), "other nodes must not pass");
    if std::env::var_os("BAKE_LONG").is_some() {
        let again = tables::generate(&recipe, &|_, _| ()).to_bytes();
        assert!(again == tables::set::embedded_bytes(), "`cargo run --release -p tables --example default_tables`");
    }
}

/// What a table may state at most: once-scattered light of a point and directional light 0.1 % of l = 0, all else 0.3 %.
fn promised(table: &str) -> f64 {
    if ["point.single", "directional.single"].contains(&table) { 1e-3 } else { 3e-3 }
}

/// The stated errors are bounds at places of the test's own, no idle ones, and no larger than promised.
#[test]
fn the_embedded_file_errs_by_no_more_than_it_states() {
    let file = TableFile::from_bytes(tables::set::embedded_bytes(), "embedded").expect("the program's own");
    let long = std::env::var_os("BAKE_LONG").is_some();
    let count = if long { 1500 } else { 12 };
    for check in accuracy::verify(&file, count, 5).expect("whole") {
        let mut worst = Worst::new(format!("look-up error of {}, of l = 0", check.table), check.stored);
        worst.record(check.measured, || format!("{count} places"));
        worst.check();
        assert!(check.holds && check.stored <= promised(&check.table), "{check:?}");
        // A tenth of a bound must fail at any places; at many, all of it is nearly met. (An area's angle goes with the distance and
        // misses what is worst in both.)
        let share = if check.table == "area.single" { 0.4 } else { 0.85 };
        assert!(check.measured > if long { share } else { 0.1 } * check.stored, "{check:?}");
    }
}

/// A file of fifteen bands is written and read; its irradiance is the sum of all of them, one light or three at a time.
#[test]
fn a_file_of_fifteen_bands_comes_back_and_all_of_them_count() {
    let recipe = Recipe {
        bands: 15,
        grid: Grid { bins: 24, ..Grid::default() },
        read_bins: 128,
        angles: area::AngleGrid { nodes: 9, ..area::AngleGrid::default() },
        scatter_orders: 2,
        ..Recipe::default()
    };
    let file = tables::generate::to_file(&recipe, &tables::generate::compute_tables(&recipe, &|_, _| ()));
    let set = TableSet::from_file(&TableFile::from_bytes(&file.to_bytes(), "memory").expect("whole")).expect("whole");
    let mut sums = Worst::new("irradiance against the sum of fifteen bands, of that facing", 1e-6);
    let mut degrees = Worst::new("coefficients of l = 11 … 14 against direct evaluation, of l = 0", 1e-3);
    let (air, cosine) = (hg(0.5), bake_optics::harmonics::clamped_cosine::<f64>(15));
    let mut missed = 0.0f64;
    for response in [set.point(&air, Scatter::Single), set.directional(&air, Scatter::Single)] {
        let rgb = ZonalRgb::new([0; 3].map(|_| response.clone()));
        for d in [0.02f32, 0.7, 5.0] {
            let mut c = [0.0f32; 15];
            response.coefficients(1.0, d, &mut c);
            let sum = |eta: f64, bands: usize| -> f64 {
                let mut y = [0.0; 15];
                bake_optics::harmonics::y_zonal_all(eta.cos(), &mut y);
                (0..bands).map(|l| cosine[l] * f64::from(c[l]) * y[l]).sum()
            };
            for eta in (0..=180).step_by(15).map(|degrees| f64::from(degrees).to_radians()) {
                let (one, three) = (eta.cos() as f32, rgb.irradiance([1.0; 3], d, eta.cos() as f32));
                for got in [response.irradiance(1.0, d, one), three[2]] {
                    sums.record((f64::from(got) - sum(eta, 15)).abs() / sum(0.0, 15), || format!("d {d} eta {eta:.2}"));
                }
                missed = missed.max((sum(eta, 11) / sum(0.0, 15) - sum(eta, 15) / sum(0.0, 15)).abs());
            }
        }
    }
    let want = &point::compute_single(0.7, &PhaseBasis::Functions(vec![air.phase.clone()]), 15)[0];
    let mut got = [0.0f32; 15];
    set.point(&air, Scatter::Single).coefficients(1.0, 0.7, &mut got);
    for l in 11..15 {
        degrees.record((f64::from(got[l]) * 0.7 * 0.7f64.exp() - want[l]).abs() / want[0], || format!("l {l}"));
    }
    sums.check();
    degrees.check();
    assert!(missed > 1e-4, "the bands beyond eleven must matter: {missed}");
}

/// The published layout through its file and both look-ups: close to the harmonics where an axis fits, far where it does not.
#[test]
fn the_published_layout_can_be_made_and_read() {
    let recipe = Recipe {
        layout: Layout::Paper,
        grid: Grid { bins: 24, ..Grid::default() },
        read_bins: 128,
        scatter_orders: 2,
        ..Recipe::default()
    };
    let file = tables::generate::to_file(&recipe, &tables::generate::compute_tables(&recipe, &|_, _| ()));
    let paper = TableSet::from_file(&TableFile::from_bytes(&file.to_bytes(), "memory").expect("whole")).expect("whole");
    let harmonic = TableSet::embedded();
    assert!(harmonic.fitted_area(&hg(0.0)).is_none());
    let mut facing = Worst::new("fitted axis against harmonics, receiver facing the emitter, of E", 4e-2);
    let mut forms = Worst::new("fitted look-up against its eleven harmonics, of E facing", 3e-2);
    let mut oblique = 0.0f32;
    for g in [0.0, 0.25, -0.5] {
        let air = Air { albedo: 0.8, ..hg(g) };
        let fitted = paper.fitted_area(&air).expect("this layout has an axis");
        let (converted, reference) = (paper.area(&air, Scatter::Single), harmonic.area(&air, Scatter::Single));
        for d in [0.05f32, 0.6, 3.0] {
            for degrees in [0.0f32, 20.0, 60.0, 85.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let axis = Vec3::new(sin, 0.0, -cos);
                let full = reference.irradiance(1.0, d, &Geometry::new(Vec3::Z, Vec3::Z, axis));
                for normal in [Vec3::Z, Vec3::new(0.8, 0.0, 0.6), Vec3::X, -Vec3::X, Vec3::Y] {
                    let geometry = Geometry::new(normal, Vec3::Z, axis);
                    let own = fitted.irradiance(1.0, d, normal, Vec3::Z, axis);
                    let place = || format!("g {g} d {d} theta {degrees} normal {normal}");
                    forms.record(f64::from((own - converted.irradiance(1.0, d, &geometry)).abs() / full), place);
                    let error = (own - reference.irradiance(1.0, d, &geometry)).abs() / full;
                    if degrees == 0.0 && normal == Vec3::Z {
                        facing.record(f64::from(error), place);
                    }
                    oblique = oblique.max(error);
                }
            }
        }
        let away = Geometry::new(Vec3::Z, Vec3::Z, Vec3::Z);
        assert_eq!(fitted.irradiance(1.0, 1.0, Vec3::Z, Vec3::Z, Vec3::Z), 0.0);
        assert_eq!(converted.irradiance(1.0, 1.0, &away), 0.0);
    }
    facing.check();
    forms.check();
    println!("largest error of the fitted axis: {oblique} of E facing");
    assert!(oblique > 0.1, "one axis cannot follow an oblique emitter");
}
