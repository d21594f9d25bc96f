//! The air of a scene: media of the settings, or of the glTF scene's extras, resolved to what light transport asks.
//!
//! Records in, `bake_optics::medium::MediumSet` out: bounds as regions of the world, grids read, phase functions checked.
//! Everything invalid is refused here by medium, field and value. What light does in the air is the solver's matter.

mod bounds;
mod density;
mod error;
mod file;
mod grid;
pub(crate) mod limits;
mod phase;
mod summary;
mod warning;

pub use error::AirError;
pub use grid::GridFault;
pub use summary::{Extent, Summary};
pub use warning::AirWarning;

use crate::scene::Scene;
use crate::settings::{self, Settings};
use bake_optics::medium::{Density, Medium, MediumSet, Scatter};
use bake_optics::phase::Phase;
use bounds::Regions;
use glam::DVec3;
use std::borrow::Cow;

/// The media of a scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Air {
    /// What light meets, in the order of the settings; media that overlap add.
    pub media: MediumSet,
    /// Their names, in the same order; `medium 0` where none was given.
    pub names: Vec<String>,
    /// Lowest and highest corner of the box around all surfaces, metres.
    pub scene: [DVec3; 2],
}

impl Air {
    /// Whether there is no medium.
    pub fn is_empty(&self) -> bool {
        self.media.media.is_empty()
    }

    /// Whether every medium treats all channels alike: one look-up then serves three.
    pub fn is_grey(&self) -> bool {
        let alike = |[r, g, b]: [f64; 3]| r == g && g == b;
        self.media.media.iter().all(|medium| alike(medium.scatter.sigma_s) && alike(medium.scatter.sigma_a))
    }

    /// Whether every density is constant within its bounds.
    pub fn is_homogeneous(&self) -> bool {
        self.media.media.iter().all(|medium| medium.density == Density::Uniform)
    }

    /// Whether every medium that scatters does so alike in all directions.
    pub fn is_isotropic(&self) -> bool {
        let scatters = |medium: &&Medium| medium.scatter.sigma_s != [0.0; 3];
        self.media.media.iter().filter(scatters).all(|medium| medium.phase == Phase::Isotropic)
    }

    /// Whether any medium scatters.
    pub fn scatters(&self) -> bool {
        self.media.media.iter().any(|medium| medium.scatter.sigma_s != [0.0; 3])
    }

    /// Whether any medium absorbs.
    pub fn absorbs(&self) -> bool {
        self.media.media.iter().any(|medium| medium.scatter.sigma_a != [0.0; 3])
    }
}

/// Resolves the media of the settings, or else those of the scene's extras.
///
/// Nodes whose inside is a medium are taken out of the scene: they are no surfaces. Where resolving fails the scene stays
/// as it was.
///
/// # Errors
/// A value out of range, bounds that enclose nothing, a file that cannot be read or is not what it should be.
pub fn resolve(settings: &Settings, scene: &mut Scene) -> Result<(Air, Vec<AirWarning>), AirError> {
    let records = records(settings, scene)?;
    if records.is_empty() {
        return Ok((Air::default(), Vec::new()));
    }
    let regions = Regions::new(&records, scene);
    let (mut air, mut warnings) = (Air { scene: regions.scene, ..Air::default() }, Vec::new());
    for (index, record) in records.iter().enumerate() {
        record.check(index)?;
        let name = name(record, index);
        let bounds = regions.resolve(record, &name, scene)?;
        let density = density::resolve(record, &name, &bounds, &mut warnings)?;
        let phase = phase::resolve(&record.phase, &name)?;
        air.media.media.push(Medium { bounds, density, scatter: scatter(&record.scatter), phase });
        air.names.push(name);
    }
    regions.take_out(scene);
    warnings.extend(warning::derive(&air, scene, settings.texels_per_m));
    Ok((air, warnings))
}

fn records<'a>(settings: &'a Settings, scene: &Scene) -> Result<Cow<'a, [settings::Medium]>, AirError> {
    match (&settings.media, &scene.media_extras) {
        (Some(media), _) => Ok(Cow::Borrowed(media)),
        (None, Some(extras)) => Ok(Cow::Owned(settings::media_of_scene(extras)?)),
        (None, None) => Ok(Cow::Borrowed(&[])),
    }
}

fn name(record: &settings::Medium, index: usize) -> String {
    if record.name.is_empty() { format!("medium {index}") } else { record.name.clone() }
}

fn scatter(record: &settings::Scatter) -> Scatter {
    match record {
        settings::Scatter::Sigma { s, a } => Scatter { sigma_s: s.map(decimal), sigma_a: a.map(decimal) },
        settings::Scatter::Look { mean_free_path_m, albedo } => {
            Scatter::from_look(decimal(*mean_free_path_m), albedo.map(decimal))
        }
    }
}

/// The number that was written: 0.1 and not its 32-bit neighbour.
fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}

fn point(values: [f32; 3]) -> DVec3 {
    values.map(decimal).into()
}

#[cfg(test)]
mod tests;
