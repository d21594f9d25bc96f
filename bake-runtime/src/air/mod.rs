//! The air of one picture: which method, which shader effects, and the buffers that they read.

mod haze;
pub(crate) mod records;
mod upload;
mod voxels;

pub use haze::Haze;
pub(crate) use upload::{AirBuffers, Sources, surface_texels};
pub use upload::{mesh_numbers, tail_texels};

use bake_formats::manifest::{LightKind, LightRecord};
pub use bake_optics::medium::Medium;
use bake_optics::medium::{Bounds, Density};
use bake_optics::phase::Phase;
use glam::DVec3;

use crate::layout::MOST_MEDIA;
use crate::variant::{Pass, Variant};

/// How light that the air scatters towards the eye is found. See `bake_optics::airlight` for each method's domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    /// The air is left out.
    None,
    /// Scattering without extinction.
    Vacuum,
    /// Two look-ups a Legendre order; uniform air, lamps that shine alike in all directions.
    Lut,
    /// Exponential integrals; uniform air of phase functions up to degree 2, lamps that shine alike in all directions.
    ClosedForm,
    /// Gauss–Legendre nodes on each side of a lamp's foot: every lamp and air.
    Quadrature,
    /// Equal steps along the ray.
    RayMarch,
}

impl Method {
    /// All of them, cheapest first.
    pub const ALL: [Self; 6] =
        [Self::None, Self::Vacuum, Self::Lut, Self::ClosedForm, Self::Quadrature, Self::RayMarch];

    /// Its name as flags and panels spell it.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Vacuum => "vacuum",
            Self::Lut => "lut",
            Self::ClosedForm => "closed_form",
            Self::Quadrature => "quadrature",
            Self::RayMarch => "ray_march",
        }
    }

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// How the air is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AirSettings {
    /// The method; where the scene leaves its domain, [`Method::Quadrature`] stands in.
    pub method: Method,
    /// Gauss–Legendre nodes on each side of a lamp's foot, 1 to 64; 0: as many as the phase functions call for.
    pub nodes: u32,
    /// Steps of [`Method::RayMarch`], 1 to 4096.
    pub steps: u32,
    /// Places along a ray where a shadow map is asked, 1 to 1024; borders between them are then found by bisection.
    pub shaft_steps: u32,
    /// Distance of the sky, metres, in air without end: it glows as it does through this much of the air (Sun et al. 2005,
    /// section 6). None: the sky is seen through the media's own extent.
    pub sky_distance_m: Option<u32>,
}

impl Default for AirSettings {
    fn default() -> Self {
        Self { method: Method::Quadrature, nodes: 0, steps: 32, shaft_steps: 32, sky_distance_m: None }
    }
}

/// What the air of a picture calls for.
#[derive(Debug, Clone, PartialEq)]
pub struct AirPlan {
    /// The method that is used.
    pub method: Method,
    /// Effects and sizes of its shader.
    pub variant: Variant,
    /// Why another method is used than was asked for.
    pub note: Option<&'static str>,
    /// Effects and sizes that surfaces need for light on its way through the air.
    pub passage: Variant,
    /// Whether lamps reach surfaces by way of the air too: known for uniform air.
    pub softens: bool,
}

/// Midpoints along a ray for light stored in a lattice.
const LATTICE_STEPS: u32 = 24;

/// Legendre orders of the table's and the closed form's phase functions.
pub const LUT_ORDERS: u32 = 3;

impl AirPlan {
    /// What media and lights call for as seen from `eye`; `None` where there is no air, or it is switched off.
    pub fn new(settings: AirSettings, media: &[Medium], lights: &[&LightRecord]) -> Option<Self> {
        Self::shadowed(settings, media, lights, false)
    }

    /// The same where lights have shadow maps.
    pub fn shadowed(settings: AirSettings, media: &[Medium], lights: &[&LightRecord], shadows: bool) -> Option<Self> {
        let media = &media[..media.len().min(MOST_MEDIA)];
        if media.is_empty() || settings.method == Method::None {
            return None;
        }
        let layered = is_layered(media, lights);
        let (method, note) = usable(settings.method, media, lights, layered);
        let sizes = Variant::new(Pass::Air)
            .constant("MEDIA", media.len() as u32)
            .constant("CUTS", most_cuts(media, layered))
            .constant("STEPS", settings.steps.clamp(1, 4096))
            .constant("ORDERS", LUT_ORDERS)
            .constant("SHAFT_STEPS", settings.shaft_steps.clamp(1, 1024))
            .constant("LATTICE_STEPS", LATTICE_STEPS)
            .quadrature(if settings.nodes == 0 { default_nodes(media, layered) } else { settings.nodes.clamp(1, 64) });
        let variant = [media_effects(media), light_effects(lights)].into_iter().flatten();
        let variant = variant.fold(sizes, |variant, (effect, on)| variant.with(effect, on));
        // The other methods know no interval of a ray but the whole.
        let by_interval = matches!(method, Method::Quadrature | Method::RayMarch) && !lights.is_empty();
        let shadows = shadows && (by_interval || variant.has("SUNS"));
        let variant = variant
            .with("LAYERED", layered)
            .with(method_effect(method), true)
            .with("SHADOWS", shadows)
            .with("SHAFTS", shadows && method == Method::Quadrature);
        let passage = Variant::new(Pass::Surface).constant("MEDIA", media.len() as u32);
        let passage = media_effects(media).into_iter().fold(passage, |v, (effect, on)| v.with(effect, on));
        Some(Self { method, variant, note, passage, softens: !layered && method != Method::Vacuum })
    }
}

