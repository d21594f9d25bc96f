//! Progress through work whose size becomes known on the way: one stage over all rounds and pages.

use super::REPLICATES;
use super::rounds::Rounds;
use crate::progress::{Interrupted, Progress};

/// Samples of a texel that take about as long as finding its surface points: sixteen rays from each of some ten points.
pub(super) const FINDING: u64 = 32;

/// A stage counted in samples of texels, or of points of a lattice.
pub(super) struct Work<'a> {
    progress: &'a dyn Progress,
    /// Units behind us.
    done: u64,
    /// Texels whose page has not begun.
    waiting: u64,
}

impl<'a> Work<'a> {
    /// Begins the stage, with so many texels on pages that have not begun: each is expected to take what `rounds` expect.
    pub fn begin(progress: &'a dyn Progress, name: &str, waiting: usize, rounds: &Rounds) -> Self {
        let work = Self { progress, done: 0, waiting: waiting as u64 };
        progress.stage(name, work.total(0, rounds));
        work
    }

    fn total(&self, texels: u64, rounds: &Rounds) -> u64 {
        self.done + texels * rounds.left() + self.waiting * (FINDING + rounds.expected())
    }

    /// A page's surface points are found.
    pub fn found(&mut self, texels: usize) {
        self.waiting -= texels as u64;
        self.done += texels as u64 * FINDING;
    }

    /// Tells how much is expected while a page of `texels` has got to where its rounds are.
    pub fn expect(&self, texels: usize, rounds: &Rounds) {
        self.progress.expect(self.total(texels as u64, rounds));
    }

    /// A round over so many texels is done.
    pub fn finish_round(&mut self, texels: usize, samples: &std::ops::Range<u32>) {
        self.done += texels as u64 * units(samples);
    }

    /// Some texels are done with units each; whether to go on.
    pub fn advance(&self, texels: usize, units: u64) -> Result<(), Interrupted> {
        self.progress.advance(texels as u64 * units);
        self.check()
    }

    /// Whether to go on.
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.progress.is_cancelled() { Err(Interrupted) } else { Ok(()) }
    }
}

/// Samples of a texel in a round.
pub(super) fn units(samples: &std::ops::Range<u32>) -> u64 {
    samples.len() as u64 * REPLICATES as u64
}
