//! `bake init`: a commented settings file beside a scene.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::input::check_scene_file;
use crate::output;
use bake_core::settings::{TEMPLATE, sidecar};
use std::path::PathBuf;

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
    output::write_so(&file, TEMPLATE.as_bytes(), "copy the scene to another place")?;
    if global.json {
        console::print_line(&serde_json::json!({ "settings": file }).to_string())?;
    } else if !global.quiet {
        console::print_line(&format!("wrote {}", file.display()))?;
    }
    Ok(Outcome::Done)
}
