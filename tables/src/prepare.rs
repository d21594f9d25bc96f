//! Tables of a set prepared for a medium: weighted by albedo and phase function, an emitter's distribution folded in.

use bake_optics::harmonics::clamped_cosine;
use bake_optics::phase::Phase;

use crate::axial::{ALL_DEGREES, HARMONIC_COUNT, HARMONICS};
use crate::curves::{Curves, Grid, Shape};
use crate::fitted::FittedResponse;
use crate::node::Node;
use crate::recipe::Recipe;
use crate::remap::Air;
use crate::response::{AxialResponse, ZonalResponse};
use crate::rgb::AxialRgb;
use crate::set::{Scatter, TableSet};
use crate::transport::harmonics::stripped_legendre;
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::slab::SlabSource;
use crate::transport::sources::{EMITTER_DEGREES, Source};
use crate::{angles, area, axial, directional, fitted, point, resample};

/// Moments beyond the tables above this, |g|^20 at g = 0.62, ask for a table of the actual phase function: at 0.8 the series
/// would be wrong by 1.6 % for a point light and by 40 % for a surface that faces away, of the l = 0 coefficient.
const LEFT_OUT_MOMENT: f64 = 7.1e-5;

/// Angles at which a table of an actual phase function is computed: the kink at 90° is sharper there than in the stored tables.
const OWN_ANGLES: usize = 129;

/// A phase function whose moment after those of the tables is above this, |g|^20 at g = 0.75, is computed and read at thrice as many
/// angles: at 0.93 the kink then costs 0.2 % of l = 0 within a degree of 90°; at 0.8 with no more than others have, 0.3 %.
const STRONG_MOMENT: f64 = 3.2e-3;

/// So many intervals in place of each between nodes.
fn thrice(nodes: usize) -> usize {
    3 * (nodes - 1) + 1
}

/// Below this albedo a sum over all orders is that of this albedo.
const SMALLEST_ALBEDO: f64 = 1e-3;

