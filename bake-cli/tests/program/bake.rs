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
        Self::with_scene("cornell.glb")
    }

    /// With `room.glb`: one of the project's scenes.
    pub fn with_scene(name: &str) -> Self {
        let desk = Self::new();
        let scene = testkit::reference::workspace().join("scenes").join(name);
        std::fs::copy(scene, desk.path("room.glb")).expect("the scenes are committed");
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

/// A scene without light: a triangle of half a square metre, and a closed box of six metres around it.
/// `facing` = 1 turns the box's faces to the triangle, −1 away from it.
pub fn gltf(facing: f32) -> String {
    let corner = |index: u32| [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { 3.0f32 } else { -3.0 });
    let triangle = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let positions = triangle.into_iter().chain((0..8).map(corner));
    // Counter-clockwise seen from outside.
    let sides = [[0u16, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let outward = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let faces = outward.map(|[a, b, c]| if facing > 0.0 { [a, c, b] } else { [a, b, c] });
    let indices = [[0, 1, 2]].into_iter().chain(faces);
    let mut bytes: Vec<u8> = positions.flatten().flat_map(f32::to_le_bytes).collect();
    let at = bytes.len();
    bytes.extend(indices.flatten().flat_map(u16::to_le_bytes));
    let hex: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
    serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "mesh": 0, "name": "triangle" }, { "mesh": 1, "name": "box" }],
        "meshes": [
            { "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] },
            { "primitives": [{ "attributes": { "POSITION": 2 }, "indices": 3, "material": 1 }] }
        ],
        "materials": [{ "doubleSided": true }, {}],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3 },
            { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "type": "VEC3", "count": 8, "min": [-3, -3, -3], "max": [3, 3, 3] },
            { "bufferView": 1, "byteOffset": 6, "componentType": 5123, "type": "SCALAR", "count": 36 }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": at },
            { "buffer": 0, "byteOffset": at, "byteLength": bytes.len() - at }
        ],
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream,{hex}") }]
    })
    .to_string()
}

/// Whether a file of a package holds measurements: the two that lie outside the same-bits rule.
pub fn holds_measurements(name: &str) -> bool {
    name.ends_with(".run.json") || name.ends_with(".report.html")
}
