//! The air as the tables see it: reduced to isotropic scattering where it is not nearly so, and uniform along each ray.

use crate::solve::media::Deflected;
use crate::solve::media::{Flight, Fog, Leg, Media};
use bake_optics::medium::{MediumSet, Scatter};
use bake_optics::phase::Phase;
use glam::Vec3;

/// Mean cosine above which the whole medium is exchanged for an isotropic one.
const LARGEST_MEAN_COSINE: f64 = 0.2;

/// The media that the tables are read for: similarity (`sigma_s' = (1 − g) sigma_s`) wherever scattering is not nearly
/// isotropic. It belongs to the whole medium, attenuation included.
pub fn reduce(set: &MediumSet) -> MediumSet {
    let mut reduced = set.clone();
    for medium in &mut reduced.media {
        let similar = medium.phase.similarity();
        if medium.phase.mean_cosine().abs() > LARGEST_MEAN_COSINE {
            let sigma_s = medium.scatter.sigma_s.map(|s| s * similar.scatter_factor);
            medium.scatter = Scatter { sigma_s, ..medium.scatter };
            medium.phase = Phase::Isotropic;
        }
    }
    reduced
}

/// Air whose scattering is looked up: paths do not turn in it, and directions are drawn half by cosine and half uniformly,
/// because scattered light has no cosine at the receiver.
#[derive(Debug, Clone)]
pub struct Tabled<'a> {
    fog: Fog<'a>,
    set: &'a MediumSet,
}

impl<'a> Tabled<'a> {
    /// Over media that [`reduce`] has prepared.
    pub fn new(set: &'a MediumSet) -> Self {
        Self { fog: Fog::new(set), set }
    }

    /// The media.
    pub fn set(&self) -> &MediumSet {
        self.set
    }

    /// Optical depth of a leg per channel.
    pub fn depth(&self, leg: &Leg) -> Vec3 {
        self.fog.depth(leg)
    }

    /// Distance of a collision on the leg, whatever the channel.
    pub fn draw_collision(&self, leg: &Leg, u: [f32; 2]) -> Option<f32> {
        self.fog.collide(leg, Vec3::ONE, u).map(|(distance, _)| distance).filter(|distance| *distance > 0.0)
    }

    /// Density of [`Self::draw_collision`], 1/m: the mean over channels that collide at all.
    pub fn collision_pdf(&self, leg: &Leg, distance: f32) -> f32 {
        let sigma_t = self.set.sigma_t(leg.at(distance).as_dvec3());
        let (total, before) = (self.depth(leg), self.depth(&Leg { length: distance, ..*leg }));
        let of = |c: usize| {
            if total[c] > 0.0 { sigma_t[c] as f32 * (-before[c]).exp() / -(-total[c]).exp_m1() } else { 0.0 }
        };
        (0..3).map(of).sum::<f32>() / 3.0
    }

    /// Whether the three channels are the same.
    pub fn is_grey(&self) -> bool {
        let equal = |v: [f64; 3]| v[0] == v[1] && v[1] == v[2];
        self.set.media.iter().all(|m| equal(m.scatter.sigma_s) && equal(m.scatter.sigma_a))
    }

    /// Whether nothing is absorbed.
    pub fn is_conservative(&self) -> bool {
        self.set.media.iter().all(|m| m.scatter.sigma_a == [0.0; 3])
    }
}

impl Media for Tabled<'_> {
    const PRESENT: bool = true;
    const MIXED: bool = true;

    fn transmittance(&self, leg: &Leg) -> Vec3 {
        self.fog.transmittance(leg)
    }

    fn scattering_stretch(&self, leg: &Leg) -> Option<(f32, f32)> {
        self.fog.scattering_stretch(leg)
    }

    fn fly(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Flight {
        self.fog.fly(leg, throughput, u)
    }

    fn collide(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Option<(f32, Vec3)> {
        self.fog.collide(leg, throughput, u)
    }

    fn scatter(&self, point: Vec3, from: Vec3, to: Vec3) -> Vec3 {
        if self.set.media.is_empty() {
            return Vec3::ZERO;
        }
        self.fog.scatter(point, from, to)
    }

    fn deflect(&self, point: Vec3, dir: Vec3, u: [f32; 3]) -> Option<Deflected> {
        self.fog.deflect(point, dir, u)
    }

    fn deflect_pdf(&self, point: Vec3, dir: Vec3, to: Vec3) -> f32 {
        self.fog.deflect_pdf(point, dir, to)
    }
}
