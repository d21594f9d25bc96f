//! What `run`, `plan` and `refog` work on: a scene made ready, its errors told as the program tells them.

use crate::exit::Failure;
use crate::input::Input;
use crate::progress::Progress;
use crate::report::Stopwatch;
use bake_core::air::AirError;
use bake_core::atlas::AtlasError;
pub use bake_core::job::Job;
use bake_core::job::JobError;
use bake_core::progress::Progress as _;

/// Loads and lays out.
pub fn prepare(input: &Input, progress: &Progress, stopwatch: &mut Stopwatch) -> Result<Job, Failure> {
    let settings = input.settings()?;
    let job = Job::prepare(&input.file, settings, progress)?;
    job.seconds.iter().for_each(|&(stage, seconds)| stopwatch.add(stage, seconds));
    Ok(job)
}

impl From<JobError> for Failure {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Settings(error) => error.into(),
            JobError::Air(error) => error.into(),
            JobError::Atlas(error) => error.into(),
            JobError::Interrupted(error) => error.into(),
            error @ JobError::NothingToBake { .. } => Self::wrong(
                error.to_string(),
                "give some to nodes with `--nodes NAME:lightmap=true`, or to GPU instances with `--bake-instanced`",
            ),
            JobError::Scene(error) => Self::invalid(error),
        }
    }
}

impl From<AirError> for Failure {
    fn from(error: AirError) -> Self {
        match error {
            AirError::Settings(error) => error.into(),
            error => Self::invalid(error),
        }
    }
}

impl From<AtlasError> for Failure {
    fn from(error: AtlasError) -> Self {
        Self::invalid(error)
    }
}

/// Ends the command where Ctrl-C was pressed.
pub fn stop_if_interrupted(progress: &Progress) -> Result<(), Failure> {
    if progress.is_cancelled() { Err(Failure::Interrupted) } else { Ok(()) }
}
