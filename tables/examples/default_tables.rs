//! Makes the embedded file `tables/data/default.tables` anew: `cargo run --release -p tables --example default_tables`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data/default.tables");
    let start = std::time::Instant::now();
    let file = tables::generate(&tables::Recipe::default(), &|share, what| {
        eprintln!("{:5.1} s {:3.0} % {what}", start.elapsed().as_secs_f64(), 100.0 * share);
    });
    let seconds = start.elapsed().as_secs_f64();
    file.write(&path)?;
    println!("{}: {} bytes, {:.1} s", path.display(), file.to_bytes().len(), seconds);
    for table in &file.manifest.tables {
        println!("{:20} {:8} curves, look-up error {:.2e}", table.name, table.columns, table.look_up_error);
    }
    Ok(())
}
