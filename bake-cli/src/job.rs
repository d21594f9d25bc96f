//! What `run` and `plan` share: the scene loaded, judged and laid out, with the warnings on the way.

use crate::commands::later;
use crate::exit::Failure;
use crate::input::Input;
use crate::progress::Progress;
use crate::report::Stopwatch;
use bake_core::air::{self, Air, AirError};
use bake_core::atlas::{self, Atlas, AtlasError};
use bake_core::progress::Progress as _;
use bake_core::scene::{self, Scene};
use bake_core::settings::{Settings, suggest};

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
}

impl Job {
    /// Loads and lays out; warnings go to `progress` at once unless it is quiet.
    pub fn prepare(input: &Input, progress: &Progress, stopwatch: &mut Stopwatch) -> Result<Self, Failure> {
        let mut settings = input.settings()?;
        refuse_later(&settings)?;
        progress.stage("load", 0);
        let loaded = stopwatch.time("load", || scene::load(&input.file, &settings.load_options()));
        let (mut scene, warnings) = loaded.map_err(Failure::invalid)?;
        let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let unused = settings.choose_lightmapped(&mut scene);
        warnings.extend(unused.iter().map(|key| unknown_node(key, &scene)));
        settings.adopt_media(&scene)?;
        let (air, notes) = stopwatch.time("air", || air::resolve(&settings, &mut scene))?;
        warnings.extend(notes.iter().map(ToString::to_string));
        stop_if_interrupted(progress)?;

        if !scene.instances.iter().any(|instance| instance.lightmapped) {
            let text = format!("nothing in {} takes a lightmap", input.file.display());
            let help =
                "give some to nodes with `--nodes NAME:lightmap=true`, or to GPU instances with `--bake-instanced`";
            return Err(Failure::wrong(text, help));
        }
        progress.stage("atlas", 0);
        let built = stopwatch.time("atlas", || atlas::build(&scene, &settings.atlas_settings()));
        let (atlas, notes) = built.map_err(Failure::from)?;
        let already_told = |note: &atlas::AtlasWarning| matches!(note, atlas::AtlasWarning::UnknownNode { .. });
        warnings.extend(notes.iter().filter(|note| !already_told(note)).map(ToString::to_string));
        stop_if_interrupted(progress)?;
        Ok(Self { settings, scene, air, atlas, warnings })
    }
}

impl From<AirError> for Failure {
    fn from(error: AirError) -> Self {
        match error {
            AirError::Settings(error) => error.into(),
            error => Self::invalid(error),
        }
    }
}

impl From<AtlasError> for Failure {
    fn from(error: AtlasError) -> Self {
        Self::invalid(error)
    }
}

/// Ends the command where Ctrl-C was pressed.
pub fn stop_if_interrupted(progress: &Progress) -> Result<(), Failure> {
    if progress.is_cancelled() { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Settings that are understood, and whose effect is not built.
fn refuse_later(settings: &Settings) -> Result<(), Failure> {
    if settings.time_budget.is_some() {
        return Err(later::refuse("`--time-budget`"));
    }
    Ok(())
}

fn unknown_node(key: &str, scene: &Scene) -> String {
    let names: Vec<&str> = scene.instances.iter().flat_map(|instance| instance.path.split('/')).collect();
    let hint = suggest(key, &names);
    let hint = if hint.starts_with("did you mean") { format!("; {hint}") } else { String::new() };
    format!("the settings name the node `{key}`, which carries no mesh{hint}")
}
