//! Collects a document and its one buffer, and joins them into GLB bytes.

use super::document::{Accessor, Asset, Buffer, BufferView, Document, Image};
use super::{CHUNK_BIN, CHUNK_JSON, FLOAT, MAGIC, UNSIGNED_INT};

/// A GLB in the making.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    /// Everything but accessors and buffers is filled in by the caller.
    pub document: Document,
    buffer: Vec<u8>,
}

impl Builder {
    /// Adds an accessor of N floats an element; `bounded` adds minimum and maximum, as POSITION needs them.
    pub fn floats<const N: usize>(&mut self, values: impl Iterator<Item = [f32; N]>, bounded: bool) -> u32 {
        let start = self.align();
        let (mut min, mut max) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        let mut count = 0;
        for value in values {
            for i in 0..N {
                (min[i], max[i]) = (min[i].min(value[i]), max[i].max(value[i]));
                self.buffer.extend(value[i].to_le_bytes());
            }
            count += 1;
        }
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let [min, max] = [min, max].map(|bound| bounded.then(|| bound.to_vec()));
        self.accessor(start, FLOAT, count, kind, [min, max])
    }

    /// Adds an index accessor.
    pub fn indices(&mut self, values: impl Iterator<Item = u32>) -> u32 {
        let start = self.align();
        self.buffer.extend(values.flat_map(u32::to_le_bytes));
        let count = (self.buffer.len() - start) / 4;
        self.accessor(start, UNSIGNED_INT, count as u32, "SCALAR", [None, None])
    }

    /// Adds an embedded PNG.
    pub fn png(&mut self, name: Option<String>, bytes: &[u8]) -> u32 {
        let start = self.align();
        self.buffer.extend(bytes);
        let buffer_view = Some(self.view(start));
        self.document.images.push(Image { name, uri: None, mime_type: Some("image/png".into()), buffer_view });
        self.document.images.len() as u32 - 1
    }

    fn align(&mut self) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        self.buffer.len()
    }

    fn view(&mut self, start: usize) -> u32 {
        let byte_length = (self.buffer.len() - start) as u64;
        self.document.buffer_views.push(BufferView { buffer: 0, byte_offset: start as u64, byte_length });
        self.document.buffer_views.len() as u32 - 1
    }

    fn accessor(
        &mut self,
        start: usize,
        component_type: u32,
        count: u32,
        kind: &str,
        bounds: [Option<Vec<f32>>; 2],
    ) -> u32 {
        let buffer_view = self.view(start);
        let [min, max] = bounds;
        self.document.accessors.push(Accessor { buffer_view, component_type, count, kind: kind.into(), min, max });
        self.document.accessors.len() as u32 - 1
    }

    /// The file's bytes; `None` when they pass GLB's limit of 4 GiB.
    pub fn finish(mut self) -> Option<Vec<u8>> {
        self.align();
        self.document.asset = Asset { version: "2.0".into(), generator: "bake".into() };
        self.document.buffers = vec![Buffer { byte_length: self.buffer.len() as u64 }];
        let mut json = serde_json::to_vec(&self.document).expect("plain data becomes JSON");
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = u32::try_from(12 + 8 + json.len() + 8 + self.buffer.len()).ok()?;
        let mut bytes = Vec::with_capacity(length as usize);
        for word in [MAGIC, 2, length, json.len() as u32, CHUNK_JSON] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(&json);
        for word in [self.buffer.len() as u32, CHUNK_BIN] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(&self.buffer);
        Some(bytes)
    }
}
