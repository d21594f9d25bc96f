//! Comparisons that say what was measured, what is allowed and how much room is left.

/// Relative error of `got` against `want`; absolute where `want` is zero.
pub fn relative_error(got: f64, want: f64) -> f64 {
    if got == want {
        return 0.0;
    }
    let difference = (got - want).abs();
    if want == 0.0 { difference } else { difference / want.abs() }
}

/// The worst of many comparisons, remembered with the place where it happened.
#[derive(Debug, Clone)]
pub struct Worst {
    what: String,
    allowed: f64,
    measured: f64,
    place: String,
    count: usize,
}

impl Worst {
    /// Starts a comparison called `what` whose error may be at most `allowed`.
    pub fn new(what: impl Into<String>, allowed: f64) -> Self {
        Self { what: what.into(), allowed, measured: 0.0, place: String::new(), count: 0 }
    }

    /// Records one error; NaN counts as infinitely wrong.
    pub fn record(&mut self, error: f64, place: impl FnOnce() -> String) {
        let error = if error.is_nan() { f64::INFINITY } else { error };
        self.count += 1;
        if error > self.measured || self.count == 1 {
            self.measured = error;
            self.place = place();
        }
    }

    /// Records the relative error of `got` against `want`.
    pub fn relative(&mut self, got: f64, want: f64, place: impl FnOnce() -> String) {
        self.record(relative_error(got, want), place);
    }

    /// The largest error so far.
    pub fn measured(&self) -> f64 {
        self.measured
    }

    /// Whether anything was compared and everything kept within the limit.
    pub fn holds(&self) -> bool {
        self.count > 0 && self.measured <= self.allowed
    }

    /// Prints measured, allowed and margin; panics when nothing was compared or the limit is broken.
    pub fn check(&self) {
        let margin = self.allowed / self.measured.max(self.allowed * 1e-9).max(f64::MIN_POSITIVE);
        println!(
            "{}: measured {:.3e}, allowed {:.3e}, margin {:.1}x, {} comparisons, worst at {}",
            self.what, self.measured, self.allowed, margin, self.count, self.place
        );
        assert!(self.count > 0, "{}: nothing was compared", self.what);
        assert!(
            self.measured <= self.allowed,
            "{}: measured {:.6e} > allowed {:.6e} at {}",
            self.what,
            self.measured,
            self.allowed,
            self.place
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_comparison_does_not_hold() {
        assert!(!Worst::new("nothing", 1.0).holds());
    }

    #[test]
    fn nan_and_excess_do_not_hold() {
        let mut worst = Worst::new("nan", 1.0);
        worst.record(f64::NAN, || "here".into());
        assert!(!worst.holds());
        let mut worst = Worst::new("excess", 1e-3);
        worst.relative(1.01, 1.0, || "here".into());
        assert!(!worst.holds());
        let mut worst = Worst::new("fine", 1e-1);
        worst.relative(1.01, 1.0, || "here".into());
        assert!(worst.holds());
    }
}
