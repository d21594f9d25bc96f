//! The reference tables in `tests/data` are copies, so that this crate passes on its own; they must stay equal to the originals.

use std::path::Path;
use testkit::reference::shared;

#[test]
fn the_copied_tables_are_those_of_the_reference() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let Some(reference) = shared("reference") else { return };
    let mut compared = 0;
    for entry in std::fs::read_dir(folder).expect("readable") {
        let copy = entry.expect("readable").path();
        let name = copy.file_name().expect("a file").to_owned();
        let text = |path: &Path| std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert!(text(&copy) == text(&reference.join(&name)), "{} differs; copy it again", copy.display());
        compared += 1;
    }
    assert!(compared >= 18, "only {compared} tables compared");
}
