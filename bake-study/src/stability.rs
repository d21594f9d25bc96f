//! Where numbers keep their digits: the tables' look-up against direct evaluation over all distances, measured here, and
//! the maps of single formulas as they are recorded in the project's documentation.

use crate::error::StudyError;
use crate::plot::{Line, Mark, Plot};
use crate::report;
use bake_core::progress::{Interrupted, Progress};
use bake_formats::package::write_atomic;
use bake_formats::table_file::Precision;
use maud::{Markup, PreEscaped, html};
use std::io::Write;
use std::path::{Path, PathBuf};
use tables::accuracy::{area_map, errors_at};
use tables::generate::{compute_tables, to_file};
use tables::set::NAMES;
use tables::{Recipe, TableSet};

/// Distances between nodes at which every table is looked up.
const PLACES: usize = 48;

/// The recorded page: for each formula what is computed, and median and worst errors in f32 and f64.
const RECORDED: &str = include_str!("../../docs/stability.md");

/// What the runtime's parity test measured.
const SHADERS: &str = include_str!("../../docs/stability/shaders.csv");

/// Its pictures.
const PICTURES: [(&str, &str); 15] = [
    ("airlight", include_str!("../../docs/stability/airlight.svg")),
    ("airlight_vacuum", include_str!("../../docs/stability/airlight_vacuum.svg")),
    ("chapman", include_str!("../../docs/stability/chapman.svg")),
    ("erfcx", include_str!("../../docs/stability/erfcx.svg")),
    ("exponential_integral_1", include_str!("../../docs/stability/exponential_integral_1.svg")),
    ("exponential_integral_8", include_str!("../../docs/stability/exponential_integral_8.svg")),
    ("henyey_greenstein", include_str!("../../docs/stability/henyey_greenstein.svg")),
    ("henyey_greenstein_sample", include_str!("../../docs/stability/henyey_greenstein_sample.svg")),
    ("lam", include_str!("../../docs/stability/lam.svg")),
    ("legendre", include_str!("../../docs/stability/legendre.svg")),
    ("linear_phase_sample", include_str!("../../docs/stability/linear_phase_sample.svg")),
    ("medium_exponential", include_str!("../../docs/stability/medium_exponential.svg")),
    ("medium_linear", include_str!("../../docs/stability/medium_linear.svg")),
    ("medium_planet", include_str!("../../docs/stability/medium_planet.svg")),
    ("phi1", include_str!("../../docs/stability/phi1.svg")),
];

/// The table that is read by angle too.
const AREA: &str = "area.single";

/// Error of one table's look-up.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the table, and how it is stored.
    pub name: String,
    /// What it is drawn over.
    pub over: Over,
    /// Place, and the largest error of any coefficient there, relative to the first of its order.
    pub points: Vec<(f64, f64)>,
}

/// What an error is drawn over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Optical distance; of an area, its worst angle.
    Distance,
    /// Degrees between an area's axis and the direction to the receiver; the worst distance.
    Angle,
}

impl Over {
    /// Name in tables and on axes.
    fn name(self) -> &'static str {
        match self {
            Self::Distance => "optical distance",
            Self::Angle => "angle from the area's normal, degrees",
        }
    }
}

/// Measures the shipped tables and, when thorough, tables of the same recipe stored in 32 bits; writes
/// `stability.html` and `stability.csv` into `folder` and returns the page's path.
///
/// # Errors
/// A file cannot be written, or [`StudyError::Interrupted`].
pub fn run(folder: &Path, thorough: bool, progress: &dyn Progress) -> Result<PathBuf, StudyError> {
    std::fs::create_dir_all(folder).map_err(StudyError::io(folder))?;
    progress.stage("tables", (NAMES.len() * if thorough { 2 } else { 1 }) as u64);
    let mut curves = measure(TableSet::embedded(), "f16 as shipped", PLACES, progress)?;
    if thorough {
        let recipe = Recipe { precision: Precision::F32, ..Recipe::default() };
        let file = to_file(&recipe, &compute_tables(&recipe, &|_, _| ()));
        let precise = TableSet::from_file(&file).expect("the default recipe is sound");
        curves.extend(measure(&precise, "f32", PLACES, progress)?);
    }
    let path = folder.join("stability.html");
    write_atomic(&path, |out| out.write_all(page(&curves).as_bytes()))?;
    write_atomic(&folder.join("stability.csv"), |out| out.write_all(csv(&curves).as_bytes()))?;
    Ok(path)
}

