//! Every setting as a flag: a key `a_b` of the settings file is `--a-b` here, and the flag wins.
//!
//! Values that may be absent take `none`. Records are written `key=value,key=value`, colours `0.5` or `0.5/0.4/0.3`.

use crate::values::{self, Given};
use bake_core::settings::{
    EffectName, Env, FogVolume, LightUnits, Medium, Mode, Node, Probes, Quality, Rgb, Settings, Sun, Unlit,
};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;

/// The flags that the help leaves out to fit a screen.
const RARE: [&str; 15] = [
    "--scene",
    "--padding",
    "--nodes",
    "--bake-instanced",
    "--light-scale",
    "--light-radius-m",
    "--unlit",
    "--probes",
    "--fog-volume",
    "--keep-vacuum",
    "--tolerance",
    "--force-effect",
    "--half",
    "--keep-paths",
    "--keep-raw",
];

/// Names them below a command's help, but for those that the command has no use for.
pub fn rare(unused: &[&str]) -> String {
    let names: Vec<_> = RARE.into_iter().filter(|name| !unused.contains(name)).collect();
    let lines: Vec<_> = names.chunks(8).map(|names| names.join(", ")).collect();
    format!("More: {}. `bake init SCENE` explains them all.", lines.join(",\n"))
}

/// The flags.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SettingsFlags {
    /// preview, medium, high, final: standard error 10, 4, 2, 1 % of the page's median [default: medium]
    #[arg(long, value_name = "PRESET", help_heading = "Accuracy", value_parser = one_of(Quality::ALL), hide_possible_values = true)]
    quality: Option<Quality>,
    /// Another standard error: 0.015 or 1.5%
    #[arg(long, value_name = "SHARE", help_heading = "Accuracy", value_parser = values::optional(values::share))]
    target_error: Option<Given<f32>>,
    /// N samples per texel, rounded up to a multiple of 8, whatever the error
    #[arg(long, value_name = "N", help_heading = "Accuracy", value_parser = values::optional(values::plain::<u32>))]
    samples: Option<Given<u32>>,
    /// Follow at most N reflections; 0 is direct light only [default: none, unlimited]
    #[arg(long, value_name = "N", help_heading = "Accuracy", value_parser = values::optional(values::plain::<u32>))]
    bounces: Option<Given<u32>>,
    /// Seed of all random numbers [default: 0]
    #[arg(long, value_name = "N", help_heading = "Accuracy", value_parser = values::plain::<u32>)]
    seed: Option<u32>,
    /// Stop sampling after this time: 90, 90s, 10m, 2h; such bakes do not repeat bit for bit
    #[arg(long, value_name = "TIME", help_heading = "Accuracy", value_parser = values::optional(values::seconds))]
    time_budget: Option<Given<f64>>,

    /// Texels per metre of surface [default: 16]
    #[arg(long, value_name = "N", help_heading = "Atlas", value_parser = values::plain::<f32>)]
    texels_per_m: Option<f32>,
    /// Width and height of a page, texels [default: 1024]
    #[arg(long, value_name = "N", help_heading = "Atlas", value_parser = values::plain::<u32>)]
    page_size: Option<u32>,
    /// Scale the density down until all fits on N pages [default: none]
    #[arg(long, value_name = "N", help_heading = "Atlas", value_parser = values::optional(values::plain::<u32>))]
    max_pages: Option<Given<u32>>,
    /// Texels between charts [default: 2]
    #[arg(hide = true, long, value_name = "N", help_heading = "Atlas", value_parser = values::plain::<u32>)]
    padding: Option<u32>,
    /// Settings of one node and all below it: NAME:texels_per_m=64 or NAME:lightmap=false; may be repeated
    #[arg(hide = true, long, value_name = "NODE:RECORD", help_heading = "Atlas", value_parser = values::node)]
    nodes: Vec<(String, Node)>,
    /// GPU-instanced meshes take lightmaps too
    #[arg(hide = true, long, value_name = "BOOL", help_heading = "Atlas", num_args = 0..=1, default_missing_value = "true", require_equals = true, hide_possible_values = true)]
    bake_instanced: Option<bool>,

    /// The glTF scene, by name or number [default: the file's]
    #[arg(hide = true, long, value_name = "SCENE", help_heading = "Light", value_parser = values::optional(values::text))]
    scene: Option<Given<String>>,
    /// Light from every direction, cd/m²: 1000 or 900/1000/1200
    #[arg(long, value_name = "RGB", help_heading = "Light", value_parser = values::optional(values::rgb))]
    sky: Option<Given<Rgb>>,
    /// A sun: azimuth_deg=120,elevation_deg=35,lux=80000[,colour=1/0.95/0.9,angular_diameter_deg=0.53]
    #[arg(long, value_name = "RECORD", help_heading = "Light", value_parser = values::optional(values::sun))]
    sun: Option<Given<Sun>>,
    /// An environment image, .hdr or .exr: FILE[,rotation_deg=90,scale=1]
    #[arg(long, value_name = "FILE", help_heading = "Light", value_parser = values::optional(values::env))]
    env: Option<Given<Env>>,
    /// Unit of the file's lights: gltf (cd, lux), watts, unitless (W/sr) [default: gltf]
    #[arg(long, value_name = "UNIT", help_heading = "Light", value_parser = one_of(LightUnits::ALL), hide_possible_values = true)]
    light_units: Option<LightUnits>,
    /// Factor on the file's lights [default: 1]
    #[arg(hide = true, long, value_name = "X", help_heading = "Light", value_parser = values::plain::<f32>)]
    light_scale: Option<f32>,
    /// Smallest radius of point and spot lights, metres [default: 0.001]
    #[arg(hide = true, long, value_name = "M", help_heading = "Light", value_parser = values::plain::<f32>)]
    light_radius_m: Option<f32>,
    /// IES profile of a light's node; may be repeated
    #[arg(long, value_name = "NODE=FILE", help_heading = "Light", value_parser = values::ies)]
    ies: Vec<(String, PathBuf)>,
    /// Unlit materials: black (only block light), reflect, emit=CD_PER_M2 [default: black]
    #[arg(hide = true, long, value_name = "HOW", help_heading = "Light", value_parser = values::unlit)]
    unlit: Option<Unlit>,
    /// Leave out what provably adds less than this share of the median irradiance [default: 0.001]
    #[arg(hide = true, long, value_name = "SHARE", help_heading = "Accuracy", value_parser = values::share)]
    tolerance: Option<f32>,
    /// Simulate an effect, or leave it out, whatever the plan would choose: multiple=off, colour=on; may be repeated
    #[arg(hide = true, long, value_name = "EFFECT=ON|OFF", help_heading = "Accuracy", value_parser = values::forced)]
    force_effect: Vec<(EffectName, bool)>,
    /// How light in the air is solved: auto, walk, grid, tables, paper [default: auto]
    #[arg(long, value_name = "MODE", help_heading = "Air", value_parser = one_of(Mode::ALL), hide_possible_values = true)]
    pub mode: Option<Mode>,
    /// Air: sigma_t=0.5,albedo=0.9[,g=0.3,bounds=x0:y0:z0:x1:y1:z1], channels as 0.5/0.4/0.3; none
    #[arg(long = "fog", value_name = "RECORD", help_heading = "Air", value_parser = values::optional(values::fog))]
    media: Option<Given<Vec<Medium>>>,

    /// Probes: metres apart, or spacing_m=1[,bounds=x0:y0:z0:x1:y1:z1] or spacing_m=1,origin=x:y:z,count=x:y:z or
    /// spacing_m=1,points=x:y:z/x:y:z one by one; visibility=true adds how far each sees
    #[arg(hide = true, long, value_name = "M", value_parser = values::optional(values::probes))]
    probes: Option<Given<Probes>>,
    /// Light at cells around the air, at most so many metres wide; 1/32 of the longest side without a number
    #[arg(hide = true, long, value_name = "M", num_args = 0..=1, require_equals = true, default_missing_value = "", value_parser = values::optional(values::fog_volume))]
    fog_volume: Option<Given<FogVolume>>,
    /// Also the total without air, beside the terms
    #[arg(hide = true, long, value_name = "BOOL", num_args = 0..=1, default_missing_value = "true", require_equals = true, hide_possible_values = true)]
    keep_vacuum: Option<bool>,
    /// Also spherical harmonics (l ≤ 1) for normal maps
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_missing_value = "true", require_equals = true, hide_possible_values = true)]
    sh1: Option<bool>,
    /// 16-bit floats
    #[arg(hide = true, long, value_name = "BOOL", num_args = 0..=1, default_missing_value = "true", require_equals = true, hide_possible_values = true)]
    half: Option<bool>,
    /// Also the paths, so that `bake refog` can give the bake other air; solves by tables
    #[arg(hide = true, long, value_name = "BOOL", num_args = 0..=1, default_missing_value = "true", require_equals = true, hide_possible_values = true)]
    keep_paths: Option<bool>,
    /// Also the pages before seams were stitched and gaps filled
    #[arg(hide = true, long, value_name = "BOOL", num_args = 0..=1, default_missing_value = "true", require_equals = true, hide_possible_values = true)]
    keep_raw: Option<bool>,
}

