//! The file of kept paths: chunks of records that the solver writes while it traces and reads back to fold them with other air.
//!
//! ```text
//! offset  size  what
//! 0       8     magic "BAKEPTH\n"
//! 8       4     version, u32 little endian
//! 12      4     length of the header in bytes, u32 little endian
//! 16      …     header, UTF-8 JSON ([`PathHeader`])
//! …       24    of every chunk: page, first texel, texels, first sample, end of the samples, packed bytes; u32 little endian
//! …       …     its records, a zstd frame with checksum
//! …       24    end: 0xFFFFFFFF six times
//! ```
//! Chunks come page by page, samples by samples, texels by texels. What the records mean, `bake-core` knows.

use crate::error::{FormatError, Result};
use serde::{Deserialize, Serialize};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Version written, and the only one read.
pub const VERSION: u32 = 2;

const MAGIC: &[u8; 8] = b"BAKEPTH\n";
const FORMAT: &str = "paths";
/// Most bytes of a header and of a chunk, packed or not: damaged lengths must not ask for all memory.
const LARGEST: usize = 1 << 30;
/// Random digits hardly compress: what does is found at once.
const LEVEL: i32 = 1;

/// What a file of paths says about itself, so that it is not read for another bake.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathHeader {
    /// Texels with a surface behind them, page by page.
    pub texels: Vec<u32>,
    /// Sequences that the samples of a texel are split into.
    pub replicates: u32,
    /// Of so many paths one is kept.
    pub thinning: u32,
    /// Points that factors are looked up at.
    pub stations: u32,
}

/// Which samples of which texels a chunk holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChunkTag {
    /// Page.
    pub page: u32,
    /// First texel, and number of texels.
    pub texels: [u32; 2],
    /// First sample of every sequence, and their end.
    pub samples: [u32; 2],
}

/// Compressed records.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chunk {
    /// Whose they are.
    pub tag: ChunkTag,
    packed: Vec<u8>,
}

impl Chunk {
    /// Compresses records.
    pub fn pack(tag: ChunkTag, records: &[u8]) -> Self {
        let packed = zstd::bulk::Compressor::new(LEVEL).and_then(|mut compressor| {
            compressor.include_checksum(true)?;
            compressor.compress(records)
        });
        Self { tag, packed: packed.expect("compression into memory") }
    }

    /// The records.
    ///
    /// # Errors
    /// They are damaged; `path` is the file, for the message.
    pub fn unpack(&self, path: &Path) -> Result<Vec<u8>> {
        let fault = |reason: String| FormatError::damaged(FORMAT, path, reason);
        let size = zstd::bulk::Decompressor::upper_bound(&self.packed).filter(|&size| size <= LARGEST);
        let size = size.ok_or_else(|| fault(format!("a chunk of page {} has no size", self.tag.page)))?;
        zstd::bulk::decompress(&self.packed, size)
            .map_err(|error| fault(format!("a chunk of page {}: {error}", self.tag.page)))
    }

    fn words(&self) -> [u32; 6] {
        let ChunkTag { page, texels, samples } = self.tag;
        [page, texels[0], texels[1], samples[0], samples[1], self.packed.len() as u32]
    }
}

/// Writes a file of paths.
#[derive(Debug)]
pub struct PathWriter<W> {
    path: PathBuf,
    out: W,
}

impl<W: Write> PathWriter<W> {
    /// Begins the file; `path` is its name, for messages.
    ///
    /// # Errors
    /// The disk is full, for one.
    pub fn new(path: &Path, out: W, header: &PathHeader) -> Result<Self> {
        let mut writer = Self { path: path.into(), out };
        let header = serde_json::to_vec(header).expect("plain data becomes JSON");
        writer.write(MAGIC)?;
        writer.write(&VERSION.to_le_bytes())?;
        writer.write(&(header.len() as u32).to_le_bytes())?;
        writer.write(&header)?;
        Ok(writer)
    }

    /// Adds a chunk.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn add(&mut self, chunk: &Chunk) -> Result<()> {
        self.write(&chunk.words().map(u32::to_le_bytes).concat())?;
        self.write(&chunk.packed)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn finish(mut self) -> Result<W> {
        self.write(&[0xff; 24])?;
        self.out.flush().map_err(FormatError::io("write", &self.path))?;
        Ok(self.out)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.out.write_all(bytes).map_err(FormatError::io("write", &self.path))
    }
}

/// Reads a file of paths.
#[derive(Debug)]
pub struct PathReader<R> {
    path: PathBuf,
    input: R,
    /// The chunk that comes next.
    next: Option<Chunk>,
}

