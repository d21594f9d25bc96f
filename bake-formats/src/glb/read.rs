//! Takes GLB bytes apart; every index and range is checked.

use super::document::{Accessor, Document};
use super::{CHUNK_BIN, CHUNK_JSON, FLOAT, MAGIC, UNSIGNED_INT};
use crate::error::{FormatError, Result};
use std::path::Path;

/// A GLB file taken apart.
pub(crate) struct Reader<'a> {
    pub document: Document,
    pub path: &'a Path,
    buffer: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Splits the container and parses the document.
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self> {
        let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let damaged = |reason: &str| FormatError::damaged("GLB", path, reason);
        if word(0) != Some(MAGIC) || word(4) != Some(2) {
            return Err(damaged("no glTF 2 header"));
        }
        let chunk = |at: usize, kind: u32| {
            let length = word(at)? as usize;
            (word(at + 4)? == kind).then(|| bytes.get(at + 8..(at + 8).checked_add(length)?)).flatten()
        };
        let json = chunk(12, CHUNK_JSON).ok_or_else(|| damaged("no JSON chunk"))?;
        let buffer = chunk(20 + json.len(), CHUNK_BIN).ok_or_else(|| damaged("no BIN chunk"))?;
        let document = serde_json::from_slice(json).map_err(|error| FormatError::damaged("GLB", path, error))?;
        Ok(Self { document, path, buffer })
    }

    /// A field that points nowhere or at the wrong kind of thing.
    pub fn invalid(&self, field: String, value: impl ToString, expected: &str) -> FormatError {
        FormatError::invalid(self.path, field, value, format!("{expected}; bake again"))
    }

    fn accessor(&self, index: u32, kind: &str, component_type: u32) -> Result<&Accessor> {
        let field = || format!("accessor {index}");
        let accessor = self.document.accessors.get(index as usize);
        let accessor = accessor.ok_or_else(|| self.invalid(field(), "absent", "an accessor"))?;
        if accessor.kind != kind || accessor.component_type != component_type {
            let found = format!("{} of {}", accessor.kind, accessor.component_type);
            return Err(self.invalid(field(), found, &format!("{kind} of {component_type}")));
        }
        Ok(accessor)
    }

    fn words(&self, index: u32, kind: &str, component_type: u32, per_element: usize) -> Result<Vec<[u8; 4]>> {
        let accessor = self.accessor(index, kind, component_type)?;
        let bytes = self.view(accessor.buffer_view)?;
        let needed = accessor.count as usize * per_element * 4;
        let bytes = bytes.get(..needed).ok_or_else(|| {
            self.invalid(format!("accessor {index}: count"), accessor.count, "no more than its buffer view holds")
        })?;
        Ok(bytes.as_chunks::<4>().0.to_vec())
    }

    /// Bytes of a buffer view.
    pub fn view(&self, index: u32) -> Result<&'a [u8]> {
        let view = self.document.buffer_views.get(index as usize);
        let bytes = view.and_then(|view| {
            let (start, length) = (usize::try_from(view.byte_offset).ok()?, usize::try_from(view.byte_length).ok()?);
            self.buffer.get(start..start.checked_add(length)?)
        });
        bytes.ok_or_else(|| self.invalid(format!("buffer view {index}"), "out of range", "a range of the buffer"))
    }

    /// Elements of a float accessor; all finite.
    pub fn floats<const N: usize>(&self, index: u32) -> Result<Vec<[f32; N]>> {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let words = self.words(index, kind, FLOAT, N)?;
        let values: Vec<[f32; N]> =
            words.as_chunks::<N>().0.iter().map(|element| element.map(f32::from_le_bytes)).collect();
        if let Some(bad) = values.iter().flatten().find(|value| !value.is_finite()) {
            return Err(self.invalid(format!("accessor {index}"), bad, "finite numbers"));
        }
        Ok(values)
    }

    /// Triangles of an index accessor, each index below `vertices`.
    pub fn triangles(&self, index: u32, vertices: usize) -> Result<Vec<[u32; 3]>> {
        let words = self.words(index, "SCALAR", UNSIGNED_INT, 1)?;
        let indices: Vec<u32> = words.into_iter().map(u32::from_le_bytes).collect();
        if let Some(bad) = indices.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Err(self.invalid(format!("accessor {index}"), bad, &format!("indices below {vertices}")));
        }
        Ok(indices.as_chunks::<3>().0.to_vec())
    }
}
