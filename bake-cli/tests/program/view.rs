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
        ("view nowhere --screenshot a.png", 1, ["nowhere", "cannot read"]),
        ("view room.bake --screenshot a.png --camera 1,2,3", 2, ["'1,2,3'", "EYE:TARGET"]),
        ("view room.bake --screenshot a.png --terms direct,fog", 2, ["'direct,fog'", "direct, indirect"]),
        ("view room.bake --screenshot a.png --air fog", 2, ["'fog'", "quadrature"]),
        ("view room.bake --screenshot a.png --size 640", 2, ["'640'", "1280x720"]),
    ] {
        desk.bake(arguments).expect(code, &words);
    }
}
