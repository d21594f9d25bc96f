//! `bake run` and `bake plan` from scene to package: what is written, what repeats, and what never lies half-written.

use crate::bake::{Desk, Ended, gltf, holds_measurements};
use bake_formats::{Package, Term};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// A bake of a few thousand rays.
const SMALL: &str = "--samples 8 --page-size 64 --max-pages 1";

/// Content of a package by file name, but for the file of measurements.
fn package_bytes(desk: &Desk, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(desk.path(folder)).expect("the package's folder");
    let files = entries.map(|entry| entry.expect("readable"));
    let named = files.map(|file| {
        let name = file.file_name().into_string().expect("our names are plain");
        (name, std::fs::read(file.path()).expect("readable"))
    });
    named.filter(|(name, _)| !holds_measurements(name)).collect()
}

#[test]
fn a_bake_writes_a_whole_package_and_reports() {
    let desk = Desk::with_room();
    let ended = desk.bake(&format!("run room.glb {SMALL}"));
    ended.expect(0, &[]);
    for word in ["load", "atlas", "trace", "write", "Mrays/s", "peak memory", "samples per texel", "room.bake.json"] {
        assert!(ended.out.contains(word), "no '{word}' in\n{}", ended.out);
    }
    let package = Package::open(&desk.path("room.bake")).expect("a whole package");
    assert_eq!(package.manifest.terms, [Term::Direct, Term::Indirect]);
    let image = package.image(&package.manifest.pages[0].lightmap).expect("readable");
    let total = image.rgb::<[f32; 3]>("").expect("R, G and B");
    assert!(total.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
    assert!(total.iter().flatten().any(|value| *value > 0.0), "no light at all");
    assert_eq!(desk.list(), ["room.bake", "room.glb"]);
}

#[test]
fn json_holds_the_same_report() {
    let desk = Desk::with_room();
    let ended = desk.bake(&format!("run room.glb {SMALL} -o out --json --progress json"));
    assert_eq!(ended.code, Some(0), "{ended:#?}");
    let report: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON alone on standard output");
    assert!(report["rays"].as_u64() > Some(0) && report["rays_per_second"].as_f64() > Some(0.0), "{report}");
    let run = std::fs::read_to_string(desk.path("out/room.run.json")).expect("written");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&run).expect("JSON"), report);
    let stages: Vec<serde_json::Value> = ended
        .err
        .lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).expect("one object a line"))
        .collect();
    assert!(stages.iter().any(|line| line["stage"] == "trace" && line["done"] == line["total"]), "{}", ended.err);
}

#[test]
fn the_report_stands_alone_and_raw_pages_are_kept_when_asked() {
    let desk = Desk::with_room();
    desk.bake(&format!("run room.glb {SMALL} -q -o out --keep-raw")).expect(0, &[]);
    let report = std::fs::read_to_string(desk.path("out/room.report.html")).expect("written");
    for part in ["data:image/png;base64,iVBOR", "Where the seconds went", "trace", "indirect"] {
        assert!(report.contains(part), "no {part}");
    }
    assert!(!report.contains("http"), "the report must not need a network");
    assert!(desk.path("out/room.raw.00.exr").exists());
    desk.bake(&format!("run room.glb {SMALL} -q -o plain")).expect(0, &[]);
    assert!(!desk.path("plain/room.raw.00.exr").exists());
}

