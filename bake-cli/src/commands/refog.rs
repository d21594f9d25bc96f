//! `bake refog`: other air for a bake whose paths were kept; the look-ups are redone, nothing is traced again but the few walks
//! that bring tables to the scene.

use super::run::{Solved, publish};
use crate::cli::Global;
use crate::exit::{Failure, Outcome};
use crate::input::check_scene_file;
use crate::interrupt::Interrupt;
use crate::job::Job;
use crate::output::Output;
use crate::progress::Progress;
use crate::report::{Measured, Stopwatch};
use crate::values::{self, Given};
use bake_core::fingerprint;
use bake_core::plan::Plan;
use bake_core::progress::Progress as _;
use bake_core::settings::{self, Medium, Mode, Settings};
use bake_core::solve::kept;
use bake_core::trace::Tracer;
use bake_formats::Package;
use bake_formats::path_file::PathReader;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  bake run room.glb --mode tables --fog sigma_t=0.2,albedo=0.9 --keep-paths -o out/room
  bake refog out/room --fog sigma_t=0.5,albedo=0.8 -o out/denser
  bake refog out/room --settings smoke.bake.ron -o out/smoke";

/// Flags of `bake refog`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, after_help = EXAMPLES)]
pub struct Args {
    /// Folder of a package that `bake run --keep-paths` wrote
    #[arg(value_name = "DIR")]
    package: PathBuf,
    /// Folder of the new package
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// The new air: sigma_t=0.5,albedo=0.9[,g=0.3,bounds=x0:y0:z0:x1:y1:z1], channels as 0.5/0.4/0.3; none
    #[arg(long = "fog", value_name = "RECORD", value_parser = values::optional(values::fog), conflicts_with = "settings")]
    fog: Option<Given<Vec<Medium>>>,
    /// A settings file whose media are the new air; all else in it is left aside
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// The scene that was baked [default: the file of its name beside DIR, or in it]
    #[arg(long, value_name = "FILE")]
    scene_file: Option<PathBuf>,
}

/// Folds the kept paths with the new air.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let progress = Progress::new(global, Interrupt::listen());
    let result = refog(args, global, &progress);
    progress.finish();
    super::run::report(&result?, global)
}

fn refog(args: &Args, global: &Global, progress: &Progress) -> Result<Measured, Failure> {
    let media = args.media()?;
    let folder = args.output_folder()?;
    let mut stopwatch = Stopwatch::default();
    progress.stage("check the package", 0);
    let package = stopwatch.time("check the package", || Package::open(&args.package))?;
    let paths = package.path(&paths_of(&package)?);
    let scene_file = args.scene_file(&package)?;
    let mut settings = settings_of(&package, &scene_file, media)?;
    let left_out = leave_out(&mut settings);
    settings.check()?;
    let mut job = Job::prepare(&scene_file, settings, progress)?;
    if job.scene.blake3 != package.manifest.scene.blake3 {
        return Err(Failure::wrong(
            format!("{} is no longer the scene that was baked", scene_file.display()),
            "name the old one with `--scene-file FILE`, or bake anew with `bake run … --keep-paths`",
        ));
    }
    job.warnings.extend(left_out);
    job.seconds.iter().for_each(|&(stage, seconds)| stopwatch.add(stage, seconds));
    let output = Output::open(folder, &job.scene.name)?;
    progress.stage("build trees", 0);
    let tracer = stopwatch.time("build trees", || Tracer::new(&job.scene));
    let plan = Plan::derive(&tracer, &job.air, &job.settings, &job.atlas, rayon::current_num_threads())?;
    super::run::tell(global, progress, &job, &plan);

    let file = File::open(&paths).map_err(|error| Failure::unreadable(&paths, &error))?;
    let solver = job.settings.lightmap_settings();
    let lightmap = stopwatch.time("fold", || {
        let open = |header: &_| PathReader::new(&paths, BufReader::new(file), header);
        kept::fold(&tracer, &job.air.media, &job.atlas, &solver, progress, open)
    })?;
    let solved = Solved { lightmap, vacuum: None, probes: None, fog_volume: None, paths: None, explanation: None };
    publish(job, &plan, solved, output, &scene_file, (progress, stopwatch))
}

