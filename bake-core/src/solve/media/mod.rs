//! What the air does to light on a straight leg of a path: weakens it, and throws it out of its way.
//!
//! A solver is compiled for one kind of [`Media`]; [`Vacuum`] leaves nothing of this in it.

#[cfg(feature = "media")]
mod fog;
#[cfg(feature = "media")]
mod uniform;

#[cfg(feature = "media")]
pub use fog::Fog;

use bake_formats::Term;
use glam::Vec3;

/// A straight leg of a path.
#[derive(Debug, Clone, Copy)]
pub struct Leg {
    /// Start, metres.
    pub origin: Vec3,
    /// Unit direction.
    pub dir: Vec3,
    /// Length, metres; infinite where nothing is met.
    pub length: f32,
}

/// How a sampled flight along a leg ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flight {
    /// It reaches the leg's end; transmittance over the probability of that.
    Through(Vec3),
    /// It ends in the air.
    Collision {
        /// Where, metres from the leg's start.
        distance: f32,
        /// Transmittance over the density per metre; the coefficient of scattering is not in it, see [`Media::scatter`].
        weight: Vec3,
    },
}

/// A direction drawn after a collision.
#[derive(Debug, Clone, Copy)]
pub struct Deflected {
    /// Unit direction.
    pub dir: Vec3,
    /// `sigma_s` times phase function over the density, 1/m.
    pub weight: Vec3,
    /// Density per solid angle.
    pub pdf: f32,
}

/// Air along straight legs.
pub trait Media: Sync {
    /// Whether there is any: false removes the air from a solver.
    const PRESENT: bool;

    /// The terms into which light falls.
    const TERMS: &'static [Term] = &Term::ALL;

    /// Whether [`Media::cached`] knows the light in the air; paths then do not turn there.
    const CACHED: bool = false;

    /// Whether directions are drawn half by cosine, half uniformly, at every vertex.
    const MIXED: bool = false;

    /// Whether light that has collided so often since a surface may collide again before it meets the next.
    fn scatters_again(&self, _collisions: u32) -> bool {
        true
    }

    /// Share of light that passes the leg, per channel.
    fn transmittance(&self, leg: &Leg) -> Vec3;

    /// The stretch of the leg outside which nothing scatters, metres from its start.
    fn scattering_stretch(&self, leg: &Leg) -> Option<(f32, f32)>;

    /// Samples how far light gets on the leg; `throughput` decides which channel leads.
    fn fly(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Flight;

    /// Distance at which light is scattered on the stretch, sampled in proportion to what collides of the leading
    /// channel, with transmittance up to there over the density per metre.
    fn collide(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Option<(f32, Vec3)>;

    /// Coefficient of scattering times phase function, 1/(m sr) per channel, for light that travels along `from`
    /// before and along `to` after.
    fn scatter(&self, point: Vec3, from: Vec3, to: Vec3) -> Vec3;

    /// Draws where light came from that leaves `point` against `dir` (the direction in which the path is followed).
    fn deflect(&self, point: Vec3, dir: Vec3, u: [f32; 3]) -> Option<Deflected>;

    /// Density per solid angle with which [`Media::deflect`] draws `to`.
    fn deflect_pdf(&self, point: Vec3, dir: Vec3, to: Vec3) -> f32;

    /// In-scattered radiance against `dir`, for a path's first leg. `u` picks among what is near.
    fn cached(&self, _point: Vec3, _dir: Vec3, _u: f32) -> InScattered {
        InScattered::default()
    }

    /// Look-ups that it pays to make for each collision that would happen; more than one for a collision on a path's first leg.
    fn looks_per_collision(&self) -> f32 {
        1.0
    }

    /// Collisions that it may pay to look at on a path's first leg, at least 1.
    fn most_looks(&self) -> usize {
        1
    }

    /// The same as one, straight light of emitters and all, cd/m³: for later legs.
    fn cached_whole(&self, _point: Vec3, _dir: Vec3, _u: f32) -> Vec3 {
        Vec3::ZERO
    }
}

/// In-scattered radiance per metre, cd/m³, by what the light did before.
#[derive(Debug, Clone, Copy, Default)]
pub struct InScattered {
    /// It came straight from surfaces.
    pub reflected: Vec3,
    /// It collided before.
    pub collided: Vec3,
    /// Roughly what came straight from emitters other than lamps: tells where drawing them is worth while.
    pub drawn: f32,
}

/// No air.
#[derive(Debug, Clone, Copy, Default)]
pub struct Vacuum;

impl Media for Vacuum {
    const PRESENT: bool = false;
    const TERMS: &'static [Term] = &[Term::Direct, Term::Indirect];

    #[inline(always)]
    fn transmittance(&self, _: &Leg) -> Vec3 {
        Vec3::ONE
    }

    fn scattering_stretch(&self, _: &Leg) -> Option<(f32, f32)> {
        None
    }

    fn fly(&self, _: &Leg, _: Vec3, _: [f32; 2]) -> Flight {
        Flight::Through(Vec3::ONE)
    }

    fn collide(&self, _: &Leg, _: Vec3, _: [f32; 2]) -> Option<(f32, Vec3)> {
        None
    }

    fn scatter(&self, _: Vec3, _: Vec3, _: Vec3) -> Vec3 {
        Vec3::ZERO
    }

    fn deflect(&self, _: Vec3, _: Vec3, _: [f32; 3]) -> Option<Deflected> {
        None
    }

    fn deflect_pdf(&self, _: Vec3, _: Vec3, _: Vec3) -> f32 {
        0.0
    }
}

impl Leg {
    /// The point at `distance`, kept before the leg's end, so that rounding does not put it behind the surface there.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.dir * distance.min(self.length * (1.0 - 4.0 * f32::EPSILON))
    }
}
