//! Air from settings, side files and glTF extras: what is resolved, and what is refused.

use super::*;
use crate::scene::{Environment, Light, LightKind, MediaExtras};
use crate::settings::{Bounds, Medium as Record, Phase as PhaseRecord, Scatter as Look};
use crate::test_scenes::{closed_box, matte, quad, scene as scene_of};
use bake_optics::medium::{Bounds as Region, Ray};
use glam::Vec3;
use std::path::PathBuf;
use testkit::compare::Worst;

/// A room of 4 × 3 × 2 m, and a node that is a box of 1 × 1 × 2 m in it.
fn room() -> Scene {
    let walls = closed_box(Vec3::ZERO, Vec3::new(4.0, 3.0, 2.0), true, 0);
    let cloud = closed_box(Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 2.0), false, 0);
    let mut scene = scene_of(vec![walls, cloud], vec![matte(0.5)]);
    scene.instances[1].path = "Room/Cloud".into();
    scene
}

fn fog() -> Record {
    let scatter = Look::Sigma { s: [0.4, 0.3, 0.2], a: [0.1, 0.1, 0.1] };
    Record {
        name: "haze".into(),
        bounds: Bounds::Scene,
        density: Default::default(),
        scatter,
        phase: Default::default(),
    }
}

fn settings(media: Vec<Record>) -> Settings {
    Settings { media: Some(media), ..Settings::default() }
}

fn resolved(record: Record) -> Air {
    resolve(&settings(vec![record]), &mut room()).expect("valid").0
}

/// The refusal of a settings text with one medium.
fn refusal(ron: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("room.bake.ron");
    std::fs::write(&file, format!("Bake(media: [{ron}])")).expect("written");
    let settings = settings::read(&file).unwrap_or_else(|error| panic!("{ron}: {error}"));
    let mut scene = room();
    let error = resolve(&settings, &mut scene).expect_err(ron);
    assert_eq!(scene.instances.len(), 2, "a refused scene stays whole");
    error.to_string()
}

#[test]
fn without_media_there_is_no_air() {
    let (air, warnings) = resolve(&Settings::default(), &mut room()).expect("valid");
    assert!(air.is_empty() && warnings.is_empty());
}

#[test]
fn numbers_are_the_written_ones() {
    let scatter = resolved(fog()).media.media[0].scatter;
    assert_eq!((scatter.sigma_s, scatter.sigma_a), ([0.4, 0.3, 0.2], [0.1; 3]));
    let look = Look::Look { mean_free_path_m: 2.5, albedo: [0.9, 1.0, 0.0] };
    let scatter = resolved(Record { scatter: look, ..fog() }).media.media[0].scatter;
    assert_eq!((scatter.sigma_s, scatter.sigma_a[1]), ([0.9 * 0.4, 0.4, 0.0], 0.0));
}

#[test]
fn traits_follow_the_media() {
    let grey = Record { scatter: Look::Sigma { s: [0.4; 3], a: [0.0; 3] }, ..fog() };
    let air = resolved(grey.clone());
    assert!(air.is_grey() && air.is_isotropic() && air.is_homogeneous() && air.scatters() && !air.absorbs());
    assert!(!resolved(fog()).is_grey());
    assert!(!resolved(Record { phase: PhaseRecord::HenyeyGreenstein(0.1), ..grey.clone() }).is_isotropic());
    assert!(resolved(Record { phase: PhaseRecord::HenyeyGreenstein(0.0), ..grey.clone() }).is_isotropic());
    let layer = crate::settings::Density::Exponential { base_m: 0.0, scale_height_m: 1.0 };
    assert!(!resolved(Record { density: layer, ..grey }).is_homogeneous());
}

