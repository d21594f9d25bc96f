//! How many samples are taken, round by round: until the error is small enough, the cap is reached or the time is over.

use super::sampler::MAX_SAMPLES;
use super::{LightmapSettings, REPLICATES};
use std::ops::Range;
use std::time::{Duration, Instant};

/// Samples of a first round whose pace is not known yet, under a deadline.
const FIRST_SAMPLES: u32 = 8;

/// Samples of each replicate where so many are asked for.
fn per_replicate(samples: u32) -> u32 {
    samples.div_ceil(REPLICATES as u32).clamp(1, MAX_SAMPLES)
}

/// Samples that are taken where so many are asked for: as many of each replicate.
pub(crate) fn whole(samples: u32) -> u32 {
    per_replicate(samples) * REPLICATES as u32
}

/// Samples per replicate, round by round: as many more as the error asks for, at most four times as many.
pub(super) struct Rounds {
    done: u32,
    next: u32,
    /// Thought to be taken in all.
    expected: u32,
    cap: u32,
    target: f32,
    deadline: Option<Instant>,
    begin: Instant,
}

impl Rounds {
    /// The first of them; `deadline` is that of this page or lattice alone.
    pub(super) fn new(settings: &LightmapSettings, deadline: Option<Instant>) -> Self {
        let first = if deadline.is_some() { FIRST_SAMPLES } else { settings.min_samples };
        let (floor, cap) = (per_replicate(first.min(settings.min_samples)), per_replicate(settings.max_samples));
        let next = floor.min(cap);
        // A sample's spread is about the texel's value.
        let usual = settings.target_error.powi(-2).min(1e9) as u32;
        let expected = per_replicate(usual).min(cap).max(next);
        Self { done: 0, next, expected, cap, target: settings.target_error, deadline, begin: Instant::now() }
    }

    /// Those of this round.
    pub(super) fn samples(&self) -> Range<u32> {
        self.done..self.next
    }

    /// Samples of a texel that all rounds are thought to take together.
    pub(super) fn expected(&self) -> u64 {
        u64::from(self.expected) * REPLICATES as u64
    }

    /// Those of them that are still to come: the ones of [`Self::samples`] and of rounds after them.
    pub(super) fn left(&self) -> u64 {
        u64::from(self.expected - self.done) * REPLICATES as u64
    }

    /// Whether another round is wanted after one that left `error`; [`Self::samples`] are that round's then.
    pub(super) fn go_on(&mut self, error: f32) -> bool {
        if error <= self.target || self.next == self.cap {
            (self.done, self.expected) = (self.next, self.next);
            return false;
        }
        let pace = self.begin.elapsed() / (self.next - self.done).max(1);
        self.done = self.next;
        let wanted = f64::from(self.done) * f64::from(error / self.target).powi(2) * 1.05;
        self.begin = Instant::now();
        let most = self.cap.min(self.done.saturating_add(self.fitting(pace)));
        self.expected = (wanted.min(1e9) as u32).max(self.done + self.done.div_ceil(4)).min(most);
        self.next = self.expected.min(self.done.saturating_mul(4));
        self.next > self.done
    }

    /// Samples that are done before the deadline, when one takes as long as `pace`.
    fn fitting(&self, pace: Duration) -> u32 {
        let Some(deadline) = self.deadline else { return u32::MAX };
        let left = deadline.saturating_duration_since(self.begin);
        (left.as_secs_f64() / pace.as_secs_f64().max(1e-9)).min(f64::from(MAX_SAMPLES)) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> LightmapSettings {
        LightmapSettings { target_error: 0.01, min_samples: 64, max_samples: 1 << 16, ..LightmapSettings::default() }
    }

    #[test]
    fn rounds_grow_as_the_error_asks() {
        let mut rounds = Rounds::new(&settings(), None);
        assert_eq!(rounds.samples(), 0..8);
        assert_eq!((rounds.expected(), rounds.left()), (10_000, 10_000), "a sample's spread is about the value");
        assert!(rounds.go_on(0.1), "ten times the error");
        assert_eq!(rounds.samples(), 8..32);
        assert_eq!((rounds.expected(), rounds.left()), (8 * 840, 8 * 832), "a hundred times the samples, and a little");
        assert!(rounds.go_on(0.012));
        assert_eq!(rounds.samples(), 32..48);
        assert!(!rounds.go_on(0.01), "reached");
        assert_eq!((rounds.expected(), rounds.left()), (384, 0));
    }

    #[test]
    fn a_deadline_ends_them() {
        let past = Instant::now();
        let mut rounds = Rounds::new(&settings(), Some(past));
        assert_eq!(rounds.samples(), 0..1, "something is baked in any case");
        assert!(!rounds.go_on(0.1));
        let mut rounds = Rounds::new(&settings(), Some(past + Duration::from_secs(3600)));
        assert!(rounds.go_on(0.1), "an hour is enough for more");
    }
}
