//! `bake run`: the main job, from a scene file to a package on disk.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::explain_text;
use crate::flags::rare;
use crate::input::{HELP_TEMPLATE, Input};
use crate::interrupt::Interrupt;
use crate::job::{self, Job, stop_if_interrupted};
use crate::output::{Output, Pages};
use crate::plan_text;
use crate::progress::Progress;
use crate::report::{Measured, Stopwatch};
use bake_core::explain::{self, Explanation};
use bake_core::plan::Plan;
use bake_core::post::{self, Hidden};
use bake_core::progress::{Interrupted, Progress as _};
use bake_core::solve::buffers::PageBuffers;
use bake_core::solve::kept::{self, KeptError};
use bake_core::solve::lattice::Lattice;
use bake_core::solve::points::{LatticeLight, LatticeReport};
use bake_core::solve::visibility;
use bake_core::solve::{self, Lightmap, LightmapSettings, Solver};
use bake_core::trace::Tracer;
use bake_optics::medium::MediumSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::NamedTempFile;

const EXAMPLES: &str = "\
Example:
  bake run room.glb --quality preview --sun azimuth_deg=120,elevation_deg=35,lux=80000 --explain -o out/room";

/// Flags of `bake run`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{}", rare(&[])))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
    /// Folder of the package [default: SCENE-stem.bake beside the scene]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Also find out by short bakes what each effect changed and what it cost
    #[arg(long)]
    pub explain: bool,
}

/// Bakes.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let progress = Progress::new(global, Interrupt::listen());
    let result = bake(args, global, &progress);
    progress.finish();
    report(&result?, global)
}

/// Prints what was measured.
pub fn report(measured: &Measured, global: &Global) -> Result<Outcome, Failure> {
    if global.json {
        console::print_line(&serde_json::to_string_pretty(measured).expect("plain data becomes JSON"))?;
    } else if !global.quiet {
        console::print(&(measured.table() + &explain_text::text(measured)))?;
    }
    Ok(if measured.lightless_texels == 0 { Outcome::Done } else { Outcome::DoneWithGaps })
}

fn bake(args: &Args, global: &Global, progress: &Progress) -> Result<Measured, Failure> {
    let mut stopwatch = Stopwatch::default();
    let job = job::prepare(&args.input, progress, &mut stopwatch)?;
    // An output that cannot be written is told before hours of tracing, not after.
    let folder = args.output.clone().unwrap_or_else(|| args.input.file.with_extension("bake"));
    let output = Output::open(&folder, &job.scene.name)?;
    progress.stage("build trees", 0);
    let tracer = stopwatch.time("build trees", || Tracer::new(&job.scene));
    stop_if_interrupted(progress)?;
    let threads = rayon::current_num_threads();
    let plan = stopwatch.time("plan", || Plan::derive(&tracer, &job.air, &job.settings, &job.atlas, threads))?;
    tell(global, progress, &job, &plan);

    let solved = trace(&tracer, &job, &plan, (&output, args.explain), progress, &mut stopwatch)?;
    publish(job, &plan, solved, output, &args.input.file, (progress, stopwatch))
}

