//! Tables prepared for the media of a scene, and what they say of one ray.
//!
//! A ray sees uniform air of its own mean density (Dubouchet et al. 2019, section 4.4): exact for attenuation. Several
//! media on a ray share its response in proportion to their optical depths.

use super::medium::Tabled;
use crate::scene::{Light, LightKind};
use crate::solve::Effort;
use crate::solve::emitters::punctual;
use crate::solve::media::Leg;
use ::tables::response::AxialResponse;
use ::tables::{Air, Geometry, SERIES_DEGREES, Scatter, TableSet, ZonalResponse};
use bake_optics::legendre::legendre_all;
use glam::Vec3;

/// Numbers of collisions up to which tables may be summed.
pub const ORDERS: [usize; 4] = [2, 3, 5, 10];

/// Midpoints over the angle from the axis and around it at which a lamp's distribution is measured: 28 within a spot of 5°.
const LAMP_PROBES: (usize, usize) = (1024, 16);

/// Light scattered once and more than once.
pub type Lobe = [Vec3; 2];

/// The tables of one medium and channel.
struct Channel {
    area_single: AxialResponse,
    area_multiple: Vec<AxialResponse>,
    sky_single: ZonalResponse,
    sky_multiple: Vec<ZonalResponse>,
    /// By shape of lamp.
    lamps: Vec<Vec<AxialResponse>>,
}

/// The tables of all media.
pub struct Responses<'a> {
    air: &'a Tabled<'a>,
    /// By medium; one channel where the air is grey.
    media: Vec<Vec<Channel>>,
    /// Shape of each light of the scene.
    shape_of: Vec<usize>,
    /// For each channel, the sum in use as an index of [`ORDERS`].
    pub chosen: [usize; 3],
}

/// An emitter with an axis, or a surface element, seen from a receiver along a leg.
pub struct Sight<'l> {
    /// From the receiver to the emitter.
    pub leg: &'l Leg,
    /// Optical depth of the leg.
    pub depth: Vec3,
    /// Receiver's normal and emitter's axis about the leg.
    pub geometry: Geometry,
}

impl<'a> Responses<'a> {
    /// Prepares the tables for the media of `air` and the shapes of `lights`, as fine as `effort` says.
    pub fn new(air: &'a Tabled<'a>, lights: &[Light], effort: &Effort) -> Self {
        let whole = TableSet::with_bands(effort.bands);
        let is_whole = (effort.bins, effort.bands) == (whole.recipe().read_bins, whole.recipe().bands);
        let reduced = (!is_whole).then(|| whole.reduced(effort.bins, effort.bands));
        let set = reduced.as_ref().unwrap_or(whole);
        let (shapes, shape_of) = shapes(lights);
        let channels = if air.is_grey() { 1 } else { 3 };
        let prepare = |medium: &bake_optics::medium::Medium| {
            let channel = |c: usize| {
                let (sigma_s, sigma_t) = (medium.scatter.sigma_s[c], medium.scatter.sigma_t()[c]);
                let albedo = if sigma_t > 0.0 { sigma_s / sigma_t } else { 0.0 };
                Channel::new(set, &Air { albedo, phase: medium.phase.clone() }, &shapes)
            };
            (0..channels).map(channel).collect()
        };
        let media = air.set().media.iter().map(prepare).collect();
        Self { air, media, shape_of, chosen: [0; 3] }
    }

    /// Irradiance per `L_o dA` of a surface element that lies at the end of the leg: scattered once, and up to each of [`ORDERS`].
    pub fn area_of_all(&self, sight: &Sight) -> [Vec3; 1 + ORDERS.len()] {
        std::array::from_fn(|i| match i {
            0 => self.axial(sight, |channel, _| &channel.area_single),
            _ => self.axial(sight, |channel, _| &channel.area_multiple[i - 1]),
        })
    }

    /// The same with the chosen sums.
    pub fn area(&self, sight: &Sight) -> Lobe {
        [
            self.axial(sight, |channel, _| &channel.area_single),
            self.axial(sight, |channel, c| &channel.area_multiple[self.chosen[c]]),
        ]
    }

    /// Irradiance per unit of intensity of a lamp at the end of the leg, scattered twice or more.
    pub fn lamp(&self, sight: &Sight, light: usize) -> Vec3 {
        self.axial(sight, |channel, c| &channel.lamps[self.shape_of[light]][self.chosen[c]])
    }

    /// The same for each of [`ORDERS`].
    pub fn lamp_of_all(&self, sight: &Sight, light: usize) -> [Vec3; ORDERS.len()] {
        std::array::from_fn(|i| self.axial(sight, |channel, _| &channel.lamps[self.shape_of[light]][i]))
    }

    /// Irradiance per irradiance before the medium of light from the direction of the leg, at `cos` from the receiver's normal.
    pub fn distant(&self, leg: &Leg, depth: Vec3, cos: f32) -> Lobe {
        [
            self.mix(leg, depth, |channel, c| channel.sky_single.irradiance(1.0, depth[c], cos).max(0.0)),
            self.mix(leg, depth, |channel, c| {
                channel.sky_multiple[self.chosen[c]].irradiance(1.0, depth[c], cos).max(0.0)
            }),
        ]
    }

    /// The same for each of [`ORDERS`].
    pub fn distant_of_all(&self, leg: &Leg, depth: Vec3, cos: f32) -> [Vec3; 1 + ORDERS.len()] {
        std::array::from_fn(|i| {
            self.mix(leg, depth, |channel, c| match i {
                0 => channel.sky_single.irradiance(1.0, depth[c], cos).max(0.0),
                _ => channel.sky_multiple[i - 1].irradiance(1.0, depth[c], cos).max(0.0),
            })
        })
    }

