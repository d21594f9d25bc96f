//! What keeping paths takes: what plan and package know of it without solving any air.

use super::{REPLICATES, TEXELS_PER_TASK};

/// End of the file's name in a package.
pub const FILE_SUFFIX: &str = "paths.zst";

/// Chunks that are in memory together.
pub(super) const CHUNKS: usize = 64;
/// Most samples of a sequence that a chunk speaks for.
pub(super) const MOST_SAMPLES: u32 = 256;
/// Of so many paths one is kept in a scene that looks escape from, and in a closed one: the air's end and its layers make paths
/// of open scenes less alike.
pub(super) const THINNING: [u32; 2] = [4, 16];

/// Bytes of a path on disk, about: measured 360 in a room of grey walls and 540 in a coloured one.
const BYTES_PER_PATH: u64 = 450;
/// Bytes of what is known of all paths of a texel: means of three channels for each sequence, air and term, of the few and of all.
const BYTES_PER_TEXEL: u64 = 12 * (2 * REPLICATES * 3 * 4) as u64;

/// Most bytes of paths that a bake is let write.
pub const MOST_BYTES: u64 = 256_000_000_000;
/// Bytes of paths in memory at most.
pub const MEMORY_BYTES: u64 = (CHUNKS * TEXELS_PER_TASK) as u64
    * ((MOST_SAMPLES / THINNING[0]) as u64 * REPLICATES as u64 * BYTES_PER_PATH + BYTES_PER_TEXEL);

/// Share of escaping rays from which folding has the noise of the open. Between a box with one side open, where it was that of
/// a bake, and a courtyard.
const OPEN: f64 = 0.4;

/// Standard error of folded pages over that of a bake by tables, at most, as the tests of kept paths hold it; measured: 0.6 to 0.7
/// in rooms, in a courtyard 1.8, and 3.0 where paths were kept without air.
pub fn noise(has_air: bool, escaping: f64) -> f64 {
    match (escaping >= OPEN, has_air) {
        (false, _) => 1.0,
        (true, true) => 2.0,
        (true, false) => 4.0,
    }
}

/// Bytes on disk of so many samples for each of so many texels, about. Each sequence keeps one path at least.
pub fn bytes(samples: u32, texels: usize, escaping: f64) -> u64 {
    let thinning = THINNING[usize::from(escaping == 0.0)];
    let paths = samples.div_ceil(REPLICATES as u32).div_ceil(thinning) * REPLICATES as u32;
    (u64::from(paths) * BYTES_PER_PATH + BYTES_PER_TEXEL) * texels as u64
}
