//! What a path over surfaces meets, without any air: kept, it is folded with whatever air is asked for.
//!
//! Strengths hold all that surfaces, emitters and densities say; what is left is transmittance, scattering and the tables. The air
//! at hand may guide where points are drawn, but their densities reach everywhere and are divided out: a record serves any air.

use crate::solve::path::Vertex;
use glam::Vec3;

/// One sample of a texel: the vertex where light is gathered and two paths on from there.
#[derive(Debug, Clone, Default)]
pub struct Path {
    /// Light straight from emitters to the start, one draw for each strategy.
    pub straight: Vec<Straight>,
    /// The start.
    pub start: Visit,
    /// On through the start's look, and aside on its own plane.
    pub chains: [Vec<Link>; 2],
}

/// A vertex of a path and what is seen from it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Visit {
    /// Where legs begin.
    pub origin: Vec3,
    /// Normal of the cosine.
    pub normal: Vec3,
    /// The station that speaks for it, if one is near.
    pub station: Option<u32>,
    /// Light straight from an emitter (later vertices only).
    pub straight: Option<Straight>,
    /// A lamp's light that one collision sends here.
    pub once: Option<Once>,
    /// An emitter to look up.
    pub lobe: Option<Lobe>,
    /// Where the path looked.
    pub look: Option<Look>,
}

/// Light on a straight leg from an emitter.
#[derive(Debug, Clone, Copy)]
pub struct Straight {
    /// Unit direction to the emitter.
    pub dir: Vec3,
    /// Metres; infinite to the sky.
    pub length: f32,
    /// Irradiance on the surface.
    pub irradiance: Vec3,
}

/// Light of a lamp by way of one point in the air.
#[derive(Debug, Clone, Copy)]
pub struct Once {
    /// Unit direction to that point.
    pub dir: Vec3,
    /// To the point, metres.
    pub distance: f32,
    /// Unit direction from there to the lamp.
    pub towards: Vec3,
    /// From there to the lamp, metres.
    pub rest: f32,
    /// Irradiance per coefficient of scattering times phase function.
    pub strength: Vec3,
}

/// A finite emitter in sight, whose light is scattered here by any way.
#[derive(Debug, Clone, Copy)]
pub struct Lobe {
    /// Index of the emitter.
    pub emitter: u32,
    /// Unit direction to it.
    pub dir: Vec3,
    /// Distance, metres.
    pub length: f32,
    /// Its axis.
    pub axis: Vec3,
    /// Intensity, or radiance times area, over the probability of the draw.
    pub strength: Vec3,
}

/// A direction into the scene and the emitters there.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Unit direction, above the surface.
    pub dir: Vec3,
    /// To the next surface, metres; infinite where there is none.
    pub length: f32,
    /// Irradiance of what glows at its end.
    pub glow: Vec3,
    /// Radiance of the sky over the density, where the look escapes.
    pub sky: Vec3,
    /// A sun seen from a point on the way.
    pub sun: Option<Sunlit>,
}

/// A point of a look that a sun shines on.
#[derive(Debug, Clone, Copy)]
pub struct Sunlit {
    /// The scene's light.
    pub light: u32,
    /// To the point, metres.
    pub distance: f32,
    /// Irradiance per coefficient of scattering times phase function.
    pub strength: Vec3,
}

/// A vertex of a path with the way that led to it.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    /// The way.
    pub step: Step,
    /// The vertex.
    pub visit: Visit,
}

/// How a path goes on to a surface, where radiance leaves towards the vertex before.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// By which way.
    pub way: Way,
    /// Inverse density per area, m².
    pub weight: f32,
    /// Normal of the surface on the side that the vertex before sees.
    pub axis: Vec3,
    /// Radiance per irradiance there, over the probability of going on this way.
    pub reflect: Vec3,
}

/// The ways from a vertex to the next.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    /// To the end of its look.
    Ahead,
    /// To a point of its own plane.
    Beside {
        /// Unit direction.
        dir: Vec3,
        /// Metres.
        length: f32,
    },
}

impl Visit {
    /// A vertex from which nothing has been seen yet.
    pub fn at(vertex: &Vertex, station: Option<u32>) -> Self {
        Self { origin: vertex.origin, normal: vertex.normal_shading, station, ..Self::default() }
    }
}
