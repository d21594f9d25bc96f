//! What a bake will simulate and why, and what that will take: derived from scene, settings and atlas, and from a pilot
//! of a few thousand paths for the median irradiance that all bounds are shares of.

pub mod bounds;
pub mod budget;
pub mod effects;
mod expected;
mod lattices;
mod mode;
pub mod reduce;
mod steps;

pub use effects::Effect;
pub use lattices::Lattices;
pub use mode::Choice;

use crate::air::{self, Air};
use crate::atlas::Atlas;
use crate::scene::Scene;
use crate::settings::{EffectName, Settings, SettingsError};
use crate::solve::{LightmapSettings, Mode, kept_size, pilot, rounds};
use crate::trace::Tracer;
use budget::Budget;
use glam::Vec3;
use serde::Serialize;

/// The plan of one bake.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Every effect that the program knows, on or off.
    pub effects: Vec<Effect>,
    /// The air.
    pub media: Vec<air::Summary>,
    /// How light in the air is solved; `None` without air.
    pub mode: Option<Choice>,
    /// What the scene consists of.
    pub scene: SceneSize,
    /// What will be written.
    pub atlas: AtlasSize,
    /// Where probes and the fog volume's cells lie.
    pub lattices: Lattices,
    /// What it will take.
    pub cost: Cost,
    /// What keeping paths takes, where they are kept.
    pub kept_paths: Option<KeptPaths>,
    /// The air that is simulated: less what is left out.
    #[serde(skip)]
    pub simulated: Air,
    /// What the solver is told: mode, and what is left out.
    #[serde(skip)]
    pub solver: LightmapSettings,
}

/// What keeping paths takes, and what folding them with other air costs in noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct KeptPaths {
    /// Bytes for the least, usual and most samples.
    pub bytes: [u64; 3],
    /// Standard error of the folded pages over that of a bake by tables in the other air with the same samples: at most, as
    /// measured where as many rays escape.
    pub noise: f64,
}

/// Size of the scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneSize {
    /// Meshes.
    pub meshes: usize,
    /// Placements of meshes.
    pub instances: usize,
    /// Of those, the ones that take a lightmap.
    pub lightmapped: usize,
    /// Triangles stored.
    pub triangles: usize,
    /// Triangles in the world, instances counted.
    pub instanced_triangles: usize,
    /// Materials.
    pub materials: usize,
    /// Point, spot and directional lights.
    pub lights: usize,
    /// Bounding box, metres.
    pub bounds: [Vec3; 2],
}

/// Size of the lightmaps.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AtlasSize {
    /// Width and height of each page, texels.
    pub pages: Vec<[u32; 2]>,
    /// Texels with a surface behind them.
    pub texels: usize,
    /// Charts.
    pub charts: u32,
}

/// What a bake takes, estimated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// Samples per texel: the preset's floor, about what its error takes, and its cap.
    pub samples: [u32; 3],
    /// Rays for each of these.
    pub rays: [f64; 3],
    /// Seconds for each of these, on `threads` threads.
    pub seconds: [f64; 3],
    /// Threads counted on.
    pub threads: usize,
    /// Memory at the peak, bytes.
    pub memory_bytes: u64,
}

/// Rays per sample and surface on the way: the path's own and one towards an emitter.
const RAYS_PER_VERTEX: f64 = 2.0;
/// Most vertices that count: Russian roulette ends paths after a few reflections. Measured: 4.8 rays a sample in a box
/// of usual albedos.
const USUAL_VERTICES: f64 = 2.5;
/// Rays per second and thread: between the 2 million of a box of 46 triangles and a fraction of that in large scenes.
const RAYS_PER_SECOND: f64 = 1e6;

/// Bytes of a lattice's point: harmonics, those of every replicate, place and image.
const LATTICE_POINT: u64 = 108 + 288 + 16 + 124;

impl Plan {
    /// Derives the plan.
    ///
    /// # Errors
    /// More probes or cells than can be solved and stored; media in a build without the feature `media`.
    pub fn derive(
        tracer: &Tracer,
        air: &Air,
        settings: &Settings,
        atlas: &Atlas,
        threads: usize,
    ) -> Result<Self, SettingsError> {
        let scene = tracer.scene();
        if cfg!(not(feature = "media")) && !air.is_empty() {
            let allowed = "none in this program: it was built without the feature `media`".into();
            return Err(SettingsError::OutOfRange { key: "media".into(), value: air.names.join(", "), allowed });
        }
        // What is too little to matter in this air may matter in the next.
        let everything = Settings { tolerance: 0.0, ..settings.clone() };
        let settings = if settings.keep_paths { &everything } else { settings };
        let lattices = Lattices::lay_out(scene, air, settings)?;
        let texels = atlas.pages.iter().map(|page| page.texels.len()).sum();
        let size = AtlasSize {
            pages: atlas.pages.iter().map(|page| [page.width, page.height]).collect(),
            texels,
            charts: atlas.layouts.iter().map(|layout| layout.charts).sum(),
        };
        let mut cost = cost(scene, settings, atlas, texels + lattices.points() as usize, threads);
        cost.memory_bytes += lattices.points() * LATTICE_POINT;
        let needs_escaping = settings.keep_paths || !air.is_empty();
        let escaping = if needs_escaping { pilot::escaping(tracer, atlas, settings.seed) } else { 0.0 };
        let kept_paths = kept_paths(settings, &cost, texels, !air.is_empty(), escaping)?;
        cost.memory_bytes += kept_paths.map_or(0, |kept| kept.bytes[1].min(kept_size::MEMORY_BYTES));
        let mut solver = settings.lightmap_settings();
        let budget = Budget::new(scene, air, pilot::median(tracer, &air.media, atlas, &solver));
        let mut effects = effects::derive(scene, air, settings, &budget);
        let simulated = effects::reduce(&effects, air);
        let mode = choose_mode(scene, &simulated, settings, &effects, escaping);
        solver.mode = mode.as_ref().map_or(Mode::Walk, |choice| choice.mode);
        effects.extend(effects::of_solver(mode.as_ref().map(|choice| choice.mode), &simulated, settings, &budget));
        leave_out(&mut solver, &effects);
        Ok(Self {
            effects,
            media: air.summaries(),
            mode,
            simulated,
            solver,
            scene: scene_size(scene, atlas),
            cost,
            kept_paths,
            lattices,
            atlas: size,
        })
    }
}

