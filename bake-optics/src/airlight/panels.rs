//! A view ray cut into panels on which the air-light integrand is smooth, and Gauss–Legendre sums on them.
//!
//! Before the lamp's foot the variable is 1/x = 1/(r − z), in which the integrand is smooth also straight at the lamp;
//! past it ln y = ln(r + z), which spans the decades of a long ray. *Source*: Pegoraro et al. 2010, eq. 6, rewritten so
//! that 1/h and every difference of nearby numbers is gone; all terms of the sum are positive.

use smallvec::SmallVec;

use crate::Real;
use crate::airlight::sight::distance;
use crate::airlight::{Air, Lamp, PathPoint, Sight};
use crate::quadrature::GaussLegendre;

/// Most rays need no allocation.
pub(crate) type Panels<T> = SmallVec<[Panel<T>; 4]>;

/// Distances from the eye of both ends.
pub(crate) type Pieces<T> = SmallVec<[(T, T); 4]>;

/// Optical depth at which even f64 has nothing left.
const FARTHEST: f64 = 700.0;

/// Which variable serves a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    /// Before the foot: 1/x.
    Before,
    /// Past the foot: ln y.
    Past,
    /// Past the foot and endless, without extinction that would end it: −1/y.
    Endless,
}

/// Part of a view ray on one side of the lamp's foot, where the lamp is lit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Panel<T> {
    side: Side,
    /// Distance of its start from the eye.
    from: T,
    /// x or y at its start.
    start: T,
    /// Excess path at its start.
    excess: T,
    /// Width in the side's variable.
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
    ///
    /// `depth` counts from the first lit place: what lies behind a long dark stretch is still all of the light.
    pub fn pieces(&self, depth: T, more: &[T]) -> Pieces<T> {
        let (sight, zero) = (self.sight, T::zero());
        let jumps = self.lamp.jumps();
        if jumps.is_empty() {
            return self.cut_at(more.iter().chain(self.air.breaks()).copied(), self.air.end(sight, zero, depth));
        }
        let places =
            jumps.iter().flat_map(|&c| sight.crossings(c)).chain(more.iter().chain(self.air.breaks()).copied());
        let everything = self.air.end(sight, zero, T::of(FARTHEST).max(depth));
        let mut lit = self.cut_at(places, everything);
        lit.retain(|&mut (from, to)| self.is_lit(from, to));
        if let Some(&(first, _)) = lit.first() {
            let end = self.air.end(sight, first, depth);
            lit.retain(|&mut (from, _)| from < end);
            lit.iter_mut().for_each(|piece| piece.1 = piece.1.min(end));
        }
        lit
    }

    /// [0, end] cut at places.
    fn cut_at(&self, places: impl Iterator<Item = T>, end: T) -> Pieces<T> {
        let mut cuts: SmallVec<[T; 8]> = places.filter(|s| *s > T::zero() && *s < end).collect();
        cuts.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        cuts.push(end);
        let mut from = T::zero();
        let mut pieces = Pieces::new();
        for to in cuts {
            if from < to {
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

    /// Gauss–Legendre sum over a whole panel. Past the foot nodes are drawn towards it, where most of the light is.
    pub fn graded_sum(&self, panel: &Panel<T>, rule: &GaussLegendre<T>) -> T {
        let pull = if panel.side == Side::Past { grading(panel.width) } else { T::zero() };
        let terms = rule.nodes().iter().map(|&(node, weight)| {
            let (rest, bent) = (T::one() - pull, pull * node);
            let (point, density) = panel.point(self.sight.h, panel.width * node * (rest + bent));
            weight * (rest + bent + bent) * density * self.value(&point)
        });
        terms.fold(T::zero(), |sum, term| sum + term) * panel.width
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

/// How far nodes are drawn towards the foot, 0 (evenly in ln y) to 0.8, for a panel of a given width.
///
/// Beyond a few e-folds light falls as 1/y, so even spacing wastes nodes. Measured over the rays of `docs/airlight.md`: the
/// largest error falls 3 to 12 times against even spacing; any factor from 0.05 to 0.1 does.
fn grading<T: Real>(width: T) -> T {
    (T::of(0.05) * (width - T::of(2.0))).max(T::zero()).min(T::of(0.8))
}

impl<T: Real> Panel<T> {
    fn new(sight: &Sight<T>, from: T, to: T) -> Self {
        let (one, h) = (T::one(), sight.h);
        let (za, zb) = (sight.z + from, sight.z + to);
        let (ra, rb) = (distance(za, h), distance(zb, h));
        let excess = if from == T::zero() { from } else { sight.excess(from) };
        // Slope of r between the ends: (r_b − r_a)/(b − a).
        let slope = if rb.is_finite() { (za + zb) / (ra + rb) } else { one };
        if za + zb <= T::zero() {
            let start = ra - za;
            let width = (to - from) * (one - slope) / start / (rb - zb);
            return Self { side: Side::Before, from, start, excess, width };
        }
        let start = ra + za.max(T::zero());
        if to == T::infinity() {
            return Self { side: Side::Endless, from, start, excess, width: one / start };
        }
        Self { side: Side::Past, from, start, excess, width: ((to - from) * (one + slope) / start).ln_1p() }
    }

    /// Width in the panel's variable.
    pub fn width(&self) -> T {
        self.width
    }

    /// Whether it lies past the foot.
    pub fn is_past(&self) -> bool {
        self.side != Side::Before
    }

    /// Point at `offset` in the panel's variable, and ds/r² per unit of that variable.
    #[inline(always)]
    fn point(&self, h: T, offset: T) -> (PathPoint<T>, T) {
        let (one, two, half) = (T::one(), T::of(2.0), T::of(0.5));
        match self.side {
            Side::Before => {
                // 1/x = 1/x_0 + offset; y = h²/x.
                let inverse = one / self.start + offset;
                let p = h * inverse;
                let grown = h * h * offset;
                let s = self.from + half * (grown + self.start * offset / inverse);
                (PathPoint::new(s, self.excess + grown, p, false), two / (one + p * p))
            }
            Side::Past => {
                // y = y_0 e^offset; dy/(h² + y²) = doffset/(y (1 + (h/y)²)).
                let (grown, y) = self.grow(offset);
                let q = h / y;
                (self.past(h, grown, q), two / (y * (one + q * q)))
            }
            Side::Endless => {
                // 1/y = 1/y_0 − offset.
                let inverse = one / self.start - offset;
                let q = h * inverse;
                (self.past(h, one / inverse - self.start, q), two / (one + q * q))
            }
        }
    }

    /// y − y_0 and y. Rounding of y moves the exponent by σ y ε, which f64 can spare and f32 cannot.
    #[inline(always)]
    fn grow(&self, offset: T) -> (T, T) {
        if T::epsilon() < T::of(1e-10) {
            let y = self.start * offset.exp();
            (y - self.start, y)
        } else {
            let grown = self.start * offset.exp_m1();
            (grown, self.start + grown)
        }
    }

    #[inline(always)]
    fn past(&self, h: T, grown: T, q: T) -> PathPoint<T> {
        let s = self.from + T::of(0.5) * grown * (T::one() + q * (h / self.start));
        PathPoint::new(s, self.excess + grown, q, true)
    }
}
