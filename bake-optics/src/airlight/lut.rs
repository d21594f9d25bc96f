//! Tables in the manner of Sun et al. 2005: air-light as the difference of two look-ups.
//!
//! The paper tabulates F(u, v), whose difference of two values has no digits left for viewing angles near π or depths above 16. Here
//! the tail of the integral is tabulated with its exponential taken out,
//!
//! ```text
//! f_l(H, v) = ∫_v^∞ e^{−H (v' − v)} P_l(cos 2ξ) dv'/(1 + v'²),   L = 2σ_s/h e^{−σ r_a} Σ_l a_l [f_l(H, v_a) − e^{−H (v_b − v_a)} f_l(H, v_b)]
//! ```
//!
//! divided by f_0's two limits, 1/(H (1 + v²) + 1/acot v), over coordinates that undo its corners: sqrt(H)/(1 + sqrt(H)) (F has a
//! u ln u term at 0) and 2ξ/π.

use crate::airlight::{Airlight, IsotropicLamp, Sight, UniformAir, sun};
use crate::legendre;
use std::f64::consts::{FRAC_PI_2, PI};

/// Air-light from a table.
///
/// *Domain*: uniform air, isotropic lamp (by type); of the phase function the first `orders` Legendre terms.
/// *Accuracy*: for tables of 64², 2e-4 on rays that pass the lamp; the two look-ups cancel on short segments, where 1e-1 is met. *Cost*: two bilinear look-ups an order, two exponentials, an arc tangent an end.
#[derive(Debug, Clone, PartialEq)]
pub struct Lut {
    size: usize,
    /// Layout: `value[l][j][i]`, i over H, j over v.
    values: Vec<Vec<f32>>,
}

impl Lut {
    /// Computes tables of `size`² (2..=1024) for Legendre orders below `orders` (1: isotropic, 3: Rayleigh).
    pub fn new(size: usize, orders: usize) -> Self {
        let size = size.clamp(2, 1024);
        let place = |i: usize| i as f64 / (size - 1) as f64;
        let values = (0..orders.max(1)).map(|l| {
            let texels = (0..size * size).map(|at| compute(l, h_of(place(at % size)), v_of(place(at / size))) as f32);
            texels.collect()
        });
        Self { size, values: values.collect() }
    }

    /// f_l(H, v) by look-up.
    pub fn tail(&self, l: usize, h: f64, v: f64) -> f64 {
        let scale = (self.size - 1) as f64;
        let cell = |x: f64| {
            let at = (x * scale).clamp(0.0, scale);
            let low = (at as usize).min(self.size - 2);
            (low, at - low as f64)
        };
        let ((i, x), (j, y)) = (cell(place_of_h(h)), cell(place_of_v(v)));
        let texel = |i: usize, j: usize| f64::from(self.values[l][j * self.size + i]);
        let row = |j: usize| texel(i, j) + x * (texel(i + 1, j) - texel(i, j));
        (row(j) + y * (row(j + 1) - row(j))) * scale_of(h, v)
    }
}

/// f_l over its scale: what the table stores.
fn compute(l: usize, h: f64, v: f64) -> f64 {
    let cos = |v: f64| (1.0 - v * v) / (1.0 + v * v);
    if v == f64::INFINITY || h == f64::INFINITY {
        return legendre::legendre(l, if v == f64::INFINITY { -1.0 } else { cos(v) });
    }
    sun::scaled_integral(h, v, f64::INFINITY, |v| legendre::legendre(l, cos(v))) / scale_of(h, v)
}

fn scale_of(h: f64, v: f64) -> f64 {
    1.0 / (h * (1.0 + v * v) + 1.0 / 1f64.atan2(v))
}

fn place_of_h(h: f64) -> f64 {
    h.sqrt() / (1.0 + h.sqrt())
}

fn h_of(place: f64) -> f64 {
    let root = place / (1.0 - place);
    root * root
}

fn place_of_v(v: f64) -> f64 {
    v.atan() / FRAC_PI_2
}

fn v_of(place: f64) -> f64 {
    if place == 1.0 { f64::INFINITY } else { (FRAC_PI_2 * place).tan() }
}

impl Airlight<f64, UniformAir<f64>, IsotropicLamp> for Lut {
    fn radiance(&self, sight: &Sight<f64>, _: &IsotropicLamp, air: &UniformAir<f64>) -> f64 {
        if sight.meets_lamp() {
            return f64::INFINITY;
        }
        // The table's differences need some distance from the line; nearer, air-light grows as 1/h.
        let height = sight.h.max(1e-6 * sight.eye_distance());
        let h = air.sigma_t * height;
        let va = sight.behind() / height;
        let excess = sight.excess(sight.length.min(f64::MAX));
        let (vb, fall) = (va + excess / height, (-air.sigma_t * excess).exp());
        let order = |l: usize| {
            let a = air.phase.moment(l) * (2 * l + 1) as f64 / (4.0 * PI);
            a * (self.tail(l, h, va) - if fall > 0.0 { fall * self.tail(l, h, vb) } else { 0.0 })
        };
        let sum: f64 = (0..self.values.len()).map(order).sum();
        (2.0 * air.sigma_s / height * sum * (-air.sigma_t * sight.eye_distance()).exp()).max(0.0)
    }
}
