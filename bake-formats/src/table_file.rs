//! The file of impulse-response tables: header, JSON manifest, compressed numbers, one hash over all of it.
//!
//! ```text
//! offset  size  what
//! 0       8     magic "BAKETBL\n"
//! 8       4     version, u32 little endian
//! 12      4     length of the manifest in bytes, u32 little endian
//! 16      32    BLAKE3 of bytes 8…16 and of everything after byte 48
//! 48      …     manifest, UTF-8 JSON ([`TableManifest`])
//! …       …     zstd of all tables in manifest order
//! ```
//! A table is stored column by column (one curve over distance after the other) as f32, its upper 24 bits, or f16, divided by a power of two,
//! and split into byte planes (all lowest bytes first) so that it compresses. What the numbers mean, the crate `tables` knows.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use half::f16;
use serde::{Deserialize, Serialize};

use crate::error::FormatError;
use crate::package::write_atomic;

/// Version written, and the only one read.
pub const VERSION: u32 = 2;

const MAGIC: &[u8; 8] = b"BAKETBL\n";
const HEADER: usize = 48;

/// Largest uncompressed size accepted, bytes: a damaged manifest must not ask for all memory.
const LARGEST: usize = 1 << 30;

/// Compression level: 3 % above the smallest size at a tenth of the time.
const LEVEL: i32 = 12;

/// How the numbers of a table are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 16 bits, 11 of them significant.
    F16,
    /// 24 bits: f32 without its last byte, 16 significant bits.
    F24,
    /// 32 bits.
    F32,
}

impl Precision {
    fn bytes(self) -> usize {
        match self {
            Self::F16 => 2,
            Self::F24 => 3,
            Self::F32 => 4,
        }
    }
}

/// One table in the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableEntry {
    /// Name, unique in the file.
    pub name: String,
    /// What a value is, in words, with its normalisation.
    pub meaning: String,
    /// Rows: places over distance.
    pub rows: usize,
    /// Columns: curves.
    pub columns: usize,
    /// How values are stored.
    pub precision: Precision,
    /// Stored value = value / `scale`; a power of two.
    pub scale: f32,
    /// Measured: largest difference between look-up and direct evaluation as a share of the l = 0 coefficient.
    pub look_up_error: f64,
    /// Whatever else the reader of this table needs.
    pub details: serde_json::Value,
}

/// What the file says about itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableManifest {
    /// Program and version that made the file.
    pub made_by: String,
    /// All parameters from which the same file can be made again.
    pub recipe: serde_json::Value,
    /// Unit by quantity.
    pub units: BTreeMap<String, String>,
    /// The tables, in the order of their numbers.
    pub tables: Vec<TableEntry>,
}

/// A whole file in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFile {
    /// The manifest.
    pub manifest: TableManifest,
    /// Per table `rows × columns` values, row-major, rounded as stored.
    pub values: Vec<Vec<f32>>,
}

/// Why a table file was refused.
#[derive(Debug, thiserror::Error)]
pub enum TableFileError {
    /// The operating system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// Not a table file at all.
    #[error("{origin}: this is no table file (it does not begin with BAKETBL); make one with `bake tables generate`")]
    Foreign {
        /// File name or description.
        origin: String,
    },
    /// Another version of the format.
    #[error(
        "{origin}: table file version {found}, this program reads version {VERSION}; make it anew with `bake tables generate`"
    )]
    Version {
        /// File name or description.
        origin: String,
        /// The version found.
        found: u32,
    },
    /// The hash does not fit: damaged or cut short.
    #[error(
        "{origin}: the contents do not match the hash in the header: the file is damaged; make it anew with `bake tables generate`"
    )]
    Damaged {
        /// File name or description.
        origin: String,
    },
    /// The hash fits and yet the contents make no sense.
    #[error("{origin}: {field}: {problem}; make the file anew with `bake tables generate`")]
    Inconsistent {
        /// File name or description.
        origin: String,
        /// Where.
        field: String,
        /// What is wrong.
        problem: String,
    },
}

