//! `docs/manifest.schema.json` describes what is written, field by field.
//!
//! The checker below knows the keywords that the schema uses and refuses all others. A full validator from the registry
//! would switch serde_json's float parser for every test of the workspace (feature `float_roundtrip`).

use bake_formats::float_image::{FloatImage, PixelFormat, Quantity};
use bake_formats::manifest::*;
use bake_formats::{MediumRecord, PackageWriter, Term};
use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};

fn schema() -> Value {
    let path = testkit::reference::workspace().join("docs/manifest.schema.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// One of each kind of bounds, density and phase function.
fn media() -> Vec<MediumRecord> {
    use bake_formats::medium::{BoundsRecord as B, DensityRecord as D, PhaseRecord as P, ScatterRecord};
    let (zero, one) = (DVec3::ZERO, DVec3::ONE);
    let bounds = [
        B::Unbounded,
        B::Box { min: zero, max: one },
        B::Sphere { centre: zero, radius: 1.0 },
        B::Hull { planes: vec![one.extend(1.0)] },
        B::Mesh { positions: vec![zero, one], triangles: vec![[0, 1, 1]] },
        B::Unbounded,
    ];
    let densities = [
        D::Uniform,
        D::Linear { zero_m: 1.0, slope_per_m: -0.5 },
        D::Exponential { base_m: 0.0, scale_height_m: 2.0 },
        D::Planet { centre: zero, radius_m: 9.0, scale_height_m: 2.0 },
        D::Grid { file: Some("room.medium.00.exr".into()), size: [1, 2, 3], world_from_grid: [one; 4] },
        D::Grid { file: None, size: [1, 2, 3], world_from_grid: [one; 4] },
    ];
    let phases = [
        P::Isotropic,
        P::Rayleigh,
        P::HenyeyGreenstein(0.5),
        P::Linear(0.5),
        P::Legendre(vec![1.0, 0.5]),
        P::Table { angles: vec![0.0, 3.0], values: vec![1.0, 2.0] },
    ];
    let scatter = ScatterRecord::Sigma { s: [0.5; 3], a: [0.0; 3] };
    let parts = bounds.into_iter().zip(densities).zip(phases);
    let record = |((bounds, density), phase)| MediumRecord {
        name: "haze".into(),
        bounds,
        density,
        scatter: scatter.clone(),
        phase,
    };
    parts.map(record).collect()
}

/// A written manifest in which nothing is absent.
fn written() -> Value {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = PackageWriter::create(folder.path(), "room").unwrap();
    let mut image = FloatImage::new(1, 1);
    for quantity in [Quantity::Irradiance, Quantity::IrradianceVariance, Quantity::Radiance, Quantity::ShRadiance] {
        image.push_rgb(&format!("{quantity:?}"), quantity, &[[1.0, 2.0, 3.0]]);
    }
    image.push("samples.Y", Quantity::Samples, vec![4.0]);
    image.push("offset.X", Quantity::Offset, vec![0.5]);
    image.push("validity.Y", Quantity::Validity, vec![1.0]);
    let [lightmap, terms] = [("lightmap.00.exr", PixelFormat::F32), ("terms.00.exr", PixelFormat::F16)]
        .map(|(name, pixels)| writer.add_image(name, &image, pixels).unwrap());
    writer.add_bytes("baked.glb", b"glTF").unwrap();
    let scene = Source { file: "room.glb".into(), blake3: "0".repeat(64) };
    let mut manifest = Manifest::new("room", scene, Settings::new(json!({ "bounces": null })));
    let (position, direction, radius, angular_radius) = (Vec3::ONE, Vec3::NEG_Y, 0.001, 0.0);
    let profile = Some(ProfileRecord { axis: Vec3::NEG_Y, legendre: vec![0.25, 0.5] });
    let point = LightKind::Point { position, radius, range: None, profile: profile.clone() };
    let (inner_angle, outer_angle, range) = (0.1, 0.5, Some(4.0));
    let spot = LightKind::Spot { position, direction, inner_angle, outer_angle, radius, range, profile };
    let sun = LightKind::Directional { direction, angular_radius };
    manifest.lights =
        [point, spot, sun].map(|kind| LightRecord { path: "lamp".into(), color: Vec3::ONE, kind }).to_vec();
    manifest.terms = Term::ALL.to_vec();
    manifest.media = media().iter().map(|record| serde_json::to_value(record).unwrap()).collect();
    manifest.warnings = vec!["one".into()];
    manifest.environment =
        Some(EnvironmentRecord { size: [1, 1], rotation: 0.5, mean_radiance: Vec3::ONE, file: Some(lightmap.clone()) });
    manifest.error_estimate = Some(ErrorEstimate { relative_standard_error: 0.01, unbaked_share: 0.0 });
    let (uv_offset, uv_scale) = (Vec2::ZERO, Vec2::ONE);
    let (path, name) = ("root/a".into(), "a".into());
    manifest.instances = vec![InstanceRecord { baked_node: 0, node: 7, path, name, page: 0, uv_offset, uv_scale }];
    let (file, origin, spacing) = (lightmap.clone(), Vec3::ZERO, Vec3::ONE);
    let (visibility, points) = (Some(terms.clone()), vec![Vec3::ZERO, Vec3::ONE]);
    manifest.probes = Some(ProbeGrid { file, visibility, origin, spacing, count: [2, 1, 1], points });
    manifest.fog_volume = manifest.probes.clone().map(|grid| ProbeGrid { visibility: None, points: vec![], ..grid });
    manifest.pages =
        vec![PageRecord { width: 1, height: 1, sh1: Some(terms.clone()), raw: Some(terms.clone()), lightmap, terms }];
    let path = writer.finish(manifest).unwrap();
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// First violation of a schema, with its place.
fn check(root: &Value, schema: &Value, value: &Value, at: &str) -> Result<(), String> {
    for (keyword, rule) in schema.as_object().ok_or("no object")? {
        let holds = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" => true,
            "$ref" => {
                let target = rule.as_str().and_then(|name| root.pointer(name.trim_start_matches('#')));
                check(root, target.ok_or(format!("no {rule}"))?, value, at)?;
                true
            }
            "type" => has_type(rule.as_str().unwrap(), value),
            "const" => rule == value,
            "enum" => rule.as_array().unwrap().contains(value),
            "minimum" => value.as_f64().is_none_or(|number| number >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|number| number <= rule.as_f64().unwrap()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > rule.as_f64().unwrap()),
            "minItems" => value.as_array().is_none_or(|list| list.len() as u64 >= rule.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as u64 <= rule.as_u64().unwrap()),
            "pattern" => value.as_str().is_none_or(|text| matches(rule.as_str().unwrap(), text)),
            "required" => rule.as_array().unwrap().iter().all(|name| value.get(name.as_str().unwrap()).is_some()),
            "additionalProperties" => {
                let known = schema["properties"].as_object().unwrap();
                assert_eq!(rule, false);
                value.as_object().is_none_or(|fields| fields.keys().all(|name| known.contains_key(name)))
            }
            "properties" => {
                for (name, rule) in rule.as_object().unwrap() {
                    value.get(name).map_or(Ok(()), |field| check(root, rule, field, &format!("{at}/{name}")))?;
                }
                true
            }
            "items" => {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, rule, item, &format!("{at}/{index}"))?;
                }
                true
            }
            "anyOf" => rule.as_array().unwrap().iter().any(|one| check(root, one, value, at).is_ok()),
            "oneOf" => rule.as_array().unwrap().iter().filter(|one| check(root, one, value, at).is_ok()).count() == 1,
            other => return Err(format!("the checker does not know '{other}'")),
        };
        if !holds {
            return Err(format!("{at}: {keyword} {rule} does not hold for {value}"));
        }
    }
    Ok(())
}

