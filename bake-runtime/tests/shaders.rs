//! Every shader without a device: all variants parse and validate, shared structs lie where Rust says, and what a variant does
//! not call for is not in it.

use bake_formats::manifest::{LightKind, LightRecord, ProfileRecord};
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::mesh::ClosedMesh;
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;
use bake_runtime::air::{AirPlan, AirSettings, Method};
use bake_runtime::layout::SHARED;
use bake_runtime::shader::{self, MODULES};
use bake_runtime::variant::{Pass, Variant};
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;

/// Parses and validates as a device would.
fn validate(text: &str) -> Result<naga::Module, String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator.validate(&module).map_err(|error| error.emit_to_string(text))?;
    Ok(module)
}

fn lights() -> Vec<LightRecord> {
    let light = |kind| LightRecord { path: "lamp".into(), color: Vec3::ONE, kind };
    let profile = || Some(ProfileRecord { axis: Vec3::NEG_Y, legendre: vec![1.0, 0.5] });
    let (position, direction, radius, range) = (Vec3::ZERO, Vec3::NEG_Y, 0.01, None);
    vec![
        light(LightKind::Point { position, radius, range, profile: None }),
        light(LightKind::Point { position, radius, range, profile: profile() }),
        light(LightKind::Spot {
            position,
            direction,
            inner_angle: 0.2,
            outer_angle: 0.4,
            radius,
            range,
            profile: None,
        }),
        light(LightKind::Directional { direction, angular_radius: 0.0 }),
    ]
}

fn media() -> Vec<Medium> {
    let scatter = Scatter { sigma_s: [0.1; 3], sigma_a: [0.0; 3] };
    let block = Bounds::Box { min: DVec3::splat(-5.0), max: DVec3::splat(5.0) };
    let ball = Bounds::Sphere { centre: DVec3::ZERO, radius: 5.0 };
    let exponential = Density::Exponential { base_m: 0.0, scale_height_m: 10.0 };
    let grid = DensityGrid::new(glam::IVec3::splat(2), vec![1.0; 8], glam::DAffine3::IDENTITY).expect("valid");
    let planet = Density::Planet { centre: DVec3::NEG_Y * 6e6, radius_m: 6e6, scale_height_m: 8e3 };
    let hull = Bounds::Hull([glam::DVec4::new(0.0, 1.0, 0.0, 2.0)].into());
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mesh = ClosedMesh::new(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).expect("closed");
    let mesh = Bounds::Mesh(std::sync::Arc::new(mesh));
    let linear = Density::Linear { zero_m: 0.0, slope_per_m: -0.1 };
    let medium = |bounds, density, phase| Medium { bounds, density, scatter, phase };
    vec![
        medium(block.clone(), Density::Uniform, Phase::Isotropic),
        medium(block.clone(), Density::Uniform, Phase::HenyeyGreenstein { g: 0.8 }),
        medium(ball, Density::Uniform, Phase::Rayleigh),
        medium(Bounds::Unbounded, exponential, Phase::Linear { a1: 0.5 }),
        medium(hull, Density::Uniform, Phase::Isotropic),
        medium(Bounds::Unbounded, planet, Phase::Rayleigh),
        medium(Bounds::Unbounded, Density::Grid(std::sync::Arc::new(grid)), Phase::Isotropic),
        medium(block, linear, Phase::Legendre(vec![1.0, 0.5, 0.1])),
        medium(mesh, Density::Uniform, Phase::Isotropic),
    ]
}

/// The plans of every method over every single medium, all of them at once, every single lamp and all of them.
fn air_plans() -> BTreeSet<(Method, Variant)> {
    let (lights, media) = (lights(), media());
    let light_sets: Vec<Vec<&LightRecord>> =
        lights.iter().map(|light| vec![light]).chain([lights.iter().collect(), vec![]]).collect();
    let media_sets: Vec<Vec<Medium>> = media.iter().map(|medium| vec![medium.clone()]).chain([media.clone()]).collect();
    let mut plans = BTreeSet::new();
    for method in Method::ALL {
        for lights in &light_sets {
            for media in &media_sets {
                let settings = AirSettings { method, ..AirSettings::default() };
                for shadows in [false, true] {
                    let plan = AirPlan::shadowed(settings, media, lights, shadows);
                    plans.extend(plan.map(|plan| (plan.method, plan.variant.with("LATTICE_AIR", shadows))));
                }
            }
        }
    }
    plans
}

