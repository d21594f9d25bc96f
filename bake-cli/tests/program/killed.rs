//! The program killed while it writes: nothing half-written, and the next bake clears up.

use crate::bake::{Desk, holds_measurements};
use bake_formats::{FormatError, Package};
use std::collections::BTreeMap;
use std::time::Duration;

/// A bake that spends a noticeable share of its time on writing.
const BAKE: &str = "run room.glb --samples 4 --page-size 256 --max-pages 1 -q -o out";

type Files = BTreeMap<String, Vec<u8>>;

/// Hashed files and manifest under final names: all but the two that hold measurements.
fn finished(desk: &Desk) -> Files {
    let entries = std::fs::read_dir(desk.path("out")).expect("the package's folder");
    let files = entries.map(|entry| entry.expect("readable").path());
    let named = files.map(|path| (path.file_name().expect("named").to_string_lossy().into_owned(), path));
    let kept = named.filter(|(name, _)| !name.starts_with(".bake-") && !holds_measurements(name));
    kept.map(|(name, path)| (name, std::fs::read(path).expect("readable"))).collect()
}

fn temporary_files(desk: &Desk) -> usize {
    let entries = std::fs::read_dir(desk.path("out")).expect("the package's folder");
    entries
        .filter(|entry| entry.as_ref().expect("readable").file_name().to_string_lossy().starts_with(".bake-"))
        .count()
}

/// Kills a bake with another seed `delay` after its first temporary file has appeared; false where it came to its end.
fn kill_while_writing(desk: &Desk, delay: Duration) -> bool {
    let before = temporary_files(desk);
    let mut child = desk.command(&format!("{BAKE} --seed 9")).spawn().expect("the program starts");
    // Older leftovers vanish when the writer starts, so that any change of their number comes before or with writing.
    let mut least = before;
    loop {
        let now = temporary_files(desk);
        least = least.min(now);
        if now > least {
            break;
        }
        if child.try_wait().expect("a child").is_some() {
            return false;
        }
    }
    std::thread::sleep(delay);
    child.kill().expect("killed");
    !child.wait().expect("it ends").success()
}

#[test]
fn a_killed_bake_leaves_no_half_file_and_the_next_one_clears_up() {
    let desk = Desk::with_room();
    desk.bake(&format!("{BAKE} --seed 9")).expect(0, &[]);
    let new = finished(&desk);
    desk.bake(BAKE).expect(0, &[]);
    let old = finished(&desk);
    assert!(
        old.values().zip(new.values()).all(|(old, new)| old.len() > 100 && (old != new || old.starts_with(b"glTF")))
    );
    for round in 0.. {
        assert!(round < 30, "no bake was killed while it wrote");
        let killed = kill_while_writing(&desk, Duration::from_millis([20, 5, 1, 0][round % 4]));
        for (name, bytes) in finished(&desk) {
            assert!(bytes == old[&name] || bytes == new[&name], "{name} is half-written");
        }
        match Package::open(&desk.path("out")) {
            Ok(_) | Err(FormatError::Stale { .. }) => {}
            Err(error) => panic!("{error}"),
        }
        if round >= 3 && killed && temporary_files(&desk) > 0 {
            break;
        }
    }
    desk.bake(BAKE).expect(0, &[]);
    assert_eq!(temporary_files(&desk), 0, "leftovers stay");
    assert!(finished(&desk) == old);
}
