//! `bake sample`: baked light at points in space, as comma separated text.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use bake_formats::Package;
use bake_formats::package::write_atomic;
use bake_formats::sample::{Sampler, sample_csv};
use std::io::Write;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Example:
  bake sample room.bake points.csv -o light.csv

The points' columns are px,py,pz,nx,ny,nz or x,y,z,nx,ny,nz: metres and directions in the axes of the glTF file.
Other columns pass through; lines that begin with # are skipped. A point takes the light of the nearest surface
that faces along its normal within 60 degrees.";

/// Flags of `bake sample`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The package's folder
    pub package: PathBuf,
    /// The points: comma separated, one a line below a header
    pub points: PathBuf,
    /// Write to this file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Samples.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let real = |path: &Path| path.canonicalize().ok();
    if args.output.as_deref().is_some_and(|file| real(file).is_some() && real(file) == real(&args.points)) {
        let text = format!("{} holds the points and is not overwritten", args.points.display());
        return Err(Failure::wrong(text, "name another file with `-o FILE`"));
    }
    let package = Package::open(&args.package)?;
    let sampler = Sampler::open(&package)?;
    let points = std::fs::read_to_string(&args.points).map_err(|error| {
        let text = format!("cannot read {}: {error}", args.points.display());
        Failure::wrong(text, "name a text file with the columns px,py,pz,nx,ny,nz")
    })?;
    let (light, unanswered) = sample_csv(&sampler, &points).map_err(|error| {
        Failure::wrong(format!("{}: {error}", args.points.display()), "`bake sample --help` shows the columns")
    })?;
    match &args.output {
        Some(file) => write_atomic(file, |out| out.write_all(light.as_bytes()))?,
        None => console::print(&light)?,
    }
    if unanswered > 0 && !global.quiet {
        console::tell(&format!(
            "{unanswered} points have empty cells: no lightmapped surface faces along their normals"
        ));
    }
    Ok(Outcome::Done)
}
