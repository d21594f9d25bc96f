//! A package on disk: files written so that no reader ever meets half of one, and read only where hashes match.
//!
//! A [`PackageWriter`] first puts every file under a temporary name into the package's folder; only when all are there
//! does it rename them, the manifest last. A full disk therefore leaves an older package untouched, and a process
//! killed between two renames leaves files that do not match the manifest, which [`Package::open`] refuses as stale.
//! Temporary files of killed processes are removed by the next writer.

use crate::error::{FormatError, Result};
use crate::float_image::{FloatImage, PixelFormat};
use crate::manifest::{FileRecord, ImageRecord, Manifest};
use crate::medium::MediumRecord;
use bake_optics::medium::MediumSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// End of the manifest's file name.
pub const MANIFEST_SUFFIX: &str = ".bake.json";

/// Begin and end of the names of temporary files.
const TEMPORARY: (&str, &str) = (".bake-", ".tmp");

/// Writes one file under a temporary name in its folder, then renames it. For the files outside the manifest's hashes.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>) -> Result<()> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let staged = stage(folder, path, |out| write(out).map_err(FormatError::io("write", path)))?;
    publish(staged, path)
}

/// A temporary file in the folder of a package, for [`PackageWriter::add_file`]; it vanishes when dropped.
///
/// # Errors
/// The folder cannot be written to.
pub fn scratch(folder: &Path) -> Result<NamedTempFile> {
    temporary(folder).map_err(FormatError::io("write", folder))
}

fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let file = tempfile::Builder::new().prefix(TEMPORARY.0).suffix(TEMPORARY.1).tempfile_in(folder);
    // The error in `tempfile`'s words names a file that nobody asked for.
    let file = file.map_err(|error| io::Error::from(error.kind()))?;
    // Tells living writers from killed ones; where locks are unknown, leftovers stay.
    let _ = file.as_file().try_lock();
    Ok(file)
}

/// A temporary file beside `path`, written and flushed to the disk.
fn stage(
    folder: &Path,
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> Result<()>,
) -> Result<NamedTempFile> {
    let mut file = temporary(folder).map_err(FormatError::io("write", path))?;
    let mut out = BufWriter::new(file.as_file_mut());
    write(&mut out)?;
    out.flush().map_err(FormatError::io("write", path))?;
    drop(out);
    file.as_file().sync_all().map_err(FormatError::io("write", path))?;
    Ok(file)
}

fn publish(staged: NamedTempFile, path: &Path) -> Result<()> {
    set_ordinary_permissions(staged.as_file()).map_err(FormatError::io("write", path))?;
    staged.persist(path).map_err(|error| FormatError::io("write", path)(error.error))?;
    Ok(())
}

/// Temporary files are private; packages are for everyone to read.
fn set_ordinary_permissions(file: &File) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.set_permissions(fs::Permissions::from_mode(0o644))?;
    }
    #[cfg(not(unix))]
    let _ = file;
    Ok(())
}

/// A package in the making; dropped before [`Self::finish`], it leaves nothing behind.
#[derive(Debug)]
pub struct PackageWriter {
    folder: PathBuf,
    name: String,
    staged: Vec<(NamedTempFile, FileRecord)>,
}

impl PackageWriter {
    /// Makes the folder where needed, and removes what killed writers left in it. Errors: the folder holds a package of another name, or cannot be written to.
    pub fn create(folder: &Path, name: &str) -> Result<Self> {
        fs::create_dir_all(folder).map_err(FormatError::io("create", folder))?;
        let found = manifests(folder)?;
        let own = format!("{name}{MANIFEST_SUFFIX}");
        if let Some(other) = found.iter().find(|file| **file != own) {
            let found = other.trim_end_matches(MANIFEST_SUFFIX).to_owned();
            return Err(FormatError::FolderTaken { folder: folder.into(), found });
        }
        remove_leftovers(folder)?;
        Ok(Self { folder: folder.into(), name: name.into(), staged: Vec::new() })
    }

    /// File name of a part: `NAME.suffix`.
    pub fn file_name(&self, suffix: &str) -> String {
        format!("{}.{suffix}", self.name)
    }

