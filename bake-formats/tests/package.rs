//! Packages on disk: round trip, equal bytes, nothing half-written, strangers and damage refused with the reason.

use bake_formats::float_image::{FloatImage, PixelFormat, Quantity};
use bake_formats::manifest::{Manifest, PageRecord, Settings, Source};
use bake_formats::{FormatError, Package, PackageWriter, Term};
use std::fs;
use std::path::Path;

fn image(value: f32) -> FloatImage {
    let mut image = FloatImage::new(4, 4);
    image.push_rgb("", Quantity::Irradiance, &[[value, 2.0 * value, 3.0]; 16]);
    image
}

fn manifest() -> Manifest {
    let scene = Source { file: "room.glb".into(), blake3: blake3::hash(b"scene").to_hex().to_string() };
    let mut manifest = Manifest::new("room", scene, Settings::new(serde_json::json!({"quality": "final"})));
    manifest.terms = vec![Term::Direct];
    manifest
}

fn write(folder: &Path, value: f32, pages: u32) -> Result<(), FormatError> {
    let mut writer = PackageWriter::create(folder, "room")?;
    let mut manifest = manifest();
    for page in 0..pages {
        let lightmap = writer.add_image(&format!("lightmap.{page:02}.exr"), &image(value), PixelFormat::F32)?;
        let terms = writer.add_image(&format!("terms.{page:02}.exr"), &image(value), PixelFormat::F16)?;
        manifest.pages.push(PageRecord { width: 4, height: 4, lightmap, terms, sh1: None, raw: None });
    }
    writer.add_bytes("baked.glb", b"glTF")?;
    writer.finish(manifest).map(|_| ())
}

fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let mut files: Vec<_> =
        entries.map(|e| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap())).collect();
    files.sort();
    files
}

#[test]
fn what_is_written_is_read_and_the_bytes_repeat() {
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write(a.path(), 5.0, 2).unwrap();
    write(b.path(), 5.0, 2).unwrap();
    assert!(files(a.path()) == files(b.path()), "same package, other bytes");
    let package = Package::open(a.path()).unwrap();
    assert_eq!(package.manifest.terms, [Term::Direct]);
    let (read, want) = (package.image("room.lightmap.01.exr").unwrap(), image(5.0));
    assert_eq!(read.rgb::<[f32; 3]>("").unwrap(), want.rgb::<[f32; 3]>("").unwrap());
    let by_manifest = Package::open(&a.path().join("room.bake.json")).unwrap();
    assert_eq!(by_manifest.manifest, package.manifest);
}

#[test]
fn a_later_bake_replaces_an_earlier_one_whole() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), 5.0, 3).unwrap();
    write(folder.path(), 6.0, 1).unwrap();
    let names: Vec<_> = files(folder.path()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["room.bake.json", "room.baked.glb", "room.lightmap.00.exr", "room.terms.00.exr"]);
    Package::open(folder.path()).unwrap();
}

#[test]
fn a_writer_that_fails_or_is_dropped_leaves_the_older_package_untouched() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), 5.0, 1).unwrap();
    let before = files(folder.path());
    let mut writer = PackageWriter::create(folder.path(), "room").unwrap();
    writer.add_image("lightmap.00.exr", &image(9.0), PixelFormat::F32).unwrap();
    drop(writer);
    assert!(files(folder.path()) == before, "a dropped writer left traces");

    let mut writer = PackageWriter::create(folder.path(), "room").unwrap();
    writer.add_image("lightmap.00.exr", &image(9.0), PixelFormat::F32).unwrap();
    let error = writer.add_image("terms.00.exr", &image(f32::NAN), PixelFormat::F32).unwrap_err();
    assert!(error.to_string().contains("NaN"), "{error}");
    drop(writer);
    assert!(files(folder.path()) == before, "a failed writer left traces");

    // A page that names a file nobody added is refused before anything is renamed.
    let mut writer = PackageWriter::create(folder.path(), "room").unwrap();
    writer.add_image("lightmap.00.exr", &image(9.0), PixelFormat::F32).unwrap();
    let mut manifest = manifest();
    let lightmap = "room.lightmap.00.exr".into();
    manifest.pages.push(PageRecord {
        width: 4,
        height: 4,
        lightmap,
        terms: "nothing.exr".into(),
        sh1: None,
        raw: None,
    });
    assert!(writer.finish(manifest).is_err());
    assert!(files(folder.path()) == before, "an invalid manifest left traces");
}

