//! Draws where each formula keeps its digits: `cargo run --release -p bake-optics --example stability` writes `docs/stability.md`
//! and one picture per formula under `docs/stability/`.
//!
//! A formula joins by one file in `maps/` and one line in `maps/mod.rs`.

mod map;
mod maps;
mod picture;
mod report;

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let folder = docs.join("stability");
    std::fs::create_dir_all(&folder)?;
    let mut measured = Vec::new();
    for map in maps::all() {
        let result = map.measure();
        let file = folder.join(format!("{}.svg", map.name));
        picture::draw(&file, &map, &result)?;
        let bytes = std::fs::metadata(&file)?.len();
        println!("{}: {bytes} bytes", map.name);
        assert!(
            bytes < picture::LARGEST,
            "{} is {bytes} bytes, allowed {}; use fewer cells",
            map.name,
            picture::LARGEST
        );
        measured.push((map, result));
    }
    std::fs::write(docs.join("stability.md"), report::markdown(&measured))?;
    Ok(())
}
