//! Draws the four panels of a map as one SVG: colour is the decade of the relative error.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::map::{Axis, Map, Panel};

/// Largest picture that may be written, bytes.
pub const LARGEST: u64 = 100_000;

const SIZE: (u32, u32) = (900, 760);
const LEGEND_HEIGHT: u32 = 60;

/// Decades from 1e-16 (and below) to 1 (and above): blue is exact, yellow is useless.
const COLOURS: [(u8, u8, u8); 17] = [
    (8, 29, 88),
    (18, 42, 116),
    (34, 57, 142),
    (35, 77, 160),
    (33, 98, 170),
    (31, 121, 180),
    (29, 145, 192),
    (43, 163, 194),
    (65, 182, 196),
    (95, 193, 192),
    (127, 205, 187),
    (163, 219, 183),
    (199, 233, 180),
    (222, 242, 178),
    (237, 248, 177),
    (250, 225, 110),
    (240, 180, 40),
];

/// Not a number or infinite.
const BROKEN: RGBColor = RGBColor(60, 0, 0);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Writes the picture of a map.
pub fn draw(file: &Path, map: &Map, panels: &[Panel; 4]) -> Outcome {
    let root = SVGBackend::new(file, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (upper, legend) = root.split_vertically(SIZE.1 - LEGEND_HEIGHT);
    for (area, panel) in upper.split_evenly((2, 2)).iter().zip(panels) {
        draw_panel(area, map, panel)?;
    }
    draw_legend(&legend)?;
    root.present()?;
    Ok(())
}

fn draw_panel(area: &Area, map: &Map, panel: &Panel) -> Outcome {
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, ("sans-serif", 16))
        .margin(8)
        .x_label_area_size(38)
        .y_label_area_size(62)
        .build_cartesian_2d(map.x.from..map.x.to, map.y.from..map.y.to)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_labels(7)
        .y_labels(7)
        .x_desc(map.x.label)
        .y_desc(map.y.label)
        .x_label_formatter(&|&v| tick(&map.x, v))
        .y_label_formatter(&|&v| tick(&map.y, v))
        .draw()?;
    let edge = |axis: &Axis, index: usize| axis.from + (axis.to - axis.from) * index as f64 / axis.cells as f64;
    for (row, errors) in panel.errors.chunks(map.x.cells).enumerate() {
        for (start, end, colour) in runs(errors) {
            let corner = (edge(&map.x, start), edge(&map.y, row));
            let opposite = (edge(&map.x, end), edge(&map.y, row + 1));
            chart.draw_series([Rectangle::new([corner, opposite], colour.filled())])?;
        }
    }
    Ok(())
}

/// Neighbours of one colour drawn as one rectangle: (first, past the last, colour).
fn runs(errors: &[f64]) -> Vec<(usize, usize, RGBColor)> {
    let mut runs: Vec<(usize, usize, RGBColor)> = Vec::new();
    for (i, &error) in errors.iter().enumerate() {
        let colour = colour_of(error);
        match runs.last_mut() {
            Some(last) if last.2 == colour => last.1 = i + 1,
            _ => runs.push((i, i + 1, colour)),
        }
    }
    runs
}

fn colour_of(error: f64) -> RGBColor {
    if !error.is_finite() {
        return BROKEN;
    }
    // One unit in the last place already counts as the decade of its precision.
    let decade = (error.max(1e-16).log10() + 16.0).round().clamp(0.0, 16.0);
    shade(decade as usize)
}

fn shade(decade: usize) -> RGBColor {
    let (r, g, b) = COLOURS[decade];
    RGBColor(r, g, b)
}

fn tick(axis: &Axis, value: f64) -> String {
    if axis.logarithmic { format!("1e{value:.0}") } else { format!("{}", (value * 1000.0).round() / 1000.0) }
}

fn draw_legend(area: &Area) -> Outcome {
    let (left, top, width) = (70, 12, 42);
    let text = ("sans-serif", 12).into_font();
    for decade in 0..COLOURS.len() {
        let x = left + width * decade as i32;
        area.draw(&Rectangle::new([(x, top), (x + width, top + 16)], shade(decade).filled()))?;
        if decade % 2 == 0 {
            area.draw(&Text::new(format!("1e{}", decade as i32 - 16), (x + 6, top + 20), text.clone()))?;
        }
    }
    let x = left + width * COLOURS.len() as i32 + 10;
    area.draw(&Rectangle::new([(x, top), (x + 30, top + 16)], BROKEN.filled()))?;
    area.draw(&Text::new("NaN, inf", (x - 4, top + 20), text))?;
    Ok(())
}
