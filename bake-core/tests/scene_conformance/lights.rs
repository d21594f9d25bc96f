//! Punctual lights, emission and absorption of the collection's models.

use crate::load;
use bake_core::scene::{LightKind, Material, Scene, WarningKind};
use glam::Vec3;
use testkit::compare::Worst;
use testkit::reference::shared;

fn material<'a>(scene: &'a Scene, name: &str) -> &'a Material {
    scene.materials.iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no material {name}"))
}

#[test]
fn lamps_have_their_colour_times_candela_at_their_nodes() {
    let Some(path) = shared("assets/LightsPunctualLamp/LightsPunctualLamp.gltf") else { return };
    let (scene, warnings) = load(&path);
    // Node, colour, candela and place as in the JSON.
    let want = [
        ("Point_Orientation", [1.0, 0.631_875, 0.239_099_76], 15.0, [0.046_223_56, 0.907_797_34, 0.006_696_629]),
        ("Point.002_Orientation", [1.0; 3], 1.5, [0.175_456_23, -0.764_219_9, -0.005_704_083]),
        (
            "Point.001_Orientation",
            [0.212_230_8, 0.590_619, 0.558_340_55],
            80.0,
            [0.137_618_21, 2.066_983_7, -1.178_986_4],
        ),
        (
            "Point.003_Orientation",
            [0.212_230_8, 0.590_619, 0.558_340_55],
            80.0,
            [0.044_289, 0.254_364_37, -1.209_032_4],
        ),
        ("Point.004_Orientation", [1.0, 0.627_836_5, 0.501_240_4], 180.0, [0.292_021_04, 1.032_399_9, 1.558_915_97]),
    ];
    assert_eq!(scene.lights.len(), want.len());
    let mut worst = Worst::new("lamps: colour and place", 1e-6);
    for (light, (path, tint, candela, place)) in scene.lights.iter().zip(want) {
        assert_eq!(light.path, path);
        let LightKind::Point { position, range: None, .. } = light.kind else { panic!("{:?}", light.kind) };
        let color = light.color / candela - Vec3::from(tint);
        worst.record(color.abs().max_element().into(), || path.into());
        worst.record((position - Vec3::from(place)).abs().max_element().into(), || path.into());
    }
    worst.check();
    assert!(!warnings.iter().any(|w| w.kind == WarningKind::LightUnits), "lamps of 1.5 to 180 candela are plausible");
}

#[test]
fn spots_have_their_cones_and_shine_down() {
    let Some(path) = shared("assets/playcanvas-Lights/Lights.glb") else { return };
    let (scene, _) = load(&path);
    // Blender's lamps shine along −Y of their own node: the exporter's extra node turns −Z there.
    let mut spots = 0;
    // The full angles are 45° and 9.015°; both inner cones are 0.85 of the outer.
    for (name, outer_degrees, height) in [("Spot/", 22.5f64, 1.943_267_2), ("Spot.001/", 4.507_431, 6.156_267_6)] {
        let light = scene.lights.iter().find(|l| l.path.starts_with(name)).expect("a spot");
        let LightKind::Spot { position, direction, cos_inner, cos_outer, .. } = light.kind else { panic!("{name}") };
        let angle = |cos: f32| f64::from(cos).acos().to_degrees();
        assert!((angle(cos_outer) - outer_degrees).abs() < 1e-3, "{name}: {}", angle(cos_outer));
        assert!((angle(cos_inner) - 0.85 * outer_degrees).abs() < 1e-3, "{name}: {}", angle(cos_inner));
        assert!((direction - Vec3::NEG_Y).length() < 1e-6, "{direction}");
        assert!((position.y - height).abs() < 1e-6, "{position}");
        spots += 1;
    }
    assert_eq!((spots, scene.lights.len()), (2, 4));
    let sun = scene.lights.iter().find(|l| l.path.starts_with("Sun")).expect("a sun");
    assert!(matches!(sun.kind, LightKind::Directional { angular_radius: 0.0, .. }));
    assert!((sun.color - Vec3::new(0.0, 1.0, 1.0)).length() < 1e-6);
}

#[test]
fn lights_that_no_node_carries_do_not_shine() {
    let Some(path) = shared("assets/khr-lights_punctual-sample/lights.gltf") else { return };
    let (scene, _) = load(&path);
    // The spot is listed but not placed.
    assert_eq!(scene.lights.len(), 2);
    for light in &scene.lights {
        match light.kind {
            LightKind::Point { position, .. } => {
                assert_eq!((position, light.color), (Vec3::new(0.0, 22.0, 0.0), Vec3::new(20.0, 0.0, 0.0)));
            }
            LightKind::Directional { direction, .. } => {
                assert_eq!(direction, Vec3::NEG_Z);
                assert!((light.color - Vec3::new(3.0, 2.7, 2.1)).length() < 1e-6);
            }
            LightKind::Spot { .. } => panic!("the spot has no node"),
        }
    }
}

#[test]
fn emission_grows_in_proportion_to_its_strength() {
    let Some(path) = shared("assets/EmissiveStrengthTest/EmissiveStrengthTest.glb") else { return };
    let (scene, _) = load(&path);
    let mut worst = Worst::new("emission against strength", 1e-6);
    for strength in [1.0, 2.0, 4.0, 8.0, 16.0f32] {
        let name = format!("Emit{strength}");
        let ratio = material(&scene, &name).emission / (strength * Vec3::new(0.1, 0.5, 0.9));
        worst.record((ratio - 1.0).abs().max_element().into(), || name);
    }
    worst.check();
}

#[test]
fn absorption_follows_colour_and_distance_alone() {
    let Some(assets) = shared("assets") else { return };
    let (scene, _) = load(&assets.join("AttenuationTest/AttenuationTest.glb"));
    // −ln 0.1, −ln 0.5, −ln 0.9.
    let one_metre = Vec3::new(std::f32::consts::LN_10, std::f32::consts::LN_2, 0.105_360_516);
    let mut worst = Worst::new("absorption, relative", 1e-6);
    let mut check = |material: &Material, want: Vec3| {
        let ratio = material.volume_sigma_a / want;
        worst.record((ratio - 1.0).abs().max_element().into(), || {
            format!("{}: {}", material.name, material.volume_sigma_a)
        });
        assert_eq!(material.transmission, 1.0);
    };
    for name in ["R2_and_R4_ThicknessFac_1.0", "R2_ThicknessFac_1.5", "R2_ThicknessFac_0.25", "R3_ThicknessTex_Mat"] {
        check(material(&scene, name), one_metre);
    }
    // The names give the density relative to one metre; the distances are their inverses.
    for (name, density) in [("1.0", 1.0), ("1.5", 1.5), ("2.0", 2.0), ("0.50", 0.5), ("0.25", 0.25)] {
        check(material(&scene, &format!("R5_Attenuation_{name}")), density * one_metre);
    }
    worst.check();
    assert_eq!(material(&scene, "R1_Sample_1.0").volume_sigma_a, Vec3::ZERO);

    let (scene, _) = load(&assets.join("GlassHurricaneCandleHolder/GlassHurricaneCandleHolder.glb"));
    // Colour (0.8, 0.95, 1) at one millimetre.
    let got = material(&scene, "GlassHurricaneCandleHolder-glass").volume_sigma_a;
    assert!((got - Vec3::new(223.143_55, 51.293_294, 0.0)).abs().max_element() < 2e-3, "{got}");
    assert_eq!(material(&scene, "GlassHurricaneCandleHolder-opaque").volume_sigma_a, Vec3::ZERO);
}
