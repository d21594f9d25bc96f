//! The air through the program: where it is stated, what `bake plan` says of it, and how faults are told.

use crate::bake::{Desk, gltf};
use serde_json::Value;

/// The plan as JSON.
fn plan(desk: &Desk, arguments: &str) -> Value {
    let ended = desk.bake(&format!("--json plan room.glb {arguments}"));
    ended.expect(0, &[]);
    serde_json::from_str(&ended.out).expect("JSON")
}

#[test]
fn the_plan_prints_each_medium() {
    let desk = Desk::with_room();
    let ended = desk.bake("plan room.glb --fog sigma_t=0.5/0.4/0.25,albedo=0.9,g=0.3,bounds=0:0:0:1:2:3");
    ended.expect(0, &[]);
    let flat = ended.out.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "medium fog: box (0 0 0) to (1 2 3) m, uniform, Henyey-Greenstein (g 0.3)",
        "mean free path 2 m / 2.5 m / 4 m",
        "albedo 0.9",
        "effect on fog ≤",
        "effect off heterogeneity - uniform densities",
    ] {
        assert!(flat.contains(part), "`{part}` is not in:\n{}", ended.out);
    }
    let media = plan(&desk, "")["media"].clone();
    assert_eq!(media, Value::Array(vec![]));
}

#[test]
fn the_scenes_extras_are_media_unless_settings_or_flags_say_otherwise() {
    let desk = Desk::new();
    let record = r#"[{"name": "mist", "scatter": {"Look": {"mean_free_path_m": 2, "albedo": [1, 1, 1]}}}]"#;
    let mut scene: Value = serde_json::from_str(&gltf(1.0)).expect("JSON");
    scene["scenes"][0]["extras"] =
        serde_json::json!({ "bake_media": serde_json::from_str::<Value>(record).expect("JSON") });
    let names = |arguments: &str| {
        let ended = desk.bake(&format!("--json plan room.gltf --sky 1 {arguments}"));
        ended.expect(0, &[]);
        let plan: Value = serde_json::from_str(&ended.out).expect("JSON");
        plan["media"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|m| m["name"].as_str().expect("text").to_owned())
            .collect::<Vec<_>>()
    };
    desk.write("room.gltf", scene.to_string());
    assert_eq!(names(""), ["mist"]);
    assert_eq!(names("--fog sigma_t=1,albedo=1"), ["fog"]);
    assert!(names("--fog none").is_empty());
    desk.write("room.bake.ron", "Bake(media: [Medium(name: \"smoke\", scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0)))])");
    assert_eq!(names(""), ["smoke"]);
    std::fs::remove_file(desk.path("room.bake.ron")).expect("removed");
    // As text: what editors with plain custom properties write.
    scene["scenes"][0]["extras"] = serde_json::json!({ "bake_media": record });
    desk.write("room.gltf", scene.to_string());
    assert_eq!(names(""), ["mist"]);
    scene["scenes"][0]["extras"] = serde_json::json!({ "bake_media": record.replace("Look", "Lok") });
    desk.write("room.gltf", scene.to_string());
    desk.bake("plan room.gltf --sky 1").expect(2, &["bake_media", "Lok", "Look"]);
}

#[test]
fn wrong_media_are_refused_before_anything_is_baked() {
    let desk = Desk::with_room();
    for (arguments, words) in [
        ("plan room.glb --fog sigma_t=-1,albedo=0.5", ["`sigma_t` is -1", "allowed is 0 to 1000000"]),
        ("plan room.glb --fog sigma_t=1,albedo=2", ["`albedo` is 2", "allowed is 0 to 1"]),
        ("plan room.glb --fog sigma_t=1,albedo=1,g=1", ["`g` is 1", "-0.999 to 0.999"]),
        ("plan room.glb --fog sigma_t=1,albedo=1,bounds=0:0:0:0:1:1", ["media[\"fog\"].bounds", "min below max"]),
    ] {
        desk.bake(arguments).expect(2, &words);
    }
    desk.write(
        "room.bake.ron",
        "Bake(media: [Medium(name: \"mist\", bounds: Node(\"none\"), scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0)))])",
    );
    desk.bake("plan room.glb").expect(2, &["mist", "no node `none`"]);
    let flat = Desk::with_scene("plane_point.glb");
    let refused = flat.bake("plan room.glb --fog sigma_t=1,albedo=1");
    refused.expect(2, &["\"fog\"", "no volume", "…,bounds=x0:y0:z0:x1:y1:z1"]);
}

