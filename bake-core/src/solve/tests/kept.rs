//! Kept paths folded with other air against bakes of that air.

use super::fog::{courtyard, courtyard_air, room, sun, uniform, unit_box};
use super::*;
use crate::solve::kept::{self, KeptError};
use crate::solve::kept_size;
use bake_formats::path_file::{PathReader, PathWriter};
use bake_optics::medium::{Density, Medium, Scatter};
use bake_optics::phase::Phase;
use std::path::Path;

fn settings(samples: u32, seed: u32) -> LightmapSettings {
    let tables = Effort { stations: 512, rays: 64, ..Effort::default() };
    let [min_samples, max_samples] = [samples; 2];
    LightmapSettings { min_samples, max_samples, seed, mode: Mode::Tables, tables, ..Default::default() }
}

fn keep(scene: &Scene, air: &MediumSet, settings: &LightmapSettings) -> (Lightmap, Vec<u8>) {
    let begin = |header: &_| PathWriter::new(Path::new("test"), Vec::new(), header);
    kept::keep(&Tracer::new(scene), air, &quad_atlas(SIZE), settings, &Silent, begin).expect("kept")
}

fn fold(scene: &Scene, air: &MediumSet, settings: &LightmapSettings, file: &[u8]) -> Result<Lightmap, KeptError> {
    let open = |header: &_| PathReader::new(Path::new("test"), file, header);
    kept::fold(&Tracer::new(scene), air, &quad_atlas(SIZE), settings, &Silent, open)
}

fn bake(scene: &Scene, air: &MediumSet, settings: &LightmapSettings) -> Lightmap {
    lightmap(&Tracer::new(scene), air, &quad_atlas(SIZE), settings, &Silent).expect("baked")
}

/// Mean of a page's total per channel with its standard error.
fn mean(lightmap: &Lightmap) -> (Vec3, Vec3) {
    let page = &lightmap.pages[0];
    let count = page.variance.len();
    let total: Vec3 = (0..count).map(|at| page.total(at)).sum();
    let variance: Vec3 = page.variance.iter().sum();
    (total / count as f32, (variance / (count * count) as f32).map(f32::sqrt))
}

/// Largest distance of two pages' means in any channel, and of that what four standard errors do not explain.
fn distance(a: &Lightmap, b: &Lightmap) -> (f32, f32) {
    let ((a, noise_a), (b, noise_b)) = (mean(a), mean(b));
    let relative = ((a - b) / b).abs();
    let noise = 4.0 * (noise_a * noise_a + noise_b * noise_b).map(f32::sqrt) / b;
    (relative.max_element(), (relative - noise).max_element())
}

/// A room with a lamp, a glowing wall and coloured walls.
fn lit_room() -> Scene {
    let mut scene = room([0.3, 0.7, 0.5, 0.5, 0.4, 0.6]);
    scene.materials[0].base_color = glam::Vec4::new(0.7, 0.1, 0.2, 1.0);
    scene.materials[1].emission = Vec3::new(0.2, 0.1, 0.4);
    scene.lights = vec![point_light(Vec3::new(0.45, 0.4, 0.7), 1.0)];
    scene
}

/// The courtyard with its ground as the surface that takes texels.
fn open_scene() -> Scene {
    let mut scene = courtyard();
    scene.meshes[0] = quad(Vec3::new(-10.0, -10.0, 0.0), Vec3::X * 20.0, Vec3::Y * 20.0, 0);
    scene.lights = vec![sun(4.0, Vec3::new(-0.6, -0.35, 0.7)), point_light(Vec3::new(0.5, 0.5, 1.5), 30.0)];
    scene.environment =
        Some(Environment { width: 1, height: 1, radiance: vec![Vec3::new(0.3, 0.4, 0.6)], rotation: 0.0 });
    scene
}

/// A room whose ceiling takes texels around a panel in it: every leg between them runs along the border of the air.
fn panelled_room() -> Scene {
    let mut scene = room([0.3, 0.7, 0.5, 0.5, 0.4, 0.6]);
    scene.meshes.swap(0, 5);
    scene.materials.push(crate::scene::Material { emission: Vec3::new(10.0, 8.0, 5.0), ..matte(0.6) });
    scene.meshes.push(quad(Vec3::new(0.35, 0.35, 0.99999), Vec3::Y * 0.3, Vec3::X * 0.3, 6));
    scene.instances.push(crate::test_scenes::instance(6, glam::Affine3A::IDENTITY));
    scene
}

