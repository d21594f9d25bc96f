//! `bake diff`: how far one package is from another.

use super::sample::failure;
use crate::cli::Global;
use crate::console;
use crate::exit::{Failure, Outcome};
use bake_formats::Package;
use bake_formats::diff::{Comparison, Diff};
use bake_formats::metrics::Metrics;
use bake_formats::package::write_atomic;
use std::io::Write;
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
    let [bake, truth] = [&args.bake, &args.truth].map(|folder| Package::open(folder).map_err(failure));
    let comparison = Comparison::open(&bake?, &truth?).map_err(failure)?;
    let diff = comparison.diff(args.subtract_noise);
    if let Some(prefix) = &args.image {
        for page in 0..comparison.pages() {
            let file = PathBuf::from(format!("{}.{page:02}.png", prefix.display()));
            let png = comparison.false_color(page);
            write_atomic(&file, |out| out.write_all(&png)).map_err(failure)?;
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
