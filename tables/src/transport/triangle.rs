//! Quadrature over the scattering point of a triangle source – scatter – receiver, in its two base angles.
//!
//! With the angles `outer` and `inner` at the two ends of a base of length d, the third angle's complement
//! `closing = π − outer − inner` and the sides opposite to them, d·sin(outer)/sin(closing) and d·sin(inner)/sin(closing),
//! the source's 1/r² and the 1/sin on the axis both cancel:
//! `∫ dω ∫ dt … /r² → (1/d) ∫ d outer ∫ d inner …` (dt = r²/(d sin γ) dβ).
//! At the receiver stands γ, at the source β; either may be the outer one.

use bake_optics::quadrature::GaussLegendre;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Nodes per axis that hold 1e-6 of the l = 0 coefficient for l ≤ 16 and distances from 1e-3 (measured 2e-7).
pub const NODES: usize = 96;

/// One place of the scattering point, for a base of length 1.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Cosine of the inner angle.
    pub cos_inner: f64,
    /// Sine of the inner angle.
    pub sin_inner: f64,
    /// The closing angle `π − outer − inner`: π minus the deflection at the scattering point.
    pub closing: f64,
    /// Length of the side opposite to the outer angle.
    pub side_outer: f64,
    /// Length of the side opposite to the inner angle.
    pub side_inner: f64,
    /// Weight of this node within its row.
    pub weight: f64,
}

/// All nodes that share an outer angle.
#[derive(Debug, Clone)]
pub struct Row {
    /// The outer angle, 0 … π.
    pub outer: f64,
    /// Cosine of the outer angle.
    pub cos_outer: f64,
    /// Weight of the row.
    pub weight: f64,
    /// Nodes in all rows before this one.
    pub first: usize,
    /// The inner nodes.
    pub nodes: Vec<Node>,
}

/// The whole rule.
#[derive(Debug, Clone)]
pub struct Triangle {
    /// Rows in ascending outer angle.
    pub rows: Vec<Row>,
}

impl Triangle {
    /// The rule of `nodes` × `nodes` places.
    pub fn new(nodes: usize) -> Self {
        Self::with_kinks(nodes, &[], &[])
    }

    /// The rule of [`NODES`] × [`NODES`] places, made once.
    pub fn standard() -> &'static Self {
        static RULE: OnceLock<Triangle> = OnceLock::new();
        RULE.get_or_init(|| Self::new(NODES))
    }

    /// The rule with panels that end at the given outer and inner angles (radians), where an integrand has kinks.
    pub fn with_kinks(nodes: usize, outer_kinks: &[f64], inner_kinks: &[f64]) -> Self {
        Self::build(&clustered_rule(nodes), &clustered_rule(nodes), outer_kinks, inner_kinks)
    }

    /// The rule of `outer` × `inner` places per panel, outer panels ending at the kinks.
    pub fn rectangular(outer: usize, inner: usize, outer_kinks: &[f64]) -> Self {
        Self::build(&clustered_rule(outer), &clustered_rule(inner), outer_kinks, &[])
    }

    fn build(outer: &[Place], inner: &[Place], outer_kinks: &[f64], inner_kinks: &[f64]) -> Self {
        let angles = panels(PI, outer_kinks).into_iter().flat_map(|panel| place(outer, panel, PI));
        let mut rows: Vec<Row> = angles.map(|angle| row(inner, angle, inner_kinks)).collect();
        let mut first = 0;
        for row in &mut rows {
            row.first = first;
            first += row.nodes.len();
        }
        Self { rows }
    }
}

/// A node of an axis: distance from its lower and upper end, each without cancellation, and its weight.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Distance from the lower end.
    pub low: f64,
    /// Distance from the upper end.
    pub high: f64,
    /// Weight; all sum to the length.
    pub weight: f64,
}

/// The rule of [`NODES`] places on (0, 1) that crowds to both ends, made once.
pub fn clustered_unit_rule() -> &'static [Place] {
    static RULE: OnceLock<Vec<Place>> = OnceLock::new();
    RULE.get_or_init(|| clustered_rule(NODES))
}