/// The kernel's `/dev/full` stands for a full disk; there the write fails at flush.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_that_names_the_file() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let error = image(1.0).write(Path::new("page.exr"), PixelFormat::F32, std::io::BufWriter::new(full)).unwrap_err();
    assert!(error.to_string().contains("page.exr"), "{error}");
}

/// A process killed between two renames: new image, old manifest.
#[test]
fn files_of_two_bakes_are_refused_as_stale() {
    let (old, new) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write(old.path(), 5.0, 1).unwrap();
    write(new.path(), 6.0, 1).unwrap();
    fs::copy(new.path().join("room.lightmap.00.exr"), old.path().join("room.lightmap.00.exr")).unwrap();
    let error = Package::open(old.path()).unwrap_err();
    assert!(matches!(error, FormatError::Stale { .. }), "{error}");
    assert!(error.to_string().contains("room.lightmap.00.exr") && error.to_string().contains("bake again"), "{error}");

    fs::remove_file(old.path().join("room.lightmap.00.exr")).unwrap();
    let error = Package::open(old.path()).unwrap_err().to_string();
    assert!(error.contains("missing"), "{error}");
}

#[test]
fn other_scene_or_settings_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), 5.0, 1).unwrap();
    let package = Package::open(folder.path()).unwrap();
    let (scene, settings) = (package.manifest.scene.blake3.clone(), package.manifest.settings.blake3.clone());
    package.check_sources(&scene, &settings).unwrap();
    for (scene, settings, what) in [("0", settings.as_str(), "scene"), (scene.as_str(), "0", "settings")] {
        let error = package.check_sources(scene, settings).unwrap_err().to_string();
        assert!(error.contains(&format!("the {what} changed")), "{error}");
    }
}

#[test]
fn strangers_and_other_versions_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    for place in [folder.path().to_owned(), folder.path().join("missing")] {
        let error = Package::open(&place).unwrap_err();
        assert!(matches!(error, FormatError::NoPackage { .. }), "{error}");
    }
    let path = folder.path().join("room.bake.json");
    let cases = [
        (r#"{"format": "atlas"}"#, "format is 'atlas'"),
        (r#"{"format": "bake package", "format_version": 99}"#, "update `bake`"),
        (r#"{"format": "bake package", "format_version": 0}"#, "bake again"),
        (r#"{"format": "bake package", "format_version": 1, "name": 3}"#, "line 1"),
        ("[", "damaged manifest"),
    ];
    for (text, expected) in cases {
        fs::write(&path, text).unwrap();
        let error = Package::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("room.bake.json"), "{text}: {error}");
    }
    fs::write(folder.path().join("other.bake.json"), "{}").unwrap();
    assert!(matches!(PackageWriter::create(folder.path(), "room"), Err(FormatError::FolderTaken { .. })));
    assert!(matches!(Package::open(folder.path()), Err(FormatError::FolderTaken { .. })));
}

#[test]
fn manifests_cannot_point_outside_their_folder() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), 5.0, 1).unwrap();
    let path = folder.path().join("room.bake.json");
    let text = fs::read_to_string(&path).unwrap().replace("room.baked.glb", "../room.baked.glb");
    fs::write(&path, text).unwrap();
    let error = Package::open(folder.path()).unwrap_err().to_string();
    assert!(error.contains("without folder"), "{error}");
}

#[test]
fn damaged_manifests_and_images_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), 5.0, 1).unwrap();
    let path = folder.path().join("room.bake.json");
    let good = fs::read(&path).unwrap();
    let rounds = if std::env::var_os("BAKE_LONG").is_some() { 200_000 } else { 5_000 };
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize
    };
    let mut refused = 0;
    for round in 0..rounds {
        let mut bad = good.clone();
        if round % 4 == 0 {
            bad.truncate(next() % bad.len());
        } else {
            let at = next() % bad.len();
            bad[at] = next() as u8;
        }
        refused += usize::from(Manifest::from_bytes(&path, &bad).is_err());
    }
    println!("{refused} of {rounds} mutated manifests refused");
    assert!(refused > rounds / 4);
    for name in ["room.lightmap.00.exr", "room.terms.00.exr", "room.baked.glb"] {
        let good = fs::read(folder.path().join(name)).unwrap();
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 1;
            fs::write(folder.path().join(name), &bad).unwrap();
            assert!(matches!(Package::open(folder.path()), Err(FormatError::Stale { .. })), "{name}, bit at {at}");
        }
        fs::write(folder.path().join(name), &good).unwrap();
    }
    Package::open(folder.path()).unwrap();
}
