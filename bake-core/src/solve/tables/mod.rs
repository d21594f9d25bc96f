//! Light through air by tables: surface paths only, and at every vertex the air's part looked up.
//!
//! A path weighs the radiance of its next vertex by what the air lets through and by what it scatters from there to the vertex
//! (the table of a surface element, Dubouchet et al. 2019). Emitters are looked up by next-event estimation; light of lamps
//! and suns that scatters once is sampled with its real distribution and shadows, because tables know neither. Rays that escape are
//! sources at the medium's boundary. Surfaces on the receiver's own plane, which no ray from it meets, are drawn on their own.
//! Tables are those of an infinite medium: [`factors`] bring them to the scene.

mod ahead;
pub mod codec;
pub mod factors;
mod fold;
pub mod medium;
pub mod paper;
pub mod record;
pub mod responses;
mod sources;
mod stations;
mod stray;
mod trace;

use super::Effort;
use super::emitters::Emitters;
use super::media::Leg;
use super::path::{Counters, Gather, Gathered, Paths, Vertex};
use super::sampler::Sampler;
use crate::trace::Tracer;
use ahead::Ahead;
use bake_formats::Term;
use bake_optics::medium::{Bounds, Density, Medium, MediumSet, Scatter};
use factors::{Factors, Local};
use fold::Fold;
use glam::Vec3;
use medium::Tabled;
use record::Path;
use responses::Responses;
use trace::Recorder;

/// A scene as looks into it see it.
pub(super) struct View<'a, 's> {
    paths: Paths<'a, 's, Tabled<'a>>,
    /// Typical size of walls, metres.
    wall: f32,
    /// Size of all surfaces together, metres.
    extent: f32,
    /// A box around all surfaces and the air that has an end.
    region: [Vec3; 2],
    /// Whether no look escapes.
    is_closed: bool,
    /// Whether paths go on from a vertex's own plane.
    own_plane: bool,
}

impl View<'_, '_> {
    /// The part of a leg within the region, metres from its start.
    fn likely_stretch(&self, leg: &Leg) -> Option<(f32, f32)> {
        let [low, high] = self.region;
        let inverse = 1.0 / leg.dir;
        let (a, b) = ((low - leg.origin) * inverse, (high - leg.origin) * inverse);
        let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element().min(leg.length));
        (near < far).then_some((near, far))
    }
}

/// Follows surface paths and looks up what the air adds: a path is recorded without air, then folded with it.
pub struct TablePaths<'a, 's> {
    view: View<'a, 's>,
    responses: Responses<'a>,
    factors: Factors,
}

impl<'a, 's> TablePaths<'a, 's> {
    /// Prepares tables and measures factors.
    pub fn new(paths: Paths<'a, 's, Tabled<'a>>, effort: Effort, seed: u32) -> Self {
        let mut responses = Responses::new(paths.media, &paths.tracer.scene().lights, &effort);
        let own_plane = effort.own_plane;
        let mut view = View { paths, wall: 1.0, extent: 1.0, region: [Vec3::ZERO; 2], is_closed: false, own_plane };
        let factors = Factors::new(&mut view, &mut responses, effort, seed);
        Self { view, responses, factors }
    }

    /// The factors in use.
    pub fn factors(&self) -> &Factors {
        &self.factors
    }

    /// One path from a vertex, without air, long enough for other air than the one at hand.
    pub fn record(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Path {
        self.record_for(None, start, sampler, counters)
    }

    fn record_for(&self, fold: Option<Fold>, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Path {
        Recorder { view: &self.view, stations: self.factors.stations(), counters, fold }.record(start, sampler)
    }

    /// What a path, whose start knows `local`, gathers in the air.
    pub fn fold(&self, path: &Path, local: &Local) -> Gathered {
        Gathered { terms: self.folder().path(path, local), ..Gathered::default() }
    }

    fn folder(&self) -> Fold<'_> {
        let View { paths, .. } = &self.view;
        Fold {
            air: paths.media,
            emitters: paths.emitters,
            lights: &paths.tracer.scene().lights,
            responses: &self.responses,
            factors: &self.factors,
        }
    }

    /// Whether no look escapes from the scene.
    pub fn is_closed(&self) -> bool {
        self.view.is_closed
    }

    /// Air around all surfaces as it might come: thin and even, and thick near the ground.
    pub fn hazes(&self) -> [MediumSet; 2] {
        let (wall, [low, high]) = (f64::from(self.view.wall), self.view.region.map(Vec3::as_dvec3));
        let haze = |optical_size: f64, density: Density| {
            let bounds = Bounds::Box { min: low - wall, max: high + wall };
            let sigma_t = optical_size / wall;
            let scatter = Scatter { sigma_s: [0.9 * sigma_t; 3], sigma_a: [0.1 * sigma_t; 3] };
            MediumSet { media: vec![Medium { bounds, scatter, density, ..Medium::default() }] }
        };
        let layer = Density::Exponential { base_m: low.y, scale_height_m: 0.5 * wall };
        [haze(0.4, Density::Uniform), haze(2.0, layer)]
    }

    /// The emitters that paths meet.
    pub fn emitters(&self) -> &Emitters<'s> {
        self.view.paths.emitters
    }
}

impl Gather for TablePaths<'_, '_> {
    const TERMS: &'static [Term] = &Term::ALL;

    fn tracer(&self) -> &Tracer<'_> {
        self.view.paths.tracer
    }

    fn gather(&self, start: &Vertex, sampler: &mut Sampler, counters: &Counters) -> Gathered {
        let path = self.record_for(Some(self.folder()), start, sampler, counters);
        self.fold(&path, &self.factors.at(start))
    }
}
