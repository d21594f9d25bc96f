//! `bake view`: what was baked, in a window or as a picture.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use bake_formats::Package;
use bake_formats::package::write_atomic;
use bake_view::{
    AirArgument, CameraArgument, CompareArgument, Options, SizeArgument, TermsArgument, ViewArgument, ViewError,
};
use std::io::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  bake view room.bake
  bake view room.bake --compare other.bake
  bake view room.bake --screenshot room.png --size 1280x720 --camera 0,1.5,6:0,1.5,0:40

In the window W A S D walk, dragging with the left button turns, O changes between flying and orbiting, Tab hides the
panel (which names all keys), P saves the picture, Esc closes.

A camera is EYE:TARGET or EYE:TARGET:DEGREES, points as x,y,z in metres in the axes of the glTF file, degrees from
bottom to top. Draws on the fastest GPU, or on software Vulkan (Debian: mesa-vulkan-drivers libvulkan1);
WGPU_ADAPTER_NAME names another.";

/// Flags of `bake view`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The package's folder
    pub package: PathBuf,
    /// Write a picture to this PNG file instead of opening a window
    #[arg(long, value_name = "FILE")]
    pub screenshot: Option<PathBuf>,
    /// Print the shaders that the picture calls for, each with its effects, instead of opening a window
    #[arg(long, conflicts_with = "screenshot")]
    pub list_variants: bool,
    /// Size of the picture or window, texels
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    pub size: SizeArgument,
    /// Where the eye is and what it looks at [default: sees the whole scene]
    #[arg(long, value_name = "EYE:TARGET", allow_hyphen_values = true)]
    pub camera: Option<CameraArgument>,
    /// Stops brighter (+) or darker (-) than what suits the lightmaps
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f32,
    /// How light in the air is found: none, vacuum, lut, closed_form, quadrature or ray_march
    #[arg(long, value_name = "METHOD", default_value = "quadrature")]
    pub air: AirArgument,
    /// What the right half shows instead: another package, or another way to draw the air
    #[arg(long, value_name = "DIR|METHOD")]
    pub compare: Option<CompareArgument>,
    /// Instead of two halves their difference in false colours, the strongest at this share of what is shown white
    #[arg(long, value_name = "SHARE", requires = "compare", num_args = 0..=1, default_missing_value = "0.1")]
    pub difference: Option<f32>,
    /// Thin shapes that are placed 32 times or more, from this distance on: half are left at twice as much
    #[arg(long, value_name = "METRES")]
    pub prune: Option<f32>,
    /// Show only these terms of the light, divided by commas: direct, indirect, single, multiple
    #[arg(long, value_name = "TERMS")]
    pub terms: Option<TermsArgument>,
    /// What is shown: light, irradiance as the lightmap has it, its texels, their density, its charts, its error (white: 10 %), its validity, or a colour for each node
    #[arg(long, value_name = "WHAT", default_value = "light")]
    pub show: ViewArgument,
    /// Keep the list of the window's widgets and their places in this file, for programs that use it as a person would
    #[arg(long, value_name = "FILE", conflicts_with_all = ["screenshot", "list_variants"])]
    pub widgets: Option<PathBuf>,
}

/// Draws, or opens the window.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let package = Package::open(&args.package).map_err(super::sample::failure)?;
    let options = Options {
        size: args.size.0,
        camera: args.camera.map(|camera| camera.0),
        exposure_stops: args.exposure.clamp(-64.0, 64.0),
        air: args.air.0,
        show: args.show.0,
        terms: args.terms.clone().map(|terms| terms.0),
        compare: args.compare.clone().map(|compare| compare.0),
        prune_start_m: args.prune.map(|start| if start > 0.0 { start } else { f32::MIN_POSITIVE }),
        widgets: args.widgets.clone(),
        difference: args.difference.map(|share| if share > 0.0 { share.min(1e6) } else { 0.1 }),
    };
    if args.list_variants {
        let variants = bake_view::variants(package, &options).map_err(failure)?;
        let lines: String = variants.iter().map(|variant| format!("{variant}\n")).collect();
        console::print(&lines)?;
        return Ok(Outcome::Done);
    }
    let Some(file) = &args.screenshot else {
        bake_view::window(package, options).map_err(failure)?;
        return Ok(Outcome::Done);
    };
    let picture = bake_view::screenshot(package, &options).map_err(failure)?;
    if !global.quiet {
        picture.notes.iter().for_each(|note| console::tell(note));
    }
    write_atomic(file, |out| out.write_all(&picture.png))?;
    if global.verbose {
        console::tell(&format!("drawn by {}", picture.adapter));
    }
    Ok(Outcome::Done)
}

fn failure(error: ViewError) -> Failure {
    match error {
        ViewError::Package(error) => super::sample::failure(error),
        error => Failure::failed(error),
    }
}
