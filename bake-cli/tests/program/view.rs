//! `bake view`: a picture of what was just baked.

use crate::bake::{Desk, Ended};

const CAMERA: &str = "--camera 0,1.5,6.2:0,1.5,0:38";

#[test]
fn a_baked_room_is_drawn_and_the_picture_repeats() {
    let desk = Desk::with_room();
    let baked = desk.bake("-q run room.glb --quality preview --texels-per-m 4 --samples 64");
    assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
    let ended = desk.bake(&format!("view room.bake --screenshot a.png --size 96x64 {CAMERA}"));
    if ended.err.contains("no graphics adapter") {
        assert_eq!(ended.code, Some(1));
        return testkit::reference::skip("no graphics adapter");
    }
    ended.expect(0, &[]);
    desk.bake(&format!("view room.bake --screenshot b.png --size 96x64 {CAMERA}")).expect(0, &[]);
    desk.bake(&format!("view room.bake --screenshot dark.png --exposure -3 --size 96x64 {CAMERA}")).expect(0, &[]);
    let views = [
        "--terms direct,indirect",
        "--terms direct",
        "--show texels",
        "--show nodes",
        "--show error",
        "--show validity",
    ];
    for (index, view) in views.iter().enumerate() {
        let file = format!("view{index}.png");
        desk.bake(&format!("view room.bake --screenshot {file} {view} --size 96x64 {CAMERA}")).expect(0, &[]);
    }
    let listed = desk.bake("view room.bake --list-variants");
    listed.expect(0, &[]);
    let airless = |line: &str| !line.starts_with("Air") && !line.contains(" AIR");
    assert!(listed.out.contains("Surface") && listed.out.lines().all(airless), "{}", listed.out);
    let read = |name: &str| std::fs::read(desk.path(name)).expect("a picture was written");
    assert!(read("a.png").starts_with(b"\x89PNG"));
    assert!(read("a.png") == read("b.png"), "same package, other picture");
    assert!(read("a.png") != read("dark.png"), "three stops make no difference");
    assert!(read("a.png") == read("view0.png"), "all terms are not the whole");
    for (index, view) in views.iter().enumerate().skip(1) {
        assert!(read("a.png") != read(&format!("view{index}.png")), "'{view}' makes no difference");
    }
}

/// Ground of 2 m x 2 m under a narrow spot lamp, 2 m above it.
fn stage() -> String {
    let corners = [[-1.0f32, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let hex: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
    let spot = serde_json::json!({
        "type": "spot", "intensity": 1000.0, "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.3 }
    });
    serde_json::json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [spot] } },
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "name": "ground" },
            {
                "name": "spot", "translation": [0, 2, 0], "rotation": [-std::f32::consts::FRAC_1_SQRT_2, 0, 0, std::f32::consts::FRAC_1_SQRT_2],
                "extensions": { "KHR_lights_punctual": { "light": 0 } }
            }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "min": [-1, 0, -1], "max": [1, 0, 1] },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6 }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 }
        ],
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream,{hex}") }]
    })
    .to_string()
}

/// A picture of a package; `None`, a counted skip, where no adapter draws.
fn drawn(desk: &Desk, package: &str, size: [u32; 2], flags: &str) -> Option<image::RgbImage> {
    let [width, height] = size;
    let ended = desk.bake(&format!("view {package} --screenshot drawn.png --size {width}x{height} {flags}"));
    if ended.err.contains("no graphics adapter") {
        testkit::reference::skip("no graphics adapter");
        return None;
    }
    ended.expect(0, &[]);
    Some(image::open(desk.path("drawn.png")).expect("a picture was written").into_rgb8())
}

