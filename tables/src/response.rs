//! Look-up: a table prepared for one medium and colour channel, read by distance, f32.
//!
//! A response is canonical: the medium's albedo and phase function are in it, sigma_t comes with every look-up
//! (`remap`: a distance d m is read at σ_t d; point-like emitters scale by σ_t², directional light does not).

use crate::angles::coordinate;
use crate::axial::HARMONIC_COUNT;
use crate::curves::{Curves, DistanceMap, Grid, Place, Shape};
use crate::geometry::Geometry;
use crate::node::{Basis, Node};
use bake_optics::legendre::legendre_all;
use std::sync::Arc;
use wide::f32x4;

/// Degrees whose clamped-cosine coefficient does not vanish, up to 12 bands.
pub(crate) const IRRADIANCE_DEGREES: [usize; 7] = [0, 1, 2, 4, 6, 8, 10];

/// The same of 13 to 16 bands.
const FURTHER_DEGREES: [usize; 2] = [12, 14];

/// Response to an emitter that is symmetric about the line to the receiver: point light, directional light.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalResponse {
    map: DistanceMap,
    bands: usize,
    point_like: bool,
    radiance: Vec<f32>,
    /// `A_l sqrt((2l+1)/4π) L_l` for [`IRRADIANCE_DEGREES`]; the last place is 0.
    irradiance: Vec<[f32x4; 2]>,
    /// The same for [`FURTHER_DEGREES`]; empty up to 12 bands.
    further: Vec<[f32; 2]>,
}

impl ZonalResponse {
    /// From normalised coefficients, rows (limit, nodes, far limit) of `bands` values.
    pub(crate) fn new(grid: &Grid, shape: Shape, bands: usize, radiance: Vec<f32>) -> Self {
        let cosine = bake_optics::harmonics::clamped_cosine::<f64>(FURTHER_DEGREES[1] + 1);
        let fold = |row: &[f32], l: usize| {
            let norm = crate::transport::harmonics::real_norm(l, 0);
            row.get(l).map_or(0.0, |&c| (cosine[l] * norm * f64::from(c)) as f32)
        };
        let first = |row: &[f32]| -> [f32x4; 2] {
            let mut places = [0.0; 8];
            places.iter_mut().zip(IRRADIANCE_DEGREES).for_each(|(place, l)| *place = fold(row, l));
            bytemuck::cast(places)
        };
        let irradiance = radiance.chunks_exact(bands).map(first).collect();
        let rows = radiance.chunks_exact(bands).filter(|_| bands > FURTHER_DEGREES[0]);
        let further = rows.map(|row| FURTHER_DEGREES.map(|l| fold(row, l))).collect();
        let (map, point_like) = (DistanceMap::new(grid, shape), shape.inverse_distance);
        Self { map, bands, point_like, radiance, irradiance, further }
    }

    /// Irradiance (W/m²) on a surface at `distance_m` whose normal makes an angle of cosine `cos_receiver` with the direction to
    /// the emitter, per W/sr of intensity (per W/m² of directional light). `sigma_t` in 1/m, ≥ 0.
    #[inline]
    pub fn irradiance(&self, sigma_t: f32, distance_m: f32, cos_receiver: f32) -> f32 {
        let place = self.map.place(sigma_t * distance_m);
        let sums = self.partial_sums(place.row, place.fraction, &even_legendre(cos_receiver));
        let further = self.further(place.row, place.fraction, cos_receiver);
        self.strength(sigma_t, &place) * (sums.reduce_add() + further)
    }

    /// Four parts of the normalised irradiance.
    #[inline]
    pub(crate) fn partial_sums(&self, row: usize, fraction: f32, legendre: &[f32x4; 2]) -> f32x4 {
        let rows = &self.irradiance[row..row + 2];
        let part = |i: usize| legendre[i] * (rows[0][i] + (rows[1][i] - rows[0][i]) * fraction);
        part(0) + part(1)
    }

    /// What [`FURTHER_DEGREES`] add to the normalised irradiance; 0 up to 12 bands.
    #[inline]
    pub(crate) fn further(&self, row: usize, fraction: f32, cos_receiver: f32) -> f32 {
        let Some([low, high]) = self.further.get(row..row + 2) else { return 0.0 };
        let mut p = [0.0f32; FURTHER_DEGREES[1] + 1];
        legendre_all(cos_receiver, &mut p);
        (0..2).map(|i| p[FURTHER_DEGREES[i]] * (low[i] + fraction * (high[i] - low[i]))).sum()
    }

    /// Zonal coefficients of the incident radiance about the direction to the emitter, units as above; length `bands`.
    pub fn coefficients(&self, sigma_t: f32, distance_m: f32, out: &mut [f32]) {
        let place = self.map.place(sigma_t * distance_m);
        let scale = self.strength(sigma_t, &place);
        let start = place.row * self.bands;
        let (low, high) = self.radiance[start..start + 2 * self.bands].split_at(self.bands);
        for ((slot, a), b) in out.iter_mut().zip(low).zip(high) {
            *slot = (a + place.fraction * (b - a)) * scale;
        }
    }

    pub(crate) fn map(&self) -> DistanceMap {
        self.map
    }