/// Closed forms of the optical depth, from the settings through to a ray.
#[test]
fn optical_depths_are_the_closed_forms() {
    use crate::settings::Density as D;
    let mut worst = Worst::new("optical depth through settings, relative", 1e-12);
    let unit = Look::Sigma { s: [0.5, 0.25, 2.0], a: [0.5, 0.75, 0.0] };
    let of = |density, bounds| Record { density, bounds, scatter: unit.clone(), ..fog() };
    let up = |x: f64, length: f64| Ray::new(DVec3::new(x, 0.0, 1.0), DVec3::Y, length);
    let (infinity, e) = (f64::INFINITY, std::f64::consts::E);
    let ball = Bounds::Sphere { centre: [2.0, 1.0, 1.0], radius: 0.5 };
    let cuboid = Bounds::Box { min: [0.0, 0.5, 0.0], max: [4.0, 1.75, 2.0] };
    let cases = [
        ("uniform, the room's 3 m", of(D::Uniform, Bounds::Scene), up(1.5, infinity), 3.0),
        ("uniform box", of(D::Uniform, cuboid), up(1.5, infinity), 1.25),
        // Chord of a ball at a quarter of a metre beside its centre.
        ("uniform ball", of(D::Uniform, ball), up(2.25, infinity), 2.0 * 0.1875f64.sqrt()),
        ("node", of(D::Uniform, Bounds::Node("Cloud".into())), up(1.5, infinity), 1.0),
        ("beside the node", of(D::Uniform, Bounds::Node("Room/Cloud".into())), up(2.5, infinity), 0.0),
        // ∫ 0.5 (y − 1) from 1 to 3.
        ("linear", of(D::Linear { zero_m: 1.0, slope_per_m: 0.5 }, Bounds::Scene), up(1.5, infinity), 1.0),
        // H e^{base/H} without end.
        (
            "exponential",
            of(D::Exponential { base_m: 2.0, scale_height_m: 2.0 }, Bounds::Unbounded),
            up(1.5, infinity),
            2.0 * e,
        ),
        // Straight up from a planet: H e^{−h/H} at altitude h, and h is 0 here.
        (
            "planet",
            of(D::Planet { centre: [1.5, -100.0, 1.0], radius_m: 100.0, scale_height_m: 8.0 }, Bounds::Unbounded),
            up(1.5, infinity),
            8.0,
        ),
    ];
    for (what, record, ray, length) in cases {
        let depth = resolved(record).media.optical_depth(&ray);
        for (channel, sigma_t) in [1.0, 1.0, 2.0].into_iter().enumerate() {
            worst.relative(depth[channel], sigma_t * length, || format!("{what}, channel {channel}"));
        }
    }
    worst.check();
}

#[test]
fn nodes_that_bound_air_are_no_surfaces() {
    let mut scene = room();
    let media = vec![Record { bounds: Bounds::Node("Cloud".into()), ..fog() }, fog()];
    let (air, _) = resolve(&settings(media), &mut scene).expect("valid");
    assert_eq!(scene.instances.iter().map(|i| i.path.as_str()).collect::<Vec<_>>(), ["node 0"]);
    assert!(matches!(&air.media.media[0].bounds, Region::Hull(planes) if planes.len() == 6));
    // The cloud does not stretch the scene's box.
    let mut scene = room();
    scene.instances[1].world_from_object = glam::Affine3A::from_scale(Vec3::new(-9.0, 1.0, 1.0));
    let media = vec![Record { bounds: Bounds::Node("Cloud".into()), ..fog() }];
    let (air, _) = resolve(&settings(media), &mut scene).expect("a mirrored box is a box");
    assert_eq!(air.scene, [DVec3::ZERO, DVec3::new(4.0, 3.0, 2.0)]);
    assert!(air.media.media[0].bounds.contains(DVec3::new(-15.0, 1.5, 1.0)));
}

/// Two nodes under one name are one region, and more than convex.
#[test]
fn nodes_apart_bound_one_medium() {
    let mut scene = room();
    let twin = crate::scene::Instance {
        path: "Room/Cloud".into(),
        world_from_object: glam::Affine3A::from_translation(Vec3::new(1.5, 0.0, 0.0)),
        ..scene.instances[1].clone()
    };
    scene.instances.push(twin);
    let media = vec![Record { bounds: Bounds::Node("Room".into()), ..fog() }];
    let (air, _) = resolve(&settings(media), &mut scene).expect("valid");
    let ray = Ray::new(DVec3::new(0.0, 1.5, 1.0), DVec3::X, 10.0);
    assert!(matches!(air.media.media[0].bounds, Region::Mesh(_)));
    assert!((air.media.media[0].optical_length(&ray) - 2.0).abs() < 1e-12);
    assert_eq!(scene.instances.len(), 1);
}

