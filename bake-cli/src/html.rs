//! `NAME.report.html`: plan, seconds, error, warnings and page thumbnails of one bake, in one file that needs no network.

use crate::exit::Failure;
use crate::output::write_beside;
use crate::report::Measured;
use bake_core::package::thumbnail;
use bake_core::plan::Plan;
use bake_core::solve::buffers::PageBuffers;
use base64::Engine;
use std::fmt::Write;

/// Longest side of a thumbnail, texels.
const THUMBNAIL: u32 = 512;

const STYLE: &str = "\
:root{color-scheme:light dark;--bar:#3b82c4;--line:#8886}
body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}
table{border-collapse:collapse;width:100%}td,th{text-align:left;padding:.2rem .6rem;border-bottom:1px solid var(--line)}
td.number{text-align:right;font-variant-numeric:tabular-nums}.bar{background:var(--bar);height:.8em}
.off{opacity:.55}figure{display:inline-block;margin:0 1rem 1rem 0;vertical-align:top}img{image-rendering:pixelated;max-width:100%}
pre{white-space:pre-wrap}@media (prefers-color-scheme:dark){body{background:#181818;color:#ddd}}
@media print{body{max-width:none;background:#fff;color:#000}.bar{print-color-adjust:exact}tr,figure{break-inside:avoid}}";

/// Writes the report beside the manifest.
pub fn write(measured: &Measured, name: &str, plan: &Plan, pages: &[PageBuffers]) -> Result<(), Failure> {
    write_beside(&measured.package, "report.html", page(measured, name, plan, pages).as_bytes())
}

fn page(measured: &Measured, name: &str, plan: &Plan, pages: &[PageBuffers]) -> String {
    let name = escape(name);
    format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{name}: bake</title><style>{STYLE}</style>\
         <h1>{name}</h1><pre>{summary}</pre>{warnings}<h2>Where the seconds went</h2>{stages}<h2>Effects</h2>{effects}{explained}\
         <h2>Pages</h2>{pages}</html>\n",
        summary = escape(&measured.table()),
        warnings = warnings(&measured.warnings),
        stages = stages(measured),
        effects = effects(plan),
        explained = explained(measured),
        pages = thumbnails(measured, pages),
    )
}

fn warnings(warnings: &[String]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let items: String = warnings.iter().map(|warning| format!("<li>{}</li>", escape(warning))).collect();
    format!("<h2>Warnings</h2><ul>{items}</ul>")
}

fn stages(measured: &Measured) -> String {
    let rows: String = measured
        .stages
        .iter()
        .map(|stage| {
            let share = 100.0 * stage.seconds / measured.seconds.max(1e-9);
            let (name, seconds) = (escape(stage.name), stage.seconds);
            format!(
                "<tr><td>{name}</td><td class=\"number\">{seconds:.2} s</td><td class=\"number\">{share:.1} %</td>\
                 <td style=\"width:50%\"><div class=\"bar\" style=\"width:{share:.2}%\"></div></td></tr>"
            )
        })
        .collect();
    format!("<table>{rows}</table>")
}

fn effects(plan: &Plan) -> String {
    let rows: String = plan
        .effects
        .iter()
        .map(|effect| {
            let (class, state) = if effect.on { ("on", "on") } else { ("off", "off") };
            format!(
                "<tr class=\"{class}\"><td>{}</td><td>{state}</td><td>{}</td><td>{}</td></tr>",
                escape(effect.name),
                escape(&crate::plan_text::bound(effect.bound)),
                escape(&effect.why)
            )
        })
        .collect();
    format!("<table>{rows}</table>")
}

/// What was left out, and what the rest cost and changed.
fn explained(measured: &Measured) -> String {
    let text = crate::explain_text::text(measured);
    if text.is_empty() { text } else { format!("<h2>What each effect did</h2><pre>{}</pre>", escape(&text)) }
}

fn thumbnails(measured: &Measured, pages: &[PageBuffers]) -> String {
    let mut html = String::new();
    for (index, (page, told)) in pages.iter().zip(&measured.pages).enumerate() {
        let png = base64::engine::general_purpose::STANDARD.encode(thumbnail(page, THUMBNAIL));
        write!(
            html,
            "<figure><img alt=\"page {index}\" src=\"data:image/png;base64,{png}\"><figcaption>page {index}: {} × {}, \
             {} samples per texel, error {:.2} % ({:.1} % in the noisiest hundredth), median {:.4} lux, {} texels, {} buried</figcaption></figure>",
            page.width,
            page.height,
            told.samples_per_texel,
            100.0 * told.error,
            100.0 * told.noisiest,
            told.median_lux,
            told.good_texels,
            told.buried_texels
        )
        .expect("a string takes text");
    }
    html
}

/// Text as HTML shows it.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_from_files_cannot_become_markup() {
        assert_eq!(escape("<img src=\"x\">&"), "&lt;img src=&quot;x&quot;&gt;&amp;");
    }
}
