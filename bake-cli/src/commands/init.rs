//! `bake init`: a commented settings file beside a scene.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::input::check_scene_file;
use bake_core::settings::{TEMPLATE, sidecar};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Flags of `bake init`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene: a .glb or .gltf file
    pub scene: PathBuf,
    /// Replace a settings file that is there
    #[arg(long)]
    pub force: bool,
}

/// Writes the file.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    check_scene_file(&args.scene)?;
    let file = sidecar(&args.scene);
    if file.exists() && !args.force {
        let text = format!("the settings file {} is there already", file.display());
        return Err(Failure::wrong(text, "edit it, or replace it with `--force`"));
    }
    write_whole(&file, TEMPLATE).map_err(|error| Failure::unwritable(&file, error))?;
    if global.json {
        console::print_line(&serde_json::json!({ "settings": file }).to_string())?;
    } else if !global.quiet {
        console::print_line(&format!("wrote {}", file.display()))?;
    }
    Ok(Outcome::Done)
}

/// Writes a file that is whole or not there.
fn write_whole(file: &Path, text: &str) -> std::io::Result<()> {
    let folder = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut temporary = tempfile::NamedTempFile::new_in(folder)?;
    temporary.write_all(text.as_bytes())?;
    temporary.as_file().sync_all()?;
    temporary.persist(file)?;
    Ok(())
}
