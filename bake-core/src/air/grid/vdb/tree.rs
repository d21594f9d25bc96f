//! The tree of a grid: a root of nodes of 32³, of nodes of 16³, of leaves of 8³ voxels.

use super::FORMAT;
use super::bytes::Bytes;
use super::codec::{self, Stream};
use super::header::{Descriptor, Head};
use crate::air::grid::{GridFault, Lattice, checked_points};
use glam::{DAffine3, I64Vec3, IVec3};

/// Voxels along a leaf, and along what a node of each level spans per entry.
const LEAF: i32 = 8;
const LOWER: i32 = 8 * 16;

/// Active values of a grid.
#[derive(Debug)]
pub struct Tree {
    tiles: Vec<Tile>,
    leaves: Vec<Leaf>,
}

/// A cube of one value.
#[derive(Debug)]
struct Tile {
    origin: IVec3,
    side: i32,
    value: f32,
}

/// Voxels of 8³; the last axis is the fastest.
#[derive(Debug)]
struct Leaf {
    origin: IVec3,
    active: codec::Mask,
    values: Vec<f32>,
}

/// Reads tree and voxels.
pub fn read(head: Head, grid: &Descriptor) -> Result<Tree, GridFault> {
    let Head { compression, tree: mut bytes, mut leaves, .. } = head;
    let buffers = bytes.u32()?;
    if buffers != 1 {
        return Err(GridFault::damaged(FORMAT, format!("{buffers} buffers a voxel")));
    }
    let background = bytes.f32()?;
    if background != 0.0 {
        return Err(GridFault::Background { background });
    }
    let stream = Stream { compression, half: grid.half, background };
    let mut tree = Tree { tiles: Vec::new(), leaves: Vec::new() };
    let (tiles, children) = (bytes.u32()?, bytes.u32()?);
    for _ in 0..tiles {
        let (origin, value, active) = (coordinates(&mut bytes)?, bytes.f32()?, bytes.u8()? != 0);
        tree.add_tile(active, origin, 32 * LOWER, value);
    }
    for _ in 0..children {
        let origin = coordinates(&mut bytes)?;
        tree.read_node(&mut bytes, &stream, origin, 5)?;
    }
    for leaf in &mut tree.leaves {
        leaf.active = codec::Mask::read(&mut leaves, 3)?;
        leaf.values = stream.values(&mut leaves, &leaf.active)?;
    }
    Ok(tree)
}

/// A corner whose nodes stay within 32-bit numbers.
fn coordinates(bytes: &mut Bytes) -> Result<IVec3, GridFault> {
    let at = IVec3::new(bytes.i32()?, bytes.i32()?, bytes.i32()?);
    match at.as_i64vec3().abs().max_element() < 1 << 30 {
        true => Ok(at),
        false => Err(GridFault::damaged(FORMAT, format!("a node at {at}"))),
    }
}

impl Tree {
    /// Reads a node of 2^`log2` entries a side, and all below it.
    fn read_node(&mut self, bytes: &mut Bytes, stream: &Stream, origin: IVec3, log2: u32) -> Result<(), GridFault> {
        let side = if log2 == 5 { LOWER } else { LEAF };
        let children = codec::Mask::read(bytes, log2)?;
        let active = codec::Mask::read(bytes, log2)?;
        let values = stream.values(bytes, &active)?;
        let corner = |index: usize| origin + side * entry(index, log2);
        for index in active.ones().filter(|&index| !children.is_on(index)) {
            self.add_tile(true, corner(index), side, values[index]);
        }
        for index in children.ones() {
            if log2 == 5 {
                self.read_node(bytes, stream, corner(index), 4)?;
            } else {
                let active = codec::Mask::read(bytes, 3)?;
                self.leaves.push(Leaf { origin: corner(index), active, values: Vec::new() });
            }
        }
        Ok(())
    }

    fn add_tile(&mut self, active: bool, origin: IVec3, side: i32, value: f32) {
        if active {
            self.tiles.push(Tile { origin, side, value });
        }
    }

    /// The box of active voxels as a dense lattice.
    pub fn into_lattice(
        self,
        grid: &Descriptor,
        world_from_index: DAffine3,
        bytes: usize,
    ) -> Result<Lattice, GridFault> {
        let Some((min, max)) = self.active_box() else { return Err(GridFault::Empty { name: grid.name.clone() }) };
        let side = |axis: usize| u32::try_from(max[axis] - min[axis] + 1).unwrap_or(u32::MAX);
        let size = [side(0), side(1), side(2)];
        let mut dense = Dense { min, size, values: vec![0.0; checked_points(size, bytes)?] };
        self.tiles.iter().for_each(|tile| dense.fill(tile));
        self.leaves.iter().for_each(|leaf| dense.copy(leaf));
        let world_from_grid = world_from_index * DAffine3::from_translation(min.as_dvec3());
        Ok(Lattice { size, values: dense.values, world_from_grid: Some(world_from_grid) })
    }

    /// Lowest and highest active voxel.
    fn active_box(&self) -> Option<(I64Vec3, I64Vec3)> {
        let tiles = self.tiles.iter().map(|tile| (tile.origin, tile.origin + (tile.side - 1)));
        let voxels = self.leaves.iter().flat_map(|leaf| leaf.active.ones().map(|index| leaf.origin + entry(index, 3)));
        let boxes = tiles.chain(voxels.map(|voxel| (voxel, voxel)));
        let both = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        both.map(|(min, max)| (min.as_i64vec3(), max.as_i64vec3()))
    }
}

/// Position of an entry in its node.
fn entry(index: usize, log2: u32) -> IVec3 {
    let (index, mask) = (index as i32, (1 << log2) - 1);
    IVec3::new(index >> (2 * log2), index >> log2 & mask, index & mask)
}

struct Dense {
    min: I64Vec3,
    size: [u32; 3],
    values: Vec<f32>,
}

impl Dense {
    /// Index of a voxel of the box, x fastest.
    fn index(&self, voxel: IVec3) -> usize {
        let at = (voxel.as_i64vec3() - self.min).as_usizevec3();
        at.x + self.size[0] as usize * (at.y + self.size[1] as usize * at.z)
    }

    fn fill(&mut self, tile: &Tile) {
        for (y, z) in (0..tile.side).flat_map(|z| (0..tile.side).map(move |y| (y, z))) {
            let first = self.index(tile.origin + IVec3::new(0, y, z));
            self.values[first..first + tile.side as usize].fill(tile.value);
        }
    }

    fn copy(&mut self, leaf: &Leaf) {
        for index in leaf.active.ones() {
            let at = self.index(leaf.origin + entry(index, 3));
            self.values[at] = leaf.values[index];
        }
    }
}
