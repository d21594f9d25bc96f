//! Time against median error of one case, both logarithmic, as SVG.

use std::path::Path;

use plotters::prelude::*;

use crate::measure::{Point, Result};

/// Errors below f64's rounding are drawn at it.
const FLOOR: f64 = 1e-16;

const COLOURS: [RGBColor; 9] = [
    RGBColor(0, 90, 170),
    RGBColor(200, 60, 30),
    RGBColor(120, 120, 120),
    RGBColor(160, 120, 0),
    RGBColor(130, 60, 160),
    RGBColor(0, 140, 90),
    RGBColor(0, 160, 190),
    RGBColor(220, 120, 160),
    RGBColor(60, 60, 60),
];

pub fn draw(file: &Path, result: &Result) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::new(file, (760, 460)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(format!("{}: ns per ray against median relative error", result.case), ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(60)
        .build_cartesian_2d((10f64..100_000.0).log_scale(), (FLOOR..10.0).log_scale())?;
    let exponent = |y: &f64| format!("{y:.0e}");
    chart.configure_mesh().x_desc("ns per ray").y_desc("median relative error").y_label_formatter(&exponent).draw()?;
    let mut methods: Vec<&str> = result.points.iter().map(|p| p.method).collect();
    methods.dedup();
    for (method, colour) in methods.into_iter().zip(COLOURS) {
        let of_method = |p: &&Point| p.method == method;
        let at = |p: &Point| (p.nanoseconds, p.median.max(FLOOR));
        let points: Vec<_> = result.points.iter().filter(of_method).map(at).collect();
        let line = chart.draw_series(LineSeries::new(points.clone(), colour))?;
        line.label(method).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour));
        chart.draw_series(points.into_iter().map(|p| Circle::new(p, 3, colour.filled())))?;
    }
    chart.configure_series_labels().position(SeriesLabelPosition::UpperRight).border_style(BLACK).draw()?;
    root.present()?;
    Ok(())
}