#[test]
fn refusals_name_medium_field_value_and_next_step() {
    let look = "scatter: Sigma(s: (1, 1, 1), a: (0, 0, 0))";
    let of = |rest: &str| format!("Medium(name: \"haze\", {look}, {rest})");
    let cases: &[(String, &[&str])] = &[
        ("Medium(name: \"haze\", scatter: Sigma(s: (1, -1, 1), a: (0, 0, 0)))".into(), &["scatter.s", "-1", "0 to"]),
        ("Medium(name: \"haze\", scatter: Sigma(s: (1, 1, 1), a: (0, NaN, 0)))".into(), &["scatter.a", "NaN", "0 to"]),
        ("Medium(name: \"haze\", scatter: Sigma(s: (1, 1, 1), a: (0, inf, 0)))".into(), &["scatter.a", "inf"]),
        (
            "Medium(name: \"haze\", scatter: Look(mean_free_path_m: 0, albedo: (1, 1, 1)))".into(),
            &["scatter.mean_free_path_m", "is 0"],
        ),
        (
            "Medium(name: \"haze\", scatter: Look(mean_free_path_m: 1, albedo: (1, 1, 1.5)))".into(),
            &["scatter.albedo", "1.5", "0 to 1"],
        ),
        (of("phase: HenyeyGreenstein(1)"), &["phase", "is 1", "-0.999 to 0.999"]),
        (of("phase: HenyeyGreenstein(-1)"), &["phase", "is -1"]),
        (of("phase: HenyeyGreenstein(NaN)"), &["phase", "NaN"]),
        (of("phase: Linear(1.5)"), &["phase", "1.5", "-1 to 1"]),
        (of("phase: Legendre([])"), &["phase", "begins with 1"]),
        (of("phase: Legendre([1, 4])"), &["a_1", "is 4", "correct `phase`"]),
        (of("phase: Legendre([1, 2.7, 0])"), &["Legendre", "180°", "more terms"]),
        (of("phase: Table(\"none.txt\")"), &["none.txt", "cannot read", "check the path"]),
        (of("bounds: Box(min: (0, 0, 0), max: (1, 0, 1))"), &["bounds", "min below max"]),
        (of("bounds: Box(min: (0, 0, 0), max: (1, inf, 1))"), &["bounds", "inf"]),
        (of("bounds: Sphere(centre: (0, 0, 0), radius: 0)"), &["bounds.radius", "is 0"]),
        (of("bounds: Sphere(centre: (0, 0, 0), radius: -1)"), &["bounds.radius", "is -1"]),
        (of("bounds: Unbounded"), &["bounds", "Exponential, Planet"]),
        (of("bounds: Unbounded, density: Linear(zero_m: 0, slope_per_m: 1)"), &["bounds", "Exponential, Planet"]),
        (of("bounds: Node(\"Clod\")"), &["Clod", "did you mean `Cloud`?"]),
        (of("density: Exponential(base_m: 0, scale_height_m: 0)"), &["density.scale_height_m", "is 0"]),
        (of("density: Exponential(base_m: NaN, scale_height_m: 1)"), &["density.base_m", "NaN"]),
        (of("density: Planet(centre: (0, 0, 0), radius_m: -1, scale_height_m: 1)"), &["density.radius_m", "is -1"]),
        (of("density: Planet(centre: (0, 0, 0), radius_m: 1, scale_height_m: 0)"), &["density.scale_height_m", "is 0"]),
        (of("density: Linear(zero_m: 0, slope_per_m: inf)"), &["density.slope_per_m", "inf"]),
    ];
    for (ron, parts) in cases {
        let message = refusal(ron);
        for part in parts.iter().chain(&["haze"]) {
            assert!(message.contains(part), "`{part}` is missing in: {message}");
        }
    }
}

