//! Solves a scene's lightmap and nothing else: `solve SCENE TEXELS_PER_M SAMPLES`, for counting what a solve costs
//! on one thread.

use bake_core::progress::Silent;
use bake_core::scene::{LoadOptions, load};
use bake_core::solve::{self, LightmapSettings};
use bake_core::trace::Tracer;
use bake_core::{atlas, settings::Settings};
use bake_optics::medium::MediumSet;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, texels_per_m, samples] = &arguments[..] else {
        return Err("usage: solve SCENE TEXELS_PER_M SAMPLES".into());
    };
    let (scene, _) = load(Path::new(scene), &LoadOptions::default())?;
    let settings =
        Settings { texels_per_m: texels_per_m.parse()?, samples: Some(samples.parse()?), ..Settings::default() };
    let (atlas, _) = atlas::build(&scene, &settings.atlas_settings())?;
    let tracer = Tracer::new(&scene);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let lightmap = pool.install(|| solve_alone(&tracer, &atlas, &settings.lightmap_settings()));
    println!("{} rays, {} shadow rays", lightmap.rays, lightmap.shadow_rays);
    Ok(())
}

/// What is counted: found by its name in the profile.
#[inline(never)]
fn solve_alone(tracer: &Tracer, atlas: &atlas::Atlas, settings: &LightmapSettings) -> solve::Lightmap {
    solve::lightmap(tracer, &MediumSet::default(), atlas, settings, &Silent).expect("nobody interrupts")
}
