//! Densities placed in the world: the kernels applied to a ray.

use glam::DVec3;
use std::sync::Arc;

use crate::medium::exponential::Climb;
use crate::medium::grid::DensityGrid;
use crate::medium::planet::Orbit;
use crate::medium::{Ray, exponential, linear, planet, uniform};

/// Relative density ≥ 0 as a function of position; sigma_s and sigma_a are those at density 1.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Density {
    /// 1 everywhere.
    #[default]
    Uniform,
    /// max(0, slope (y − zero)).
    Linear {
        /// Height of zero density, metres.
        zero_m: f64,
        /// Change per metre of height; negative: denser below.
        slope_per_m: f64,
    },
    /// exp(−(y − base)/scale height).
    Exponential {
        /// Height of density 1, metres.
        base_m: f64,
        /// Height over which the density falls by e, metres, > 0.
        scale_height_m: f64,
    },
    /// exp(−(|x − centre| − radius)/scale height).
    Planet {
        /// Centre of the planet, metres.
        centre: DVec3,
        /// Distance of density 1 from the centre, metres, > 0.
        radius_m: f64,
        /// Height over which the density falls by e, metres, > 0.
        scale_height_m: f64,
    },
    /// Trilinear between lattice points, zero beyond them.
    Grid(Arc<DensityGrid>),
}

impl Density {
    /// The density at a point.
    pub fn at(&self, point: DVec3) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Linear { zero_m, slope_per_m } => (slope_per_m * (point.y - zero_m)).max(0.0),
            Self::Exponential { base_m, scale_height_m } => ((base_m - point.y) / scale_height_m).exp(),
            Self::Planet { centre, radius_m, scale_height_m } => {
                ((radius_m - point.distance(*centre)) / scale_height_m).exp()
            }
            Self::Grid(grid) => grid.at(point),
        }
    }

    /// Integral of the density along the ray, metres; infinite only where the density does not fall along an infinite ray.
    pub fn optical_length(&self, ray: &Ray) -> f64 {
        match self {
            Self::Uniform => uniform::optical_length(1.0, ray.length),
            Self::Linear { zero_m, slope_per_m } => {
                let start = slope_per_m * (ray.origin.y - zero_m);
                linear::optical_length(start, slope_per_m * ray.dir.y, ray.length)
            }
            Self::Exponential { base_m, scale_height_m } => {
                exponential::optical_length(1.0 / scale_height_m, climb(ray, *base_m), ray.length)
            }
            Self::Planet { centre, radius_m, scale_height_m } => {
                planet::optical_length(1.0 / scale_height_m, orbit(ray, *centre, *radius_m), ray.length)
            }
            Self::Grid(grid) => grid.optical_length(ray),
        }
    }

    /// Distance along the ray after which the optical length reaches `target`; infinite where it does not within the ray.
    pub fn free_path(&self, ray: &Ray, target: f64) -> f64 {
        let distance = match self {
            Self::Uniform => uniform::free_path(1.0, target),
            Self::Linear { zero_m, slope_per_m } => {
                let start = slope_per_m * (ray.origin.y - zero_m);
                linear::free_path(start, slope_per_m * ray.dir.y, target)
            }
            Self::Exponential { base_m, scale_height_m } => {
                exponential::free_path(1.0 / scale_height_m, climb(ray, *base_m), target)
            }
            Self::Planet { centre, radius_m, scale_height_m } => {
                planet::free_path(1.0 / scale_height_m, orbit(ray, *centre, *radius_m), target, ray.length)
            }
            Self::Grid(grid) => grid.free_path(ray, target),
        };
        if distance <= ray.length { distance } else { f64::INFINITY }
    }
}

fn climb(ray: &Ray, base_m: f64) -> Climb<f64> {
    Climb { height: ray.origin.y - base_m, cos_theta: ray.dir.y }
}

fn orbit(ray: &Ray, centre: DVec3, radius_m: f64) -> Orbit<f64> {
    let from_centre = ray.origin - centre;
    // A start at the very centre has no up; any direction is as good.
    let radius = from_centre.length().max(radius_m * f64::EPSILON);
    Orbit { radius, altitude: radius - radius_m, cos_theta: (from_centre.dot(ray.dir) / radius).clamp(-1.0, 1.0) }
}
