//! The page `study.html`: one file that needs no network, with plots, tables and pictures.

use crate::measure::Errors;
use crate::pareto;
use crate::plot::{Line, Mark, Plot};
use crate::store::{Row, Store};
use crate::summary::{LEVELS, Summary, floor, percent};
use crate::sweep::{Group, Kind, Series};
use crate::thumbnails;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = "\
:root{color-scheme:light dark;--line:#8886;--bad:#c0392b}\
body{font:15px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem}\
table{border-collapse:collapse;margin:.5rem 0 1rem}td,th{text-align:left;padding:.15rem .7rem;border-bottom:1px solid var(--line)}\
.n{text-align:right;font-variant-numeric:tabular-nums}.bad{color:var(--bad);font-weight:600}\
pre{white-space:pre-wrap}figure{display:inline-block;margin:0 1rem 1rem 0;vertical-align:top;font-size:12px;max-width:400px}\
figure img{image-rendering:pixelated;width:190px;background:#000}details{margin:.5rem 0 2rem}summary{cursor:pointer}\
@media (prefers-color-scheme:dark){:root{--bad:#ff7b6b}body{background:#181818;color:#ddd}}\
@media print{body{max-width:none;background:#fff;color:#000}section,figure,tr{break-inside:avoid}figure img{width:145px}\
details::details-content{content-visibility:visible;display:block}}";

/// How to read [`crate::reach::Reach`].
pub const REACH: &str = "\
A time with ~ was not measured: more samples are expected to take it, by the noise, which falls as one over the root of time, \
and the floor, which stays. With ≥ the floor is too small to be told from chance, so it may be more; \
never: the floor is above.";

/// Error of the tables by size.
const RECORDED: &str = include_str!("../../docs/tables.csv");

/// The whole page.
pub fn page(summary: &Summary, groups: &[Group], store: &Store) -> String {
    frame(
        &format!("{}: what accuracy costs", summary.scene),
        html! {
            pre { (summary.text()) }
            p {
                "RMSE and bias are relative, of Rec.709 luminance, over baked texels, against the reference, whose variance is taken off. "
                "Noise is what the bake's own variance tells of it; the floor is the rest of the RMSE, which samples do not take away. "
                "Filled points lie on the Pareto front. Times leave out loading and layout."
            }
            (modes(summary))
            (controls(summary))
            @for group in groups.iter() { (section(group, store)) }
        },
    )
}

/// A page with the study's looks.
pub fn frame(title: &str, body: Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { h1 { (title) } (body) }
        }
    };
    page.into_string()
}

fn modes(summary: &Summary) -> Markup {
    html! {
        h2 { "Each mode" }
        p { (REACH) }
        table {
            tr {
                th { "mode" }
                @for level in LEVELS { th.n { "seconds to " (100.0 * level) " %" } }
                th.n { "floor" } th.n { "bias" } th.n { "over no air" } th.n { "at fewest samples" }
            }
            @for mode in &summary.modes {
                tr {
                    td { (mode.name) }
                    @for reach in &mode.seconds_to { td.n { (reach) } }
                    td.n { (floor(&mode.errors)) }
                    (bias(&mode.errors))
                    @for overhead in [mode.overhead, mode.overhead_at_fewest] {
                        td.n { (overhead.map_or("–".into(), |share| format!("{:+.0} %", 100.0 * share))) }
                    }
                }
            }
        }
    }
}

fn controls(summary: &Summary) -> Markup {
    html! {
        @if !summary.controls_hold() {
            p.bad { "A setting that is wrong on purpose was not told from an honest one: do not trust this study." }
        }
    }
}

/// Bias with its standard error, marked where it is no chance.
fn bias(errors: &Errors) -> Markup {
    let class = if errors.is_biased() { "n bad" } else { "n" };
    html! { td class=(class) { (format!("{:+.2} ± {:.2} %", 100.0 * errors.bias, 100.0 * errors.bias_error)) } }
}

fn section(group: &Group, store: &Store) -> Markup {
    let [title, text] = group.kind.text();
    html! {
        section {
            h2 { (title) }
            p { (prose(text)) }
            (plot(group, store).svg())
            (named(group, store))
            @if group.kind == Kind::Tables { (bands()) }
        }
        details {
            summary { "All numbers and pictures" }
            (table(group, store))
            @for series in &group.series { (pictures(series, store)) }
        }
    }
}

/// Text with what stands between backticks as code.
fn prose(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() { @if index % 2 == 1 { code { (part) } } @else { (part) } }
    }
}