    /// Whether the power of sigma_t is that of an emitter at a point.
    pub(crate) fn is_point_like(&self) -> bool {
        self.point_like
    }

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.bands
    }

    #[inline]
    fn strength(&self, sigma_t: f32, place: &Place) -> f32 {
        if self.point_like { sigma_t * sigma_t * place.scale } else { place.scale }
    }
}

/// P_l(c) for [`IRRADIANCE_DEGREES`]; 0 in the last place.
#[inline]
pub(crate) fn even_legendre(c: f32) -> [f32x4; 2] {
    let s = c * c;
    bytemuck::cast([
        1.0,
        c,
        1.5 * s - 0.5,
        (4.375 * s - 3.75) * s + 0.375,
        ((14.4375 * s - 19.6875) * s + 6.5625) * s - 0.3125,
        (((50.273_438 * s - 93.843_75) * s + 54.140_625) * s - 9.843_75) * s + 0.273_437_5,
        ((((180.425_78 * s - 427.324_2) * s + 351.914_06) * s - 117.304_69) * s + 13.535_156) * s - 0.246_093_75,
        0.0,
    ])
}

/// Response to an emitter with an axis: a small surface element, a spot or lamp.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialResponse {
    map: DistanceMap,
    angles: usize,
    /// Rows of `angles`.
    nodes: Arc<[Node]>,
    /// What all nodes are multiplied with.
    strength: f32,
}

/// A place among the angles.
#[derive(Clone, Copy)]
pub(crate) struct AnglePlace {
    node: usize,
    fraction: f32,
}

impl AxialResponse {
    /// From rows (limit, nodes, far limit) of equally many angles.
    pub(crate) fn new(grid: &Grid, shape: Shape, nodes: Vec<Node>) -> Self {
        let angles = nodes.len() / Curves::rows(grid);
        Self { map: DistanceMap::new(grid, shape), angles, nodes: nodes.into(), strength: 1.0 }
    }

    pub(crate) fn map(&self) -> DistanceMap {
        self.map
    }

    /// The same response at another strength, in the same memory.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { strength: self.strength * factor as f32, ..self.clone() }
    }

    /// Irradiance (W/m²) on the receiver of `geometry`, `distance_m` from the emitter, per W/sr of intensity on the emitter's
    /// axis (for an area: per L_o dA). `sigma_t` in 1/m, ≥ 0.
    #[inline]
    pub fn irradiance(&self, sigma_t: f32, distance_m: f32, geometry: &Geometry) -> f32 {
        let place = self.map.place(sigma_t * distance_m);
        let sums = self.partial_sums(place.row, place.fraction, self.angle_place(geometry.angle), &geometry.basis);
        self.unit() * sigma_t * sigma_t * place.scale * sums.reduce_add()
    }

    /// The stripped coefficients `L_lm/sin^m θ` of the incident radiance, in the order of [`crate::axial::HARMONICS`].
    pub fn coefficients(&self, sigma_t: f32, distance_m: f32, cos_emitter: f32) -> [f32; HARMONIC_COUNT] {
        let place = self.map.place(sigma_t * distance_m);
        let corners = self.corners(place.row, place.fraction, self.angle_place(coordinate(cos_emitter)));
        let scale = self.strength * sigma_t * sigma_t * place.scale;
        let values = corners.map(|(node, weight)| node.values().map(|v| scale * weight * v));
        std::array::from_fn(|h| values.iter().map(|v| v[h]).sum())
    }

    /// Number of angles.
    pub(crate) fn angles(&self) -> usize {
        self.angles
    }

    #[inline]
    pub(crate) fn angle_place(&self, angle: f32) -> AnglePlace {
        let x = (0.5 * angle + 0.5) * (self.angles - 1) as f32;
        let node = (x as usize).min(self.angles - 2);
        AnglePlace { node, fraction: x - node as f32 }
    }

    /// Four neighbours and their weights.
    #[inline]
    fn corners(&self, row: usize, u: f32, angle: AnglePlace) -> [(&Node, f32); 4] {
        let v = angle.fraction;
        let (v0, u0) = (1.0 - v, 1.0 - u);
        let first = row * self.angles + angle.node;
        let nodes = &self.nodes[first..first + self.angles + 2];
        let (low, high) = (nodes.first_chunk::<2>(), nodes.last_chunk::<2>());
        let (Some([a, b]), Some([c, d])) = (low, high) else { unreachable!("two angles at least") };
        [(a, u0 * v0), (b, u0 * v), (c, u * v0), (d, u * v)]
    }

    /// Four parts of the normalised irradiance, in units of [`Self::unit`].
    #[inline]
    pub(crate) fn partial_sums(&self, row: usize, fraction: f32, angle: AnglePlace, basis: &Basis) -> f32x4 {
        let [a, b, c, d] = self.corners(row, fraction, angle);
        (a.0.dot(basis, a.1) + b.0.dot(basis, b.1)) + (c.0.dot(basis, c.1) + d.0.dot(basis, d.1))
    }

    /// What partial sums are to be multiplied with.
    pub(crate) fn unit(&self) -> f32 {
        self.strength * Basis::UNIT
    }
}