#[test]
fn same_bits_whatever_the_thread_count() {
    let desk = Desk::with_room();
    let bake = |folder: &str, flags: &str| {
        desk.bake(&format!("run room.glb {SMALL} --sh1 -q -o {folder} {flags}")).expect(0, &[]);
        package_bytes(&desk, folder)
    };
    let first = bake("one", "--threads 1");
    assert!(first.len() >= 4, "manifest, lightmap, terms and harmonics: {:?}", first.keys());
    for (folder, threads) in [("again", 1), ("two", 2), ("seven", 7), ("seven-again", 7)] {
        let other = bake(folder, &format!("--threads {threads}"));
        assert_eq!(first.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
        for (name, bytes) in &first {
            assert!(*bytes == other[name], "{name} differs with {threads} threads ({folder})");
        }
    }
    let control = bake("seed", "--threads 1 --seed 1");
    assert!(control["room.lightmap.00.exr"] != first["room.lightmap.00.exr"], "another seed must give other bits");
}

/// The same in fog, where a grid is filled and factors are measured first.
#[test]
fn fog_has_the_same_bytes_whatever_the_threads() {
    let desk = Desk::with_room();
    for mode in ["grid", "tables"] {
        let fog = "--fog sigma_t=0.6,albedo=0.7 --samples 8 --page-size 32 --max-pages 1 -q";
        let bake = |more: &str| {
            let folder = format!("{mode} {more}").replace(' ', "_");
            desk.bake(&format!("run room.glb {fog} --mode {mode} {more} -o {folder}")).expect(0, &[]);
            package_bytes(&desk, &folder)
        };
        let first = bake("--threads 1");
        for threads in [2, 7] {
            let other = bake(&format!("--threads {threads}"));
            for (name, bytes) in &first {
                assert!(*bytes == other[name], "{mode}: {name} differs with {threads} threads");
            }
        }
        let (page, control) = ("room.lightmap.00.exr", bake("--threads 1 --seed 1"));
        assert!(first[page] != control[page], "{mode}: another seed gives other bits");
    }
}

#[test]
fn plan_writes_nothing_and_says_what_would_be_done() {
    let desk = Desk::with_room();
    let ended = desk.bake("plan room.glb --quality final");
    ended.expect(0, &[]);
    for word in ["4 meshes", "on  emissive surfaces", "off fog", "texels", "memory", "128 to 65536 (usually about "] {
        assert!(ended.out.contains(word), "no '{word}' in\n{}", ended.out);
    }
    let json = desk.bake("plan room.glb --json").out;
    let plan: serde_json::Value = serde_json::from_str(&json).expect("JSON alone on standard output");
    assert!(plan["atlas"]["texels"].as_u64() > Some(0), "{plan}");
    assert_eq!(desk.list(), ["room.glb"]);
}

#[test]
fn a_scene_without_light_or_with_damage_is_refused_by_both_commands() {
    let desk = Desk::new();
    desk.write("dark.gltf", gltf(1.0));
    desk.write(
        "cut.glb",
        &std::fs::read(testkit::reference::workspace().join("scenes/cornell.glb")).expect("there")[..500],
    );
    desk.write("noise.glb", [7u8; 64]);
    for command in ["run", "plan"] {
        desk.bake(&format!("{command} dark.gltf")).expect(2, &["dark.gltf", "no light", "--sky", "--sun", "--env"]);
        desk.bake(&format!("{command} cut.glb")).expect(2, &["cut.glb"]);
        desk.bake(&format!("{command} noise.glb")).expect(2, &["noise.glb", "glTF"]);
    }
    desk.bake(&format!("run dark.gltf --sky 100 {SMALL}")).expect(0, &[]);
}

#[test]
fn fog_gives_all_four_terms() {
    let desk = Desk::with_room();
    desk.bake("run room.glb --fog sigma_t=0.5,albedo=0.9 --samples 16 --page-size 32 --max-pages 1 -o fog")
        .expect(0, &[]);
    let package = Package::open(&desk.path("fog")).expect("a package");
    assert_eq!(package.manifest.terms, Term::ALL);
}

/// The reference takes the flags of `run` and is its mode walk, bit for bit; the settings file's mode does not count.
#[test]
fn the_reference_is_the_bake_by_walks() {
    let desk = Desk::with_room();
    let flags = "--fog sigma_t=0.5,albedo=0.9 --samples 16 --page-size 32 --max-pages 1 -q";
    desk.write("room.bake.ron", "Bake(mode: Grid)");
    let bake = |command: &str, folder: &str| {
        desk.bake(&format!("{command} room.glb {flags} -o {folder}")).expect(0, &[]);
        package_bytes(&desk, folder)["room.terms.00.exr"].clone()
    };
    let reference = bake("reference", "truth");
    assert!(reference == bake("run --mode walk", "walk"));
    assert!(reference != bake("run", "grid"), "the settings ask for a grid, which gives other bits");
    for mode in ["grid", "auto"] {
        let ended = desk.bake(&format!("reference room.glb --mode {mode}"));
        ended.expect(2, &["--mode", "walks", "bake run"]);
    }
}

#[test]
fn probes_fog_cells_and_the_total_without_air_are_written() {
    let desk = Desk::with_room();
    let small = "--samples 64 --page-size 32 --max-pages 1 --mode walk";
    let fog = "--fog sigma_t=0.5,albedo=0.9";
    let ended = desk.bake(&format!(
        "run room.glb {small} {fog} --probes spacing_m=0.5,visibility=true --fog-volume=1 --keep-vacuum -o fog"
    ));
    ended.expect(0, &[]);
    assert!(ended.out.contains("probes") && ended.out.contains("64 samples each"), "{}", ended.out);
    desk.bake(&format!("run room.glb {small} --keep-vacuum -q -o clear")).expect(0, &[]);
    let [fog, clear] = ["fog", "clear"].map(|folder| Package::open(&desk.path(folder)).expect("a package"));

    // What is kept beside the fog is the other bake, bit for bit; without air it is the total.
    let image = |package: &Package, layer: &str| {
        let terms = package.image(&package.manifest.pages[0].terms).expect("readable");
        terms.rgb::<[f32; 3]>(layer).expect("three channels")
    };
    let lightmap = clear.image(&clear.manifest.pages[0].lightmap).expect("readable");
    assert_eq!(image(&fog, "vacuum"), lightmap.rgb::<[f32; 3]>("").expect("R, G and B"));
    assert_eq!(image(&fog, "vacuum"), image(&clear, "vacuum"));
    assert_ne!(image(&fog, "vacuum"), fog.image(&fog.manifest.pages[0].lightmap).unwrap().rgb::<[f32; 3]>("").unwrap());

    for (grid, coefficients) in [(&fog.manifest.probes, 9), (&fog.manifest.fog_volume, 4)] {
        let grid = grid.as_ref().expect("in the manifest");
        let [nx, ny, nz] = grid.count;
        let image = fog.image(&grid.file).expect("readable");
        assert_eq!((image.width, image.height), (nx * nz, ny));
        assert_eq!(image.channels.len(), 3 * coefficients + 4, "harmonics, offset and validity");
        let light = image.rgb::<[f32; 3]>("c0").expect("c0");
        let valid = image.channel("validity.Y").expect("validity");
        assert!(valid.iter().sum::<f32>() > 0.7 * valid.len() as f32, "most of the room is air");
        for (light, valid) in light.iter().zip(valid) {
            assert!(light.iter().all(|c| c.is_finite() && (*c > 0.0) == (*valid == 1.0)), "{light:?} {valid}");
        }
        let Some(seen) = &grid.visibility else {
            assert_eq!(coefficients, 4, "only probes were asked how far they see");
            continue;
        };
        let image = fog.image(seen).expect("readable");
        assert_eq!((image.width, image.height), (16 * nx * nz, 16 * ny));
        let [mean, square] = ["distance.Y", "squared_distance.Y"].map(|name| image.channel(name).expect("moments"));
        let valid = |pixel: usize| {
            valid[pixel / image.width as usize / 16 * (nx * nz) as usize + pixel % image.width as usize / 16]
        };
        for (pixel, (mean, square)) in mean.iter().zip(square).enumerate() {
            assert!(
                (*mean > 0.0) == (valid(pixel) == 1.0) && *square >= mean * mean * 0.9999,
                "{pixel}: {mean} {square}"
            );
        }
    }
    assert!(clear.manifest.probes.is_none() && clear.manifest.fog_volume.is_none());
    desk.bake("plan room.glb --probes 0.5").expect(0, &[]);
    assert!(desk.bake("plan room.glb --probes 0.5").out.contains("m apart"));
    desk.bake("plan room.glb --probes 0.01").expect(2, &["probes.spacing_m", "points"]);
}

#[test]
fn an_output_that_cannot_be_written_is_told_before_tracing() {
    let desk = Desk::with_room();
    let long = "--samples 1000000";
    desk.bake(&format!("run room.glb {long} -o room.glb"))
        .expect(1, &["cannot write room.glb: a file stands where a folder", "-o"]);
    desk.bake(&format!("run room.glb {long} -o room.glb/deep/er")).expect(1, &["cannot write", "-o"]);
    assert_eq!(desk.list(), ["room.glb"]);
}

#[test]
fn a_folder_with_another_package_is_left_alone() {
    let desk = Desk::with_room();
    std::fs::copy(desk.path("room.glb"), desk.path("hut.glb")).expect("copied");
    desk.bake(&format!("run room.glb {SMALL} -o out")).expect(0, &[]);
    let before = package_bytes(&desk, "out");
    desk.bake(&format!("run hut.glb {SMALL} -o out")).expect(2, &["out", "room", "-o"]);
    assert!(before == package_bytes(&desk, "out"));
}

/// A file size limit stands for a full disk: writing fails in the middle of a file.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_the_older_package_whole() {
    let desk = Desk::with_room();
    desk.bake(&format!("run room.glb {SMALL} -o out")).expect(0, &[]);
    let before = package_bytes(&desk, "out");
    let limited = |folder: &str| {
        let program = desk.command("");
        let script = format!("trap '' XFSZ; ulimit -f 8; exec \"$0\" run room.glb {SMALL} --seed 9 -o {folder}");
        let mut shell = std::process::Command::new("bash");
        shell.args(["-c", &script]).arg(program.get_program()).current_dir(desk.path("")).env("NO_COLOR", "1");
        Ended::from(shell.output().expect("bash is there"))
    };
    limited("out").expect(1, &["cannot write", "out"]);
    assert!(before == package_bytes(&desk, "out"), "the older package changed");
    Package::open(&desk.path("out")).expect("the older package is whole");
    limited("new").expect(1, &["cannot write"]);
    assert_eq!(desk.list(), ["out", "room.glb"], "a folder without a package stays behind");
}

