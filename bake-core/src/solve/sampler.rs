//! Random numbers of a path: an Owen-scrambled Sobol sequence, seeded per texel and replicate.
//!
//! Dimensions come in sets of four: each vertex of a path takes a fixed number of sets, so that sample i of a texel
//! asks the same question of every dimension whatever happened before it. Source of the sequence: Burley 2020,
//! "Practical Hash-based Owen Scrambling" (crate `sobol_burley`).

/// Sets that the sequence holds before seeds are changed.
const SETS: u32 = 64;

/// Most samples of one sequence.
pub const MAX_SAMPLES: u32 = 1 << 16;

/// One sample of one sequence.
#[derive(Debug, Clone, Copy)]
pub struct Sampler {
    sample: u32,
    seed: u32,
    set: u32,
}

impl Sampler {
    /// Sample number `sample` (below [`MAX_SAMPLES`]) of the sequence `seed`.
    pub fn new(sample: u32, seed: u32) -> Self {
        debug_assert!(sample < MAX_SAMPLES);
        Self { sample, seed, set: 0 }
    }

    /// The next four numbers in [0, 1).
    #[inline]
    pub fn next4(&mut self) -> [f32; 4] {
        let seed = if self.set < SETS { self.seed } else { hash(self.seed, self.set / SETS) };
        let numbers = sobol_burley::sample_4d(self.sample, self.set % SETS, seed);
        self.set += 1;
        numbers
    }
}

impl Sampler {
    /// The same sample of an independent sequence.
    pub fn fork(&self) -> Self {
        Self { seed: hash(self.seed, 0x61_6972), set: 0, ..*self }
    }
}

/// Mixes two words into one (two rounds of the finaliser of MurmurHash3).
pub fn hash(a: u32, b: u32) -> u32 {
    let mix = |mut h: u32| {
        h ^= h >> 16;
        h = h.wrapping_mul(0x85eb_ca6b);
        h ^= h >> 13;
        h = h.wrapping_mul(0xc2b2_ae35);
        h ^ (h >> 16)
    };
    mix(mix(a.wrapping_add(0x9e37_79b9)) ^ b.wrapping_mul(0x85eb_ca77))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_is_stratified_and_seeds_differ() {
        let first = |seed: u32| (0..64).map(|i| Sampler::new(i, seed).next4()).collect::<Vec<_>>();
        let numbers = first(7);
        for dimension in 0..4 {
            let mut strata: Vec<u32> = numbers.iter().map(|n| (n[dimension] * 64.0) as u32).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..64).collect::<Vec<_>>());
        }
        assert_ne!(numbers, first(8));
    }

    #[test]
    fn dimensions_past_the_sequence_are_fresh() {
        let mut sampler = Sampler::new(3, 1);
        let drawn: Vec<[f32; 4]> = (0..2 * SETS).map(|_| sampler.next4()).collect();
        assert_ne!(drawn[0], drawn[SETS as usize]);
    }
}