/// What an area would gain by harmonics beyond its fourteen, as it is recorded.
fn bands() -> Markup {
    // Layout, distances, bands, precision, bytes, error, nanoseconds.
    let lines = RECORDED.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let shipped = lines.filter(|line| line[..2] == ["harmonic", "256"] && line[3] == "f16");
    html! {
        p {
            "What all harmonics of an area would gain: the tables alone, irradiance over all receivers, "
            "RMS, as recorded in " code { "docs/tables.csv" } " by " code { "cargo run --release -p tables --example cost" } ":"
        }
        table {
            tr { th.n { "bands" } th.n { "bytes" } th.n { "error" } }
            @for line in shipped {
                tr { td.n { (line[2]) } td.n { (line[4]) } td.n { (percent(line[5].parse().unwrap_or(f64::NAN))) } }
            }
        }
    }
}

/// Error against seconds.
pub fn plot(group: &Group, store: &Store) -> Plot {
    let mark = |(label, point): &(String, _)| {
        let row = store.row(point)?;
        let [bias, bias_error, rmse] = [row.bias, row.bias_error, row.rmse].map(|share| 100.0 * share);
        let title = format!("{label}: {:.3} s, RMSE {rmse:.3} %, bias {bias:+.3} ± {bias_error:.3} %", row.seconds);
        Some(Mark { at: (row.seconds, rmse), title })
    };
    let line =
        |series: &Series| Line { name: series.name.clone(), marks: series.points.iter().filter_map(mark).collect() };
    let lines: Vec<Line> = group.series.iter().map(line).collect();
    let points: Vec<(f64, f64)> = lines.iter().flat_map(|line| line.marks.iter().map(|mark| mark.at)).collect();
    Plot {
        title: group.kind.text()[0].into(),
        axes: ["seconds", "relative RMSE, %"],
        even: false,
        front: pareto::front(&points).into_iter().map(|at| points[at]).collect(),
        levels: LEVELS.map(|level| (100.0 * level, format!("{} %", 100.0 * level))).into(),
        lines,
    }
}

/// The cheapest setting of a group for each level.
fn named(group: &Group, store: &Store) -> Markup {
    if group.kind == Kind::Control {
        return html! {};
    }
    let rows: Vec<(&str, &Row)> = rows(group, store).collect();
    let points: Vec<(f64, f64)> = rows.iter().map(|(_, row)| (row.seconds, row.rmse)).collect();
    let found = LEVELS.map(|level| {
        let best = pareto::cheapest(&points, level).map(|at| format!("{} ({:.2} s)", rows[at].0, rows[at].1.seconds));
        (level, best.unwrap_or_else(|| "not reached".into()))
    });
    html! {
        p { "Cheapest for " @for (index, (level, best)) in found.iter().enumerate() { @if index > 0 { "; " } b { (100.0 * level) " %" } ": " (best) } "." }
    }
}

fn rows<'a>(group: &'a Group, store: &'a Store) -> impl Iterator<Item = (&'a str, &'a Row)> {
    let points = group.series.iter().flat_map(|series| &series.points);
    points.filter_map(|(label, point)| Some((label.as_str(), store.row(point)?)))
}

fn table(group: &Group, store: &Store) -> Markup {
    html! {
        table {
            tr {
                th { "setting" } th.n { "seconds" } th.n { "spread" } th.n { "samples" }
                @if group.kind == Kind::Target { th.n { "asked" } th.n { "stated" } }
                th.n { "RMSE" } th.n { "bias" } th.n { "noise" } th.n { "floor" }
            }
            @for (label, row) in rows(group, store) {
                tr {
                    td { (label) }
                    td.n { (format!("{:.3}", row.seconds)) }
                    td.n { @if row.seconds_spread > 0.0 { (percent(row.seconds_spread)) } }
                    td.n { (row.samples) }
                    @if group.kind == Kind::Target {
                        td.n { (row.target.map_or(String::new(), |target| percent(target.into()))) }
                        td.n { (percent(row.stated_error.into())) }
                    }
                    td.n { (percent(row.rmse)) }
                    (bias(&row.errors()))
                    td.n { (percent(row.noise)) }
                    td.n { (floor(&row.errors())) }
                }
            }
        }
    }
}

/// Each point's page, and where it is too bright (red) or too dark (blue).
fn pictures(series: &Series, store: &Store) -> Markup {
    html! {
        @for (label, point) in &series.points {
            @if let Some([picture, error]) = thumbnails::embedded(store, &store.key(point)) {
                figure {
                    img src=(picture) alt=(format!("first page, {label}"));
                    " "
                    img src=(error) alt=(format!("its error: red too bright, blue too dark, full at 20 %"));
                    figcaption { (label) }
                }
            }
        }
    }
}
