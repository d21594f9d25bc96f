//! Help, and what wrong usage is answered with.

use crate::bake::Desk;

#[test]
fn help_fits_a_screen() {
    let desk = Desk::new();
    for (arguments, sample) in [
        ("--help", "bake run room.glb"),
        ("run --help", "Accuracy:"),
        ("run -h", "--max-pages"),
        ("reference --help", "out/truth"),
        ("plan --help", "--texels-per-m"),
        ("tables generate --help", "--scatter-orders"),
        ("study --help", "--stability"),
        ("init --help", "--force"),
    ] {
        let ended = desk.bake(arguments);
        assert_eq!(ended.code, Some(0), "{arguments}");
        let lines = ended.out.lines().count();
        assert!((5..=44).contains(&lines), "{arguments}: {lines} lines");
        assert!(ended.out.lines().all(|line| line.chars().count() <= 130), "{arguments}: a line is too long");
        assert!(ended.out.contains(sample), "{arguments}: no '{sample}' in\n{}", ended.out);
        assert!(ended.err.is_empty(), "{arguments}: {}", ended.err);
    }
}

#[test]
fn nothing_asked_is_wrong_usage_and_shows_the_commands() {
    let ended = Desk::new().bake("");
    ended.expect(2, &["Usage: bake", "run", "plan", "init", "Examples"]);
    assert!(ended.out.is_empty());
}

#[test]
fn typing_errors_are_answered_with_what_was_meant() {
    let desk = Desk::with_room();
    for (arguments, words) in [
        ("plna room.glb", ["'plna'", "'plan'"]),
        ("run room.glb --qualty final", ["'--qualty'", "'--quality'"]),
        ("run room.glb --quality finl", ["'finl'", "'final'"]),
        ("run room.glb --sun azimut_deg=1", ["azimut_deg", "`azimuth_deg`"]),
    ] {
        desk.bake(arguments).expect(2, &words);
    }
}

#[test]
fn wrong_values_are_refused_with_what_is_allowed() {
    let desk = Desk::with_room();
    for (arguments, words) in [
        ("run", ["<SCENE>", "bake run"]),
        ("run room.glb --threads 0", ["--threads", "1..=1024"]),
        ("run room.glb --texels-per-m -3", ["`texels_per_m` is -3", "allowed"]),
        ("run room.glb --page-size 1", ["`page_size` is 1", "16 to 16384"]),
        ("run room.glb --samples x", ["--samples", "a whole number like 16"]),
        ("run room.glb --bounces -1", ["--bounces", "a whole number like 16, from 0"]),
        ("run room.glb --texels-per-m x", ["--texels-per-m", "a number like 0.5"]),
        ("run room.glb --sky abc", ["--sky", "like 0.5/0.4/0.3"]),
        ("run room.glb --sky 1/2", ["--sky", "like 0.5/0.4/0.3"]),
        ("run room.glb --probes foo", ["--probes", "spacing_m=0.5"]),
        ("run room.glb --time-budget foo", ["--time-budget", "a time like 90"]),
        ("run room.glb --light-scale 0", ["`light_scale` is 0", "allowed is 0.000000001 to 1000000000"]),
        ("run --fog-volume nope.glb", ["nope.glb does not exist", "room.glb"]),
        ("run room.glb --sky 1 --env sky.hdr", ["`sky`", "one of the two"]),
        ("run room.glb -v -q", ["--verbose", "--quiet"]),
        ("run room.glb other.glb", ["other.glb", "unexpected"]),
    ] {
        desk.bake(arguments).expect(2, &words);
    }
}

#[test]
fn help_names_no_flag_that_the_command_refuses() {
    let desk = Desk::new();
    for flag in ["--keep-paths", "--mode"] {
        assert!(desk.bake("run --help").out.contains(flag));
        assert!(!desk.bake("reference --help").out.contains(flag), "{flag}");
    }
    let (_, air) = desk.bake("run --help").out.split_once("Air:").map(|(a, b)| (a.len(), b.to_owned())).expect("Air");
    assert!(air.contains("--fog "), "{air}");
}

