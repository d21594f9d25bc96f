//! A medium as a record, and the sum of all media of a scene.

use glam::DVec3;

use crate::medium::invert::{self, Monotone};
use crate::medium::{Bounds, Density, Ray};
use crate::phase::Phase;

/// Scattering and absorption per linear RGB channel at density 1, in 1/m, each ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Scattering coefficient.
    pub sigma_s: [f64; 3],
    /// Absorption coefficient.
    pub sigma_a: [f64; 3],
}

impl Scatter {
    /// Extinction: scattering plus absorption.
    pub fn sigma_t(&self) -> [f64; 3] {
        std::array::from_fn(|c| self.sigma_s[c] + self.sigma_a[c])
    }

    /// From the look: mean free path 1/sigma_t in metres, and single-scattering albedo sigma_s/sigma_t per channel.
    pub fn from_look(mean_free_path_m: f64, albedo: [f64; 3]) -> Self {
        let sigma_t = 1.0 / mean_free_path_m;
        Self { sigma_s: albedo.map(|a| a * sigma_t), sigma_a: albedo.map(|a| (1.0 - a) * sigma_t) }
    }
}

/// One medium: where it is, how dense, what it does to light. Plain data; the formulas are in the parts' modules.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Medium {
    /// Where it ends.
    pub bounds: Bounds,
    /// Relative density inside.
    pub density: Density,
    /// Coefficients at density 1.
    pub scatter: Scatter,
    /// How it spreads light.
    pub phase: Phase<f64>,
}

impl Medium {
    /// The density at a point; zero outside the bounds.
    pub fn density_at(&self, point: DVec3) -> f64 {
        if self.bounds.contains(point) { self.density.at(point) } else { 0.0 }
    }

    /// Integral of the density along the ray inside the bounds, metres at density 1.
    pub fn optical_length(&self, ray: &Ray) -> f64 {
        let inside = self.bounds.intervals(ray);
        inside.iter().map(|&(enter, leave)| self.density.optical_length(&ray.part(enter, leave))).sum()
    }

    /// Distance from the ray's start after which the optical length reaches `target`; infinite where it does not.
    pub fn free_path(&self, ray: &Ray, target: f64) -> f64 {
        let intervals = self.bounds.intervals(ray);
        let mut rest = target;
        for (index, &(enter, leave)) in intervals.iter().enumerate() {
            let part = ray.part(enter, leave);
            let distance = self.density.free_path(&part, rest);
            if distance.is_finite() || index + 1 == intervals.len() {
                return enter + distance;
            }
            rest -= self.density.optical_length(&part);
        }
        f64::INFINITY
    }
}

/// Media that may overlap: their coefficients add.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MediumSet {
    /// The media, in the order of the settings.
    pub media: Vec<Medium>,
}

impl MediumSet {
    /// Optical depth along the ray per channel.
    pub fn optical_depth(&self, ray: &Ray) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for medium in &self.media {
            let (length, sigma_t) = (medium.optical_length(ray), medium.scatter.sigma_t());
            // Zero times an infinite length is no depth.
            (0..3).filter(|&c| sigma_t[c] > 0.0).for_each(|c| sum[c] += sigma_t[c] * length);
        }
        sum
    }

    /// Share of light that passes along the ray, per channel.
    pub fn transmittance(&self, ray: &Ray) -> [f64; 3] {
        self.optical_depth(ray).map(|depth| (-depth).exp())
    }

    /// Extinction at a point per channel, 1/m.
    pub fn sigma_t(&self, point: DVec3) -> [f64; 3] {
        self.sum_at(point, Scatter::sigma_t)
    }

    /// Scattering at a point per channel, 1/m.
    pub fn sigma_s(&self, point: DVec3) -> [f64; 3] {
        self.sum_at(point, |scatter| scatter.sigma_s)
    }

    /// Distance after which the optical depth of `channel` (0 to 2) reaches `target`; infinite where it does not within the ray.
    ///
    /// One medium in closed form where it has one; several by bracketed Newton iteration, at most 64 steps.
    pub fn free_path(&self, ray: &Ray, channel: usize, target: f64) -> f64 {
        if target <= 0.0 {
            return 0.0;
        }
        let met: Vec<_> =
            self.media.iter().filter(|m| m.sigma_t(channel) > 0.0 && m.bounds.clip(ray).is_some()).collect();
        if let [medium] = met[..] {
            return medium.free_path(ray, target / medium.sigma_t(channel));
        }
        let path = Monotone {
            value: |s| met.iter().map(|m| m.sigma_t(channel) * m.optical_length(&Ray { length: s, ..*ray })).sum(),
            slope: |s| met.iter().map(|m| m.sigma_t(channel) * m.density_at(ray.at(s))).sum(),
            limit: ray.length,
        };
        invert::solve(path, target)
    }

    fn sum_at(&self, point: DVec3, coefficient: impl Fn(&Scatter) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for medium in &self.media {
            let (density, sigma) = (medium.density_at(point), coefficient(&medium.scatter));
            (0..3).for_each(|c| sum[c] += density * sigma[c]);
        }
        sum
    }
}

impl Medium {
    fn sigma_t(&self, channel: usize) -> f64 {
        self.scatter.sigma_s[channel] + self.scatter.sigma_a[channel]
    }
}
