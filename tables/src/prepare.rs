//! Tables of a set prepared for a medium: weighted by albedo and phase function, an emitter's distribution folded in.

use bake_optics::phase::Phase;
use std::slice;

use crate::axial::{ALL_DEGREES, HARMONIC_COUNT};
use crate::curves::{Curves, Grid, Shape};
use crate::fitted::FittedResponse;
use crate::node::Node;
use crate::recipe::Recipe;
use crate::remap::Air;
use crate::response::{AxialResponse, ZonalResponse};
use crate::rgb::AxialRgb;
use crate::series::{Series, cosine_legendre};
use crate::set::{Scatter, TableSet};
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::slab::SlabSource;
use crate::transport::sources::Source;
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
            Scatter::Multiple(_) | Scatter::Order(_) => {
                self.zonal(self.table("point.orders"), &self.order_weights(albedo, scatter))
            }
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
            Scatter::Multiple(_) | Scatter::Order(_) => {
                self.zonal(self.table("directional.orders"), &self.order_weights(albedo, scatter))
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
            _ => {
                let [distances, angles] = self.multiple_nodes(scatter);
                self.axial_at(distances, &Series::new(angles, &cosine_legendre(), false), air, scatter)
            }
        }
    }

    /// Distances and angles at which an area's light scattered more often is read: fewer for the sums of a bake, so that three
    /// channels of them stay in a core's cache. Their kink is soft: they lose 0.15 %, single orders alone more.
    fn multiple_nodes(&self, scatter: Scatter) -> [usize; 2] {
        let Recipe { read_bins, read_angles, .. } = *self.recipe();
        match scatter {
            Scatter::Order(_) => [read_bins, read_angles],
            _ => [read_bins / 2 + 1, (read_angles - 1) * 3 / 8 + 1],
        }
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

    /// Response of a medium to an emitter whose intensity is `Σ c_l P_l(cos)` about its axis, l < [`SERIES_DEGREES`](crate::SERIES_DEGREES),
    /// light scattered twice or more.
    /// (Once-scattered light of such an emitter needs its real distribution and visibility: the estimator of the bake.)
    /// `Scatter::Single` gives an empty response.
    ///
    /// *Accuracy*, of l = 0 at the same place: see "Spots" in `docs/tables.md`.
    pub fn axial(&self, legendre: &[f64], air: &Air, scatter: Scatter) -> AxialResponse {
        let Recipe { read_bins, read_angles, .. } = *self.recipe();
        self.axial_at(read_bins, &Series::new(read_angles, legendre, true), air, scatter)
    }

    /// The same read at so many distances.
    fn axial_at(&self, distances: usize, series: &Series, air: &Air, scatter: Scatter) -> AxialResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        let of = |curves: &Curves, weights: &[f64]| axial_of(curves, distances, weights, series);
        match scatter {
            Scatter::Single => of(self.table("axial.orders"), &[]),
            Scatter::Multiple(_) | Scatter::Order(_) => {
                of(self.table("axial.orders"), &self.order_weights(albedo, scatter))
            }
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

    /// α² … α^up_to, or one of them among zeros.
    fn order_weights(&self, albedo: f64, scatter: Scatter) -> Vec<f64> {
        let (from, to) = match scatter {
            Scatter::Multiple(up_to) => (2, up_to),
            Scatter::Order(order) => (order, order),
            Scatter::Single | Scatter::AllMultiple => (1, 0),
        };
        let weight = |k: usize| if (from..=to).contains(&k) { albedo.powi(k as i32) } else { 0.0 };
        (2..=to.min(self.recipe().scatter_orders)).map(weight).collect()
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

fn axial_of(curves: &Curves, distances: usize, weights: &[f64], series: &Series) -> AxialResponse {
    let grid = Grid { bins: distances, ..curves.grid };
    let curves = resample::distances(curves, Grid { bins: 2 * distances - 1, ..grid });
    let rows: Vec<_> = weighted_rows(&curves, weights, axial::curves(&ALL_DEGREES).len()).collect();
    let [near, nodes @ .., far] = rows.as_slice() else { unreachable!("two limits at least") };
    let rows = [slice::from_ref(near), &angles::balanced(nodes), slice::from_ref(far)].concat();
    let nodes = rows.iter().flat_map(|row| angles::balanced(&series.sum(row))).map(|v| Node::new(&v));
    AxialResponse::new(&grid, curves.shape, nodes.collect())
}

/// A table of an actual phase function on the grid that is read: closer nodes than for stored ones, because behind an emitter its light
/// falls off faster.
fn refined(computed: &Curves) -> Curves {
    resample::distances(computed, Grid { bins: thrice(computed.grid.bins), ..computed.grid })
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
