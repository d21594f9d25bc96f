//! The package that `bake run` writes: opened before the work begins, published whole at its end.

use crate::exit::Failure;
use crate::job::Job;
use crate::report::Measured;
use bake_core::fingerprint;
use bake_core::package::{self as core_package, Bake, Record};
use bake_core::plan::Plan;
use bake_core::solve::PageReport;
use bake_core::solve::buffers::PageBuffers;
use bake_core::solve::points::LatticeLight;
use bake_formats::FormatError;
use bake_formats::float_image::PixelFormat;
use bake_formats::manifest::Source;
use bake_formats::package::{self, PackageWriter, write_atomic};
use bake_formats::path_file::{PathHeader, PathWriter};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A folder that will take a package.
pub struct Output {
    folder: PathBuf,
    /// The folder, to be removed again where nothing comes to lie in it.
    made: MadeFolder,
}

/// What the solver and post-processing left.
#[derive(Debug, Clone, Copy)]
pub struct Pages<'a> {
    /// After post-processing.
    pub finished: &'a [PageBuffers],
    /// How they went.
    pub reports: &'a [PageReport],
    /// Before, when asked for.
    pub raw: Option<&'a [PageBuffers]>,
    /// Of the scene without air, when asked for.
    pub vacuum: Option<&'a [PageBuffers]>,
    /// Light at probes.
    pub probes: Option<&'a LatticeLight>,
    /// Light at the cells of the fog volume.
    pub fog_volume: Option<&'a LatticeLight>,
}

/// Folders made here; those still empty at the end are removed.
struct MadeFolder(Vec<PathBuf>);

impl Drop for MadeFolder {
    fn drop(&mut self) {
        for folder in &self.0 {
            // Refused by the system unless empty, which is meant.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

impl Output {
    /// Makes the folder and proves that files can be written to it.
    pub fn open(folder: &Path, name: &str) -> Result<Self, Failure> {
        let missing = folder.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        let made = MadeFolder(missing.map(Path::to_owned).collect());
        // A writer that is dropped leaves nothing behind; the package's own comes when there is something to write.
        drop(PackageWriter::create(folder, name)?);
        drop(package::scratch(folder)?);
        Ok(Self { folder: folder.to_owned(), made })
    }

    /// A file of paths that will become part of the package, and vanishes where none is written.
    pub fn begin_paths(&self, header: &PathHeader) -> Result<PathWriter<BufWriter<NamedTempFile>>, FormatError> {
        PathWriter::new(&self.folder, BufWriter::new(package::scratch(&self.folder)?), header)
    }

    /// The failure of writing to the folder.
    pub fn unwritable(&self, error: std::io::Error) -> Failure {
        Failure::unwritable(&self.folder, error)
    }

    /// Writes everything and publishes it; returns the manifest's path.
    pub fn write(
        mut self,
        scene_file: &Path,
        job: &Job,
        plan: &Plan,
        pages: Pages,
        paths: Option<NamedTempFile>,
    ) -> Result<PathBuf, Failure> {
        let Pages { finished, reports, raw, vacuum, probes, fog_volume } = pages;
        let (scene, air, atlas) = (&job.scene, &job.air, &job.atlas);
        let bake = Bake { scene, air, atlas, pages: finished, reports, raw, vacuum, probes, fog_volume };
        let path = core_package::write_with(&self.folder, bake, &record(scene_file, job, plan)?, paths);
        let path = path.map_err(|error| match error {
            FormatError::Io { .. } | FormatError::FolderTaken { .. } => Failure::from(error),
            // What we were about to write is our own fault, not the input's.
            other => Failure::failed(other),
        })?;
        self.made.0.clear();
        Ok(path)
    }
}

/// What the manifest says about how it was baked.
fn record(scene_file: &Path, job: &Job, plan: &Plan) -> Result<Record, Failure> {
    let file = scene_file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let blake3 = job.scene.blake3.clone();
    Ok(Record {
        source: Source { file, blake3 },
        settings: fingerprint::settings(&job.settings).map_err(Failure::failed)?,
        plan: serde_json::to_value(&plan.effects).expect("plain data becomes JSON"),
        warnings: job.warnings.clone(),
        reproducible: job.settings.time_budget.is_none(),
        pixels: if job.settings.half { PixelFormat::F16 } else { PixelFormat::F32 },
    })
}

/// Writes `NAME.run.json` beside the manifest; it lies outside the package's hashes.
pub fn write_measured(measured: &Measured) -> Result<(), Failure> {
    let mut bytes = serde_json::to_vec_pretty(measured).expect("plain data becomes JSON");
    bytes.push(b'\n');
    write_beside(&measured.package, "run.json", &bytes)
}

/// Writes `NAME.suffix` beside a manifest.
pub fn write_beside(manifest: &Path, suffix: &str, bytes: &[u8]) -> Result<(), Failure> {
    let file = manifest.file_name().unwrap_or_default().to_string_lossy();
    let name = file.strip_suffix(bake_formats::package::MANIFEST_SUFFIX).unwrap_or(&file);
    let path = manifest.with_file_name(format!("{name}.{suffix}"));
    Ok(write_atomic(&path, |out| out.write_all(bytes))?)
}

/// Writes a file that `-o` does not move, with the way to another place.
pub fn write_so(path: &Path, bytes: &[u8], way_out: &str) -> Result<(), Failure> {
    write_atomic(path, |out| out.write_all(bytes)).map_err(|error| match error {
        FormatError::Io { path, source, .. } => Failure::unwritable_so(&path, source, way_out),
        other => other.into(),
    })
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        match error {
            FormatError::Io { action: "read", path, source } => Self::unreadable(&path, &source),
            FormatError::Io { path, source, .. } => Self::unwritable(&path, source),
            other => Self::invalid(other),
        }
    }
}