#[test]
fn meshes_that_enclose_nothing_are_refused_by_name() {
    let mut scene = room();
    scene.meshes[1].triangles.pop();
    let media = settings(vec![Record { bounds: Bounds::Node("Cloud".into()), ..fog() }]);
    let message = resolve(&media, &mut scene).expect_err("open").to_string();
    assert!(["haze", "Cloud", "not closed", "fill holes"].iter().all(|part| message.contains(part)), "{message}");
    let mut scene = room();
    scene.meshes[1].triangles[0].swap(0, 1);
    let message = resolve(&media, &mut scene).expect_err("turned").to_string();
    assert!(message.contains("both ways") && message.contains("recalculate normals"), "{message}");
    let mut flat = scene_of(vec![quad(Vec3::ZERO, Vec3::X, Vec3::Z, 0)], vec![matte(0.5)]);
    let message = resolve(&settings(vec![fog()]), &mut flat).expect_err("flat").to_string();
    assert!(message.contains("no volume") && message.contains("Box("), "{message}");
}

#[test]
fn tables_are_read_and_normalised() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("phase.txt");
    let resolve_text = |text: &str| {
        std::fs::write(&file, text).expect("written");
        phase::resolve(&PhaseRecord::Table(file.clone()), "haze")
    };
    // 1 + cos θ at every degree: the linear phase function with a1 = 1, whose mean cosine is 1/3.
    let lines: String =
        (0..=180).map(|d| format!("{d}\t{} # value\r\n", 7.0 * (1.0 + f64::from(d).to_radians().cos()))).collect();
    let table = resolve_text(&format!("# angle, value\n\n{lines}")).expect("valid");
    let mut worst = Worst::new("table against (1 + cos)/4π, absolute", 2e-5);
    for i in 0..100 {
        let cos = f64::from(i) / 50.0 - 1.0;
        worst.record((table.eval(cos) - (1.0 + cos) / (4.0 * std::f64::consts::PI)).abs(), || cos.to_string());
    }
    worst.check();
    assert!((table.mean_cosine() - 1.0 / 3.0).abs() < 1e-4);
    let refused = [
        ("0 1\n180", ":2: 1 fields"),
        ("0 1\n90 x\n180 1", ":2: `x` is no number"),
        ("0 1\n180 -1", "values must be finite and at least 0"),
        ("0 1\n180 NaN", "finite"),
        ("0 0\n180 0", "zero everywhere"),
        ("0 1\n90 1", "0 to 180"),
        ("0 1\n90 1\n80 1\n180 1", "ascend"),
        ("", "at least 2"),
    ];
    for (text, part) in refused {
        let message = resolve_text(text).expect_err(text).to_string();
        assert!(
            message.contains(part) && message.contains("haze") && message.contains("phase.txt"),
            "{text}: {message}"
        );
    }
}

