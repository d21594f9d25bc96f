//! Density grids from files: told apart by their first bytes, read, checked, and placed in the world.
//!
//! Whatever the format, value (i, j, k) lies at growing x, y, z; with `z_up` at growing x, −z, y. Sizes are checked before
//! anything is allocated.

mod exr;
mod fault;
mod ktx;
mod numbers;
mod vdb;

pub use fault::GridFault;

use crate::settings::{Place, Values};
use bake_optics::medium::Bounds;
use bake_optics::medium::grid::{DensityGrid, GridError};
use glam::{DAffine3, DMat3, DVec3, IVec3};

/// Most points along an axis, and in all: 1 GiB.
const MOST_ALONG: u32 = 1 << 20;
const MOST_POINTS: u64 = 1 << 28;
/// Densities this share of the largest below zero are rounding of the program that wrote them.
const ROUNDING: f32 = 1e-3;

/// What the settings say about a grid.
#[derive(Debug, Clone, Copy)]
pub struct Choice<'a> {
    /// Grid or channel.
    pub name: Option<&'a str>,
    /// Points along x, y, z.
    pub size: Option<[u32; 3]>,
    /// Type of bare numbers.
    pub values: Values,
    /// Where it lies.
    pub place: Place,
    /// Whether its third axis points up.
    pub z_up: bool,
}

/// What a file holds.
#[derive(Debug)]
pub struct Lattice {
    /// Points along x, y, z.
    pub size: [u32; 3],
    /// Values, x fastest.
    pub values: Vec<f32>,
    /// Where the file says that it lies.
    pub world_from_grid: Option<DAffine3>,
}

/// Reads a grid from a file's bytes and places it.
pub fn read(bytes: &[u8], choice: Choice, bounds: &Bounds) -> Result<(DensityGrid, Option<Negatives>), GridFault> {
    let mut lattice = decode(bytes, choice)?;
    let negatives = clear_rounding(&mut lattice.values)?;
    let grid = place(lattice, choice, bounds)?;
    Ok((grid, negatives))
}

fn decode(bytes: &[u8], choice: Choice) -> Result<Lattice, GridFault> {
    match bytes {
        [0x20, b'B', b'D', b'V', 0, 0, 0, 0, ..] => vdb::read(bytes, choice.name),
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, ..] => ktx::read(bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::read(bytes, choice),
        _ => numbers::read(bytes, choice.size.ok_or(GridFault::Unknown)?, choice.values),
    }
}

/// Number of points, if a file of `bytes` may have so many: grids pack to a thousandth at most.
fn checked_points(size: [u32; 3], bytes: usize) -> Result<usize, GridFault> {
    let points = size.iter().fold(1u64, |product, &side| product.saturating_mul(u64::from(side)));
    let allowed = MOST_POINTS.min((16 << 20) + 275 * bytes as u64);
    if points == 0 || size.iter().any(|&side| side > MOST_ALONG) || points > allowed {
        return Err(GridFault::TooLarge { points, allowed });
    }
    Ok(points as usize)
}

/// Values below zero that were set to zero.
#[derive(Debug, Clone, Copy)]
pub struct Negatives {
    /// How many.
    pub count: usize,
    /// The lowest.
    pub lowest: f32,
}

/// Sets values just below zero to zero, and refuses what is no density.
fn clear_rounding(values: &mut [f32]) -> Result<Option<Negatives>, GridFault> {
    let (mut found, mut largest) = (Negatives { count: 0, lowest: 0.0 }, 0.0f32);
    for (index, value) in values.iter_mut().enumerate() {
        if !value.is_finite() {
            return Err(GridError::Value { index, value: *value }.into());
        }
        if *value < 0.0 {
            found = Negatives { count: found.count + 1, lowest: found.lowest.min(*value) };
            *value = 0.0;
        }
        largest = largest.max(*value);
    }
    if found.lowest < -ROUNDING * largest {
        return Err(GridFault::Negative { lowest: found.lowest });
    }
    Ok((found.count > 0).then_some(found))
}

fn place(lattice: Lattice, choice: Choice, bounds: &Bounds) -> Result<DensityGrid, GridFault> {
    let turned = if choice.z_up {
        DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y))
    } else {
        DAffine3::IDENTITY
    };
    match (choice.place, lattice.world_from_grid) {
        (Place::File, None) => Err(GridFault::Place("does not say where it lies; leave `place: File` out")),
        (Place::File | Place::Auto, Some(world_from_grid)) => {
            let size = IVec3::from(lattice.size.map(|side| side as i32));
            Ok(DensityGrid::new(size, lattice.values, turned * world_from_grid)?)
        }
        (Place::Fill, _) | (Place::Auto, None) => fill(lattice, turned, bounds),
    }
}

/// Stretches a lattice over the box of the bounds: values lie in the middles of equal parts, as texels do, and the outermost
/// hold up to the faces.
fn fill(lattice: Lattice, turned: DAffine3, bounds: &Bounds) -> Result<DensityGrid, GridFault> {
    let [min, max] = bounds.bounding_box();
    if !(min.is_finite() && max.is_finite()) {
        return Err(GridFault::Place(
            "has to fill the medium's bounds, which have no end; give it Box, Sphere or Node",
        ));
    }
    let size = DVec3::from(lattice.size.map(f64::from));
    let (padded, values) = repeat_border(lattice)?;
    // Padding puts the first value at 1; the grid's box reaches from half a part before it to half a part behind the last.
    let unit_from_grid = DAffine3::from_scale(size.recip()) * DAffine3::from_translation(DVec3::splat(-0.5));
    let middle = DAffine3::from_translation(DVec3::splat(0.5));
    let world_from_unit = DAffine3::from_translation(min) * DAffine3::from_scale(max - min);
    let world_from_grid = world_from_unit * middle * turned * middle.inverse() * unit_from_grid;
    Ok(DensityGrid::new(padded, values, world_from_grid)?)
}

/// The lattice with one more layer on every side, equal to the outermost.
fn repeat_border(lattice: Lattice) -> Result<(IVec3, Vec<f32>), GridFault> {
    let size = lattice.size.map(|side| side as usize);
    let padded = size.map(|side| side + 2);
    let points = padded.iter().map(|&side| side as u64).product();
    if points > 2 * MOST_POINTS {
        return Err(GridFault::TooLarge { points, allowed: MOST_POINTS });
    }
    let inner = |i: usize, axis: usize| i.saturating_sub(1).min(size[axis] - 1);
    let mut values = Vec::with_capacity(points as usize);
    for k in (0..padded[2]).map(|k| inner(k, 2)) {
        for j in (0..padded[1]).map(|j| inner(j, 1)) {
            let row = &lattice.values[size[0] * (j + size[1] * k)..][..size[0]];
            values.push(row[0]);
            values.extend_from_slice(row);
            values.push(row[size[0] - 1]);
        }
    }
    Ok((IVec3::from(padded.map(|side| side as i32)), values))
}

#[cfg(test)]
mod tests;
