//! Whether values make sense: each is named with its allowed range where it does not.

use super::{Bounds, Density, FogVolume, Medium, Mode, Phase, Probes, Scatter, Settings, SettingsError, Unlit};
use std::fmt::Display;
use std::ops::RangeInclusive;

type Check = Result<(), SettingsError>;

impl Settings {
    /// Judges every value.
    pub fn check(&self) -> Check {
        self.check_accuracy()?;
        self.check_atlas()?;
        self.check_light()?;
        for (index, medium) in self.media.iter().flatten().enumerate() {
            medium.check(index)?;
        }
        if let Some(probes) = &self.probes {
            probes.check()?;
        }
        if let Some(FogVolume { spacing_m }) = self.fog_volume {
            optional("fog_volume.spacing_m", spacing_m, 0.01..=1e4)?;
        }
        self.check_paths()?;
        for (name, node) in &self.nodes {
            if let Some(density) = node.texels_per_m {
                range(&format!("nodes.{name}.texels_per_m"), density, 1e-3..=1e5)?;
            }
        }
        Ok(())
    }

    fn check_accuracy(&self) -> Check {
        optional("target_error", self.target_error, 1e-5..=1.0)?;
        optional("samples", self.samples, 1..=1 << 24)?;
        optional("bounces", self.bounces, 0..=1 << 16)?;
        range("tolerance", self.tolerance, 0.0..=1.0)?;
        optional("time_budget", self.time_budget, 0.1..=1e7)
    }

    /// Paths that know nothing of the air are those of tables alone, and these gather no harmonics.
    fn check_paths(&self) -> Check {
        match self.mode {
            _ if !self.keep_paths => Ok(()),
            _ if self.sh1 => {
                Err(refusal("sh1", "set beside `keep_paths`", "one of the two: tables hold no directions"))
            }
            Mode::Auto | Mode::Tables => Ok(()),
            mode => {
                Err(refusal("mode", format!("{mode:?} beside `keep_paths`"), "Tables or Auto where paths are kept"))
            }
        }
    }

    fn check_atlas(&self) -> Check {
        range("texels_per_m", self.texels_per_m, 1e-3..=1e5)?;
        range("page_size", self.page_size, 16..=16384)?;
        optional("max_pages", self.max_pages, 1..=9999)?;
        range("padding", self.padding, 1..=64)
    }

    fn check_light(&self) -> Check {
        if self.sky.is_some() && self.env.is_some() {
            return Err(refusal("sky", "set beside `env`", "one of the two"));
        }
        if let Some(sky) = self.sky {
            channels("sky", sky, 0.0..=1e9)?;
        }
        if let Some(sun) = self.sun {
            range("sun.azimuth_deg", sun.azimuth_deg, -360.0..=360.0)?;
            range("sun.elevation_deg", sun.elevation_deg, -90.0..=90.0)?;
            range("sun.lux", sun.lux, 0.0..=1e9)?;
            channels("sun.colour", sun.colour, 0.0..=1e3)?;
            range("sun.angular_diameter_deg", sun.angular_diameter_deg, 0.0..=90.0)?;
        }
        if let Some(env) = &self.env {
            range("env.rotation_deg", env.rotation_deg, -360.0..=360.0)?;
            range("env.scale", env.scale, 0.0..=1e9)?;
        }
        if let Unlit::Emit(radiance) = self.unlit {
            range("unlit", radiance, 0.0..=1e9)?;
        }
        range("light_scale", self.light_scale, 1e-9..=1e9)?;
        range("light_radius_m", self.light_radius_m, 1e-6..=10.0)
    }
}

impl Probes {
    fn check(&self) -> Check {
        range("probes.spacing_m", self.spacing_m, 0.01..=1e4)?;
        if let Bounds::Box { min, max } = self.bounds {
            channels("probes.bounds", min, -1e9..=1e9)?;
            channels("probes.bounds", max, -1e9..=1e9)?;
            if min.iter().zip(max).any(|(low, high)| *low > high) {
                return Err(refusal("probes.bounds", format!("{min:?} to {max:?}"), "min not above max"));
            }
        } else if self.bounds != Bounds::Scene {
            return Err(refusal("probes.bounds", format!("{:?}", self.bounds), "Scene, or Box(min: …, max: …)"));
        }
        for (index, point) in self.points.iter().enumerate() {
            channels(&format!("probes.points[{index}]"), *point, -1e9..=1e9)?;
        }
        if !self.points.is_empty() && (self.origin, self.count, &self.bounds) != (None, None, &Bounds::Scene) {
            return Err(refusal("probes.points", "a list", "no list beside `bounds`, `origin` and `count`"));
        }
        match (self.origin, self.count) {
            (None, None) => Ok(()),
            (Some(origin), Some(count)) if self.bounds == Bounds::Scene => {
                channels("probes.origin", origin, -1e9..=1e9)?;
                count.into_iter().try_for_each(|count| range("probes.count", count, 1..=1 << 16))
            }
            (Some(_), Some(_)) => Err(refusal("probes.bounds", "a box", "no box beside `origin` and `count`")),
            (origin, _) => {
                let (there, missing) = if origin.is_some() { ("origin", "count") } else { ("count", "origin") };
                Err(refusal(&format!("probes.{missing}"), "absent", format!("one beside `{there}`, or neither")))
            }
        }
    }
}