/// Surface variants: every set of effects that a material and a page can have.
fn surface_variants() -> Vec<Variant> {
    let effects = ["LIGHTMAP", "BASE_TEXTURE", "EMISSION", "EMISSION_TEXTURE", "MASK", "BLEND"];
    let variant = |bits: u32| {
        effects.iter().enumerate().fold(Variant::new(Pass::Surface), |v, (i, e)| v.with(e, bits >> i & 1 == 1))
    };
    let sensible =
        |v: &Variant| (v.has("EMISSION") || !v.has("EMISSION_TEXTURE")) && (!v.has("MASK") || !v.has("BLEND"));
    (0..1 << effects.len()).map(variant).filter(sensible).collect()
}

/// Surfaces lit by what was not baked: probes, lamps and suns, with shadows, through air that weakens and softens, and views.
fn lit_variants() -> Vec<Variant> {
    let (lights, media) = (lights(), media());
    let lights: Vec<&LightRecord> = lights.iter().collect();
    let plain = Variant::new(Pass::Surface).with("LIGHTMAP", true).with("LIGHTS", true).with("SPECULAR", true);
    let plain = ["LAMPS", "SUNS", "LAMP_CONE", "LAMP_LEGENDRE"].iter().fold(plain, |v, effect| v.with(effect, true));
    let mut variants = vec![
        plain.clone(),
        Variant::new(Pass::Surface).with("PROBES", true),
        Variant::new(Pass::Surface).with("LIGHTMAP", true).with("SH1", true).with("NORMAL_MAP", true),
        Variant::new(Pass::Surface).with("LIGHTMAP", true).with("SHOW_PAGE", true).with("SHOW_TEXELS", true),
        Variant::new(Pass::Surface).with("SHOW_NODES", true),
        Variant::new(Pass::Surface).with("LIGHTMAP", true).with("SHOW_DENSITY", true),
        Variant::new(Pass::Surface).with("LIGHTMAP", true).with("SHOW_CHARTS", true),
        Variant::new(Pass::Surface).with("SHOW_GREY", true),
        Variant::new(Pass::Surface).with("PRUNED", true),
        Variant::new(Pass::Pick),
        Variant::new(Pass::Pick).with("LIGHTMAP", true).with("MASK", true).with("BASE_TEXTURE", true),
        Variant::new(Pass::Difference).with("ENCODE", true),
    ];
    for media in [&media[..1], &media[..2], &media[..]] {
        let plan = AirPlan::new(AirSettings::default(), media, &lights).expect("air");
        for shadows in [false, true] {
            let fogged = plain.clone().and(&plan.passage).with("FOGGED", true).with("SOFTENED", plan.softens);
            variants.push(fogged.with("SHADOWS", shadows));
        }
    }
    variants
}

#[test]
fn every_variant_is_valid_wgsl() {
    let mut count = 0;
    let mut check = |variant: &Variant| {
        count += 1;
        validate(&shader::compose(variant)).unwrap_or_else(|error| panic!("{variant}: {error}"));
    };
    let surfaces = surface_variants();
    surfaces.iter().for_each(&mut check);
    let plans = air_plans();
    for (_, plan) in &plans {
        check(plan);
        check(&surfaces[0].clone().with("BLEND", true).and(plan).with("AIR", true));
    }
    for (filmic, encode) in [(false, false), (true, true)] {
        check(&Variant::new(Pass::Tone).with("FILMIC", filmic).with("ENCODE", encode));
    }
    check(&Variant::new(Pass::Sky));
    check(&Variant::new(Pass::Sky).with("SKY_PICTURE", true));
    check(&Variant::new(Pass::Sky).with("SKY_PICTURE", true).with("SKY_FOGGED", true));
    check(&Variant::new(Pass::Caster));
    lit_variants().iter().for_each(&mut check);
    assert!(count > 100, "{count} variants are not all");
    println!("{count} variants");
}

#[test]
fn a_broken_shader_is_refused() {
    assert!(validate("fn f() -> f32 { return vec3f(0.0); }").is_err());
}

#[test]
fn every_module_is_in_some_variant() {
    let mut texts: Vec<String> = surface_variants().iter().map(shader::compose).collect();
    texts.extend(air_plans().iter().map(|(_, plan)| shader::compose(plan)));
    texts.extend([Pass::Tone, Pass::Sky, Pass::Caster].map(|pass| shader::compose(&Variant::new(pass))));
    texts.extend(lit_variants().iter().map(shader::compose));
    texts.push(shader::compose(&Variant::new(Pass::Sky).with("SKY_PICTURE", true)));
    for (name, source) in MODULES {
        let functions = source.lines().filter_map(|line| line.strip_prefix("fn ").or(line.strip_prefix("@group")));
        for line in functions.filter(|line| !line.contains("// if ")) {
            let head = line.split('{').next().expect("a line").trim();
            assert!(texts.iter().any(|text| text.contains(head)), "{name}: '{head}' is in no variant");
        }
    }
}

