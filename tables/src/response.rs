//! Look-up: a table prepared for one medium and colour channel, read by distance, f32.
//!
//! A response is canonical: the medium's albedo and phase function are in it, sigma_t comes with every look-up
//! (`remap`: a distance d m is read at σ_t d; point-like emitters scale by σ_t², directional light does not).

use crate::area::coordinate;
use crate::axial::HARMONIC_COUNT;
use crate::curves::{DistanceMap, Grid, Place, Shape};
use crate::geometry::Geometry;
use crate::node::{Basis, Node};
use std::sync::Arc;
use wide::f32x8;

/// Degrees whose clamped-cosine coefficient does not vanish, up to 11 bands (and one empty place).
pub(crate) const IRRADIANCE_DEGREES: [usize; 8] = [0, 1, 2, 4, 6, 8, 10, 12];

/// Response to an emitter that is symmetric about the line to the receiver: point light, directional light.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalResponse {
    map: DistanceMap,
    bands: usize,
    point_like: bool,
    radiance: Vec<f32>,
    /// `A_l sqrt((2l+1)/4π) L_l` for [`IRRADIANCE_DEGREES`].
    irradiance: Vec<[f32; 8]>,
}

impl ZonalResponse {
    /// From normalised coefficients, rows (limit, nodes, far limit) of `bands` values.
    pub(crate) fn new(grid: &Grid, shape: Shape, bands: usize, radiance: Vec<f32>) -> Self {
        let cosine = bake_optics::harmonics::clamped_cosine::<f64>(IRRADIANCE_DEGREES[7] + 1);
        let fold = |row: &[f32]| {
            IRRADIANCE_DEGREES.map(|l| {
                let norm = crate::transport::harmonics::real_norm(l, 0);
                row.get(l).map_or(0.0, |&c| (cosine[l] * norm * f64::from(c)) as f32)
            })
        };
        let irradiance = radiance.chunks_exact(bands).map(fold).collect();
        Self { map: DistanceMap::new(grid, shape), bands, point_like: shape.inverse_distance, radiance, irradiance }
    }

    /// Irradiance (W/m²) on a surface at `distance_m` whose normal makes an angle of cosine `cos_receiver` with the direction to
    /// the emitter, per W/sr of intensity (per W/m² of directional light). `sigma_t` in 1/m, ≥ 0.
    #[inline]
    pub fn irradiance(&self, sigma_t: f32, distance_m: f32, cos_receiver: f32) -> f32 {
        self.irradiance_at(sigma_t, &self.map.place(sigma_t * distance_m), &even_legendre(cos_receiver))
    }

    #[inline]
    pub(crate) fn irradiance_at(&self, sigma_t: f32, place: &Place, legendre: &[f32; 8]) -> f32 {
        let rows = &self.irradiance[place.row..place.row + 2];
        let (low, high, p) = (f32x8::from(rows[0]), f32x8::from(rows[1]), f32x8::from(*legendre));
        let sum = (p * (low + f32x8::splat(place.fraction) * (high - low))).reduce_add();
        self.strength(sigma_t, place) * sum
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

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.bands
    }

    #[inline]
    fn strength(&self, sigma_t: f32, place: &Place) -> f32 {
        if self.point_like { sigma_t * sigma_t * place.scale } else { place.scale }
    }
}

/// P_l(c) for [`IRRADIANCE_DEGREES`]; 0 in the empty place.
#[inline]
pub(crate) fn even_legendre(c: f32) -> [f32; 8] {
    let s = c * c;
    [
        1.0,
        c,
        1.5 * s - 0.5,
        (4.375 * s - 3.75) * s + 0.375,
        ((14.4375 * s - 19.6875) * s + 6.5625) * s - 0.3125,
        (((50.273_438 * s - 93.843_75) * s + 54.140_625) * s - 9.843_75) * s + 0.273_437_5,
        ((((180.425_78 * s - 427.324_2) * s + 351.914_06) * s - 117.304_69) * s + 13.535_156) * s - 0.246_093_75,
        0.0,
    ]
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
    pub(crate) fn new(grid: &Grid, shape: Shape, angles: usize, nodes: Vec<Node>) -> Self {
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
        self.irradiance_at(sigma_t, &place, self.angle_place(geometry.angle), &geometry.basis)
    }

    /// The stripped coefficients `L_lm/sin^m θ` of the incident radiance, in the order of [`crate::axial::HARMONICS`].
    pub fn coefficients(&self, sigma_t: f32, distance_m: f32, cos_emitter: f32) -> [f32; HARMONIC_COUNT] {
        let place = self.map.place(sigma_t * distance_m);
        let corners = self.corners(&place, self.angle_place(coordinate(cos_emitter)));
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
    fn corners(&self, place: &Place, angle: AnglePlace) -> [(&Node, f32); 4] {
        let (v, u) = (angle.fraction, place.fraction);
        let (v0, u0) = (1.0 - v, 1.0 - u);
        let first = place.row * self.angles + angle.node;
        let nodes = &self.nodes[first..first + self.angles + 2];
        let (low, high) = (nodes.first_chunk::<2>(), nodes.last_chunk::<2>());
        let (Some([a, b]), Some([c, d])) = (low, high) else { unreachable!("two angles at least") };
        [(a, u0 * v0), (b, u0 * v), (c, u * v0), (d, u * v)]
    }

    #[inline]
    pub(crate) fn irradiance_at(&self, sigma_t: f32, place: &Place, angle: AnglePlace, basis: &Basis) -> f32 {
        let [a, b, c, d] = self.corners(place, angle).map(|(node, weight)| node.dot(basis, weight));
        self.strength * Basis::UNIT * sigma_t * sigma_t * place.scale * ((a + b) + (c + d)).reduce_add()
    }
}
