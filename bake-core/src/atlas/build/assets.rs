//! Atlases of scenes that nobody of the project made. Skipped, and counted, where they are not beside the project.

use super::tests::{built, crossing_lookups};
use super::*;
use crate::scene::{LoadOptions, load};

/// Builds an asset's atlas on one page, checks the laws, prints its numbers.
fn on_one_page(file: &str, page_size: u32, texels_per_m: f32) -> Option<(Atlas, Vec<AtlasWarning>)> {
    let path = testkit::reference::shared(&format!("assets/{file}"))?;
    let (scene, _) = load(&path, &LoadOptions { require_light: false, ..LoadOptions::default() }).expect("loads");
    let settings = AtlasSettings { page_size, max_pages: Some(1), texels_per_m, ..AtlasSettings::default() };
    let (atlas, warnings) = built(&scene, &settings);
    let triangles: usize = atlas.layouts.iter().map(|l| l.triangles.len()).sum();
    let charts: u32 = atlas.layouts.iter().map(|l| l.charts).sum();
    let page = &atlas.pages[0];
    let covered = page.texels.len() as f32 / (page.width * page.height) as f32;
    println!("{file}: {triangles} triangles, {charts} charts, {}×{}, {covered:.2} covered", page.width, page.height);
    warnings.iter().for_each(|warning| println!("  {warning}"));
    Some((atlas, warnings))
}

fn rejected(warnings: &[AtlasWarning]) -> usize {
    warnings.iter().filter(|w| matches!(w, AtlasWarning::OwnUvRejected { .. })).count()
}

/// The house is small in its units: at 16 texels per metre its own charts share texels, and it is unwrapped; on a page
/// filled by it they hold.
#[test]
fn a_house_keeps_its_lightmap_coordinates_where_the_density_suffices() {
    let Some((atlas, warnings)) = on_one_page("playcanvas-house/house.glb", 1024, 16.0) else { return };
    assert_eq!(rejected(&warnings), 2, "{warnings:?}");
    assert_eq!(crossing_lookups(&atlas, 4), 0);
    let Some((_, warnings)) = on_one_page("playcanvas-house/house.glb", 2048, 1e4) else { return };
    assert_eq!(rejected(&warnings), 0, "{warnings:?}");
}

#[test]
fn a_cornell_box_keeps_its_lightmap_coordinates() {
    let Some((atlas, warnings)) = on_one_page("bevy-CornellBox/CornellBox.glb", 256, 16.0) else { return };
    assert_eq!(rejected(&warnings), 0, "{warnings:?}");
    assert_eq!(crossing_lookups(&atlas, 100), 0);
}

#[test]
fn rooms_without_lightmap_coordinates() {
    let mut rooms = vec![("webxr-garage/garage.gltf", 512), ("godot-living_room/living_room.glb", 512)];
    if std::env::var("BAKE_LONG").as_deref() == Ok("1") {
        rooms.push(("godot-room/room.glb", 1024));
    }
    for (file, page_size) in rooms {
        let Some((atlas, warnings)) = on_one_page(file, page_size, 16.0) else { return };
        assert!(!warnings.iter().any(|w| matches!(w, AtlasWarning::UnwrapFallback { .. })), "{warnings:?}");
        assert_eq!(crossing_lookups(&atlas, 1), 0, "{file}");
    }
}