impl TableSet {
    /// Response of a medium to a point light.
    pub fn point(&self, air: &Air, scatter: Scatter) -> ZonalResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        match scatter {
            Scatter::Single => match self.own_basis(&air.phase) {
                Some(basis) => {
                    self.zonal(&refined(&point::store_single(self.own_grid(), &basis, self.recipe().bands)), &[albedo])
                }
                None => self.zonal(self.table("point.single"), &self.recipe().weights(air)),
            },
            Scatter::Multiple(up_to) => self.zonal(self.table("point.orders"), &self.order_weights(albedo, up_to)),
            Scatter::AllMultiple if self.stored_all(albedo) => self.zonal(self.table("point.all"), &[1.0]),
            Scatter::AllMultiple => {
                let source = Source::all(albedo.max(SMALLEST_ALBEDO));
                let shape = Shape::POINT_MULTIPLE.all_orders(source.rate);
                self.zonal(&point::store_multiple(self.grid(), shape, &source, albedo, self.recipe().bands), &[1.0])
            }
        }
    }

    /// Response of a medium to directional light that enters it perpendicularly to its boundary.
    pub fn directional(&self, air: &Air, scatter: Scatter) -> ZonalResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        match scatter {
            Scatter::Single => match self.own_basis(&air.phase) {
                Some(basis) => self.zonal(
                    &refined(&directional::store_single(self.own_grid(), &basis, self.recipe().bands)),
                    &[albedo],
                ),
                None => self.zonal(self.table("directional.single"), &self.recipe().weights(air)),
            },
            Scatter::Multiple(up_to) => {
                self.zonal(self.table("directional.orders"), &self.order_weights(albedo, up_to))
            }
            Scatter::AllMultiple if self.stored_all(albedo) => self.zonal(self.table("directional.all"), &[1.0]),
            Scatter::AllMultiple => {
                let source = SlabSource::all(albedo.max(SMALLEST_ALBEDO));
                let shape = Shape::DIRECTIONAL.all_orders(source.rate);
                self.zonal(
                    &directional::store_multiple(self.grid(), shape, &source, albedo, self.recipe().bands),
                    &[1.0],
                )
            }
        }
    }

    /// Response of a medium to a small Lambertian surface element.
    pub fn area(&self, air: &Air, scatter: Scatter) -> AxialResponse {
        match scatter {
            Scatter::Single => self.area_single(&air.phase, self.single_angles(&air.phase)).scaled(air.albedo),
            // Without a kink and with few degrees these lose 0.15 %.
            _ => {
                let [distances, angles] = self.fewer_nodes();
                self.axial_at(distances, &Angles::new(angles, &cosine_legendre(), halved), air, scatter)
            }
        }
    }

    /// Distances and angles at which three channels of light scattered more often stay in a core's cache.
    fn fewer_nodes(&self) -> [usize; 2] {
        let Recipe { read_bins, read_angles, .. } = *self.recipe();
        [read_bins / 2 + 1, (read_angles - 1) * 3 / 8 + 1]
    }

    /// Angles at which light scattered once is read.
    fn single_angles(&self, phase: &Phase<f64>) -> usize {
        let angles = self.recipe().read_angles;
        if self.is_strong(phase) { thrice(angles) } else { angles }
    }

    /// The same for the channels of one medium, which share a table where that is the same.
    pub fn area_rgb(&self, airs: &[Air; 3], scatter: Scatter) -> AxialRgb {
        let [first, others @ ..] = airs;
        if scatter != Scatter::Single {
            return AxialRgb::new(airs.each_ref().map(|air| self.area(air, scatter)));
        }
        // Equally many angles, because the channels share their place among them.
        let angles = airs.iter().map(|air| self.single_angles(&air.phase)).max().unwrap_or(0);
        if others.iter().all(|air| air.phase == first.phase) {
            let shared = self.area_single(&first.phase, angles);
            return AxialRgb::new(airs.each_ref().map(|air| shared.scaled(air.albedo)));
        }
        AxialRgb::new(airs.each_ref().map(|air| self.area_single(&air.phase, angles).scaled(air.albedo)))
    }

    /// Response of a medium to a small Lambertian surface element, light scattered once, about a fitted axis; `None` unless the
    /// layout is one of those.
    pub fn fitted_area(&self, air: &Air) -> Option<FittedResponse> {
        self.recipe().layout.criterion()?;
        let (curves, weights) = (self.table("area.single"), self.recipe().weights(air));
        let rows = weighted_rows(curves, &weights, fitted::ANGLES * fitted::COLUMNS);
        // The tilt takes the weights of the phase function only.
        let rows = rows.map(|mut row| {
            row.chunks_exact_mut(fitted::COLUMNS).for_each(|node| node[fitted::BANDS] /= air.albedo.max(1e-30));
            row
        });
        Some(FittedResponse::new(&curves.grid, curves.shape, rows))
    }

    /// Response of a medium to an emitter whose intensity is `Σ c_l P_l(cos)` about its axis, l ≤ 16, light scattered twice or more.
    /// (Once-scattered light of such an emitter needs its real distribution and visibility: the estimator of the bake.)
    /// `Scatter::Single` gives an empty response.
    ///
    /// *Accuracy*, of l = 0 at the same place: see "Spots" in `docs/tables.md`.
    pub fn axial(&self, legendre: &[f64], air: &Air, scatter: Scatter) -> AxialResponse {
        let Recipe { read_bins, read_angles, .. } = *self.recipe();
        self.axial_at(read_bins, &Angles::new(read_angles, legendre, filter), air, scatter)
    }

    /// The same read at so many distances.
    fn axial_at(&self, distances: usize, angles: &Angles, air: &Air, scatter: Scatter) -> AxialResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        let of = |curves: &Curves, weights: &[f64]| axial_of(curves, distances, weights, angles);
        match scatter {
            Scatter::Single => of(self.table("axial.orders"), &[]),
            Scatter::Multiple(up_to) => of(self.table("axial.orders"), &self.order_weights(albedo, up_to)),
            Scatter::AllMultiple if self.stored_all(albedo) => of(self.table("axial.all"), &[1.0]),
            Scatter::AllMultiple => {
                let source = Source::all(albedo.max(SMALLEST_ALBEDO));
                let shape = Shape::POINT_MULTIPLE.all_orders(source.rate);
                of(&axial::store_multiple(self.grid(), shape, &[source], albedo), &[1.0])
            }
        }
    }

    fn grid(&self) -> Grid {
        self.recipe().read_grid()
    }

    /// The grid at which a table of an actual phase function is computed: a decade more below, because a sharp peak of width 1 − |g|
    /// leaves the form `n_0 + b d ln d` already where d is a hundredth of it.
    fn own_grid(&self) -> Grid {
        let grid = self.recipe().grid;
        let more = (10f64.ln() / grid.step()).ceil();
        Grid { min: grid.distance(-more), bins: grid.bins + more as usize, ..grid }
    }

    fn stored_all(&self, albedo: f64) -> bool {
        (albedo - self.recipe().all_orders_albedo).abs() < 1e-6
    }

    /// α² … α^up_to.
    fn order_weights(&self, albedo: f64, up_to: usize) -> Vec<f64> {
        (2..=up_to.min(self.recipe().scatter_orders)).map(|k| albedo.powi(k as i32)).collect()
    }

    /// The actual phase function where its Legendre orders in the tables do not suffice.
    fn own_basis(&self, phase: &Phase<f64>) -> Option<PhaseBasis> {
        let own = self.recipe().layout.criterion().is_none() && self.has_left_out(phase, LEFT_OUT_MOMENT);
        own.then(|| PhaseBasis::Functions(vec![phase.clone()]))
    }

    /// Whether its kink at 90° asks for more angles.
    fn is_strong(&self, phase: &Phase<f64>) -> bool {
        self.recipe().layout.criterion().is_none() && self.has_left_out(phase, STRONG_MOMENT)
    }

    /// Whether a moment beyond those of the tables is above a limit.
    fn has_left_out(&self, phase: &Phase<f64>, limit: f64) -> bool {
        let first = self.recipe().legendre_orders;
        (first..first + 24).any(|l| phase.moment(l).abs() > limit)
    }

    /// `Σ_i weight_i × block i` of every row; blocks of `bands` columns.
    fn zonal(&self, curves: &Curves, weights: &[f64]) -> ZonalResponse {
        let bands = self.recipe().bands;
        let rows = weighted_rows(curves, weights, bands).map(|row| row.iter().map(|&v| v as f32).collect::<Vec<_>>());
        ZonalResponse::new(&curves.grid, curves.shape, bands, rows.flatten().collect())
    }

    /// Light of an area scattered once, albedo 1, read at so many angles.
    fn area_single(&self, phase: &Phase<f64>, angles: usize) -> AxialResponse {
        let air = Air { albedo: 1.0, phase: phase.clone() };
        if self.recipe().layout.criterion().is_some() {
            return self.area_from_fitted(&air);
        }
        match self.own_basis(phase) {
            Some(basis) => {
                let nodes = if self.is_strong(phase) { thrice(OWN_ANGLES) } else { OWN_ANGLES };
                let own = area::AngleGrid { nodes, ..self.recipe().angles };
                area_of(&refined(&area::store_single(self.own_grid(), own, &basis)), own, &[1.0], angles)
            }
            None => area_of(self.table("area.single"), self.recipe().angles, &self.recipe().weights(&air), angles),
        }
    }

    /// The fitted functions as mirror-symmetric harmonics, so that a bake can be made with either layout. Albedo 1.
    fn area_from_fitted(&self, air: &Air) -> AxialResponse {
        let (curves, weights) = (self.table("area.single"), self.recipe().weights(air));
        let cosines = angles::cosines(self.recipe().read_angles);
        let rows = weighted_rows(curves, &weights, fitted::ANGLES * fitted::COLUMNS).flat_map(|row| {
            let at_node = |&cos: &f64| match cos {
                cos if cos < -1e-9 => Node::new(&[0.0; HARMONIC_COUNT]),
                cos => Node::new(&fitted::stripped(&row, cos.acos())),
            };
            cosines.iter().step_by(2).map(at_node).collect::<Vec<_>>()
        });
        AxialResponse::new(&curves.grid, curves.shape, rows.collect())
    }
}