#[test]
fn shared_structs_lie_where_rust_says() {
    let text: String = SHARED.iter().map(|shared| shared.wgsl).collect();
    let module = naga::front::wgsl::parse_str(&text).expect("structs parse");
    for shared in SHARED {
        let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(shared.name)).expect("declared");
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{} is no struct", shared.name) };
        let offsets: Vec<(&str, usize)> =
            members.iter().map(|member| (member.name.as_deref().unwrap_or(""), member.offset as usize)).collect();
        assert_eq!(offsets, shared.offsets, "{}", shared.name);
        assert_eq!(*span as usize, shared.size, "{}: forgotten padding at the end", shared.name);
    }
}

#[test]
fn a_fog_free_scene_has_no_air_in_its_shaders() {
    assert_eq!(AirPlan::new(AirSettings::default(), &[], &lights().iter().collect::<Vec<_>>()), None);
    for method in Method::ALL {
        let plan = AirPlan::new(AirSettings { method, ..AirSettings::default() }, &[], &[]);
        assert_eq!(plan, None, "{method:?}");
    }
    for variant in surface_variants() {
        let text = shader::compose(&variant);
        for word in [
            "media",
            "Medium",
            "lamps",
            "Lamp",
            "Sight",
            "airlight",
            "transmittance",
            "RULE",
            "phase",
            "moments",
            "coefficients",
        ] {
            assert!(!text.contains(word), "{variant} holds '{word}'");
        }
        let module = validate(&text).expect("valid");
        let names: Vec<&str> = module.global_variables.iter().filter_map(|(_, v)| v.name.as_deref()).collect();
        let allowed = [
            "frame",
            "instances",
            "page_uvs",
            "surface",
            "lightmap_texels",
            "base_texture",
            "base_sampler",
            "emission_texture",
            "emission_sampler",
        ];
        assert!(names.iter().all(|name| allowed.contains(name)), "{variant} binds {names:?}");
    }
}

#[test]
fn an_effect_that_is_off_leaves_no_instruction_and_no_binding() {
    // Marks that each effect leaves in a shader that has it.
    let marks = [
        ("LAMP_CONE", "spot_cone"),
        ("LAMP_LEGENDRE", "legendre"),
        ("PHASE_HENYEY_GREENSTEIN", "if medium.phase == 3u"),
        ("PHASE_RAYLEIGH", "if medium.phase == 2u"),
        ("BOUNDS_BOX", "clip_box"),
        ("BOUNDS_BALL", "clip_ball"),
        ("DENSITY_EXPONENTIAL", "exponential_length"),
        ("DENSITY_LINEAR", "linear_length"),
        ("BOUNDS_HULL", "clip_hull"),
        ("BOUNDS_MESH", "mesh_parts"),
        ("DENSITY_PLANET", "planet_length"),
        ("DENSITY_GRID", "grid_length"),
        ("SUNS", "sun_between"),
        ("LAYERED", "scattering_at"),
        ("QUADRATURE", "airlight_between"),
        ("LUT", "tail_texels"),
        ("RAY_MARCH", "f32(STEPS)"),
        ("SHAFTS", "lamp_airlight_shadowed"),
        ("LATTICE_AIR", "air_texels"),
        ("SHADOWS", "shadow_map"),
    ];
    let mut seen = BTreeSet::new();
    for (_, plan) in air_plans() {
        let text = shader::compose(&plan);
        for (effect, mark) in marks {
            // The cone's function stays where another shape of lamp is: it is called by none.
            let shared = effect == "LAMP_LEGENDRE" && plan.has("PHASE_LEGENDRE")
                || effect == "QUADRATURE" && (plan.has("CLOSED_FORM") || plan.has("LUT"))
                || effect == "LAMP_CONE";
            assert!(!plan.has(effect) || text.contains(mark), "{plan}: {effect} without '{mark}'");
            assert!(plan.has(effect) || shared || !text.contains(mark), "{plan}: '{mark}' without {effect}");
            seen.extend(plan.has(effect).then_some(effect));
        }
    }
    assert_eq!(seen.len(), marks.len(), "effects seen: {seen:?}");
}
