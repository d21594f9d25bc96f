//! Running the program under test in a folder of its own.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A temporary folder in which the program runs.
pub struct Desk {
    folder: tempfile::TempDir,
}

/// What one run left behind.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; `None` where a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Desk {
    /// An empty one.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    /// With `room.glb`: the smallest of the project's scenes.
    pub fn with_room() -> Self {
        let desk = Self::new();
        let scene = testkit::reference::workspace().join("scenes/cornell.glb");
        std::fs::copy(scene, desk.path("room.glb")).expect("scenes/cornell.glb is committed");
        desk
    }

    /// A path in it.
    pub fn path(&self, relative: &str) -> PathBuf {
        self.folder.path().join(relative)
    }

    /// Writes a file.
    pub fn write(&self, relative: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(relative), content).expect("the temporary folder takes files");
    }

    /// Names of what lies in it, sorted.
    pub fn list(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).expect("readable");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("readable").file_name()).collect();
        names.sort();
        names.into_iter().map(|name| name.into_string().expect("our names are plain")).collect()
    }

    /// The program with arguments divided by spaces, not yet started.
    pub fn command(&self, arguments: &str) -> Command {
        command_in(self.folder.path(), arguments)
    }

    /// Runs the program with arguments divided by spaces.
    pub fn bake(&self, arguments: &str) -> Ended {
        Ended::from(self.command(arguments).output().expect("the program starts"))
    }
}

/// The built program with a plain environment.
fn command_in(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bake"));
    command.current_dir(folder).args(arguments.split_whitespace()).env_remove("RUST_BACKTRACE").env("NO_COLOR", "1");
    command
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("UTF-8 on standard output"),
            err: String::from_utf8(output.stderr).expect("UTF-8 on standard error"),
        }
    }
}

impl Ended {
    /// Requires an exit code, and words on standard error in any order of lines.
    #[track_caller]
    pub fn expect(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:#?}");
        let flat = self.err.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in words {
            assert!(flat.contains(word), "'{word}' is not in: {}", self.err);
        }
        assert!(!self.err.contains("panicked"), "{}", self.err);
    }
}
