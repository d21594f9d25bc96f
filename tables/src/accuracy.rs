//! Error of look-up: every table read between its nodes, through storage, refinement and linear interpolation, against direct
//! evaluation of the integral. [`bounds`] are what a file states, [`verify`] tries them at other places.

use bake_formats::table_file::{TableFile, TableFileError};
use bake_optics::phase::Phase;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::area::{self, AllAngles};
use crate::axial::{self, HARMONIC_COUNT, HARMONICS};
use crate::curves::DistanceMap;
use crate::generate::{Progress, slab_sources};
use crate::recipe::Recipe;
use crate::remap::Air;
use crate::response::AxialResponse;
use crate::set::{NAMES, Scatter, TableSet};
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::slab::SlabSource;
use crate::transport::sources::Source;
use crate::{angles, directional, point};

/// What a bound lies above the largest error that was found, a share: for what lies between the places tried.
const MARGIN: f64 = 0.03;

/// Bound on the error of each table of [`NAMES`] between the ends of its grid, as a share of the l = 0 coefficient of the same order
/// (order 1: of the isotropic function; area: at the same angle, for |g| up to 0.6).
///
/// Every interval between the distances that are read is tried at both ends and in the middle. Within it, the error of linear reading is a
/// parabola up to third differences: its largest value counts.
pub fn bounds(set: &TableSet, progress: Progress) -> Vec<f64> {
    let bound = |(i, name): (usize, &&str)| {
        progress(i as f64 / NAMES.len() as f64, name);
        (1.0 + MARGIN) * largest(set.recipe(), &*errors(set, name))
    };
    NAMES.iter().enumerate().map(bound).collect()
}

/// Signed errors of all columns of a table at a distance.
type Errors<'a> = dyn Fn(f32) -> Vec<f64> + Sync + 'a;

/// Largest error over all intervals.
fn largest(recipe: &Recipe, errors: &Errors) -> f64 {
    let grid = recipe.read_grid();
    let at: Vec<_> =
        (0..2 * grid.bins - 1).into_par_iter().map(|i| errors(grid.distance(0.5 * i as f64) as f32)).collect();
    let peak_of = |places: &[Vec<f64>]| {
        let columns = places[0].iter().zip(&places[1]).zip(&places[2]);
        columns.map(|((a, b), c)| peak([*a, *b, *c])).fold(0.0, f64::max)
    };
    at.windows(3).step_by(2).map(peak_of).fold(0.0, f64::max)
}

/// Largest size over 0 … 1 of the parabola with these values at 0, ½ and 1.
fn peak([start, middle, end]: [f64; 3]) -> f64 {
    let (slope, bend) = (4.0 * middle - 3.0 * start - end, 2.0 * (start - 2.0 * middle + end));
    let summit = -0.5 * slope / bend;
    let inside = if summit > 0.0 && summit < 1.0 { start + 0.5 * slope * summit } else { middle };
    start.abs().max(end.abs()).max(inside.abs())
}

/// Largest error of one table at each of these distances; that of an area at an angle that changes with the distance. Panics on a name
/// that is none of [`NAMES`].
pub fn errors_at(set: &TableSet, name: &str, distances: &[f64]) -> Vec<f64> {
    if name == "area.single" {
        return area_errors_at(set, distances);
    }
    let errors = errors(set, name);
    distances.par_iter().map(|&d| size(errors(d as f32))).collect()
}

/// Largest size of signed errors.
fn size(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0f64, |most, error| most.max(error.abs()))
}