#[test]
#[cfg(unix)]
fn ctrl_c_stops_cleanly_and_leaves_nothing() {
    let desk = Desk::with_room();
    let mut bake = desk.command("run room.glb --samples 20000 --progress json -o new");
    let mut child = bake.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("piped")).lines();
    let tracing = lines.any(|line| line.expect("UTF-8").contains("\"stage\":\"trace\""));
    assert!(tracing, "the bake ended before it traced");
    interrupt(child.id());
    let told = lines.any(|line| line.expect("UTF-8").contains("interrupted"));
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(130), "{status}");
    assert!(told, "nothing was said about the interruption");
    assert_eq!(desk.list(), ["room.glb"]);
}

#[cfg(unix)]
fn interrupt(process: u32) {
    let sent = std::process::Command::new("kill").args(["-INT", &process.to_string()]).status();
    assert!(sent.expect("`kill` is there").success());
}

/// A triangle sealed in a box sees only back faces: no light can be found for it, nor neighbours to fill it from.
#[test]
fn texels_that_cannot_be_baked_give_code_3() {
    let desk = Desk::new();
    desk.write("sealed.gltf", gltf(-1.0));
    let ended = desk.bake(&format!("run sealed.gltf --sky 100 {SMALL}"));
    assert_eq!(ended.code, Some(3), "{ended:#?}");
    let told = std::fs::read_to_string(desk.path("sealed.bake/sealed.run.json")).expect("measurements are written");
    assert!(told.contains("no light could be found for"), "{told}");
}

