//! Densities: formulas as they are set, grids read from files.

use super::grid::{self, Choice};
use super::{AirError, AirWarning, decimal, file, point};
use crate::settings::{self, Density as Record};
use bake_optics::medium::{Bounds, Density};
use std::path::Path;
use std::sync::Arc;

/// Largest grid file, bytes.
const MOST_BYTES: u64 = 4 << 30;

/// The density of a medium.
pub fn resolve(
    record: &settings::Medium,
    name: &str,
    bounds: &Bounds,
    warnings: &mut Vec<AirWarning>,
) -> Result<Density, AirError> {
    Ok(match &record.density {
        Record::Uniform => Density::Uniform,
        Record::Linear { zero_m, slope_per_m } => {
            Density::Linear { zero_m: decimal(*zero_m), slope_per_m: decimal(*slope_per_m) }
        }
        Record::Exponential { base_m, scale_height_m } => {
            Density::Exponential { base_m: decimal(*base_m), scale_height_m: decimal(*scale_height_m) }
        }
        Record::Planet { centre, radius_m, scale_height_m } => Density::Planet {
            centre: point(*centre),
            radius_m: decimal(*radius_m),
            scale_height_m: decimal(*scale_height_m),
        },
        Record::Grid { file, name: of_file, size, values, place, z_up } => {
            let choice = Choice { name: of_file.as_deref(), size: *size, values: *values, place: *place, z_up: *z_up };
            let (density, warning) = read_grid(file, choice, name, bounds)?;
            warnings.extend(warning);
            density
        }
    })
}

fn read_grid(
    path: &Path,
    choice: Choice,
    medium: &str,
    bounds: &Bounds,
) -> Result<(Density, Option<AirWarning>), AirError> {
    let bytes = file::read(path, MOST_BYTES).map_err(|source| AirError::Unreadable {
        medium: medium.into(),
        file: path.into(),
        source,
    })?;
    let (grid, negatives) = grid::read(&bytes, choice, bounds).map_err(|source| AirError::Grid {
        medium: medium.into(),
        file: path.into(),
        source,
    })?;
    let warning = negatives.map(|grid::Negatives { count, lowest }| AirWarning::Negative {
        medium: medium.into(),
        count,
        lowest,
    });
    Ok((Density::Grid(Arc::new(grid)), warning))
}
