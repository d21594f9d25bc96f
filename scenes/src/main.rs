//! Writes the scenes' files, or with `--check` says which of the committed ones differ from what the code makes.

use std::process::ExitCode;
use std::{env, fs};

fn main() -> ExitCode {
    let check = env::args().skip(1).any(|argument| argument == "--check");
    let mut failed = false;
    for scene in scenes::all() {
        for (name, content) in scene.files() {
            let path = scenes::folder().join(&name);
            if fs::read(&path).is_ok_and(|old| old == content) {
                continue;
            }
            if check {
                eprintln!("{name} is not what the code makes; `cargo run -p scenes` writes it");
                failed = true;
            } else if let Err(error) = fs::write(&path, content) {
                eprintln!("{}: {error}", path.display());
                failed = true;
            } else {
                println!("{name}: {} bytes", content.len());
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
