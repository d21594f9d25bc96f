//! A picture of coefficients against distance, as SVG text: the tables at a glance.

use std::fmt::Write;

use crate::curves::Curves;

/// Size of the picture, pixels.
const SIZE: (f64, f64) = (760.0, 460.0);
/// Left, right, top and bottom margins.
const MARGIN: (f64, f64, f64, f64) = (64.0, 70.0, 34.0, 46.0);
/// Decades of the vertical axis.
const DECADES: f64 = 8.0;

/// The first `columns` columns of a table against canonical distance, both axes logarithmic; dark red is l = 0, blue the last.
/// Negative values are drawn dashed.
pub fn draw(curves: &Curves, columns: usize, title: &str) -> String {
    let distances = curves.grid.distances();
    let columns = columns.min(curves.columns);
    let value = |i: usize, column: usize| f64::from(curves.row(i + 1)[column]) * curves.shape.scale(distances[i]);
    let largest = (0..distances.len()).map(|i| value(i, 0).abs()).fold(f64::MIN_POSITIVE, f64::max);
    let top = largest.log10().ceil();
    let x = |d: f64| {
        let share = (d / curves.grid.min).ln() / (curves.grid.max / curves.grid.min).ln();
        MARGIN.0 + share * (SIZE.0 - MARGIN.0 - MARGIN.1)
    };
    let y = |exponent: f64| MARGIN.2 + (top - exponent) / DECADES * (SIZE.1 - MARGIN.2 - MARGIN.3);
    let mut svg = frame(title, top, curves.grid.min, curves.grid.max, &x, &y);
    for column in (0..columns).rev() {
        let points = (0..distances.len()).map(|i| (distances[i], value(i, column)));
        curve(&mut svg, points, top, &x, &y, &colour(column, columns));
        let _ = writeln!(
            svg,
            r#"<text x="{:.0}" y="{:.0}" fill="{}" font-size="11">l = {column}</text>"#,
            SIZE.0 - MARGIN.1 + 12.0,
            MARGIN.2 + 14.0 * (column + 1) as f64,
            colour(column, columns)
        );
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
        let svg = draw(&curves, 3, "test");
        assert_eq!(svg.matches("stroke-width").count(), 2, "two curves, none for the zero one");
        assert_eq!(svg.matches("stroke-dasharray").count(), 1);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
