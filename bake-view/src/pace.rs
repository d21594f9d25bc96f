//! Coarser pictures while something moves, where full ones would come too slowly.

/// Longest time for a picture while something moves, seconds.
const BUDGET: f64 = 1.0 / 15.0;

/// Coarsest picture: one texel for this many pixels across.
const COARSEST: u32 = 8;

/// How long full pictures take, as far as is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pace {
    full_seconds: f64,
}

impl Pace {
    /// Pixels across that share a texel: 1 at rest.
    pub fn divisor(&self, moves: bool) -> u32 {
        if moves { ((self.full_seconds / BUDGET).sqrt().ceil() as u32).clamp(1, COARSEST) } else { 1 }
    }

    /// Learns from a picture that took `seconds`; what was drawn before counts half, so that one hiccup does not show.
    pub fn drew(&mut self, divisor: u32, seconds: f64) {
        let full = seconds * f64::from(divisor * divisor);
        self.full_seconds = if self.full_seconds == 0.0 { full } else { 0.5 * (self.full_seconds + full) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_pictures_get_coarser_while_something_moves_and_only_then() {
        let mut pace = Pace::default();
        assert_eq!(pace.divisor(true), 1);
        pace.drew(1, 0.6);
        assert_eq!((pace.divisor(true), pace.divisor(false)), (3, 1));
        // Coarse ones that take a ninth of the time say the same.
        pace.drew(3, 0.6 / 9.0);
        assert_eq!(pace.divisor(true), 3);
        (0..10).for_each(|_| pace.drew(1, 0.005));
        assert_eq!(pace.divisor(true), 1);
        (0..10).for_each(|_| pace.drew(1, 1e4));
        assert_eq!(pace.divisor(true), COARSEST);
    }
}
