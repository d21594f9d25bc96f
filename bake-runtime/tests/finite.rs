//! Pictures of random cameras, lights and media, hard ones among them: none holds a NaN, an infinity or a negative number.
//!
//! Making a shader takes seconds where processors draw, a small picture milliseconds; what a shader holds follows from the kinds of
//! lights and media alone. So few [`Kind`]s are drawn, and many pictures of each: 500 of kinds that hold every effect; with `BAKE_LONG=1`
//! 10,000 of kinds in whose shaders every two effects meet that ever do.

mod common;
#[path = "finite/kind.rs"]
mod kind;

use std::collections::BTreeSet;

use bake_formats::glb::document::AlphaMode;
use bake_formats::manifest::EnvironmentRecord;
use bake_runtime::scene::LatticeData;
use bake_runtime::variant::{Pass, Variant};
use bake_runtime::{Headless, Model, Renderer, SceneData, Settings, shader};
use common::{Fixture, headless, radiance};
use glam::{Affine3A, Vec2, Vec3};
use kind::Kind;
use rand::SeedableRng;
use rand::rngs::SmallRng;

/// Effects of lights and air.
const EFFECTS: [&str; 30] = [
    "AIR",
    "BOUNDS_BALL",
    "BOUNDS_BOX",
    "BOUNDS_HULL",
    "BOUNDS_MESH",
    "CLOSED_FORM",
    "DENSITY_EXPONENTIAL",
    "DENSITY_GRID",
    "DENSITY_LINEAR",
    "DENSITY_PLANET",
    "FOGGED",
    "LAMPS",
    "LAMP_CONE",
    "LAMP_LEGENDRE",
    "LATTICE_AIR",
    "LAYERED",
    "LIGHTS",
    "LUT",
    "PHASE_HENYEY_GREENSTEIN",
    "PHASE_LEGENDRE",
    "PHASE_LINEAR",
    "PHASE_RAYLEIGH",
    "QUADRATURE",
    "RAY_MARCH",
    "SHADOWS",
    "SHAFTS",
    "SKY_FOGGED",
    "SOFTENED",
    "SUNS",
    "VACUUM",
];

const METHODS: [&str; 5] = ["CLOSED_FORM", "LUT", "QUADRATURE", "RAY_MARCH", "VACUUM"];

/// Effects of surfaces and of the display: `tests/surfaces.rs`, `tests/views.rs`.
const OF_SURFACES: [&str; 14] = [
    "BASE_TEXTURE",
    "BLEND",
    "EMISSION",
    "EMISSION_TEXTURE",
    "ENCODE",
    "FILMIC",
    "LIGHTMAP",
    "MASK",
    "NORMAL_MAP",
    "PROBES",
    "PRUNED",
    "SH1",
    "SKY_PICTURE",
    "SPECULAR",
];

/// Whether two effects never meet in a shader.
fn apart(a: &str, b: &str) -> bool {
    let uneven = |x: &str| x == "LAYERED" || x == "BOUNDS_MESH" || x.starts_with("DENSITY_");
    let peaked = |x: &str| x.starts_with("LAMP_") || x == "PHASE_HENYEY_GREENSTEIN";
    let another_method = |a: &str, b: &str| METHODS.contains(&b) && a != b;
    let one_way = |a: &str, b: &str| match a {
        "LUT" | "CLOSED_FORM" => another_method(a, b) || uneven(b) || peaked(b) || b == "SHAFTS",
        "SHAFTS" => another_method("QUADRATURE", b),
        "SOFTENED" => b == "VACUUM" || uneven(b),
        _ => METHODS.contains(&a) && another_method(a, b),
    };
    one_way(a, b) || one_way(b, a)
}

/// Pairs of [`EFFECTS`] in alphabetical order; an effect that is met is a pair with itself.
type Pairs = BTreeSet<[&'static str; 2]>;

/// All pairs for which `test` holds.
fn pairs(test: impl Fn(&str, &str) -> bool) -> Pairs {
    let all = EFFECTS.into_iter().flat_map(|a| EFFECTS.into_iter().map(move |b| [a, b]));
    all.filter(|&[a, b]| a <= b && test(a, b)).collect()
}

/// Pairs that meet in shaders.
fn met<'a>(variants: impl Iterator<Item = &'a Variant>) -> Pairs {
    let variants: Vec<&Variant> = variants.collect();
    pairs(|a, b| variants.iter().any(|variant| variant.has(a) && variant.has(b)))
}

