//! Loads the scenes of the shared collection and checks what is known about them from elsewhere.

use bake_core::scene::{self, LoadOptions, Scene, Warning, WarningKind};
use std::path::Path;
use testkit::reference::shared;

/// Loads an asset that may bring no light of its own.
fn load(path: &Path) -> (Scene, Vec<Warning>) {
    let options = LoadOptions { require_light: false, ..LoadOptions::default() };
    scene::load(path, &options).unwrap_or_else(|error| panic!("{error}"))
}

fn instanced_triangles(scene: &Scene) -> usize {
    scene.instances.iter().map(|i| scene.meshes[i.mesh as usize].triangles.len()).sum()
}

/// Triangles without area that were left out.
fn dropped(warnings: &[Warning]) -> usize {
    let degenerate = warnings.iter().filter(|w| w.kind == WarningKind::DegenerateTriangles);
    degenerate.map(|w| w.count as usize).sum()
}

#[test]
fn triangles_match_the_table_of_the_collection() {
    let Some(assets) = shared("assets") else { return };
    // Counts of the collection's README, made by reading the JSON with another program.
    for (file, triangles) in [
        ("bevy-CornellBox/CornellBox.glb", 36),
        ("bevy-VolumetricFogExample/VolumetricFogExample.glb", 360),
        ("godot-living_room/living_room.glb", 5088),
        ("webxr-garage/garage.gltf", 11358),
        ("playcanvas-house/house.glb", 10497),
        ("godot-room/room.glb", 63720),
        ("LightsPunctualLamp/LightsPunctualLamp.gltf", 6000),
        ("playcanvas-Lights/Lights.glb", 12),
        ("khr-lights_punctual-sample/lights.gltf", 1724),
        ("DiffuseTransmissionPlant/DiffuseTransmissionPlant.glb", 69806),
        ("NegativeScaleTest/NegativeScaleTest.glb", 7724),
        ("SimpleInstancing/SimpleInstancing.glb", 1500),
        ("khr-teapots_galore/teapots_galore.gltf", 7656770),
        ("MeshPrimitiveModes/MeshPrimitiveModes.gltf", 16),
        ("MultipleScenes/MultipleScenes.gltf", 2),
        ("TriangleWithoutIndices/TriangleWithoutIndices.gltf", 1),
        ("Box With Spaces/Box With Spaces.gltf", 12),
        ("Lantern/glTF/Lantern.gltf", 5394),
        ("Lantern/glTF-Draco/Lantern.gltf", 5394),
        ("Lantern/glTF-Quantized/Lantern.gltf", 5394),
        ("draco-box/Box.gltf", 12),
        ("playcanvas-heart_draco/heart_draco.glb", 180),
        ("gltf-transform-BoxMeshopt/BoxMeshopt.glb", 12),
        ("gltf-transform-BoxMeshopt/BoxMeshopt.gltf", 12),
    ] {
        let (scene, warnings) = load(&assets.join(file));
        let kept = instanced_triangles(&scene);
        assert_eq!(kept + dropped(&warnings), triangles, "{file}");
    }
    // Both counted with another program: 3537 triangles of this scene have zero area exactly.
    let (scene, warnings) = load(&assets.join("godot-living_room/living_room.glb"));
    assert_eq!((instanced_triangles(&scene), dropped(&warnings)), (1551, 3537));
}

#[test]
fn missing_textures_are_warned_about_once_each_kind() {
    let Some(path) = shared("assets/Lantern/glTF/Lantern.gltf") else { return };
    let (scene, warnings) = load(&path);
    let missing: Vec<_> = warnings.iter().filter(|w| w.kind == WarningKind::MissingTexture).collect();
    assert_eq!(missing.len(), 1);
    assert!(missing[0].message.contains("Lantern_baseColor.png"), "{}", missing[0]);
    assert!(scene.materials[0].base_color_texture.is_none());
}

