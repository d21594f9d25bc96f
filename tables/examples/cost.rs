//! What accuracy costs: `cargo run --release -p tables --example cost` writes `docs/tables.md`, `docs/tables.csv` and
//! `docs/tables.svg`.
//!
//! Errors: once-scattered light of an area in isotropic air, irradiance over all receiver normals (Parseval), RMS of the RMS, worst
//! of distances that lie between nodes and of θ = 30, 60, 85°; coefficients read linearly between distances and rounded as stored.

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use bake_formats::table_file::TableFile;
use bake_optics::harmonics::clamped_cosine;
use glam::Vec3;
use half::f16;
use tables::area::compute_exact;
use tables::curves::Grid;
use tables::fitted::{ANGLES, BANDS, Fit, harmonics};
use tables::transport::phase_basis::PhaseBasis;
use tables::{Air, Geometry, Layout, Recipe, Scatter, TableSet, set};

const BINS: [usize; 5] = [32, 64, 128, 256, 512];
const BAND_COUNTS: [usize; 7] = [3, 5, 7, 9, 11, 13, 15];
const LAYOUTS: [Layout; 3] = [Layout::Harmonic, Layout::Paper, Layout::PaperIrradiance];
const THETAS: [f64; 3] = [30.0, 60.0, 85.0];
/// Places between 0.02 and 10, in the middle between nodes of every grid.
const DISTANCES: [f64; 4] = [0.03, 0.2, 1.0, 5.0];
const FINEST: usize = 20;

type Coefficients = Vec<((usize, usize), f64)>;

struct Line {
    layout: Layout,
    bins: usize,
    bands: usize,
    half: bool,
    bytes: usize,
    error: f64,
    look_up_ns: f64,
}

/// (l, m) that irradiance sees, l below `bands`.
fn visible(bands: usize) -> Vec<(usize, usize)> {
    (0..bands).filter(|l| *l == 1 || l % 2 == 0).flat_map(|l| (0..=l).map(move |m| (l, m))).collect()
}

fn exact(d: f64, theta: f64, list: &[(usize, usize)]) -> Vec<f64> {
    compute_exact(d, theta, &PhaseBasis::Legendre(1), list, 32).remove(0)
}

/// One node of a table: coefficients, or zonal ones and the sine of the tilt.
fn node(layout: Layout, d: f64, theta: f64) -> Vec<f64> {
    match layout.criterion() {
        None => exact(d, theta, &visible(BAND_COUNTS[6])),
        Some(criterion) => {
            let fit = Fit::new(&exact(d, theta, &harmonics()), criterion);
            fit.zonal.into_iter().chain([fit.tilt.sin()]).collect()
        }
    }
}

/// The function that a node's values stand for, bands below `bands` only.
fn function(layout: Layout, values: &[f64], bands: usize) -> Coefficients {
    let all: Coefficients = match layout.criterion() {
        None => visible(BAND_COUNTS[6]).into_iter().zip(values.iter().copied()).collect(),
        Some(_) => {
            let fit = Fit { tilt: values[BANDS].asin(), zonal: std::array::from_fn(|l| values[l]) };
            harmonics().into_iter().zip(fit.expand()).collect()
        }
    };
    all.into_iter().filter(|&((l, _), _)| l < bands).collect()
}

fn error(got: &Coefficients, want: &[f64]) -> f64 {
    let cosine = clamped_cosine::<f64>(FINEST + 1);
    let (mut error, mut all) = (0.0, 0.0);
    for (pair, want) in visible(FINEST + 1).into_iter().zip(want) {
        let got = got.iter().find(|(key, _)| *key == pair).map_or(0.0, |(_, v)| *v);
        error += (cosine[pair.0] * (got - want)).powi(2);
        all += (cosine[pair.0] * want).powi(2);
    }
    (error / all).sqrt()
}

fn stored_values(layout: Layout, bands: usize) -> usize {
    match layout.criterion() {
        None => Recipe::default().angles.nodes * visible(bands).len(),
        Some(_) => ANGLES * (bands + 1),
    }
}

