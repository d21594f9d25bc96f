//! The commented default that `bake init` writes.

/// A settings file that states every default, explained.
pub const TEMPLATE: &str = r#"// Settings of a bake. Every value here is the default: delete what you do not change.
// Every key `a_b` is also a flag `--a-b` of `bake run` and `bake plan`, `media` is `--fog`; the flag wins.
// File names are relative to this file. Units: metres, degrees, seconds; light in cd, lux and cd/m².
Bake(
    // Accuracy
    quality: Medium,        // Preview, Medium, High, Final: standard error 10, 4, 2, 1 % of the page's median
    target_error: None,     // another standard error, as a share: 0.015
    samples: None,          // so many samples per texel, rounded up to a multiple of 8, whatever the error
    bounces: None,          // None: unlimited; 0: direct light only
    seed: 0,
    time_budget: None,      // seconds after which sampling ends; such bakes do not repeat bit for bit

    // Atlas
    texels_per_m: 16.0,
    page_size: 1024,        // texels, width and height
    max_pages: None,        // a number: the density is scaled down until all fits
    padding: 2,             // texels between charts

    // Light
    scene: None,            // "name" or "number" of the glTF scene; None: the file's default
    sky: None,              // (900, 1000, 1200): cd/m² from every direction
    sun: None,              // Sun(azimuth_deg: 120, elevation_deg: 35, lux: 80000, colour: (1, 0.95, 0.9), angular_diameter_deg: 0.53)
    env: None,              // Env(file: "sky.hdr", rotation_deg: 0, scale: 1), instead of `sky`
    light_units: Gltf,      // of the file's lights; Gltf: cd and lux; Watts; Unitless: W/sr (both at 683 lm/W)
    light_scale: 1.0,       // factor on them
    light_radius_m: 0.001,  // smallest radius of point and spot lights
    ies: {},                // {"Lamp": "lamp.ies"}: profiles by node name or path
    unlit: Black,           // unlit materials: Black only block light, Reflect, Emit(1000) in cd/m²
    bake_instanced: false,  // GPU-instanced meshes take lightmaps too

    // Effects
    tolerance: 0.001,       // what provably adds less than this share of the median irradiance is left out; 0: nothing is
    force_effect: {},       // {Multiple: false, Colour: true}: off or on whatever the plan would choose; also Attenuation, Absorption,
                            // Scattering, Anisotropy, Heterogeneity, OwnPlane, Indirect, Environment

    // Air
    mode: Auto,             // how light in the air is solved: Walk (unbiased, slow), Grid (fast), Tables (for keep_paths), Paper (published, biased); Auto: the plan chooses
    media: None,            // [Medium(bounds: Scene, scatter: Look(mean_free_path_m: 20, albedo: (0.9, 0.9, 0.9)), phase: HenyeyGreenstein(0.3))]
    probes: None,           // Probes(spacing_m: 1.0): over the scene; with bounds: Box(min: (0, 0, 0), max: (4, 3, 4)) over a box;
                            // with origin: (0.5, 0.5, 0.5), count: (4, 3, 4) exactly there; with points: [(0.5, 1.6, 2), (3, 1.6, 2)]
                            // one by one; visibility: true adds how far they see
    fog_volume: None,       // FogVolume(spacing_m: 0.5): light at cells around the air, for volumetric rendering
    keep_vacuum: false,     // also the total without air, beside the terms

    // Output
    sh1: false,             // also spherical harmonics (l ≤ 1) for normal maps
    half: false,            // 16-bit floats
    keep_paths: false,      // also the paths, for other air by `bake refog`; solves by tables
    keep_raw: false,        // also the pages before seams were stitched and gaps filled

    // Single nodes, by name or path
    nodes: {},              // {"Statue": Node(texels_per_m: 64), "Roof/Bolts": Node(lightmap: false)}
)
"#;

#[cfg(test)]
mod tests {
    use super::super::{Settings, file::parse};
    use super::TEMPLATE;

    #[test]
    fn template_states_the_default() {
        let settings = parse("template".as_ref(), TEMPLATE.to_owned()).expect("the template parses");
        assert_eq!(settings, Settings::default());
    }

    #[test]
    fn template_states_every_key() {
        let json = serde_json::to_value(Settings::default()).expect("serialises");
        for key in json.as_object().expect("a record").keys() {
            assert!(TEMPLATE.contains(&format!("    {key}: ")), "`{key}` is not in the template");
        }
    }

    /// The values shown in comments are ones that parse and are allowed.
    #[test]
    fn template_comments_show_valid_values() {
        let mut shown = 0;
        for line in TEMPLATE.lines() {
            let (Some((key, _)), Some((_, comment))) = (line.trim().split_once(": "), line.split_once("// ")) else {
                continue;
            };
            let Some(example) = example_of(comment) else { continue };
            let text = format!("Bake({key}: {example})");
            let settings = parse("example".as_ref(), text.clone()).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_ne!(settings, Settings::default(), "{text} changes nothing");
            settings.check().unwrap_or_else(|error| panic!("{text}: {error}"));
            shown += 1;
        }
        assert_eq!(shown, 9, "sky, sun, env, ies, force_effect, media, probes, fog_volume and nodes show a value");
    }

    /// The bracketed value or record with which a comment begins, if it does.
    fn example_of(comment: &str) -> Option<&str> {
        let open = comment.find(['(', '[', '{'])?;
        comment[..open].chars().all(char::is_alphanumeric).then_some(())?;
        let mut depth = 0;
        for (index, character) in comment.char_indices().skip(open) {
            match character {
                '(' | '[' | '{' => depth += 1,
                ')' | ']' | '}' => depth -= 1,
                _ => continue,
            }
            if depth == 0 {
                return Some(&comment[..=index]);
            }
        }
        None
    }
}
