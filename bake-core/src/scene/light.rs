//! Punctual lights into world space and SI units, the sun of the settings, IES profiles by name.

use super::document::{Document, LightRecord};
use super::error::{Fault, Place, Refusal, lookup};
use super::ies;
use super::light_units;
use super::nodes::Placed;
use super::options::{Ies, LightUnits, LoadOptions, Sun};
use super::warning::{WarningKind, Warnings};
use super::{Light, LightKind, Profile};
use glam::{DAffine3, DVec3, Vec3};
use std::collections::BTreeSet;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// All lights of the placed nodes, then the sun of the settings.
pub(super) fn load(
    document: &Document,
    placed: &[Placed],
    options: &LoadOptions,
    warnings: &mut Warnings,
) -> Result<Vec<Light>, Refusal> {
    let list = document.extensions.lights.as_ref().map(|l| l.lights.as_slice()).unwrap_or_default();
    let mut used = BTreeSet::new();
    let mut lights = Vec::new();
    for node in placed {
        let Some(reference) = &node.node.extensions.light else { continue };
        let at = Place::entry("nodes", node.index as usize);
        let from = at.field("extensions.KHR_lights_punctual.light");
        let record = lookup(list, "extensions.KHR_lights_punctual.lights", reference.light, &from)?;
        let place = Place::entry("extensions.KHR_lights_punctual.lights", reference.light as usize);
        let profile = find_profile(record, node, options, &mut used);
        lights.push(convert(record, node, profile, options, &place)?);
    }
    for (name, ies) in options.ies.iter().filter(|(name, _)| !used.contains(name.as_str())) {
        // A package remembers its content.
        ies::read(&ies.file)?;
        let message = format!(
            "the settings give an IES profile to `{name}`, but no point or spot light or its node is called so"
        );
        warnings.push(WarningKind::UnusedSetting, &Place::root("ies"), message);
    }
    if options.light_units == LightUnits::Gltf && !lights.is_empty() {
        let generator = document.asset.as_ref().and_then(|asset| asset.generator.as_deref());
        light_units::warn(list, generator.unwrap_or_default(), warnings);
    }
    if let Some(sun) = &options.sun {
        lights.push(sunlight(sun)?);
    }
    Ok(lights)
}

fn find_profile<'a>(
    record: &'a LightRecord,
    node: &'a Placed,
    options: &'a LoadOptions,
    used: &mut BTreeSet<&'a str>,
) -> Option<&'a Ies> {
    if record.kind == "directional" {
        return None;
    }
    let names = [record.name.as_deref(), node.node.name.as_deref(), Some(&node.path)];
    let (name, ies) = names.into_iter().flatten().find_map(|name| options.ies.get_key_value(name))?;
    used.insert(name);
    Some(ies)
}

fn convert(
    record: &LightRecord,
    node: &Placed,
    ies: Option<&Ies>,
    options: &LoadOptions,
    place: &Place,
) -> Result<Light, Refusal> {
    let tint = tint(record, place)?;
    let position = node.world.translation.as_vec3();
    let axes = Axes::of(&node.world).map_err(|fault| fault.at(&Place::entry("nodes", node.index as usize)))?;
    let range = range(record, place)?;
    let radius = options.min_light_radius;
    let (profile, candela) = match ies {
        Some(ies) => axes.profile(ies).map(|(profile, candela)| (Some(profile), candela))?,
        None => (None, intensity(record, place)? * options.light_units.candela_factor() * options.light_scale),
    };
    let kind = match record.kind.as_str() {
        "point" => LightKind::Point { position, radius, range, profile },
        "spot" => {
            let [inner, outer] = cone(record, place)?;
            let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
            LightKind::Spot { position, direction: axes.travel, cos_inner, cos_outer, radius, range, profile }
        }
        "directional" => {
            let lux = intensity(record, place)? * options.light_units.lux_factor() * options.light_scale;
            let kind = LightKind::Directional { direction: axes.travel, angular_radius: 0.0 };
            return Ok(Light { path: node.path.clone(), color: tint * lux, kind });
        }
        other => return Err(Fault::value(format!("`{other}`"), "point, spot or directional").at(&place.field("type"))),
    };
    Ok(Light { path: node.path.clone(), color: tint * candela, kind })
}

