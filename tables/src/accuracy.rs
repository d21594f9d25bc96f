//! Measured error of look-up: every table read between its nodes, through storage, refinement and linear interpolation,
//! against direct evaluation of the integral.

use bake_formats::table_file::{TableFile, TableFileError};
use bake_optics::phase::Phase;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::axial::{self, HARMONICS};
use crate::curves::{Curves, DistanceMap};
use crate::generate::slab_sources;
use crate::recipe::Recipe;
use crate::remap::Air;
use crate::set::{NAMES, Scatter, TableSet};
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::slab::SlabSource;
use crate::transport::sources::Source;
use crate::{area, directional, point};

/// Distances at which a new file is measured.
pub const SAMPLES: usize = 48;

/// What [`verify`] allows on top of the stored bound: a random subset may meet a slightly worse place than the fixed samples did.
const SLACK: f64 = 1.5;

/// Largest error of each table of [`NAMES`] over `count` distances spread between the ends of the grid, as a share of the l = 0
/// coefficient of the same order (order 1: of the isotropic function; area: at the same angle).
pub fn measure(set: &TableSet, count: usize) -> Vec<f64> {
    NAMES.iter().map(|name| measure_at(set, name, &spread(set.recipe(), count, 0.5))).collect()
}

/// `count` distances by the golden ratio, uniform in ln d, up to where tables per order begin to fade.
fn spread(recipe: &Recipe, count: usize, start: f64) -> Vec<f64> {
    let (low, high) = (recipe.grid.min.ln(), (0.9 * recipe.grid.max).ln());
    (0..count).map(|i| (low + (high - low) * (start + 0.618_033_988_749_894_9 * i as f64).fract()).exp()).collect()
}

/// The same of one table at given distances. Panics on a name that is none of [`NAMES`].
pub fn measure_at(set: &TableSet, name: &str, distances: &[f64]) -> f64 {
    let recipe = set.recipe();
    let (bands, orders, albedo) = (recipe.bands, recipe.scatter_orders, recipe.all_orders_albedo);
    let basis = recipe.basis();
    let curves = set.table(name);
    let one = |compute: &(dyn Fn(f64) -> Vec<f64> + Sync), block: usize| worst(curves, distances, block, compute);
    let scaled = |values: Vec<f64>| values.into_iter().map(|v| albedo * v).collect::<Vec<_>>();
    match name {
        "point.single" => one(&|d| point::compute_single(d, &basis, bands).concat(), curves.columns),
        "directional.single" => one(&|d| directional::compute_single(d, &basis, bands).concat(), curves.columns),
        "point.orders" => {
            let sources: Vec<_> = (1..orders).map(Source::order).collect();
            one(&|d| sources.iter().flat_map(|s| point::compute_multiple(d, s, bands)).collect(), bands)
        }
        "directional.orders" => {
            let sources = slab_sources(orders);
            one(&|d| sources.iter().flat_map(|s| directional::compute_multiple(d, s, bands)).collect(), bands)
        }
        "point.all" => {
            let source = Source::all(albedo);
            one(&|d| scaled(point::compute_multiple(d, &source, bands)), bands)
        }
        "directional.all" => {
            let source = SlabSource::all(albedo);
            one(&|d| scaled(directional::compute_multiple(d, &source, bands)), bands)
        }
        "area.single" => measure_area(set, distances),
        "axial.orders" => {
            let sources: Vec<_> = (1..orders).map(Source::order).collect();
            let block = curves.columns / sources.len();
            one(&|d| axial::compute_multiple(d, &sources).concat(), block)
        }
        "axial.all" => {
            let source = [Source::all(albedo)];
            one(&|d| scaled(axial::compute_multiple(d, &source).concat()), curves.columns)
        }
        _ => unreachable!("a name of NAMES"),
    }
}

/// Largest difference over all columns, relative to the first column of each block.
fn worst(curves: &Curves, distances: &[f64], block: usize, compute: &(dyn Fn(f64) -> Vec<f64> + Sync)) -> f64 {
    let map = DistanceMap::new(&curves.grid, curves.shape);
    let at = |&d: &f64| {
        let d = f64::from(d as f32);
        let (got, want) = (curves.read(&map.place(d as f32)), compute(d));
        let blocks = got.chunks(block).zip(want.chunks(block));
        let errors =
            blocks.flat_map(|(got, want)| got.iter().zip(want).map(|(&g, w)| (f64::from(g) - w).abs() / want[0].abs()));
        errors.fold(0.0, f64::max)
    };
    distances.par_iter().map(at).collect::<Vec<_>>().into_iter().fold(0.0, f64::max)
}

/// Area order 1, isotropic and g = 0.5, at an angle that changes with the distance; full coefficients, not stripped ones.
fn measure_area(set: &TableSet, distances: &[f64]) -> f64 {
    let phases = [Phase::Isotropic, Phase::HenyeyGreenstein { g: 0.5 }];
    let responses = phases.clone().map(|phase| set.area(&Air { albedo: 1.0, phase }, Scatter::Single));
    let basis = PhaseBasis::Functions(phases.to_vec());
    // Tables about a fitted axis end at 90°.
    let end = if set.recipe().layout.criterion().is_some() { FRAC_PI_2 } else { PI };
    let at = |(i, &d): (usize, &f64)| {
        let theta = end * (0.25 + 0.754_877_666_246_692_7 * i as f64).fract();
        let want = area::compute_exact(d, theta, &basis, &HARMONICS, 64);
        let scale = (-d).exp() / d;
        let error = |response: &crate::AxialResponse, want: &[f64]| {
            let got = response.coefficients(1.0, d as f32, theta.cos() as f32);
            let full = got.iter().zip(&HARMONICS).map(|(&g, &(_, m))| f64::from(g) * theta.sin().powi(m as i32));
            full.zip(want).map(|(g, w)| (g / scale - w).abs() / want[0]).fold(0.0, f64::max)
        };
        responses.iter().zip(&want).map(|(response, want)| error(response, want)).fold(0.0, f64::max)
    };
    distances.par_iter().enumerate().map(at).collect::<Vec<_>>().into_iter().fold(0.0, f64::max)
}

/// One table's check.
#[derive(Debug, Clone, PartialEq)]
pub struct Verified {
    /// Name of the table.
    pub table: String,
    /// Error bound stored in the file.
    pub stored: f64,
    /// Error measured now.
    pub measured: f64,
    /// Whether the measured error keeps to the bound (times 1.5 for the change of places).
    pub holds: bool,
}

/// Recomputes a subset of `count` places chosen by `seed` in each table and compares with the bound in the file.
pub fn verify(file: &TableFile, count: usize, seed: u64) -> Result<Vec<Verified>, TableFileError> {
    let set = TableSet::from_file(file)?;
    let start = (seed as f64 * 0.569_840_290_998_053).fract();
    let distances = spread(set.recipe(), count.max(1), start);
    let check = |(name, entry): (&&str, &bake_formats::table_file::TableEntry)| {
        let (stored, measured) = (entry.look_up_error, measure_at(&set, name, &distances));
        Verified { table: (*name).to_owned(), stored, measured, holds: measured <= SLACK * stored }
    };
    Ok(NAMES.iter().zip(&file.manifest.tables).map(check).collect())
}