/// One of a fixed set of names.
fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    names: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let values = PossibleValuesParser::new(names.map(|(name, _)| name));
    values.map(move |text| names.iter().find(|(name, _)| *name == text).expect("clap allows only these").1)
}

impl SettingsFlags {
    /// Lays the flags over what a file states.
    pub fn apply(&self, settings: &mut Settings) {
        let flags = self.clone();
        // Three ways to say how accurate: one of them as a flag takes back what the file says in another way.
        let is_error_set = matches!(flags.target_error, Some(Given(Some(_))));
        if flags.quality.is_some() || is_error_set || matches!(flags.samples, Some(Given(Some(_)))) {
            (settings.target_error, settings.samples) = (None, None);
        }
        set(&mut settings.quality, flags.quality);
        set(&mut settings.target_error, flags.target_error);
        set(&mut settings.samples, flags.samples);
        set(&mut settings.bounces, flags.bounces);
        set(&mut settings.seed, flags.seed);
        set(&mut settings.time_budget, flags.time_budget);
        set(&mut settings.texels_per_m, flags.texels_per_m);
        set(&mut settings.page_size, flags.page_size);
        set(&mut settings.max_pages, flags.max_pages);
        set(&mut settings.padding, flags.padding);
        set(&mut settings.bake_instanced, flags.bake_instanced);
        set(&mut settings.scene, flags.scene);
        self.apply_light(settings);
        set(&mut settings.tolerance, flags.tolerance);
        settings.force_effect.extend(flags.force_effect);
        set(&mut settings.mode, flags.mode);
        // `none` is air without media, not the glTF file's.
        if let Some(Given(media)) = flags.media {
            settings.media = Some(media.unwrap_or_default());
        }
        set(&mut settings.probes, flags.probes);
        set(&mut settings.fog_volume, flags.fog_volume);
        set(&mut settings.keep_vacuum, flags.keep_vacuum);
        set(&mut settings.sh1, flags.sh1);
        set(&mut settings.half, flags.half);
        set(&mut settings.keep_paths, flags.keep_paths);
        set(&mut settings.keep_raw, flags.keep_raw);
        settings.nodes.extend(flags.nodes);
    }

