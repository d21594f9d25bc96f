//! One glTF primitive: finds its attributes (plain or Draco) and turns its topology into triangles.

use super::accessor::{Accessors, Component, View};
use super::buffers::Buffers;
use super::document::{Document, PrimitiveRecord};
use super::draco;
use super::error::{Fault, Place, Refusal, lookup};
use super::files::Files;
use draco_gltf::PackedGeometry;

/// Memory of a triangle that shares no vertex: three times position, normal, two texture coordinates and colour.
const TRIANGLE_BYTES: u64 = 3 * (12 + 12 + 16 + 16 + 4);

/// What reading a primitive takes.
pub(super) struct Source<'a> {
    pub document: &'a Document,
    pub accessors: &'a Accessors<'a>,
    pub buffers: &'a Buffers<'a>,
    pub files: &'a Files,
}

/// A primitive whose compressed part, if any, is decoded.
pub(super) struct Reader<'a> {
    source: &'a Source<'a>,
    record: &'a PrimitiveRecord,
    place: Place<'a>,
    packed: Option<PackedGeometry>,
}

impl<'a> Reader<'a> {
    /// Decodes what is compressed.
    pub fn new(source: &'a Source<'a>, record: &'a PrimitiveRecord, place: Place<'a>) -> Result<Self, Refusal> {
        let mut reader = Self { source, record, place, packed: None };
        if let Some(compressed) = &record.extensions.draco {
            let at = place.field("extensions.KHR_draco_mesh_compression.bufferView");
            lookup(&source.document.buffer_views, "bufferViews", compressed.buffer_view, &at)?;
            let allowance = &source.files.geometry;
            reader.packed =
                Some(draco::decode(record, compressed, source.accessors, source.buffers, allowance, &place)?);
        }
        Ok(reader)
    }

    /// An attribute, if the primitive has it; `widths` are the numbers of components it may have.
    pub fn attribute(&self, name: &str, widths: &[usize]) -> Result<Option<View<'_>>, Refusal> {
        let Some(&index) = self.record.attributes.get(name) else { return Ok(None) };
        let list = self.place.field("attributes");
        let place = list.field(name);
        let view = match self.packed.as_ref().and_then(|packed| draco::attribute(packed, name)) {
            Some(view) => view,
            None => self.source.accessors.open(index, &place)?,
        };
        if !widths.contains(&view.width) {
            let value = format!("accessors[{index}] with {} components", view.width);
            return Err(Fault::value(value, format!("{widths:?} components")).at(&place));
        }
        if view.component == Component::U32 {
            return Err(Fault::value("of component type 5125", "5120, 5121, 5122, 5123 or 5126").at(&place));
        }
        Ok(Some(view))
    }

    /// The triangles, every index below `vertices`.
    pub fn triangles(&self, vertices: u64) -> Result<Vec<[u32; 3]>, Refusal> {
        let place = self.place.field("indices");
        let view = match (self.packed.as_ref().and_then(draco::indices), self.record.indices) {
            (Some(view), _) => Some(view),
            (None, Some(index)) => Some(self.open_indices(index, &place)?),
            (None, None) => None,
        };
        let count = view.as_ref().map_or(vertices, |view| view.count);
        let topology = if self.packed.is_some() { Topology::List } else { self.topology()? };
        let triangles = topology.triangles(count);
        self.source.files.geometry.take(triangles, TRIANGLE_BYTES).map_err(|fault| fault.at(&place))?;
        let corner = |at: u64| match &view {
            Some(view) if u64::from(view.index(at)) >= vertices => {
                Err(Fault::value(format!("{} at position {at}", view.index(at)), format!("below {vertices}"))
                    .at(&place))
            }
            Some(view) => Ok(view.index(at)),
            None => Ok(at as u32),
        };
        (0..triangles)
            .map(|t| {
                let [a, b, c] = topology.corners(t);
                Ok([corner(a)?, corner(b)?, corner(c)?])
            })
            .collect()
    }

    fn open_indices(&self, index: u32, place: &Place) -> Result<View<'_>, Refusal> {
        let view = self.source.accessors.open(index, place)?;
        let integer = matches!(view.component, Component::U8 | Component::U16 | Component::U32);
        if !integer || view.width != 1 {
            let value = format!("accessors[{index}] of {:?} × {}", view.component, view.width);
            return Err(Fault::value(value, "a SCALAR of unsigned integers").at(place));
        }
        Ok(view)
    }

    fn topology(&self) -> Result<Topology, Refusal> {
        match self.record.mode.unwrap_or(4) {
            4 => Ok(Topology::List),
            5 => Ok(Topology::Strip),
            6 => Ok(Topology::Fan),
            mode => Err(Fault::value(mode, "0 to 6").at(&self.place.field("mode"))),
        }
    }
}

/// How corners make triangles; glTF 2.0, section 3.7.2.1.
#[derive(Debug, Clone, Copy)]
enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// Number of whole triangles.
    fn triangles(self, corners: u64) -> u64 {
        match self {
            Self::List => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// Positions of triangle `t`'s corners, keeping the front face.
    fn corners(self, t: u64) -> [u64; 3] {
        match self {
            Self::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Self::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Self::Fan => [t + 1, t + 2, 0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        // The examples of the specification's section 3.7.2.1.
        let all = |topology: Topology, n| (0..topology.triangles(n)).map(|t| topology.corners(t)).collect::<Vec<_>>();
        assert_eq!(all(Topology::List, 7), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(all(Topology::Strip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(all(Topology::Fan, 5), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert!(all(Topology::Strip, 1).is_empty());
    }
}