/// What an emitter's degrees weigh in each harmonic: `c_l' P̄_l'^m(cos θ)/sin^m θ`, m < 5, at the places of [`angles::cosines`].
struct Angles(Vec<[[f64; EMITTER_DEGREES]; 5]>);

impl Angles {
    /// `weaken` tells what a degree weighs at a cosine.
    fn new(count: usize, legendre: &[f64], weaken: fn(usize, f64) -> f64) -> Self {
        let at = |cos: f64| std::array::from_fn(|m| emitter_lanes(m, cos, legendre, weaken));
        Self(angles::cosines(count).into_iter().map(at).collect())
    }
}

/// An area's table of light scattered once, stored at the angles `stored`, read at so many `angles`.
fn area_of(curves: &Curves, stored: area::AngleGrid, weights: &[f64], angles: usize) -> AxialResponse {
    let cosines = angles::cosines(angles);
    let rows = weighted_rows(curves, weights, stored.nodes * HARMONIC_COUNT).flat_map(|row| {
        let nodes: Vec<[f64; HARMONIC_COUNT]> =
            row.chunks_exact(HARMONIC_COUNT).map(|c| std::array::from_fn(|h| c[h])).collect();
        angles::balanced(&resample::angles(&nodes, cosines.iter().map(|&c| stored.index(c))))
    });
    AxialResponse::new(&curves.grid, curves.shape, rows.map(|v| Node::new(&v)).collect())
}