#[test]
fn air_that_swallows_the_sun_is_a_warning() {
    let desk = Desk::with_room();
    let sun = "--sun azimuth_deg=0,elevation_deg=45,lux=1000";
    let ended = desk.bake(&format!("plan room.glb {sun} --fog sigma_t=10,albedo=1,bounds=-50:-50:-50:50:50:50"));
    ended.expect(0, &["warning", "lets", "through"]);
    desk.bake(&format!("plan room.glb {sun} --fog sigma_t=0.01,albedo=1,bounds=-50:-50:-50:50:50:50")).expect(0, &[]);
}

#[test]
fn smoke_from_a_file_is_planned_and_a_wrong_one_is_told() {
    let desk = Desk::with_room();
    let data = testkit::reference::workspace().join("bake-core/tests/data/air");
    std::fs::copy(data.join("several.vdb"), desk.path("smoke.vdb")).expect("committed");
    let smoke = |grid: &str| {
        let text =
            "Bake(media: [Medium(name: \"smoke\", scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0)), density: Grid(GRID))])";
        desk.write("room.bake.ron", text.replace("GRID", grid));
        desk.bake("plan room.glb")
    };
    smoke("file: \"smoke.vdb\"").expect(2, &["smoke", "smoke.vdb", "several grids", "half", "turned"]);
    smoke("file: \"smoke.vdb\", name: \"surface\"").expect(2, &["level set"]);
    smoke("file: \"none.vdb\"").expect(2, &["cannot read", "none.vdb"]);
    let planned = smoke("file: \"smoke.vdb\", name: \"half\", place: Fill");
    planned.expect(0, &[]);
    // Voxels −5…20, −9…15 and −5…15, and one more layer on every side.
    assert!(planned.out.contains("grid of 28 × 27 × 23 points"), "{}", planned.out);
}

/// Names of the effects that are on.
fn effects_on(plan: &Value) -> Vec<String> {
    let effects = plan["effects"].as_array().expect("a list").iter();
    effects.filter(|e| e["on"] == true).map(|e| e["name"].as_str().expect("text").to_owned()).collect()
}

#[test]
fn three_kinds_of_air_make_three_plans() {
    let desk = Desk::with_room();
    let vacuum = plan(&desk, "");
    let grey = plan(&desk, "--fog sigma_t=0.5,albedo=1");
    desk.write(
        "room.bake.ron",
        "Bake(media: [Medium(name: \"smoke\", scatter: Sigma(s: (0.5, 0.4, 0.3), a: (0.1, 0.1, 0.2)), \
         density: Exponential(base_m: 0, scale_height_m: 1), phase: HenyeyGreenstein(0.5))])",
    );
    let smoke = plan(&desk, "");
    let of_air = ["attenuation", "absorption", "scattering", "multiple", "anisotropy", "heterogeneity", "colour"];
    let on = |plan: &Value| {
        let on = effects_on(plan);
        of_air.into_iter().filter(|name| on.iter().any(|on| on == name)).collect::<Vec<_>>()
    };
    assert_eq!(on(&vacuum), [""; 0]);
    assert_eq!(on(&grey), ["attenuation", "scattering", "multiple"]);
    assert_eq!(on(&smoke), of_air);
    assert!(vacuum["mode"].is_null() && !grey["mode"].is_null());
    for effect in smoke["effects"].as_array().expect("a list") {
        assert!(effect["bound"].is_null() || effect["bound"].as_f64() >= Some(0.0), "{effect}");
    }
}

#[test]
fn what_lies_below_the_tolerance_is_left_out_and_force_overrules_it() {
    let desk = Desk::with_room();
    let thin = "--fog sigma_t=1e-9,albedo=0.9";
    let ended = desk.bake(&format!("plan room.glb {thin}"));
    ended.expect(0, &[]);
    let flat = ended.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat.contains("effect off attenuation ≤") && flat.contains("below the tolerance of 0.001"), "{flat}");
    let left = plan(&desk, thin);
    assert!(left["mode"].is_null() && !effects_on(&left).contains(&"scattering".to_owned()));
    assert!(effects_on(&plan(&desk, &format!("{thin} --tolerance 0"))).contains(&"scattering".to_owned()));
    let forced = plan(&desk, &format!("{thin} --force-effect attenuation=on --force-effect scattering=on"));
    assert!(effects_on(&forced).contains(&"scattering".to_owned()) && !forced["mode"].is_null());
    let thick = plan(&desk, "--fog sigma_t=1,albedo=0.9 --force-effect scattering=off");
    assert!(!effects_on(&thick).contains(&"scattering".to_owned()));
    desk.bake("plan room.glb --force-effect multipel=off").expect(2, &["did you mean `multiple`?"]);
}
