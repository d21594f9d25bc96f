//! What accuracy costs: every air-light method on one fixed set of rays, time per evaluation against relative error.
//!
//! `cargo run --release -p bake-optics --example airlight_cost` writes `docs/airlight.md`, `docs/airlight.csv` and a picture per
//! case under `docs/airlight/`. Set `RUSTFLAGS="-C target-cpu=native"` for the vector forms' full width.

mod measure;
mod picture;
mod rays;
mod report;

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    std::fs::create_dir_all(docs.join("airlight"))?;
    let mut results = Vec::new();
    for case in rays::cases() {
        let result = measure::measure(&case);
        picture::draw(&docs.join("airlight").join(format!("{}.svg", case.name.replace(' ', "_"))), &result)?;
        results.push(result);
    }
    std::fs::write(docs.join("airlight.csv"), report::csv(&results))?;
    std::fs::write(docs.join("airlight.md"), report::markdown(&results))?;
    Ok(())
}
