//! Densities: formulas as they are set, grids read from files.

use super::{AirError, AirWarning, decimal, point};
use crate::settings;
use bake_optics::medium::{Bounds, Density};

/// The density of a medium.
pub fn resolve(
    record: &settings::Medium,
    name: &str,
    _bounds: &Bounds,
    _warnings: &mut Vec<AirWarning>,
) -> Result<Density, AirError> {
    Ok(match &record.density {
        settings::Density::Uniform => Density::Uniform,
        settings::Density::Linear { zero_m, slope_per_m } => {
            Density::Linear { zero_m: decimal(*zero_m), slope_per_m: decimal(*slope_per_m) }
        }
        settings::Density::Exponential { base_m, scale_height_m } => {
            Density::Exponential { base_m: decimal(*base_m), scale_height_m: decimal(*scale_height_m) }
        }
        settings::Density::Planet { centre, radius_m, scale_height_m } => Density::Planet {
            centre: point(*centre),
            radius_m: decimal(*radius_m),
            scale_height_m: decimal(*scale_height_m),
        },
        settings::Density::Grid { file, .. } => {
            let source = std::io::Error::other("grids are not read yet");
            return Err(AirError::Unreadable { medium: name.into(), file: file.clone(), source });
        }
    })
}
