//! `bake view`: what was baked, in a window or as a picture.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::output;
use bake_formats::{FormatError, Package};
use bake_view::{
    AirArgument, CameraArgument, CompareArgument, Options, SizeArgument, TermsArgument, ViewArgument, ViewError,
};
use std::ops::RangeInclusive;
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
    #[arg(long, value_name = "FILE", value_parser = png_file)]
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
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true, value_parser = within(-64.0..=64.0))]
    pub exposure: f32,
    /// How light in the air is found: none, vacuum, lut, closed_form, quadrature or ray_march
    #[arg(long, value_name = "METHOD", default_value = "quadrature")]
    pub air: AirArgument,
    /// What the right half shows instead: another package, or another way to draw the air
    #[arg(long, value_name = "DIR|METHOD")]
    pub compare: Option<CompareArgument>,
    /// Instead of two halves their difference in false colours, the strongest at this share of what is shown white
    #[arg(long, value_name = "SHARE", requires = "compare", num_args = 0..=1, require_equals = true, default_missing_value = "0.1", value_parser = within(1e-6..=1e6))]
    pub difference: Option<f32>,
    /// Thin shapes that are placed 32 times or more, from this distance on: half are left at twice as much
    #[arg(long, value_name = "METRES", value_parser = within(0.0..=1e9))]
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
    let package = Package::open(&args.package)?;
    let options = Options {
        size: args.size.0,
        camera: args.camera.map(|camera| camera.0),
        exposure_stops: args.exposure,
        air: args.air.0,
        show: args.show.0,
        terms: args.terms.clone().map(|terms| terms.0),
        compare: args.compare.clone().map(|compare| compare.0),
        prune_start_m: args.prune.map(|start| start.max(f32::MIN_POSITIVE)),
        widgets: args.widgets.clone(),
        difference: args.difference,
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
    output::write_so(file, &picture.png, "choose another place with `--screenshot`")?;
    if global.verbose {
        console::tell(&format!("drawn by {}", picture.adapter));
    }
    Ok(Outcome::Done)
}

fn failure(error: ViewError) -> Failure {
    match error {
        // All that the window itself writes by name.
        ViewError::Package(FormatError::Io { action: "write", path, source }) => {
            Failure::unwritable_so(&path, source, "choose another place with `--widgets`")
        }
        ViewError::Package(error) => error.into(),
        error => Failure::failed(error),
    }
}

/// A number within a range.
fn within(allowed: RangeInclusive<f32>) -> impl Fn(&str) -> Result<f32, String> + Clone {
    let [low, high] = [*allowed.start(), *allowed.end()];
    let is_allowed = move |number: &f32| (low..=high).contains(number);
    move |text| text.parse().ok().filter(is_allowed).ok_or_else(|| format!("allowed is {low} to {high}"))
}

/// The name of a PNG file.
fn png_file(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    let is_png = file.extension().is_some_and(|end| end.eq_ignore_ascii_case("png"));
    if is_png { Ok(file) } else { Err("the picture is a PNG file: give it a name that ends in .png".into()) }
}
