//! `bake plan`: what a bake would do, and its sizes, memory and time; nothing is traced but a few thousand paths that
//! tell how bright the scene is.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::flags::rare;
use crate::input::{HELP_TEMPLATE, Input};
use crate::interrupt::Interrupt;
use crate::job;
use crate::plan_text;
use crate::progress::Progress;
use crate::report::Stopwatch;
use bake_core::plan::Plan;
use bake_core::trace::Tracer;

const EXAMPLES: &str = "\
Example:
  bake plan room.glb --quality final --page-size 2048";

/// Flags of `bake plan`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{}", rare(&[])))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
}

/// Plans.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let progress = Progress::new(global, Interrupt::listen());
    let prepared = job::prepare(&args.input, &progress, &mut Stopwatch::default());
    progress.finish();
    let job = prepared?;
    if !global.quiet {
        job.warnings.iter().for_each(|warning| progress.line(&format!("warning: {warning}")));
    }
    let plan =
        Plan::derive(&Tracer::new(&job.scene), &job.air, &job.settings, &job.atlas, rayon::current_num_threads())?;
    if global.json {
        console::print_line(&serde_json::to_string_pretty(&plan).expect("plain data becomes JSON"))?;
    } else {
        console::print(&plan_text::text(&job.scene.name, &plan))?;
    }
    Ok(Outcome::Done)
}