    /// Adds the file `NAME.suffix`; returns its full name.
    pub fn add_bytes(&mut self, suffix: &str, bytes: &[u8]) -> Result<String> {
        let file = self.file_name(suffix);
        let path = self.folder.join(&file);
        let staged = stage(&self.folder, &path, |out| out.write_all(bytes).map_err(FormatError::io("write", &path)))?;
        self.push(staged, file, None)
    }

    /// Adds a file of [`scratch`] as `NAME.suffix`; returns its full name.
    ///
    /// # Errors
    /// It cannot be brought to the disk.
    pub fn add_file(&mut self, suffix: &str, staged: NamedTempFile) -> Result<String> {
        let file = self.file_name(suffix);
        staged.as_file().sync_all().map_err(FormatError::io("write", &self.folder.join(&file)))?;
        self.push(staged, file, None)
    }

    /// Adds the image `NAME.suffix`; returns its full name.
    pub fn add_image(&mut self, suffix: &str, image: &FloatImage, pixels: PixelFormat) -> Result<String> {
        let file = self.file_name(suffix);
        let path = self.folder.join(&file);
        let mut groups = Vec::new();
        let staged = stage(&self.folder, &path, |out| {
            groups = image.write(&path, pixels, out)?;
            Ok(())
        })?;
        let (width, height) = (image.width, image.height);
        self.push(staged, file, Some(ImageRecord { width, height, pixels, groups }))
    }

    fn push(&mut self, staged: NamedTempFile, file: String, image: Option<ImageRecord>) -> Result<String> {
        let (blake3, bytes) = hash_file(staged.path())?;
        self.staged.push((staged, FileRecord { file: file.clone(), blake3, bytes, image }));
        Ok(file)
    }

    /// Publishes all files, the manifest last, then removes files that only an older bake had. Returns the manifest's
    /// path. `manifest.files` is filled in here.
    pub fn finish(self, mut manifest: Manifest) -> Result<PathBuf> {
        let path = self.folder.join(format!("{}{MANIFEST_SUFFIX}", self.name));
        let older = fs::read(&path).ok().and_then(|bytes| Manifest::from_bytes(&path, &bytes).ok());
        manifest.files = self.staged.iter().map(|(_, record)| record.clone()).collect();
        let bytes = manifest.to_bytes();
        // Whatever the reader would refuse is refused here, before anything is replaced.
        Manifest::from_bytes(&path, &bytes)?;
        let staged_manifest =
            stage(&self.folder, &path, |out| out.write_all(&bytes).map_err(FormatError::io("write", &path)))?;
        for (staged, record) in self.staged {
            publish(staged, &self.folder.join(&record.file))?;
        }
        publish(staged_manifest, &path)?;
        for record in older.iter().flat_map(|older| &older.files) {
            if manifest.file(&record.file).is_none() {
                let _ = fs::remove_file(self.folder.join(&record.file));
            }
        }
        Ok(path)
    }
}

/// A package whose files are those that its manifest was written for.
#[derive(Debug, Clone)]
pub struct Package {
    folder: PathBuf,
    path: PathBuf,
    /// What the manifest says.
    pub manifest: Manifest,
}

