//! Whether the intensities of a file look as if they were candela and lux, as KHR_lights_punctual says.
//!
//! Lamps of a household have 1 to 1000 candela and take 1 to 1000 watts, so a number alone proves nothing and honest
//! candela must not be doubted. These are taken as signs:
//!
//! * a sun of 0.5 to 20 lux: brighter than a full moon (0.3 lux), darker than an overcast day (above 100). Strengths of
//!   suns are written as 1 to 10;
//! * every light of the file is 1, the number of a light that nobody set;
//! * the file is Blender's, and a point or spot light's intensity, or 4π times it, is a number of at most two digits and
//!   zeros, as people type watts: "Raw" writes the watts, "Unitless" the watts divided by 4π. In candela ("Standard")
//!   they come multiplied with 683/4π, which leaves no such number.

use super::document::LightRecord;
use super::error::Place;
use super::warning::{WarningKind, Warnings};

/// Illuminance of suns that are none, lux.
const DIM_SUN_LUX: std::ops::RangeInclusive<f32> = 0.5..=20.0;

/// What exporters round to: f32.
const ROUNDING: f64 = 1e-6;

/// Warns about the lights of a file that look as if they were in other units.
pub(super) fn warn(lights: &[LightRecord], generator: &str, warnings: &mut Warnings) {
    let blender = generator.contains("Blender");
    let ones = lights.iter().all(|light| (intensity(light) - 1.0).abs() <= 1e-6);
    for (i, light) in lights.iter().enumerate() {
        let Some(guess) = guess(light, blender, ones) else { continue };
        let unit = if light.kind == "directional" { "lux" } else { "candela" };
        let message = format!("an intensity of {} {unit} looks like {guess}", intensity(light));
        warnings.push(WarningKind::LightUnits, &Place::entry("extensions.KHR_lights_punctual.lights", i), message);
    }
}

fn intensity(light: &LightRecord) -> f32 {
    light.intensity.unwrap_or(1.0)
}

/// What else a number may be, and the setting for it.
fn guess(light: &LightRecord, blender: bool, ones: bool) -> Option<&'static str> {
    let intensity = intensity(light);
    if light.kind == "directional" {
        let dim = DIM_SUN_LUX.contains(&intensity);
        return dim.then_some("W/m² or a factor; if so, give `--light-units watts` or `--light-units unitless`");
    }
    if ones {
        return Some("a factor; if so, give `--light-units watts` or `--light-units unitless`");
    }
    if !blender {
        return None;
    }
    let intensity = f64::from(intensity);
    if is_typed(intensity) {
        return Some("raw watts; if so, give `--light-units watts`");
    }
    is_typed(intensity * 4.0 * std::f64::consts::PI)
        .then_some("watts divided by 4π; if so, give `--light-units unitless`")
}

/// At most two digits, and zeros.
fn is_typed(value: f64) -> bool {
    if !(value.is_finite() && value > 0.0) {
        return false;
    }
    let two_digits = value / 10f64.powi(value.log10().floor() as i32 - 1);
    (two_digits - two_digits.round()).abs() <= ROUNDING * two_digits
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places and messages for lights given as type and intensity.
    fn warned(lights: &[(&str, f64)], generator: &str) -> Vec<(String, String)> {
        let json = |(kind, intensity): &(&str, f64)| format!(r#"{{"type":"{kind}","intensity":{intensity}}}"#);
        let lights: Vec<LightRecord> =
            lights.iter().map(|light| serde_json::from_str(&json(light)).expect("valid JSON")).collect();
        let mut warnings = Warnings::default();
        warn(&lights, generator, &mut warnings);
        warnings.into_vec().into_iter().map(|w| (w.object, w.message)).collect()
    }

    const BLENDER: &str = "Khronos glTF Blender I/O v4.0.44";

    #[test]
    fn every_wattage_that_people_type_is_told_from_candela() {
        for digits in 1..100 {
            for power in [0.1, 1.0, 10.0, 100.0] {
                let watts = f64::from(digits) * power;
                // A second light, so that not all are one.
                let message = |factor: f64| {
                    let first = warned(&[("point", watts * factor), ("spot", 543.514_13)], BLENDER);
                    first.first().map(|w| w.1.clone()).unwrap_or_default()
                };
                let per_sphere = 0.25 / std::f64::consts::PI;
                assert!(message(1.0).contains("--light-units watts"), "{watts} W raw");
                assert!(message(per_sphere).contains("--light-units unitless"), "{watts} W without unit");
                assert_eq!(message(683.0 * per_sphere), "", "{watts} W in candela");
            }
        }
    }

    #[test]
    fn honest_candela_and_lux_pass() {
        // A candle, bulbs, a stage lamp; full moon, overcast and clear sky.
        let lamps = [("point", 1.0), ("point", 64.0), ("spot", 100.0), ("point", 1000.0)];
        assert!(warned(&lamps, "an editor").is_empty());
        assert!(warned(&[("directional", 0.25), ("directional", 1000.0), ("directional", 1e5)], BLENDER).is_empty());
        assert!(warned(&[("point", 0.0), ("point", 64.3)], BLENDER).is_empty());
    }

    #[test]
    fn ones_and_dim_suns_do_not() {
        let places = |lights: &[(&str, f64)]| warned(lights, "an editor").into_iter().map(|w| w.0).collect::<Vec<_>>();
        assert_eq!(places(&[("point", 1.0), ("spot", 1.0)]), ["extensions.KHR_lights_punctual.lights[0]"]);
        assert_eq!(
            places(&[("point", 60.0), ("directional", 3.0)]),
            ["extensions.KHR_lights_punctual.lights[1]"],
            "the sun only"
        );
    }
}