/// All lines of a layout and number of bins.
fn lines(layout: Layout, bins: usize, look_up_ns: f64) -> Vec<Line> {
    let grid = Grid { bins, ..Grid::default() };
    let mut worst = [[0.0f64; BAND_COUNTS.len()]; 2];
    for (near, theta) in DISTANCES.iter().flat_map(|d| THETAS.iter().map(move |t| (*d, t.to_radians()))) {
        let low = grid.index(near).floor();
        let d = grid.distance(low + 0.5);
        let want = exact(d, theta, &visible(FINEST + 1));
        let nodes = [low, low + 1.0].map(|i| node(layout, grid.distance(i), theta));
        for (half, worst) in [false, true].into_iter().zip(&mut worst) {
            let round = |v: f64| if half { f64::from(f16::from_f64(v * 1024.0)) / 1024.0 } else { v };
            let read: Vec<f64> = nodes[0].iter().zip(&nodes[1]).map(|(&a, &b)| 0.5 * (round(a) + round(b))).collect();
            for (slot, bands) in worst.iter_mut().zip(BAND_COUNTS) {
                *slot = slot.max(error(&function(layout, &read, bands), &want));
            }
        }
    }
    let line = |half: usize, i: usize| Line {
        layout,
        bins,
        bands: BAND_COUNTS[i],
        half: half == 1,
        bytes: (bins + 2) * stored_values(layout, BAND_COUNTS[i]) * if half == 1 { 2 } else { 4 },
        error: worst[half][i],
        look_up_ns,
    };
    let fitting = BAND_COUNTS.iter().filter(|&&bands| layout == Layout::Harmonic || bands <= BANDS).count();
    (0..2).flat_map(|half| (0..fitting).map(move |i| (half, i))).map(|(half, i)| line(half, i)).collect()
}

/// A file read with another number of nodes.
fn read_with(file: &TableFile, bins: usize) -> TableSet {
    let mut file = file.clone();
    file.manifest.recipe["read_bins"] = bins.into();
    TableSet::from_file(&file).expect("a recipe that is allowed")
}

/// Nanoseconds of one irradiance for three channels, the fastest of many rounds.
fn time(mut look_up: impl FnMut(f32, Vec3, Vec3, Vec3) -> f32) -> f64 {
    let point =
        |i: usize| Vec3::new((i as f32).sin(), (1.7 * i as f32).cos(), (0.3 * i as f32).sin() + 0.1).normalize();
    let places: Vec<_> = (0..2000)
        .map(|i| (0.01 * 1000f32.powf((i as f32 * 0.618_034).fract()), point(i), point(3 * i + 1), point(7 * i + 2)))
        .collect();
    let round = |_| {
        let start = Instant::now();
        let sum: f32 = places.iter().map(|&(d, n, a, e)| look_up(d, n, a, e)).sum();
        black_box(sum);
        start.elapsed().as_nanos() as f64 / places.len() as f64
    };
    (0..400).map(round).fold(f64::INFINITY, f64::min)
}

fn look_up_ns(layout: Layout, file: &TableFile, bins: usize) -> f64 {
    let set = read_with(file, bins);
    let airs = [1.0, 0.9, 0.8].map(Air::isotropic);
    let sigma = [0.5, 1.0, 2.0];
    if layout == Layout::Harmonic {
        let rgb = set.area_rgb(&airs, Scatter::Single);
        return time(|d, n, a, e| rgb.irradiance(sigma, d, &Geometry::new(n, a, e)).iter().sum());
    }
    let rgb = airs.map(|air| set.fitted_area(&air).expect("this layout has an axis"));
    time(|d, n, a, e| rgb.iter().zip(sigma).map(|(r, sigma)| r.irradiance(sigma, d, n, a, e)).sum())
}

fn name(layout: Layout) -> &'static str {
    match layout {
        Layout::Harmonic => "harmonic",
        Layout::Paper => "paper",
        Layout::PaperIrradiance => "paper-irradiance",
    }
}