impl<R: Read> PathReader<R> {
    /// Opens the file and judges its header; `path` is its name, for messages.
    ///
    /// # Errors
    /// It is no file of paths, of another version, damaged, or was kept by another bake than `expected` says.
    pub fn new(path: &Path, mut input: R, expected: &PathHeader) -> Result<Self> {
        let fault = |reason: String| FormatError::damaged(FORMAT, path, reason);
        let mut fixed = [0; 16];
        input.read_exact(&mut fixed).map_err(|_| fault("shorter than its header".into()))?;
        if &fixed[..8] != MAGIC {
            let value = String::from_utf8_lossy(&fixed[..8]).into_owned();
            return Err(FormatError::Foreign { path: path.into(), field: "magic", value, expected: "BAKEPTH".into() });
        }
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| fixed[at + i]));
        if word(8) != VERSION {
            return Err(FormatError::Version { path: path.into(), found: word(8), supported: VERSION });
        }
        let mut reader = Self { path: path.into(), input, next: None };
        let header = reader.bytes(word(12) as usize, "its header")?;
        let header: PathHeader = serde_json::from_slice(&header).map_err(|error| fault(format!("header: {error}")))?;
        if header != *expected {
            return Err(FormatError::Stale {
                path: path.into(),
                reason: "the paths were kept for another scene, atlas or version of the program".into(),
            });
        }
        reader.next = reader.read()?;
        Ok(reader)
    }

    /// The chunk that comes next; `None` at the end.
    pub fn peek(&self) -> Option<ChunkTag> {
        Some(self.next.as_ref()?.tag)
    }

    /// Takes the next chunk.
    ///
    /// # Errors
    /// The file ends early.
    pub fn take(&mut self) -> Result<Option<Chunk>> {
        let taken = self.next.take();
        if taken.is_some() {
            self.next = self.read()?;
        }
        Ok(taken)
    }

    /// The file, for messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn read(&mut self) -> Result<Option<Chunk>> {
        let bytes = self.bytes(24, "a chunk")?;
        let words: [u32; 6] = std::array::from_fn(|w| u32::from_le_bytes(std::array::from_fn(|i| bytes[4 * w + i])));
        if words == [u32::MAX; 6] {
            return Ok(None);
        }
        let [page, first, texels, start, end, size] = words;
        let tag = ChunkTag { page, texels: [first, texels], samples: [start, end] };
        Ok(Some(Chunk { tag, packed: self.bytes(size as usize, "a chunk")? }))
    }

    fn bytes(&mut self, count: usize, what: &str) -> Result<Vec<u8>> {
        let fault = |reason: String| FormatError::damaged(FORMAT, &self.path, reason);
        if count > LARGEST {
            return Err(fault(format!("{what} claims {count} bytes")));
        }
        let mut bytes = Vec::new();
        let read = self.input.by_ref().take(count as u64).read_to_end(&mut bytes);
        read.map_err(FormatError::io("read", &self.path))?;
        if bytes.len() < count {
            return Err(fault(format!("it ends within {what}: {} of {count} bytes", bytes.len())));
        }
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> PathHeader {
        PathHeader { texels: vec![70, 3], replicates: 8, thinning: 4, stations: 100 }
    }

    fn tag(page: u32) -> ChunkTag {
        ChunkTag { page, texels: [0, 3], samples: [0, 4] }
    }

    fn file() -> Vec<u8> {
        let mut writer = PathWriter::new("p".as_ref(), Vec::new(), &header()).expect("writes");
        writer.add(&Chunk::pack(tag(0), b"records records records")).expect("writes");
        writer.add(&Chunk::pack(tag(1), b"more")).expect("writes");
        writer.finish().expect("writes")
    }

    fn read(bytes: &[u8], expected: &PathHeader) -> Result<Vec<Vec<u8>>> {
        let path = Path::new("p.paths.zst");
        let mut reader = PathReader::new(path, bytes, expected)?;
        let mut records = Vec::new();
        while let Some(chunk) = reader.take()? {
            records.push(chunk.unpack(path)?);
        }
        Ok(records)
    }

    #[test]
    fn chunks_come_back_in_order() {
        assert_eq!(read(&file(), &header()).expect("reads"), [&b"records records records"[..], b"more"]);
    }

    #[test]
    fn another_bakes_paths_are_refused() {
        let error = read(&file(), &PathHeader { stations: 99, ..header() }).expect_err("another header");
        assert!(matches!(error, FormatError::Stale { .. }), "{error}");
        let error = read(&[b"BAKETBL\n", &file()[8..]].concat(), &header()).expect_err("another magic");
        assert!(error.to_string().contains("magic"), "{error}");
        let mut newer = file();
        newer[8] = 9;
        assert!(matches!(read(&newer, &header()), Err(FormatError::Version { found: 9, .. })));
    }

    #[test]
    fn cut_and_flipped_files_are_refused() {
        let file = file();
        for end in 0..file.len() {
            assert!(read(&file[..end], &header()).is_err(), "{end} of {} bytes", file.len());
        }
        // Tags are judged by who reads the chunks, and of every frame's descriptor the bit 0x10 means nothing (RFC 8878, 3.1.1.1.1.3);
        // everything else is told here.
        let flips: Vec<usize> = (0..file.len())
            .filter(|&i| {
                let mut flipped = file.clone();
                flipped[i] ^= 0x10;
                read(&flipped, &header()).is_ok()
            })
            .collect();
        assert!(flips.len() <= 2 * 21, "{flips:?}");
    }
}
