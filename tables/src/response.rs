//! Look-up: a table prepared for one medium and colour channel, read by distance, f32.
//!
//! A response is canonical: the medium's albedo and phase function are in it, sigma_t comes with every look-up
//! (`remap`: a distance d m is read at σ_t d; point-like emitters scale by σ_t², directional light does not).

use crate::axial::HARMONIC_COUNT;
use crate::curves::{DistanceMap, Grid, Place, SMALLEST_DISTANCE, Shape};
use crate::geometry::Geometry;
use wide::f32x4;

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
        let (place, scale) = self.locate(sigma_t, distance_m);
        let (low, high) = (&self.irradiance[place.row], &self.irradiance[place.row + 1]);
        let p = even_legendre(cos_receiver);
        let mut sum = 0.0;
        for i in 0..8 {
            sum += p[i] * (low[i] + place.fraction * (high[i] - low[i]));
        }
        sum * scale
    }

    /// Zonal coefficients of the incident radiance about the direction to the emitter, units as above; length `bands`.
    pub fn coefficients(&self, sigma_t: f32, distance_m: f32, out: &mut [f32]) {
        let (place, scale) = self.locate(sigma_t, distance_m);
        let start = place.row * self.bands;
        let (low, high) = self.radiance[start..start + 2 * self.bands].split_at(self.bands);
        for ((slot, a), b) in out.iter_mut().zip(low).zip(high) {
            *slot = (a + place.fraction * (b - a)) * scale;
        }
    }

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.bands
    }

    #[inline]
    fn locate(&self, sigma_t: f32, distance_m: f32) -> (Place, f32) {
        let place = self.map.place(sigma_t * distance_m);
        let scale = if self.point_like { sigma_t * sigma_t * place.scale } else { place.scale };
        (place, scale)
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
    nodes: usize,
    /// `L_lm / sin^m θ`, rows of `nodes` × 11 (and one 0).
    values: Vec<[f32; 12]>,
}

/// A place in an [`AxialResponse`]: four neighbours and their weights.
#[derive(Debug, Clone, Copy)]
struct Corner {
    first: usize,
    weights: [f32; 4],
}

impl AxialResponse {
    pub(crate) fn new(grid: &Grid, shape: Shape, nodes: usize, values: Vec<[f32; 12]>) -> Self {
        Self { map: DistanceMap::new(grid, shape), nodes, values }
    }

    /// Irradiance (W/m²) on the receiver of `geometry`, `distance_m` from the emitter, per W/sr of intensity on the emitter's
    /// axis (for an area: per L_o dA). `sigma_t` in 1/m, ≥ 0.
    #[inline]
    pub fn irradiance(&self, sigma_t: f32, distance_m: f32, geometry: &Geometry) -> f32 {
        let place = self.map.place(sigma_t * distance_m);
        sigma_t * sigma_t * place.scale * self.contract(self.corner(&place, geometry.angle), geometry)
    }

    /// The stripped coefficients `L_lm/sin^m θ` of the incident radiance, in the order of [`crate::axial::HARMONICS`].
    pub fn coefficients(&self, sigma_t: f32, distance_m: f32, cos_emitter: f32) -> [f32; HARMONIC_COUNT] {
        let place = self.map.place(sigma_t * distance_m);
        let corner = self.corner(&place, crate::geometry::angle_coordinate(cos_emitter));
        let rows = self.rows(&corner);
        let scale = sigma_t * sigma_t * place.scale;
        std::array::from_fn(|h| scale * (0..4).map(|i| corner.weights[i] * rows[i][h]).sum::<f32>())
    }

    #[inline]
    fn corner(&self, place: &Place, angle: f32) -> Corner {
        let x = (0.5 * angle + 0.5) * (self.nodes - 1) as f32;
        let node = (x.max(0.0) as usize).min(self.nodes - 2);
        let (v, u) = (x - node as f32, place.fraction);
        let (v0, u0) = (1.0 - v, 1.0 - u);
        Corner { first: place.row * self.nodes + node, weights: [u0 * v0, u0 * v, u * v0, u * v] }
    }

    #[inline]
    fn rows(&self, corner: &Corner) -> [&[f32; 12]; 4] {
        let (low, high) = (corner.first, corner.first + self.nodes);
        [&self.values[low], &self.values[low + 1], &self.values[high], &self.values[high + 1]]
    }

    #[inline]
    fn contract(&self, corner: Corner, geometry: &Geometry) -> f32 {
        let rows = self.rows(&corner);
        let mut sums = [0.0f32; 4];
        for (i, basis) in geometry.basis.chunks_exact(4).enumerate() {
            for lane in 0..4 {
                let at = 4 * i + lane;
                let [a, b, c, d] = corner.weights;
                sums[lane] += basis[lane] * (a * rows[0][at] + b * rows[1][at] + c * rows[2][at] + d * rows[3][at]);
            }
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }
}

/// Responses of the three colour channels of one medium.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialRgb(pub [AxialResponse; 3]);

impl AxialRgb {
    /// As [`AxialResponse::irradiance`] for three channels at once.
    ///
    /// *Accuracy*: 1e-5 of the single form for optical distances up to 40. *Cost*: see `docs/tables.md`.
    #[inline]
    pub fn irradiance(&self, sigma_t: [f32; 3], distance_m: f32, geometry: &Geometry) -> [f32; 3] {
        let sigma = f32x4::from([sigma_t[0], sigma_t[1], sigma_t[2], 1.0]);
        let d = (sigma * f32x4::splat(distance_m)).max(f32x4::splat(SMALLEST_DISTANCE));
        let (optical, ln) = (d.to_array(), d.ln().to_array());
        std::array::from_fn(|i| {
            let response = &self.0[i];
            let place = response.map.place_by_ln(optical[i], ln[i]);
            sigma_t[i] * sigma_t[i] * place.scale * response.contract(response.corner(&place, geometry.angle), geometry)
        })
    }
}