fn csv(lines: &[Line]) -> String {
    let mut text = "layout,bins,bands,precision,bytes,rms_error,look_up_ns\n".to_owned();
    for l in lines {
        let precision = if l.half { "f16" } else { "f32" };
        let (layout, bins, bands, bytes) = (name(l.layout), l.bins, l.bands, l.bytes);
        let _ = writeln!(text, "{layout},{bins},{bands},{precision},{bytes},{:.3e},{:.1}", l.error, l.look_up_ns);
    }
    text
}

/// Error against size, both logarithmic; one colour a layout, hollow for f16.
fn svg(lines: &[Line]) -> String {
    let x = |bytes: usize| 60.0 + 110.0 * ((bytes as f64).log10() - 3.0);
    let y = |error: f64| 30.0 + 130.0 * -error.log10();
    let mut text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"620\" height=\"460\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n".to_owned();
    for decade in 3..8 {
        let at = x(10usize.pow(decade));
        let _ = writeln!(
            text,
            r##"<path d="M{at} 30V420" stroke="#ddd"/><text x="{at}" y="436" text-anchor="middle">1e{decade} bytes</text>"##
        );
    }
    for decade in 0..4 {
        let at = y(10f64.powi(-decade));
        let _ = writeln!(
            text,
            r##"<path d="M60 {at}H600" stroke="#ddd"/><text x="54" y="{at}" text-anchor="end">1e-{decade}</text>"##
        );
    }
    for l in lines {
        let colour = ["#1b6", "#c33", "#38c"][LAYOUTS.iter().position(|&k| k == l.layout).unwrap_or(0)];
        let fill = if l.half { "none" } else { colour };
        let _ = writeln!(
            text,
            r#"<circle cx="{:.1}" cy="{:.1}" r="4" stroke="{colour}" fill="{fill}"><title>{} {} bins {} bands</title></circle>"#,
            x(l.bytes),
            y(l.error),
            name(l.layout),
            l.bins,
            l.bands
        );
    }
    text.push_str("<text x=\"60\" y=\"18\">RMS error of irradiance against size: harmonic green, paper red, paper-irradiance blue; f16 hollow</text>\n</svg>\n");
    text
}

fn page(lines: &[Line]) -> String {
    let mut text = include_str!("cost.md").to_owned();
    text.push_str("\n| layout | bins | bands | precision | bytes | RMS error | RGB look-up, ns |\n|---|---|---|---|---|---|---|\n");
    for l in lines.iter().filter(|l| [5, 11].contains(&l.bands) && [32, 128, 512].contains(&l.bins)) {
        let precision = if l.half { "f16" } else { "f32" };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {precision} | {} | {:.2} % | {:.0} |",
            name(l.layout),
            l.bins,
            l.bands,
            l.bytes,
            100.0 * l.error,
            l.look_up_ns
        );
    }
    text
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shipped = TableFile::from_bytes(set::embedded_bytes(), "embedded tables")?;
    let recipe = Recipe {
        layout: Layout::Paper,
        grid: Grid { bins: 16, ..Grid::default() },
        scatter_orders: 2,
        ..Recipe::default()
    };
    let paper = tables::generate::to_file(&recipe, &tables::generate::compute_tables(&recipe, &|_, _| ()));
    let mut all = Vec::new();
    for (layout, bins) in LAYOUTS.into_iter().flat_map(|layout| BINS.map(|bins| (layout, bins))) {
        let file = if layout == Layout::Harmonic { &shipped } else { &paper };
        all.extend(lines(layout, bins, look_up_ns(layout, file, bins)));
        eprintln!("{} {bins}", name(layout));
    }
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    std::fs::write(docs.join("tables.csv"), csv(&all))?;
    std::fs::write(docs.join("tables.svg"), svg(&all))?;
    std::fs::write(docs.join("tables.md"), page(&all))?;
    Ok(())
}
