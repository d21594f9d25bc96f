//! Scattered light of a point lamp arriving at a surface in endless uniform isotropic air (Sun et al. 2005, section 5).
//!
//! `G_n(T, θ)` integrates air-light over the hemisphere against the n-th power of the cosine from an axis: the normal of a
//! Lambertian surface (**n = 1**, which the paper names G_0), or the mirror direction of a Phong lobe (n = its exponent).
//! T is the optical distance surface – lamp, θ the angle between axis and lamp. Around the direction of the lamp,
//!
//! ```text
//! G_n = ∫_0^π K(γ) M_n(γ) dγ,   K = e^{−T} Im S_1(T sin γ (tan(γ/2) − i)),
//! M_n = ∫_0^{2π} max(0, cos θ cos γ + sin θ sin γ cos φ)^n dφ:
//! ```
//!
//! the paper's 1/sin γ has cancelled against the solid angle. Light behind the surface (θ > π/2) still arrives through the air.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::airlight::sun;
use crate::quadrature::GaussLegendre;

/// `G_n(t, theta)`, n = `cos_power` ≥ 0 (any real ≥ 1 at full accuracy), t > 0, theta in [0, π] radians.
///
/// *Accuracy*: 1e-12 (n = 1, 10, 20). *Cost*: 384 exponential integrals, some 0.1 ms; for frames use [`SurfaceTable`].
pub fn g(cos_power: f64, t: f64, theta: f64) -> f64 {
    let rule = GaussLegendre::<f64>::cached(96);
    // The circle at γ begins or ends to dip below the horizon.
    let kink = (FRAC_PI_2 - theta).abs();
    let panels = [(0.0, kink), (kink, FRAC_PI_2), (FRAC_PI_2, PI - kink), (PI - kink, PI)];
    let part = |(from, to): (f64, f64)| {
        rule.integrate_offset(1.0, |v| {
            // Clusters nodes at both ends, where the integrand has (γ − γ*)^{n+1/2} and γ ln γ.
            let (a, b) = (v.powi(4), (1.0 - v).powi(4));
            let share = a / (a + b);
            let density = 4.0 * (v * (1.0 - v)).powi(3) / (a + b).powi(2);
            let gamma = from + (to - from) * share;
            density * sun::endless(gamma, t) * azimuth_moment(cos_power, theta, gamma)
        }) * (to - from)
    };
    panels.into_iter().filter(|(from, to)| to > from).map(part).sum()
}

/// Irradiance scattered once onto a Lambertian surface, per unit intensity of the lamp: σ_s σ_t G_1/(2πT), 1/m².
pub fn scattered_irradiance(sigma_s: f64, sigma_t: f64, distance: f64, theta: f64) -> f64 {
    let t = sigma_t * distance;
    sigma_s * sigma_t * g(1.0, t, theta) / (2.0 * PI * t)
}

/// `∫_0^{2π} max(0, cos θ cos γ + sin θ sin γ cos φ)^n dφ`.
fn azimuth_moment(n: f64, theta: f64, gamma: f64) -> f64 {
    let (a, b) = (theta.cos() * gamma.cos(), theta.sin() * gamma.sin());
    let edge = if a >= b {
        PI
    } else if a <= -b {
        0.0
    } else {
        (-a / b).acos()
    };
    if n == 1.0 {
        return 2.0 * (a * edge + b * edge.sin());
    }
    // a + b cos φ = cos(θ + γ) + 2 b cos²(φ/2).
    let lowest = (theta + gamma).cos();
    let rule = GaussLegendre::<f64>::cached(24 + (0.5 * n.min(200.0)) as usize);
    2.0 * rule.integrate_offset(edge, |phi| (lowest + 2.0 * b * (0.5 * phi).cos().powi(2)).max(0.0).powf(n))
}

/// G_n over optical distance and angle, for look-ups in frames.
///
/// *Map*: (T/(1 + T), θ/π) ↦ (1 + T) e^T G_n, smooth and finite at both ends. *Accuracy*: [`SurfaceTable::new`]'s size decides;
/// 64²: 1e-3 of the value at θ = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceTable {
    size: usize,
    /// Row-major, T fastest.
    values: Vec<f32>,
}

/// Beyond it (1 + T) e^T G is constant within the table's accuracy.
const FAR: f64 = 60.0;

impl SurfaceTable {
    /// Computes `size`² texels (2..=512) for the power `cos_power`.
    pub fn new(size: usize, cos_power: f64) -> Self {
        let size = size.clamp(2, 512);
        let place = |i: usize| i as f64 / (size - 1) as f64;
        let distance = |x: f64| (x / (1.0 - x)).clamp(1e-6, FAR);
        let texel = |at: usize| {
            let t = distance(place(at % size));
            (g(cos_power, t, PI * place(at / size)) * (1.0 + t) * t.exp()) as f32
        };
        Self { size, values: (0..size * size).map(texel).collect() }
    }

    /// G_n by bilinear look-up.
    pub fn look_up(&self, t: f64, theta: f64) -> f64 {
        let scale = (self.size - 1) as f64;
        let cell = |x: f64| {
            let at = (x * scale).clamp(0.0, scale);
            let low = (at as usize).min(self.size - 2);
            (low, at - low as f64)
        };
        let ((i, x), (j, y)) = (cell(t / (1.0 + t)), cell(theta / PI));
        let texel = |i: usize, j: usize| f64::from(self.values[j * self.size + i]);
        let row = |j: usize| texel(i, j) + x * (texel(i + 1, j) - texel(i, j));
        (row(j) + y * (row(j + 1) - row(j))) * (-t).exp() / (1.0 + t)
    }
}
