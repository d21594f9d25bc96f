//! What a method sees of the air along one view ray: transmittance by way of a point, and scattering there.

use glam::DVec3;

use crate::Real;
use crate::airlight::{PathPoint, Sight, borders};
use crate::medium::{MediumSet, Ray};
use crate::phase::{Deflection, Phase};

/// Air along one view ray towards one lamp.
pub trait Air<T: Real> {
    /// Transmittance common to all points: a factor taken out so that the rest neither under- nor overflows.
    fn common_transmittance(&self, sight: &Sight<T>) -> T;

    /// Transmittance lamp → point → eye, divided by the common one.
    fn transmittance(&self, point: &PathPoint<T>) -> T;

    /// Σ σ_s Φ, 1/(m sr), at distance `s`.
    fn scattering(&self, s: T, deflection: Deflection<T>) -> T;

    /// Distance beyond which less than e^{−`depth`} of the light passes that passes by way of `from`; at most the sight's length.
    fn end(&self, sight: &Sight<T>, from: T, depth: T) -> T;

    /// Distances where the integrand has corners.
    fn breaks(&self) -> &[T] {
        &[]
    }
}

/// Air of the same density everywhere.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UniformAir<T> {
    /// Scattering, 1/m.
    pub sigma_s: T,
    /// Extinction, 1/m, ≥ sigma_s.
    pub sigma_t: T,
    /// How it spreads light.
    pub phase: Phase<T>,
}

impl<T: Real> Air<T> for UniformAir<T> {
    fn common_transmittance(&self, sight: &Sight<T>) -> T {
        (-self.sigma_t * sight.eye_distance()).exp()
    }

    #[inline(always)]
    fn transmittance(&self, point: &PathPoint<T>) -> T {
        (-self.sigma_t * point.excess).exp()
    }

    #[inline(always)]
    fn scattering(&self, _: T, deflection: Deflection<T>) -> T {
        self.sigma_s * self.phase.eval_deflected(deflection)
    }

    #[inline]
    fn end(&self, sight: &Sight<T>, from: T, depth: T) -> T {
        if self.sigma_t == T::zero() {
            return sight.length;
        }
        let passed = if from == T::zero() { from } else { sight.excess(from) };
        sight.reach(passed + depth / self.sigma_t).min(sight.length)
    }
}

/// Any sum of media, one colour channel, along one ray in the world.
///
/// Kinks are known where the view ray crosses the bounds of a medium or the zero level of a linear one, and where the way to
/// the lamp passes a corner of a box or hull or a flank of a ball. Not known: the cells of a density grid, and where a zero level
/// meets a ball. Beside a flank light goes as a square root: there 48 quadrature nodes leave 2e-5.
#[derive(Debug, Clone)]
pub struct MediumAlong<'a> {
    set: &'a MediumSet,
    channel: usize,
    ray: Ray,
    lamp: DVec3,
    breaks: Vec<f64>,
}

impl<'a> MediumAlong<'a> {
    /// The media of `set` in `channel` (0 to 2) along `ray` with a lamp at `lamp`.
    pub fn new(set: &'a MediumSet, channel: usize, ray: Ray, lamp: DVec3) -> Self {
        let mut breaks: Vec<f64> = set.media.iter().flat_map(|medium| borders::kinks(medium, &ray, lamp)).collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        Self { set, channel, ray, lamp, breaks }
    }

    /// The sight that belongs to it, for a lamp with the unit `axis`.
    pub fn sight(&self, axis: DVec3) -> Sight<f64> {
        let Ray { origin, dir, length } = self.ray;
        Sight::from_points(origin.to_array(), dir.to_array(), length, self.lamp.to_array(), axis.to_array())
    }

    fn depth(&self, ray: &Ray) -> f64 {
        self.set.optical_depth(ray)[self.channel]
    }
}

impl Air<f64> for MediumAlong<'_> {
    fn common_transmittance(&self, _: &Sight<f64>) -> f64 {
        1.0
    }

    fn transmittance(&self, point: &PathPoint<f64>) -> f64 {
        let towards_lamp = Ray::between(self.ray.at(point.s), self.lamp);
        (-self.depth(&Ray { length: point.s, ..self.ray }) - self.depth(&towards_lamp)).exp()
    }

    fn scattering(&self, s: f64, deflection: Deflection<f64>) -> f64 {
        let point = self.ray.at(s);
        let media = self.set.media.iter();
        media.map(|m| m.density_at(point) * m.scatter.sigma_s[self.channel] * m.phase.eval_deflected(deflection)).sum()
    }

    fn end(&self, sight: &Sight<f64>, from: f64, depth: f64) -> f64 {
        let whole = self.depth(&self.ray);
        let target = self.depth(&Ray { length: from, ..self.ray }) + depth;
        if whole < target && self.ray.length.is_finite() {
            return sight.length;
        }
        // An infinite ray through air that ends or thins out: all but a share below rounding.
        self.set.free_path(&self.ray, self.channel, target.min(whole * (1.0 - 1e-13))).min(sight.length)
    }

    fn breaks(&self) -> &[f64] {
        &self.breaks
    }
}
