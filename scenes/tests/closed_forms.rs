//! The closed forms against an independent renderer that read the committed GLB (`truth/irradiance.py`): this holds the
//! formula, the scene's geometry, its units and its settings together.

use glam::DVec3;
use testkit::compare::Worst;
use testkit::reference::{Row, read_csv};

/// Standard errors allowed: among 240 points and 3 channels, 5 are broken by chance once in 2000 runs of the renderer.
const SIGMAS: f64 = 5.0;
/// Relative allowance for coordinates rounded to 2^-16 m and for the renderer's single precision.
const ROUNDING: f64 = 2e-4;

fn vector(row: &Row, columns: [&str; 3]) -> DVec3 {
    DVec3::from_array(columns.map(|column| row.number(column)))
}

/// Compares in units of the allowance; `scale` multiplies the closed form, for the negative control.
fn compare(name: &str, scale: f64, systematic: f64, closed_form: impl Fn(DVec3) -> DVec3) -> Worst {
    let mut worst = Worst::new(format!("{name}: difference over allowance"), 1.0);
    for row in read_csv(&scenes::folder().join(format!("tests/data/mitsuba_{name}.csv"))) {
        let point = vector(&row, ["px", "py", "pz"]);
        let expected = scale * closed_form(point);
        let rendered = vector(&row, ["E_r", "E_g", "E_b"]);
        let allowed = SIGMAS * vector(&row, ["se_r", "se_g", "se_b"]) + expected.abs() * (ROUNDING + systematic);
        for channel in 0..3 {
            let difference = (rendered[channel] - expected[channel]).abs();
            worst.record(difference / allowed[channel].max(f64::MIN_POSITIVE), || format!("{point}"));
        }
    }
    worst
}

#[test]
fn point_light() {
    compare("plane_point", 1.0, 0.0, scenes::plane_point::irradiance).check();
}

#[test]
fn sun_with_shadow() {
    compare("plane_sun", 1.0, 0.0, scenes::plane_sun::irradiance).check();
}

#[test]
fn sky_with_wall() {
    compare("plane_sky", 1.0, 0.0, scenes::plane_sky::irradiance).check();
}

#[test]
fn rectangular_lamp() {
    compare("plane_rect", 1.0, 0.0, scenes::plane_rect::irradiance).check();
}

#[test]
fn furnace() {
    compare("furnace", 1.0, 0.0, |_| scenes::furnace::irradiance(None)).check();
}

#[test]
fn concentric_spheres() {
    // Points on facets of 48 by 24 lie up to 0.4 % nearer to the middle than the sphere.
    let closed_form = |point: DVec3| match point.length() > 1.0 {
        true => scenes::spheres::outer_irradiance(None),
        false => scenes::spheres::inner_irradiance(),
    };
    compare("spheres", 1.0, 0.01, closed_form).check();
}

#[test]
fn a_wrong_closed_form_is_seen() {
    assert!(!compare("plane_point", 1.001, 0.0, scenes::plane_point::irradiance).holds());
    assert!(!compare("plane_sky", 1.02, 0.0, scenes::plane_sky::irradiance).holds());
    assert!(!compare("plane_rect", 1.02, 0.0, scenes::plane_rect::irradiance).holds());
    assert!(!compare("furnace", 1.04, 0.0, |_| scenes::furnace::irradiance(None)).holds());
    assert!(!compare("furnace", 1.0, 0.0, |_| scenes::furnace::irradiance(Some(3))).holds());
}
