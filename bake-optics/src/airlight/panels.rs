//! A view ray cut into panels on which the air-light integrand is smooth, and Gauss–Legendre sums on them.
//!
//! Before the lamp's foot the variable is 1/x = 1/(r − z), in which the integrand is smooth also straight at the lamp;
//! past it ln y = ln(r + z), which spans the decades of a long ray. *Source*: Pegoraro et al. 2010, eq. 6, rewritten so
//! that 1/h and every difference of nearby numbers is gone; all terms of the sum are positive.

use smallvec::SmallVec;

use crate::Real;
use crate::airlight::{Air, Lamp, PathPoint, Sight};
use crate::quadrature::GaussLegendre;

/// Most rays need no allocation.
pub(crate) type Panels<T> = SmallVec<[Panel<T>; 4]>;

/// Part of a view ray on one side of the lamp's foot, where the lamp is lit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Panel<T> {
    past: bool,
    /// Distance of its start from the eye.
    from: T,
    /// x or y at its start.
    start: T,
    /// Excess path at its start.
    excess: T,
    /// Width in 1/x or ln y.
    width: T,
}

/// Integrand of one sight.
pub(crate) struct Integrand<'a, T, A: ?Sized, E> {
    pub sight: &'a Sight<T>,
    pub lamp: &'a E,
    pub air: &'a A,
}

impl<T: Real, A: Air<T> + ?Sized, E: Lamp<T>> Integrand<'_, T, A, E> {
    /// Lit panels of the ray as far as optical depth `depth`.
    pub fn panels(&self, depth: T) -> Panels<T> {
        self.pieces(depth, &[self.sight.foot()])
            .into_iter()
            .map(|(from, to)| Panel::new(self.sight, from, to))
            .collect()
    }

    /// Lit pieces of the ray, cut at jumps, borders and `more` places; empty ones and those in the lamp's dark are left out.
    pub fn pieces(&self, depth: T, more: &[T]) -> SmallVec<[(T, T); 4]> {
        let (sight, end) = (self.sight, self.air.end(self.sight, depth));
        let jumps = self.lamp.jumps();
        let mut cuts: SmallVec<[T; 8]> = SmallVec::new();
        cuts.extend(jumps.iter().flat_map(|&c| sight.crossings(c)));
        cuts.extend(self.air.breaks().iter().copied());
        cuts.extend_from_slice(more);
        cuts.retain(|s| *s > T::zero() && *s < end);
        cuts.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        cuts.push(end);
        let mut from = T::zero();
        let mut pieces = SmallVec::new();
        for to in cuts {
            if from < to && (jumps.is_empty() || self.is_lit(from, to)) {
                pieces.push((from, to));
            }
            from = to;
        }
        pieces
    }

    /// Between jumps a lamp is dark everywhere or nowhere but at isolated points.
    fn is_lit(&self, from: T, to: T) -> bool {
        let middle = if to.is_finite() { T::of(0.5) * (from + to) } else { from + T::one() };
        self.lamp.intensity(self.sight.cos_axis(&self.sight.point(middle))) != T::zero()
    }

    /// Gauss–Legendre sum over the part [from, from + width] of a panel, in its variable.
    #[inline]
    pub fn sum(&self, panel: &Panel<T>, from: T, width: T, rule: &GaussLegendre<T>) -> T {
        let nodes = rule.nodes().iter();
        let terms = nodes.map(|&(node, weight)| {
            let (point, density) = panel.point(self.sight.h, from + width * node);
            weight * density * self.value(&point)
        });
        terms.fold(T::zero(), |sum, term| sum + term) * width
    }

    /// σ_s Φ I × transmittance at a point, without 1/r².
    #[inline(always)]
    fn value(&self, point: &PathPoint<T>) -> T {
        let intensity = self.lamp.intensity(self.sight.cos_axis(point));
        intensity * self.air.scattering(point.s, point.deflection) * self.air.transmittance(point)
    }
}

impl<T: Real> Panel<T> {
    fn new(sight: &Sight<T>, from: T, to: T) -> Self {
        let (one, h) = (T::one(), sight.h);
        let (za, zb) = (sight.z + from, sight.z + to);
        let (ra, rb) = (za.hypot(h), zb.hypot(h));
        let excess = if from == T::zero() { from } else { sight.excess(from) };
        // Slope of r between the ends: (r_b − r_a)/(b − a).
        let slope = if rb.is_finite() { (za + zb) / (ra + rb) } else { one };
        if za + zb > T::zero() {
            let start = ra + za.max(T::zero());
            Self { past: true, from, start, excess, width: ((to - from) * (one + slope) / start).ln_1p() }
        } else {
            let start = ra - za;
            Self { past: false, from, start, excess, width: (to - from) * (one - slope) / start / (rb - zb) }
        }
    }

    /// Width in the panel's variable.
    pub fn width(&self) -> T {
        self.width
    }

    /// Whether it lies past the foot.
    pub fn is_past(&self) -> bool {
        self.past
    }

    /// Point at `offset` in the panel's variable, and ds/r² per unit of that variable.
    #[inline(always)]
    fn point(&self, h: T, offset: T) -> (PathPoint<T>, T) {
        let (one, two, half) = (T::one(), T::of(2.0), T::of(0.5));
        if self.past {
            // y = y_0 e^offset; dy/(h² + y²) = doffset/(y (1 + (h/y)²)).
            let grown = self.start * offset.exp_m1();
            let y = self.start + grown;
            let q = h / y;
            let s = self.from + half * grown * (one + q * (h / self.start));
            (PathPoint::new(s, self.excess + grown, q, true), two / (y * (one + q * q)))
        } else {
            // 1/x = 1/x_0 + offset; y = h²/x.
            let inverse = one / self.start + offset;
            let p = h * inverse;
            let grown = h * h * offset;
            let s = self.from + half * (grown + self.start * offset / inverse);
            (PathPoint::new(s, self.excess + grown, p, false), two / (one + p * p))
        }
    }
}
