//! Reading settings: the side file `SCENE.bake.ron`, and media in the extras of a glTF scene.

use crate::scene::MediaExtras;

use super::{Medium, Settings, SettingsError, Syntax};
use ron::extensions::Extensions;
use std::path::{Path, PathBuf};

/// Where the settings of a scene are looked for: `room.bake.ron` beside `room.glb`.
pub fn sidecar(scene: &Path) -> PathBuf {
    scene.with_extension("bake.ron")
}

/// Reads a settings file. File names in it are relative to its folder; the result's are relative to where the
/// program runs. Values are not judged yet.
pub fn read(file: &Path) -> Result<Settings, SettingsError> {
    let unreadable = |source| SettingsError::Unreadable { file: file.to_owned(), source };
    let bytes = std::fs::read(file).map_err(unreadable)?;
    let text = String::from_utf8(bytes)
        .map_err(|error| unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, error.utf8_error())))?;
    let mut settings = parse(file, text)?;
    settings.resolve_files(file.parent().unwrap_or(Path::new("")));
    Ok(settings)
}

/// Parses the text of a settings file. `Some(…)` may be left out around values.
pub(super) fn parse(file: &Path, text: String) -> Result<Settings, SettingsError> {
    let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
    options.from_str(&text).map_err(|error| SettingsError::Syntax(Box::new(Syntax::new(file, text, &error))))
}

/// Media of a glTF scene's extras; file names come out relative to where the program runs. Values are not judged yet.
pub(crate) fn media_of_scene(extras: &MediaExtras) -> Result<Vec<Medium>, SettingsError> {
    let mut media = from_json(&extras.json)?;
    media.iter_mut().flat_map(Medium::files_mut).for_each(|file| *file = extras.folder.join(&*file));
    Ok(media)
}

/// Media as a glTF scene's `extras.bake_media` holds them: the settings file's records as JSON.
pub fn from_json(json: &str) -> Result<Vec<Medium>, SettingsError> {
    let mut parser = serde_json::Deserializer::from_str(json);
    serde_path_to_error::deserialize(&mut parser).map_err(|error| {
        let at = error.path().to_string();
        SettingsError::Extras { at, source: error.into_inner() }
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Density, Env, LightUnits, Phase, Place, Quality, Values};
    use super::*;

    fn fault(text: &str) -> Syntax {
        match parse("a/room.bake.ron".as_ref(), text.to_owned()) {
            Err(SettingsError::Syntax(fault)) => *fault,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn unknown_keys_and_values_are_refused_with_position_and_suggestion() {
        let cases = [
            ("Bake(\n    texel_per_m: 4,\n)", (2, 5), "unknown key `texel_per_m`", "did you mean `texels_per_m`?"),
            ("Bake(\n  é: 1)", (2, 3), "unknown key `é`", "known are quality, target_error"),
            ("Bake(quality: Finel)", (1, 15), "unknown value `Finel`", "did you mean `Final`?"),
            ("Bake(quality: final)", (1, 15), "unknown value `final`", "did you mean `Final`?"),
            ("Bake(sun: (azimut_deg: 1))", (1, 12), "unknown key `azimut_deg`", "did you mean `azimuth_deg`?"),
        ];
        for (text, position, message, hint) in cases {
            let fault = fault(text);
            assert_eq!((fault.line, fault.column), position, "{text}: {fault}");
            assert_eq!(fault.message, message);
            assert!(fault.hint.as_deref().is_some_and(|found| found.starts_with(hint)), "{text}: {fault}");
            assert!(fault.to_string().starts_with(&format!("a/room.bake.ron:{}:{}: ", position.0, position.1)));
            assert!(fault.text.get(fault.span.clone()).is_some(), "the span lies in the text");
        }
    }

    #[test]
    fn damaged_text_is_refused_whatever_its_end() {
        let whole = super::super::TEMPLATE;
        let opening = whole.find("Bake(").expect("the template is a record");
        let closing = whole.rfind(')').expect("the template is a record");
        for end in (opening..closing).filter(|&end| whole.is_char_boundary(end)) {
            assert!(parse("cut".as_ref(), whole[..end].to_owned()).is_err(), "cut at {end}");
        }
        for text in ["", "Bake", "Bake(quality)", "Bake(seed: 1e99)", "Bake(seed: -1)", "Bake() Bake()", "[1]", "\u{0}"]
        {
            assert!(parse("damaged".as_ref(), text.to_owned()).is_err(), "{text}");
        }
        let deep = format!("Bake(media: {}", "[".repeat(100_000));
        assert!(parse("deep".as_ref(), deep).is_err());
    }

    #[test]
    fn a_file_states_only_what_differs() {
        let text = "Bake(quality: Final, max_pages: 1, sky: Some((1, 2, 3)), light_units: Watts)";
        let settings = parse("test".as_ref(), text.to_owned()).expect("parses");
        let expected = Settings {
            quality: Quality::Final,
            max_pages: Some(1),
            sky: Some([1.0, 2.0, 3.0]),
            light_units: LightUnits::Watts,
            ..Settings::default()
        };
        assert_eq!(settings, expected);
    }

    #[test]
    fn file_names_are_relative_to_the_settings_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("room.bake.ron");
        let grid = r#"Medium(scatter: Look(mean_free_path_m: 1, albedo: (1, 1, 1)), density: Grid(file: "s.vdb", name: "d"), phase: Table("p.csv"))"#;
        let text = format!(r#"Bake(env: Env(file: "sky.hdr"), ies: {{"L": "/abs/l.ies"}}, media: [{grid}])"#);
        std::fs::write(&file, text).expect("written");
        let settings = read(&file).expect("reads");
        let env = Env { file: folder.path().join("sky.hdr"), rotation_deg: 0.0, scale: 1.0 };
        assert_eq!(settings.env, Some(env));
        assert_eq!(settings.ies["L"], Path::new("/abs/l.ies"));
        let medium = &settings.media.as_ref().expect("media")[0];
        assert_eq!(medium.phase, Phase::Table(folder.path().join("p.csv")));
        assert_eq!(
            medium.density,
            Density::Grid {
                file: folder.path().join("s.vdb"),
                name: Some("d".into()),
                size: None,
                values: Values::F32,
                place: Place::Auto,
                z_up: false
            }
        );
    }

    #[test]
    fn the_side_file_lies_beside_the_scene() {
        assert_eq!(sidecar("a/room.glb".as_ref()), Path::new("a/room.bake.ron"));
        assert_eq!(sidecar("room.v2.gltf".as_ref()), Path::new("room.v2.bake.ron"));
    }

    #[test]
    fn extras_hold_the_same_media_records() {
        let json = r#"[{"name": "haze", "bounds": {"Box": {"min": [0, 0, 0], "max": [1, 1, 1]}},
            "scatter": {"Sigma": {"s": [0.4, 0.4, 0.4], "a": [0, 0, 0]}}, "phase": {"HenyeyGreenstein": 0.5}}]"#;
        let ron = r#"Bake(media: [Medium(name: "haze", bounds: Box(min: (0, 0, 0), max: (1, 1, 1)),
            scatter: Sigma(s: (0.4, 0.4, 0.4), a: (0, 0, 0)), phase: HenyeyGreenstein(0.5))])"#;
        let media = from_json(json).expect("valid");
        assert_eq!(media[0].phase, Phase::HenyeyGreenstein(0.5));
        assert_eq!(Some(media), parse("test".as_ref(), ron.to_owned()).expect("parses").media);
        assert!(from_json(r#"[{"scatter": 1}]"#).is_err());
    }
}
