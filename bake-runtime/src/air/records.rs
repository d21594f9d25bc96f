//! Media of a package, and what of them the shaders can draw.

use bake_formats::medium::{DensityRecord, MediumRecord};
use bake_formats::{FormatError, Package};
use bake_optics::medium::Medium;
use bake_optics::phase::Phase;

use super::voxels;
use crate::error::Result;
use crate::layout::MOST_MEDIA;

/// Legendre terms that stand for a tabulated phase function.
const TABLE_TERMS: usize = 32;

/// Media that are drawn, and a line about each one that is drawn coarsely or not at all.
pub fn media(package: &Package) -> Result<(Vec<Medium>, Vec<String>)> {
    let path = package.path(&format!("{}.bake.json", package.manifest.name));
    let (mut media, mut notes) = (Vec::new(), Vec::new());
    for (index, value) in package.manifest.media.iter().enumerate() {
        let record: MediumRecord = serde_json::from_value(value.clone()).map_err(|error| {
            FormatError::invalid(&path, format!("media[{index}]"), error.to_string(), "a medium; bake again")
        })?;
        let missing = matches!(record.density, DensityRecord::Grid { file: None, .. })
            .then_some("its density grid is too wide for a package's images");
        if let Some(why) = missing.or((media.len() == MOST_MEDIA).then_some("more than eight media")) {
            notes.push(format!("the medium '{}' is not drawn: {why}", record.name));
            continue;
        }
        let (medium, note) = voxels::drawable(record.medium(&path, |file| package.image(file))?);
        notes.extend(note.map(|note| format!("the medium '{}' is drawn coarsely: {note}", record.name)));
        media.push(Medium { phase: series(medium.phase), ..medium });
    }
    Ok((media, notes))
}

/// Tables become series.
fn series(phase: Phase<f64>) -> Phase<f64> {
    if let Phase::Table(_) = phase { phase.to_legendre(TABLE_TERMS) } else { phase }
}
