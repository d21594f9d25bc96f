//! Scenes that nobody of the project made, with committed settings (`scenes/real`). Skipped, and counted, where the
//! assets are not beside the project.
//!
//! Each is baked as set, and again with twice the samples, all others: its light must be the same. A texel is valid when it
//! was baked, or lies buried in other geometry and was filled from its neighbours. The normal run takes three of them
//! on small pages, the long form all on pages of their settings.

use bake_core::atlas::{self, Atlas};
use bake_core::post::{self, SeamScore};
use bake_core::scene::{self, Scene};
use bake_core::settings;
use bake_core::solve::buffers::{PageBuffers, TermImage, Validity};
use bake_formats::Term;
use bake_formats::metrics::{FLOOR, luminance};
use bake_formats::sample::LightmapPage;
use bake_tests::ledger::Ledger;
use bake_tests::program::Baked;
use glam::Vec3;
use std::path::Path;
use testkit::reference::{shared, workspace};

use crate::leaks;

/// Least share of texels with a value.
const VALID: f64 = 0.99;
/// Largest relative difference of mean and percentiles from the longer bake.
const STEADY: f64 = 0.05;
/// Largest mean relative step across seams that are meant as smooth.
const SEAM: f64 = 0.05;
/// Largest mean direct light where no emitter reaches, as a share of the mean.
const LEAK: f64 = 0.05;
/// Largest angle between normals on both sides of such a seam, degrees; the program's own.
const SMOOTH_ANGLE: f32 = 15.0;

/// An asset: its folder, which names its settings; its file; page size and samples of the normal run.
struct Asset {
    name: &'static str,
    file: &'static str,
    small: Option<[u32; 2]>,
}

const ASSETS: [Asset; 7] = [
    Asset { name: "bevy-CornellBox", file: "CornellBox.glb", small: Some([64, 256]) },
    Asset { name: "LightsPunctualLamp", file: "LightsPunctualLamp.gltf", small: None },
    Asset { name: "godot-living_room", file: "living_room.glb", small: Some([128, 256]) },
    Asset { name: "playcanvas-house", file: "house.glb", small: None },
    Asset { name: "godot-room", file: "room.glb", small: Some([96, 128]) },
    Asset { name: "webxr-garage", file: "garage.gltf", small: None },
    Asset { name: "DiffuseTransmissionPlant", file: "DiffuseTransmissionPlant.glb", small: None },
];

#[test]
fn small_pages() {
    for asset in &ASSETS {
        if let Some([page_size, samples]) = asset.small {
            check(asset, "small pages", &format!("--page-size {page_size}"), &format!("--samples {samples}"));
        }
    }
}

#[test]
fn pages_as_set() {
    if bake_tests::long() {
        ASSETS.iter().for_each(|asset| check(asset, "as set", "", ""));
    }
}

/// Four thousand triangles placed 1899 times make 7.7 million; memory is that of the four thousand.
#[test]
fn millions_of_instanced_triangles() {
    let Some(scene) = shared("assets/khr-teapots_galore/teapots_galore.gltf") else { return };
    let baked = Baked::new(&scene, "--sky 1000 --page-size 64 --max-pages 1 --samples 8");
    let ledger = Ledger::new("Real scenes", "teapots_galore");
    ledger.note("seconds", baked.number("seconds"));
    ledger.at_most("peak memory, MB", baked.number("peak_memory_bytes") / 1e6, 1000.0);
    ledger.at_least("rays traced", baked.number("rays") + baked.number("shadow_rays"), 1e4);
}

fn check(asset: &Asset, subject: &str, flags: &str, samples: &str) {
    let Some(scene) = shared(&format!("assets/{}/{}", asset.name, asset.file)) else { return };
    let settings = workspace().join(format!("scenes/real/{}.bake.ron", asset.name));
    let flags = format!("--settings {} {flags}", settings.display());
    let baked = Baked::new(&scene, &format!("{flags} {samples}"));
    let ledger = Ledger::new("Real scenes", &format!("{}, {subject}", asset.name));
    ledger.note("seconds", baked.number("seconds"));
    ledger.note("peak memory, MB", baked.number("peak_memory_bytes") / 1e6);
    texels(&ledger, &baked);

    let pages = baked.pages();
    let strange =
        pages.iter().flat_map(|page| &page.total).filter(|value| !value.is_finite() || value.min_element() < 0.0);
    ledger.at_most("texels not finite, or negative", strange.count() as f64, 0.0);
    let (layout_scene, atlas) = layout(&scene, &settings, &flags, &pages);
    ledger.at_most("seam score", seam_score(&layout_scene, &atlas, &pages).mean, SEAM);
    let leaks = leaks::measure(&layout_scene, &baked, &pages);
    ledger.note("points that no emitter reaches", f64::from(leaks.dark_points));
    ledger.at_most("leak score", leaks.score, LEAK);
    if leaks.dark_points > 0 {
        ledger.refused("leak score of the points that emitters reach", leaks.lit_score, LEAK);
    }

    let longer = Baked::new(&scene, &format!("{flags} --seed 1 --samples {}", 2.0 * baked.samples()));
    let longer = longer.pages();
    let (light, longer) = (levels(&pages, &longer), levels(&longer, &longer));
    for (what, of) in STATISTICS {
        let difference = relative(of(&light), of(&longer), &longer);
        ledger.at_most(&format!("{what}: difference from twice the samples"), difference, STEADY);
    }
    let darker: Vec<f64> = longer.iter().map(|level| 0.9 * level).collect();
    let (what, of) = STATISTICS[0];
    let difference = relative(of(&light), of(&darker), &darker);
    ledger.refused(&format!("{what} against a bake 10 % darker"), difference, STEADY);
}