fn axial_of(curves: &Curves, distances: usize, weights: &[f64], angles: &Angles) -> AxialResponse {
    let list = axial::curves(&ALL_DEGREES);
    let curves = &resample::distances(curves, Grid { bins: distances, ..curves.grid });
    let rows = weighted_rows(curves, weights, list.len()).flat_map(|row| {
        let at = |lanes: &[[f64; EMITTER_DEGREES]; 5]| {
            let mut sum = [0.0; HARMONIC_COUNT];
            list.iter().zip(&row).for_each(|(&(h, degree), g)| sum[h] += lanes[HARMONICS[h].1][degree] * g);
            sum
        };
        angles::balanced(&angles.0.iter().map(at).collect::<Vec<_>>())
    });
    AxialResponse::new(&curves.grid, curves.shape, rows.map(|v| Node::new(&v)).collect())
}

/// A table of an actual phase function on the grid that is read: closer nodes than for stored ones, because behind an emitter its light
/// falls off faster.
fn refined(computed: &Curves) -> Curves {
    resample::distances(computed, Grid { bins: thrice(computed.grid.bins), ..computed.grid })
}

/// Legendre coefficients of the clamped cosine, `A_l (2l+1)/(4π)`: ¼, ½, 5/16, 0, −3/32 …
pub fn cosine_legendre() -> Vec<f64> {
    let a = clamped_cosine::<f64>(EMITTER_DEGREES);
    a.iter().enumerate().map(|(l, a)| a * (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI)).collect()
}

/// `c_l' P̄_l'^m(c)/sin^m θ` for all degrees, each weakened.
fn emitter_lanes(m: usize, cos: f64, legendre: &[f64], weaken: fn(usize, f64) -> f64) -> [f64; EMITTER_DEGREES] {
    let mut lanes = [0.0; EMITTER_DEGREES];
    stripped_legendre(m, cos, &mut lanes);
    lanes
        .iter_mut()
        .enumerate()
        .for_each(|(l, lane)| *lane *= weaken(l, cos) * legendre.get(l).copied().unwrap_or(0.0));
    lanes
}

/// What a degree is weakened by behind an emitter, where the end of a narrow spot's series would shine: a ripple adds up on the
/// axis to light that comes straight to the receiver, and 18 mean free paths away outweighs what has had to turn round.
///
/// *Equation*: `exp(−8 s (l/17)⁶)`, s = −c/0.34 within 0 … 1, an exponential filter (Gottlieb & Shu 1997, 5). *Accuracy*: order 2 of a spot of
/// 20° at 18 mean free paths, beyond 110°: 0.4 % of l = 0, without it 43 % (`tests/spots.rs`).
fn filter(degree: usize, cos: f64) -> f64 {
    (-8.0 * behind(cos) * (degree as f64 / EMITTER_DEGREES as f64).powi(6)).exp()
}

/// The same for a surface, whose series falls off and behind it changes sign with every term: half of the last one stands for all that
/// follow. *Accuracy*: order 2 behind it at 40 mean free paths 0.5 % of l = 0, without 1.9 %, by [`filter`] 0.8 %; up to 8 below 0.2 %
/// (`tests/spots.rs`).
fn halved(degree: usize, cos: f64) -> f64 {
    if degree + 1 == EMITTER_DEGREES { 1.0 - 0.5 * behind(cos) } else { 1.0 }
}

/// From 0 at 90° to 1 at 110° from an emitter's axis and beyond.
fn behind(cos: f64) -> f64 {
    (-cos / 0.34).clamp(0.0, 1.0)
}

/// Per row the weighted sum of its blocks of `width` columns.
fn weighted_rows<'a>(curves: &'a Curves, weights: &'a [f64], width: usize) -> impl Iterator<Item = Vec<f64>> + 'a {
    (0..Curves::rows(&curves.grid)).map(move |row| {
        let mut sum = vec![0.0; width];
        for (block, w) in curves.row(row).chunks_exact(width).zip(weights) {
            sum.iter_mut().zip(block).for_each(|(s, &v)| *s += w * f64::from(v));
        }
        sum
    })
}
