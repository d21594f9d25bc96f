//! Values of a node: which are stored, and how they are packed (zlib, or Blosc 1 with LZ4).

use super::FORMAT;
use super::bytes::Bytes;
use crate::air::grid::GridFault;
use half::f16;
use std::io::Read;

/// Flags of a grid's compression.
const ZIP: u32 = 1;
const ACTIVE_MASK: u32 = 2;
const BLOSC: u32 = 4;

/// What all nodes of a grid share.
#[derive(Debug, Clone, Copy)]
pub struct Stream {
    /// Flags.
    pub compression: u32,
    /// 16-bit floats.
    pub half: bool,
    /// Value of what is not stored.
    pub background: f32,
}

/// One bit an entry.
#[derive(Debug, Default)]
pub struct Mask(Vec<u64>);

impl Mask {
    /// The mask of a node of 2^`log2` entries a side.
    pub fn read(bytes: &mut Bytes, log2: u32) -> Result<Self, GridFault> {
        let words = bytes.take((1 << (3 * log2)) / 8)?.as_chunks::<8>().0;
        Ok(Self(words.iter().map(|word| u64::from_le_bytes(*word)).collect()))
    }

    /// Entries in all.
    fn len(&self) -> usize {
        64 * self.0.len()
    }

    /// Whether an entry's bit is set.
    pub fn is_on(&self, index: usize) -> bool {
        self.0[index / 64] >> (index % 64) & 1 == 1
    }

    /// Entries whose bit is set, ascending.
    pub fn ones(&self) -> impl Iterator<Item = usize> {
        let ones_of = |(word, &bits): (usize, &u64)| {
            let next = |&bits: &u64| Some(bits & bits.wrapping_sub(1));
            let rests = std::iter::successors(Some(bits), next).take_while(|&bits| bits != 0);
            rests.map(move |bits| 64 * word + bits.trailing_zeros() as usize)
        };
        self.0.iter().enumerate().flat_map(ones_of)
    }

    fn log2(&self) -> u32 {
        self.len().ilog2() / 3
    }
}

impl Stream {
    /// All values of a node whose active entries are `active` (io/Compression.h, `readCompressedValues`).
    pub fn values(&self, bytes: &mut Bytes, active: &Mask) -> Result<Vec<f32>, GridFault> {
        let form = bytes.u8()?;
        if form > 6 {
            return Err(GridFault::damaged(FORMAT, format!("a node of form {form}")));
        }
        let first = if form == 0 { self.background } else { -self.background };
        let first = if [2, 4, 5].contains(&form) { bytes.f32()? } else { first };
        let second = if form == 5 { bytes.f32()? } else { self.background };
        let selected = if [3, 4, 5].contains(&form) { Some(Mask::read(bytes, active.log2())?) } else { None };
        let packed = self.compression & ACTIVE_MASK != 0 && form != 6;
        let count = if packed { active.ones().count() } else { active.len() };
        let stored = self.numbers(bytes, count)?;
        if !packed {
            return Ok(stored);
        }
        let mut stored = stored.into_iter();
        let inactive =
            |index: usize| if selected.as_ref().is_some_and(|mask| mask.is_on(index)) { second } else { first };
        let value = |index: usize| match active.is_on(index) {
            true => stored.next().expect("one an active entry"),
            false => inactive(index),
        };
        Ok((0..active.len()).map(value).collect())
    }

    fn numbers(&self, bytes: &mut Bytes, count: usize) -> Result<Vec<f32>, GridFault> {
        // Nothing is written for no 16-bit numbers; for no 32-bit ones an empty chunk is.
        if self.half && count == 0 {
            return Ok(Vec::new());
        }
        let data = self.unpack(bytes, count * if self.half { 2 } else { 4 })?;
        Ok(match self.half {
            true => data.as_chunks::<2>().0.iter().map(|b| f16::from_le_bytes(*b).to_f32()).collect(),
            false => data.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
        })
    }

