//! Finding the reference folder beside the project, and counted skips where it is absent.
//!
//! The folder is `$BAKE_SHARED`, or `../shared` beside the workspace. A test that needs it and does not find it
//! calls [`skip`]: one line in `target/skipped.txt`, or a failure when `BAKE_NO_SKIP=1`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The workspace's root folder.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("testkit lies in the workspace").to_owned()
}

/// A file or folder of the shared reference data, or `None` (a counted skip) where it is absent.
pub fn shared(relative: &str) -> Option<PathBuf> {
    let root = std::env::var_os("BAKE_SHARED").map_or_else(|| workspace().join("../shared"), PathBuf::from);
    let path = root.join(relative);
    if path.exists() {
        return Some(path);
    }
    skip(&format!("{relative} is not beside the project"));
    None
}

/// Counts a skipped test; fails instead when `BAKE_NO_SKIP=1`.
pub fn skip(reason: &str) {
    assert!(std::env::var("BAKE_NO_SKIP").as_deref() != Ok("1"), "skip refused by BAKE_NO_SKIP=1: {reason}");
    let name = std::thread::current().name().unwrap_or("?").to_owned();
    eprintln!("SKIPPED {name}: {reason}");
    let log = workspace().join("target/skipped.txt");
    if let Ok(mut file) = fs::OpenOptions::new().create(true).append(true).open(log) {
        let _ = writeln!(file, "{name}: {reason}");
    }
}

/// One row of a CSV file, addressed by column name.
#[derive(Debug, Clone)]
pub struct Row {
    header: std::rc::Rc<Vec<String>>,
    cells: Vec<String>,
}

impl Row {
    /// The cell of a column as text. Panics on an unknown column.
    pub fn text(&self, column: &str) -> &str {
        let index = self.header.iter().position(|name| name == column);
        &self.cells[index.unwrap_or_else(|| panic!("no column {column} in {:?}", self.header))]
    }

    /// The cell of a column as a number (`inf` allowed). Panics when it is none.
    pub fn number(&self, column: &str) -> f64 {
        let text = self.text(column);
        text.parse().unwrap_or_else(|_| panic!("column {column}: '{text}' is no number"))
    }

    /// Whether the row is marked as a hard case.
    pub fn is_hard(&self) -> bool {
        self.header.iter().any(|name| name == "case") && self.text("case").starts_with("hard")
    }
}

/// Cells of a line; commas within double quotes belong to their cell.
fn cells(line: &str) -> Vec<String> {
    let mut quoted = false;
    let split = line.split(|c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    split.map(|cell| cell.trim().trim_matches('"').to_owned()).collect()
}

/// Reads a comma separated file with one header line; lines starting with `#` are skipped. Panics when unreadable.
pub fn read_csv(path: &Path) -> Vec<Row> {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let header = std::rc::Rc::new(cells(lines.next().unwrap_or_else(|| panic!("{}: empty", path.display()))));
    let rows: Vec<Row> = lines.map(|line| Row { header: header.clone(), cells: cells(line) }).collect();
    assert!(rows.iter().all(|row| row.cells.len() == row.header.len()), "{}: ragged rows", path.display());
    assert!(!rows.is_empty(), "{}: no rows", path.display());
    rows
}

#[cfg(test)]
mod tests {
    #[test]
    fn quoted_commas_stay_in_their_cell() {
        assert_eq!(super::cells("1.0, inf,\"hard:a, b\",x"), ["1.0", "inf", "hard:a, b", "x"]);
    }
}
