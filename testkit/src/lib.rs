//! What the tests of every crate share: finding reference data, counted skips, comparisons that print
//! measured, allowed and margin, and small statistics. Depends on no crate of the project.

pub mod compare;
pub mod oracle;
pub mod reference;
pub mod statistics;
