//! The `bake` program: flags, progress, reports, exit codes; nothing numeric.

fn main() {}