/// What keeping paths takes, where they are kept.
fn kept_paths(
    settings: &Settings,
    cost: &Cost,
    texels: usize,
    has_air: bool,
    escaping: f64,
) -> Result<Option<KeptPaths>, SettingsError> {
    let bytes = cost.samples.map(|count| kept_size::bytes(count, texels, escaping));
    if settings.keep_paths && bytes[1] > kept_size::MOST_BYTES {
        let way_out = "lower `texels_per_m`, `samples` or the quality";
        return Err(SettingsError::TooLarge {
            key: "keep_paths",
            bytes: bytes[1],
            most: kept_size::MOST_BYTES,
            way_out,
        });
    }
    Ok(settings.keep_paths.then_some(KeptPaths { bytes, noise: kept_size::noise(has_air, escaping) }))
}

/// The solver for the air that is left.
fn choose_mode(scene: &Scene, air: &Air, settings: &Settings, effects: &[Effect], escaping: f64) -> Option<Choice> {
    let choice = (!air.is_empty()).then(|| Choice::derive(scene, air, settings, escaping))?;
    if matches!(choice.mode, Mode::Tables | Mode::Paper)
        && !settings.keep_paths
        && !effects::is_on(effects, EffectName::Multiple)
    {
        let why = "tables hold all orders of scattering together, and `multiple` is off";
        return Some(Choice::instead(scene, air, Mode::Grid, why, escaping));
    }
    Some(choice)
}

/// Tells the solver what is off and is no matter of the air.
pub(crate) fn leave_out(solver: &mut LightmapSettings, effects: &[Effect]) {
    if !effects::is_on(effects, EffectName::Indirect) {
        solver.bounces = Some(0);
    }
    solver.environment = effects::is_on(effects, EffectName::Environment);
    solver.collisions = if effects::is_on(effects, EffectName::Multiple) { None } else { Some(1) };
    solver.tables.own_plane = effects::is_on(effects, EffectName::OwnPlane);
}

fn scene_size(scene: &Scene, atlas: &Atlas) -> SceneSize {
    let triangles_of = |mesh: u32| scene.meshes[mesh as usize].triangles.len();
    SceneSize {
        meshes: scene.meshes.len(),
        instances: scene.instances.len(),
        lightmapped: atlas.placements.iter().flatten().count(),
        triangles: scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum(),
        instanced_triangles: scene.instances.iter().map(|instance| triangles_of(instance.mesh)).sum(),
        materials: scene.materials.len(),
        lights: scene.lights.len(),
        bounds: scene.bounds(),
    }
}

fn cost(scene: &Scene, settings: &Settings, atlas: &Atlas, texels: usize, threads: usize) -> Cost {
    let solver = settings.lightmap_settings();
    let (floor, cap) = (solver.min_samples, solver.max_samples);
    let usual = (solver.target_error.powi(-2) as u32).clamp(floor, cap);
    let samples = [floor, usual, cap].map(rounds::whole);
    let vertices = settings.bounces.map_or(USUAL_VERTICES, |bounces| (f64::from(bounces) + 1.0).min(USUAL_VERTICES));
    let rays = samples.map(|count| f64::from(count) * texels as f64 * vertices * RAYS_PER_VERTEX);
    let seconds = rays.map(|rays| rays / (RAYS_PER_SECOND * threads.max(1) as f64));
    Cost { samples, rays, seconds, threads, memory_bytes: memory(scene, atlas, settings.sh1) }
}

/// Geometry, trees, images, surface points and buffers at their largest, bytes.
fn memory(scene: &Scene, atlas: &Atlas, sh1: bool) -> u64 {
    /// Position, normal, two texture coordinates and colour.
    const VERTEX: usize = 12 + 12 + 16 + 16;
    /// Indices, and the triangle's copy and its share of nodes in the tree.
    const TRIANGLE: usize = 12 + 36 + 16 + 48;
    /// Terms, variance, samples and validity, twice while seams are stitched.
    const PAGE_TEXEL: usize = 2 * (2 * 12 + 12 + 4 + 1);
    /// Estimates of the solver.
    const COVERED_TEXEL: usize = 256;
    const SH1_TEXEL: usize = 2 * 48;
    const POINT: usize = 64;
    let meshes: usize = scene.meshes.iter().map(|m| m.positions.len() * VERTEX + m.triangles.len() * TRIANGLE).sum();
    let images: usize = scene.images.iter().map(|image| image.rgba.len() * 4).sum();
    let per_texel = PAGE_TEXEL + if sh1 { SH1_TEXEL } else { 0 };
    let pages: usize = atlas
        .pages
        .iter()
        .map(|page| {
            let area = page.width as usize * page.height as usize;
            area * per_texel + page.texels.len() * COVERED_TEXEL + page.points.len() * POINT
        })
        .sum();
    (meshes + images + pages) as u64
}

#[cfg(all(test, feature = "media"))]
mod tests;