impl TableFile {
    /// The file's bytes. Same contents, same bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let manifest = serde_json::to_vec(&self.manifest).expect("a manifest of plain values");
        let numbers: Vec<u8> =
            self.manifest.tables.iter().zip(&self.values).flat_map(|(entry, values)| pack(entry, values)).collect();
        let packed = zstd::bulk::compress(&numbers, LEVEL).expect("compression into memory");
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((manifest.len() as u32).to_le_bytes());
        let mut hasher = blake3::Hasher::new();
        hasher.update(&bytes[8..16]).update(&manifest).update(&packed);
        bytes.extend(hasher.finalize().as_bytes());
        bytes.extend(manifest);
        bytes.extend(packed);
        bytes
    }

    /// From a file's bytes; `origin` names them in errors.
    pub fn from_bytes(bytes: &[u8], origin: &str) -> Result<Self, TableFileError> {
        let (manifest, packed) = check_header(bytes, origin)?;
        let fault = |field: &str, problem: String| TableFileError::Inconsistent {
            origin: origin.to_owned(),
            field: field.to_owned(),
            problem,
        };
        let manifest: TableManifest =
            serde_json::from_slice(manifest).map_err(|error| fault("manifest", error.to_string()))?;
        let size = |entry: &TableEntry| entry.rows.checked_mul(entry.columns)?.checked_mul(entry.precision.bytes());
        let total = manifest.tables.iter().try_fold(0usize, |sum, entry| sum.checked_add(size(entry)?));
        let total = total.filter(|&total| total <= LARGEST);
        let total = total.ok_or_else(|| fault("tables", "they would need more than 1 GiB".into()))?;
        let numbers = zstd::bulk::decompress(packed, total).map_err(|error| fault("numbers", error.to_string()))?;
        if numbers.len() != total {
            return Err(fault("numbers", format!("{} bytes instead of {total}", numbers.len())));
        }
        let mut rest = &numbers[..];
        let values = manifest.tables.iter().map(|entry| {
            let (own, after) = rest.split_at(size(entry).unwrap_or(0));
            rest = after;
            unpack(entry, own)
        });
        let values = values.collect();
        Ok(Self { manifest, values })
    }

    /// Writes the file: a temporary file beside it, then a rename.
    pub fn write(&self, path: &Path) -> Result<(), FormatError> {
        write_atomic(path, |out| out.write_all(&self.to_bytes()))
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, TableFileError> {
        let io = |source| TableFileError::Io { path: path.to_owned(), source };
        Self::from_bytes(&fs::read(path).map_err(io)?, &path.display().to_string())
    }
}

/// Checks magic, version, lengths and hash; returns manifest and packed numbers.
fn check_header<'a>(bytes: &'a [u8], origin: &str) -> Result<(&'a [u8], &'a [u8]), TableFileError> {
    let origin = || origin.to_owned();
    if bytes.len() < 12 || &bytes[..8] != MAGIC {
        return Err(TableFileError::Foreign { origin: origin() });
    }
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let found = word(8).unwrap_or(0);
    if found != VERSION {
        return Err(TableFileError::Version { origin: origin(), found });
    }
    let damaged = || TableFileError::Damaged { origin: origin() };
    let length = word(12).ok_or_else(damaged)? as usize;
    let body = bytes.get(HEADER..).ok_or_else(damaged)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bytes[8..16]).update(body);
    if hasher.finalize().as_bytes() != &bytes[16..HEADER] || length > body.len() {
        return Err(damaged());
    }
    Ok(body.split_at(length))
}

/// Columns one after the other, in byte planes.
fn pack(entry: &TableEntry, values: &[f32]) -> Vec<u8> {
    assert_eq!(values.len(), entry.rows * entry.columns, "table {}", entry.name);
    let count = values.len();
    let mut planes = vec![0; count * entry.precision.bytes()];
    for (i, at) in by_column(entry).enumerate() {
        let value = values[at] / entry.scale;
        let mut put = |bytes: &[u8]| bytes.iter().enumerate().for_each(|(plane, b)| planes[plane * count + i] = *b);
        match entry.precision {
            Precision::F32 => put(&value.to_le_bytes()),
            Precision::F24 => put(&upper_24(value)),
            Precision::F16 => put(&f16::from_f32(value).to_le_bytes()),
        }
    }
    planes
}

/// The upper three bytes of the nearest f32 that has no more, ties to even.
fn upper_24(value: f32) -> [u8; 3] {
    let bits = value.to_bits();
    let [_, a, b, c] = bits.wrapping_add(0x7f + (bits >> 8 & 1)).to_le_bytes();
    [a, b, c]
}

fn unpack(entry: &TableEntry, planes: &[u8]) -> Vec<f32> {
    let count = entry.rows * entry.columns;
    let mut values = vec![0.0; count];
    for (i, at) in by_column(entry).enumerate() {
        let byte = |plane: usize| planes[plane * count + i];
        let stored = match entry.precision {
            Precision::F32 => f32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]),
            Precision::F24 => f32::from_le_bytes([0, byte(0), byte(1), byte(2)]),
            Precision::F16 => f16::from_le_bytes([byte(0), byte(1)]).to_f32(),
        };
        values[at] = stored * entry.scale;
    }
    values
}