    /// The next `size` bytes of data.
    fn unpack(&self, bytes: &mut Bytes, size: usize) -> Result<Vec<u8>, GridFault> {
        if self.compression & (ZIP | BLOSC) == 0 {
            return Ok(bytes.take(size)?.to_vec());
        }
        let length = bytes.i64()?;
        let chunk = bytes.take(usize::try_from(length.unsigned_abs()).unwrap_or(usize::MAX))?;
        let data = match (length > 0, self.compression & BLOSC != 0) {
            (false, _) => chunk.to_vec(),
            (true, _) if size == 0 => Vec::new(),
            (true, true) => {
                blosc(chunk, size).ok_or_else(|| GridFault::damaged(FORMAT, "a Blosc chunk does not decode"))?
            }
            (true, false) => inflate(chunk, size).map_err(|error| GridFault::damaged(FORMAT, error))?,
        };
        match data.len() == size {
            true => Ok(data),
            false => Err(GridFault::damaged(FORMAT, format!("{} bytes of voxels instead of {size}", data.len()))),
        }
    }
}

fn inflate(chunk: &[u8], size: usize) -> std::io::Result<Vec<u8>> {
    let mut data = Vec::with_capacity(size);
    flate2::read::ZlibDecoder::new(chunk).take(size as u64).read_to_end(&mut data)?;
    Ok(data)
}

/// A chunk of Blosc 1 under LZ4, with or without byte shuffling (what OpenVDB writes); `None` for all else.
///
/// *Source*: c-blosc 1, README_HEADER.rst and `blosc_d`.
fn blosc(chunk: &[u8], size: usize) -> Option<Vec<u8>> {
    /// Streams of a block at most, and bytes a stream at least, for which blocks are split.
    const MOST_SPLITS: usize = 16;
    const LEAST_STREAM: usize = 128;
    let number = |at: usize| Some(u32::from_le_bytes(chunk.get(at..at + 4)?.try_into().ok()?) as usize);
    let (flags, type_size) = (*chunk.get(2)?, usize::from(*chunk.get(3)?));
    let (total, block) = (number(4)?, number(8)?);
    let (shuffled, copied, bit_shuffled, whole, codec) = (flags & 1, flags & 2, flags & 4, flags & 16, flags >> 5);
    if total != size || block == 0 || type_size == 0 || bit_shuffled != 0 {
        return None;
    }
    if copied != 0 {
        return Some(chunk.get(16..16 + size)?.to_vec());
    }
    if codec != 1 {
        return None;
    }
    let mut data = vec![0; size];
    let mut scratch = Vec::new();
    for (index, out) in data.chunks_mut(block).enumerate() {
        let mut at = number(16 + 4 * index)?;
        let split = whole == 0 && type_size <= MOST_SPLITS && block / type_size >= LEAST_STREAM && out.len() == block;
        scratch.resize(out.len(), 0);
        for stream in scratch.chunks_mut(out.len().div_ceil(if split { type_size } else { 1 })) {
            let length = number(at)?;
            let packed = chunk.get(at + 4..(at + 4).checked_add(length)?)?;
            if length == stream.len() {
                stream.copy_from_slice(packed);
            } else if lz4_flex::block::decompress_into(packed, stream).ok()? != stream.len() {
                return None;
            }
            at += 4 + length;
        }
        match shuffled != 0 && type_size > 1 {
            true => unshuffle(&scratch, out, type_size),
            false => out.copy_from_slice(&scratch),
        }
    }
    Some(data)
}

