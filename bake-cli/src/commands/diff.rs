//! `bake diff`: how far one package is from another.

use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use crate::output;
use bake_formats::Package;
use bake_formats::diff::{Comparison, Diff};
use bake_formats::metrics::Metrics;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Example:
  bake diff preview.bake final.bake --image error

Both must have the same pages. bias = mean(A)/mean(B) - 1; rmse = root of the mean of ((A - B)/max(B, 0.01 mean B))^2,
of Rec.709 luminance over texels that both baked.";

/// Flags of `bake diff`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The package to judge
    pub bake: PathBuf,
    /// The package to judge it by
    pub truth: PathBuf,
    /// Write false-colour images PREFIX.00.png …: red too bright, blue too dark, full at 20 %
    #[arg(long, value_name = "PREFIX")]
    pub image: Option<PathBuf>,
    /// Subtract the variance that the second package states from the total's squared error
    #[arg(long)]
    pub subtract_noise: bool,
}

/// Compares.
pub fn run(args: &Args, global: &Global) -> Result<Outcome, Failure> {
    let comparison = Comparison::open(&Package::open(&args.bake)?, &Package::open(&args.truth)?)?;
    let diff = comparison.diff(args.subtract_noise);
    if let Some(prefix) = &args.image {
        for page in 0..comparison.pages() {
            let file = PathBuf::from(format!("{}.{page:02}.png", prefix.display()));
            output::write_so(&file, &comparison.false_color(page), "choose another place with `--image`")?;
        }
    }
    if global.json {
        console::print_line(&serde_json::to_string_pretty(&diff).map_err(Failure::failed)?)?;
    } else {
        console::print(&table(&diff))?;
    }
    Ok(Outcome::Done)
}

fn table(diff: &Diff) -> String {
    let row = |name: &str, metrics: &Metrics| {
        let [bias, rmse] = [metrics.luminance.bias, metrics.luminance.relative_rmse].map(|share| 100.0 * share);
        format!("{name:<10}{bias:>11.3} %{rmse:>11.3} %\n")
    };
    let mut text = format!("{:<10}{:>13}{:>13}   {} texels\n", "", "bias", "rmse", diff.total.texels);
    text += &row("total", &diff.total);
    diff.terms.iter().for_each(|term| text += &row(term.term, &term.metrics));
    text += "\nworst texels: page, x, y, relative error of luminance, A against B (lux)\n";
    for texel in &diff.worst {
        let error = 100.0 * texel.relative_error;
        text += &format!(
            "{:>4}{:>6}{:>6}{error:>11.2} %   {} against {}\n",
            texel.page, texel.x, texel.y, texel.bake, texel.truth
        );
    }
    text
}
