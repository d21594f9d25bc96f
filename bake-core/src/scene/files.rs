//! Reading the files that a scene names: URIs, a hash of all that was read, and an allowance that keeps memory in
//! proportion to the input.

use super::error::{Fault, Place, Refusal};
use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};

/// Reads a regular file; pipes and devices, which may never end, are refused.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Fault> {
    let data = std::fs::metadata(path)?;
    if !data.is_file() {
        return Err(Fault::Unreadable(std::io::Error::new(std::io::ErrorKind::InvalidInput, "not a regular file")));
    }
    Ok(std::fs::read(path)?)
}

/// Resolves the URIs of one scene file and counts what was read.
pub(super) struct Files {
    folder: PathBuf,
    hasher: RefCell<blake3::Hasher>,
    /// Allowance for geometry.
    pub geometry: Allowance,
    /// Allowance for decoded images.
    pub pixels: Allowance,
}

impl Files {
    /// For the scene file at `path` that holds `bytes`.
    pub fn new(path: &Path, bytes: &[u8]) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(bytes);
        let files = Self {
            hasher: hasher.into(),
            folder: path.parent().map(Path::to_owned).unwrap_or_default(),
            // Draco and meshopt pack a triangle, which takes 180 bytes here, into about one byte.
            geometry: Allowance::new(16 << 20, 256),
            // Deflate packs at most 1032 bytes into one.
            pixels: Allowance::new(64 << 20, 1100),
        };
        files.count(bytes.len());
        files
    }

    /// BLAKE3 of the scene file's bytes, followed by the BLAKE3 of each file read since, in that order; hexadecimal.
    pub fn hash(&self) -> String {
        self.hasher.borrow().finalize().to_hex().to_string()
    }

    fn count(&self, bytes: usize) {
        self.geometry.grow(bytes);
        self.pixels.grow(bytes);
    }

    /// The bytes that a URI stands for: a data URI, or a file relative to the scene.
    pub fn fetch(&self, uri: &str, place: &Place) -> Result<Vec<u8>, Refusal> {
        if uri.starts_with("data:") {
            let decode =
                |e: draco_gltf::GltfError| Fault::Decode { format: "data URI", reason: e.to_string() }.at(place);
            return draco_gltf::decode_data_uri(uri, None).map_err(decode);
        }
        let path = self.path_of(uri).map_err(|fault| fault.at(place))?;
        let bytes = read(&path).map_err(|fault| fault.in_file(&path).object(format!("(named by {place})")))?;
        self.count(bytes.len());
        self.hasher.borrow_mut().update(blake3::hash(&bytes).as_bytes());
        Ok(bytes)
    }

    fn path_of(&self, uri: &str) -> Result<PathBuf, Fault> {
        let relative = percent_decode(uri)?;
        if Path::new(relative.as_ref()).is_absolute() || uri.contains("://") {
            return Err(Fault::Unsupported {
                what: format!("`{}`, which is no path relative to the scene", shorten(uri)),
                way_out: "put the file beside the scene and refer to it by name",
            });
        }
        if relative.is_empty() || relative.contains('\0') {
            return Err(Fault::value(format!("`{}`", shorten(uri)), "a relative path or a data URI"));
        }
        Ok(self.folder.join(relative.as_ref()))
    }
}

/// The beginning of a text that may be long.
pub(super) fn shorten(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text.to_owned(),
    }
}

/// Bytes that decoded data may take: a base and a factor on the bytes read.
pub(super) struct Allowance {
    left: Cell<u64>,
    factor: u64,
}

impl Allowance {
    fn new(base: u64, factor: u64) -> Self {
        Self { left: Cell::new(base), factor }
    }

    fn grow(&self, input_bytes: usize) {
        self.left.set(self.left.get().saturating_add(self.factor.saturating_mul(input_bytes as u64)));
    }

    /// Bytes that may still be taken.
    pub fn left(&self) -> u64 {
        self.left.get()
    }

    /// Takes `count · size` bytes, or says that they are too many.
    pub fn take(&self, count: u64, size: u64) -> Result<(), Fault> {
        let needed = count.saturating_mul(size);
        match self.left.get().checked_sub(needed) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(Fault::TooLarge { needed, allowed: self.left.get() }),
        }
    }
}

/// RFC 3986 percent-encoding.
fn percent_decode(uri: &str) -> Result<Cow<'_, str>, Fault> {
    if !uri.contains('%') {
        return Ok(Cow::Borrowed(uri));
    }
    let fault = || Fault::value(format!("`{}`", shorten(uri)), "percent-encoded UTF-8");
    let mut out = Vec::with_capacity(uri.len());
    let mut bytes = uri.bytes();
    while let Some(byte) = bytes.next() {
        if byte == b'%' {
            let mut digit = || bytes.next().and_then(|b| (b as char).to_digit(16));
            let (high, low) = digit().zip(digit()).ok_or_else(fault)?;
            out.push((high * 16 + low) as u8);
        } else {
            out.push(byte);
        }
    }
    String::from_utf8(out).map(Cow::Owned).map_err(|_| fault())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris() {
        let files = Files::new(Path::new("a.gltf"), &[]);
        let fetch = |uri: &str| files.fetch(uri, &Place::root("buffers[0].uri"));
        assert_eq!(fetch("data:application/octet-stream;base64,Zm9vYg==").expect("RFC 4648, section 10"), b"foob");
        for bad in ["data:", "data:;base64", "data:;base64,Z", "data:;base64,Zm9!"] {
            assert!(fetch(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_hash_covers_the_files_that_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let hash = |scene: &[u8], buffer: Option<&[u8]>| {
            let files = Files::new(&folder.path().join("a.gltf"), scene);
            if let Some(bytes) = buffer {
                std::fs::write(folder.path().join("a.bin"), bytes).expect("written");
                files.fetch("a.bin", &Place::root("buffers[0].uri")).expect("there");
            }
            files.hash()
        };
        assert_eq!(
            hash(b"one", None),
            blake3::hash(b"one").to_hex().to_string(),
            "the plain hash of a file that stands alone"
        );
        let different = [hash(b"one", None), hash(b"two", None), hash(b"one", Some(b"a")), hash(b"one", Some(b"b"))];
        assert!((1..4).all(|i| !different[..i].contains(&different[i])), "{different:?}");
        assert_eq!(hash(b"one", Some(b"a")), different[2]);
    }

    #[test]
    fn percent_encoding() {
        assert_eq!(percent_decode("Box%20With%20Spaces.bin").expect("valid"), "Box With Spaces.bin");
        assert_eq!(percent_decode("gr%C3%BCn.png").expect("valid"), "grün.png");
        for bad in ["%", "%2", "%zz", "%FF"] {
            assert!(percent_decode(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn absolute_and_remote_uris_are_refused() {
        let files = Files::new(Path::new("scenes/a.gltf"), &[]);
        for uri in ["/etc/passwd", "https://example.org/a.bin", "", "a%00b"] {
            assert!(files.path_of(uri).is_err(), "{uri}");
        }
        assert_eq!(files.path_of("../t/a%20b.png").expect("relative"), Path::new("scenes/../t/a b.png"));
    }

    #[test]
    fn an_allowance_runs_out() {
        let allowance = Allowance::new(10, 2);
        allowance.grow(5);
        assert!(allowance.take(4, 5).is_ok());
        assert!(matches!(allowance.take(1, 1), Err(Fault::TooLarge { needed: 1, allowed: 0 })));
        assert!(allowance.take(u64::MAX, 2).is_err());
    }
}
