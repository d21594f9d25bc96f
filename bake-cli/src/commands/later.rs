//! What is planned and not built yet: refused by name, so that nobody hunts for a typing error.

use crate::exit::Failure;

/// Commands of later versions.
pub const COMMANDS: &[&str] = &["merge", "status", "explain", "report"];

/// Flags of later versions.
pub const FLAGS: &[&str] = &["--shard", "--resume", "--watch"];

/// Refuses something that a later version will do.
pub fn refuse(what: &str) -> Failure {
    Failure::wrong(format!("{what} is not in this version"), "`bake --help` lists what is")
}
