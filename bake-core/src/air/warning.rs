//! What is allowed and probably not meant: media that swallow the sun, touch nothing, or are finer than texels.

use super::Air;
use super::summary::own_box;
use crate::scene::{LightKind, Scene};
use bake_optics::medium::{MediumSet, Ray};
use glam::DVec3;
use std::f64::consts::PI;
use std::fmt;

/// Share of a light below which it is said to be lost.
const LOST: f64 = 1e-6;
/// Mean free path below which a medium is finer than texels show, in texels.
const FINE: f64 = 0.1;
/// Surface points and directions of the sky that stand for all.
const POINTS: usize = 64;
const DIRECTIONS: usize = 48;

/// Something about the air that the user should know.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum AirWarning {
    /// Next to nothing of a distant light arrives.
    Lost {
        /// Path of the light, or `the sky`.
        light: String,
        /// Mean share that arrives at surfaces, walls aside.
        share: f64,
    },
    /// Light is stopped within a small part of a texel.
    Fine {
        /// Name of the medium.
        medium: String,
        /// Mean free path, metres.
        mean_free_path_m: f64,
        /// Size of a texel, metres.
        texel_m: f64,
    },
    /// A medium beside the scene.
    Apart {
        /// Name of the medium.
        medium: String,
    },
    /// A medium that stops no light.
    NoEffect {
        /// Name of the medium.
        medium: String,
    },
    /// Values of a grid just below zero, taken as zero.
    Negative {
        /// Name of the medium.
        medium: String,
        /// How many.
        count: usize,
        /// The lowest.
        lowest: f32,
    },
}

impl fmt::Display for AirWarning {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Lost { light, share } => {
                write!(
                    out,
                    "{light}: the air lets {share:.1e} of its light through; thin the media, or leave the light out"
                )
            }
            Self::Fine { medium, mean_free_path_m, texel_m } => write!(
                out,
                "medium \"{medium}\": its mean free path of {mean_free_path_m:.2e} m is far below a texel of {texel_m:.2e} m; \
                 raise `texels_per_m` or thin it"
            ),
            Self::Apart { medium } => {
                write!(out, "medium \"{medium}\" lies beside the scene's box; check its bounds, or where its grid lies")
            }
            Self::NoEffect { medium } => {
                write!(out, "medium \"{medium}\" stops no light: its coefficients or its density are zero")
            }
            Self::Negative { medium, count, lowest } => {
                write!(
                    out,
                    "medium \"{medium}\": {count} densities below zero (down to {lowest:.1e}) are taken as zero"
                )
            }
        }
    }
}

/// Warnings about the air as a whole.
pub fn derive(air: &Air, scene: &Scene, texels_per_m: f32) -> Vec<AirWarning> {
    let mut warnings: Vec<AirWarning> =
        (0..air.names.len()).filter_map(|index| of_medium(air, index, texels_per_m)).collect();
    let points = surface_points(scene);
    let suns = scene.lights.iter().filter_map(|light| match light.kind {
        LightKind::Directional { direction, .. } => {
            Some((light.path.clone(), vec![-direction.as_dvec3().normalize_or_zero()]))
        }
        _ => None,
    });
    let sky = scene.environment.iter().map(|_| ("the sky".to_owned(), directions()));
    for (light, towards) in suns.chain(sky) {
        let share = mean_transmittance(&air.media, &points, &towards);
        if share < LOST {
            warnings.push(AirWarning::Lost { light, share });
        }
    }
    warnings
}

fn of_medium(air: &Air, index: usize, texels_per_m: f32) -> Option<AirWarning> {
    let (medium, name) = (&air.media.media[index], &air.names[index]);
    let sigma_t = medium.scatter.sigma_t().into_iter().fold(0.0, f64::max) * air.peak_density(medium);
    if sigma_t == 0.0 {
        return Some(AirWarning::NoEffect { medium: name.clone() });
    }
    let [min, max] = own_box(medium);
    if min.cmpgt(max.min(air.scene[1])).any() || max.cmplt(air.scene[0]).any() {
        return Some(AirWarning::Apart { medium: name.clone() });
    }
    let (mean_free_path_m, texel_m) = (1.0 / sigma_t, 1.0 / f64::from(texels_per_m));
    (mean_free_path_m < FINE * texel_m).then(|| AirWarning::Fine { medium: name.clone(), mean_free_path_m, texel_m })
}

/// Mean over points and directions of the clearest channel's transmittance; 1 without points.
fn mean_transmittance(media: &MediumSet, points: &[DVec3], towards: &[DVec3]) -> f64 {
    if points.is_empty() {
        return 1.0;
    }
    let clearest = |ray: Ray| media.transmittance(&ray).into_iter().fold(0.0, f64::max);
    let pairs = points.iter().flat_map(|&point| towards.iter().map(move |&dir| Ray::new(point, dir, f64::INFINITY)));
    pairs.map(clearest).sum::<f64>() / (points.len() * towards.len()) as f64
}

/// Middles of triangles spread over the scene's list of them.
fn surface_points(scene: &Scene) -> Vec<DVec3> {
    let counts = scene.instances.iter().map(|instance| scene.meshes[instance.mesh as usize].triangles.len());
    let total: usize = counts.clone().sum();
    let ends: Vec<usize> = counts
        .scan(0, |end, count| {
            *end += count;
            Some(*end)
        })
        .collect();
    let middle = |index: usize| {
        let instance = ends.partition_point(|&end| end <= index);
        let placed = &scene.instances[instance];
        let mesh = &scene.meshes[placed.mesh as usize];
        let triangle = mesh.triangles[index + mesh.triangles.len() - ends[instance]];
        let corners = triangle.map(|corner| placed.world_from_object.transform_point3(mesh.positions[corner as usize]));
        corners.map(|corner| corner.as_dvec3()).iter().sum::<DVec3>() / 3.0
    };
    let count = total.min(POINTS);
    (0..count).map(|i| middle(i * total / count)).collect()
}

/// Directions spread evenly over the sphere (Fibonacci lattice).
fn directions() -> Vec<DVec3> {
    let golden = PI * (3.0 - 5f64.sqrt());
    let direction = |i: usize| {
        let y = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        DVec3::new(radius * cos, y, radius * sin)
    };
    (0..DIRECTIONS).map(direction).collect()
}
