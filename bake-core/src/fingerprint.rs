//! What a package remembers of its settings: the same wherever the bake ran. The scene's hash is [`crate::scene::Scene::blake3`].

use crate::settings::Settings;
use serde_json::Value;
use std::io;
use std::path::Path;

/// The settings as they stand in a package: the same wherever the bake ran. A file is told by its name and the BLAKE3
/// of its bytes.
///
/// # Errors
/// A file cannot be read.
pub fn settings(settings: &Settings) -> io::Result<Value> {
    let mut settings = settings.clone();
    for file in settings.files_mut() {
        let hash = blake3::hash(&std::fs::read(&*file)?).to_hex();
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        *file = format!("{name}#{hash}").into();
    }
    // By way of text: 0.1 stays 0.1, where a direct conversion shows the digits of its 32-bit neighbour.
    let text = serde_json::to_string(&settings).expect("plain data becomes JSON");
    Ok(serde_json::from_str(&text).expect("what was written is JSON"))
}

/// Finds the files of settings that come from a package in `folder`, by name and content.
///
/// # Errors
/// The name of a file that is not there, or has changed.
pub fn find_files(settings: &mut Settings, folder: &Path) -> Result<(), String> {
    for file in settings.files_mut() {
        let told = file.to_string_lossy().into_owned();
        let (name, hash) = told.rsplit_once('#').unwrap_or((&told, ""));
        let place = folder.join(name);
        let found = std::fs::read(&place).is_ok_and(|bytes| blake3::hash(&bytes).to_hex().as_str() == hash);
        if !found {
            return Err(name.to_owned());
        }
        *file = place;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Env;

    #[test]
    fn files_are_told_by_content_and_not_by_place() {
        let record = |folder: &Path, content: &str| {
            let file = folder.join("sky.hdr");
            std::fs::write(&file, content).expect("written");
            let env = Some(Env { file, rotation_deg: 0.1, scale: 1.0 });
            settings(&Settings { env, ..Settings::default() }).expect("readable")
        };
        let (a, b) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
        assert_eq!(record(a.path(), "one"), record(b.path(), "one"));
        assert_ne!(record(a.path(), "one"), record(b.path(), "two"));
        assert_eq!(record(a.path(), "one")["env"]["rotation_deg"].to_string(), "0.1");

        let again: Settings = serde_json::from_value(record(a.path(), "one")).expect("settings");
        let find = |folder: &Path| find_files(&mut again.clone(), folder);
        assert_eq!(find(a.path()), Ok(()));
        assert_eq!(find(b.path()), Err("sky.hdr".to_owned()), "another content");
        assert_eq!(find(&a.path().join("none")), Err("sky.hdr".to_owned()));
    }
}
