//! Any sum of media along legs, through their closed forms in double precision.

use super::uniform::UniformBox;
use super::{Deflected, Flight, Leg, Media};
use bake_optics::medium::{self, MediumSet};
use bake_optics::phase::{Deflection, Phase};
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Any sum of media, through their closed forms in double precision.
#[derive(Debug, Clone)]
pub struct Fog<'a> {
    pub(in crate::solve) set: &'a MediumSet,
    /// Whether any of it scatters; what only absorbs needs no sampling.
    pub(in crate::solve) scatters: bool,
    most_collisions: u32,
    /// The set in its simplest form, where it has that.
    pub(in crate::solve) uniform: Option<UniformBox>,
}

impl<'a> Fog<'a> {
    /// The sum of all media.
    pub fn new(set: &'a MediumSet) -> Self {
        let scatters = set.media.iter().any(is_scattering);
        Self { set, scatters, most_collisions: u32::MAX, uniform: UniformBox::of(set) }
    }

    /// The same, where light collides at most so often between two surfaces.
    pub fn colliding_at_most(self, collisions: Option<u32>) -> Self {
        Self { most_collisions: collisions.unwrap_or(u32::MAX), ..self }
    }

    /// Optical depth of a leg per channel.
    pub(in crate::solve) fn depth(&self, leg: &Leg) -> Vec3 {
        if let Some(uniform) = &self.uniform {
            return uniform.stretch(leg).map_or(Vec3::ZERO, |(near, far)| uniform.sigma_t * (far - near));
        }
        DVec3::from(self.set.optical_depth(&leg.ray())).as_vec3()
    }

    /// Scattering at a point, 1/m.
    pub(in crate::solve) fn sigma_s(&self, point: Vec3) -> Vec3 {
        match &self.uniform {
            Some(uniform) if uniform.contains(point) => uniform.sigma_s,
            Some(_) => Vec3::ZERO,
            None => DVec3::from(self.set.sigma_s(point.as_dvec3())).as_vec3(),
        }
    }

    /// Extinction times transmittance at `distance`, and that transmittance.
    fn density(&self, ray: &medium::Ray, distance: f64) -> (DVec3, DVec3) {
        let passed = self.set.transmittance(&medium::Ray { length: distance, ..*ray });
        (DVec3::from(self.set.sigma_t(ray.at(distance))) * DVec3::from(passed), DVec3::from(passed))
    }
}

