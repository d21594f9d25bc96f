//! When a mode comes down to an error: measured where its samples reach it, else expected by the law of its noise.

use crate::pareto;
use crate::store::Row;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Formatter};

/// When one way to solve the air comes down to an error, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// By a power law between the two measured points around it.
    Measured(f64),
    /// With more samples than were measured.
    Expected(f64),
    /// As expected without any floor: the floor is too small to be told from chance, so it may be more.
    AtLeast(f64),
    /// With no number of samples: the floor is above.
    Never,
}

impl Reach {
    /// Of rows in the order of their samples. Beyond the last one, of s seconds, noise² falls with what is not
    /// preparation and the floor f stays: prepare + (s − prepare)·noise²/(level² − f²).
    pub fn new(rows: &[&Row], level: f64) -> Option<Self> {
        let most = rows.last()?;
        let line: Vec<(f64, f64)> = rows.iter().map(|row| (row.seconds, row.rmse)).collect();
        if let Some(seconds) = pareto::seconds_to(&line, level) {
            return Some(Self::Measured(seconds));
        }
        let with_floor = |floor: f64| {
            let rest = level * level - floor * floor;
            let traced = most.seconds - most.prepare_seconds;
            (rest > 0.0).then(|| most.prepare_seconds + traced * (most.noise * most.noise / rest).max(1.0))
        };
        if most.errors().has_floor() {
            Some(with_floor(most.floor).map_or(Self::Never, Self::Expected))
        } else {
            with_floor(0.0).map(Self::AtLeast)
        }
    }
}

impl Display for Reach {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Measured(seconds) => write!(f, "{seconds:.2}"),
            Self::Expected(seconds) => write!(f, "~ {seconds:.0}"),
            Self::AtLeast(seconds) => write!(f, "≥ {seconds:.0}"),
            Self::Never => f.write_str("never"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PREPARE: f64 = 2.0;

    /// A mode with 10 % of noise after a second of tracing, over a floor.
    fn rows(floor: f64, least_floor: f64) -> [Row; 3] {
        [1.0, 4.0, 16.0].map(|traced: f64| {
            let noise = 0.1 / traced.sqrt();
            let rmse = noise.hypot(floor);
            let seconds = PREPARE + traced;
            Row { seconds, prepare_seconds: PREPARE, rmse, noise, floor, least_floor, ..Row::default() }
        })
    }

    fn reach(rows: &[Row], level: f64) -> Reach {
        Reach::new(&rows.iter().collect::<Vec<_>>(), level).expect("there are rows")
    }

    #[test]
    fn what_is_expected_of_few_samples_is_what_more_take() {
        let rows = rows(0.02, 0.001);
        let Reach::Expected(seconds) = reach(&rows[..2], rows[2].rmse) else { panic!("one more row is needed") };
        assert!((seconds - rows[2].seconds).abs() < 1e-9, "{seconds}");
        let Reach::Measured(seconds) = reach(&rows, rows[2].rmse) else { panic!("the last row is there") };
        assert!((seconds - rows[2].seconds).abs() < 1e-9, "{seconds}");
    }

    #[test]
    fn a_floor_above_is_never_passed_and_one_in_doubt_only_bounds() {
        assert_eq!([0.02, 0.019].map(|level| reach(&rows(0.02, 0.001), level)), [Reach::Never; 2]);
        let Reach::AtLeast(seconds) = reach(&rows(0.001, 0.03), 0.01) else { panic!("the floor is in doubt") };
        assert!((seconds - PREPARE - 100.0).abs() < 1e-9, "{seconds}");
        // Its noise is small enough, its error is not: by chance or by the floor.
        assert_eq!(reach(&rows(0.02, 0.03), 0.026), Reach::AtLeast(PREPARE + 16.0));
        assert_eq!(Reach::new(&[], 0.01), None);
    }

    #[test]
    fn what_was_not_measured_does_not_look_measured() {
        let all = [Reach::Measured(1.234), Reach::Expected(1234.5), Reach::AtLeast(250.0), Reach::Never];
        assert_eq!(all.map(|reach| reach.to_string()), ["1.23", "~ 1234", "≥ 250", "never"]);
    }
}