impl Args {
    fn media(&self) -> Result<Vec<Medium>, Failure> {
        match (&self.fog, &self.settings) {
            (Some(Given(media)), _) => Ok(media.clone().unwrap_or_default()),
            (None, Some(file)) => settings::read(file)?.media.ok_or_else(|| {
                Failure::wrong(format!("{} states no media", file.display()), "add `media: [Medium(…)]` to it")
            }),
            (None, None) => Err(Failure::wrong(
                "the new air is not said",
                "give it with `--fog sigma_t=0.5,albedo=0.9`, or `--settings FILE` for the media of a settings file",
            )),
        }
    }

    fn output_folder(&self) -> Result<&Path, Failure> {
        let Some(folder) = &self.output else {
            return Err(Failure::wrong(
                format!("a new package does not replace {}, which holds the paths", self.package.display()),
                "name its folder with `-o DIR`",
            ));
        };
        let real = |path: &Path| path.canonicalize().ok();
        if real(folder).is_some_and(|folder| Some(folder) == real(&self.package)) {
            return Err(Failure::wrong(
                format!("{} holds the paths and is not overwritten", folder.display()),
                "name another folder with `-o DIR`",
            ));
        }
        Ok(folder)
    }

    /// The scene file.
    fn scene_file(&self, package: &Package) -> Result<PathBuf, Failure> {
        if let Some(file) = &self.scene_file {
            check_scene_file(file)?;
            return Ok(file.clone());
        }
        let source = &package.manifest.scene;
        let folder = if self.package.is_dir() { self.package.as_path() } else { package_folder(&self.package) };
        // `..` would miss the folder that a relative name like `out` stands in.
        let beside = folder.canonicalize().ok().and_then(|folder| Some(folder.parent()?.join(&source.file)));
        let places = [beside, Some(folder.join(&source.file))];
        places.into_iter().flatten().find(|file| file.is_file()).ok_or_else(|| {
            Failure::wrong(
                format!("the scene {} that was baked lies neither beside {} nor in it", source.file, folder.display()),
                "name it with `--scene-file FILE`",
            )
        })
    }
}

fn package_folder(manifest: &Path) -> &Path {
    manifest.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Name of the file of paths.
fn paths_of(package: &Package) -> Result<String, Failure> {
    let name = format!("{}.{}", package.manifest.name, kept::FILE_SUFFIX);
    if package.manifest.file(&name).is_none() {
        return Err(Failure::wrong(
            format!("the package {} holds no paths", package.manifest.name),
            "bake it with `bake run … --mode tables --keep-paths`",
        ));
    }
    Ok(name)
}

/// The settings that the package was baked with, but for the air.
fn settings_of(package: &Package, scene: &Path, media: Vec<Medium>) -> Result<Settings, Failure> {
    let mut kept: Settings = serde_json::from_value(package.manifest.settings.values.clone()).map_err(|error| {
        Failure::wrong(format!("the package's manifest states no settings of this program: {error}"), "bake again")
    })?;
    kept.media = None;
    let folder = scene.parent().unwrap_or(Path::new(""));
    fingerprint::find_files(&mut kept, folder).map_err(|missing| {
        Failure::wrong(
            format!("the file {missing} that was baked does not lie in {}, or was changed", folder.display()),
            "put it there",
        )
    })?;
    Ok(Settings {
        media: Some(media),
        mode: Mode::Tables,
        keep_paths: false,
        // Kept paths leave nothing out.
        tolerance: 0.0,
        ..kept
    })
}

/// Takes from the settings what kept paths cannot answer, with a warning of it.
fn leave_out(settings: &mut Settings) -> Option<String> {
    let asked = [
        ("probes", settings.probes.take().is_some()),
        ("fog volume", settings.fog_volume.take().is_some()),
        ("vacuum", std::mem::take(&mut settings.keep_vacuum)),
    ];
    let names: Vec<_> = asked.into_iter().filter(|(_, is_asked)| *is_asked).map(|(name, _)| name).collect();
    let again = "no paths are kept for them; `bake run` with the new air makes them";
    (!names.is_empty()).then(|| format!("the package is written without {}: {again}", names.join(", ")))
}
