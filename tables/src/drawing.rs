//! A picture of coefficients against distance, as SVG text: the tables at a glance.

use std::fmt::Write;

use crate::area;
use crate::axial::{self, ALL_DEGREES, HARMONICS};
use crate::curves::Curves;
use crate::fitted;
use crate::set::TableSet;

/// Size of the picture, pixels.
const SIZE: (f64, f64) = (760.0, 460.0);
/// Left, right, top and bottom margins.
const MARGIN: (f64, f64, f64, f64) = (64.0, 70.0, 34.0, 46.0);
/// Decades of the vertical axis.
const DECADES: f64 = 8.0;

/// Angle θ at which an area is drawn, of cosine ½.
const COSINE: f64 = 0.5;

/// One of a set's tables against canonical distance, both axes logarithmic: its first function of the phase (isotropic in the default
/// layout) or its first order. Panics on a name that is none of [`crate::set::NAMES`].
pub fn draw(set: &TableSet, name: &str) -> String {
    let (what, columns) = chosen(set, name);
    picture(set.table(name), &columns, &format!("{name}, {what}"))
}

/// What of a table is drawn, in words; the columns and their labels.
fn chosen(set: &TableSet, name: &str) -> (String, Vec<(usize, String)>) {
    let recipe = set.recipe();
    let harmonic = |h: usize| format!("{},{}", HARMONICS[h].0, HARMONICS[h].1);
    match (name, recipe.layout.criterion()) {
        ("area.single", None) => {
            let node = recipe.angles.index(COSINE).round();
            let degrees = recipe.angles.cosine(node).acos().to_degrees();
            let at = |h| (area::column(&recipe.angles, 0, node as usize, h), harmonic(h));
            (format!("l,m divided by sin^m, {degrees:.0}° from its normal"), (0..HARMONICS.len()).map(at).collect())
        }
        ("area.single", Some(_)) => {
            let angle = fitted::index(COSINE.acos()).round();
            let at = |l| (fitted::column(0, angle as usize, l), format!("l = {l}"));
            let degrees = fitted::theta(angle).to_degrees();
            (
                format!("about the fitted axis, {degrees:.0}° from its normal, g = −0.5"),
                (0..fitted::BANDS).map(at).collect(),
            )
        }
        ("axial.orders" | "axial.all", _) => {
            let curves = axial::curves(&ALL_DEGREES);
            let lowest = |h: usize| {
                let column = curves.iter().position(|&(of, degree)| of == h && degree == HARMONICS[h].1);
                (column.expect("every harmonic has its lowest degree"), harmonic(h))
            };
            ("l,m of the emitter's degree l' = m".to_owned(), (0..HARMONICS.len()).map(lowest).collect())
        }
        _ => ("zonal".to_owned(), (0..recipe.bands).map(|l| (l, format!("l = {l}"))).collect()),
    }
}