fn tint(record: &LightRecord, place: &Place) -> Result<Vec3, Refusal> {
    let tint = Vec3::from(record.color.unwrap_or([1.0; 3]));
    if tint.is_finite() && tint.min_element() >= 0.0 {
        return Ok(tint);
    }
    Err(Fault::value(tint, "three numbers of 0 or more").at(&place.field("color")))
}

fn intensity(record: &LightRecord, place: &Place) -> Result<f32, Refusal> {
    let intensity = record.intensity.unwrap_or(1.0);
    if (0.0..=1e30).contains(&intensity) {
        return Ok(intensity);
    }
    Err(Fault::value(intensity, "0 or more, finite").at(&place.field("intensity")))
}

fn range(record: &LightRecord, place: &Place) -> Result<Option<f32>, Refusal> {
    match record.range {
        Some(range) if range > 0.0 && range.is_finite() => Ok(Some(range)),
        Some(range) => Err(Fault::value(range, "above 0").at(&place.field("range"))),
        None => Ok(None),
    }
}

/// Inner and outer cone angle, radians; KHR_lights_punctual: 0 ≤ inner < outer ≤ π/2.
fn cone(record: &LightRecord, place: &Place) -> Result<[f32; 2], Refusal> {
    let Some(spot) = &record.spot else {
        return Err(Fault::value("absent", "an object: spot lights need it").at(&place.field("spot")));
    };
    let (inner, outer) = (spot.inner_cone_angle.unwrap_or(0.0), spot.outer_cone_angle.unwrap_or(FRAC_PI_4));
    // Exporters write π/2 rounded up.
    if !(0.0..=FRAC_PI_2 + 1e-5).contains(&outer) || outer == 0.0 {
        return Err(Fault::value(outer, "above 0, at most pi/2").at(&place.field("spot.outerConeAngle")));
    }
    if !(0.0..outer).contains(&inner) {
        return Err(Fault::value(inner, format!("0 or more, below {outer}")).at(&place.field("spot.innerConeAngle")));
    }
    Ok([inner, outer.min(FRAC_PI_2)])
}

/// Unit axes of a light's node; its scale does not matter.
struct Axes {
    /// The node's −Z.
    travel: Vec3,
    /// The node's +X, made perpendicular to `travel`.
    side: Vec3,
}

impl Axes {
    fn of(world: &DAffine3) -> Result<Self, Fault> {
        let travel = world.transform_vector3(DVec3::NEG_Z).try_normalize();
        let travel = travel
            .ok_or_else(|| Fault::value("scale 0", "a node whose −Z keeps a direction, as it carries a light"))?;
        let side = world.transform_vector3(DVec3::X).reject_from_normalized(travel).try_normalize();
        let side = side.unwrap_or_else(|| travel.any_orthonormal_vector());
        Ok(Self { travel: travel.as_vec3(), side: side.as_vec3() })
    }

    /// The profile turned with the node, and its greatest intensity in candela.
    fn profile(&self, ies: &Ies) -> Result<(Profile, f32), Refusal> {
        if !(ies.scale.is_finite() && ies.scale >= 0.0) {
            return Err(Fault::value(ies.scale, "0 or more").at(&Place::root("ies.scale")));
        }
        let (profile, candela) = ies::read(&ies.file)?.into_profile(self.travel, self.side);
        Ok((profile, candela * ies.scale))
    }
}

