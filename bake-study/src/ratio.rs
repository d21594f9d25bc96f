//! Whether one program is slower than another, from interleaved runs of both: by ratio, beyond the noise of these runs.

/// A loss below this is none, a share: what another place of code in memory does.
pub const NEGLIGIBLE: f64 = 0.02;

/// Standard errors between the mean and what is taken for sure; with eight pairs a false alarm in 300 runs (Student's t).
const CERTAIN: f64 = 4.0;

/// What pairs of runs say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// New over old, geometric mean over the pairs.
    pub ratio: f64,
    /// Its standard error, as a factor's share, from the spread of the pairs.
    pub error: f64,
    /// What follows.
    pub verdict: Verdict,
}

/// What follows from pairs of runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No loss that counts.
    Kept,
    /// Slower beyond noise.
    Lost,
    /// The noise would hide a loss of a tenth: measure again on a quieter machine, or longer.
    TooNoisy,
}

/// Judges the costs of pairs (old, new), each above 0, taken one right after the other. Panics with fewer than three.
pub fn decide(pairs: &[(f64, f64)]) -> Decision {
    assert!(pairs.len() >= 3, "{} pairs tell nothing of their noise", pairs.len());
    let logs: Vec<f64> = pairs.iter().map(|(old, new)| (new / old).ln()).collect();
    let count = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / count;
    let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    let verdict = if mean - CERTAIN * error > NEGLIGIBLE.ln_1p() {
        Verdict::Lost
    } else if CERTAIN * error > 0.1 {
        Verdict::TooNoisy
    } else {
        Verdict::Kept
    };
    Decision { ratio: mean.exp(), error, verdict }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight pairs of the given ratio, with made-up noise of about `noise` that machines show: both run slow together.
    fn pairs(ratio: f64, noise: f64) -> Vec<(f64, f64)> {
        const SHAKE: [f64; 8] = [0.3, -1.1, 0.8, -0.4, 1.2, -0.9, 0.5, -0.4];
        let slow = |i: usize| 1.0 + 0.5 * (i as f64).sin().abs();
        (0..8).map(|i| (10.0 * slow(i), 10.0 * slow(i) * ratio * (1.0 + noise * SHAKE[i]))).collect()
    }

    #[test]
    fn a_loss_beyond_noise_is_told_and_one_within_is_not() {
        for (ratio, noise, verdict) in [
            (1.0, 0.01, Verdict::Kept),
            (0.8, 0.01, Verdict::Kept),
            (1.01, 0.001, Verdict::Kept),
            (1.1, 0.01, Verdict::Lost),
            (1.05, 0.01, Verdict::Lost),
            (1.05, 0.05, Verdict::Kept),
            (1.3, 0.05, Verdict::Lost),
            (1.05, 0.2, Verdict::TooNoisy),
        ] {
            let decision = decide(&pairs(ratio, noise));
            assert_eq!(decision.verdict, verdict, "ratio {ratio}, noise {noise}: {decision:?}");
        }
    }

    #[test]
    fn a_machine_that_slows_down_is_no_loss() {
        let slowing: Vec<(f64, f64)> = (0..8).map(|i| (1.0 + f64::from(i), 1.0 + f64::from(i) + 0.001)).collect();
        assert_eq!(decide(&slowing).verdict, Verdict::Kept);
        // Taken apart, the same numbers would look like one: old runs first, new ones after.
        let apart: Vec<(f64, f64)> = (0..4).map(|i| (slowing[i].0, slowing[i + 4].1)).collect();
        assert!(decide(&apart).ratio > 1.5);
    }
}