/// Columns of a table; dark red the first, blue the last. Negative values are drawn dashed.
fn picture(curves: &Curves, columns: &[(usize, String)], title: &str) -> String {
    let distances = curves.grid.distances();
    let value = |i: usize, column: usize| f64::from(curves.row(i + 1)[column]) * curves.shape.scale(distances[i]);
    let largest = (0..distances.len()).map(|i| value(i, columns[0].0).abs()).fold(f64::MIN_POSITIVE, f64::max);
    let top = largest.log10().ceil();
    let x = |d: f64| {
        let share = (d / curves.grid.min).ln() / (curves.grid.max / curves.grid.min).ln();
        MARGIN.0 + share * (SIZE.0 - MARGIN.0 - MARGIN.1)
    };
    let y = |exponent: f64| MARGIN.2 + (top - exponent) / DECADES * (SIZE.1 - MARGIN.2 - MARGIN.3);
    let mut svg = frame(title, top, curves.grid.min, curves.grid.max, &x, &y);
    for (i, (column, label)) in columns.iter().enumerate().rev() {
        let (points, colour) =
            ((0..distances.len()).map(|i| (distances[i], value(i, *column))), colour(i, columns.len()));
        curve(&mut svg, points, top, &x, &y, &colour);
        let (x, y) = (SIZE.0 - MARGIN.1 + 12.0, MARGIN.2 + 14.0 * (i + 1) as f64);
        let _ = writeln!(svg, r#"<text x="{x:.0}" y="{y:.0}" fill="{colour}" font-size="11">{label}</text>"#);
    }
    svg.push_str("</svg>\n");
    svg
}

/// Dark red for the first, blue for the last.
fn colour(column: usize, columns: usize) -> String {
    let share = column as f64 / (columns.max(2) - 1) as f64;
    format!("rgb({:.0},{:.0},{:.0})", 150.0 * (1.0 - share), 70.0 * share * (2.0 - share), 200.0 * share)
}

fn frame(title: &str, top: f64, min: f64, max: f64, x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64) -> String {
    let (width, height) = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{}\" y=\"20\" font-size=\"14\">{title}</text>\n\
         <text x=\"{}\" y=\"{}\">distance (optical)</text>\n",
        MARGIN.0,
        0.45 * width,
        height - 10.0
    );
    let mut line = |x1: f64, y1: f64, x2: f64, y2: f64, label: String, anchor: &str, dx: f64, dy: f64| {
        let _ = writeln!(
            svg,
            r##"<path d="M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}" stroke="#ddd"/><text x="{:.1}" y="{:.1}" text-anchor="{anchor}">{label}</text>"##,
            x1 + dx,
            y1 + dy
        );
    };
    for decade in 0..=DECADES as i32 {
        let exponent = top - f64::from(decade);
        line(MARGIN.0, y(exponent), width - MARGIN.1, y(exponent), format!("1e{exponent:.0}"), "end", -6.0, 4.0);
    }
    for exponent in min.log10().ceil() as i32..=max.log10().floor() as i32 {
        let at = x(10f64.powi(exponent));
        line(at, height - MARGIN.3, at, MARGIN.2, format!("1e{exponent}"), "middle", 0.0, 16.0);
    }
    svg
}

/// One curve as pieces of equal sign inside the picture.
fn curve(
    svg: &mut String,
    points: impl Iterator<Item = (f64, f64)>,
    top: f64,
    x: &dyn Fn(f64) -> f64,
    y: &dyn Fn(f64) -> f64,
    colour: &str,
) {
    let mut pieces: [String; 2] = Default::default();
    let mut last = None;
    for (d, value) in points {
        let exponent = value.abs().log10();
        let inside = exponent.is_finite() && exponent >= top - DECADES;
        let negative = usize::from(value < 0.0);
        if inside {
            let command = if last == Some(negative) { 'L' } else { 'M' };
            let _ = write!(pieces[negative], "{command}{:.1} {:.1}", x(d), y(exponent));
        }
        last = inside.then_some(negative);
    }
    for (piece, dash) in pieces.iter().zip(["", " stroke-dasharray=\"4 3\""]) {
        if !piece.is_empty() {
            let _ = writeln!(svg, r#"<path d="{piece}" fill="none" stroke="{colour}" stroke-width="1.6"{dash}/>"#);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Grid, Shape};

    #[test]
    fn every_coefficient_that_is_not_zero_has_a_curve_and_signs_show() {
        let curves =
            Curves::store(Grid { bins: 16, ..Grid::default() }, Shape::POINT_SINGLE, 3, |_| vec![1.0, -0.5, 0.0]);
        let columns: Vec<_> = (0..3).map(|l| (l, format!("l = {l}"))).collect();
        let svg = picture(&curves, &columns, "test");
        assert_eq!(svg.matches("stroke-width").count(), 2, "two curves, none for the zero one");
        assert_eq!(svg.matches("stroke-dasharray").count(), 1);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }

    #[test]
    fn every_table_names_what_it_draws() {
        let set = TableSet::embedded();
        for name in crate::set::NAMES {
            let (what, columns) = chosen(set, name);
            let svg = draw(set, name);
            assert!(svg.contains(&what) && !svg.contains("NaN"), "{name}");
            let is_axial = name.starts_with("area") || name.starts_with("axial");
            assert_eq!(columns.len(), if is_axial { HARMONICS.len() } else { 11 }, "{name}");
            assert!(columns.iter().all(|(column, label)| *column < set.table(name).columns && svg.contains(label)));
        }
        // The facing half of an area, where the first harmonic is its largest.
        let (what, columns) = chosen(set, "area.single");
        let row = set.table("area.single").row(100);
        assert!(what.contains("60°") || what.contains("59°") || what.contains("61°"), "{what}");
        assert!(columns.iter().all(|(column, _)| row[*column].abs() <= row[columns[0].0] * 1.5), "{what}");
    }
}