/// Cuts of a ray at a lamp's foot and cone, and at borders of media: of a mesh sixteen, and as many shadows of its edges.
fn most_cuts(media: &[Medium], layered: bool) -> u32 {
    let count = media.len() as u32;
    let meshes = media.iter().filter(|medium| is_mesh(medium)).count() as u32;
    6 + 2 * count + if layered { 3 * count } else { 3 } + 32 * meshes
}

fn is_mesh(medium: &Medium) -> bool {
    matches!(medium.bounds, Bounds::Mesh(_))
}

/// Whether the air needs optical depths point by point: density that varies, regions that differ or have gaps, a lamp outside.
fn is_layered(media: &[Medium], lights: &[&LightRecord]) -> bool {
    let uniform =
        |medium: &Medium| medium.density == Density::Uniform && medium.bounds == media[0].bounds && !is_mesh(medium);
    let inside = |light: &&LightRecord| position(light).is_none_or(|place| media[0].bounds.contains(place));
    !media.iter().all(uniform) || !lights.iter().all(inside)
}

fn position(light: &LightRecord) -> Option<DVec3> {
    match &light.kind {
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => Some(position.as_dvec3()),
        LightKind::Directional { .. } => None,
    }
}

/// The method asked for, or the one that stands in.
fn usable(method: Method, media: &[Medium], lights: &[&LightRecord], layered: bool) -> (Method, Option<&'static str>) {
    let shaped = light_effects(lights).iter().any(|&(effect, on)| on && effect.starts_with("LAMP_"));
    let bands = |phase: &Phase<f64>| match phase {
        Phase::Isotropic => 1,
        Phase::Linear { .. } => 2,
        Phase::Rayleigh => 3,
        Phase::Legendre(terms) => terms.len(),
        _ => usize::MAX,
    };
    let most = media.iter().map(|medium| bands(&medium.phase)).max().unwrap_or(1);
    let refused = match method {
        Method::Lut | Method::ClosedForm if layered => Some("it needs air of one density that holds the lamps"),
        Method::Lut | Method::ClosedForm if shaped => Some("it needs lamps that shine alike in all directions"),
        Method::Lut if most > LUT_ORDERS as usize => Some("its tables hold three Legendre orders"),
        Method::ClosedForm if most > LUT_ORDERS as usize => {
            Some("in single precision it holds for phase functions up to degree 2")
        }
        _ => None,
    };
    (if refused.is_some() { Method::Quadrature } else { method }, refused)
}

/// Nodes on each side that keep the error below 1e-4: see `docs/runtime.md`.
fn default_nodes(media: &[Medium], layered: bool) -> u32 {
    let peaked = |phase: &Phase<f64>| match phase {
        Phase::HenyeyGreenstein { g } => g.abs() > 0.5,
        Phase::Legendre(terms) => terms.len() > 6,
        _ => false,
    };
    // Nodes meet kinks at a grid's cells; a mesh's borders are cuts, between which uniform air is uniform.
    let grid = |medium: &Medium| matches!(medium.density, Density::Grid(_));
    let cut = |medium: &Medium| is_mesh(medium) && medium.density == Density::Uniform;
    if media.iter().any(|medium| peaked(&medium.phase) || grid(medium)) {
        32
    } else if layered && !media.iter().all(cut) {
        24
    } else {
        16
    }
}

fn media_effects(media: &[Medium]) -> Vec<(&'static str, bool)> {
    let any = |test: fn(&Medium) -> bool| media.iter().any(test);
    vec![
        // A mesh has a box around it.
        ("BOUNDS_BOX", any(|m| matches!(m.bounds, Bounds::Box { .. } | Bounds::Mesh(_)))),
        ("BOUNDS_BALL", any(|m| matches!(m.bounds, Bounds::Sphere { .. }))),
        ("BOUNDS_HULL", any(|m| matches!(m.bounds, Bounds::Hull(_)))),
        ("BOUNDS_MESH", any(is_mesh)),
        ("DENSITY_EXPONENTIAL", any(|m| matches!(m.density, Density::Exponential { .. }))),
        ("DENSITY_LINEAR", any(|m| matches!(m.density, Density::Linear { .. }))),
        ("DENSITY_PLANET", any(|m| matches!(m.density, Density::Planet { .. }))),
        ("DENSITY_GRID", any(|m| matches!(m.density, Density::Grid(_)))),
        ("PHASE_LINEAR", any(|m| matches!(m.phase, Phase::Linear { .. }))),
        ("PHASE_RAYLEIGH", any(|m| matches!(m.phase, Phase::Rayleigh))),
        ("PHASE_HENYEY_GREENSTEIN", any(|m| matches!(m.phase, Phase::HenyeyGreenstein { .. }))),
        ("PHASE_LEGENDRE", any(|m| matches!(m.phase, Phase::Legendre(_)))),
    ]
}

pub(crate) fn light_effects(lights: &[&LightRecord]) -> Vec<(&'static str, bool)> {
    let any = |test: fn(&LightKind) -> bool| lights.iter().any(|light| test(&light.kind));
    vec![
        ("LAMPS", any(|kind| !matches!(kind, LightKind::Directional { .. }))),
        ("SUNS", any(|kind| matches!(kind, LightKind::Directional { .. }))),
        ("LAMP_CONE", any(|kind| matches!(kind, LightKind::Spot { profile: None, .. }))),
        (
            "LAMP_LEGENDRE",
            any(|kind| {
                matches!(kind, LightKind::Spot { profile: Some(_), .. } | LightKind::Point { profile: Some(_), .. })
            }),
        ),
    ]
}

fn method_effect(method: Method) -> &'static str {
    match method {
        Method::None => "NO_AIR",
        Method::Vacuum => "VACUUM",
        Method::Lut => "LUT",
        Method::ClosedForm => "CLOSED_FORM",
        Method::Quadrature => "QUADRATURE",
        Method::RayMarch => "RAY_MARCH",
    }
}