impl Media for Fog<'_> {
    const PRESENT: bool = true;

    fn scatters_again(&self, collisions: u32) -> bool {
        self.scatters && collisions < self.most_collisions
    }

    fn transmittance(&self, leg: &Leg) -> Vec3 {
        if let Some(uniform) = &self.uniform {
            return uniform.stretch(leg).map_or(Vec3::ONE, |(near, far)| uniform.passed(far - near));
        }
        DVec3::from(self.set.transmittance(&leg.ray())).as_vec3()
    }

    fn scattering_stretch(&self, leg: &Leg) -> Option<(f32, f32)> {
        if let Some(uniform) = &self.uniform {
            return uniform.stretch(leg).filter(|_| self.scatters);
        }
        let ray = leg.ray();
        let scattering = self.set.media.iter().filter(|m| is_scattering(m));
        scattering
            .filter_map(|m| m.bounds.clip(&ray))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .map(|(near, far)| (near as f32, far as f32))
    }

    fn fly(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Flight {
        let ray = leg.ray();
        if !self.scatters {
            return Flight::Through(self.transmittance(leg));
        }
        let (lead, shares) = leading_channel(throughput, u[0]);
        if let Some(uniform) = &self.uniform {
            return uniform.fly(leg, lead, shares.as_vec3(), u[1]);
        }
        // Depth zero would be reached before the air begins.
        let depth = -f64::from(-u[1]).ln_1p().min(-f64::MIN_POSITIVE);
        let distance = self.set.free_path(&ray, lead, depth);
        if distance < ray.length {
            let (density, passed) = self.density(&ray, distance);
            let pdf = shares.dot(density);
            let weight = if pdf > 0.0 { (passed / pdf).as_vec3() } else { Vec3::ZERO };
            return Flight::Collision { distance: distance as f32, weight };
        }
        let passed = DVec3::from(self.set.transmittance(&ray));
        let probability = shares.dot(passed);
        Flight::Through(if probability > 0.0 { (passed / probability).as_vec3() } else { Vec3::ZERO })
    }

    fn collide(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Option<(f32, Vec3)> {
        let (lead, shares) = leading_channel(throughput, u[0]);
        if let Some(uniform) = &self.uniform {
            return uniform.collide(leg, lead, shares.as_vec3(), u[1]);
        }
        let ray = leg.ray();
        let depth = DVec3::from(self.set.optical_depth(&ray));
        let collided = depth.to_array().map(|tau| -(-tau).exp_m1());
        let target = -(-f64::from(u[1]) * collided[lead]).ln_1p();
        let distance = self.set.free_path(&ray, lead, target).min(ray.length);
        let (density, passed) = self.density(&ray, distance);
        let conditional =
            DVec3::from_array(std::array::from_fn(|c| if collided[c] > 0.0 { density[c] / collided[c] } else { 0.0 }));
        let pdf = shares.dot(conditional);
        (pdf > 0.0 && distance.is_finite()).then(|| (distance as f32, (passed / pdf).as_vec3()))
    }

    fn scatter(&self, point: Vec3, from: Vec3, to: Vec3) -> Vec3 {
        if let (Some(uniform), Phase::Isotropic) = (&self.uniform, &self.set.media[0].phase) {
            return if uniform.contains(point) { uniform.sigma_s * (0.25 * FRAC_1_PI) } else { Vec3::ZERO };
        }
        let at = point.as_dvec3();
        let deflection = Deflection::between(from.as_dvec3().to_array(), to.as_dvec3().to_array());
        let of = |m: &medium::Medium| {
            let density = m.density_at(at);
            if density > 0.0 {
                DVec3::from(m.scatter.sigma_s) * (density * m.phase.eval_deflected(deflection))
            } else {
                DVec3::ZERO
            }
        };
        self.set.media.iter().map(of).sum::<DVec3>().as_vec3()
    }

    fn deflect(&self, point: Vec3, dir: Vec3, u: [f32; 3]) -> Option<Deflected> {
        let at = point.as_dvec3();
        let strength = |m: &medium::Medium| strength(m, at);
        let total: f64 = self.set.media.iter().map(strength).sum();
        if total <= 0.0 {
            return None;
        }
        let mut rest = f64::from(u[2]) * total;
        let chosen = self.set.media.iter().find(|m| {
            rest -= strength(m);
            rest < 0.0
        });
        let chosen = chosen.or_else(|| self.set.media.iter().rev().find(|m| strength(m) > 0.0))?;
        let drawn = chosen.phase.sample(f64::from(u[0])).deflection;
        let sin = (drawn.one_minus_cos * drawn.one_plus_cos).sqrt() as f32;
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        let to =
            crate::solve::warp::about(dir, Vec3::new(sin * cos_phi, sin * sin_phi, drawn.cos_theta as f32)).normalize();
        // All phase functions depend on the deflection alone: the sum needs no second look at directions.
        let (mut weight, mut pdf) = (DVec3::ZERO, 0.0);
        for m in &self.set.media {
            let share = strength(m) / total;
            if share > 0.0 {
                pdf += share * m.phase.pdf(drawn);
                weight += DVec3::from(m.scatter.sigma_s) * (m.density_at(at) * m.phase.eval_deflected(drawn));
            }
        }
        (pdf > 0.0).then(|| Deflected { dir: to, weight: (weight / pdf).as_vec3(), pdf: pdf as f32 })
    }

    fn deflect_pdf(&self, point: Vec3, dir: Vec3, to: Vec3) -> f32 {
        let deflection = Deflection::between(dir.as_dvec3().to_array(), to.as_dvec3().to_array());
        let (mut pdf, mut total) = (0.0, 0.0);
        for m in &self.set.media {
            let strength = strength(m, point.as_dvec3());
            total += strength;
            pdf += if strength > 0.0 { strength * m.phase.pdf(deflection) } else { 0.0 };
        }
        if total > 0.0 { (pdf / total) as f32 } else { 0.0 }
    }
}

impl Leg {
    pub(in crate::solve) fn ray(&self) -> medium::Ray {
        medium::Ray::from_single(self.origin, self.dir, self.length)
    }
}

/// How much a medium scatters at a point over all channels, 1/m.
fn strength(medium: &medium::Medium, at: DVec3) -> f64 {
    medium.density_at(at) * medium.scatter.sigma_s.iter().sum::<f64>()
}

fn is_scattering(medium: &medium::Medium) -> bool {
    medium.scatter.sigma_s.iter().any(|&sigma| sigma > 0.0)
}

/// One channel drawn in proportion to what the path still carries, and each channel's share: densities are summed over
/// all channels (balance heuristic), so that no channel gets an unbounded weight.
fn leading_channel(throughput: Vec3, u: f32) -> (usize, DVec3) {
    let sum = throughput.element_sum();
    let shares = if sum > 0.0 { throughput / sum } else { Vec3::splat(1.0 / 3.0) };
    let lead = if u < shares.x {
        0
    } else if u < shares.x + shares.y {
        1
    } else {
        2
    };
    (lead, shares.as_dvec3())
}
