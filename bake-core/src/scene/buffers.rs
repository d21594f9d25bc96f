//! Buffers and buffer views: every byte range of the file is checked once, here; compressed views are decoded.

use super::document::{Document, MeshoptRecord};
use super::error::{Fault, Place, Refusal, lookup};
use super::files::Files;
use draco_gltf::meshopt;
use std::ops::Range;

/// The bytes of all buffer views.
pub(super) struct Buffers<'a> {
    bin: &'a [u8],
    /// Content of each buffer; none for the GLB's own chunk.
    owned: Vec<Option<Vec<u8>>>,
    views: Vec<ViewBytes>,
}

enum ViewBytes {
    /// Part of a buffer.
    Range { buffer: u32, range: Range<usize> },
    /// Decompressed.
    Decoded(Vec<u8>),
}

impl<'a> Buffers<'a> {
    /// Reads all buffers of the document and checks all views. `bin` is the GLB's binary chunk.
    pub fn new(document: &Document, bin: Option<&'a [u8]>, files: &Files) -> Result<Self, Refusal> {
        let mut buffers = Self { bin: bin.unwrap_or_default(), owned: Vec::new(), views: Vec::new() };
        for index in 0..document.buffers.len() {
            let content = read_buffer(document, index, bin, files)?;
            buffers.owned.push(content);
        }
        for index in 0..document.buffer_views.len() {
            let view = buffers.check_view(document, index, files)?;
            buffers.views.push(view);
        }
        Ok(buffers)
    }

    /// Bytes of a buffer view; the index has been looked up.
    pub fn view(&self, index: u32) -> &[u8] {
        match &self.views[index as usize] {
            ViewBytes::Range { buffer, range } => &self.buffer(*buffer)[range.clone()],
            ViewBytes::Decoded(bytes) => bytes,
        }
    }

    fn buffer(&self, index: u32) -> &[u8] {
        self.owned[index as usize].as_deref().unwrap_or(self.bin)
    }

    fn check_view(&self, document: &Document, index: usize, files: &Files) -> Result<ViewBytes, Refusal> {
        let view = &document.buffer_views[index];
        let place = Place::entry("bufferViews", index);
        if let Some(stride) = view.byte_stride
            && !(4..=252).contains(&stride)
        {
            return Err(Fault::value(stride, "4 to 252").at(&place.field("byteStride")));
        }
        if let Some(record) = &view.extensions.meshopt {
            let at = place.field("extensions.EXT_meshopt_compression");
            return self.decode_meshopt(document, record, &at, files).map(ViewBytes::Decoded);
        }
        let range = self.range(document, view.buffer, view.byte_offset, view.byte_length, &place)?;
        Ok(ViewBytes::Range { buffer: view.buffer, range })
    }

    fn range(
        &self,
        document: &Document,
        buffer: u32,
        offset: u64,
        length: u64,
        place: &Place,
    ) -> Result<Range<usize>, Refusal> {
        let record = lookup(&document.buffers, "buffers", buffer, &place.field("buffer"))?;
        let present = record.byte_length.min(self.buffer(buffer).len() as u64);
        let end = offset.saturating_add(length);
        if end > present {
            return Err(Fault::Bounds { needed: end, of: format!("buffers[{buffer}]"), present }.at(place));
        }
        Ok(offset as usize..end as usize)
    }

    fn decode_meshopt(
        &self,
        document: &Document,
        record: &MeshoptRecord,
        place: &Place,
        files: &Files,
    ) -> Result<Vec<u8>, Refusal> {
        let source = self.range(document, record.buffer, record.byte_offset, record.byte_length, place)?;
        let source = &self.buffer(record.buffer)[source];
        let decode = |reason: String| Fault::Decode { format: "meshopt", reason }.at(place);
        let mode = meshopt::MeshoptMode::from_name(&record.mode).map_err(|e| decode(e.to_string()))?;
        let filter = record.filter.as_deref().unwrap_or("NONE");
        let filter = meshopt::MeshoptFilter::from_name(filter).map_err(|e| decode(e.to_string()))?;
        check_meshopt_stride(mode, record.byte_stride).map_err(|fault| fault.at(&place.field("byteStride")))?;
        files.geometry.take(record.count, record.byte_stride).map_err(|fault| fault.at(&place.field("count")))?;
        let (count, stride) = (record.count as usize, record.byte_stride as usize);
        let mut out = vec![0; count * stride];
        meshopt::decode_buffer_view(&mut out, source, mode, filter, count, stride)
            .map_err(|e| decode(e.to_string()))?;
        Ok(out)
    }
}

/// EXT_meshopt_compression, "JSON schema updates": strides of attributes are multiples of 4 up to 256, of indices 2 or 4.
fn check_meshopt_stride(mode: meshopt::MeshoptMode, stride: u64) -> Result<(), Fault> {
    let (good, allowed) = match mode {
        meshopt::MeshoptMode::Attributes => {
            (stride.is_multiple_of(4) && (4..=256).contains(&stride), "a multiple of 4 up to 256")
        }
        _ => (stride == 2 || stride == 4, "2 or 4"),
    };
    if good { Ok(()) } else { Err(Fault::value(stride, allowed)) }
}

/// Content of one buffer; none stands for the GLB's binary chunk.
fn read_buffer(
    document: &Document,
    index: usize,
    bin: Option<&[u8]>,
    files: &Files,
) -> Result<Option<Vec<u8>>, Refusal> {
    let record = &document.buffers[index];
    let place = Place::entry("buffers", index);
    let content = match &record.uri {
        Some(uri) => Some(files.fetch(uri, &place.field("uri"))?),
        // The uncompressed copy that a meshopt-compressed file leaves out.
        None if record.extensions.meshopt.is_some() => return Ok(Some(Vec::new())),
        None if index == 0 && bin.is_some() => None,
        None => {
            return Err(
                Fault::value("absent", "a URI (only buffers[0] of a .glb may do without)").at(&place.field("uri"))
            );
        }
    };
    let present = content.as_deref().or(bin).map_or(0, <[u8]>::len) as u64;
    if record.byte_length > present {
        let of = if record.uri.is_some() { "its file" } else { "the binary chunk" };
        return Err(Fault::Bounds { needed: record.byte_length, of: of.into(), present }.at(&place.field("byteLength")));
    }
    Ok(content)
}