/// Every table at places spread over all distances.
fn measure(set: &TableSet, stored: &str, places: usize, progress: &dyn Progress) -> Result<Vec<Curve>, Interrupted> {
    let grid = set.recipe().grid;
    let place = |i: usize| grid.min * (0.9 * grid.max / grid.min).powf((i as f64 + 0.5) / places as f64);
    let distances: Vec<f64> = (0..places).map(place).collect();
    let mut curves = Vec::new();
    for name in NAMES.iter().filter(|name| **name != AREA) {
        let points = distances.iter().copied().zip(errors_at(set, name, &distances)).collect();
        curves.push(Curve { name: format!("{name}, {stored}"), over: Over::Distance, points });
        progress.advance(1);
        if progress.is_cancelled() {
            return Err(Interrupted);
        }
    }
    curves.extend(measure_area(set, stored, &distances));
    progress.advance(1);
    Ok(curves)
}

/// The table that has angles too: over distances the worst angle, over angles the worst distance.
fn measure_area(set: &TableSet, stored: &str, distances: &[f64]) -> [Curve; 2] {
    let (thetas, rows) = area_map(set, distances);
    let most = |errors: &mut dyn Iterator<Item = f64>| errors.fold(0.0, f64::max);
    let by_distance = distances.iter().zip(&rows).map(|(&d, row)| (d, most(&mut row.iter().copied())));
    let by_angle =
        thetas.iter().enumerate().map(|(i, theta)| (theta.to_degrees(), most(&mut rows.iter().map(|row| row[i]))));
    let curve = |over, points| Curve { name: format!("{AREA}, {stored}"), over, points };
    [curve(Over::Distance, by_distance.collect()), curve(Over::Angle, by_angle.collect())]
}

fn csv(curves: &[Curve]) -> String {
    let lines = curves.iter().flat_map(|curve| {
        let over = if curve.over == Over::Distance { "optical distance" } else { "degrees" };
        curve.points.iter().map(move |(at, error)| format!("\"{}\",{over},{at:.4e},{error:.3e}\n", curve.name))
    });
    format!("table,over,at,error\n{}", lines.collect::<String>())
}

fn page(curves: &[Curve]) -> String {
    report::frame(
        "Where numbers keep their digits",
        html! {
            h2 { "Tables: look-up against direct evaluation" }
            p {
                "Largest error of any coefficient, through storage, refinement and linear interpolation in f32, against the integral "
                "in f64, at " (PLACES) " distances between nodes, relative to the first coefficient of the same order. Light of an area "
                "scattered once: of |g| up to 0.6, at its worst angle over distances, at its worst distance over angles from 0 to 180°."
            }
            @for over in [Over::Distance, Over::Angle] {
                @let drawn: Vec<&Curve> = curves.iter().filter(|curve| curve.over == over).collect();
                @for few in drawn.chunks(5) { (plot(few, over).svg()) }
            }
            (worst(curves))
            h2 { "Formulas" }
            p {
                "Recorded by " code { "cargo run --release -p bake-optics --example stability" } ". Textbook form left, ours right, f32 above, "
                "f64 below; dark blue is exact to f64, yellow has no digit left, dark red is no finite number."
            }
            @for section in RECORDED.split("\n## ").skip(1) { (formula(section)) }
            h2 { "Shaders" }
            p {
                "Recorded by " code { "ci/parity-record" } ": each function of the runtime's WGSL on a software adapter against its twin in f64 over a grid and "
                "awkward inputs; relative, absolute where a function vanishes."
            }
            (shaders())
        },
    )
}

/// Function, largest error, what is allowed, comparisons.
fn shaders() -> Markup {
    html! {
        table {
            tr { th { "function" } th.n { "largest error" } th.n { "allowed" } th.n { "comparisons" } }
            @for line in SHADERS.lines() {
                tr { @for (index, cell) in line.split(';').enumerate() { td class=(if index > 0 { "n" } else { "" }) { (cell) } } }
            }
        }
    }
}

