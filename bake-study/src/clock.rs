//! What times are told by.

use cpu_time::ProcessTime;
use std::time::Instant;

/// A clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Clock {
    /// What one waits.
    #[default]
    Wall,
    /// What the processor spends on this process, all threads together: the same on a busy machine, more or less.
    Processor,
}

/// A running measurement.
pub enum Running {
    /// Of [`Clock::Wall`].
    Wall(Instant),
    /// Of [`Clock::Processor`].
    Processor(ProcessTime),
}

impl Clock {
    /// Begins to measure.
    pub fn start(self) -> Running {
        match self {
            Self::Wall => Running::Wall(Instant::now()),
            Self::Processor => Running::Processor(ProcessTime::now()),
        }
    }

    /// Name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Processor => "processor",
        }
    }
}

impl Running {
    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        match self {
            Self::Wall(start) => start.elapsed().as_secs_f64(),
            Self::Processor(start) => start.elapsed().as_secs_f64(),
        }
    }
}
