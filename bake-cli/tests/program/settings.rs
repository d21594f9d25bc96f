//! Settings files through the program: where they are found, how faults in them are told, and `bake init`.

use crate::bake::Desk;

#[test]
fn init_writes_a_file_that_run_accepts_and_replaces_none() {
    let desk = Desk::with_room();
    desk.bake("init room.glb").expect(0, &[]);
    assert_eq!(desk.list(), ["room.bake.ron", "room.glb"]);
    let written = std::fs::read_to_string(desk.path("room.bake.ron")).expect("written");
    assert!(written.contains("quality: Medium"), "{written}");

    desk.write("room.bake.ron", "Bake(seed: 3)");
    desk.bake("init room.glb").expect(2, &["is there already", "--force"]);
    assert_eq!(std::fs::read_to_string(desk.path("room.bake.ron")).expect("there"), "Bake(seed: 3)");
    desk.bake("init room.glb --force").expect(0, &[]);
    assert_eq!(std::fs::read_to_string(desk.path("room.bake.ron")).expect("there"), written);
}

#[test]
fn unknown_keys_are_refused_with_position_and_suggestion() {
    let desk = Desk::with_room();
    desk.write("room.bake.ron", "Bake(\n    texel_per_m: 4,\n)");
    desk.bake("run room.glb").expect(2, &["room.bake.ron:2:5", "`texel_per_m`", "did you mean `texels_per_m`?"]);
    desk.write("room.bake.ron", "Bake(\n    quality: Finel,\n)");
    desk.bake("plan room.glb").expect(2, &["room.bake.ron:2:", "`Finel`", "did you mean `Final`?"]);
    desk.write("room.bake.ron", "Bake(samples: \"x\")");
    desk.bake("plan room.glb").expect(2, &["room.bake.ron:1:14", "a whole number belongs here", "bake init SCENE"]);
    desk.write("room.bake.ron", "");
    desk.bake("plan room.glb").expect(2, &["room.bake.ron:1:1", "a record belongs here", "like `Bake(key: value, …)`"]);
    desk.write("room.bake.ron", [0xff, 0xfe, 0x00]);
    desk.bake("run room.glb").expect(2, &["room.bake.ron", "utf-8"]);
}

#[test]
fn a_named_settings_file_replaces_the_side_file() {
    let desk = Desk::with_room();
    desk.write("room.bake.ron", "not RON at all (");
    desk.write("other.ron", "Bake(texels_per_m: -1)");
    desk.bake("run room.glb --settings other.ron").expect(2, &["`texels_per_m` is -1"]);
    desk.bake("run room.glb --settings none.ron").expect(2, &["none.ron", "bake init"]);
}

#[test]
fn the_flag_wins_over_the_file() {
    let desk = Desk::with_room();
    desk.write("room.bake.ron", "Bake(page_size: 3)");
    desk.bake("plan room.glb").expect(2, &["`page_size` is 3"]);
    desk.bake("plan room.glb --page-size 4").expect(2, &["`page_size` is 4"]);
}