/// Byte b of all elements lies together; what is left of an element stays at the end.
fn unshuffle(shuffled: &[u8], out: &mut [u8], type_size: usize) {
    let elements = shuffled.len() / type_size;
    for (element, bytes) in out.chunks_exact_mut(type_size).enumerate() {
        bytes.iter_mut().enumerate().for_each(|(byte, slot)| *slot = shuffled[byte * elements + element]);
    }
    let tail = elements * type_size;
    out[tail..].copy_from_slice(&shuffled[tail..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn numbers() -> Vec<f32> {
        (0..512).map(|i| i as f32 * 0.25).collect()
    }

    fn plain(values: &[f32]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    /// A leaf of form 6 (all values stored) whose data are `chunk`.
    fn leaf(compression: u32, chunk: &[u8]) -> Result<Vec<f32>, GridFault> {
        let mut file = vec![6];
        if compression & (ZIP | BLOSC) != 0 {
            file.extend((chunk.len() as i64).to_le_bytes());
        }
        file.extend(chunk);
        let stream = Stream { compression, half: false, background: 0.0 };
        stream.values(&mut Bytes::new(&file), &Mask(vec![u64::MAX; 8]))
    }

    fn zlib(data: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(data).expect("memory takes bytes");
        encoder.finish().expect("memory takes bytes")
    }

    /// A Blosc chunk of one block, cut into `streams` streams that are stored as they are.
    fn blosc_chunk(flags: u8, data: &[u8], streams: usize) -> Vec<u8> {
        let mut chunk = vec![2, 1, flags, 4];
        for word in [data.len() as u32, data.len() as u32, 0, 20] {
            chunk.extend(word.to_le_bytes());
        }
        for stream in data.chunks(data.len() / streams) {
            chunk.extend((stream.len() as u32).to_le_bytes());
            chunk.extend(stream);
        }
        chunk
    }

    #[test]
    fn every_packing_holds_the_same_numbers() {
        let (values, data) = (numbers(), plain(&numbers()));
        let shuffled: Vec<u8> = (0..4).flat_map(|byte| data.iter().skip(byte).step_by(4).copied()).collect();
        let copied = [&blosc_chunk(0b10, &data, 1)[..16], &data].concat();
        let cases = [
            ("plain", 0, data.clone()),
            ("zlib", ZIP, zlib(&data)),
            ("Blosc, one stream", BLOSC, blosc_chunk(0b0011_0000, &data, 1)),
            ("Blosc, shuffled", BLOSC, blosc_chunk(0b0011_0001, &shuffled, 1)),
            ("Blosc, shuffled and split", BLOSC, blosc_chunk(0b0010_0001, &shuffled, 4)),
            ("Blosc, copied", BLOSC, copied),
        ];
        for (what, compression, chunk) in cases {
            assert_eq!(leaf(compression, &chunk).unwrap_or_else(|error| panic!("{what} {error}")), values, "{what}");
        }
    }

    #[test]
    fn chunks_of_another_length_or_codec_are_refused() {
        let data = plain(&numbers());
        let wrong = [
            (ZIP, zlib(&data[4..])),
            (ZIP, data.clone()),
            (BLOSC, blosc_chunk(0b0011_0000, &data[4..], 1)),
            (BLOSC, blosc_chunk(0b0001_0000, &data, 1)),
            (BLOSC, blosc_chunk(0b0011_0100, &data, 1)),
            (BLOSC, vec![2, 1]),
        ];
        for (compression, chunk) in wrong {
            assert!(
                matches!(leaf(compression, &chunk), Err(GridFault::Damaged { .. })),
                "{compression} {:?}",
                &chunk[..2]
            );
        }
    }

    /// Where only active values are stored, the others are one of two values, chosen by a second mask.
    #[test]
    fn inactive_values_are_those_of_the_form() {
        let mut active = Mask(vec![0; 8]);
        active.0[1] = 1 << 5;
        let selected: Vec<u8> = (0..64).map(|byte| if byte == 0 { 1 } else { 0 }).collect();
        let stream = Stream { compression: ACTIVE_MASK, half: false, background: 0.5 };
        let read = |form: u8, rest: &[u8]| {
            let file = [&[form], rest, &7f32.to_le_bytes()].concat();
            let values = stream.values(&mut Bytes::new(&file), &active).expect("valid");
            assert_eq!(values[69], 7.0);
            (values[0], values[1])
        };
        let (two, three) = (2f32.to_le_bytes(), 3f32.to_le_bytes());
        assert_eq!(read(0, &[]), (0.5, 0.5));
        assert_eq!(read(1, &[]), (-0.5, -0.5));
        assert_eq!(read(2, &two), (2.0, 2.0));
        assert_eq!(read(3, &selected), (0.5, -0.5));
        assert_eq!(read(4, &[&two[..], &selected].concat()), (0.5, 2.0));
        assert_eq!(read(5, &[&two[..], &three, &selected].concat()), (3.0, 2.0));
    }
}
