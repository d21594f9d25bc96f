//! The three colour channels of one medium looked up together: geometry, distance and memory are shared as far as they are equal.

use crate::curves::Place;
use crate::geometry::Geometry;
use crate::lanes::{DistanceLanes, lanes};
use crate::response::{AxialResponse, ZonalResponse, even_legendre};
use wide::f32x4;

/// Area, spot or lamp.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialRgb {
    channels: [AxialResponse; 3],
    distances: DistanceLanes,
}

impl AxialRgb {
    /// Of three channels from one set of tables; `TableSet::area_rgb` lets them share memory where it can.
    pub fn new(channels: [AxialResponse; 3]) -> Self {
        let angles = channels.each_ref().map(AxialResponse::angles);
        assert!(angles == [angles[0]; 3], "responses of one set have the same angles, not {angles:?}");
        let distances = DistanceLanes::new(channels.each_ref().map(AxialResponse::map));
        Self { channels, distances }
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
        let places = self.distances.places(lanes(sigma_t) * f32x4::splat(distance_m));
        let angle = self.channels[0].angle_place(geometry.angle);
        each(&self.channels, sigma_t, &places, |response, sigma, place| {
            response.irradiance_at(sigma, place, angle, &geometry.basis)
        })
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
        let places = self.distances.places(lanes(sigma_t) * f32x4::splat(distance_m));
        let legendre = even_legendre(cos_receiver);
        each(&self.channels, sigma_t, &places, |response, sigma, place| response.irradiance_at(sigma, place, &legendre))
    }
}

#[inline]
fn each<R>(channels: &[R; 3], sigma_t: [f32; 3], places: &[Place; 3], at: impl Fn(&R, f32, &Place) -> f32) -> [f32; 3] {
    std::array::from_fn(|i| at(&channels[i], sigma_t[i], &places[i]))
}