/// Gauss–Legendre in v, u = v⁴/(v⁴ + (1−v)⁴): nodes crowd to both ends, where the integrands have boundary layers of width d.
fn clustered_rule(nodes: usize) -> Vec<Place> {
    let map = |&(v, w): &(f64, f64)| {
        let (a, b) = (v.powi(4), (1.0 - v).powi(4));
        let slope = 4.0 * (v * (1.0 - v)).powi(3) / (a + b).powi(2);
        Place { low: a / (a + b), high: b / (a + b), weight: w * slope }
    };
    GaussLegendre::<f64>::new(nodes).nodes().iter().map(map).collect()
}

fn panels(end: f64, kinks: &[f64]) -> Vec<(f64, f64)> {
    let mut breaks: Vec<f64> = kinks.iter().copied().filter(|&k| k > 1e-9 && k < end - 1e-9).collect();
    breaks.extend([0.0, end]);
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    breaks.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// The rule on one panel of the axis [0, end].
fn place(rule: &[Place], (from, to): (f64, f64), end: f64) -> Vec<Place> {
    let length = to - from;
    let on_panel =
        |p: &Place| Place { low: from + length * p.low, high: (end - to) + length * p.high, weight: length * p.weight };
    rule.iter().map(on_panel).collect()
}

fn row(rule: &[Place], outer: Place, inner_kinks: &[f64]) -> Row {
    // sin(outer) from the nearer end of [0, π].
    let sin_outer = outer.low.min(outer.high).sin();
    let node = |p: Place| {
        // Near π the sine of an angle is that of the sum of the other two.
        let cos_inner = p.low.cos();
        let sin_inner = if p.low > 0.5 * PI { (outer.low + p.high).sin() } else { p.low.sin() };
        let sin_closing = if p.high > 0.5 * PI { (outer.low + p.low).sin() } else { p.high.sin() };
        Node {
            cos_inner,
            sin_inner,
            closing: p.high,
            side_outer: sin_outer / sin_closing,
            side_inner: sin_inner / sin_closing,
            weight: p.weight,
        }
    };
    let nodes = panels(outer.high, inner_kinks)
        .into_iter()
        .flat_map(|panel| place(rule, panel, outer.high))
        .map(node)
        .collect();
    Row { outer: outer.low, cos_outer: outer.low.cos(), weight: outer.weight, first: 0, nodes }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_the_triangle_and_a_kinked_integrand_come_out() {
        let area: f64 =
            Triangle::new(16).rows.iter().map(|r| r.weight * r.nodes.iter().map(|n| n.weight).sum::<f64>()).sum();
        assert!((area - PI * PI / 2.0).abs() < 1e-3 * area);
        // ∫∫ |outer − 1| over the triangle in closed form: ∫_0^π |x − 1| (π − x) dx.
        let want = 0.5 * PI - 1.0 / 6.0 + (PI - 1.0).powi(3) / 6.0;
        let integral = |triangle: Triangle| -> f64 {
            triangle
                .rows
                .iter()
                .map(|r| (r.outer - 1.0).abs() * r.weight * r.nodes.iter().map(|n| n.weight).sum::<f64>())
                .sum()
        };
        let split = integral(Triangle::with_kinks(40, &[1.0], &[0.7]));
        assert!((split / want - 1.0).abs() < 1e-9, "{split} {want}");
        let unsplit = integral(Triangle::new(40));
        assert!((unsplit / want - 1.0).abs() > 1e-7, "without the panel's end at the kink the rule must lose digits");
    }

    #[test]
    fn both_sides_projected_on_the_base_make_up_its_length() {
        let mut worst = testkit::compare::Worst::new("projection of the sides on the base, of their length", 1e-12);
        for row in &Triangle::new(24).rows {
            for n in &row.nodes {
                let base = n.side_inner * row.cos_outer + n.side_outer * n.cos_inner;
                let error = (base - 1.0).abs() / (1.0 + n.side_inner + n.side_outer);
                worst.record(error, || format!("outer {} closing {}", row.outer, n.closing));
            }
        }
        worst.check();
    }
}