    /// A sky on the command line replaces an environment of the file, and the other way round.
    fn apply_light(&self, settings: &mut Settings) {
        let flags = self.clone();
        match (&flags.sky, &flags.env) {
            (Some(Given(Some(_))), None) => settings.env = None,
            (None, Some(Given(Some(_)))) => settings.sky = None,
            _ => {}
        }
        set(&mut settings.sky, flags.sky);
        set(&mut settings.sun, flags.sun);
        set(&mut settings.env, flags.env);
        set(&mut settings.light_units, flags.light_units);
        set(&mut settings.light_scale, flags.light_scale);
        set(&mut settings.light_radius_m, flags.light_radius_m);
        set(&mut settings.unlit, flags.unlit);
        settings.ies.extend(flags.ies);
    }
}

fn set<T>(setting: &mut T, flag: Option<impl Into<T>>) {
    if let Some(value) = flag {
        *setting = value.into();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Args, Command, FromArgMatches};

    fn parse(arguments: &str) -> Settings {
        let mut settings = Settings::default();
        parse_into(arguments, &mut settings);
        settings
    }

    fn parse_into(arguments: &str, settings: &mut Settings) {
        let command = SettingsFlags::augment_args(Command::new("test").no_binary_name(true));
        let matches =
            command.try_get_matches_from(arguments.split_whitespace()).unwrap_or_else(|error| panic!("{error}"));
        SettingsFlags::from_arg_matches(&matches).expect("parsed").apply(settings);
    }

    /// Every key with a flag value that is not its default.
    const NOT_DEFAULT: [(&str, &str); 32] = [
        ("quality", "--quality final"),
        ("target_error", "--target-error 1.5%"),
        ("samples", "--samples 64"),
        ("bounces", "--bounces 3"),
        ("seed", "--seed 7"),
        ("time_budget", "--time-budget 10m"),
        ("texels_per_m", "--texels-per-m 4"),
        ("page_size", "--page-size 256"),
        ("max_pages", "--max-pages 1"),
        ("padding", "--padding 4"),
        ("scene", "--scene 1"),
        ("sky", "--sky 900/1000/1200"),
        ("sun", "--sun azimuth_deg=120,elevation_deg=35,lux=80000"),
        ("env", "--env sky.hdr"),
        ("light_units", "--light-units watts"),
        ("light_scale", "--light-scale 2"),
        ("light_radius_m", "--light-radius-m 0.1"),
        ("ies", "--ies Lamp=lamp.ies"),
        ("unlit", "--unlit reflect"),
        ("bake_instanced", "--bake-instanced"),
        ("tolerance", "--tolerance 1%"),
        ("force_effect", "--force-effect multiple=off"),
        ("mode", "--mode walk"),
        ("media", "--fog sigma_t=0.5,albedo=0.9"),
        ("probes", "--probes 2"),
        ("fog_volume", "--fog-volume=0.5"),
        ("keep_vacuum", "--keep-vacuum"),
        ("sh1", "--sh1"),
        ("half", "--half"),
        ("keep_paths", "--keep-paths"),
        ("keep_raw", "--keep-raw"),
        ("nodes", "--nodes Statue:texels_per_m=64"),
    ];

    #[test]
    fn every_key_has_a_flag_that_sets_it_and_nothing_else() {
        let default = serde_json::to_value(Settings::default()).expect("serialises");
        let keys = default.as_object().expect("a record").keys();
        for key in keys.clone() {
            assert!(NOT_DEFAULT.iter().any(|(name, _)| name == key), "`{key}` has no flag");
        }
        for (key, flag) in NOT_DEFAULT {
            let set = serde_json::to_value(parse(flag)).expect("serialises");
            let changed: Vec<_> = keys.clone().filter(|name| set[name.as_str()] != default[name.as_str()]).collect();
            assert_eq!(changed, [key], "{flag}");
            if key != "media" {
                assert!(flag.starts_with(&format!("--{}", key.replace('_', "-"))), "{flag} is not called after {key}");
            }
        }
    }

    #[test]
    fn a_flag_of_accuracy_takes_back_what_the_file_says_in_another_way() {
        let of = |arguments: &str| {
            let mut settings = Settings { target_error: Some(0.3), samples: Some(512), ..Settings::default() };
            parse_into(arguments, &mut settings);
            (settings.quality, settings.target_error, settings.samples)
        };
        assert_eq!(of("--quality final"), (Quality::Final, None, None));
        assert_eq!(of("--target-error 1%"), (Quality::Medium, Some(0.01), None));
        assert_eq!(of("--samples 8 --quality final"), (Quality::Final, None, Some(8)));
        assert_eq!(of("--samples none"), (Quality::Medium, Some(0.3), None));
        assert_eq!(of("--seed 1"), (Quality::Medium, Some(0.3), Some(512)));
    }

    #[test]
    fn none_takes_a_setting_back_and_booleans_can_be_turned_off() {
        let flags = "--max-pages none --bounces none --sky none --half=false";
        assert_eq!(parse(flags), Settings::default());
    }

    #[test]
    fn flags_that_the_help_leaves_out_are_named_below_it() {
        let command = SettingsFlags::augment_args(Command::new("test"));
        let hidden: Vec<_> = command.get_arguments().filter(|argument| argument.is_hide_set()).collect();
        for argument in &hidden {
            let name = format!("--{}", argument.get_long().expect("every setting has a long flag"));
            assert!(RARE.contains(&name.as_str()), "{name}");
        }
        assert_eq!(RARE.len(), hidden.len());
        assert!(!rare(&["--half"]).contains("--half") && rare(&["--half"]).contains("--keep-raw. "));
    }

    /// The defaults that the help states are those of the settings.
    #[test]
    fn help_states_the_defaults() {
        let default = serde_json::to_value(Settings::default()).expect("serialises");
        let command = SettingsFlags::augment_args(Command::new("test"));
        let mut stated = 0;
        for argument in command.get_arguments() {
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            let Some((_, after)) = help.split_once("[default: ") else { continue };
            let shown = after.trim_end_matches(']').split(',').next().unwrap_or_default();
            let value = &default[argument.get_id().as_str()];
            let actual = match value {
                serde_json::Value::Null => "none".to_owned(),
                serde_json::Value::String(name) => name.to_lowercase(),
                number => (number.as_f64().expect("a number") as f32).to_string(),
            };
            if argument.get_id() != "scene" {
                assert_eq!(shown, actual, "--{}", argument.get_id());
            }
            stated += 1;
        }
        assert_eq!(stated, 14);
    }
}