    fn axial<'s>(&'s self, sight: &Sight, table: impl Fn(&'s Channel, usize) -> &'s AxialResponse) -> Vec3 {
        let Sight { leg, depth, geometry } = sight;
        self.mix(leg, *depth, |channel, c| {
            table(channel, c).irradiance(depth[c] / leg.length, leg.length, geometry).max(0.0)
        })
    }

    /// A look-up for each channel, over the media in proportion to their optical depths on the leg.
    #[inline]
    fn mix<'s>(&'s self, leg: &Leg, depth: Vec3, look_up: impl Fn(&'s Channel, usize) -> f32) -> Vec3 {
        let of = |channels: &'s Vec<Channel>, share: Vec3| match channels.as_slice() {
            [grey] => {
                if share.x > 0.0 {
                    Vec3::splat(look_up(grey, 0) * share.x)
                } else {
                    Vec3::ZERO
                }
            }
            _ => Vec3::from_array(std::array::from_fn(|c| {
                if share[c] > 0.0 { look_up(&channels[c], c) * share[c] } else { 0.0 }
            })),
        };
        if let [channels] = self.media.as_slice() {
            return of(channels, depth.map(|d| if d > 0.0 { 1.0 } else { 0.0 }));
        }
        let ray = leg.ray();
        self.air
            .set()
            .media
            .iter()
            .zip(&self.media)
            .map(|(medium, channels)| {
                let length = medium.optical_length(&ray);
                let share = Vec3::from_array(std::array::from_fn(|c| {
                    if depth[c] > 0.0 { (medium.scatter.sigma_t()[c] * length) as f32 / depth[c] } else { 0.0 }
                }));
                of(channels, share)
            })
            .sum()
    }
}

impl Channel {
    fn new(set: &TableSet, air: &Air, shapes: &[Vec<f64>]) -> Self {
        let sums = ORDERS.map(Scatter::Multiple);
        Self {
            area_single: set.area(air, Scatter::Single),
            area_multiple: sums.map(|sum| set.area(air, sum)).into(),
            sky_single: set.directional(air, Scatter::Single),
            sky_multiple: sums.map(|sum| set.directional(air, sum)).into(),
            lamps: shapes.iter().map(|shape| sums.map(|sum| set.axial(shape, air, sum)).into()).collect(),
        }
    }
}

/// The different distributions of the lights as Legendre coefficients about their axes, and which one each light has.
fn shapes(lights: &[Light]) -> (Vec<Vec<f64>>, Vec<usize>) {
    let mut shapes: Vec<Vec<f64>> = Vec::new();
    let of = |light: &Light| {
        if matches!(light.kind, LightKind::Directional { .. }) {
            return 0;
        }
        let shape = legendre(light);
        shapes.iter().position(|known| *known == shape).unwrap_or_else(|| {
            shapes.push(shape);
            shapes.len() - 1
        })
    };
    let shape_of = lights.iter().map(of).collect();
    (shapes, shape_of)
}

/// Legendre coefficients `(2l+1)/2 ∫ I(μ) P_l(μ) dμ` of a lamp's distribution about its axis.
fn legendre(light: &Light) -> Vec<f64> {
    if matches!(light.kind, LightKind::Point { profile: None, .. }) {
        return vec![1.0];
    }
    let (mut sums, mut p) = (vec![0.0; SERIES_DEGREES], vec![0.0; SERIES_DEGREES]);
    let (angles, turns) = LAMP_PROBES;
    let step = std::f64::consts::PI / angles as f64;
    for i in 0..angles {
        let (exact_sin, mu) = ((i as f64 + 0.5) * step).sin_cos();
        let sin = exact_sin as f32;
        let towards = |turn: usize| {
            let (y, x) = (std::f32::consts::TAU * turn as f32 / turns as f32).sin_cos();
            crate::solve::warp::about(punctual::axis(light), Vec3::new(sin * x, sin * y, mu as f32))
        };
        let mean = (0..turns).map(|t| f64::from(punctual::shape(light, towards(t)))).sum::<f64>() / turns as f64;
        legendre_all(mu, &mut p);
        let weight = 0.5 * mean * step * exact_sin;
        sums.iter_mut().zip(&p).enumerate().for_each(|(l, (s, p))| *s += (2 * l + 1) as f64 * weight * p);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// glTF's falloff `((μ − o)/(i − o))²` between the cosines i and o of half angles of 5 and 10°: c_0 = ((1 − i) + (i − o)/3)/2, and c_1 is
    /// nearly 3 c_0 of so narrow a beam.
    #[test]
    fn a_narrow_spots_series_begins_with_its_flux() {
        let (i, o) = (5f64.to_radians().cos(), 10f64.to_radians().cos());
        let kind = LightKind::Spot {
            position: Vec3::ZERO,
            direction: Vec3::new(0.6, -0.8, 0.0),
            cos_inner: i as f32,
            cos_outer: o as f32,
            radius: 0.0,
            range: None,
            profile: None,
        };
        let c = legendre(&Light { path: "lamp".into(), color: Vec3::ONE, kind });
        let want = 0.5 * ((1.0 - i) + (i - o) / 3.0);
        assert_eq!(c.len(), SERIES_DEGREES);
        assert!((c[0] / want - 1.0).abs() < 3e-3, "{} {want}", c[0]);
        assert!((c[1] / (3.0 * want) - 1.0).abs() < 1e-2, "{} {want}", c[1]);
    }
}