/// A picture's shaders of air, wall and pane as the renderer will make them.
fn shaders(renderer: &Renderer, model: &Model, settings: &Settings, kind: &Kind) -> Vec<Variant> {
    let plan = renderer.air_plan(model, settings).expect("there is air");
    let mut wall = Variant::new(Pass::Surface);
    if !kind.dynamic.is_empty() {
        let lights = plan.variant.effects().filter(|effect| effect.starts_with("LAMP") || *effect == "SUNS");
        wall = lights.fold(wall.and(&plan.passage), |wall, effect| wall.with(effect, true));
        wall = wall.with("FOGGED", true).with("LIGHTS", true).with("SPECULAR", true);
        wall = wall.with("SOFTENED", plan.softens).with("SHADOWS", kind.shadows);
    }
    let pane = kind.pane.then(|| wall.clone().and(&plan.variant).with("AIR", true).with("BLEND", true));
    pane.into_iter().chain([wall, plan.variant]).collect()
}

/// A grey wall at z = −4, 16 m wide, that shines a little, and a pane before it.
fn base() -> SceneData {
    let mut fixture = Fixture::new([2, 2], [1.0; 3]);
    for (depth, mode, alpha) in [(-4.0, AlphaMode::Opaque, 1.0), (-3.5, AlphaMode::Blend, 0.5)] {
        let material = fixture.material(|material| {
            material.pbr_metallic_roughness.base_color_factor[3] = alpha;
            material.pbr_metallic_roughness.roughness_factor = 0.5;
            material.alpha_mode = mode;
        });
        let square = fixture.square(material);
        let map = Affine3A::from_translation(Vec3::new(0.0, 0.0, depth)) * Affine3A::from_scale(Vec3::splat(8.0));
        fixture.place(square, map, Vec2::ZERO, Vec2::ONE);
    }
    let harmonic = |index: usize| vec![if index == 0 { [2.0, 1.0, 0.5, 1.0] } else { [0.1, -0.2, 0.0, 1.0] }; 27];
    let harmonics = (0..4).map(harmonic).collect();
    let air_light =
        Some(LatticeData { origin: Vec3::splat(-5.0), spacing: Vec3::splat(5.0), count: [3, 3, 3], harmonics });
    let mean_radiance = Vec3::new(1.0, 10.0, 1e4);
    let environment = Some(EnvironmentRecord { size: [1, 1], rotation: 0.0, mean_radiance, file: None });
    SceneData { environment, air_light, ..fixture.load() }
}

/// A device, what draws on it, and the scene that the pictures' lights and media are put in.
struct Studio {
    headless: Headless,
    renderer: Renderer,
    model: Model,
    base: SceneData,
}

impl Studio {
    fn open() -> Option<Self> {
        let headless = headless()?;
        let renderer = Renderer::new(&headless.device, &headless.queue, wgpu::TextureFormat::Rgba8Unorm);
        let model = Model::new(&headless.device, &headless.queue, base()).expect("small");
        let base = model.scene.clone();
        Some(Self { headless, renderer, model, base })
    }

    /// Kinds in whose shaders all of some pairs meet: each time that of many which adds most of them for what its shaders cost.
    fn kinds(&mut self, random: &mut SmallRng, mut left: Pairs) -> Vec<Kind> {
        let mut kinds = Vec::new();
        while !left.is_empty() {
            let candidates = (0..200).map(|_| {
                let kind = Kind::random(random);
                (self.model.scene, _) = kind.scene(random, &self.base);
                let shaders = shaders(&self.renderer, &self.model, &kind.settings(random), &kind);
                let new: Pairs = met(shaders.iter()).intersection(&left).copied().collect();
                // Making a shader takes longer than in proportion to its text.
                let cost: f64 = shaders.iter().map(|variant| (shader::compose(variant).len() as f64).powf(1.5)).sum();
                (new.len() as f64 / cost, kind, new)
            });
            let (_, kind, new) = candidates.max_by(|a, b| a.0.total_cmp(&b.0)).expect("some");
            assert!(kinds.len() < 200, "these effects do not meet: {left:?}");
            left = left.difference(&new).copied().collect();
            kinds.push(kind);
        }
        kinds
    }

