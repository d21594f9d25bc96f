//! Media as the manifest records them, read into the types of `bake-optics`.

use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use glam::{DVec3, Vec3};
use serde_json::Value;

use crate::error::{Result, RuntimeError};

/// Media of a manifest; `scene` is the box that the bounds `Scene` mean.
pub fn media(records: &[Value], scene: [Vec3; 2]) -> Result<Vec<Medium>> {
    let read =
        |(index, record): (usize, &Value)| medium(&Record { path: format!("media[{index}]"), value: record }, scene);
    records.iter().enumerate().map(read).collect()
}

fn medium(record: &Record, scene: [Vec3; 2]) -> Result<Medium> {
    let medium = Medium {
        bounds: bounds(&record.field("bounds"), scene)?,
        density: density(&record.field("density"))?,
        scatter: scatter(&record.field("scatter"))?,
        phase: phase(&record.field("phase"))?,
    };
    let coefficients = medium.scatter.sigma_s.iter().chain(&medium.scatter.sigma_a);
    if coefficients.clone().any(|c| !(c.is_finite() && *c >= 0.0)) {
        return Err(record.field("scatter").refuse("coefficients must be finite and at least 0"));
    }
    Ok(medium)
}

/// A JSON value and where it stands.
struct Record<'a> {
    path: String,
    value: &'a Value,
}

impl<'a> Record<'a> {
    fn field(&self, name: &str) -> Record<'a> {
        Record { path: format!("{}.{name}", self.path), value: self.value.get(name).unwrap_or(&Value::Null) }
    }

    fn refuse(&self, expected: &str) -> RuntimeError {
        let (field, value) = (format!("the manifest's {}", self.path), self.value.to_string());
        RuntimeError::Record { field, value, expected: expected.into() }
    }

    /// Name and content of an enum's variant: `"Name"` or `{"Name": content}`; absent: the default.
    fn variant(&self, default: &'static str) -> Result<(&'a str, Record<'a>)> {
        let at = |name: &str, value: &'a Value| Record { path: format!("{}.{name}", self.path), value };
        match self.value {
            Value::Null => Ok((default, at(default, &Value::Null))),
            Value::String(name) => Ok((name, at(name, &Value::Null))),
            Value::Object(map) if map.len() == 1 => {
                let (name, value) = map.iter().next().expect("one entry");
                Ok((name, at(name, value)))
            }
            _ => Err(self.refuse("a name, or one name with its content, is expected; bake again")),
        }
    }

    fn number(&self) -> Result<f64> {
        self.value.as_f64().filter(|n| n.is_finite()).ok_or_else(|| self.refuse("a number is expected; bake again"))
    }

    fn numbers(&self) -> Result<Vec<f64>> {
        let list = self.value.as_array().map(|list| list.iter().map(Value::as_f64).collect::<Option<Vec<_>>>());
        list.flatten().ok_or_else(|| self.refuse("a list of numbers is expected; bake again"))
    }

    /// Three numbers, or one for all three.
    fn triple(&self) -> Result<[f64; 3]> {
        if let Some(number) = self.value.as_f64() {
            return Ok([number; 3]);
        }
        let refuse = |_| self.refuse("three numbers are expected; bake again");
        self.numbers()?.try_into().map_err(refuse)
    }
}

fn bounds(record: &Record, scene: [Vec3; 2]) -> Result<Bounds> {
    let (name, content) = record.variant("Scene")?;
    let point = |name: &str| Ok::<_, RuntimeError>(DVec3::from(content.field(name).triple()?));
    match name {
        "Scene" => Ok(Bounds::Box { min: scene[0].as_dvec3(), max: scene[1].as_dvec3() }),
        "Unbounded" => Ok(Bounds::Unbounded),
        "Box" => Ok(Bounds::Box { min: point("min")?, max: point("max")? }),
        "Sphere" => Ok(Bounds::Sphere { centre: point("centre")?, radius: content.field("radius").number()? }),
        _ => Err(record.refuse("the runtime draws Scene, Unbounded, Box and Sphere")),
    }
}

fn density(record: &Record) -> Result<Density> {
    let (name, content) = record.variant("Uniform")?;
    let number = |name: &str| content.field(name).number();
    match name {
        "Uniform" => Ok(Density::Uniform),
        "Linear" => Ok(Density::Linear { zero_m: number("zero_m")?, slope_per_m: number("slope_per_m")? }),
        "Exponential" => {
            Ok(Density::Exponential { base_m: number("base_m")?, scale_height_m: number("scale_height_m")?.max(1e-6) })
        }
        _ => Err(record.refuse("the runtime draws Uniform, Linear and Exponential")),
    }
}

fn scatter(record: &Record) -> Result<Scatter> {
    let (name, content) = record.variant("")?;
    match name {
        "Sigma" => Ok(Scatter { sigma_s: content.field("s").triple()?, sigma_a: content.field("a").triple()? }),
        "Look" => {
            let length = content.field("mean_free_path_m").number()?;
            Ok(Scatter::from_look(length, content.field("albedo").triple()?))
        }
        _ => Err(record.refuse("Sigma or Look is expected; bake again")),
    }
}

fn phase(record: &Record) -> Result<Phase<f64>> {
    let (name, content) = record.variant("Isotropic")?;
    match name {
        "Isotropic" => Ok(Phase::Isotropic),
        "Rayleigh" => Ok(Phase::Rayleigh),
        "HenyeyGreenstein" => Ok(Phase::HenyeyGreenstein { g: content.number()? }),
        "Linear" => Ok(Phase::Linear { a1: content.number()? }),
        "Legendre" => Ok(Phase::Legendre(content.numbers()?)),
        _ => Err(record.refuse("the runtime draws Isotropic, Rayleigh, HenyeyGreenstein, Linear and Legendre")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_settings_form_is_read_and_what_is_unknown_is_named() {
        let record = json!({
            "name": "haze", "bounds": {"Box": {"min": [0, 1, 2], "max": [3, 4, 5]}},
            "density": {"Exponential": {"base_m": 1.0, "scale_height_m": 10.0}},
            "scatter": {"Look": {"mean_free_path_m": 2.0, "albedo": [0.9, 0.8, 0.7]}},
            "phase": {"HenyeyGreenstein": 0.3},
        });
        let read = media(&[record], [Vec3::ZERO, Vec3::ONE]).expect("valid").remove(0);
        assert_eq!(read.bounds, Bounds::Box { min: DVec3::new(0.0, 1.0, 2.0), max: DVec3::new(3.0, 4.0, 5.0) });
        assert_eq!(read.phase, Phase::HenyeyGreenstein { g: 0.3 });
        assert!((read.scatter.sigma_t()[2] - 0.5).abs() < 1e-12 && (read.scatter.sigma_s[2] - 0.35).abs() < 1e-12);
        for (record, words) in [
            (json!({"scatter": {"Sigma": {"s": [1, 1], "a": [0, 0, 0]}}}), "media[0].scatter.Sigma.s"),
            (json!({"scatter": {"Sigma": {"s": [-1, 1, 1], "a": [0, 0, 0]}}}), "at least 0"),
            (
                json!({"bounds": {"Node": "x"}, "scatter": {"Sigma": {"s": [1, 1, 1], "a": [0, 0, 0]}}}),
                "media[0].bounds",
            ),
            (json!({"bounds": 3}), "media[0].bounds"),
        ] {
            let error = media(&[record], [Vec3::ZERO, Vec3::ONE]).expect_err(words).to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
