//! How the silent core tells how far it is, and hears that it should stop.

/// Watches a long computation. Called from many threads.
pub trait Progress: Sync {
    /// A stage begins; its work is counted in units whose number may still be an estimate.
    fn stage(&self, name: &str, units: u64);
    /// The current stage is now thought to take so many units in all, those done included.
    fn expect(&self, units: u64);
    /// Some units of the current stage are done.
    fn advance(&self, units: u64);
    /// Whether to stop as soon as possible.
    fn is_cancelled(&self) -> bool;
}

/// Watches nothing and never stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&self, _name: &str, _units: u64) {}
    fn expect(&self, _units: u64) {}
    fn advance(&self, _units: u64) {}
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// The computation was stopped from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;
