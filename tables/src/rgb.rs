//! The three colour channels of one medium looked up together: geometry, distance and memory are shared as far as they are equal.

use crate::geometry::Geometry;
use crate::lanes::{DistanceLanes, Places, lanes};
use crate::response::{AxialResponse, ZonalResponse, even_legendre};
use wide::f32x4;

/// Area, spot or lamp.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialRgb {
    channels: [AxialResponse; 3],
    distances: DistanceLanes,
    /// Of the channels, with the unit of the basis.
    strength: f32x4,
}

impl AxialRgb {
    /// Of three channels from one set of tables; `TableSet::area_rgb` lets them share memory where it can.
    pub fn new(channels: [AxialResponse; 3]) -> Self {
        let angles = channels.each_ref().map(AxialResponse::angles);
        assert!(angles == [angles[0]; 3], "responses of one set have the same angles, not {angles:?}");
        let distances = DistanceLanes::new(channels.each_ref().map(AxialResponse::map));
        let strength = lanes(channels.each_ref().map(AxialResponse::unit));
        Self { channels, distances, strength }
    }

    /// The channels.
    pub fn channels(&self) -> &[AxialResponse; 3] {
        &self.channels
    }

    /// As [`AxialResponse::irradiance`] for three channels at once.
    ///
    /// *Accuracy*: 1e-5 of the single form for optical distances up to 40. *Cost*: see `docs/tables.md`.
    #[inline]
    pub fn irradiance(&self, sigma_t: [f32; 3], distance_m: f32, geometry: &Geometry) -> [f32; 3] {
        let sigma = lanes(sigma_t);
        let Places { rows: [i, j, k], fractions: [u, v, w], scale } = self.distances.places(sigma * distance_m);
        let angle = self.channels[0].angle_place(geometry.angle);
        let [a, b, c] = &self.channels;
        let sums = [
            a.partial_sums(i, u, angle, &geometry.basis),
            b.partial_sums(j, v, angle, &geometry.basis),
            c.partial_sums(k, w, angle, &geometry.basis),
        ];
        three(self.strength * scale * sigma * sigma * reduce(sums))
    }
}

/// Point or directional light.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalRgb {
    channels: [ZonalResponse; 3],
    distances: DistanceLanes,
}

impl ZonalRgb {
    /// Of three channels.
    pub fn new(channels: [ZonalResponse; 3]) -> Self {
        let distances = DistanceLanes::new(channels.each_ref().map(ZonalResponse::map));
        Self { channels, distances }
    }

    /// The channels.
    pub fn channels(&self) -> &[ZonalResponse; 3] {
        &self.channels
    }

    /// As [`ZonalResponse::irradiance`] for three channels at once; accuracy and cost as for [`AxialRgb`].
    #[inline]
    pub fn irradiance(&self, sigma_t: [f32; 3], distance_m: f32, cos_receiver: f32) -> [f32; 3] {
        let sigma = lanes(sigma_t);
        let Places { rows: [i, j, k], fractions: [u, v, w], scale } = self.distances.places(sigma * distance_m);
        let legendre = even_legendre(cos_receiver);
        let [a, b, c] = &self.channels;
        let sums = [a.partial_sums(i, u, &legendre), b.partial_sums(j, v, &legendre), c.partial_sums(k, w, &legendre)];
        let power = if self.channels[0].is_point_like() { sigma * sigma } else { f32x4::ONE };
        let further =
            lanes([a.further(i, u, cos_receiver), b.further(j, v, cos_receiver), c.further(k, w, cos_receiver)]);
        three(power * scale * (reduce(sums) + further))
    }
}

/// Sums over the lanes of three vectors; the last lane is 0.
#[inline]
fn reduce([a, b, c]: [f32x4; 3]) -> f32x4 {
    let [x, y, z, w] = f32x4::transpose([a, b, c, f32x4::ZERO]);
    (x + y) + (z + w)
}

#[inline]
fn three(lanes: f32x4) -> [f32; 3] {
    let [a, b, c, _] = lanes.to_array();
    [a, b, c]
}
