//! OpenVDB files, read without OpenVDB: fog volumes of 32- or 16-bit floats, in files since version 222 (OpenVDB 2, 2013).
//!
//! Active voxels and tiles become a dense lattice; what is inactive counts as zero. Own code, because the one crate there
//! is (vdb-rs 0.6.0) panics, allocates what a file asks for and decodes damaged Blosc chunks outside of Rust's checks; it also
//! drops tiles and most transforms. *Source*: the format as OpenVDB 10 reads it (io/Archive.cc, io/Compression.h,
//! tree/InternalNode.h, math/Maps.h).

mod bytes;
mod codec;
mod header;
mod tree;

use super::{GridFault, Lattice};
use bytes::Bytes;
use header::Descriptor;

const FORMAT: &str = "OpenVDB";

/// Reads the grid called `name`, or the only one.
pub fn read(file: &[u8], name: Option<&str>) -> Result<Lattice, GridFault> {
    let mut bytes = Bytes::new(file);
    let grids = header::read(&mut bytes)?;
    let grid = choose(&grids, name)?;
    grid.check_kind()?;
    let head = grid.head(&bytes)?;
    tree::read(head, grid)?.into_lattice(grid, head.world_from_index, file.len())
}

fn choose<'a>(grids: &'a [Descriptor], name: Option<&str>) -> Result<&'a Descriptor, GridFault> {
    let names = || grids.iter().map(Descriptor::describe).collect();
    match (grids, name) {
        (_, Some(name)) => grids.iter().find(|grid| grid.name == name).ok_or_else(|| GridFault::NoSuch {
            what: "grid",
            name: name.into(),
            names: names(),
        }),
        ([], None) => Err(GridFault::damaged(FORMAT, "it holds no grid")),
        ([only], None) => Ok(only),
        (_, None) => Err(GridFault::Several { what: "grid", names: names() }),
    }
}
