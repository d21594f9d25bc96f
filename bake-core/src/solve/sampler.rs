//! Random numbers of a path: an Owen-scrambled Sobol sequence, seeded per texel and replicate.
//!
//! Dimensions come in sets of four: each vertex of a path takes a fixed number of sets, so that sample i of a texel
//! asks the same question of every dimension whatever happened before it. Source of the sequence: Burley 2020,
//! "Practical Hash-based Owen Scrambling" (crate `sobol_burley`).

use sobol_burley::parts;
use std::sync::LazyLock;

/// Sets that the sequence holds before seeds are changed.
const SETS: u32 = 64;
/// Bits of an index that the sequence reads, four at a time.
const NIBBLES: usize = 4;

/// Most samples of one sequence.
pub const MAX_SAMPLES: u32 = 1 << 16;

/// Four dimensions of the sequence for each nibble of the index, by set: the sequence is linear over bits, so that four
/// entries stand for up to sixteen direction numbers.
static PARTS: LazyLock<Vec<[[[u32; 4]; 16]; NIBBLES]>> = LazyLock::new(|| {
    let of = |set: u32, nibble: usize, value: usize| {
        let index = (value as u32) << (28 - 4 * nibble);
        std::array::from_fn(|i| parts::sobol_rev(index, 4 * set + i as u32))
    };
    let of_set = |set| std::array::from_fn(|nibble| std::array::from_fn(|value| of(set, nibble, value)));
    (0..SETS).map(of_set).collect()
});

/// One sample of one sequence.
#[derive(Debug, Clone, Copy)]
pub struct Sampler {
    sample: u32,
    seed: u32,
    set: u32,
    /// The sample's place in the sequence as the seed shuffles it, bits reversed.
    shuffled: u32,
}

impl Sampler {
    /// Sample number `sample` (below [`MAX_SAMPLES`]) of the sequence `seed`.
    pub fn new(sample: u32, seed: u32) -> Self {
        debug_assert!(sample < MAX_SAMPLES);
        let shuffled = parts::owen_scramble_rev(sample.reverse_bits(), parts::hash(seed ^ 0x79c6_8e4a));
        Self { sample, seed, set: 0, shuffled }
    }

    /// The next four numbers in [0, 1).
    #[inline]
    pub fn next4(&mut self) -> [f32; 4] {
        let set = self.set;
        self.set += 1;
        if set < SETS {
            return self.of_set(set);
        }
        Self::new(self.sample, hash(self.seed, set / SETS)).of_set(set % SETS)
    }

    /// Passes four numbers over, so that those after them stay what they are.
    pub fn skip(&mut self) {
        self.set += 1;
    }

    /// The same sample of an independent sequence.
    pub fn fork(&self) -> Self {
        Self::new(self.sample, hash(self.seed, 0x61_6972))
    }

    /// What `sobol_burley::sample_4d` gives, with the shuffled index and the sums of direction numbers at hand.
    #[inline]
    fn of_set(&self, set: u32) -> [f32; 4] {
        let table = &PARTS[set as usize];
        let part = |nibble: usize| parts::Int4::from(table[nibble][(self.shuffled >> (28 - 4 * nibble)) as usize & 15]);
        let sobol = part(0) ^ part(1) ^ part(2) ^ part(3);
        let seed = self.seed.wrapping_mul(0x9c8f_2d3b) ^ set;
        let scramble = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].map(|word: u32| word ^ seed);
        parts::owen_scramble_int4_rev(sobol, parts::hash_int4(scramble.into())).reverse_bits().to_f32_norm()
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
    fn numbers_are_those_of_the_crate() {
        for (sample, seed) in (0..200).map(|i| (i * 327 % MAX_SAMPLES, hash(i, 5))) {
            let mut sampler = Sampler::new(sample, seed);
            for set in 0..2 * SETS {
                let seed = if set < SETS { seed } else { hash(seed, 1) };
                assert_eq!(sampler.next4(), sobol_burley::sample_4d(sample, set % SETS, seed), "{sample}, set {set}");
            }
        }
    }

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