impl Medium {
    /// Judges every value of the medium at `index`.
    pub(crate) fn check(&self, index: usize) -> Check {
        let key = &self.key(index);
        self.check_bounds(&format!("{key}.bounds"))?;
        self.check_density(&format!("{key}.density"))?;
        match &self.scatter {
            Scatter::Sigma { s, a } => {
                channels(&format!("{key}.scatter.s"), *s, 0.0..=1e6)?;
                channels(&format!("{key}.scatter.a"), *a, 0.0..=1e6)?;
            }
            Scatter::Look { mean_free_path_m, albedo } => {
                range(&format!("{key}.scatter.mean_free_path_m"), *mean_free_path_m, 1e-6..=1e9)?;
                channels(&format!("{key}.scatter.albedo"), *albedo, 0.0..=1.0)?;
            }
        }
        self.check_phase(&format!("{key}.phase"))
    }

    /// Path to the record in messages: by its name where it has one.
    fn key(&self, index: usize) -> String {
        if self.name.is_empty() { format!("media[{index}]") } else { format!("media[\"{}\"]", self.name) }
    }

    fn check_bounds(&self, key: &str) -> Check {
        match &self.bounds {
            Bounds::Box { min, max } => {
                channels(key, *min, -1e9..=1e9)?;
                channels(key, *max, -1e9..=1e9)?;
                let ordered = min.iter().zip(max).all(|(low, high)| low < high);
                if ordered { Ok(()) } else { Err(refusal(key, format!("{min:?} to {max:?}"), "min below max")) }
            }
            Bounds::Sphere { centre, radius } => {
                channels(key, *centre, -1e9..=1e9)?;
                range(&format!("{key}.radius"), *radius, 1e-6..=1e9)
            }
            Bounds::Unbounded => match self.density {
                Density::Exponential { .. } | Density::Planet { .. } | Density::Grid { .. } => Ok(()),
                _ => Err(refusal(key, "Unbounded", "that only with the densities Exponential, Planet and Grid")),
            },
            Bounds::Scene | Bounds::Node(_) => Ok(()),
        }
    }

    fn check_density(&self, key: &str) -> Check {
        match &self.density {
            Density::Uniform => Ok(()),
            Density::Grid { size, .. } => {
                size.iter().flatten().try_for_each(|&points| range(&format!("{key}.size"), points, 1..=1 << 20))
            }
            Density::Linear { zero_m, slope_per_m } => {
                range(&format!("{key}.zero_m"), *zero_m, -1e9..=1e9)?;
                range(&format!("{key}.slope_per_m"), *slope_per_m, -1e6..=1e6)
            }
            Density::Exponential { base_m, scale_height_m } => {
                range(&format!("{key}.base_m"), *base_m, -1e9..=1e9)?;
                range(&format!("{key}.scale_height_m"), *scale_height_m, 1e-3..=1e9)
            }
            Density::Planet { centre, radius_m, scale_height_m } => {
                channels(&format!("{key}.centre"), *centre, -1e9..=1e9)?;
                range(&format!("{key}.radius_m"), *radius_m, 1e-3..=1e9)?;
                range(&format!("{key}.scale_height_m"), *scale_height_m, 1e-3..=1e9)
            }
        }
    }

    fn check_phase(&self, key: &str) -> Check {
        match &self.phase {
            Phase::Isotropic | Phase::Rayleigh | Phase::Table(_) => Ok(()),
            Phase::HenyeyGreenstein(g) => range(key, *g, -0.999..=0.999),
            // Beyond these the function is negative somewhere.
            Phase::Linear(a1) => range(key, *a1, -1.0..=1.0),
            Phase::Legendre(coefficients) => match coefficients.first() {
                Some(&1.0) => coefficients.iter().try_for_each(|&b| range(key, b, -1e3..=1e3)),
                _ => Err(refusal(key, format!("{coefficients:?}"), "a list that begins with 1")),
            },
        }
    }
}

