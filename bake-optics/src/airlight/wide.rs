//! [`crate::airlight::Quadrature`] for many rays at once in f32: 8 or 16 rays in the lanes of one vector.
//!
//! For rays of a frame or a froxel column: uniform air, isotropic lamp, the same phase function for all lanes. Other lamps need
//! each ray cut at its own places; take the scalar form. Every lane does the work of both sides of the lamp's foot.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f32x8, f32x16};

use crate::quadrature::GaussLegendre;

/// A vector of f32.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The same value in every lane.
    fn splat(value: f32) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// e^x.
    fn exp(self) -> Self;
    /// ln(1 + x).
    fn ln_1p(self) -> Self;
    /// The larger of two, lane by lane.
    fn max(self, other: Self) -> Self;
    /// The smaller of two, lane by lane.
    fn min(self, other: Self) -> Self;
    /// `self` where `test` > 0, `other` elsewhere.
    fn where_positive(self, test: Self, other: Self) -> Self;
}

macro_rules! lanes {
    ($v:ty) => {
        impl Lanes for $v {
            #[inline(always)]
            fn splat(value: f32) -> Self {
                <$v>::splat(value)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$v>::sqrt(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                <$v>::exp(self)
            }
            #[inline(always)]
            fn ln_1p(self) -> Self {
                <$v>::ln_1p(self)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.fast_max(other)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.fast_min(other)
            }
            #[inline(always)]
            fn where_positive(self, test: Self, other: Self) -> Self {
                test.simd_gt(<$v>::splat(0.0)).select(self, other)
            }
        }
    };
}

lanes!(f32x8);
lanes!(f32x16);

/// Rays and air, one a lane; fields as in [`crate::airlight::Sight`] and [`crate::airlight::UniformAir`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WideRays<V> {
    /// Signed distance of the eye past the lamp's foot, metres.
    pub z: V,
    /// Distance of the lamp from the line, metres, > 0.
    pub h: V,
    /// Length, metres, > 0, may be infinite.
    pub length: V,
    /// Scattering, 1/m.
    pub sigma_s: V,
    /// Extinction, 1/m, ≥ 0; > 0 on endless rays.
    pub sigma_t: V,
}

/// Phase functions of the wide form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WidePhase {
    /// The same in all directions.
    Isotropic,
    /// 3 (1 + μ²)/(16π).
    Rayleigh,
    /// Henyey–Greenstein with this mean cosine, −1 < g < 1.
    HenyeyGreenstein(f32),
}

const INVERSE_FOUR_PI: f32 = 0.25 * std::f32::consts::FRAC_1_PI;

/// Optical depth beyond which light is left out.
const CUT: f32 = 30.0;

impl WidePhase {
    /// Value times 4π from 1 − μ and 1 + μ.
    #[inline(always)]
    fn eval<V: Lanes>(self, one_minus_cos: V, one_plus_cos: V) -> V {
        match self {
            Self::Isotropic => V::splat(1.0),
            // 3/4 (1 + μ²) = 3/2 − 3/4 (1 − μ)(1 + μ).
            Self::Rayleigh => V::splat(1.5) - V::splat(0.75) * one_minus_cos * one_plus_cos,
            Self::HenyeyGreenstein(g) => {
                let (a, gap) = (g.abs(), 1.0 - g.abs());
                let from_peak = if g >= 0.0 { one_minus_cos } else { one_plus_cos };
                let denominator = V::splat(gap * gap) + V::splat(2.0 * a) * from_peak;
                V::splat(gap * (1.0 + a)) / (denominator * denominator.sqrt())
            }
        }
    }
}

