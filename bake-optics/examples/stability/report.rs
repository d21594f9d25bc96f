//! The page `docs/stability.md`: how to read and remake the pictures, then one section per map with its worst and median errors.

use std::fmt::Write;

use crate::map::{Map, Panel};

const HEAD: &str = "# Where each formula keeps its digits

Made by `cargo run --release -p bake-optics --example stability`; do not edit by hand.

Each picture shows the relative error over two parameters: the textbook form on the left, ours on the right, f32 above, f64 below.
Dark blue is exact to f64, teal is what f32 can hold (1e-7), yellow has no digit left, dark red is NaN or infinite where the value is
finite. A cell is the worst of four points inside it. Inputs are rounded to the precision first, so that what is shown is the error of the
form and not of its input. Oracles are independent: double-double arithmetic or a positive, non-oscillating integral in f64 (good to about
3e-15, which is then the least that some f64 panels can show).
";

/// The whole page.
pub fn markdown(measured: &[(Map, [Panel; 4])]) -> String {
    let mut page = HEAD.to_owned();
    for (map, panels) in measured {
        section(&mut page, map, panels);
    }
    page
}

fn section(page: &mut String, map: &Map, panels: &[Panel; 4]) {
    let _ = write!(page, "\n## {}\n\n{}\n\n![{}](stability/{}.svg)\n\n", map.title, map.text, map.title, map.name);
    page.push_str("| | median error | worst error |\n| --- | --- | --- |\n");
    for panel in panels {
        let _ = writeln!(page, "| {} | {} | {} |", panel.title, number(panel.median()), number(panel.worst()));
    }
}

fn number(error: f64) -> String {
    if error.is_finite() { format!("{error:.1e}") } else { "NaN or infinite".into() }
}
