//! A plan as people read it.

use crate::units;
use bake_core::air::{Extent, Summary};
use bake_core::plan::Plan;
use bake_core::solve::lattice::Lattice;
use std::fmt::Write;

/// The plan of the scene `name`, some ten lines.
pub fn text(name: &str, plan: &Plan) -> String {
    let mut text = String::new();
    let mut line = |name: &str, value: String| writeln!(text, "{name:<9} {value}").expect("a string takes text");
    let scene = &plan.scene;
    let size = scene.bounds[1] - scene.bounds[0];
    line(
        "scene",
        format!(
            "{name}: {} instances of {} meshes ({} lightmapped), {} triangles, {} lights, {:.1} × {:.1} × {:.1} m",
            scene.instances,
            scene.meshes,
            scene.lightmapped,
            scene.instanced_triangles,
            scene.lights,
            size.x,
            size.y,
            size.z
        ),
    );
    let atlas = &plan.atlas;
    let page = atlas.pages.first().map(|[width, height]| format!(" of {width} × {height}")).unwrap_or_default();
    line("pages", format!("{}{page}, {} texels in {} charts", atlas.pages.len(), atlas.texels, atlas.charts));
    for medium in &plan.media {
        line("medium", medium_text(medium));
    }
    if let Some(choice) = &plan.mode {
        line("mode", format!("{} ({})", choice.mode.name(), choice.why));
        line("error", expected(choice.expected_error));
    }
    for effect in &plan.effects {
        let state = if effect.on { "on " } else { "off" };
        line("effect", format!("{state} {:<31} {:<10} {}", effect.name, bound(effect.bound), effect.why));
    }
    for (name, lattice) in [("probes", &plan.lattices.probes), ("cells", &plan.lattices.fog_volume)] {
        if let Some(lattice) = lattice {
            line(name, lattice_text(lattice));
        }
    }
    let cost = &plan.cost;
    line("samples", format!("{} per texel", range(cost.samples.map(|count| count.to_string()))));
    line("time", format!("{} on {} threads, roughly", range(cost.seconds.map(units::seconds)), cost.threads));
    if let Some(kept) = &plan.kept_paths {
        let noise = match kept.noise {
            times if times > 1.0 => format!("with up to {} times the noise of a bake", number(times)),
            _ => "with no more noise than a bake".into(),
        };
        line("paths", format!("{} kept for `bake refog`: {noise}", range(kept.bytes.map(units::bytes))));
    }
    line("memory", format!("{}, roughly", units::bytes(cost.memory_bytes)));
    text
}

/// Least to most, with what is usual between them.
fn range([least, usual, most]: [String; 3]) -> String {
    if least == most { most } else { format!("{least} to {most} (usually about {usual})") }
}

/// What a mode is expected to leave of error.
fn expected(error: Option<f64>) -> String {
    match error {
        Some(0.0) => "of the air's solver none expected: noise alone".into(),
        Some(share) => format!(
            "of the air's solver about {} % expected beside noise (RMSE, measured elsewhere)",
            number(100.0 * share)
        ),
        None => "of the air's solver not known, by factors where light does not reach".into(),
    }
}

/// The most that an effect contributes, as a share of the median.
pub fn bound(bound: f64) -> String {
    match bound {
        0.0 => "-".into(),
        share if share.is_infinite() => "unbounded".into(),
        share if share >= 10.0 => format!("≤ {} ×", number(share.ceil())),
        share => format!("≤ {} %", number(100.0 * share)),
    }
}

/// A lattice in one line.
fn lattice_text(lattice: &Lattice) -> String {
    let ([x, y, z], spacing) = (lattice.count.to_array(), lattice.spacing.as_dvec3());
    let spacing = channels(spacing.to_array(), number);
    if !lattice.listed.is_empty() {
        return format!("{} points, listed, in cells of {spacing} m", lattice.points());
    }
    format!("{} points, {x} × {y} × {z} from {} m, {spacing} m apart", lattice.points(), lattice.origin)
}

/// A medium in two lines.
fn medium_text(medium: &Summary) -> String {
    let path = |path: Option<f64>| path.map_or("endless".into(), |path| format!("{} m", number(path)));
    format!(
        "{}: {}, {}, {} (g {})\n{:<9} mean free path {}, optical depth {} across the scene, albedo {}",
        medium.name,
        extent_text(&medium.bounds),
        medium.density,
        medium.phase,
        number(medium.g),
        "",
        channels(medium.mean_free_path_m, path),
        channels(medium.optical_depth, number),
        channels(medium.albedo, number)
    )
}

fn extent_text(extent: &Extent) -> String {
    let point = |p: &[f64]| p.iter().map(|&x| number(x)).collect::<Vec<_>>().join(" ");
    match extent.corners {
        None => extent.shape.into(),
        Some([min, max]) => format!("{} ({}) to ({}) m", extent.shape, point(min.as_ref()), point(max.as_ref())),
    }
}

/// One value where the channels agree, else three.
fn channels<T: PartialEq + Copy>(values: [T; 3], text: impl Fn(T) -> String) -> String {
    let [r, g, b] = values;
    if r == g && g == b { text(r) } else { values.map(text).join(" / ") }
}

/// Four digits, with an exponent only where a number is far from one.
fn number(value: f64) -> String {
    let size = value.abs();
    if value != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = if size < 1.0 { 4 } else { (3 - size.log10() as i32).max(0) as usize };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}