    /// A pixel of a small picture that is no light, if there is one.
    fn flaw(&mut self, kind: &Kind, random: &mut SmallRng, edit: impl Fn(&mut SceneData)) -> Option<String> {
        let (scene, camera) = kind.scene(random, &self.base);
        self.model.scene = scene;
        edit(&mut self.model.scene);
        let (settings, size) = (kind.settings(random), [4, 4]);
        let target = self.headless.target(size, wgpu::TextureFormat::Rgba8Unorm).create_view(&Default::default());
        self.renderer.draw(&self.model, &camera, &settings, &target, size);
        let pixels = radiance(&self.headless, &self.renderer);
        let at = pixels.iter().position(|pixel| pixel.iter().any(|v| !v.is_finite() || *v < 0.0))?;
        let SceneData { lights, dynamic_lights, media, .. } = &self.model.scene;
        let lights = (lights, dynamic_lights);
        Some(format!("pixel {at}: {:?} of {lights:?} in {media:?}, {camera:?}, {settings:?}", pixels[at]))
    }
}

/// Pairs that are drawn: in the long form all that ever meet, else each effect.
fn required(long: bool) -> Pairs {
    pairs(|a, b| !apart(a, b) && (long || a == b))
}

#[test]
fn no_picture_has_a_nan_or_an_infinity() {
    let Some(mut studio) = Studio::open() else { return };
    let long = std::env::var("BAKE_LONG").is_ok();
    let count = if long { 10_000 } else { 500 };
    let mut random = SmallRng::seed_from_u64(1);
    let kinds = studio.kinds(&mut random, required(long));
    for index in 0..count {
        let kind = &kinds[index % kinds.len()];
        if let Some(flaw) = studio.flaw(kind, &mut random, |_| ()) {
            panic!("picture {index}, {kind:?}, {flaw}");
        }
    }
    // Negative control: of every kind, lights without end show in a picture.
    let endless = |scene: &mut SceneData| {
        let lights = scene.lights.iter_mut().chain(&mut scene.dynamic_lights);
        lights.for_each(|light| light.color = Vec3::INFINITY);
    };
    let mut noticed = |kind: &Kind| (0..20).any(|_| studio.flaw(kind, &mut random, endless).is_some());
    let unnoticed: Vec<&Kind> = kinds.iter().filter(|&kind| !noticed(kind)).collect();
    assert!(unnoticed.is_empty(), "{unnoticed:?}");

    let (drawn, left_out) = (met(studio.renderer.variants()), pairs(apart));
    println!("{count} pictures of {} kinds, {} pairs of effects", kinds.len(), drawn.len());
    assert!(drawn.is_superset(&required(long)), "not drawn: {:?}", required(long).difference(&drawn));
    assert!(drawn.is_disjoint(&left_out), "drawn though apart: {:?}", drawn.intersection(&left_out));
}

/// Every effect that shaders know is one of [`EFFECTS`] or one of surfaces and views.
#[test]
fn no_effect_of_lights_or_air_is_forgotten() {
    let words = |text: &'static str| text.split(['|', '&', '!', ' ']).filter(|word| !word.is_empty());
    let marks = |line: &'static str| line.split_once("// if ").or(line.split_once("// unless ")).map(|(_, mark)| mark);
    let known = shader::MODULES.iter().flat_map(|(_, text)| text.lines().filter_map(marks).flat_map(words));
    let known: BTreeSet<&str> = known.collect();
    let forgotten =
        |word: &&&str| !EFFECTS.contains(*word) && !OF_SURFACES.contains(*word) && !word.starts_with("SHOW_");
    let forgotten: Vec<_> = known.iter().filter(forgotten).collect();
    assert!(forgotten.is_empty(), "{forgotten:?}");
    assert!(EFFECTS.iter().all(|effect| known.contains(effect) || *effect == "LIGHTS"), "{known:?}");
}
