//! Shared by the tests that span crates: the program under test, points on baked surfaces, the ledger of results.

pub mod ledger;
pub mod points;
pub mod program;

/// Whether the long forms of tests were asked for (`BAKE_LONG=1`).
pub fn long() -> bool {
    std::env::var("BAKE_LONG").as_deref() == Ok("1")
}
