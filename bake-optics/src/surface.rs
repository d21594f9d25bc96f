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

use crate::Real;
use crate::airlight::sun;
use crate::quadrature::GaussLegendre;

/// `G_n(t, theta)`, n = `cos_power` ≥ 0 (any real ≥ 1 at full accuracy), t ≥ 0, theta in [0, π] radians.
///
/// *Accuracy* (n = 1, 10, 20): 2e-14 in f64; in f32 4e-6 of the larger of G_n(t, theta) and G_n(t, 0)/100 (plus T ulp).
/// *Cost*: 384 exponential integrals (f32: 192), some 0.1 ms; for frames use [`SurfaceTable`].
pub fn g<T: Real>(cos_power: T, t: T, theta: T) -> T {
    let (zero, one, four, right) = (T::zero(), T::one(), T::of(4.0), T::FRAC_PI_2());
    let rule = GaussLegendre::<T>::cached(T::pick(48, 96));
    // The circle at γ begins or ends to dip below the horizon.
    let kink = (right - theta).abs().min(right);
    let panels = [(zero, kink), (kink, right), (right, T::PI() - kink), (T::PI() - kink, T::PI())];
    let part = |(from, to): (T, T)| {
        rule.integrate_offset(one, |v| {
            // Clusters nodes at both ends, where the integrand has (γ − γ*)^{n+1/2} and γ ln γ.
            let (a, b) = (v.powi(4), (one - v).powi(4));
            let share = a / (a + b);
            let density = four * (v * (one - v)).powi(3) / (a + b).powi(2);
            let gamma = from + (to - from) * share;
            density * sun::endless(gamma, t) * azimuth_moment(cos_power, theta, gamma)
        }) * (to - from)
    };
    panels.into_iter().filter(|(from, to)| to > from).map(part).fold(zero, |sum, part| sum + part)
}

/// Irradiance scattered once onto a Lambertian surface, per unit intensity of the lamp: σ_s σ_t G_1/(2πT), 1/m².
///
/// *Accuracy*: that of [`g`].
pub fn scattered_irradiance<T: Real>(sigma_s: T, sigma_t: T, distance: T, theta: T) -> T {
    let t = sigma_t * distance;
    sigma_s * g(T::one(), t, theta) / (T::of(2.0) * T::PI() * distance)
}

/// `∫_0^{2π} max(0, cos θ cos γ + sin θ sin γ cos φ)^n dφ`.
fn azimuth_moment<T: Real>(n: T, theta: T, gamma: T) -> T {
    let (zero, two, half) = (T::zero(), T::of(2.0), T::of(0.5));
    let (a, b) = (theta.cos() * gamma.cos(), theta.sin() * gamma.sin());
    let edge = if a >= b {
        T::PI()
    } else if a <= -b {
        zero
    } else {
        (-a / b).acos()
    };
    if n == T::one() {
        return two * (a * edge + b * edge.sin());
    }
    // a + b cos φ = cos(θ + γ) + 2 b cos²(φ/2).
    let lowest = (theta + gamma).cos();
    let count = 24 + (0.5 * n.as_f64().min(200.0)) as usize;
    let value = |phi: T| (lowest + two * b * (half * phi).cos().powi(2)).max(zero).powf(n);
    two * GaussLegendre::<T>::cached(count).integrate_offset(edge, value)
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
            (g(cos_power, t, std::f64::consts::PI * place(at / size)) * (1.0 + t) * t.exp()) as f32
        };
        Self { size, values: (0..size * size).map(texel).collect() }
    }

    /// The table: rows of constant angle, T fastest; what a shader samples.
    pub fn texels(&self) -> &[f32] {
        &self.values
    }

    /// G_n by bilinear look-up, in f32 as a shader does it.
    pub fn look_up<T: Real>(&self, t: T, theta: T) -> T {
        let one = T::one();
        let ((i, x), (j, y)) = (self.cell(t / (one + t)), self.cell(theta / T::PI()));
        let texel = |i: usize, j: usize| T::of(f64::from(self.values[j * self.size + i]));
        let row = |j: usize| texel(i, j) + x * (texel(i + 1, j) - texel(i, j));
        (row(j) + y * (row(j + 1) - row(j))) * (-t).exp() / (one + t)
    }

    /// Texel at or below a place in [0, 1], and the share of the next.
    fn cell<T: Real>(&self, place: T) -> (usize, T) {
        let scale = T::of((self.size - 1) as f64);
        let at = (place * scale).max(T::zero()).min(scale);
        let low = at.to_usize().unwrap_or(0).min(self.size - 2);
        (low, at - T::of(low as f64))
    }
}
