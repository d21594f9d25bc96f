//! Bare numbers, x fastest, then y, then z, little-endian: the raw slice stack, and the texels of other formats.

use super::{GridFault, Lattice, checked_points};
use crate::settings::Values;
use half::f16;

impl Values {
    fn bytes(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F16 | Self::U16 => 2,
            Self::U8 => 1,
        }
    }

    /// The numbers in `bytes`.
    pub fn decode(self, bytes: &[u8]) -> Vec<f32> {
        let pairs = || bytes.as_chunks::<2>().0.iter();
        match self {
            Self::F32 => bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
            Self::F16 => pairs().map(|b| f16::from_le_bytes(*b).to_f32()).collect(),
            Self::U16 => pairs().map(|b| f32::from(u16::from_le_bytes(*b)) / 65535.0).collect(),
            Self::U8 => bytes.iter().map(|&b| f32::from(b) / 255.0).collect(),
        }
    }
}

/// A lattice of `size` whose numbers are exactly `bytes`.
pub fn read(bytes: &[u8], size: [u32; 3], values: Values) -> Result<Lattice, GridFault> {
    let expected = checked_points(size, bytes.len())? * values.bytes();
    if bytes.len() != expected {
        return Err(GridFault::Size { found: bytes.len() as u64, unit: "bytes", expected: expected as u64 });
    }
    Ok(Lattice { size, values: values.decode(bytes), world_from_grid: None })
}