/// Finishes what was solved and writes the package.
pub fn publish(
    mut job: Job,
    plan: &Plan,
    mut solved: Solved,
    output: Output,
    scene_file: &Path,
    (progress, mut stopwatch): (&Progress, Stopwatch),
) -> Result<Measured, Failure> {
    let raw = job.settings.keep_raw.then(|| solved.lightmap.pages.clone());
    stopwatch.time("post", || {
        finish_pages(&job, &mut solved.lightmap.pages);
        solved.vacuum.iter_mut().for_each(|vacuum| finish_pages(&job, vacuum));
    });
    stop_if_interrupted(progress)?;

    progress.stage("write", 0);
    let target = job.settings.relative_error();
    let Solved { lightmap, vacuum, probes, fog_volume, paths, explanation } = solved;
    job.warnings.extend(missed_target(&job, &lightmap));
    job.warnings.extend([("probes", &probes), ("fog cells", &fog_volume)].into_iter().filter_map(|(name, light)| {
        missed_points(name, light.as_ref().filter(|_| job.settings.samples.is_none())?, target)
    }));
    job.warnings.extend(endless_paths(&lightmap));
    let hidden = post::hidden(&job.atlas, &lightmap.pages);
    job.warnings.extend(lightless(&job, &hidden));
    // Without air the bake is its own vacuum.
    let vacuum = job.settings.keep_vacuum.then(|| vacuum.as_deref().unwrap_or(&lightmap.pages));
    let (probes, fog_volume) = (probes.as_ref(), fog_volume.as_ref());
    let pages = Pages {
        finished: &lightmap.pages,
        reports: &lightmap.reports,
        raw: raw.as_deref(),
        vacuum,
        probes,
        fog_volume,
    };
    let package = stopwatch.time("write", || output.write(scene_file, &job, plan, pages, paths))?;
    let mut measured = Measured::new(stopwatch, &lightmap, target);
    measured.unbaked_texels = hidden.texels;
    measured.lightless_texels = hidden.lightless_texels;
    measured.filled_texels -= hidden.texels;
    measured.probes = probes.map(|light| light.report);
    measured.fog_volume = fog_volume.map(|light| light.report);
    measured.warnings = job.warnings;
    measured.left_out = plan.effects.iter().filter(|effect| effect.is_left_out()).cloned().collect();
    measured.explained = explanation.clone().map(|explanation| measured.explain(explanation, &lightmap.pages));
    measured.package = package;
    crate::output::write_measured(&measured)?;
    crate::html::write(&measured, &job.scene.name, plan, &lightmap.pages)?;
    Ok(measured)
}

/// Says what is going to happen: warnings, and the plan when asked to say more.
pub fn tell(global: &Global, progress: &Progress, job: &Job, plan: &Plan) {
    if global.verbose {
        progress.line(plan_text::text(&job.scene.name, plan).trim_end());
    }
    if !global.quiet {
        job.warnings.iter().for_each(|warning| progress.line(&format!("warning: {warning}")));
    }
}

/// All light of a bake.
pub struct Solved {
    /// The counts of rays are those of everything.
    pub lightmap: Lightmap,
    /// Pages of the scene without its air, where that is asked for and another bake.
    pub vacuum: Option<Vec<PageBuffers>>,
    /// Light at probes.
    pub probes: Option<LatticeLight>,
    /// Light at the cells of the fog volume.
    pub fog_volume: Option<LatticeLight>,
    /// The file of kept paths.
    pub paths: Option<NamedTempFile>,
    /// What each effect took and changed, where it was asked for.
    pub explanation: Option<Explanation>,
}