#[test]
fn a_time_budget_ends_the_bake_and_is_told() {
    let desk = Desk::with_room();
    desk.bake("run room.glb --quality final --max-pages 1 --page-size 64 --time-budget 0.2 -o out").expect(0, &[]);
    let package = Package::open(&desk.path("out")).expect("a package");
    assert!(!package.manifest.reproducible, "bytes depend on the machine");
    let error = package.manifest.error_estimate.expect("an estimate").relative_standard_error;
    assert!(error > 0.01, "a fifth of a second was enough for the whole bake: {error}");
}

/// A closed room of albedo exactly 1 ends at the longest path and says so; one that absorbs says nothing.
#[test]
fn endless_light_is_a_warning_with_the_way_out() {
    let desk = Desk::new();
    let mut scene: serde_json::Value = serde_json::from_str(&gltf(1.0)).expect("JSON");
    scene["extensionsUsed"] = serde_json::json!(["KHR_lights_punctual"]);
    scene["extensions"] =
        serde_json::json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 10 }] } });
    let lamp = serde_json::json!({ "translation": [0, 0, 1], "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    scene["nodes"].as_array_mut().expect("a list").push(lamp);
    scene["scenes"][0]["nodes"] = serde_json::json!([0, 1, 2]);
    let warnings = |scene: &serde_json::Value| {
        desk.write("room.gltf", scene.to_string());
        let ended = desk.bake("--json run room.gltf --samples 8 --texels-per-m 0.5");
        ended.expect(0, &[]);
        let measured: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
        measured["warnings"].to_string()
    };
    let told = warnings(&scene);
    assert!(told.contains("endless light") && told.contains("base colour") && told.contains("--bounces"), "{told}");
    for material in 0..2 {
        scene["materials"][material]["pbrMetallicRoughness"] =
            serde_json::json!({ "baseColorFactor": [0.8, 0.8, 0.8, 1] });
    }
    assert!(!warnings(&scene).contains("endless light"));
}

#[test]
fn explain_tells_what_each_effect_cost_and_changed() {
    let desk = Desk::with_room();
    let fog = "--fog sigma_t=0.3/0.2/0.1,albedo=0.9,g=0.4 --mode walk --force-effect absorption=off";
    let ended = desk.bake(&format!("run room.glb --samples 8 --texels-per-m 2 {fog} --explain -o out"));
    ended.expect(0, &[]);
    for part in [
        "seconds      surface tracing",
        "single scattering",
        "multiple scattering",
        "changed by   scattering",
        "left out     absorption",
    ] {
        assert!(ended.out.contains(part), "`{part}` is not in:\n{}", ended.out);
    }
    let text = std::fs::read_to_string(desk.path("out/room.run.json")).expect("written");
    let measured: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let explained = &measured["explained"];
    let change = |name: &str| {
        let changes = explained["changes"].as_array().expect("a list").iter();
        let change = changes.clone().find(|change| change["effect"] == name).expect(name);
        ["mean", "max", "bound"].map(|key| change[key].as_f64().expect("a number"))
    };
    let [mean, max, bound] = change("scattering");
    assert!(0.0 < mean && mean < max && mean < bound, "{explained}");
    assert!(change("scattering")[0] > change("colour")[0], "{explained}");
    let terms =
        explained["terms"].as_array().expect("a list").iter().map(|term| term["mean"].as_f64().expect("a number"));
    assert!((terms.sum::<f64>() - 1.0).abs() < 1e-5, "{explained}");
    let report = std::fs::read_to_string(desk.path("out/room.report.html")).expect("written");
    assert!(report.contains("What each effect did") && report.contains("changed by"), "the report holds it too");
}
