//! Small pictures of a measured point: its first page as it looks, and where it is wrong.

use crate::error::StudyError;
use crate::measure::Page;
use crate::store::Store;
use bake_core::package::thumbnail;
use bake_core::solve::buffers::PageBuffers;
use bake_formats::diff::false_color;
use bake_formats::package::write_atomic;
use base64::Engine;
use std::io::Write;

/// Longest side of the picture, texels.
const SIDE: u32 = 192;

/// Writes both pictures of the point `key`.
///
/// # Errors
/// A file cannot be written.
pub fn write(store: &Store, key: &str, page: &PageBuffers, truth: &Page) -> Result<(), StudyError> {
    let folder = store.file("thumbnails");
    std::fs::create_dir_all(&folder).map_err(StudyError::io(&folder))?;
    let errors = Page::from(page).relative_errors(truth);
    let pictures = [thumbnail(page, SIDE), false_color(page.width, page.height, &errors)];
    for (png, name) in pictures.iter().zip(names(key)) {
        write_atomic(&store.file(&name), |out| out.write_all(png))?;
    }
    Ok(())
}

/// Both pictures of a point as data URIs, where they were written.
pub fn embedded(store: &Store, key: &str) -> Option<[String; 2]> {
    let [picture, error] = names(key).map(|name| {
        let png = std::fs::read(store.file(&name)).ok()?;
        Some(format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png)))
    });
    Some([picture?, error?])
}

fn names(key: &str) -> [String; 2] {
    [format!("thumbnails/{key}.png"), format!("thumbnails/{key}.error.png")]
}
