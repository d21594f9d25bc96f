//! What every bake begins with: the scene loaded, judged and laid out, with the warnings on the way.

use crate::air::{self, Air, AirError};
use crate::atlas::{self, Atlas, AtlasError, AtlasWarning};
use crate::progress::{Interrupted, Progress};
use crate::scene::{self, LoadError, Scene};
use crate::settings::{Settings, SettingsError, suggest};
use std::path::{Path, PathBuf};
use std::time::Instant;
use thiserror::Error;

/// A scene that is ready to be baked.
pub struct Job {
    /// Everything that was set.
    pub settings: Settings,
    /// The checked scene.
    pub scene: Scene,
    /// The air in it.
    pub air: Air,
    /// Its layout.
    pub atlas: Atlas,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Wall-clock seconds of each stage.
    pub seconds: Vec<(&'static str, f64)>,
}

/// Why a scene cannot be baked.
#[derive(Debug, Error)]
pub enum JobError {
    /// The scene file.
    #[error(transparent)]
    Scene(#[from] LoadError),
    /// A setting.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The air.
    #[error(transparent)]
    Air(#[from] AirError),
    /// The layout.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
    /// No instance takes a lightmap.
    #[error("nothing in {} takes a lightmap", file.display())]
    NothingToBake {
        /// The scene file.
        file: PathBuf,
    },
    /// Stopped from outside.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl Job {
    /// Loads and lays out.
    ///
    /// # Errors
    /// Whatever is invalid, by name; [`JobError::Interrupted`] when the progress asks to stop.
    pub fn prepare(file: &Path, mut settings: Settings, progress: &dyn Progress) -> Result<Self, JobError> {
        let mut seconds = Vec::new();
        progress.stage("load", 0);
        let (mut scene, notes) = timed(&mut seconds, "load", || scene::load(file, &settings.load_options()))?;
        let mut warnings: Vec<String> = notes.iter().map(ToString::to_string).collect();
        let unused = settings.choose_lightmapped(&mut scene);
        warnings.extend(unused.iter().map(|key| unknown_node(key, &scene)));
        settings.adopt_media(&scene)?;
        let (air, notes) = timed(&mut seconds, "air", || air::resolve(&settings, &mut scene))?;
        warnings.extend(notes.iter().map(ToString::to_string));
        stop_if_cancelled(progress)?;
        if !scene.instances.iter().any(|instance| instance.lightmapped) {
            return Err(JobError::NothingToBake { file: file.to_owned() });
        }
        progress.stage("atlas", 0);
        let (atlas, notes) = timed(&mut seconds, "atlas", || atlas::build(&scene, &settings.atlas_settings()))?;
        let already_told = |note: &AtlasWarning| matches!(note, AtlasWarning::UnknownNode { .. });
        warnings.extend(notes.iter().filter(|note| !already_told(note)).map(ToString::to_string));
        stop_if_cancelled(progress)?;
        Ok(Self { settings, scene, air, atlas, warnings, seconds })
    }
}

fn timed<T>(seconds: &mut Vec<(&'static str, f64)>, name: &'static str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    seconds.push((name, start.elapsed().as_secs_f64()));
    result
}

fn stop_if_cancelled(progress: &dyn Progress) -> Result<(), Interrupted> {
    if progress.is_cancelled() { Err(Interrupted) } else { Ok(()) }
}

fn unknown_node(key: &str, scene: &Scene) -> String {
    let names: Vec<&str> = scene.instances.iter().flat_map(|instance| instance.path.split('/')).collect();
    let hint = suggest(key, &names);
    let hint = if hint.starts_with("did you mean") { format!("; {hint}") } else { String::new() };
    format!("the settings name the node `{key}`, which carries no mesh{hint}")
}
