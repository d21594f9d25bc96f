//! The parameters from which a table file is made: same recipe, same numbers.

use crate::area::AngleGrid;
use crate::curves::Grid;
use crate::fitted::{self, Criterion};
use crate::remap::Air;
use crate::transport::phase_basis::{LEGENDRE_ORDERS, PhaseBasis};
use bake_formats::table_file::Precision;
use serde::{Deserialize, Serialize};

/// How the light of an area is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// Mirror-symmetric SH, one table per Legendre order of the phase function.
    Harmonic,
    /// Once-scattered light as published in 2019: areas in zonal harmonics about a fitted axis at 8 angles, and three tables
    /// g = −0.5, 0, 0.5 of every emitter. Higher orders as in the other layout.
    Paper,
    /// The same with the axis fitted to irradiance, not to radiance.
    PaperIrradiance,
}

impl Layout {
    /// What the axis is fitted to, in the layouts that have one.
    pub fn criterion(self) -> Option<Criterion> {
        match self {
            Self::Harmonic => None,
            Self::Paper => Some(Criterion::Radiance),
            Self::PaperIrradiance => Some(Criterion::Irradiance),
        }
    }
}

/// Zonal bands that look-up contracts at most.
pub const MOST_BANDS: usize = 16;

/// All parameters of a table file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Layout of the area tables.
    pub layout: Layout,
    /// Distances stored.
    pub grid: Grid,
    /// Nodes over the same distances when read: stored curves are refined by a cubic to so many.
    pub read_bins: usize,
    /// Emitter angles stored (the published layout has its own 8).
    pub angles: AngleGrid,
    /// Angle nodes when read.
    pub read_angles: usize,
    /// Zonal bands of point and directional tables, 3 … 16.
    pub bands: usize,
    /// Scattering orders, 2 … 10, each a table.
    pub scatter_orders: usize,
    /// Legendre orders of the phase function for light scattered once, 1 … 24.
    pub legendre_orders: usize,
    /// Albedo of the sums over all orders.
    pub all_orders_albedo: f64,
    /// Storage of area and axial tables and of higher orders (once-scattered point and directional light is always f32).
    pub precision: Precision,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            layout: Layout::Harmonic,
            grid: Grid { bins: 128, ..Grid::default() },
            read_bins: 256,
            angles: AngleGrid::default(),
            read_angles: 145,
            bands: 11,
            scatter_orders: 10,
            legendre_orders: LEGENDRE_ORDERS,
            all_orders_albedo: 1.0,
            precision: Precision::F16,
        }
    }
}

impl Recipe {
    /// The functions of the deflection for which order-1 tables are made.
    pub fn basis(&self) -> PhaseBasis {
        match self.layout.criterion() {
            None => PhaseBasis::Legendre(self.legendre_orders),
            Some(_) => fitted::basis(),
        }
    }

    /// Weights of these functions for a medium.
    pub fn weights(&self, air: &Air) -> Vec<f64> {
        match self.layout.criterion() {
            None => air.legendre_weights(self.legendre_orders),
            Some(_) => fitted::weights(air.phase.moment(1)).map(|w| air.albedo * w).to_vec(),
        }
    }

    /// The grid that is read.
    pub fn read_grid(&self) -> Grid {
        Grid { bins: self.read_bins, ..self.grid }
    }

    /// What is wrong with the recipe, if anything: field, value and allowed range.
    pub fn fault(&self) -> Option<String> {
        let outside = |name: &str, value: usize, low: usize, high: usize| {
            (value < low || value > high).then(|| format!("{name} is {value}, allowed are {low} to {high}"))
        };
        let Grid { min, max, bins } = self.grid;
        let range_ok =
            min.is_finite() && max.is_finite() && (1e-4..=0.1).contains(&min) && (5.0..=100.0).contains(&max);
        None.or_else(|| outside("bins", bins, 16, 4096))
            .or_else(|| outside("read_bins", self.read_bins, 16, 4096))
            .or_else(|| outside("angles", self.angles.nodes, 9, 257))
            .or_else(|| outside("read_angles", self.read_angles, 9, 257))
            .or_else(|| outside("bands", self.bands, 3, MOST_BANDS))
            .or_else(|| outside("scatter_orders", self.scatter_orders, 2, 10))
            .or_else(|| outside("legendre_orders", self.legendre_orders, 1, 24))
            .or_else(|| (!range_ok).then(|| format!("range is {min}:{max}, allowed are 1e-4…0.1 : 5…100")))
            .or_else(|| {
                let albedo = self.all_orders_albedo;
                (!(albedo > 0.0 && albedo <= 1.0))
                    .then(|| format!("all_orders_albedo is {albedo}, allowed is 0 < albedo ≤ 1"))
            })
            .or_else(|| {
                let crowding = self.angles.crowding;
                (!(0.05..=10.0).contains(&crowding)).then(|| format!("crowding is {crowding}, allowed are 0.05 to 10"))
            })
            .or_else(|| (self.angles.nodes.is_multiple_of(2)).then(|| "angles must be odd".to_owned()))
    }
}
