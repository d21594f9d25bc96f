//! A plan as people read it.

use crate::units;
use bake_core::plan::Plan;
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
    for effect in &plan.effects {
        let state = if effect.on { "on " } else { "off" };
        line("effect", format!("{state} {:<24} {}", effect.name, effect.why));
    }
    let cost = &plan.cost;
    let [least, usual, most] = cost.samples;
    line(
        "samples",
        if least == most {
            format!("{most} per texel")
        } else {
            format!("{least} to {most} per texel, usually about {usual}")
        },
    );
    let [least, usual, most] = cost.seconds.map(units::seconds);
    line(
        "time",
        if least == most {
            format!("{most} on {} threads, roughly", cost.threads)
        } else {
            format!("{least} to {most}, usually about {usual}, on {} threads, roughly", cost.threads)
        },
    );
    line("memory", format!("{}, roughly", units::bytes(cost.memory_bytes)));
    text
}