/// Counts good, filled and unbaked texels.
fn texels(ledger: &Ledger, baked: &Baked) {
    let [texels, filled, unbaked] = ["texels", "filled_texels", "unbaked_texels"].map(|key| baked.number(key));
    ledger.note("texels", texels);
    ledger.note("share baked", (texels - filled - unbaked) / texels);
    ledger.note("share buried and filled", filled / texels);
    ledger.at_least("share valid", (texels - unbaked) / texels, VALID);
}

/// |a/b − 1|, b no less than a hundredth of the mean of `levels`, as in the project's relative RMSE.
fn relative(a: f64, b: f64, levels: &[f64]) -> f64 {
    (a - b).abs() / b.max(FLOOR * (STATISTICS[0].1)(levels))
}

type Statistic = (&'static str, fn(&[f64]) -> f64);

/// Of sorted numbers.
const STATISTICS: [Statistic; 3] = [
    ("mean", |levels| levels.iter().sum::<f64>() / levels.len() as f64),
    ("5th percentile", |levels| levels[levels.len() / 20]),
    ("95th percentile", |levels| levels[levels.len() * 19 / 20]),
];

/// Luminance of the baked texels that are not black in `longer`, sorted. The insides of closed furniture are black, and a
/// percentile that falls on their edge says nothing.
fn levels(pages: &[LightmapPage], longer: &[LightmapPage]) -> Vec<f64> {
    let lit = |(page, longer): (&LightmapPage, &LightmapPage)| {
        let is_lit = |&i: &usize| longer.valid[i] && longer.total[i] != Vec3::ZERO;
        (0..page.total.len()).filter(is_lit).map(|i| luminance(page.total[i])).collect::<Vec<_>>()
    };
    let mut levels: Vec<f64> = pages.iter().zip(longer).flat_map(lit).collect();
    assert!(!levels.is_empty(), "no texel was baked");
    levels.sort_by(f64::total_cmp);
    levels
}

/// The scene and layout that the program had, made again.
fn layout(scene: &Path, settings: &Path, flags: &str, pages: &[LightmapPage]) -> (Scene, Atlas) {
    let mut settings = settings::read(settings).expect("committed settings are valid");
    let mut words = flags.split_whitespace().skip_while(|word| *word != "--page-size");
    if let Some(size) = words.nth(1) {
        settings.page_size = size.parse().expect("a page's size is a number");
    }
    let (mut scene, _) = scene::load(scene, &settings.load_options()).expect("what the program baked loads");
    settings.choose_lightmapped(&mut scene);
    let (atlas, _) = atlas::build(&scene, &settings.atlas_settings()).expect("what the program baked has a layout");
    let sizes = atlas.pages.iter().map(|page| (page.width, page.height));
    assert!(sizes.eq(pages.iter().map(|page| (page.width, page.height))), "another layout than the program's");
    (scene, atlas)
}

/// The score of what was written.
fn seam_score(scene: &Scene, atlas: &Atlas, pages: &[LightmapPage]) -> SeamScore {
    let pages: Vec<PageBuffers> = pages.iter().map(buffers).collect();
    post::seam_score(&post::find_seams(scene, atlas, SMOOTH_ANGLE), atlas, &pages)
}

/// A page as the solver holds it, the total as one term. What dilation wrote counts as filled, as it does for readers.
fn buffers(page: &LightmapPage) -> PageBuffers {
    let size = page.total.len();
    let state = |i: usize| match (page.valid[i], page.total[i] == Vec3::ZERO) {
        (true, _) => Validity::Good,
        (false, false) => Validity::Filled,
        (false, true) => Validity::Empty,
    };
    PageBuffers {
        width: page.width,
        height: page.height,
        terms: vec![TermImage { term: Term::Direct, irradiance: page.total.clone() }],
        variance: page.variance.clone(),
        samples: vec![0; size],
        validity: (0..size).map(state).collect(),
        sh1: None,
    }
}
