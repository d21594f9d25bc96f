//! Incident radiance at free points, as spherical harmonics: what probes hold, and what the light grid knows of the air.

use super::emitters::Strategy;
use super::media::Media;
use super::path::{Counters, Paths, Vertex};
use super::sampler::Sampler;
use super::warp;
use bake_formats::Term;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Coefficients with l ≤ 2, index l(l+1)+m, per linear RGB channel.
pub type Sh9 = [Vec3; 9];

/// The nine harmonics in a unit direction (Sloan 2013, "Efficient Spherical Harmonic Evaluation").
///
/// *Accuracy*: within 3e-7 of `bake_optics::harmonics` in double precision.
#[inline]
pub fn harmonics(dir: Vec3) -> [f32; 9] {
    /// √(1/4π), √(3/4π), √(15/4π), √(5/16π), √(15/16π).
    const N: [f32; 5] = [0.282_094_79, 0.488_602_51, 1.092_548_4, 0.315_391_57, 0.546_274_2];
    let Vec3 { x, y, z } = dir;
    let (one, two) = (N[1] * dir, N[2] * dir);
    [N[0], one.y, one.z, one.x, two.x * y, two.y * z, N[3] * (3.0 * z * z - 1.0), two.x * z, N[4] * (x * x - y * y)]
}

/// Harmonics of incident radiance (cd/m²) by term, in the order of [`Term`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Incident {
    /// One set a term.
    pub terms: [Sh9; 4],
}

impl Incident {
    /// Adds radiance from `dir` to a term.
    pub(super) fn add(&mut self, term: usize, dir: Vec3, radiance: Vec3) {
        if radiance != Vec3::ZERO {
            for (sum, y) in self.terms[term].iter_mut().zip(harmonics(dir)) {
                *sum += radiance * y;
            }
        }
    }

    /// Adds another's coefficients, times `scale`.
    pub fn add_scaled(&mut self, other: &Self, scale: f32) {
        for (sums, values) in self.terms.iter_mut().zip(&other.terms) {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += *value * scale;
            }
        }
    }

    /// All terms together.
    pub fn total(&self) -> Sh9 {
        std::array::from_fn(|i| self.terms.iter().map(|term| term[i]).sum())
    }
}

/// Density of directions drawn evenly over the sphere.
const SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// A vertex in the air.
pub(super) fn in_air(point: Vec3) -> Vertex {
    Vertex { origin: point, normal_geom: Vec3::ZERO, normal_shading: Vec3::ZERO }
}

impl<M: Media> Paths<'_, '_, M> {
    /// One sample of the light that arrives at a free point, drawn emitters and all.
    pub fn gather_sphere(&self, point: Vec3, sampler: &mut Sampler, counters: &Counters) -> Incident {
        let mut incident = Incident::default();
        for strategy in self.strategies_at_points() {
            let [u, v, w, _] = sampler.next4();
            if let Some((irradiance, dir, emitter_pdf)) = self.draw_at(point, strategy, [u, v, w], counters) {
                let weight = emitter_pdf.map_or(1.0, |own| super::path::power_heuristic(own, SPHERE_PDF));
                incident.add(Term::Direct as usize, dir, irradiance * weight);
            }
        }
        let mut air = sampler.fork();
        if let Some((radiance, dir, _)) = self.lamps_around(&in_air(point), &mut air, counters) {
            incident.add(Term::Single as usize, dir, radiance);
        }
        self.follow_any(point, (sampler, &mut air), counters, &mut incident);
        incident
    }

    /// The same but for what emitters are drawn for: their straight light, and that of lamps scattered once.
    #[cfg(feature = "media")]
    pub(super) fn reflected_sphere(&self, point: Vec3, sampler: &mut Sampler, counters: &Counters) -> Incident {
        let (mut incident, mut air) = (Incident::default(), sampler.fork());
        self.follow_any(point, (sampler, &mut air), counters, &mut incident);
        incident
    }

    /// Adds what comes from one direction of all.
    fn follow_any(
        &self,
        point: Vec3,
        (sampler, air): (&mut Sampler, &mut Sampler),
        counters: &Counters,
        incident: &mut Incident,
    ) {
        let [u, v, crossing, lobe] = sampler.next4();
        let dir = warp::uniform_sphere(u, v);
        let radiance = self.follow(&in_air(point), dir, SPHERE_PDF, [crossing, lobe], (sampler, air), counters);
        for (term, radiance) in radiance.into_iter().enumerate() {
            incident.add(term, dir, radiance / SPHERE_PDF);
        }
    }

    /// The kinds of draw that reach every emitter from a point in the air.
    pub(super) fn strategies_at_points(&self) -> impl Iterator<Item = Strategy> {
        let lamps = self.emitters.has_lamps().then_some(Strategy::Lamp);
        self.emitters.strategies_in_air().iter().copied().chain(lamps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::harmonics::real_sh_into;
    use testkit::compare::Worst;

    #[test]
    fn closed_forms_are_the_harmonics() {
        let mut worst = Worst::new("harmonics in closed form", 3e-7);
        for i in 0..1000u32 {
            let dir = warp::uniform_sphere((i as f32 + 0.5) / 1000.0, (i as f32 * 0.618_034).fract());
            let mut exact = [0.0f64; 9];
            real_sh_into(dir.as_dvec3().to_array(), 3, &mut exact);
            for (i, (got, want)) in harmonics(dir).into_iter().zip(exact).enumerate() {
                worst.record((f64::from(got) - want).abs(), || format!("coefficient {i} along {dir}"));
            }
        }
        worst.check();
    }
}