#[test]
fn a_scene_without_light_names_the_settings_that_give_one() {
    let Some(path) = shared("assets/playcanvas-house/house.glb") else { return };
    let error = scene::load(&path, &LoadOptions::default()).expect_err("the house is dark");
    assert!(matches!(error.fault, scene::Fault::NoLight));
    for flag in ["--sky", "--sun", "--env", "house.glb"] {
        assert!(error.to_string().contains(flag), "{error}");
    }
    let sky = LoadOptions { sky: Some(glam::Vec3::ONE), ..LoadOptions::default() };
    assert!(scene::load(&path, &sky).is_ok());
    let sun = LoadOptions { sun: Some(scene::Sun::default()), ..LoadOptions::default() };
    assert_eq!(scene::load(&path, &sun).expect("sunlit").0.lights.len(), 1);
}

#[test]
fn raw_intensities_are_warned_about_and_physical_ones_are_not() {
    let Some(assets) = shared("assets") else { return };
    let warns = |file: &str| load(&assets.join(file)).1.iter().any(|w| w.kind == WarningKind::LightUnits);
    assert!(warns("playcanvas-Lights/Lights.glb"));
    assert!(warns("khr-lights_punctual-sample/lights.gltf"), "its sun has 3 lux");
    assert!(!warns("bevy-VolumetricFogExample/VolumetricFogExample.glb"), "its sun has 68 300 lux");
    assert!(!warns("LightsPunctualLamp/LightsPunctualLamp.gltf"), "its lamps have 1.5 to 180 candela");
    let counted = |file: &str| load(&assets.join(file)).1.iter().map(|w| (w.kind, w.count)).collect::<Vec<_>>();
    let all_four = (WarningKind::LightUnits, 4);
    assert!(
        counted("playcanvas-Lights/Lights.glb").contains(&all_four),
        "5, 10 and 10 are Blender's, its sun has 1 lux"
    );
}

#[test]
fn required_strangers_are_refused_by_name() {
    let Some(folder) = shared("assets/asset-generator/Compatibility") else { return };
    let mut refused = Vec::new();
    for i in 0..7 {
        let path = folder.join(format!("Compatibility_{i:02}.gltf"));
        let options = LoadOptions { require_light: false, ..LoadOptions::default() };
        if let Err(error) = scene::load(&path, &options) {
            refused.push((i, error.to_string()));
        }
    }
    // The folder's README: 04 asks for minVersion 2.1, 05 requires an extension that nobody has, the others must load.
    assert_eq!(refused.iter().map(|(i, _)| *i).collect::<Vec<_>>(), [4, 5], "{refused:?}");
    assert!(refused[0].1.contains("asset.minVersion is `2.1`"), "{refused:?}");
    assert!(refused[1].1.contains("FAKE_materials_quantumRendering"), "{refused:?}");
}

#[test]
fn environments_and_profiles_of_the_collection_load() {
    let Some(assets) = shared("assets") else { return };
    let env = scene::Env {
        file: assets.join("hdr-spiaggia_di_mondello_1k/spiaggia_di_mondello_1k.hdr"),
        rotation_deg: 90.0,
        scale: 2.0,
    };
    let profile = scene::Ies { file: assets.join("ies-arnold-a/6.ies"), scale: 1.0 };
    let mut options = LoadOptions { env: Some(env), ..LoadOptions::default() };
    options.ies.insert("nobody".into(), profile);
    let (scene, warnings) =
        scene::load(&assets.join("bevy-CornellBox/CornellBox.glb"), &options).expect("loads with an environment");
    let environment = scene.environment.expect("was asked for");
    assert_eq!((environment.width, environment.height, environment.radiance.len()), (1024, 512, 1024 * 512));
    assert!(environment.radiance.iter().all(|r| r.is_finite() && r.min_element() >= 0.0));
    assert!(warnings.iter().any(|w| w.kind == WarningKind::UnusedSetting && w.message.contains("nobody")));
    options.ies.insert("nobody".into(), scene::Ies { file: "absent.ies".into(), scale: 1.0 });
    let error = scene::load(&assets.join("bevy-CornellBox/CornellBox.glb"), &options).expect_err("has no such file");
    assert!(error.to_string().starts_with("absent.ies"), "{error}");
}