/// Radiance scattered once towards the eye per unit intensity, by `rule` on each side of the lamp's foot.
///
/// *Domain*: h > 0 (from 1e-12 of the lamp's distance on), σ_t ≥ 0; not both σ_t = 0 and an endless ray. Light below e^{−87} is 0.
/// *Accuracy*: that of the scalar form in f32, 1e-5 with 24 nodes, beside the rule's own error; at the ends
/// of the domain (h = 1e-12 m, σ_t = 0, T = 78) 2e-7, 2e-7 and 2e-6. *Cost*: `docs/airlight.md`.
#[inline]
pub fn radiance<V: Lanes>(rays: &WideRays<V>, phase: WidePhase, rule: &GaussLegendre<f32>) -> V {
    let span = Span::new(rays);
    let sum = span.before(rays, phase, rule) + span.past(rays, phase, rule);
    sum * rays.sigma_s * V::splat(2.0 * INVERSE_FOUR_PI) * (-(rays.sigma_t * span.eye_distance)).exp()
}

/// Ends of both panels; see [`crate::airlight`]'s scalar form for the formulas.
struct Span<V> {
    eye_distance: V,
    /// 1/x at the eye and its growth up to the foot.
    inverse_ahead: V,
    before_width: V,
    /// y at the foot (or the eye, past it) and the growth of ln y.
    behind: V,
    past_width: V,
}

impl<V: Lanes> Span<V> {
    #[inline(always)]
    fn new(rays: &WideRays<V>) -> Self {
        let WideRays { z, h, length, sigma_t, .. } = *rays;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let square = h * h;
        let eye_distance = (z * z + square).sqrt();
        let far = eye_distance + z.max(-z);
        let other = square / far;
        let (ahead, behind) = (other.where_positive(z, far), far.where_positive(z, other));
        // Where the excess path reaches the cut: s = (Δ/2)(1 + x/(y + Δ)).
        let excess = V::splat(CUT) / sigma_t;
        let end = length.min(V::splat(0.5) * excess * (one + ahead / (behind + excess)));
        let before = (-z).max(zero).min(end);
        let foot = z + before;
        let foot_distance = (foot * foot + square).sqrt();
        let slope = (z + foot) / (eye_distance + foot_distance);
        let before_width = before * (one - slope) / ahead / (foot_distance - foot.min(zero));
        let (past, last) = (end - before, z + end);
        let slope = (foot + last) / (foot_distance + (last * last + square).sqrt());
        let start = foot_distance + foot.max(zero);
        // A ray that ends before the foot has no past; rounding must not make one.
        let past = past.where_positive(last, zero);
        let past_width = (past * (one + slope) / start).ln_1p();
        Self { eye_distance, inverse_ahead: one / ahead, before_width, behind: start, past_width }
    }

    /// `∫ d(1/x) e^{−σ h² offset} Φ/(1 + p²)`, p = h/x.
    #[inline(always)]
    fn before(&self, rays: &WideRays<V>, phase: WidePhase, rule: &GaussLegendre<f32>) -> V {
        let (one, two) = (V::splat(1.0), V::splat(2.0));
        let decay = -(rays.sigma_t * rays.h * rays.h * self.before_width);
        let (p0, dp) = (rays.h * self.inverse_ahead, rays.h * self.before_width);
        let mut sum = V::splat(0.0);
        for &(node, weight) in rule.nodes() {
            let node = V::splat(node);
            let p = p0 + dp * node;
            let inverse = one / (one + p * p);
            let value = phase.eval(two * p * p * inverse, two * inverse);
            sum = sum + V::splat(weight) * (decay * node).exp() * value * inverse;
        }
        sum * self.before_width
    }

    /// `∫ d(ln y) e^{−σ (y − y_a)} Φ/(y (1 + q²))`, q = h/y.
    #[inline(always)]
    fn past(&self, rays: &WideRays<V>, phase: WidePhase, rule: &GaussLegendre<f32>) -> V {
        let (one, two) = (V::splat(1.0), V::splat(2.0));
        let excess = rays.h * rays.h * self.before_width;
        let mut sum = V::splat(0.0);
        for &(node, weight) in rule.nodes() {
            let y = self.behind * (self.past_width * V::splat(node)).exp();
            let q = rays.h / y;
            let inverse = one / (one + q * q);
            let value = phase.eval(two * inverse, two * q * q * inverse);
            let fall = (-(rays.sigma_t * (excess + y - self.behind))).exp();
            sum = sum + V::splat(weight) * fall * value * inverse / y;
        }
        sum * self.past_width
    }
}