/// [`Errors`] of one of [`NAMES`].
fn errors<'a>(set: &'a TableSet, name: &str) -> Box<Errors<'a>> {
    let Recipe { bands, scatter_orders: orders, all_orders_albedo: albedo, .. } = *set.recipe();
    let (basis, curves) = (set.recipe().basis(), set.table(name));
    let map = DistanceMap::new(&curves.grid, curves.shape);
    let of = move |block: usize, factor: f64, compute: Box<dyn Fn(f64) -> Vec<f64> + Sync>| -> Box<Errors<'a>> {
        Box::new(move |d| {
            let (got, want) = (curves.read(&map.place(d)), compute(f64::from(d)));
            let blocks = got.chunks(block).zip(want.chunks(block));
            blocks
                .flat_map(|(got, want)| {
                    let first = factor * want[0].abs();
                    got.iter().zip(want).map(move |(&g, w)| (f64::from(g) - factor * w) / first)
                })
                .collect()
        })
    };
    match name {
        "point.single" => of(curves.columns, 1.0, Box::new(move |d| point::compute_single(d, &basis, bands).concat())),
        "directional.single" => {
            of(curves.columns, 1.0, Box::new(move |d| directional::compute_single(d, &basis, bands).concat()))
        }
        "point.orders" => {
            let sources: Vec<_> = (1..orders).map(Source::order).collect();
            let at = move |d| sources.iter().flat_map(|s| point::compute_multiple(d, s, bands)).collect();
            of(bands, 1.0, Box::new(at))
        }
        "directional.orders" => {
            let sources = slab_sources(orders);
            let at = move |d| sources.iter().flat_map(|s| directional::compute_multiple(d, s, bands)).collect();
            of(bands, 1.0, Box::new(at))
        }
        "point.all" => {
            let source = Source::all(albedo);
            of(bands, albedo, Box::new(move |d| point::compute_multiple(d, &source, bands)))
        }
        "directional.all" => {
            let source = SlabSource::all(albedo);
            of(bands, albedo, Box::new(move |d| directional::compute_multiple(d, &source, bands)))
        }
        "axial.orders" => {
            let sources: Vec<_> = (1..orders).map(Source::order).collect();
            of(curves.columns / sources.len(), 1.0, Box::new(move |d| axial::compute_multiple(d, &sources).concat()))
        }
        "axial.all" => {
            let source = [Source::all(albedo)];
            of(curves.columns, albedo, Box::new(move |d| axial::compute_multiple(d, &source).concat()))
        }
        "area.single" => area_errors(set),
        _ => unreachable!("a name of NAMES"),
    }
}

/// Light of an area scattered once: the phase functions for which it is measured.
const PHASES: [Phase<f64>; 3] =
    [Phase::Isotropic, Phase::HenyeyGreenstein { g: -0.6 }, Phase::HenyeyGreenstein { g: 0.6 }];

/// An area's responses to be tried, and the last angle at which: tables about a fitted axis end at 90°.
fn area_responses(set: &TableSet) -> ([AxialResponse; 3], f64) {
    let of = |phase: Phase<f64>| set.area(&Air { albedo: 1.0, phase }, Scatter::Single);
    (PHASES.map(of), if set.recipe().layout.criterion().is_some() { FRAC_PI_2 } else { PI })
}

/// Errors of l = 0 of full coefficients, not stripped ones, of one response.
fn area_error(response: &AxialResponse, d: f32, theta: f64, want: &[f64]) -> [f64; HARMONIC_COUNT] {
    let got = response.coefficients(1.0, d, theta.cos() as f32);
    let scale = f64::from(response.map().place(d).scale);
    std::array::from_fn(|h| {
        let full = f64::from(got[h]) / scale * theta.sin().powi(HARMONICS[h].1 as i32);
        (full - want[h]) / want[0]
    })
}

/// Angles θ at which an area is read and the middles between them, where a line errs most.
fn area_angles(set: &TableSet, end: f64) -> Vec<f64> {
    let cosines = angles::cosines(set.recipe().read_angles);
    cosines.iter().map(|cos| cos.acos()).filter(|theta| *theta <= end + 1e-9).collect()
}