fn plot(curves: &[&Curve], over: Over) -> Plot {
    let line = |curve: &&Curve| {
        let mark = |&(at, error): &(f64, f64)| {
            let title = format!("{}: {:.3} % at {} {at:.3}", curve.name, 100.0 * error, over.name());
            Mark { at: (at, 100.0 * error), title }
        };
        Line { name: curve.name.clone(), marks: curve.points.iter().map(mark).collect() }
    };
    Plot {
        title: "Look-up error of the tables".into(),
        axes: [over.name(), "largest error, %"],
        even: over == Over::Angle,
        lines: curves.iter().map(line).collect(),
        ..Plot::default()
    }
}

fn worst(curves: &[Curve]) -> Markup {
    html! {
        table {
            tr { th { "table" } th.n { "largest error" } th.n { "at" } th { "of" } }
            @for curve in curves {
                @if let Some((at, error)) = curve.points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)) {
                    tr { td { (curve.name) } td.n { (format!("{:.3} %", 100.0 * error)) } td.n { (format!("{at:.3}")) } td { (curve.over.name()) } }
                }
            }
        }
    }
}

/// One section of the recorded page: heading, text, picture, table.
fn formula(section: &str) -> Markup {
    let mut lines = section.lines();
    let title = lines.next().unwrap_or_default();
    let text: Vec<&str> = lines.clone().take_while(|line| !line.starts_with("![")).collect();
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let rows = lines.filter(|line| line.starts_with('|') && !line.starts_with("| ---")).map(cells);
    let picture = PICTURES.iter().find(|(name, _)| section.contains(&format!("(stability/{name}.svg)")));
    html! {
        h3 { (title) }
        p { (text.join(" ")) }
        @if let Some((_, svg)) = picture { (PreEscaped(*svg)) }
        table { @for row in rows { tr { @for (index, cell) in row.iter().enumerate() { td class=(if index > 0 { "n" } else { "" }) { (cell) } } } } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_core::progress::Silent;

    #[test]
    fn every_recorded_map_has_its_picture_and_numbers() {
        for section in RECORDED.split("\n## ").skip(1) {
            let html = formula(section).into_string();
            assert!(html.contains("<svg") && html.contains("ours, f32"), "{}", &section[..60]);
        }
        assert_eq!(RECORDED.matches("\n## ").count(), PICTURES.len());
    }

    #[test]
    fn every_recorded_shader_function_keeps_to_its_limit() {
        let lines: Vec<Vec<&str>> = SHADERS.lines().map(|line| line.split(';').collect()).collect();
        for line in &lines {
            let [measured, allowed] = [line[1], line[2]].map(|number| number.parse::<f64>().expect("a number"));
            assert!(measured <= allowed, "{line:?}");
        }
        assert!(lines.len() > 20 && lines.iter().all(|line| line.len() == 4), "{}", lines.len());
    }

    /// No look-up over all distances errs by more than the file itself states.
    #[test]
    fn the_shipped_tables_hold_what_their_file_states() {
        let places = if std::env::var_os("BAKE_LONG").is_some() { PLACES } else { 1 };
        let curves = measure(TableSet::embedded(), "f16", places, &Silent).expect("silent");
        let file =
            bake_formats::table_file::TableFile::from_bytes(tables::set::embedded_bytes(), "embedded").expect("sound");
        for curve in &curves {
            let stated = file.manifest.tables.iter().find(|entry| curve.name.starts_with(&format!("{},", entry.name)));
            let entry = stated.expect("every curve is of a table");
            let worst = curve.points.iter().map(|point| point.1).fold(0.0, f64::max);
            println!("{}: {worst:.2e}, stated {:.2e}", curve.name, entry.look_up_error);
            assert!(worst <= entry.look_up_error, "{}: {worst:.2e}", curve.name);
        }
        let angles = curves.iter().find(|curve| curve.over == Over::Angle).expect("the area's");
        let [least, most] = [f64::min, f64::max].map(|pick| angles.points.iter().map(|point| point.0).reduce(pick));
        assert_eq!((least, most.map(f64::round)), (Some(0.0), Some(180.0)));
        // The kink at 90° shows.
        let near = |degrees: f64| {
            let near = angles.points.iter().filter(|point| (point.0 - degrees).abs() < 2.0);
            near.map(|point| point.1).fold(0.0, f64::max)
        };
        assert!(places == 1 || near(90.0) > 2.0 * near(45.0), "{} {}", near(90.0), near(45.0));
        assert_eq!(page(&curves).matches("<svg").count(), PICTURES.len() + 3);
    }
}
