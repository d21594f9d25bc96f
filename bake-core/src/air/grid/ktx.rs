//! KTX2 3-D textures of one channel, uncompressed or under Zstandard; the largest mip level is read.
//!
//! Own code for the three fields that matter: the crate ktx2 0.5.0 panics on damaged files.
//! *Source*: KTX File Format Specification 2.0, sections 3 and 4; Vulkan's numbers of formats.

use super::{GridFault, Lattice, checked_points, numbers};
use crate::settings::Values;

const FORMAT: &str = "KTX2";

/// Reads a texture.
pub fn read(bytes: &[u8]) -> Result<Lattice, GridFault> {
    let [format, _, width, height, depth, layers, faces, _, scheme] = std::array::from_fn(|i| word(bytes, 12 + 4 * i));
    let values = match format? {
        9 => Values::U8,
        70 => Values::U16,
        76 => Values::F16,
        100 => Values::F32,
        other => {
            let what = format!("texels of Vulkan's format {other}");
            return Err(unsupported(what, "write R8_UNORM, R16_UNORM, R16_SFLOAT or R32_SFLOAT"));
        }
    };
    let size = [width?, height?, depth?];
    if size.contains(&0) || layers? > 1 || faces? != 1 {
        return Err(unsupported("no single 3-D texture".into(), "write one 3-D texture"));
    }
    let points = checked_points(size, bytes.len())?;
    let data = first_level(bytes)?;
    match scheme? {
        0 => numbers::read(data, size, values),
        2 => {
            let data = zstd::bulk::decompress(data, 4 * points).map_err(|error| GridFault::damaged(FORMAT, error))?;
            numbers::read(&data, size, values)
        }
        other => Err(unsupported(format!("data under supercompression {other}"), "write it plain or under Zstandard")),
    }
}

/// The bytes of the largest level, whose place stands first behind the header of 80 bytes.
fn first_level(bytes: &[u8]) -> Result<&[u8], GridFault> {
    let long = |at: usize| Ok::<_, GridFault>(u64::from(word(bytes, at)?) | u64::from(word(bytes, at + 4)?) << 32);
    let (start, length) = (long(80)?, long(88)?);
    let end = start.checked_add(length).filter(|&end| end <= bytes.len() as u64).ok_or_else(short)?;
    Ok(&bytes[start as usize..end as usize])
}

fn word(bytes: &[u8], at: usize) -> Result<u32, GridFault> {
    let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
    four.map(u32::from_le_bytes).ok_or_else(short)
}

fn short() -> GridFault {
    GridFault::damaged(FORMAT, "it ends within its data")
}

fn unsupported(what: String, way_out: &'static str) -> GridFault {
    GridFault::Unsupported { what, way_out }
}