#[test]
fn what_is_no_package_is_refused_alike_by_every_command() {
    let desk = Desk::with_room();
    std::fs::create_dir_all(desk.path("odd/room.bake.json")).expect("created");
    std::fs::create_dir(desk.path("cut")).expect("created");
    desk.write("cut/room.bake.json", "{");
    let mut commands = vec!["sample PLACE points.csv", "diff PLACE PLACE", "refog PLACE --fog none -o out"];
    commands.extend(cfg!(feature = "view").then_some("view PLACE --screenshot a.png"));
    for command in commands {
        for (place, words) in [
            ("nope", ["nope: no bake package here", "SCENE -o DIR"]),
            ("room.glb", ["room.glb is a scene and no package: bake it with `bake run room.glb`", "room.bake"]),
            ("cut", ["cut/room.bake.json: damaged manifest", "bake again"]),
            ("odd", ["cannot read odd/room.bake.json", "check the path"]),
        ] {
            desk.bake(&command.replace("PLACE", place)).expect(2, &words);
        }
    }
}

#[test]
fn what_cannot_be_written_is_told_in_one_form_and_no_input_is_overwritten() {
    let desk = Desk::with_room();
    desk.bake("run room.glb --page-size 16 --samples 8 --texels-per-m 4 -o out -q").expect(0, &[]);
    desk.write("points.csv", "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n");
    let sample = desk.bake("sample out points.csv -o no/where.csv");
    sample.expect(1, &["cannot write no/where.csv: its folder does not exist", "make the folder", "`-o`"]);
    let image = desk.bake("diff out out --image no/where");
    image.expect(1, &["cannot write no/where.00.png: its folder does not exist", "make the folder", "`--image`"]);
    desk.bake("sample out points.csv -o ./points.csv").expect(2, &["points.csv holds the points", "`-o FILE`"]);
    assert!(std::fs::read(desk.path("points.csv")).expect("there").starts_with(b"x,y,z"));
    assert_eq!(desk.list(), ["out", "points.csv", "room.glb"]);
}

#[test]
fn scenes_that_are_none_are_refused_with_the_next_step() {
    let desk = Desk::with_room();
    std::fs::create_dir(desk.path("empty")).expect("created");
    desk.write("room.obj", "v 0 0 0");
    for (arguments, words) in [
        ("run nope.glb", ["nope.glb does not exist", "room.glb"]),
        ("plan .", ["is a folder", "room.glb"]),
        ("run empty/a.glb", ["does not exist", "no .glb or .gltf file"]),
        ("run no/such/folder/a.glb", ["does not exist", "no/such/folder"]),
        ("init room.obj", ["room.obj is no .glb", "export"]),
        ("sample nope points.csv", ["nope: no bake package here", "SCENE -o DIR"]),
        ("diff nope room.glb", ["nope: no bake package here", "SCENE -o DIR"]),
    ] {
        desk.bake(arguments).expect(2, &words);
    }
}

/// The reader is gone before the first word, on both outputs: exit codes and files stay what they are.
#[test]
#[cfg(unix)]
fn a_closed_pipe_is_no_failure() {
    let desk = Desk::with_room();
    for (arguments, code) in [
        ("tables inspect", 0),
        ("init room.glb", 0),
        ("init room.glb", 2),
        ("plan room.glb", 0),
        ("--json --verbose plan room.glb --progress json", 0),
        ("run room.glb --page-size 16 --samples 8 --texels-per-m 4 -o out", 0),
        ("diff out out", 0),
        ("--help", 0),
        ("plna", 2),
    ] {
        let closed = || {
            let (reader, writer) = std::io::pipe().expect("a pipe");
            drop(reader);
            writer
        };
        let status = desk.command(arguments).stdout(closed()).stderr(closed()).status().expect("the program starts");
        assert_eq!(status.code(), Some(code), "{arguments}");
    }
    assert!(desk.path("out/room.bake.json").exists(), "{:?}", desk.list());
}
