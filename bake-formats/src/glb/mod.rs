//! A small GLB of our own shape, written and read: triangles, f32 attributes, u32 indices, embedded PNGs, no compression.
//!
//! It knows just what `NAME.baked.glb` holds ([`crate::baked_scene`]); general glTF files are the loader's business.

pub mod document;
mod read;
mod write;

pub(crate) use read::Reader;
pub(crate) use write::Builder;

/// The four bytes at the start.
const MAGIC: u32 = u32::from_le_bytes(*b"glTF");
/// Type of the chunk that holds the document.
const CHUNK_JSON: u32 = u32::from_le_bytes(*b"JSON");
/// Type of the chunk that holds the buffer.
const CHUNK_BIN: u32 = u32::from_le_bytes(*b"BIN\0");
/// glTF's code of 32-bit floats.
const FLOAT: u32 = 5126;
/// glTF's code of 32-bit unsigned integers.
const UNSIGNED_INT: u32 = 5125;