fn has_type(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("type {other}"),
    }
}

/// The two patterns of the schema.
fn matches(pattern: &str, text: &str) -> bool {
    match pattern {
        "^[0-9a-f]{64}$" => text.len() == 64 && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f')),
        r"^[^/\\:]+$" => !text.is_empty() && !text.contains(['/', '\\', ':']),
        other => panic!("pattern {other}"),
    }
}

/// Pointers to every field of every object.
fn fields(value: &Value, at: &str, found: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(map) => map.iter().map(|(name, child)| (format!("{at}/{name}"), child)).collect(),
        Value::Array(list) => list.iter().enumerate().map(|(i, child)| (format!("{at}/{i}"), child)).collect(),
        _ => return,
    };
    for (pointer, child) in children {
        if value.is_object() {
            found.push(pointer.clone());
        }
        fields(child, &pointer, found);
    }
}

/// What stands in the manifest as free JSON.
fn is_free(pointer: &str) -> bool {
    ["/settings/values/", "/plan/"].iter().any(|free| pointer.starts_with(free))
}

#[test]
fn written_manifests_satisfy_the_schema() {
    let (schema, written) = (schema(), written());
    check(&schema, &schema, &written, "").unwrap();
    let scene = Source { file: "room.glb".into(), blake3: "0".repeat(64) };
    let empty = Manifest::new("room", scene, Settings::new(Value::Null));
    check(&schema, &schema, &serde_json::from_slice(&empty.to_bytes()).unwrap(), "").unwrap();
}

/// The schema is closed: no field can be missing, renamed, or of another kind.
#[test]
fn every_change_of_a_field_breaks_the_schema() {
    let (schema, written) = (schema(), written());
    let mut pointers = Vec::new();
    fields(&written, "", &mut pointers);
    pointers.retain(|pointer| !is_free(pointer));
    assert!(pointers.len() > 100, "{pointers:?}");
    for pointer in pointers {
        let (parent, name) = pointer.rsplit_once('/').unwrap();
        let mut renamed = written.clone();
        let value = object_at(&mut renamed, parent).remove(name).unwrap();
        assert!(check(&schema, &schema, &renamed, "").is_err(), "{pointer} may be missing");
        object_at(&mut renamed, parent).insert(name.into(), value.clone());
        object_at(&mut renamed, parent).insert("surplus".into(), value);
        assert!(check(&schema, &schema, &renamed, "").is_err(), "{parent} takes other fields");
        if !["/plan", "/settings/values"].contains(&pointer.as_str()) {
            let mut other = written.clone();
            *other.pointer_mut(&pointer).unwrap() = json!({ "of": "another kind" });
            assert!(check(&schema, &schema, &other, "").is_err(), "{pointer} may be anything");
        }
    }
}

fn object_at<'a>(value: &'a mut Value, pointer: &str) -> &'a mut serde_json::Map<String, Value> {
    value.pointer_mut(pointer).and_then(Value::as_object_mut).unwrap()
}
