//! Which settings are baked: data, derived from the scene and the effort.
//!
//! A [`Group`] is one plot with its table; its [`Series`] are the plot's lines. Points that stand in several groups are
//! measured once.

use crate::effort::Effort;
use crate::point::{AirChange, Point, Stop, Tables};
use bake_core::job::Job;
use bake_core::plan::Choice;
use bake_core::settings::Settings;
use bake_core::solve::Mode;
use bake_core::solve::grid::GridSettings;

/// A line of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Points with their labels.
    pub points: Vec<(String, Point)>,
}

/// A plot with its table.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its kind.
    pub kind: Kind,
    /// The lines.
    pub series: Vec<Series>,
}

/// What a group varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Samples per texel, by mode.
    Samples,
    /// Reflections.
    Bounces,
    /// Collisions.
    Scattering,
    /// Density that changes from place to place.
    Unevenness,
    /// Cells and walks of the light grid.
    Grid,
    /// Distances, degrees and orders of the tables.
    Tables,
    /// Standard error asked for.
    Target,
    /// Settings that are wrong on purpose.
    Control,
}

impl Kind {
    /// Heading, and what to see; for the report.
    pub fn text(self) -> [&'static str; 2] {
        match self {
            Self::Samples => [
                "Samples per texel, by mode",
                "A line that goes level has met its mode's own error: more samples do not help. Walks are what `bake reference` does.",
            ],
            Self::Bounces => ["Reflections", "What leaving out later reflections costs in error and saves in time."],
            Self::Scattering => [
                "Scattering",
                "No air at all, air that only weakens, light scattered at most once, twice and ten times between two surfaces (these by walks), and any number of times.",
            ],
            Self::Unevenness => [
                "Uneven air",
                "Tables see uniform air of its own mean density along each ray, walks and the grid the air as it is; last, walks in air of one density.",
            ],
            Self::Grid => {
                ["Cells and walks of the light grid", "Error of mode `grid` by cells along a side and walks a node."]
            }
            Self::Tables => [
                "Tables",
                "Error of mode `tables` by the distances at which they are read, the bands of their harmonics, and the collisions up to which they are summed. Surfaces and lamps have fourteen harmonics, up to l = 8, by design: from 11 bands on only the light of sky and sun can change. Factors that the mode measures in the scene take most of what is left out on themselves.",
            ],
            Self::Target => [
                "Error asked for",
                "Asked: the target. Stated: what the bake says of itself, its standard error over the larger of texel and median. Measured: the relative RMSE against the reference, whose denominator falls to a hundredth of the mean, so that dark texels weigh more.",
            ],
            Self::Control => [
                "Controls: wrong on purpose",
                "These must show a bias that cannot be chance; where they do not, this report cannot be trusted.",
            ],
        }
    }
}

/// The number that tells the reference's random numbers from those of all points.
const REFERENCE_SEED: u32 = 0x7275_7468;

/// The groups of a scene.
pub fn groups(job: &Job, effort: &Effort) -> Vec<Group> {
    let base = Base::new(job);
    let mut groups = vec![base.samples(effort), base.bounces(effort)];
    if base.scatters {
        groups.extend([base.scattering(effort), base.grids(effort), base.tables(effort)]);
        if base.is_uneven {
            groups.push(base.unevenness(effort));
        }
    } else if base.has_air {
        groups.push(base.scattering(effort));
    }
    groups.extend([base.targets(effort), base.controls(effort)]);
    groups
}

/// The bake that all are compared with.
pub fn reference(settings: &Settings, effort: &Effort) -> Point {
    Point {
        mode: Mode::Walk,
        stop: Stop::Samples(effort.reference_samples),
        bounces: settings.bounces,
        air: AirChange::AsIs,
        grid: None,
        tables: Tables::default(),
        seed: settings.seed ^ REFERENCE_SEED,
    }
}

/// What the settings and the plan choose, from which one thing at a time is varied.
struct Base {
    point: Point,
    grid: [u32; 2],
    has_air: bool,
    scatters: bool,
    is_uneven: bool,
}

impl Base {
    fn new(job: &Job) -> Self {
        let settings = &job.settings;
        let GridSettings { cells, samples } = settings.quality.grid();
        let has_air = !job.air.is_empty();
        // How many rays escape decides on the error to expect, not on the mode.
        let mode = if has_air { Choice::derive(&job.scene, &job.air, settings, 0.0).mode } else { Mode::Walk };
        let point = Point {
            mode,
            stop: Stop::Samples(0),
            bounces: settings.bounces,
            air: AirChange::AsIs,
            grid: None,
            tables: Tables::default(),
            seed: settings.seed,
        };
        let scatters = has_air && job.air.scatters();
        Self { point, grid: [cells, samples], has_air, scatters, is_uneven: !job.air.is_homogeneous() }
    }

    fn with_mode(&self, mode: Mode, stop: Stop) -> Point {
        Point { mode, stop, grid: (mode == Mode::Grid).then_some(self.grid), ..self.point }
    }

    fn fixed(&self, effort: &Effort) -> Point {
        self.with_mode(self.point.mode, Stop::Samples(effort.fixed_samples))
    }

