//! `bake run`: the main job, from a scene file to a package on disk.

use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use crate::flags::RARE;
use crate::input::{HELP_TEMPLATE, Input};
use crate::interrupt::Interrupt;
use crate::job::{Job, stop_if_interrupted};
use crate::output::{Output, Pages};
use crate::plan_text;
use crate::progress::Progress;
use crate::report::{Measured, Stopwatch};
use bake_core::plan::Plan;
use bake_core::post;
use bake_core::progress::Progress as _;
use bake_core::solve::buffers::{PageBuffers, Validity};
use bake_core::solve::{self, Lightmap};
use bake_core::trace::Tracer;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  bake run room.glb --quality preview -o out/room
  bake run room.glb --sky 1000 --sun azimuth_deg=120,elevation_deg=35,lux=80000";

/// Flags of `bake run`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{RARE}"))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
    /// Folder of the package [default: SCENE-stem.bake beside the scene]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Bakes.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let progress = Progress::new(global, Interrupt::listen());
    let result = bake(args, global, &progress);
    progress.finish();
    let measured = result?;
    if global.json {
        println!("{}", serde_json::to_string_pretty(&measured).expect("plain data becomes JSON"));
    } else if !global.quiet {
        print!("{}", measured.table());
    }
    Ok(if measured.unbaked_texels == 0 { Outcome::Done } else { Outcome::DoneWithGaps })
}

fn bake(args: &Args, global: &Global, progress: &Progress) -> Result<Measured, Failure> {
    let mut stopwatch = Stopwatch::default();
    let mut job = Job::prepare(&args.input, progress, &mut stopwatch)?;
    // An output that cannot be written is told before hours of tracing, not after.
    let folder = args.output.clone().unwrap_or_else(|| args.input.file.with_extension("bake"));
    let output = Output::open(&folder, &job.scene.name)?;
    let plan = Plan::derive(&job.scene, &job.air, &job.settings, &job.atlas, rayon::current_num_threads());
    tell(global, progress, &job, &plan);

    let mut lightmap = trace(&job, &plan, progress, &mut stopwatch)?;
    let raw = job.settings.keep_raw.then(|| lightmap.pages.clone());
    stopwatch.time("post", || finish_pages(&job, &mut lightmap.pages));
    stop_if_interrupted(progress)?;

    progress.stage("write", 0);
    let target = job.settings.relative_error();
    job.warnings.extend(missed_target(&job, &lightmap));
    job.warnings.extend(endless_paths(&lightmap));
    let pages = Pages { finished: &lightmap.pages, raw: raw.as_deref() };
    let package = stopwatch.time("write", || output.write(&args.input.file, &job, &plan, pages))?;
    let mut measured = Measured::new(stopwatch, &lightmap, target);
    measured.unbaked_texels = lightmap.pages.iter().map(without_value).sum();
    measured.filled_texels -= measured.unbaked_texels;
    measured.warnings = job.warnings;
    measured.package = package;
    crate::output::write_measured(&measured)?;
    crate::html::write(&measured, &job.scene.name, &plan, &lightmap.pages)?;
    Ok(measured)
}

/// Says what is going to happen: warnings, and the plan when asked to say more.
fn tell(global: &Global, progress: &Progress, job: &Job, plan: &Plan) {
    if global.verbose {
        progress.line(plan_text::text(&job.scene.name, plan).trim_end());
    }
    if !global.quiet {
        job.warnings.iter().for_each(|warning| progress.line(&format!("warning: {warning}")));
    }
}

fn trace(job: &Job, plan: &Plan, progress: &Progress, stopwatch: &mut Stopwatch) -> Result<Lightmap, Failure> {
    progress.stage("build trees", 0);
    let tracer = stopwatch.time("build trees", || Tracer::new(&job.scene));
    stop_if_interrupted(progress)?;
    let mut settings = job.settings.lightmap_settings();
    if let Some(choice) = &plan.mode {
        settings.mode = choice.mode;
    }
    let traced = stopwatch.time("trace", || solve::lightmap(&tracer, &job.air.media, &job.atlas, &settings, progress));
    traced.map_err(|_| Failure::Interrupted)
}

/// Fills what no sample reached and closes seams.
fn finish_pages(job: &Job, pages: &mut [PageBuffers]) {
    /// Largest angle between normals on both sides of a seam, degrees: surfaces meant as smooth stay below.
    const SMOOTH_ANGLE: f32 = 15.0;
    post::dilate(&job.atlas, pages, job.settings.padding);
    let seams = post::find_seams(&job.scene, &job.atlas, SMOOTH_ANGLE);
    post::stitch(&seams, &job.atlas, pages);
}

fn without_value(page: &PageBuffers) -> u64 {
    page.validity.iter().filter(|state| **state == Validity::Buried).count() as u64
}

/// A warning where the cap on samples ended a page before its error was small enough.
fn missed_target(job: &Job, lightmap: &Lightmap) -> Option<String> {
    let target = job.settings.relative_error();
    let missed = lightmap.reports.iter().filter(|page| page.error > target).count();
    let worst = lightmap.reports.iter().map(|page| page.error).fold(0.0, f32::max);
    (missed > 0 && job.settings.samples.is_none()).then(|| {
        format!(
            "{missed} of {} pages kept a standard error above {:.1} % (up to {:.1} %) when the most samples were taken",
            lightmap.reports.len(),
            100.0 * target,
            100.0 * worst
        )
    })
}

/// A warning where light had nothing to absorb it.
fn endless_paths(lightmap: &Lightmap) -> Option<String> {
    (lightmap.cut_paths > 0).then(|| {
        format!(
            "{} paths were cut at the longest length: surfaces that enclose light absorb next to nothing; lower their base colour",
            lightmap.cut_paths
        )
    })
}