/// Row-major places in column-major order.
fn by_column(entry: &TableEntry) -> impl Iterator<Item = usize> {
    let (rows, columns) = (entry.rows, entry.columns);
    (0..columns).flat_map(move |column| (0..rows).map(move |row| row * columns + column))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> TableFile {
        let entry = |name: &str, precision| TableEntry {
            name: name.into(),
            meaning: "test".into(),
            rows: 3,
            columns: 2,
            precision,
            scale: 0.5,
            look_up_error: 1e-3,
            details: serde_json::json!({"rate": 1.0}),
        };
        TableFile {
            manifest: TableManifest {
                made_by: "test".into(),
                recipe: serde_json::json!({"bins": 3}),
                units: BTreeMap::from([("distance".to_owned(), "1".to_owned())]),
                tables: vec![entry("a", Precision::F32), entry("b", Precision::F16)],
            },
            values: vec![vec![1.0, -2.5, 3.25, 0.1, 1e-9, 7.0], vec![1.0, 2.0, -0.125, 4.0, 0.0, 1024.0]],
        }
    }

    #[test]
    fn a_file_comes_back_and_its_bytes_repeat() {
        let file = sample();
        let bytes = file.to_bytes();
        assert_eq!(bytes, file.to_bytes());
        assert_eq!(TableFile::from_bytes(&bytes, "memory").unwrap(), file);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.tables");
        file.write(&path).unwrap();
        assert_eq!(TableFile::read(&path).unwrap(), file);
    }

    #[test]
    fn each_precision_keeps_its_digits_and_no_more() {
        let value = 0.123_456_79f32;
        let stored = |precision| {
            let mut file = sample();
            file.manifest.tables[0].precision = precision;
            file.values[0][0] = value;
            let back = TableFile::from_bytes(&file.to_bytes(), "memory").unwrap();
            (f64::from(back.values[0][0]) / f64::from(value) - 1.0).abs()
        };
        assert_eq!(stored(Precision::F32), 0.0);
        for (precision, bits) in [(Precision::F24, 17), (Precision::F16, 12)] {
            let unit = 0.5f64.powi(bits);
            assert!((0.01 * unit..unit).contains(&stored(precision)), "{precision:?}: {:e}", stored(precision));
        }
    }

    #[test]
    fn every_flipped_byte_and_every_cut_is_refused() {
        let bytes = sample().to_bytes();
        for i in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[i] ^= 0x10;
            assert!(TableFile::from_bytes(&damaged, "damaged").is_err(), "byte {i}");
            assert!(TableFile::from_bytes(&bytes[..i], "cut").is_err(), "cut at {i}");
        }
    }

    #[test]
    fn strangers_and_other_versions_are_refused_with_the_reason() {
        let foreign = TableFile::from_bytes(b"PNG, or whatever else", "x.png").unwrap_err();
        assert!(foreign.to_string().contains("x.png: this is no table file"), "{foreign}");
        for (version, name) in [(VERSION - 1, "old.tables"), (VERSION + 1, "new.tables")] {
            let mut other = sample().to_bytes();
            other[8..12].copy_from_slice(&version.to_le_bytes());
            let other = TableFile::from_bytes(&other, name).unwrap_err().to_string();
            let reason = format!("{name}: table file version {version}, this program reads version {VERSION}");
            assert!(other.contains(&reason) && other.contains("bake tables generate"), "{other}");
        }
        assert!(matches!(TableFile::read(Path::new("/nowhere/x")), Err(TableFileError::Io { .. })));
    }

    #[test]
    fn a_manifest_that_asks_for_too_much_is_refused() {
        let mut file = sample();
        file.manifest.tables[0].rows = usize::MAX / 2;
        // Only the manifest is grown, as a hostile writer would: the hash fits.
        let manifest = serde_json::to_vec(&file.manifest).unwrap();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((manifest.len() as u32).to_le_bytes());
        let mut hasher = blake3::Hasher::new();
        hasher.update(&bytes[8..16]).update(&manifest);
        bytes.extend(hasher.finalize().as_bytes());
        bytes.extend(manifest);
        let error = TableFile::from_bytes(&bytes, "greedy").unwrap_err();
        assert!(error.to_string().contains("1 GiB"), "{error}");
    }
}