impl Package {
    /// Opens the package in a folder, or the one whose manifest is named. Every file is hashed: what does not match is
    /// refused as stale.
    pub fn open(place: &Path) -> Result<Self> {
        if place.is_file() && place.extension().is_some_and(|end| end == "glb" || end == "gltf") {
            return Err(FormatError::Scene { scene: place.to_owned() });
        }
        let path = if place.is_dir() { only_manifest(place)? } else { place.to_owned() };
        let bytes = fs::read(&path).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => FormatError::NoPackage { folder: place.to_owned() },
            _ => FormatError::io("read", &path)(source),
        })?;
        let manifest = Manifest::from_bytes(&path, &bytes)?;
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        let package = Self { folder, path, manifest };
        for record in &package.manifest.files {
            package.verify(record)?;
        }
        Ok(package)
    }

    fn verify(&self, record: &FileRecord) -> Result<()> {
        let path = self.folder.join(&record.file);
        let stale = |reason: String| FormatError::Stale { path: path.clone(), reason };
        if !path.is_file() {
            return Err(stale("the file is missing".into()));
        }
        let (blake3, bytes) = hash_file(&path)?;
        if bytes != record.bytes {
            return Err(stale(format!("{bytes} bytes, the manifest says {}", record.bytes)));
        }
        if blake3 != record.blake3 {
            return Err(stale(format!("BLAKE3 {blake3}, the manifest says {}", record.blake3)));
        }
        Ok(())
    }

    /// Refuses the package when it was baked from another scene or with other settings than these hashes stand for.
    pub fn check_sources(&self, scene_blake3: &str, settings_blake3: &str) -> Result<()> {
        let pairs = [
            ("scene", &self.manifest.scene.blake3, scene_blake3),
            ("settings", &self.manifest.settings.blake3, settings_blake3),
        ];
        for (what, baked, now) in pairs {
            if baked != now {
                let reason = format!("the {what} changed: baked from {baked}, now {now}");
                return Err(FormatError::Stale { path: self.path.clone(), reason });
            }
        }
        Ok(())
    }

    /// Full path of a file of the package.
    pub fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    /// Bytes of a listed file.
    pub fn read(&self, file: &str) -> Result<Vec<u8>> {
        let path = self.path(file);
        fs::read(&path).map_err(FormatError::io("read", &path))
    }

    /// An image of the package.
    pub fn image(&self, file: &str) -> Result<FloatImage> {
        let path = self.path(file);
        let image = FloatImage::read(&path, &self.read(file)?)?;
        if let Some(record) = self.manifest.file(file).and_then(|record| record.image.as_ref())
            && (record.width, record.height) != (image.width, image.height)
        {
            let found = format!("{} x {}", image.width, image.height);
            return Err(FormatError::invalid(&path, "size", found, format!("{} x {}", record.width, record.height)));
        }
        Ok(image)
    }

    /// The media, and their names.
    ///
    /// # Errors
    /// Records that make no medium, and density grids that were too wide to be stored.
    pub fn media(&self) -> Result<(MediumSet, Vec<String>)> {
        let (mut set, mut names) = (MediumSet::default(), Vec::new());
        for record in &self.manifest.media {
            let record: MediumRecord = serde_json::from_value(record.clone())
                .map_err(|error| FormatError::damaged("manifest", &self.path, format!("media: {error}")))?;
            set.media.push(record.medium(&self.path, |file| self.image(file))?);
            names.push(record.name);
        }
        Ok((set, names))
    }

    /// Name of the runtime's scene file.
    pub fn baked_scene(&self) -> String {
        format!("{}.baked.glb", self.manifest.name)
    }
}

/// BLAKE3 in lower-case hexadecimal, and size.
fn hash_file(path: &Path) -> Result<(String, u64)> {
    let mut hasher = blake3::Hasher::new();
    let file = File::open(path).map_err(FormatError::io("read", path))?;
    hasher.update_reader(file).map_err(FormatError::io("read", path))?;
    Ok((hasher.finalize().to_hex().to_string(), hasher.count()))
}

/// Removes temporary files of killed processes: those that nobody holds a lock on.
fn remove_leftovers(folder: &Path) -> Result<()> {
    for entry in fs::read_dir(folder).map_err(FormatError::io("read", folder))? {
        let entry = entry.map_err(FormatError::io("read", folder))?;
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|name| name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1));
        // What cannot be removed is in nobody's way.
        if ours && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(())
}

/// File names of the manifests in a folder, sorted.
fn manifests(folder: &Path) -> Result<Vec<String>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(FormatError::io("read", folder))? {
        let name = entry.map_err(FormatError::io("read", folder))?.file_name();
        found.extend(name.to_str().filter(|name| name.ends_with(MANIFEST_SUFFIX)).map(str::to_owned));
    }
    found.sort();
    Ok(found)
}

fn only_manifest(folder: &Path) -> Result<PathBuf> {
    match manifests(folder)?.as_slice() {
        [] => Err(FormatError::NoPackage { folder: folder.into() }),
        [one] => Ok(folder.join(one)),
        several => Err(FormatError::FolderTaken { folder: folder.into(), found: several.join(", ") }),
    }
}
