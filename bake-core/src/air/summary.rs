//! What a medium means in numbers: region, mean free path, optical depth across the scene.

use super::Air;
use bake_optics::medium::{Bounds, Density, Medium, Ray};
use bake_optics::phase::Phase;
use glam::DVec3;
use serde::Serialize;

/// A medium in the numbers by which people judge fog.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name.
    pub name: String,
    /// Where it is.
    pub bounds: Extent,
    /// How its density varies, in words.
    pub density: String,
    /// Largest density within its bounds and the scene's box.
    pub peak_density: f64,
    /// Mean free path where it is densest, metres, per channel; absent where light is never stopped.
    pub mean_free_path_m: [Option<f64>; 3],
    /// Largest optical depth of lines across its part of the scene's box, per channel.
    pub optical_depth: [f64; 3],
    /// Share of stopped light that is scattered, per channel; 0 where none is stopped.
    pub albedo: [f64; 3],
    /// Name of the phase function.
    pub phase: &'static str,
    /// Mean cosine of the deflection.
    pub g: f64,
}

/// The box around a region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extent {
    /// Shape within the box.
    pub shape: &'static str,
    /// Lowest and highest corner, metres; absent where the region has no end.
    pub corners: Option<[DVec3; 2]>,
}

impl Air {
    /// One a medium.
    pub fn summaries(&self) -> Vec<Summary> {
        let media = self.media.media.iter().zip(&self.names);
        media.map(|(medium, name)| self.summary(medium, name)).collect()
    }

    fn summary(&self, medium: &Medium, name: &str) -> Summary {
        let (peak_density, sigma_t) = (self.peak_density(medium), medium.scatter.sigma_t());
        let path = |sigma_t: f64| (sigma_t * peak_density > 0.0).then(|| 1.0 / (sigma_t * peak_density));
        let albedo = |c: usize| if sigma_t[c] > 0.0 { medium.scatter.sigma_s[c] / sigma_t[c] } else { 0.0 };
        Summary {
            name: name.into(),
            bounds: extent(&medium.bounds),
            density: words(&medium.density),
            peak_density,
            mean_free_path_m: sigma_t.map(path),
            optical_depth: self.optical_depth_across(medium),
            albedo: std::array::from_fn(albedo),
            phase: phase_name(&medium.phase),
            g: medium.phase.mean_cosine(),
        }
    }

    /// The box that a medium shares with the scene; its own, or the scene's, where they share none.
    fn shared_box(&self, medium: &Medium) -> [DVec3; 2] {
        let [min, max] = own_box(medium);
        let shared = [min.max(self.scene[0]), max.min(self.scene[1])];
        match (shared[0].cmple(shared[1]).all(), min.is_finite()) {
            (true, _) => shared,
            (false, true) => [min, max],
            (false, false) => self.scene,
        }
    }

    /// Largest density within [`Self::shared_box`].
    pub(super) fn peak_density(&self, medium: &Medium) -> f64 {
        let [min, max] = self.shared_box(medium);
        let nearest = match &medium.density {
            Density::Uniform => return 1.0,
            Density::Grid(grid) => return grid.largest(),
            Density::Linear { .. } | Density::Exponential { .. } => {
                return [min, max].map(|corner| medium.density.at(corner)).into_iter().fold(0.0, f64::max);
            }
            Density::Planet { centre, .. } => centre.clamp(min, max),
        };
        medium.density.at(nearest)
    }

    /// Largest optical depth of the box's diagonals and of nine lines along each axis.
    fn optical_depth_across(&self, medium: &Medium) -> [f64; 3] {
        let [min, max] = self.shared_box(medium);
        let longest = lines(min, max).into_iter().map(|line| medium.optical_length(&line)).fold(0.0, f64::max);
        medium.scatter.sigma_t().map(|sigma_t| if sigma_t > 0.0 { sigma_t * longest } else { 0.0 })
    }
}

/// The box outside of which a medium is not; turned inside out where its grid lies beside its bounds.
pub(crate) fn own_box(medium: &Medium) -> [DVec3; 2] {
    let [min, max] = medium.bounds.bounding_box();
    match &medium.density {
        Density::Grid(grid) => {
            let [low, high] = grid.bounding_box();
            [min.max(low), max.min(high)]
        }
        _ => [min, max],
    }
}

/// Diagonals of a box, and lines along its axes through the middles of nine parts of each face.
fn lines(min: DVec3, max: DVec3) -> Vec<Ray> {
    let at = |share: DVec3| min + share * (max - min);
    let mut ends: Vec<[DVec3; 2]> = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
        .map(|(y, z)| [DVec3::new(0.0, y, z), DVec3::new(1.0, 1.0 - y, 1.0 - z)])
        .to_vec();
    const PARTS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
    for axis in 0..3 {
        for (u, v) in PARTS.into_iter().flat_map(|u| PARTS.map(|v| (u, v))) {
            let mut from = DVec3::ZERO;
            (from[(axis + 1) % 3], from[(axis + 2) % 3]) = (u, v);
            ends.push([from, from + DVec3::AXES[axis]]);
        }
    }
    ends.into_iter().map(|[from, to]| Ray::between(at(from), at(to))).collect()
}

fn extent(bounds: &Bounds) -> Extent {
    let shape = match bounds {
        Bounds::Unbounded => "unbounded",
        Bounds::Box { .. } => "box",
        Bounds::Sphere { .. } => "sphere",
        Bounds::Hull(_) => "convex mesh",
        Bounds::Mesh(_) => "mesh",
    };
    let corners = (*bounds != Bounds::Unbounded).then(|| bounds.bounding_box());
    Extent { shape, corners }
}

fn words(density: &Density) -> String {
    match density {
        Density::Uniform => "uniform".into(),
        Density::Linear { zero_m, slope_per_m } => {
            format!("linear, 0 at {zero_m} m, {slope_per_m} per metre of height")
        }
        Density::Exponential { base_m, scale_height_m } => {
            format!("exponential, 1 at {base_m} m, scale height {scale_height_m} m")
        }
        Density::Planet { radius_m, scale_height_m, .. } => {
            format!("planet of {radius_m} m, scale height {scale_height_m} m")
        }
        Density::Grid(grid) => {
            let size = grid.size();
            format!("grid of {} × {} × {} points, up to {:.3}", size.x, size.y, size.z, grid.largest())
        }
    }
}

fn phase_name(phase: &Phase<f64>) -> &'static str {
    match phase {
        Phase::Isotropic => "isotropic",
        Phase::Linear { .. } => "linear",
        Phase::Rayleigh => "Rayleigh",
        Phase::HenyeyGreenstein { .. } => "Henyey-Greenstein",
        Phase::Legendre(_) => "Legendre series",
        Phase::Table(_) => "table",
    }
}