#[test]
fn extras_are_media_unless_the_settings_have_some() {
    let json = r#"[{"name": "mist", "scatter": {"Sigma": {"s": [1, 1, 1], "a": [0, 0, 0]}}, "phase": {"HenyeyGreenstein": 0.25}}]"#;
    let mut scene = room();
    scene.media_extras = Some(MediaExtras { json: json.into(), folder: PathBuf::from("scenes") });
    let (air, _) = resolve(&Settings::default(), &mut scene).expect("valid");
    assert_eq!(air.names, ["mist"]);
    assert_eq!(air.media.media[0].phase, Phase::HenyeyGreenstein { g: 0.25 });
    assert_eq!(resolve(&settings(vec![fog()]), &mut scene).expect("valid").0.names, ["haze"]);
    assert!(resolve(&settings(vec![]), &mut scene).expect("valid").0.is_empty());
    let table = json.replace(r#"{"HenyeyGreenstein": 0.25}"#, r#"{"Table": "p.txt"}"#);
    let wrong = [
        (json.replace("[1, 1, 1]", "[1, -1, 1]"), "media[\"mist\"].scatter.s"),
        (json.replace("Sigma", "Sgma"), "bake_media"),
        (json.replace("0.25", "\"much\""), "[0].phase"),
        (table, "scenes/p.txt"),
        ("7".into(), "bake_media"),
    ];
    for (json, part) in wrong {
        scene.media_extras = Some(MediaExtras { json, folder: PathBuf::from("scenes") });
        let message = resolve(&Settings::default(), &mut scene).expect_err(part).to_string();
        assert!(message.contains(part), "`{part}` is missing in: {message}");
    }
}

#[test]
fn media_that_are_hardly_meant_are_told() {
    let warnings = |record: Record, scene: &mut Scene| resolve(&settings(vec![record]), scene).expect("valid").1;
    let dense = |sigma| Record { scatter: Look::Sigma { s: [sigma; 3], a: [0.0; 3] }, ..fog() };
    assert_eq!(warnings(fog(), &mut room()), []);
    assert!(matches!(warnings(dense(1e4), &mut room())[..], [AirWarning::Fine { .. }]));
    assert!(matches!(warnings(dense(0.0), &mut room())[..], [AirWarning::NoEffect { .. }]));
    let bounds = Bounds::Sphere { centre: [90.0, 0.0, 0.0], radius: 1.0 };
    assert!(matches!(warnings(Record { bounds, ..fog() }, &mut room())[..], [AirWarning::Apart { .. }]));

    // A grid lies where its file says: one beside the room, one partly in it.
    let grid = |name: &str| crate::settings::Density::Grid {
        file: PathBuf::from(format!("{}/tests/data/air/several.vdb", env!("CARGO_MANIFEST_DIR"))),
        name: Some(name.into()),
        size: None,
        values: Default::default(),
        place: Default::default(),
        z_up: false,
    };
    assert!(matches!(
        warnings(Record { density: grid("turned"), ..fog() }, &mut room())[..],
        [AirWarning::Apart { .. }]
    ));
    assert_eq!(warnings(Record { density: grid("half"), ..fog() }, &mut room()), []);

    let lit = |mut scene: Scene| {
        let kind = LightKind::Directional { direction: Vec3::NEG_Y, angular_radius: 0.0 };
        scene.lights.push(Light { path: "sun".into(), color: Vec3::ONE, kind });
        scene.environment = Some(Environment { width: 1, height: 1, radiance: vec![Vec3::ONE], rotation: 0.0 });
        scene
    };
    let cloud = Bounds::Box { min: [-90.0; 3], max: [90.0; 3] };
    assert_eq!(warnings(Record { bounds: cloud.clone(), ..dense(0.05) }, &mut lit(room())), []);
    let lost = warnings(Record { bounds: cloud, ..dense(2.0) }, &mut lit(room()));
    let lights: Vec<&str> = lost
        .iter()
        .filter_map(|w| match w {
            AirWarning::Lost { light, .. } => Some(light.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(lights, ["sun", "the sky"]);
}

#[test]
fn summaries_are_closed_forms() {
    let layer = crate::settings::Density::Exponential { base_m: 1.0, scale_height_m: 2.0 };
    let summary = &resolved(Record { density: layer, bounds: Bounds::Unbounded, ..fog() }).summaries()[0];
    let peak = 0.5f64.exp();
    assert!((summary.peak_density - peak).abs() < 1e-12, "densest on the floor: e^(1/2)");
    assert!((summary.mean_free_path_m[0].expect("stops light") - 2.0 / peak).abs() < 1e-12);
    assert_eq!(summary.bounds, Extent { shape: "unbounded", corners: None });
    let summary = &resolved(fog()).summaries()[0];
    // The diagonal of 4 × 3 × 2 m.
    assert!((summary.optical_depth[0] - 0.5 * 29f64.sqrt()).abs() < 1e-12);
    assert!((summary.albedo[0] - 0.8).abs() < 1e-12);
    assert_eq!(summary.bounds.corners, Some([DVec3::ZERO, DVec3::new(4.0, 3.0, 2.0)]));
}
