//! `bake study`: what accuracy costs in time, for one scene.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::flags::rare;
use crate::input::{HELP_TEMPLATE, Input};
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use bake_study::clock::Clock;
use bake_study::effort::Effort;
use bake_study::{Study, StudyError, effects};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Example: bake study room.glb --fog sigma_t=0.2,albedo=0.9 -o out, then open out/study.html
Ctrl-C keeps what was measured; the same command goes on. Samples are the study's own, pages too unless it is thorough.
--reference-samples N changes its reference, --processor-time tells the processor's seconds on a busy machine.";

const USAGE: &str = "\
bake study [OPTIONS] <SCENE>
       bake study --stability [OPTIONS]";

/// Rare flags of a bake that do not count here.
const UNUSED: [&str; 6] = ["--probes", "--fog-volume", "--keep-vacuum", "--half", "--keep-paths", "--keep-raw"];

/// Flags of `bake study`.
#[derive(Debug, clap::Args)]
#[command(mut_arg("file", |file| file.required(false).required_unless_present("stability").default_value_if("stability", "true", "-")))]
#[command(mut_args(hide_unused), override_usage = USAGE)]
#[command(allow_negative_numbers = true, help_template = HELP_TEMPLATE, after_help = format!("{EXAMPLES}\n\n{}", rare(&UNUSED)))]
pub struct Args {
    /// What to work on.
    #[command(flatten)]
    pub input: Input,
    /// Folder of the study [default: SCENE-stem.study beside the scene]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Take what it needs: the settings' own pages, more points, a better reference
    #[arg(long)]
    pub thorough: bool,
    /// Leave out each effect and compare with the bound that the plan states
    #[arg(long, conflicts_with = "stability")]
    pub effects: bool,
    /// Without a scene: where formulas and tables keep their digits
    #[arg(long)]
    pub stability: bool,
    /// Tell the processor's seconds, all threads together, not the wall's: for a machine that is busy otherwise
    #[arg(long, hide = true)]
    pub processor_time: bool,
    /// Samples per texel of the reference [default: 8192; 65536 when thorough]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..), hide = true)]
    pub reference_samples: Option<u32>,
}

/// Hides flags of a bake that do not count here.
fn hide_unused(flag: clap::Arg) -> clap::Arg {
    let is_unused = ["samples", "target_error", "time_budget", "sh1"].iter().any(|name| flag.get_id() == name);
    if is_unused { flag.hide(true) } else { flag }
}

/// Studies.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let progress = Progress::new(global, Interrupt::listen());
    let told = match args {
        Args { stability: true, .. } => stability(args, &progress),
        Args { effects: true, .. } => effects(args, global, &progress),
        _ => costs(args, global, &progress),
    };
    progress.finish();
    let told = told?;
    if !global.quiet || global.json {
        console::print(&told)?;
    }
    Ok(Outcome::Done)
}

fn costs(args: &Args, global: &Global, progress: &Progress) -> Result<String, Failure> {
    let study = study(args)?;
    let summary =
        bake_study::run(&study, progress, &tell(global, progress)).map_err(|error| failure(error, &study.folder))?;
    if global.json {
        return Ok(json(&summary));
    }
    Ok(format!("{}{:<10} {}\n", summary.text(), "report", study.folder.join("study.html").display()))
}

fn effects(args: &Args, global: &Global, progress: &Progress) -> Result<String, Failure> {
    let study = study(args)?;
    let all = effects::run(&study, progress, &tell(global, progress)).map_err(|error| failure(error, &study.folder))?;
    if global.json {
        return Ok(json(&all));
    }
    Ok(format!("{}report {}\n", effects::text(&all), study.folder.join("effects.html").display()))
}

fn stability(args: &Args, progress: &Progress) -> Result<String, Failure> {
    let folder = args.output.clone().unwrap_or_else(|| "stability".into());
    let page = bake_study::stability::run(&folder, args.thorough, progress).map_err(|error| failure(error, &folder))?;
    Ok(format!("report {}\n", page.display()))
}

fn json(result: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(result).expect("plain data becomes JSON") + "\n"
}

/// Warnings are told unless all is to be quiet, points when more is to be said.
fn tell<'a>(global: &'a Global, progress: &'a Progress) -> impl Fn(&str) + 'a {
    move |line| {
        if global.verbose || (line.starts_with("warning") && !global.quiet) {
            progress.line(line);
        }
    }
}

fn study(args: &Args) -> Result<Study, Failure> {
    let mut effort = if args.thorough { Effort::thorough() } else { Effort::quick() };
    if let Some(samples) = args.reference_samples {
        effort = effort.with_reference(samples);
    }
    let clock = if args.processor_time { Clock::Processor } else { Clock::Wall };
    let folder = args.output.clone().unwrap_or_else(|| args.input.file.with_extension("study"));
    Ok(Study { file: args.input.file.clone(), settings: args.input.settings()?, folder, effort, clock })
}

fn failure(error: StudyError, folder: &Path) -> Failure {
    match error {
        StudyError::Job(error) => error.into(),
        StudyError::Format(error) => error.into(),
        StudyError::Interrupted(_) => {
            Failure::Paused(format!("what was measured lies in {}; the same command goes on", folder.display()))
        }
        StudyError::Io { path, source } => Failure::unwritable(&path, source),
        error @ StudyError::Points { .. } => Failure::invalid(error),
    }
}
