//! Media of a package, and what of them the shaders can draw.

use bake_formats::{FormatError, MediumRecord, Package};
use bake_optics::medium::{Bounds, Density, Medium};
use bake_optics::phase::Phase;

use crate::error::Result;
use crate::layout::MOST_MEDIA;

/// Legendre terms that stand for a tabulated phase function.
const TABLE_TERMS: usize = 32;

/// Media that are drawn, and a line about each one that is not.
pub fn media(package: &Package) -> Result<(Vec<Medium>, Vec<String>)> {
    let path = package.path(&format!("{}.bake.json", package.manifest.name));
    let (mut media, mut notes) = (Vec::new(), Vec::new());
    for (index, value) in package.manifest.media.iter().enumerate() {
        let record: MediumRecord = serde_json::from_value(value.clone()).map_err(|error| {
            FormatError::invalid(&path, format!("media[{index}]"), error.to_string(), "a medium; bake again")
        })?;
        let medium = record.medium(&path, |file| package.image(file))?;
        match drawable(&medium).or((media.len() == MOST_MEDIA).then_some("more than eight media")) {
            Some(what) => notes.push(format!("the medium '{}' is not drawn: {what}", record.name)),
            None => media.push(Medium { phase: series(medium.phase), ..medium }),
        }
    }
    Ok((media, notes))
}

/// What the shaders do not know of a medium.
fn drawable(medium: &Medium) -> Option<&'static str> {
    match (&medium.bounds, &medium.density) {
        (Bounds::Hull(_) | Bounds::Mesh(_), _) => Some("it ends at a mesh"),
        (_, Density::Planet { .. }) => Some("its density falls with height above a ball"),
        (_, Density::Grid(_)) => Some("its density is a grid"),
        _ => None,
    }
}

/// Tables become series.
fn series(phase: Phase<f64>) -> Phase<f64> {
    if let Phase::Table(_) = phase { phase.to_legendre(TABLE_TERMS) } else { phase }
}