fn refusal(key: &str, value: impl Display, allowed: impl Display) -> SettingsError {
    SettingsError::OutOfRange { key: key.into(), value: value.to_string(), allowed: allowed.to_string() }
}

/// A value that is no number is in no range.
fn range<T: PartialOrd + Display>(key: &str, value: T, allowed: RangeInclusive<T>) -> Check {
    if allowed.contains(&value) {
        return Ok(());
    }
    Err(refusal(key, value, format_args!("{} to {}", allowed.start(), allowed.end())))
}

fn optional<T: PartialOrd + Display>(key: &str, value: Option<T>, allowed: RangeInclusive<T>) -> Check {
    value.map_or(Ok(()), |value| range(key, value, allowed))
}

fn channels(key: &str, values: [f32; 3], allowed: RangeInclusive<f32>) -> Check {
    values.into_iter().try_for_each(|value| range(key, value, allowed.clone()))
}

#[cfg(test)]
mod tests {
    use super::super::file::parse;
    use super::*;

    fn fault(text: &str) -> String {
        let settings = parse("test".as_ref(), text.to_owned()).expect("parses");
        settings.check().expect_err(text).to_string()
    }

    #[test]
    fn defaults_are_allowed() {
        Settings::default().check().expect("the default is valid");
    }

    #[test]
    fn values_outside_their_range_are_named() {
        let cases = [
            ("Bake(texels_per_m: -3)", "`texels_per_m` is -3"),
            ("Bake(texels_per_m: inf)", "`texels_per_m` is inf"),
            ("Bake(texels_per_m: NaN)", "`texels_per_m` is NaN"),
            ("Bake(page_size: 0)", "allowed is 16 to 16384"),
            ("Bake(max_pages: 0)", "`max_pages` is 0"),
            ("Bake(target_error: 0)", "`target_error` is 0"),
            ("Bake(samples: Some(0))", "`samples` is 0"),
            ("Bake(tolerance: -0.1)", "`tolerance` is -0.1"),
            ("Bake(sky: (1, -1, 1))", "`sky` is -1"),
            ("Bake(sky: (1, 1, 1), env: Env(file: \"a.hdr\"))", "one of the two"),
            ("Bake(sun: Sun(azimuth_deg: 0, elevation_deg: 91, lux: 1))", "`sun.elevation_deg` is 91"),
            ("Bake(light_scale: 0)", "allowed is 0.000000001 to 1000000000"),
            ("Bake(unlit: Emit(-1))", "`unlit` is -1"),
            ("Bake(keep_paths: true, mode: Walk)", "Tables or Auto"),
            ("Bake(keep_paths: true, sh1: true)", "one of the two"),
            ("Bake(probes: Probes(spacing_m: 0))", "`probes.spacing_m` is 0"),
            ("Bake(probes: Probes(spacing_m: 1, origin: (0, 0, 0)))", "`probes.count` is absent"),
            ("Bake(probes: Probes(spacing_m: 1, bounds: Unbounded))", "Scene, or Box"),
            ("Bake(probes: Probes(spacing_m: 1, points: [(0, 1, 0), (0, NaN, 0)]))", "`probes.points[1]`"),
            (
                "Bake(probes: Probes(spacing_m: 1, points: [(0, 1, 0)], origin: (0, 0, 0), count: (1, 1, 1)))",
                "no list beside",
            ),
            ("Bake(fog_volume: FogVolume(spacing_m: NaN))", "`fog_volume.spacing_m` is NaN"),
            ("Bake(nodes: {\"A\": Node(texels_per_m: 0)})", "`nodes.A.texels_per_m` is 0"),
            ("Bake(media: [Medium(scatter: Look(mean_free_path_m: 2, albedo: (1, 1, 2)))])", "media[0].scatter.albedo"),
            ("Bake(media: [Medium(scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0)), phase: HenyeyGreenstein(1))])", "phase"),
            ("Bake(media: [Medium(scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0)), bounds: Unbounded)])", "Exponential"),
            (
                "Bake(media: [Medium(scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0)), bounds: Box(min: (0, 0, 0), max: (1, 0, 1)))])",
                "min below max",
            ),
        ];
        for (text, part) in cases {
            let message = fault(text);
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