fn trace(
    tracer: &Tracer,
    job: &Job,
    plan: &Plan,
    (output, is_explained): (&Output, bool),
    progress: &Progress,
    stopwatch: &mut Stopwatch,
) -> Result<Solved, Failure> {
    let deadline = job.settings.time_budget.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    let (media, settings) = (&plan.simulated.media, &LightmapSettings { deadline, ..plan.solver.clone() });
    let solver = stopwatch.time("light in the air", || Solver::prepare(tracer, media, settings, progress))?;
    let (mut lightmap, paths) = stopwatch.time("trace", || {
        if !job.settings.keep_paths {
            return Ok((solver.lightmap(&job.atlas, progress)?, None));
        }
        let begin = |header: &_| output.begin_paths(header);
        let kept = kept::keep(tracer, media, &job.atlas, settings, progress, begin)?;
        Ok::<_, Failure>((kept.0, Some(kept.1.into_inner().map_err(|error| output.unwritable(error.into_error()))?)))
    })?;
    let mut vacuum = None;
    if job.settings.keep_vacuum && !plan.simulated.is_empty() {
        let none = MediumSet::default();
        let without = stopwatch.time("vacuum", || solve::lightmap(tracer, &none, &job.atlas, settings, progress))?;
        lightmap.rays += without.rays;
        lightmap.shadow_rays += without.shadow_rays;
        vacuum = Some(without.pages);
    }
    let mut lattice = |name, lattice: &Option<Lattice>| -> Result<Option<LatticeLight>, Failure> {
        let Some(lattice) = lattice else { return Ok(None) };
        let light = stopwatch.time(name, || solver.lattice(lattice, progress))?;
        lightmap.rays += light.report.rays;
        lightmap.shadow_rays += light.report.shadow_rays;
        lightmap.cut_paths += light.report.cut_paths;
        Ok(Some(light))
    };
    let mut probes = lattice("probes", &plan.lattices.probes)?;
    let fog_volume = lattice("fog volume", &plan.lattices.fog_volume)?;
    if let Some(probes) = probes.as_mut().filter(|_| job.settings.probes.as_ref().is_some_and(|set| set.visibility)) {
        probes.visibility = Some(stopwatch.time("probes", || visibility::moments(tracer, probes, progress))?);
    }
    if is_explained {
        progress.stage("explain", 0);
    }
    let explain = || explain::explain(tracer, &job.air, &job.atlas, plan, &solver);
    let explanation = is_explained.then(|| stopwatch.time("explain", explain)).transpose()?;
    Ok(Solved { lightmap, vacuum, probes, fog_volume, paths, explanation })
}

impl From<KeptError> for Failure {
    fn from(error: KeptError) -> Self {
        match error {
            KeptError::Interrupted => Self::Interrupted,
            KeptError::File(error) => error.into(),
        }
    }
}

impl From<Interrupted> for Failure {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// Fills what no sample reached and closes seams.
fn finish_pages(job: &Job, pages: &mut [PageBuffers]) {
    /// Largest angle between normals on both sides of a seam, degrees: surfaces meant as smooth stay below.
    const SMOOTH_ANGLE: f32 = 15.0;
    post::adopt(&job.scene, &job.atlas.pages, pages);
    post::dilate(&job.atlas, pages, job.settings.padding);
    let seams = post::find_seams(&job.scene, &job.atlas, SMOOTH_ANGLE);
    post::stitch(&seams, &job.atlas, pages);
}

/// A warning that names what got no light at all.
fn lightless(job: &Job, hidden: &Hidden) -> Option<String> {
    const NAMED: usize = 3;
    let paths = hidden.lightless.iter().map(|&i| format!("\"{}\"", job.scene.instances[i as usize].path));
    let named: Vec<String> = paths.take(NAMED).collect();
    let more = hidden.lightless.len().checked_sub(NAMED + 1).map_or(String::new(), |n| format!(" and {} more", n + 1));
    (!named.is_empty()).then(|| {
        format!(
            "no light could be found for {}{more}: inside other geometry, or turned inside out; check the faces' winding, \
             or take the node out of the lightmap (`nodes` in the settings)",
            named.join(", ")
        )
    })
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

/// The same of points in the air.
fn missed_points(name: &str, light: &LatticeLight, target: f32) -> Option<String> {
    let LatticeReport { error, samples, .. } = light.report;
    (error > target).then(|| {
        let [error, target] = [error, target].map(|share| 100.0 * share);
        format!("{name} kept a standard error of {error:.1} %, above {target:.1} %, when the most samples ({samples}) were taken")
    })
}

/// A warning where light had nothing to absorb it: a closed room of albedo 1 holds its light for ever.
fn endless_paths(lightmap: &Lightmap) -> Option<String> {
    (lightmap.cut_paths > 0).then(|| {
        format!(
            "endless light: {} paths were cut at the longest length, because the surfaces that enclose them absorb next to \
             nothing; lower their base colour below 1, or cap reflections with `--bounces`",
            lightmap.cut_paths
        )
    })
}
