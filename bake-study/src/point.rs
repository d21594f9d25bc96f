//! One way to bake: data, of which a study has many.

use bake_core::settings::{Quality, Settings};
use bake_core::solve::{self, grid::GridSettings};
use bake_core::solve::{LightmapSettings, Mode};
use serde::Serialize;

/// Where sampling ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Stop {
    /// After so many samples per texel.
    Samples(u32),
    /// At this standard error, within the range of samples of the preset that asks for it.
    Error(f32),
}

/// What is done to the air.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum AirChange {
    /// Nothing.
    AsIs,
    /// It is taken away.
    None,
    /// Scattering times a factor, extinction kept: 0 is attenuation only.
    Scattering(f64),
    /// Light collides at most so often between two surfaces.
    Collisions(u32),
    /// Every medium has one density, the middle of its least and largest.
    Uniform,
}

/// How the tables are read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tables {
    /// Distances.
    pub bins: usize,
    /// Degrees below which.
    pub bands: usize,
    /// Collisions up to which they are summed, where that is not left to the scene.
    pub orders: Option<usize>,
}

impl Default for Tables {
    fn default() -> Self {
        let solve::Effort { bins, bands, orders, .. } = solve::Effort::default();
        Self { bins, bands, orders }
    }
}

/// One way to bake.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// Solver of the air.
    pub mode: Mode,
    /// Samples.
    pub stop: Stop,
    /// Most reflections.
    pub bounces: Option<u32>,
    /// The air.
    pub air: AirChange,
    /// Cells and walks of the grid, where the mode has one.
    pub grid: Option<[u32; 2]>,
    /// How tables are read, where the mode has them.
    pub tables: Tables,
    /// Seed.
    pub seed: u32,
}

impl Point {
    /// What the solver is told.
    pub fn solver_settings(&self, settings: &Settings) -> LightmapSettings {
        let mut solver = settings.lightmap_settings();
        match self.stop {
            Stop::Samples(samples) => (solver.min_samples, solver.max_samples) = (samples, samples),
            Stop::Error(target) => {
                solver.target_error = target;
                (solver.min_samples, solver.max_samples) = preset(target).sample_range();
            }
        }
        (solver.bounces, solver.seed, solver.mode) = (self.bounces, self.seed, self.mode);
        if let AirChange::Collisions(most) = self.air {
            solver.collisions = Some(most);
        }
        let Tables { bins, bands, orders } = self.tables;
        solver.tables = solve::Effort { bins, bands, orders, ..solver.tables };
        if let Some([cells, samples]) = self.grid {
            solver.grid = GridSettings { cells, samples };
        }
        solver
    }

    /// Samples per texel that it will take, about.
    pub fn likely_samples(&self) -> u32 {
        match self.stop {
            Stop::Samples(samples) => samples,
            Stop::Error(target) => {
                let (floor, cap) = preset(target).sample_range();
                (target.powi(-2) as u32).clamp(floor, cap)
            }
        }
    }
}

/// The coarsest preset that is at least as exact.
fn preset(target: f32) -> Quality {
    let fitting =
        Quality::ALL.into_iter().map(|(_, quality)| quality).find(|quality| quality.relative_error() <= target);
    fitting.unwrap_or(Quality::Final)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_takes_the_range_of_the_preset_that_asks_for_it() {
        assert_eq!(
            [0.2, 0.1, 0.05, 0.04, 0.01, 0.001].map(preset),
            [Quality::Preview, Quality::Preview, Quality::Medium, Quality::Medium, Quality::Final, Quality::Final]
        );
    }
}
