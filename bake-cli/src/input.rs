//! What `run`, `plan`, `reference` and `study` work on: a scene file, and its settings from the side file and the flags.

use crate::exit::Failure;
use crate::flags::SettingsFlags;
use bake_core::settings::{self, Mode, Settings};
use std::path::{Path, PathBuf};

/// The usage line names the only argument; it has no list of its own.
pub const HELP_TEMPLATE: &str = "{about}\n\n{usage-heading} {usage}\n\n{all-args}{after-help}";

/// The flags that name it.
#[derive(Debug, Clone, clap::Args)]
pub struct Input {
    /// The scene: a .glb or .gltf file
    #[arg(value_name = "SCENE", hide = true)]
    pub file: PathBuf,
    /// Settings file [default: SCENE.bake.ron beside the scene, if there is one]
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    #[command(flatten)]
    flags: SettingsFlags,
}

impl Input {
    /// The settings, judged.
    pub fn settings(&self) -> Result<Settings, Failure> {
        check_scene_file(&self.file)?;
        let side_file = settings::sidecar(&self.file);
        let file = self.settings.clone().or_else(|| side_file.exists().then_some(side_file));
        let mut settings = file.as_deref().map(settings::read).transpose()?.unwrap_or_default();
        self.flags.apply(&mut settings);
        settings.check()?;
        Ok(settings)
    }

    /// The same input with light in the air solved by walks, whatever a settings file says.
    ///
    /// # Errors
    /// A flag asks for another mode.
    pub fn by_walks(mut self) -> Result<Self, Failure> {
        match self.flags.mode.replace(Mode::Walk) {
            None | Some(Mode::Walk) => Ok(self),
            Some(_) => Err(Failure::wrong(
                "`bake reference` solves by walks alone: --mode asks for something else",
                "leave `--mode` out, or use `bake run`",
            )),
        }
    }
}

/// Refuses what is plainly no scene file, before anything is read of it.
pub fn check_scene_file(scene: &Path) -> Result<(), Failure> {
    let path = scene.display();
    match std::fs::metadata(scene) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Err(Failure::wrong(format!("the scene {path} does not exist"), neighbours(scene)))
        }
        Err(error) => Err(Failure::wrong(format!("cannot read the scene {path}: {error}"), "check its permissions")),
        Ok(data) if data.is_dir() => {
            Err(Failure::wrong(format!("the scene {path} is a folder"), neighbours(&scene.join("scene.glb"))))
        }
        Ok(_) => match scene.extension().map(|extension| extension.to_string_lossy().to_lowercase()) {
            Some(extension) if ["glb", "gltf"].contains(&extension.as_str()) => Ok(()),
            _ => Err(Failure::wrong(
                format!("the scene {path} is no .glb or .gltf file"),
                "export the scene as glTF 2.0 (.glb or .gltf)",
            )),
        },
    }
}

/// Names the scenes that lie where one was expected.
fn neighbours(scene: &Path) -> String {
    const SHOWN: usize = 5;
    let folder = scene.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "glb" || extension == "gltf");
    let Ok(entries) = std::fs::read_dir(folder) else {
        return format!("the folder {} cannot be read; check the path", folder.display());
    };
    let mut scenes: Vec<_> = entries.flatten().map(|entry| entry.path()).filter(is_scene).collect();
    scenes.sort();
    if scenes.is_empty() {
        return format!("the folder {} holds no .glb or .gltf file", folder.display());
    }
    let names: Vec<_> = scenes.iter().take(SHOWN).map(|path| path.display().to_string()).collect();
    let more = if scenes.len() > SHOWN { format!(" and {} more", scenes.len() - SHOWN) } else { String::new() };
    format!("scenes there: {}{more}", names.join(", "))
}
