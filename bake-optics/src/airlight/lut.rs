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

use crate::Real;
use crate::airlight::{Airlight, IsotropicLamp, Sight, UniformAir, sun};
use crate::legendre;
use std::f64::consts::{FRAC_PI_2, PI};

/// Air-light from a table.
///
/// *Domain*: uniform air, isotropic lamp (by type); of the phase function the first `orders` Legendre terms.
/// *Accuracy*: for tables of 64², 2e-4 on rays that pass the lamp (f32 look-ups add 2e-6 of the first of the two); the two look-ups cancel on short segments, where 1e-1 is met. *Cost*: two bilinear look-ups an order, two exponentials, an arc tangent an end.
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

    /// The table of each order, divided by the scale: rows of constant v, H fastest; what a shader samples.
    pub fn layers(&self) -> &[Vec<f32>] {
        &self.values
    }

    /// f_l(H, v) by look-up, in f32 as a shader does it.
    pub fn tail<T: Real>(&self, l: usize, h: T, v: T) -> T {
        let ((i, x), (j, y)) = (self.cell(place_of_h(h)), self.cell(place_of_v(v)));
        let texel = |i: usize, j: usize| T::of(f64::from(self.values[l][j * self.size + i]));
        let row = |j: usize| texel(i, j) + x * (texel(i + 1, j) - texel(i, j));
        (row(j) + y * (row(j + 1) - row(j))) * scale_of(h, v)
    }

    /// Texel at or below a place in [0, 1], and the share of the next.
    fn cell<T: Real>(&self, place: T) -> (usize, T) {
        let scale = T::of((self.size - 1) as f64);
        let at = (place * scale).max(T::zero()).min(scale);
        let low = at.to_usize().unwrap_or(0).min(self.size - 2);
        (low, at - T::of(low as f64))
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

/// 1/(h (1 + v²) + 1/acot v) without ∞ times 0.
fn scale_of<T: Real>(h: T, v: T) -> T {
    let angle = T::one().atan2(v);
    if h == T::zero() || angle == T::zero() {
        return angle;
    }
    (h * (T::one() + v * v) + angle.recip()).recip()
}

fn place_of_h<T: Real>(h: T) -> T {
    h.sqrt() / (T::one() + h.sqrt())
}

fn h_of(place: f64) -> f64 {
    let root = place / (1.0 - place);
    root * root
}

fn place_of_v<T: Real>(v: T) -> T {
    v.atan() / T::FRAC_PI_2()
}

fn v_of(place: f64) -> f64 {
    if place == 1.0 { f64::INFINITY } else { (FRAC_PI_2 * place).tan() }
}

impl<T: Real> Airlight<T, UniformAir<T>, IsotropicLamp> for Lut {
    fn radiance(&self, sight: &Sight<T>, _: &IsotropicLamp, air: &UniformAir<T>) -> T {
        if sight.meets_lamp() {
            return T::infinity();
        }
        let zero = T::zero();
        // The table's differences need some distance from the line; nearer, air-light grows as 1/h.
        let height = sight.h.max(T::of(T::pick(1e-4, 1e-6)) * sight.eye_distance());
        let h = air.sigma_t * height;
        let va = sight.behind() / height;
        let excess = sight.excess(sight.length.min(T::max_value()));
        let (vb, fall) = (va + excess / height, (-air.sigma_t * excess).exp());
        let order = |l: usize| {
            let a = air.phase.moment(l) * T::of((2 * l + 1) as f64 / (4.0 * PI));
            a * (self.tail(l, h, va) - if fall > zero { fall * self.tail(l, h, vb) } else { zero })
        };
        let sum = (0..self.values.len()).map(order).fold(zero, |sum, term| sum + term);
        let value = T::of(2.0) * air.sigma_s / height * sum * (-air.sigma_t * sight.eye_distance()).exp();
        if value < zero { zero } else { value }
    }
}
