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
    let nowhere = desk.bake("view room.bake --screenshot no/where.png --size 8x8");
    nowhere.expect(1, &["cannot write no/where.png: its folder does not exist", "make the folder", "`--screenshot`"]);
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

/// A shape of a scene: name, corners, triangles.
type Shape = (&'static str, Vec<[f32; 3]>, Vec<[u16; 3]>);

/// Ground of 2 m x 2 m under a narrow spot lamp, 2 m above it.
fn stage() -> String {
    stage_with(vec![])
}

/// The same with more on it.
fn stage_with(more: Vec<Shape>) -> String {
    let corners = vec![[-1.0f32, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]];
    let ground: Shape = ("ground", corners, vec![[0, 1, 2], [0, 2, 3]]);
    let spot = serde_json::json!({
        "type": "spot", "intensity": 1000.0, "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.3 }
    });
    let down = [-std::f32::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2];
    let lit = serde_json::json!({ "KHR_lights_punctual": { "light": 0 } });
    let mut nodes =
        vec![serde_json::json!({ "name": "spot", "translation": [0, 2, 0], "rotation": down, "extensions": lit })];
    let (mut meshes, mut accessors, mut views, mut bytes) = (vec![], vec![], vec![], Vec::<u8>::new());
    for (index, (name, corners, triangles)) in [ground].into_iter().chain(more).enumerate() {
        let least = |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|axis| corners.iter().map(|c| c[axis]).reduce(pick));
        let (min, max) = (least(f32::min), least(f32::max));
        let lists = [
            corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
            triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect(),
        ];
        let accessor = |view: usize, component: u32, kind: &str, count: usize| serde_json::json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        let mut places = accessor(2 * index, 5126, "VEC3", corners.len());
        (places["min"], places["max"]) = (serde_json::json!(min), serde_json::json!(max));
        accessors.extend([places, accessor(2 * index + 1, 5123, "SCALAR", 3 * triangles.len())]);
        for list in lists {
            views.push(serde_json::json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": list.len() }));
            bytes.extend(list);
        }
        let attributes = serde_json::json!({ "POSITION": 2 * index });
        meshes.push(serde_json::json!({ "primitives": [{ "attributes": attributes, "indices": 2 * index + 1 }] }));
        nodes.push(serde_json::json!({ "mesh": index, "name": name }));
    }
    let hex: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
    serde_json::json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [spot] } },
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": meshes,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream,{hex}") }]
    })
    .to_string()
}

/// A C that stands up, open to the left: slabs from 0.1 m to 0.6 m and from 1.2 m to 1.7 m, joined at the right.
fn hook() -> Shape {
    let outline = [[-1.0, 0.1], [1.0, 0.1], [1.0, 1.7], [-1.0, 1.7], [-1.0, 1.2], [0.6, 1.2], [0.6, 0.6], [-1.0, 0.6]];
    let corners = [1.0f32, -1.0].into_iter().flat_map(|z| outline.map(|[x, y]| [x, y, z])).collect();
    let face = [[0, 1, 6], [0, 6, 7], [1, 2, 6], [6, 2, 5], [2, 3, 5], [3, 4, 5]];
    let back = face.map(|[a, b, c]| [8 + a, 8 + c, 8 + b]);
    let sides = (0..8u16).flat_map(|a| {
        let b = (a + 1) % 8;
        [[a, a + 8, b + 8], [a, b + 8, b]]
    });
    ("hook", corners, face.into_iter().chain(back).chain(sides).collect())
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
    for (name, flags) in [("dark", ""), ("lit", "--fog-volume=0.5")] {
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
fn media_are_drawn_where_and_as_dense_as_they_were_baked() {
    let desk = Desk::new();
    // Green in the middle of the lamp's cone, 1.45 m, 0.9 m and 0.4 m above the ground; nothing but the night behind.
    let seen = |name: &str, shapes: Vec<Shape>, bounds: &str, density: &str| {
        desk.write("stage.gltf", stage_with(shapes));
        let scatter = "scatter: Sigma(s: (0.2, 0.2, 0.2), a: (0, 0, 0))";
        let medium = format!("Bake(media: [Medium(bounds: {bounds}, density: {density}, {scatter})])");
        desk.write("stage.bake.ron", medium);
        let baked = desk.bake(&format!("-q run stage.gltf --quality preview --texels-per-m 4 --samples 16 -o {name}"));
        assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
        let picture = drawn(&desk, name, [64, 64], "--camera 0,1,6:0,1,0:20 --exposure 2")?;
        Some([18, 35, 50].map(|row| picture.get_pixel(32, row).0[1]))
    };
    let block = "Box(min: (-1, 0.1, -1), max: (1, 1.7, 1))";
    let Some([top, gap, bottom]) = seen("mesh", vec![hook()], "Node(\"hook\")", "Uniform") else { return };
    assert!(top > 40 && gap == 0 && bottom > 40, "within a closed mesh: {top} {gap} {bottom}");
    let [top, gap, bottom] = seen("box", vec![], block, "Uniform").expect("drawn before");
    assert!(top > gap && gap > bottom && bottom > 40, "a box about it (negative control): {top} {gap} {bottom}");
    let low = "Exponential(base_m: 0.4, scale_height_m: 0.25)";
    let [top, gap, bottom] = seen("low", vec![], block, low).expect("drawn before");
    assert!(bottom > 40 && bottom > 2 * gap && gap > 2 * top, "denser towards the ground: {top} {gap} {bottom}");
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
    let mut command = desk.command("view room.bake");
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    let ended = Ended::from(command.output().expect("the program starts"));
    if cfg!(target_os = "linux") {
        ended.expect(1, &["no display for a window: neither WAYLAND_DISPLAY", "`--screenshot FILE`"]);
        assert!(!ended.err.contains(".rs"), "{}", ended.err);
    }
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
        ("view room.bake --screenshot a.png --exposure nan", 2, ["'nan'", "-64 to 64"]),
        ("view room.bake --screenshot a.png --exposure inf", 2, ["'inf'", "-64 to 64"]),
        ("view room.bake --screenshot a.png --compare lut --difference=nan", 2, ["'nan'", "0.000001 to 1000000"]),
        ("view room.bake --screenshot a.png --compare lut --difference=-1", 2, ["'-1'", "0.000001 to 1000000"]),
        ("view --compare lut --difference nowhere", 2, ["nowhere", "no bake package here"]),
        ("view room.bake --screenshot a.png --prune nan", 2, ["'nan'", "0 to 1000000000"]),
        ("view room.bake --screenshot a.jpg", 2, ["'a.jpg'", "ends in .png"]),
        (
            "view room.bake --screenshot a.png --compare zzz",
            2,
            ["'zzz'", "folder of a package, nor one of none, vacuum"],
        ),
    ] {
        desk.bake(arguments).expect(code, &words);
    }
}
