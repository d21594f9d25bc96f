//! From modules in `shaders/` to the text of one shader that holds only what its variant calls for.
//!
//! A module's first lines may say `// uses: a, b`; those modules come before it, each once. A line that ends with `// if X`
//! stays only where effect X is on, one with `// unless X` only where it is off; `A|B` is either, `A&B` both, `!A` its absence. Each file is thus plain WGSL.
//! Shared structs ([`crate::layout`]), constants of the variant and quadrature rules are generated in front.

use std::collections::BTreeSet;
use std::fmt::Write;

use bake_optics::quadrature::GaussLegendre;

use crate::layout::SHARED;
use crate::variant::Variant;

/// Nodes of a panel of a planet's air: twelve leave f32's own error (`bake_optics::medium::planet`).
const ORBIT_RULE: u32 = 12;

macro_rules! modules {
    ($($name:literal),* $(,)?) => {
        /// Every module: name and text.
        pub const MODULES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../shaders/", $name, ".wgsl"))),)*];
    };
}

modules![
    "air",
    "air_layered",
    "air_uniform",
    "airlight_closed_form",
    "airlight_lut",
    "airlight_quadrature",
    "airlight_ray_march",
    "airlight_sun",
    "airlight_vacuum",
    "arithmetic",
    "base_texture",
    "caster",
    "coefficients",
    "cone",
    "cuts",
    "density",
    "density_grid",
    "difference",
    "display",
    "emission_texture",
    "emitter",
    "exponential_integral",
    "frame",
    "hashed_color",
    "hull",
    "inscatter",
    "lamp_sight",
    "lamps",
    "lattice",
    "lattice_inscatter",
    "legendre",
    "lightmap",
    "lights",
    "medium",
    "mesh",
    "mesh_cuts",
    "moments",
    "normal_map",
    "panel",
    "palette",
    "phase",
    "pick",
    "pieces",
    "placed",
    "planet",
    "probes",
    "pruning",
    "screen",
    "sh1",
    "shadow",
    "shadow_border",
    "shafts",
    "sight",
    "sky",
    "sky_picture",
    "softened",
    "sun_march",
    "sun_shafts",
    "surface",
    "texel_pattern",
    "texture_map",
    "tone",
    "twofold",
    "view_ray",
];

/// Text of a module. Panics on an unknown name: names come from the modules themselves and from [`Variant`].
pub fn module(name: &str) -> &'static str {
    let found = MODULES.iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("no shader module '{name}'")).1
}

/// The shader of a variant.
pub fn compose(variant: &Variant) -> String {
    compose_with(variant, &variant.roots(), "")
}

/// Modules of a variant's effects with text of one's own behind them: how tests call single functions.
pub fn compose_with(variant: &Variant, roots: &[&'static str], tail: &str) -> String {
    let mut text = String::new();
    let mut done = BTreeSet::new();
    for root in roots {
        add(root, variant, &mut done, &mut text);
    }
    text += tail;
    prelude(variant, &text) + &text
}

/// Shared structs that are named in `body`, constants, rules.
fn prelude(variant: &Variant, body: &str) -> String {
    let mut text = String::from("const PI = 3.14159265358979;\n");
    for (name, value) in variant.constants() {
        let _ = writeln!(text, "const {name} = {value}u;");
    }
    if body.contains("RULE_NODES") {
        text += &rule("RULE", variant.nodes());
    }
    if body.contains("ORBIT_NODES") {
        text += &rule("ORBIT", ORBIT_RULE);
    }
    if body.contains("PALETTE") {
        text += &variant.palette().declaration();
    }
    for shared in SHARED.iter().filter(|shared| names(body, shared.name)) {
        text += shared.wgsl;
    }
    text
}

/// A Gauss–Legendre rule on (0, 1) as constant arrays `NAME_NODES`, `NAME_WEIGHTS`; digits that give the same f32 back.
pub fn rule(name: &str, count: u32) -> String {
    let rule = GaussLegendre::<f32>::new(count as usize);
    let list = |values: Vec<f32>| values.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join(", ");
    let (nodes, weights): (Vec<f32>, Vec<f32>) = rule.nodes().iter().copied().unzip();
    let (nodes, weights) = (list(nodes), list(weights));
    format!(
        "const {name}_COUNT = {count}u;\nvar<private> {name}_NODES: array<f32, {count}> = array<f32, {count}>({nodes});\n\
         var<private> {name}_WEIGHTS: array<f32, {count}> = array<f32, {count}>({weights});\n"
    )
}

/// Whether `body` uses a name as a whole word.
fn names(body: &str, name: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    body.match_indices(name).any(|(at, _)| {
        !body[..at].chars().next_back().is_some_and(word) && !body[at + name.len()..].chars().next().is_some_and(word)
    })
}

fn add(name: &'static str, variant: &Variant, done: &mut BTreeSet<&'static str>, text: &mut String) {
    if !done.insert(name) {
        return;
    }
    let source = module(name);
    for used in uses(source, variant) {
        add(used, variant, done, text);
    }
    source.lines().filter_map(|line| keep(line, variant)).for_each(|line| {
        text.push_str(line);
        text.push('\n');
    });
}

/// Modules that a module builds on.
fn uses(source: &'static str, variant: &Variant) -> Vec<&'static str> {
    let lines = source.lines().filter_map(|line| keep(line, variant));
    let lists = lines.filter_map(|line| line.strip_prefix("// uses: "));
    lists.flat_map(|list| list.split(',').map(str::trim)).collect()
}

/// The line without its mark, if the variant calls for it; comments go.
fn keep(line: &'static str, variant: &Variant) -> Option<&'static str> {
    let (body, on) = if let Some((body, condition)) = line.rsplit_once("// if ") {
        (body, holds(condition, variant))
    } else if let Some((body, condition)) = line.rsplit_once("// unless ") {
        (body, !holds(condition, variant))
    } else {
        (line, true)
    };
    let comment = body.trim_start().starts_with("//") && !body.starts_with("// uses: ");
    (on && !comment).then(|| body.trim_end())
}

fn holds(condition: &str, variant: &Variant) -> bool {
    let one = |name: &str| match name.strip_prefix('!') {
        Some(name) => !variant.has(name),
        None => variant.has(name),
    };
    let all = |part: &str| part.split('&').all(|name| one(name.trim()));
    condition.split('|').any(all)
}
