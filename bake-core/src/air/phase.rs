//! Phase functions: checked parameters, and tables read from files.
//!
//! A table is text: an angle in degrees and a value a line, divided by blanks, tabs, `,` or `;`; `#` begins a comment.
//! Angles ascend from 0 (straight on) to 180; values are ≥ 0 in any unit and are normalised.

use super::{AirError, decimal};
use crate::settings;
use bake_optics::phase::Phase;
use std::path::Path;

/// Largest table, bytes: a million lines.
const MOST_BYTES: u64 = 64 << 20;

/// The phase function of a medium.
pub fn resolve(record: &settings::Phase, medium: &str) -> Result<Phase<f64>, AirError> {
    let phase = match record {
        settings::Phase::Isotropic => Phase::Isotropic,
        settings::Phase::Rayleigh => Phase::Rayleigh,
        // Even air needs no directions.
        settings::Phase::HenyeyGreenstein(0.0) | settings::Phase::Linear(0.0) => Phase::Isotropic,
        settings::Phase::HenyeyGreenstein(g) => Phase::HenyeyGreenstein { g: decimal(*g) },
        settings::Phase::Linear(a1) => Phase::Linear { a1: decimal(*a1) },
        settings::Phase::Legendre(terms) => Phase::Legendre(terms.iter().copied().map(decimal).collect()),
        settings::Phase::Table(file) => table(file, medium)?,
    };
    phase.check().map_err(|source| AirError::Phase { medium: medium.into(), source })?;
    if let Phase::Legendre(terms) = &phase {
        check_sign(&phase, terms.len(), medium)?;
    }
    Ok(phase)
}

/// Refuses a series below zero; it has fewer bends than terms, and eight points a bend find each.
fn check_sign(phase: &Phase<f64>, terms: usize, medium: &str) -> Result<(), AirError> {
    let points = 8 * terms.clamp(16, 4096);
    let value = |i: usize| {
        let angle = std::f64::consts::PI * i as f64 / points as f64;
        (phase.eval(angle.cos()), angle.to_degrees())
    };
    let (value, angle_deg) = (0..=points).map(value).min_by(|a, b| a.0.total_cmp(&b.0)).expect("at least one point");
    // Terms written with seven digits may touch zero from below.
    let slack = 1e-6 * phase.eval(1.0).abs().max(1.0);
    if value >= -slack { Ok(()) } else { Err(AirError::NegativePhase { medium: medium.into(), value, angle_deg }) }
}

fn table(file: &Path, medium: &str) -> Result<Phase<f64>, AirError> {
    let bytes = super::file::read(file, MOST_BYTES).map_err(|source| AirError::Unreadable {
        medium: medium.into(),
        file: file.into(),
        source,
    })?;
    let text = String::from_utf8_lossy(&bytes);
    let (mut angles, mut values) = (Vec::new(), Vec::new());
    for (index, line) in text.lines().enumerate() {
        let wrong = |message| {
            let (medium, file) = (medium.into(), file.into());
            AirError::TableLine { medium, file, line: index + 1, message }
        };
        let content = line.split('#').next().unwrap_or_default();
        let fields: Vec<&str> = content.split([' ', '\t', ',', ';']).filter(|field| !field.is_empty()).collect();
        let number = |text: &str| text.parse::<f64>().map_err(|_| wrong(format!("`{}` is no number", short(text))));
        match fields[..] {
            [] => {}
            [angle, value] => {
                angles.push(number(angle)?.to_radians());
                values.push(number(value)?);
            }
            _ => return Err(wrong(format!("{} fields", fields.len()))),
        }
    }
    Phase::from_table(angles, values).map_err(|source| AirError::Table {
        medium: medium.into(),
        file: file.into(),
        source,
    })
}

/// The beginning of a text that may be long.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}
