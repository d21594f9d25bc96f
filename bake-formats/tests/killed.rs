//! Writers killed at any moment: no final name ever holds half a file, and what lies there opens or is refused as stale.
#![cfg(unix)]

use bake_formats::manifest::{Manifest, Settings, Source};
use bake_formats::{FormatError, Package, PackageWriter};
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Folder that `endless_writer` writes to; set only in processes that are to be killed.
const PLACE: &str = "BAKE_KILLED_WRITER";

/// When set besides, files are written in place: the negative control.
const IN_PLACE: &str = "BAKE_KILLED_WRITER_IN_PLACE";

/// Parts of a package; many, so that there is time between the first rename and the last.
const PARTS: usize = 40;

type Files = BTreeMap<String, Vec<u8>>;

fn write(folder: &Path, level: u8) -> Result<(), FormatError> {
    let mut writer = PackageWriter::create(folder, "room")?;
    for part in 0..PARTS {
        writer.add_bytes(&format!("part.{part:02}"), &vec![level; 50_000])?;
    }
    let source = Source { file: "room.glb".into(), blake3: "0".repeat(64) };
    let settings = Settings::new(serde_json::json!({ "level": level }));
    writer.finish(Manifest::new("room", source, settings)).map(|_| ())
}

/// Files under final names.
fn finished(folder: &Path) -> Files {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let named = entries.map(|entry| (entry.file_name().into_string().unwrap(), entry.path()));
    named.filter(|(name, _)| !name.ends_with(".tmp")).map(|(name, path)| (name, fs::read(path).unwrap())).collect()
}

fn leftovers(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    entries.filter(|name| name.to_str().unwrap().ends_with(".tmp")).count()
}

/// What a whole package of each level holds.
fn whole_packages() -> [Files; 2] {
    [1, 2].map(|level| {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), level).unwrap();
        finished(folder.path())
    })
}

/// Body of the processes to be killed; without the variable it does nothing.
#[test]
fn endless_writer() {
    let Some(folder) = std::env::var_os(PLACE) else { return };
    let whole = whole_packages();
    for round in 0.. {
        if std::env::var_os(IN_PLACE).is_some() {
            whole[round % 2].iter().for_each(|(name, bytes)| fs::write(Path::new(&folder).join(name), bytes).unwrap());
        } else {
            write(Path::new(&folder), 1 + (round % 2) as u8).unwrap();
        }
    }
}

fn start(folder: &Path, in_place: bool) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["endless_writer", "--exact"]).env(PLACE, folder).stdout(Stdio::null()).stderr(Stdio::null());
    if in_place {
        command.env(IN_PLACE, "1");
    }
    command.spawn().unwrap()
}

/// Lets a writer begin its second package, and kills it at a moment that moves with the round.
fn kill_one(folder: &Path, in_place: bool, round: u64) {
    let first = folder.join("room.part.00");
    let inode = || fs::metadata(&first).map(|data| (data.ino(), data.mtime_nsec())).ok();
    let before = inode();
    let mut child = start(folder, in_place);
    while inode() == before {
        assert!(child.try_wait().unwrap().is_none(), "the writer ended by itself");
    }
    // Even rounds die among the renames, odd ones while the next package is being written.
    std::thread::sleep(Duration::from_micros(if round.is_multiple_of(2) { 20 * round } else { 500 * round }));
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Final names whose bytes belong to neither package.
fn half_written(folder: &Path, whole: &[Files; 2]) -> Vec<String> {
    let found = finished(folder).into_iter();
    found
        .filter(|(name, bytes)| whole.iter().all(|files| files.get(name) != Some(bytes)))
        .map(|(name, _)| name)
        .collect()
}

#[test]
fn killed_writers_leave_no_half_file_under_a_final_name() {
    let (folder, whole) = (tempfile::tempdir().unwrap(), whole_packages());
    let [mut opened, mut stale, mut littered] = [0; 3];
    let rounds = if std::env::var_os("BAKE_LONG").is_some() { 200 } else { 6 };
    for round in 0..rounds {
        kill_one(folder.path(), false, round % 40);
        assert_eq!(half_written(folder.path(), &whole), Vec::<String>::new(), "round {round}");
        match Package::open(folder.path()) {
            Ok(_) => opened += 1,
            Err(FormatError::Stale { .. } | FormatError::NoPackage { .. }) => stale += 1,
            Err(error) => panic!("round {round}: {error}"),
        }
        littered += usize::from(leftovers(folder.path()) > 0);
    }
    println!("{opened} opened, {stale} refused as stale, {littered} with temporary files");
    assert!(littered > 0, "no writer was killed while it wrote");
    write(folder.path(), 1).unwrap();
    assert_eq!(leftovers(folder.path()), 0, "the next bake cleans up");
    assert!(finished(folder.path()) == whole[0]);
    Package::open(folder.path()).unwrap();
}

#[test]
fn files_written_in_place_are_found_half_written() {
    let (folder, whole) = (tempfile::tempdir().unwrap(), whole_packages());
    let found = (0..200).any(|round| {
        kill_one(folder.path(), true, round % 40);
        !half_written(folder.path(), &whole).is_empty()
    });
    assert!(found, "the check cannot fail");
}

#[test]
fn a_living_writers_temporary_files_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mut living = PackageWriter::create(folder.path(), "room").unwrap();
    living.add_bytes("part.00", b"kept").unwrap();
    fs::write(folder.path().join(".bake-dead.tmp"), b"left by a killed process").unwrap();
    fs::write(folder.path().join("notes.tmp"), b"not ours").unwrap();
    drop(PackageWriter::create(folder.path(), "room").unwrap());
    assert_eq!(leftovers(folder.path()), 2, "the living writer's and the stranger's");
    let source = Source { file: "room.glb".into(), blake3: "0".repeat(64) };
    living.finish(Manifest::new("room", source, Settings::new(serde_json::Value::Null))).unwrap();
    assert_eq!(fs::read(folder.path().join("room.part.00")).unwrap(), b"kept");
}
