//! What an OpenVDB file says about itself and its grids before their voxels.

use super::FORMAT;
use super::bytes::Bytes;
use crate::air::grid::GridFault;
use glam::{DAffine3, DMat3, DVec3};

/// The first version that states compression per grid and masks per node.
const OLDEST: u32 = 222;

/// A grid of the file.
#[derive(Debug, Clone)]
pub struct Descriptor {
    /// Name.
    pub name: String,
    kind: String,
    parent: String,
    class: String,
    /// Whether voxels are 16-bit floats.
    pub half: bool,
    /// Where the grid's head begins.
    head: u64,
    /// Where its leaves' voxels begin.
    leaves: u64,
}

/// The head of a grid.
#[derive(Debug, Clone, Copy)]
pub struct Head<'a> {
    /// From voxel indices, whole at the middles of voxels, to the world.
    pub world_from_index: DAffine3,
    /// Flags.
    pub compression: u32,
    /// Where the tree begins.
    pub tree: Bytes<'a>,
    /// Where the leaves' voxels begin.
    pub leaves: Bytes<'a>,
}

/// The grids of a file.
pub fn read(bytes: &mut Bytes) -> Result<Vec<Descriptor>, GridFault> {
    bytes.take(8)?;
    let version = bytes.u32()?;
    if version < OLDEST {
        let what = format!("file version {version}, of OpenVDB 1 (before 2013)");
        return Err(unsupported(what, "open and save it with a newer program"));
    }
    // Version of the library.
    bytes.take(8)?;
    if bytes.u8()? == 0 {
        return Err(unsupported("a stream without offsets".into(), "save it as a file"));
    }
    // UUID.
    bytes.take(36)?;
    metadata(bytes)?;
    let count = bytes.u32()?;
    let mut grids = Vec::new();
    for _ in 0..count {
        let (grid, end) = descriptor(bytes)?;
        // Backwards, the same grid would be met for ever.
        if end < bytes.position() {
            return Err(GridFault::damaged(FORMAT, format!("the grid `{}` ends before it begins", grid.name)));
        }
        *bytes = bytes.at(end)?;
        grids.push(grid);
    }
    Ok(grids)
}

/// A grid, and where what belongs to it ends.
fn descriptor(bytes: &mut Bytes) -> Result<(Descriptor, u64), GridFault> {
    let (unique, full_kind, parent) = (bytes.text()?, bytes.text()?, bytes.text()?);
    // Grids of the same name are told apart by a number behind a separator.
    let name = unique.split('\u{1e}').next().unwrap_or_default().to_owned();
    let (head, leaves, end) = (bytes.u64()?, bytes.u64()?, bytes.u64()?);
    let kind = full_kind.trim_end_matches("_HalfFloat").to_owned();
    let mut at_head = bytes.at(head)?;
    at_head.u32()?;
    let mut grid = Descriptor { name, half: kind != full_kind, kind, parent, class: String::new(), head, leaves };
    for (key, value) in metadata(&mut at_head)? {
        match key.as_str() {
            "class" => grid.class = String::from_utf8_lossy(value).into_owned(),
            "is_saved_as_half_float" => grid.half |= value.first().is_some_and(|&byte| byte != 0),
            _ => {}
        }
    }
    Ok((grid, end))
}

/// Keys and the bytes of their values.
fn metadata<'a>(bytes: &mut Bytes<'a>) -> Result<Vec<(String, &'a [u8])>, GridFault> {
    let count = bytes.u32()?;
    let mut entries = Vec::new();
    for _ in 0..count {
        let (key, _kind) = (bytes.text()?, bytes.text()?);
        let size = bytes.u32()?;
        entries.push((key, bytes.take(size as usize)?));
    }
    Ok(entries)
}

impl Descriptor {
    /// Name and kind, for lists.
    pub fn describe(&self) -> String {
        let class = if self.class.is_empty() || self.class == "unknown" { self.kind.as_str() } else { &self.class };
        format!("{} ({class})", self.name)
    }

    /// Refuses what is no scalar fog.
    pub fn check_kind(&self) -> Result<(), GridFault> {
        if self.class == "level set" {
            return Err(GridFault::LevelSet { name: self.name.clone() });
        }
        if self.kind != "Tree_float_5_4_3" {
            let what = format!("the grid `{}` of type {}", self.name, self.kind);
            return Err(unsupported(what, "density is a float grid of the usual 5-4-3 layout: choose or save one"));
        }
        if !self.parent.is_empty() {
            let what = format!("the grid `{}` as an instance of `{}`", self.name, self.parent);
            return Err(unsupported(what, "choose that one, or save the grid with voxels of its own"));
        }
        Ok(())
    }

    /// What stands before the grid's voxels.
    pub fn head<'a>(&self, file: &Bytes<'a>) -> Result<Head<'a>, GridFault> {
        let mut bytes = file.at(self.head)?;
        let compression = bytes.u32()?;
        metadata(&mut bytes)?;
        let world_from_index = transform(&mut bytes)?;
        if !world_from_index.is_finite() || world_from_index.matrix3.determinant() == 0.0 {
            return Err(GridFault::damaged(FORMAT, format!("the transform of `{}` has no inverse", self.name)));
        }
        Ok(Head { world_from_index, compression, tree: bytes, leaves: file.at(self.leaves)? })
    }
}

/// Affine maps; the rest of each record repeats scales in other forms.
fn transform(bytes: &mut Bytes) -> Result<DAffine3, GridFault> {
    let kind = bytes.text()?;
    Ok(match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let scale = vector(bytes)?;
            bytes.take(4 * 24)?;
            DAffine3::from_scale(scale)
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let (translation, scale) = (vector(bytes)?, vector(bytes)?);
            bytes.take(4 * 24)?;
            DAffine3 { matrix3: DMat3::from_diagonal(scale), translation }
        }
        "TranslationMap" => DAffine3::from_translation(vector(bytes)?),
        "AffineMap" | "UnitaryMap" => affine(bytes)?,
        other => {
            let what = format!("a grid under a {other}");
            return Err(unsupported(what, "resample it onto a straight grid"));
        }
    })
}

/// Rows of a matrix that row vectors are multiplied by: the columns of ours.
fn affine(bytes: &mut Bytes) -> Result<DAffine3, GridFault> {
    let mut row = || -> Result<DVec3, GridFault> {
        let row = vector(bytes)?;
        bytes.f64()?;
        Ok(row)
    };
    Ok(DAffine3 { matrix3: DMat3::from_cols(row()?, row()?, row()?), translation: row()? })
}

fn vector(bytes: &mut Bytes) -> Result<DVec3, GridFault> {
    Ok(DVec3::new(bytes.f64()?, bytes.f64()?, bytes.f64()?))
}

fn unsupported(what: String, way_out: &'static str) -> GridFault {
    GridFault::Unsupported { what, way_out }
}