/// The sun of the settings; azimuth from −Z towards +X.
fn sunlight(sun: &Sun) -> Result<Light, Refusal> {
    let at = Place::root("sun");
    let check = |name: &str, value: f32, low: f32, high: f32| match (low..=high).contains(&value) {
        true => Ok(()),
        false => Err(Fault::value(value, format!("{low} to {high}")).at(&at.field(name))),
    };
    check("azimuth_deg", sun.azimuth_deg, -3600.0, 3600.0)?;
    check("elevation_deg", sun.elevation_deg, -90.0, 90.0)?;
    check("lux", sun.lux, 0.0, 1e30)?;
    check("colour", sun.color.min_element(), 0.0, 1e6)?;
    check("colour", sun.color.max_element(), 0.0, 1e6)?;
    check("angular_diameter_deg", sun.angular_diameter_deg, 0.0, 90.0)?;
    let (sin_a, cos_a) = f64::from(sun.azimuth_deg).to_radians().sin_cos();
    let (sin_e, cos_e) = f64::from(sun.elevation_deg).to_radians().sin_cos();
    let direction = -DVec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a).as_vec3();
    let angular_radius = sun.angular_diameter_deg.to_radians() / 2.0;
    let kind = LightKind::Directional { direction, angular_radius };
    Ok(Light { path: "sun".into(), color: sun.color * sun.lux, kind })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_shines_from_its_azimuth() {
        let direction = |azimuth_deg, elevation_deg| {
            let light = sunlight(&Sun { azimuth_deg, elevation_deg, ..Sun::default() }).expect("in range");
            let LightKind::Directional { direction, .. } = light.kind else { panic!("a sun is directional") };
            direction
        };
        for (azimuth, elevation, travel) in
            [(0.0, 0.0, Vec3::Z), (90.0, 0.0, Vec3::NEG_X), (180.0, 0.0, Vec3::NEG_Z), (33.0, 90.0, Vec3::NEG_Y)]
        {
            assert!((direction(azimuth, elevation) - travel).length() < 1e-7, "{azimuth}, {elevation}");
        }
        assert!(sunlight(&Sun { elevation_deg: 91.0, ..Sun::default() }).is_err());
        assert!(sunlight(&Sun { lux: f32::NAN, ..Sun::default() }).is_err());
    }

    #[test]
    fn axes_ignore_scale_and_mirror() {
        let world = DAffine3::from_scale(DVec3::new(-2.0, 3.0, 5.0));
        let axes = Axes::of(&world).expect("not flat");
        assert_eq!((axes.travel, axes.side), (Vec3::NEG_Z, Vec3::NEG_X));
        assert!(Axes::of(&DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0))).is_err());
    }

    fn converted(json: &str) -> Result<Light, Refusal> {
        let record: LightRecord = serde_json::from_str(json).expect("valid JSON");
        let node = super::super::document::Node::default();
        let world = DAffine3::from_translation(DVec3::ONE);
        let placed = Placed { index: 0, node: &node, path: "lamp".into(), world };
        convert(&record, &placed, None, &LoadOptions::default(), &Place::root("lights"))
    }

    #[test]
    fn absent_fields_read_as_the_extension_says() {
        // KHR_lights_punctual: colour white, intensity 1, no range, inner cone 0, outer cone π/4.
        let light = converted(r#"{"type":"spot","spot":{}}"#).expect("all defaults");
        assert_eq!(light.color, Vec3::ONE);
        let LightKind::Spot { position, direction, cos_inner, cos_outer, range, .. } = light.kind else {
            panic!("a spot")
        };
        assert_eq!((position, direction, cos_inner, range), (Vec3::ONE, Vec3::NEG_Z, 1.0, None));
        assert!((cos_outer - std::f32::consts::FRAC_1_SQRT_2).abs() < 1e-7);
        let light = converted(r#"{"type":"point","intensity":3,"color":[1,0.5,0],"range":7}"#).expect("a point");
        assert_eq!(light.color, Vec3::new(3.0, 1.5, 0.0));
        assert!(matches!(light.kind, LightKind::Point { range: Some(7.0), .. }));
    }

    #[test]
    fn cones_and_numbers_out_of_range_are_refused_by_field() {
        for (json, field) in [
            (r#"{"type":"spot"}"#, "lights.spot"),
            (r#"{"type":"spot","spot":{"outerConeAngle":1.6}}"#, "outerConeAngle"),
            (r#"{"type":"spot","spot":{"outerConeAngle":0}}"#, "outerConeAngle"),
            (r#"{"type":"spot","spot":{"innerConeAngle":0.8}}"#, "innerConeAngle"),
            (r#"{"type":"spot","spot":{"innerConeAngle":-0.1}}"#, "innerConeAngle"),
            (r#"{"type":"point","range":0}"#, "range"),
            (r#"{"type":"point","intensity":-1}"#, "intensity"),
            (r#"{"type":"point","color":[1,-1,0]}"#, "color"),
            (r#"{"type":"lamp"}"#, "type"),
        ] {
            let error = converted(json).expect_err(json).into_error(std::path::Path::new("a.gltf"));
            assert!(error.to_string().contains(field), "{json}: {error}");
        }
        // The exporters' π/2 rounded up is taken.
        assert!(converted(r#"{"type":"spot","spot":{"outerConeAngle":1.5707964}}"#).is_ok());
    }
}