/// The wrong twin of each is the page of the air that the paths were kept with.
#[test]
fn kept_paths_with_other_air_are_a_bake_of_that_air() {
    let haze = uniform(unit_box(), 0.5, 0.9, Phase::Isotropic);
    let mut smoke = uniform(unit_box(), 2.0, 0.8, Phase::HenyeyGreenstein { g: 0.4 });
    smoke.media[0].scatter = Scatter { sigma_s: [1.5, 1.0, 0.5], sigma_a: [0.1, 0.2, 0.3] };
    let mut layer = courtyard_air();
    layer.media[0].density = Density::Exponential { base_m: 0.0, scale_height_m: 2.0 };
    layer.media[0].phase = Phase::Isotropic;
    let thick = MediumSet { media: vec![layer.media[0].clone(), Medium { ..courtyard_air().media[0].clone() }] };
    let none = MediumSet::default();
    for (name, scene, (kept_with, folded_with), seed) in [
        ("room, without air then smoke", lit_room(), (&none, &smoke), 2),
        ("room, haze then smoke", lit_room(), (&haze, &smoke), 2),
        // The panel's factor, measured beside it, is 12 % another with another seed: only its own tells the fold.
        ("ceiling with a panel, haze then smoke", panelled_room(), (&haze, &smoke), 1),
        ("open, without air then fog", open_scene(), (&none, &courtyard_air()), 2),
        ("open, fog then two media", open_scene(), (&courtyard_air(), &thick), 2),
    ] {
        let (old, file) = keep(&scene, kept_with, &settings(256, 1));
        let folded = fold(&scene, folded_with, &settings(256, 1), &file).expect("folded");
        let baked = bake(&scene, folded_with, &settings(256, seed));
        let (all, beyond) = distance(&folded, &baked);
        let (twin, twin_beyond) = distance(&old, &baked);
        let per_path = file.len() as f64 / f64::from(256 * SIZE * SIZE);
        let noise = folded.reports[0].error / baked.reports[0].error;
        println!(
            "{name}: folded {:.2} % off, kept {:.1} % off, {noise:.2} times the noise, {per_path:.0} bytes a sample",
            100.0 * all,
            100.0 * twin
        );
        // Alone, the few that are kept have four times the noise of all in rooms and twice that in the open, where paths that
        // were drawn without air have 2.4 times that of a bake.
        let escaping = if name.contains("open") { 0.6 } else { 0.0 };
        let most = kept_size::noise(!kept_with.media.is_empty(), escaping) as f32;
        assert!(noise < most, "{name}: {noise}");
        assert!(beyond < 0.01, "{name}: {all}");
        assert!(twin_beyond > 0.01, "{name}: the kept air's page is told apart");
        assert_eq!(folded.reports[0].samples, 256);
    }
}

#[test]
fn kept_paths_with_their_own_air_are_the_same_bake() {
    let haze = uniform(unit_box(), 1.0, 0.8, Phase::Isotropic);
    for (name, scene, air) in [
        ("room", lit_room(), haze.clone()),
        ("ceiling with a panel", panelled_room(), haze),
        ("courtyard", open_scene(), courtyard_air()),
    ] {
        let (baked, file) = keep(&scene, &air, &settings(128, 1));
        let folded = fold(&scene, &air, &settings(128, 1), &file).expect("folded");
        // Strengths are rounded by up to 0.4 % at random, and texels sum tens to hundreds of them.
        let mut worst = Worst::new(format!("{name} folded with the same air, relative by texel"), 5.7e-3);
        let (a, b) = (&folded.pages[0], &baked.pages[0]);
        for at in 0..(SIZE * SIZE) as usize {
            let (got, want) = (a.total(at), b.total(at));
            // Buried texels hold nothing.
            let relative = (got - want) / want.max(Vec3::splat(1e-6));
            worst.record(f64::from(relative.abs().max_element()), || format!("{at}: {got} {want}"));
        }
        worst.check();
        assert_eq!(a.validity, b.validity);
        let again = bake(&scene, &air, &settings(128, 1));
        assert_eq!(again.pages[0].terms[1].irradiance.len(), a.terms[1].irradiance.len());
        // Kept paths are longer ones.
        let (off, beyond) = distance(&baked, &again);
        println!("{name}: kept {:.2} % beside a bake that keeps none", 100.0 * off);
        assert!(beyond < 0.0, "keeping paths changes no light: {name}: {off}");
    }
}

#[test]
fn damaged_and_foreign_files_are_refused_with_the_reason() {
    let (scene, air) = (lit_room(), uniform(unit_box(), 1.0, 0.8, Phase::Isotropic));
    let (_, file) = keep(&scene, &air, &settings(16, 1));
    let fault = |bytes: &[u8]| fold(&scene, &air, &settings(16, 1), bytes).expect_err("refused").to_string();
    assert!(fault(&file[..file.len() / 2]).contains("ends within"), "cut in the middle");
    assert!(fault(&file[..file.len() - 1]).contains("ends within"), "the last byte is missing");
    let mut flipped = file.clone();
    flipped[file.len() / 2] ^= 4;
    assert!(fault(&flipped).contains("damaged paths file"), "{}", fault(&flipped));
    let mut fewer = lit_room();
    fewer.lights.clear();
    fewer.materials[1].emission = Vec3::ZERO;
    let other = fold(&fewer, &air, &settings(16, 1), &file).expect_err("another scene").to_string();
    assert!(other.contains("an emitter that the scene has not"), "{other}");
}

#[test]
fn the_file_does_not_depend_on_threads() {
    let (scene, air) = (lit_room(), uniform(unit_box(), 1.0, 0.8, Phase::Isotropic));
    let file = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| keep(&scene, &air, &settings(16, 1)).1)
    };
    assert_eq!(file(1), file(3));
}
