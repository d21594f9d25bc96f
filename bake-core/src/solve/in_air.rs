//! Light in the air, solved in one of the modes.

use super::emitters::Emitters;
use super::grid::{LightGrid, Lit};
use super::lattice::Lattice;
use super::media::Fog;
use super::points::{self, LatticeLight};
use super::sampler::hash;
use super::tables::medium::Tabled;
use super::tables::paper::PaperPaths;
use super::tables::{self, TablePaths};
use super::{Lightmap, LightmapSettings, Mode, emitters, pages, paths, pilot, solve_pages};
use crate::atlas::Atlas;
use crate::progress::{Interrupted, Progress};
use crate::trace::Tracer;
use ::tables::TableSet;
use bake_optics::medium::MediumSet;

/// Of the light grid, beside those of pages.
const GRID_SEED: u32 = 0x6772_6964;
/// Tells the random numbers of the tables\' factors from those of pages.
const FACTORS_SEED: u32 = 0x7461_626c;

/// The air, as paths of a mode meet it.
pub enum InAir<'a> {
    /// Collisions along every path.
    Walk(Fog<'a>),
    /// A filled grid, with the rays, shadow rays and cut paths that it took.
    Grid(Fog<'a>, LightGrid, [u64; 3]),
    /// Tables answer at surfaces; points in the air are walked.
    Tables(&'a MediumSet, Fog<'a>),
    /// The same, as published.
    Paper(&'a MediumSet, Fog<'a>),
}

impl<'a> InAir<'a> {
    /// Makes ready: fills the grid where the mode asks for one.
    pub fn prepare(
        tracer: &Tracer,
        media: &'a MediumSet,
        settings: &LightmapSettings,
        progress: &dyn Progress,
    ) -> Result<Self, Interrupted> {
        let fog = Fog::new(media).colliding_at_most(settings.collisions);
        match settings.mode {
            Mode::Grid if fog.scatters => {
                let (emitters, mut counts) = (emitters(tracer, settings), [0; 3]);
                let paths = paths(tracer, &emitters, &fog, settings);
                let seed = hash(settings.seed, GRID_SEED);
                let grid = LightGrid::solve(&paths, settings.grid, seed, &mut counts, progress)?;
                Ok(Self::Grid(fog, grid, counts))
            }
            Mode::Tables if fog.scatters => Ok(Self::Tables(media, fog)),
            Mode::Paper if fog.scatters => Ok(Self::Paper(media, fog)),
            _ => Ok(Self::Walk(fog)),
        }
    }

    /// Solves every page of the atlas.
    pub fn lightmap(
        &self,
        tracer: &Tracer,
        atlas: &Atlas,
        settings: &LightmapSettings,
        progress: &dyn Progress,
    ) -> Result<Lightmap, Interrupted> {
        match self {
            Self::Walk(fog) => pages(tracer, fog, atlas, settings, progress),
            Self::Tables(media, _) => {
                with_tables(tracer, media, settings, progress, |paths| solve_pages(paths, atlas, settings, progress))
            }
            Self::Paper(media, _) => {
                let (emitters, tabled) = (emitters(tracer, settings), Tabled::new(media));
                let paths = PaperPaths::new(paths(tracer, &emitters, &tabled, settings), TableSet::published());
                solve_pages(&paths, atlas, settings, progress)
            }
            Self::Grid(fog, grid, [rays, shadow_rays, cut_paths]) => {
                let lit = Lit::new(fog.clone(), grid, tracer);
                let emitters = emitters(tracer, settings);
                let spread = pilot::spread_of_samples(&paths(tracer, &emitters, &lit, settings), atlas, settings.seed);
                let lit = lit.beside(spread);
                let mut lightmap = pages(tracer, &lit, atlas, settings, progress)?;
                lightmap.rays += rays;
                lightmap.shadow_rays += shadow_rays;
                lightmap.cut_paths += cut_paths;
                Ok(lightmap)
            }
        }
    }

    /// Solves the points of a lattice.
    pub fn lattice(
        &self,
        tracer: &Tracer,
        emitters: &Emitters,
        lattice: &Lattice,
        settings: &LightmapSettings,
        progress: &dyn Progress,
    ) -> Result<LatticeLight, Interrupted> {
        match self {
            Self::Walk(fog) | Self::Tables(_, fog) | Self::Paper(_, fog) => {
                points::solve(&paths(tracer, emitters, fog, settings), lattice, settings, progress)
            }
            Self::Grid(fog, grid, _) => {
                let lit = Lit::new(fog.clone(), grid, tracer);
                points::solve(&paths(tracer, emitters, &lit, settings), lattice, settings, progress)
            }
        }
    }
}

/// Does something with paths that look up tables.
pub fn with_tables<T>(
    tracer: &Tracer,
    media: &MediumSet,
    settings: &LightmapSettings,
    progress: &dyn Progress,
    solve: impl FnOnce(&TablePaths) -> T,
) -> T {
    progress.stage("measure factors", 1);
    let (emitters, reduced) = (emitters(tracer, settings), tables::medium::reduce(media));
    let tabled = Tabled::new(&reduced);
    let paths = paths(tracer, &emitters, &tabled, settings);
    let paths = TablePaths::new(paths, settings.tables, hash(settings.seed, FACTORS_SEED));
    progress.advance(1);
    solve(&paths)
}