/// At all these angles: `[phase function][angle][harmonic]`, flat.
fn area_errors(set: &TableSet) -> Box<Errors<'_>> {
    let (responses, end) = area_responses(set);
    let thetas = area_angles(set, end);
    let direct = AllAngles::new(&thetas);
    let basis = PhaseBasis::Functions(PHASES.to_vec());
    Box::new(move |d| {
        let want = direct.compute(f64::from(d), &basis);
        let places = responses.iter().flat_map(|response| thetas.iter().map(move |&theta| (response, theta)));
        let of = |((response, theta), want)| area_error(response, d, theta, want);
        places.zip(want.chunks_exact(HARMONIC_COUNT)).flat_map(of).collect()
    })
}

/// Largest error of light of an area scattered once at each of these distances and angles: the angles, and for each distance the error at
/// each of them.
pub fn area_map(set: &TableSet, distances: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let (thetas, errors) = (area_angles(set, area_responses(set).1), area_errors(set));
    let row = |&d: &f64| {
        let mut row = vec![0.0f64; thetas.len()];
        for of_phase in errors(d as f32).chunks_exact(thetas.len() * HARMONIC_COUNT) {
            let at_angles = of_phase.chunks_exact(HARMONIC_COUNT).map(|errors| size(errors.iter().copied()));
            row.iter_mut().zip(at_angles).for_each(|(most, error)| *most = most.max(error));
        }
        row
    };
    let rows = distances.par_iter().map(row).collect();
    (thetas, rows)
}

/// By the slower rule that has no error at the emitter's kink.
fn area_errors_at(set: &TableSet, distances: &[f64]) -> Vec<f64> {
    let (responses, end) = area_responses(set);
    let basis = PhaseBasis::Functions(PHASES.to_vec());
    let at = |(i, &d): (usize, &f64)| {
        let theta = end * (0.25 + 0.754_877_666_246_692_7 * i as f64).fract();
        let d = d as f32;
        let want = area::compute_exact(f64::from(d), theta, &basis, &HARMONICS, 64);
        size(responses.iter().zip(&want).flat_map(|(response, want)| area_error(response, d, theta, want)))
    };
    distances.par_iter().enumerate().map(at).collect()
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
    /// Whether the measured error keeps to the bound.
    pub holds: bool,
}

/// Recomputes a subset of `count` places chosen by `seed` in each table and compares with the bound in the file.
pub fn verify(file: &TableFile, count: usize, seed: u64) -> Result<Vec<Verified>, TableFileError> {
    let set = TableSet::from_file(file)?;
    let start = (seed as f64 * 0.569_840_290_998_053).fract();
    let distances = spread(set.recipe(), count.max(1), start);
    let check = |(name, entry): (&&str, &bake_formats::table_file::TableEntry)| {
        let (stored, measured) = (entry.look_up_error, size(errors_at(&set, name, &distances)));
        Verified { table: (*name).to_owned(), stored, measured, holds: measured <= stored }
    };
    Ok(NAMES.iter().zip(&file.manifest.tables).map(check).collect())
}

/// `count` distances by the golden ratio, uniform in ln d, up to where tables per order begin to fade.
fn spread(recipe: &Recipe, count: usize, start: f64) -> Vec<f64> {
    let (low, high) = (recipe.grid.min.ln(), (0.9 * recipe.grid.max).ln());
    (0..count).map(|i| (low + (high - low) * (start + 0.618_033_988_749_894_9 * i as f64).fract()).exp()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_of_a_parabola_is_found_inside_and_at_both_ends() {
        for (values, want) in [
            ([0.0, 1.0, 0.0], 1.0),
            ([0.0, 0.75, 1.0], 1.0),
            ([3.0, 1.0, 0.0], 3.0),
            ([0.0, 0.0, 0.0], 0.0),
            ([1.0, 1.0, 1.0], 1.0),
            // The summit lies at ¼, between the places.
            ([0.75, 0.75, -0.25], 0.875),
            ([-0.75, -0.75, 0.25], 0.875),
        ] {
            assert!((peak(values) - want).abs() < 1e-12, "{values:?}: {}", peak(values));
        }
    }
}
