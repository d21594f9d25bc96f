//! `bake tables`: the impulse-response tables that fog is baked with: made, shown, checked.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use ::tables::accuracy::{self, Verified};
use ::tables::curves::Grid;
use ::tables::set::{self, NAMES};
use ::tables::{Layout, Recipe, TableSet, drawing};
use bake_core::progress::Progress as _;
use bake_formats::table_file::{Precision, TableFile};

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::progress::Progress;

/// Flags of `bake tables`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    action: Action,
}

/// What `bake tables` does.
#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Make a table file anew, with its look-up error measured
    Generate(Generate),
    /// Print the manifest of a table file and draw its coefficients against distance
    Inspect(Inspect),
    /// Recompute part of a table file and compare with the error it states
    Verify(Verify),
}

/// Flags of `bake tables generate`.
#[derive(Debug, clap::Args)]
struct Generate {
    /// File to write
    #[arg(short, long, default_value = "bake.tables")]
    output: PathBuf,
    /// Distances stored, uniform in their logarithm
    #[arg(long, default_value_t = Recipe::default().grid.bins)]
    bins: usize,
    /// Smallest distance, optical
    #[arg(long, default_value_t = Recipe::default().grid.min)]
    min: f64,
    /// Largest distance, optical
    #[arg(long, default_value_t = Recipe::default().grid.max)]
    max: f64,
    /// Zonal bands of point and directional light
    #[arg(long, default_value_t = Recipe::default().bands)]
    bands: usize,
    /// Scattering orders with a table each
    #[arg(long, default_value_t = Recipe::default().scatter_orders)]
    scatter_orders: usize,
    /// How light that a surface sends is held
    #[arg(long, value_enum, default_value_t = Held::Harmonic)]
    layout: Held,
    /// Storage of the large tables
    #[arg(long, value_enum, default_value_t = Stored::F16)]
    precision: Stored,
}

/// Storage on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Stored {
    /// 16 bits
    F16,
    /// 32 bits
    F32,
}

/// Layout on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Held {
    /// Mirror-symmetric harmonics
    Harmonic,
    /// As published in 2019: zonal harmonics about an axis fitted to radiance
    Paper,
    /// The same with the axis fitted to irradiance
    PaperIrradiance,
}

/// Flags of `bake tables inspect`.
#[derive(Debug, clap::Args)]
struct Inspect {
    /// Table file; without it the tables of the program
    file: Option<PathBuf>,
    /// Write a picture of one table's coefficients against distance
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Table that is drawn
    #[arg(long, default_value = "point.single", value_parser = clap::builder::PossibleValuesParser::new(NAMES))]
    table: String,
}

/// Flags of `bake tables verify`.
#[derive(Debug, clap::Args)]
struct Verify {
    /// Table file; without it the tables of the program
    file: Option<PathBuf>,
    /// Distances recomputed in each table
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,
    /// Which distances: another seed, other places
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Generates, inspects or verifies.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    match &args.action {
        Action::Generate(args) => generate(args, global),
        Action::Inspect(args) => inspect(args),
        Action::Verify(args) => verify(args, global),
    }
}

fn generate(args: &Generate, global: &Global) -> Result<Outcome, Failure> {
    let recipe = Recipe {
        layout: match args.layout {
            Held::Harmonic => Layout::Harmonic,
            Held::Paper => Layout::Paper,
            Held::PaperIrradiance => Layout::PaperIrradiance,
        },
        grid: Grid { min: args.min, max: args.max, bins: args.bins },
        bands: args.bands,
        scatter_orders: args.scatter_orders,
        precision: if args.precision == Stored::F16 { Precision::F16 } else { Precision::F32 },
        ..Recipe::default()
    };
    if let Some(fault) = recipe.fault() {
        return Err(Failure::wrong(fault, "`bake tables generate --help` lists the flags"));
    }
    check_folder(&args.output)?;
    let progress = Progress::new(global, Interrupt::default());
    let file = ::tables::generate(&recipe, &reporter(&progress));
    file.write(&args.output)?;
    console::print_line(&args.output.display().to_string())?;
    Ok(Outcome::Done)
}

/// Told before the work, which takes half a minute.
fn check_folder(file: &Path) -> Result<(), Failure> {
    let inside = file.with_file_name(".");
    std::fs::metadata(inside).map(drop).map_err(|error| Failure::unwritable(file, error))
}

/// Steps of the bar, which has one stage.
const STEPS: u64 = 1000;

/// Turns shares done into steps of a bar.
fn reporter(progress: &Progress) -> impl Fn(f64, &str) + Sync {
    progress.stage("tables", STEPS);
    let done = AtomicU64::new(0);
    move |share, _| {
        let now = (share * STEPS as f64) as u64;
        progress.advance(now.saturating_sub(done.fetch_max(now, Ordering::Relaxed)));
        if now == STEPS {
            progress.finish();
        }
    }
}

fn read(file: &Option<PathBuf>) -> Result<TableFile, Failure> {
    match file {
        Some(path) => TableFile::read(path),
        None => TableFile::from_bytes(set::embedded_bytes(), "the tables of the program"),
    }
    .map_err(Failure::invalid)
}

fn inspect(args: &Inspect) -> Result<Outcome, Failure> {
    let file = read(&args.file)?;
    console::print_line(&serde_json::to_string_pretty(&file.manifest).map_err(Failure::failed)?)?;
    if let Some(path) = &args.svg {
        let tables = TableSet::from_file(&file).map_err(Failure::invalid)?;
        let svg = drawing::draw(&tables, &args.table);
        std::fs::write(path, svg)
            .map_err(|error| Failure::unwritable_so(path, error, "choose another place with `--svg`"))?;
    }
    Ok(Outcome::Done)
}

fn verify(args: &Verify, global: &Global) -> Result<Outcome, Failure> {
    let checks = accuracy::verify(&read(&args.file)?, args.samples as usize, args.seed).map_err(Failure::invalid)?;
    console::print(&if global.json { as_json(&checks) } else { as_text(&checks) })?;
    match checks.iter().find(|check| !check.holds) {
        Some(check) => Err(Failure::wrong(
            format!("table {}: error {:.2e} where the file states {:.2e}", check.table, check.measured, check.stored),
            "make the file anew with `bake tables generate`",
        )),
        None => Ok(Outcome::Done),
    }
}

fn as_text(checks: &[Verified]) -> String {
    let line = |check: &Verified| {
        let verdict = if check.holds { "" } else { "  TOO LARGE" };
        format!("{:<20} {:>12.2e} {:>12.2e}{verdict}\n", check.table, check.stored, check.measured)
    };
    let head = format!("{:<20} {:>12} {:>12}\n", "table", "stated", "measured");
    head + &checks.iter().map(line).collect::<String>()
}

fn as_json(checks: &[Verified]) -> String {
    let of = |check: &Verified| {
        let Verified { table, stored, measured, holds } = check;
        serde_json::json!({ "table": table, "stated": stored, "measured": measured, "holds": holds })
    };
    format!("{:#}\n", serde_json::Value::from_iter(checks.iter().map(of)))
}
