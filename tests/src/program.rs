//! Running the built `bake` program and reading what it leaves behind.

use bake_formats::Package;
use bake_formats::sample::{LightmapPage, Sampler};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock};
use std::time::SystemTime;
use tempfile::TempDir;

/// The program under test: the one that `BAKE_PROGRAM` names, or else that of this build, which is built first where it is
/// missing or older than a source file.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        if let Some(program) = std::env::var_os("BAKE_PROGRAM") {
            return program.into();
        }
        // Tests lie in target/PROFILE/deps.
        let test = std::env::current_exe().expect("a running test has a path");
        let folder = test.ancestors().nth(2).expect("tests lie below the target folder");
        let program = folder.join("bake").with_extension(std::env::consts::EXE_EXTENSION);
        if !is_fresh(&program) {
            build(folder);
        }
        program
    })
}

fn is_fresh(program: &Path) -> bool {
    let modified = |path: &Path| path.metadata().and_then(|file| file.modified()).ok();
    let Some(built) = modified(program) else { return false };
    let root = testkit::reference::workspace();
    let crates = ["bake-optics", "bake-formats", "tables", "bake-core", "bake-cli"];
    crates.iter().all(|name| newest(&root.join(name).join("src")).is_none_or(|source| source <= built))
}

/// Time of the last change below a folder.
fn newest(folder: &Path) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    entries
        .filter_map(|entry| match entry.file_type().ok()?.is_dir() {
            true => newest(&entry.path()),
            false => entry.metadata().ok()?.modified().ok(),
        })
        .max()
}

fn build(folder: &Path) {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--quiet", "-p", "bake-cli"]).current_dir(testkit::reference::workspace());
    if folder.ends_with("release") {
        cargo.arg("--release");
    }
    let status = cargo.status().expect("cargo starts");
    assert!(status.success(), "the program does not build");
}

/// Runs the program. One at a time, since each uses all processors and is timed.
pub fn run(arguments: &[&str]) -> Output {
    static TURN: Mutex<()> = Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    Command::new(program()).args(arguments).env("NO_COLOR", "1").output().expect("the program starts")
}

/// A finished bake in a temporary folder.
#[derive(Debug)]
pub struct Baked {
    folder: TempDir,
    /// What the program says it measured.
    pub measured: Value,
    /// What it wrote.
    pub package: Package,
}

impl Baked {
    /// Runs `bake run SCENE FLAGS…`; flags are divided by spaces. Panics unless it ends with 0 or 3 (texels left out).
    #[track_caller]
    pub fn new(scene: &Path, flags: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let place = |path: &Path| path.to_str().expect("paths of tests are UTF-8").to_owned();
        let (scene, output) = (place(scene), place(folder.path()));
        let mut arguments = vec!["--quiet", "--json", "run", &scene, "-o", &output];
        arguments.extend(flags.split_whitespace());
        let ended = run(&arguments);
        let errors = String::from_utf8_lossy(&ended.stderr);
        assert!(matches!(ended.status.code(), Some(0 | 3)), "bake {}: {errors}", arguments.join(" "));
        let measured = serde_json::from_slice(&ended.stdout).expect("--json prints JSON");
        let package = Package::open(folder.path()).expect("a package that was just written opens");
        Self { folder, measured, package }
    }

    /// One of the project's own scenes, with its settings file.
    #[track_caller]
    pub fn own(name: &str, flags: &str) -> Self {
        Self::new(&testkit::reference::workspace().join(format!("scenes/{name}.glb")), flags)
    }

    /// Folder of the package.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// A number of the measurements; NaN where there is none.
    pub fn number(&self, key: &str) -> f64 {
        self.measured[key].as_f64().unwrap_or(f64::NAN)
    }

    /// Samples per texel of the first page.
    pub fn samples(&self) -> f64 {
        self.measured["pages"][0]["samples_per_texel"].as_f64().expect("a baked page counts its samples")
    }

    /// Look-ups at points.
    pub fn sampler(&self) -> Sampler {
        Sampler::open(&self.package).expect("a package that was just written can be sampled")
    }

    /// All pages.
    pub fn pages(&self) -> Vec<LightmapPage> {
        LightmapPage::read_all(&self.package).expect("a package that was just written can be read")
    }
}