    fn samples(&self, effort: &Effort) -> Group {
        let line = |name: &str, mode| {
            let point =
                |&samples: &u32| (format!("{name}, {samples} samples"), self.with_mode(mode, Stop::Samples(samples)));
            Series { name: name.into(), points: effort.samples.iter().map(point).collect() }
        };
        let series = if self.scatters {
            [Mode::Walk, Mode::Grid, Mode::Tables, Mode::Paper].map(|mode| line(mode.name(), mode)).to_vec()
        } else {
            vec![line("paths", Mode::Walk)]
        };
        Group { kind: Kind::Samples, series }
    }

    fn bounces(&self, effort: &Effort) -> Group {
        const COUNTS: [u32; 7] = [0, 1, 2, 3, 4, 6, 10];
        let most = self.point.bounces.unwrap_or(u32::MAX);
        let capped = COUNTS.into_iter().filter(|&count| count < most).map(Some);
        let label = |bounces: Option<u32>| match bounces {
            None => "any number of reflections".into(),
            Some(1) => "1 reflection".into(),
            Some(count) => format!("{count} reflections"),
        };
        let points = capped.chain([self.point.bounces]);
        let points = points.map(|bounces| (label(bounces), Point { bounces, ..self.fixed(effort) })).collect();
        Group { kind: Kind::Bounces, series: vec![Series { name: self.point.mode.name().into(), points }] }
    }

    fn scattering(&self, effort: &Effort) -> Group {
        let line = |name: &str, air| {
            let point = |&samples: &u32| {
                let mode = if air == AirChange::AsIs { self.point.mode } else { Mode::Walk };
                (format!("{name}, {samples} samples"), Point { air, ..self.with_mode(mode, Stop::Samples(samples)) })
            };
            Series { name: name.into(), points: effort.samples.iter().map(point).collect() }
        };
        let mut series = vec![line("no air", AirChange::None), line("attenuation only", AirChange::Scattering(0.0))];
        if self.scatters {
            let cut = [("scattered once", 1), ("twice", 2), ("ten times", 10)];
            series.extend(cut.map(|(name, most)| line(name, AirChange::Collisions(most))));
            series.push(line("all orders", AirChange::AsIs));
        }
        Group { kind: Kind::Scattering, series }
    }

    fn grids(&self, effort: &Effort) -> Group {
        let point = |&[cells, walks]: &[u32; 2]| {
            let point = self.with_mode(Mode::Grid, Stop::Samples(effort.fixed_samples));
            (format!("{cells} cells, {walks} walks"), Point { grid: Some([cells, walks]), ..point })
        };
        let points = effort.grids.iter().map(point).collect();
        Group { kind: Kind::Grid, series: vec![Series { name: "grid".into(), points }] }
    }

    fn tables(&self, effort: &Effort) -> Group {
        let whole = Tables::default();
        let line = |name: &str, values: &[usize], change: &dyn Fn(usize) -> Tables| {
            let point = |&value: &usize| {
                let point = self.with_mode(Mode::Tables, Stop::Samples(effort.fixed_samples));
                (format!("{value} {name}"), Point { tables: change(value), ..point })
            };
            Series { name: name.into(), points: values.iter().map(point).collect() }
        };
        let series = vec![
            line("distances", &effort.bins, &|bins| Tables { bins, ..whole }),
            line("bands", &effort.bands, &|bands| Tables { bands, ..whole }),
            line("collisions", &effort.orders, &|orders| Tables { orders: Some(orders), ..whole }),
        ];
        Group { kind: Kind::Tables, series }
    }

    fn unevenness(&self, effort: &Effort) -> Group {
        let line = |name: &str, mode, air| {
            let point = |&samples: &u32| {
                (format!("{name}, {samples} samples"), Point { air, ..self.with_mode(mode, Stop::Samples(samples)) })
            };
            Series { name: name.into(), points: effort.samples.iter().map(point).collect() }
        };
        let mut series =
            [Mode::Walk, Mode::Grid, Mode::Tables].map(|mode| line(mode.name(), mode, AirChange::AsIs)).to_vec();
        series.push(line("walk, one density", Mode::Walk, AirChange::Uniform));
        Group { kind: Kind::Unevenness, series }
    }

    fn targets(&self, effort: &Effort) -> Group {
        let point = |&target: &f32| {
            (format!("asked {} %", 100.0 * target), self.with_mode(self.point.mode, Stop::Error(target)))
        };
        let points = effort.targets.iter().map(point).collect();
        Group { kind: Kind::Target, series: vec![Series { name: self.point.mode.name().into(), points }] }
    }

    fn controls(&self, effort: &Effort) -> Group {
        let fixed = Point { mode: Mode::Walk, grid: None, ..self.fixed(effort) };
        let mut points = vec![("one reflection".to_owned(), Point { bounces: Some(1), ..fixed })];
        if self.scatters {
            points.push(("a fifth less scattering".into(), Point { air: AirChange::Scattering(0.8), ..fixed }));
        }
        Group { kind: Kind::Control, series: vec![Series { name: "wrong".into(), points }] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_draws_the_references_numbers() {
        let settings = Settings::default();
        assert_ne!(reference(&settings, &Effort::quick()).seed, settings.seed);
    }
}