#[test]
fn fog_in_shadow_glows_with_a_fog_volume_and_is_black_without() {
    let desk = Desk::new();
    desk.write("stage.gltf", stage());
    // A metre up and down at the lamp's cone, nothing behind it but the night.
    let camera = "--camera 0,1,6:0,1,0:20 --exposure 2";
    let mut shades = Vec::new();
    for (name, flags) in [("dark", ""), ("lit", "--fog-volume 0.5")] {
        let fog = "--fog sigma_t=0.5,albedo=0.9,bounds=-1:0:-1:1:2:1";
        let run = format!("-q run stage.gltf --quality preview --texels-per-m 8 --samples 64 {fog} {flags} -o {name}");
        let baked = desk.bake(&run);
        assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
        let Some(picture) = drawn(&desk, name, [64, 64], camera) else { return };
        // Beside the cone, above the ground, within the fog: x and y from 0.65 m to 0.85 m off the middle.
        let shade: Vec<u8> = (8..24).flat_map(|y| [6, 8, 55, 57].map(|x| picture.get_pixel(x, y).0[1])).collect();
        let cone = picture.get_pixel(32, 32).0[1];
        assert!(cone > 60, "{name}: the cone is lit: {cone}");
        shades.push(shade);
    }
    assert!(shades[0].iter().all(|&byte| byte == 0), "no light was stored, yet: {:?}", shades[0]);
    let least = shades[1].iter().min();
    assert!(shades[1].iter().all(|&byte| byte > 4), "fog beside the cone: {least:?}");
}

#[test]
fn the_environments_picture_stands_behind_the_scene() {
    let desk = Desk::new();
    desk.write("stage.gltf", stage());
    // Radiance HDR of 4 x 2 texels: from -Z over +X to +Z red, back over -X blue; RGBE: 128/256 * 2^(136 - 128).
    let row: Vec<u8> = [[128, 0, 0, 136], [128, 0, 0, 136], [0, 0, 128, 136], [0, 0, 128, 136]].concat();
    desk.write("sky.hdr", [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".as_slice(), &row, &row].concat());
    let baked = desk.bake("-q run stage.gltf --quality preview --texels-per-m 4 --samples 16 --env sky.hdr -o out");
    assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
    assert!(desk.path("out/stage.environment.exr").exists());
    let Some(picture) = drawn(&desk, "out", [32, 32], "--camera 0,3,0:1,3,0:60") else { return };
    let [r, _, b] = picture.get_pixel(16, 4).0;
    assert!(r > 60 && b == 0, "towards +X: {r} {b}");
    let Some(picture) = drawn(&desk, "out", [32, 32], "--camera 0,3,0:-1,3,0:60") else { return };
    let [r, _, b] = picture.get_pixel(16, 4).0;
    assert!(b > 60 && r == 0, "towards -X: {r} {b}");
}

#[test]
fn a_machine_without_any_adapter_is_told_what_to_install() {
    let desk = Desk::with_room();
    let baked = desk.bake("-q run room.glb --quality preview --texels-per-m 1 --samples 16");
    assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
    let mut command = desk.command("view room.bake --screenshot a.png --size 8x8");
    // Only Vulkan may be looked for, and it has no driver.
    command.env("WGPU_BACKEND", "vulkan").env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    let ended = Ended::from(command.output().expect("the program starts"));
    ended.expect(1, &["no graphics adapter", "libvulkan1"]);
    assert!(!desk.path("a.png").exists());
}

#[test]
fn nonsense_is_refused_with_the_form_that_is_meant() {
    let desk = Desk::with_room();
    for (arguments, code, words) in [
        ("view nowhere --screenshot a.png", 2, ["nowhere", "no bake package here"]),
        ("view room.bake --screenshot a.png --camera 1,2,3", 2, ["'1,2,3'", "EYE:TARGET"]),
        ("view room.bake --screenshot a.png --terms direct,fog", 2, ["'direct,fog'", "direct, indirect"]),
        ("view room.bake --screenshot a.png --air fog", 2, ["'fog'", "quadrature"]),
        ("view room.bake --screenshot a.png --size 640", 2, ["'640'", "1280x720"]),
    ] {
        desk.bake(arguments).expect(code, &words);
    }
}
