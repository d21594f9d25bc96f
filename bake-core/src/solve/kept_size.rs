//! What keeping paths takes: what plan and package know of it without solving any air.

use super::{REPLICATES, TEXELS_PER_TASK};

/// End of the file's name in a package.
pub const FILE_SUFFIX: &str = "paths.zst";

/// Chunks that are in memory together.
pub(super) const CHUNKS: usize = 64;
/// Most samples of a sequence in one chunk.
pub(super) const MOST_SAMPLES: u32 = 32;

/// Bytes of a path on disk, about: measured 360 in a room of grey walls and 540 in a coloured one.
const BYTES_PER_PATH: u64 = 450;

/// Most bytes of paths that a bake is let write.
pub const MOST_BYTES: u64 = 256_000_000_000;
/// Bytes of paths in memory at most.
pub const MEMORY_BYTES: u64 = (CHUNKS * TEXELS_PER_TASK * MOST_SAMPLES as usize * REPLICATES) as u64 * BYTES_PER_PATH;

/// Bytes on disk of so many samples for each of so many texels, about.
pub fn bytes(samples: u64, texels: usize) -> u64 {
    samples * texels as u64 * BYTES_PER_PATH
}
