//! Accessors over checked bytes: after [`Accessors::open`] every element of a view can be read without a further check.

use super::buffers::Buffers;
use super::document::{Accessor, Document, Sparse};
use super::error::{Fault, Place, Refusal, lookup};

/// The accessors of one document.
pub(super) struct Accessors<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
}

/// An accessor whose bytes are known to be there.
pub(super) struct View<'a> {
    /// Number of elements.
    pub count: u64,
    /// Components an element.
    pub width: usize,
    /// Type of the components.
    pub component: Component,
    normalized: bool,
    /// None reads as zeros.
    bytes: Option<&'a [u8]>,
    stride: usize,
    sparse: Option<SparseView<'a>>,
}

/// Elements that replace those of the base; positions ascend.
struct SparseView<'a> {
    positions: Vec<u64>,
    values: &'a [u8],
}

/// Component types of glTF 2.0, section 3.6.2.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u32) -> Result<Self, Fault> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(Fault::value(code, "5120, 5121, 5122, 5123, 5125 or 5126")),
        })
    }

    /// Bytes a component.
    pub const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// One component as a float; integers divided by their maximum when normalized (glTF 2.0, section 3.6.2.2,
    /// where the most negative value reads as −1).
    pub fn to_f32(self, b: &[u8], normalized: bool) -> f32 {
        let (value, scale) = match self {
            Self::I8 => (f32::from(b[0] as i8), 127.0),
            Self::U8 => (f32::from(b[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => (u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, 4_294_967_295.0),
            Self::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        if normalized { (value / scale).max(-1.0) } else { value }
    }

    fn to_u32(self, b: &[u8]) -> u32 {
        match self {
            Self::U8 => b[0].into(),
            Self::U16 => u16::from_le_bytes([b[0], b[1]]).into(),
            _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

impl<'a> View<'a> {
    /// Tightly packed bytes of `count` elements.
    pub fn packed(bytes: &'a [u8], count: usize, width: usize, component: Component, normalized: bool) -> Self {
        let stride = width * component.size();
        debug_assert!(bytes.len() >= count * stride);
        Self { count: count as u64, width, component, normalized, bytes: Some(bytes), stride, sparse: None }
    }

    /// Element `index < count`, as floats; the first `N` components.
    pub fn floats<const N: usize>(&self, index: u64) -> [f32; N] {
        let size = self.component.size();
        let read = |b: &[u8]| std::array::from_fn(|i| self.component.to_f32(&b[i * size..], self.normalized));
        self.element(index).map_or([0.0; N], read)
    }

    /// Element `index < count` of a scalar integer accessor.
    pub fn index(&self, index: u64) -> u32 {
        self.element(index).map_or(0, |b| self.component.to_u32(b))
    }

    fn element(&self, index: u64) -> Option<&[u8]> {
        debug_assert!(index < self.count);
        if let Some(sparse) = &self.sparse
            && let Ok(at) = sparse.positions.binary_search(&index)
        {
            return Some(&sparse.values[at * self.width * self.component.size()..]);
        }
        self.bytes.map(|bytes| &bytes[index as usize * self.stride..])
    }
}

impl<'a> Accessors<'a> {
    /// Checks every accessor of the document, used or not.
    pub fn new(document: &'a Document, buffers: &'a Buffers<'a>) -> Result<Self, Refusal> {
        let accessors = Self { document, buffers };
        for index in 0..document.accessors.len() {
            accessors.open(index as u32, &Place::root("accessors"))?;
        }
        Ok(accessors)
    }

    /// Count and normalization of an accessor whose data lies elsewhere (Draco).
    pub fn declared(&self, index: u32, from: &Place) -> Result<(u64, bool), Refusal> {
        let record = lookup(&self.document.accessors, "accessors", index, from)?;
        Ok((record.count, record.normalized))
    }

    /// Opens an accessor that `from` refers to.
    pub fn open(&self, index: u32, from: &Place) -> Result<View<'a>, Refusal> {
        let record = lookup(&self.document.accessors, "accessors", index, from)?;
        let place = Place::entry("accessors", index as usize);
        let component =
            Component::from_code(record.component_type).map_err(|fault| fault.at(&place.field("componentType")))?;
        let width = width_of(&record.kind).map_err(|fault| fault.at(&place.field("type")))?;
        if record.count == 0 {
            return Err(Fault::value(0, "1 or more").at(&place.field("count")));
        }
        let mut view = View {
            count: record.count,
            width,
            component,
            normalized: record.normalized,
            bytes: None,
            stride: 0,
            sparse: None,
        };
        if let Some(bytes) = self.base(record, width * component.size(), &place)? {
            (view.bytes, view.stride) = (Some(bytes.0), bytes.1);
        }
        if let Some(sparse) = &record.sparse {
            view.sparse = Some(self.sparse(record, sparse, width * component.size(), &place.field("sparse"))?);
        }
        Ok(view)
    }

    /// Bytes and stride of the dense part.
    fn base(&self, record: &Accessor, element: usize, place: &Place) -> Result<Option<(&'a [u8], usize)>, Refusal> {
        let Some(index) = record.buffer_view else { return Ok(None) };
        let view = lookup(&self.document.buffer_views, "bufferViews", index, &place.field("bufferView"))?;
        let stride = match (&view.extensions.meshopt, view.byte_stride) {
            (Some(meshopt), None) if meshopt.mode == "ATTRIBUTES" => meshopt.byte_stride,
            (_, stride) => stride.unwrap_or(element as u64),
        };
        if stride < element as u64 {
            let allowed = format!("{element} or more for {place}");
            return Err(
                Fault::value(stride, allowed).at(&Place::entry("bufferViews", index as usize).field("byteStride"))
            );
        }
        let needed = (record.count - 1).saturating_mul(stride).saturating_add(element as u64);
        let bytes = self.slice(index, record.byte_offset, needed, place)?;
        Ok(Some((bytes, stride as usize)))
    }

    fn sparse(
        &self,
        record: &Accessor,
        sparse: &Sparse,
        element: usize,
        place: &Place,
    ) -> Result<SparseView<'a>, Refusal> {
        if sparse.count == 0 || sparse.count > record.count {
            return Err(Fault::value(sparse.count, format!("1 to {}", record.count)).at(&place.field("count")));
        }
        let at = place.field("indices");
        let component = Component::from_code(sparse.indices.component_type)
            .and_then(|c| {
                if c.is_index() {
                    Ok(c)
                } else {
                    Err(Fault::value(sparse.indices.component_type, "5121, 5123 or 5125"))
                }
            })
            .map_err(|fault| fault.at(&at.field("componentType")))?;
        let size = component.size();
        lookup(&self.document.buffer_views, "bufferViews", sparse.indices.buffer_view, &at.field("bufferView"))?;
        let bytes = self.slice(
            sparse.indices.buffer_view,
            sparse.indices.byte_offset,
            sparse.count.saturating_mul(size as u64),
            &at,
        )?;
        let positions: Vec<u64> = bytes.chunks_exact(size).map(|b| component.to_u32(b).into()).collect();
        if let Some(pair) = positions.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(Fault::value(format!("{} after {}", pair[1], pair[0]), "strictly ascending").at(&at));
        }
        if let Some(&last) = positions.last().filter(|last| **last >= record.count) {
            return Err(Fault::value(last, format!("below {}", record.count)).at(&at));
        }
        let at = place.field("values");
        lookup(&self.document.buffer_views, "bufferViews", sparse.values.buffer_view, &at.field("bufferView"))?;
        let needed = sparse.count.saturating_mul(element as u64);
        let values = self.slice(sparse.values.buffer_view, sparse.values.byte_offset, needed, &at)?;
        Ok(SparseView { positions, values })
    }

    fn slice(&self, view: u32, offset: u64, needed: u64, place: &Place) -> Result<&'a [u8], Refusal> {
        let bytes = self.buffers.view(view);
        let end = offset.saturating_add(needed);
        if end > bytes.len() as u64 {
            let of = format!("bufferViews[{view}]");
            return Err(Fault::Bounds { needed: end, of, present: bytes.len() as u64 }.at(place));
        }
        Ok(&bytes[offset as usize..end as usize])
    }
}

/// Components of an accessor type. Columns of matrices of small integers are padded to four bytes; no bake reads
/// matrices, so that padding is not counted.
fn width_of(kind: &str) -> Result<usize, Fault> {
    Ok(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return Err(Fault::value(format!("`{kind}`"), "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4")),
    })
}
