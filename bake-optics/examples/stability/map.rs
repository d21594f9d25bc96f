//! What a map is: two parameters, four error functions (textbook and ours, f32 and f64), and their measurement on a grid.

use bake_optics::Real;

/// A parameter: values from `from` to `to`, equally spaced, or equally spaced exponents of ten.
pub struct Axis {
    pub label: &'static str,
    pub from: f64,
    pub to: f64,
    pub cells: usize,
    pub logarithmic: bool,
}

impl Axis {
    /// Equal steps.
    pub const fn linear(label: &'static str, from: f64, to: f64, cells: usize) -> Self {
        Self { label, from, to, cells, logarithmic: false }
    }

    /// From 10^from to 10^to in equal ratios.
    pub const fn decades(label: &'static str, from: f64, to: f64, cells: usize) -> Self {
        Self { label, from, to, cells, logarithmic: true }
    }

    /// The value at a share of the way, 0 … 1.
    fn at(&self, share: f64) -> f64 {
        let position = self.from + (self.to - self.from) * share;
        if self.logarithmic { 10f64.powf(position) } else { position }
    }
}

/// Relative error at (x, y); NaN or infinite where the form breaks down.
pub type Error = fn(f64, f64) -> f64;

/// The textbook form beside ours, in one precision.
#[derive(Clone, Copy)]
pub struct Pair {
    pub textbook: Error,
    pub ours: Error,
}

/// One formula.
pub struct Map {
    /// File stem of the picture.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What is computed, what the textbook form is, what to see; Markdown.
    pub text: &'static str,
    pub x: Axis,
    pub y: Axis,
    pub single: Pair,
    pub double: Pair,
}

/// Errors of one panel, row by row from the least y; each the worst of several points inside its cell.
pub struct Panel {
    pub title: &'static str,
    pub errors: Vec<f64>,
}

impl Panel {
    /// Errors in ascending order, a breakdown last.
    fn sorted(&self) -> Vec<f64> {
        let mut sorted: Vec<f64> = self.errors.iter().map(|&e| if e.is_nan() { f64::INFINITY } else { e }).collect();
        sorted.sort_by(f64::total_cmp);
        sorted
    }

    pub fn median(&self) -> f64 {
        let sorted = self.sorted();
        sorted[sorted.len() / 2]
    }

    pub fn worst(&self) -> f64 {
        self.sorted()[self.errors.len() - 1]
    }
}

impl Map {
    /// Errors of the four panels: textbook f32, ours f32, textbook f64, ours f64.
    pub fn measure(&self) -> [Panel; 4] {
        let panel = |title, error| Panel { title, errors: self.grid(error) };
        [
            panel("textbook, f32", self.single.textbook),
            panel("ours, f32", self.single.ours),
            panel("textbook, f64", self.double.textbook),
            panel("ours, f64", self.double.ours),
        ]
    }

    fn grid(&self, error: Error) -> Vec<f64> {
        /// Points per cell, off the grid lines so that no round number flatters a form.
        const INSIDE: [(f64, f64); 4] = [(0.213, 0.687), (0.789, 0.341), (0.457, 0.113), (0.631, 0.897)];
        let mut errors = Vec::with_capacity(self.x.cells * self.y.cells);
        for row in 0..self.y.cells {
            for column in 0..self.x.cells {
                let inside = INSIDE.map(|(i, j)| {
                    let x = self.x.at((column as f64 + i) / self.x.cells as f64);
                    let y = self.y.at((row as f64 + j) / self.y.cells as f64);
                    error(x, y)
                });
                errors.push(inside.into_iter().fold(0.0, worse));
            }
        }
        errors
    }
}

/// The larger error; NaN wins.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// |got/want − 1|.
pub fn relative<T: Real>(got: T, want: f64) -> f64 {
    (got.as_f64() / want - 1.0).abs()
}
