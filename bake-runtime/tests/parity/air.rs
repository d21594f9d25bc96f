//! Air-light functions and media against `bake-optics` in f64.

use bake_optics::airlight::{Airlight, ClosedForm, IsotropicLamp, Lut, Oracle, RayMarch, Sight, UniformAir, Vacuum};
use bake_optics::emitter::Emitter;
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::mesh::ClosedMesh;
use bake_optics::medium::{self, Bounds, Density, MediumSet, Ray};
use bake_optics::phase::Phase;
use bake_runtime::layout::Medium;
use bake_runtime::variant::{Pass, Variant};
use glam::{DAffine3, DQuat, DVec3, IVec3};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

use std::sync::Arc;

use crate::harness::Case;

fn round(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Rays: eye relative to the lamp (a.xyz), length (a.w), direction (b.xyz), lamp's radius (b.w), extinction (c.x) and axis (c.yzw).
///
/// A lamp 0.1 to 30 m away, seen at 1e-3 to π rad beside the ray, rays from 1e-2 to 100 m: grid and random.
fn rays() -> Vec<Vec<f64>> {
    let mut random = SmallRng::seed_from_u64(7);
    let mut unit = move || loop {
        let v = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        if (0.1..1.0).contains(&v.length()) {
            return v.normalize();
        }
    };
    let mut rows = Vec::new();
    for gamma in [1e-3, 3e-3, 0.01, 0.1, 0.5, 1.0, 1.57, 2.0, 2.6, 3.0, 3.13] {
        for distance in [0.1, 1.0, 5.0, 30.0] {
            for length in [0.01, 0.9, 1.0, 4.0, 20.0, 100.0] {
                // Powers of two: lengths are multiplied by them without rounding.
                for sigma in [0.0009765625, 0.125, 1.0, 4.0] {
                    let to_lamp = unit();
                    let side = to_lamp.cross(unit()).normalize();
                    let dir = to_lamp * f64::cos(gamma) + side * f64::sin(gamma);
                    let axis = unit();
                    let (q, axis) = (-to_lamp * distance, axis);
                    let row = [q.x, q.y, q.z, length, dir.x, dir.y, dir.z, 0.0, sigma, axis.x, axis.y, axis.z];
                    rows.push(row.map(round).to_vec());
                }
            }
        }
    }
    rows
}

fn sight(row: &[f64]) -> Sight<f64> {
    let unit = |v: [f64; 3]| DVec3::from(v).normalize().to_array();
    let (dir, axis) = (unit([row[4], row[5], row[6]]), unit([row[9], row[10], row[11]]));
    Sight::from_points([row[0], row[1], row[2]], dir, row[3], [0.0; 3], axis)
}

/// Scattering of the test medium; its extinction comes with the row.
const SIGMA_S: f64 = 0.5;

fn uniform(row: &[f64], phase: &Phase<f64>) -> UniformAir<f64> {
    UniformAir { sigma_s: SIGMA_S * row[8], sigma_t: row[8], phase: phase.clone() }
}

fn effects(phase: &Phase<f64>) -> Variant {
    Variant::new(Pass::Air)
        .with("PHASE_LINEAR", matches!(phase, Phase::Linear { .. }))
        .with("PHASE_RAYLEIGH", matches!(phase, Phase::Rayleigh))
        .with("PHASE_HENYEY_GREENSTEIN", matches!(phase, Phase::HenyeyGreenstein { .. }))
        .with("PHASE_LEGENDRE", matches!(phase, Phase::Legendre(_)))
        .constant("MEDIA", 1)
        .constant("CUTS", 9)
        .constant("STEPS", 64)
        .constant("ORDERS", 3)
}

/// The medium with extinction 1: rows are scaled by their extinction instead, which leaves optical lengths as they are.
fn media(phase: &Phase<f64>) -> (Vec<Medium>, Vec<f32>) {
    let (kind, asymmetry, terms) = match phase {
        Phase::Linear { a1 } => (1, *a1 as f32, Vec::new()),
        Phase::Rayleigh => (2, 0.0, Vec::new()),
        Phase::HenyeyGreenstein { g } => (3, *g as f32, Vec::new()),
        Phase::Legendre(terms) => (4, 0.0, terms.iter().map(|&c| c as f32).collect()),
        _ => (0, 0.0, Vec::new()),
    };
    let medium = Medium {
        sigma_s: [SIGMA_S as f32; 3],
        sigma_t: [1.0; 3],
        phase: kind,
        asymmetry,
        count: terms.len() as u32,
        ..Medium::default()
    };
    (vec![medium], terms)
}

/// The call with all lengths times the extinction: L scales as sigma².
const RAY: &str = "ViewRay(a.xyz * c.x, b.xyz, a.w * c.x)";

fn lamp(shape: u32, cosines: [f64; 2], count: usize, first: usize) -> String {
    format!(
        "Lamp(vec3f(0.0), 0.0, c.yzw, {:e}, vec3f(1.0), {:e}, {shape}u, {first}u, {count}u, 0u, 0u, 0u, 0.0, 0u)",
        cosines[1] as f32, cosines[0] as f32
    )
}

/// One method on one kind of air and lamp.
struct Trial {
    name: &'static str,
    roots: &'static [&'static str],
    function: &'static str,
    nodes: u32,
    phase: Phase<f64>,
    lamp: Emitter<f64>,
    limit: f64,
}

/// Air-light by quadrature, against the oracle.
fn quadrature(name: &'static str, nodes: u32, phase: Phase<f64>, lamp: Emitter<f64>) -> Case {
    // A ray that ends at a lamp it grazes moves with the rounding of its length.
    let limit = 1e-4;
    let (roots, function): (&[&str], _) = (&["airlight_quadrature"], "lamp_airlight");
    Trial { name, roots, function, nodes, phase, lamp, limit }
        .case(|sight, lamp, air| Oracle::default().radiance(sight, lamp, air))
}

impl Trial {
    /// Errors are relative to the value, or to a hundredth of what a lamp that shines alike everywhere gives where that is more:
    /// at the edge of a cone f32 keeps few digits of little light.
    fn case(self, method: impl Fn(&Sight<f64>, &Emitter<f64>, &UniformAir<f64>) -> f64 + 'static) -> Case {
        let Self { name, roots, function, nodes, phase, lamp: emitter, limit } = self;
        let (media, mut coefficients) = media(&phase);
        let lamp = match &emitter {
            Emitter::SpotCone { cos_inner, cos_outer } => lamp(1, [*cos_inner, *cos_outer], 0, 0),
            Emitter::Legendre(terms) => {
                let first = coefficients.len();
                coefficients.extend(terms.iter().map(|&c| c as f32));
                lamp(2, [-1.0; 2], terms.len(), first)
            }
            _ => lamp(0, [-1.0; 2], 0, 0),
        };
        let variant = effects(&phase)
            .with("LAMP_CONE", matches!(emitter, Emitter::SpotCone { .. }))
            .with("LAMP_LEGENDRE", matches!(emitter, Emitter::Legendre(_)))
            .with("RAY_MARCH", roots[0] == "airlight_ray_march")
            .quadrature(nodes);
        let moments = (0..3).map(|l| phase.moment(l) as f32).collect();
        let call = format!("vec4f(c.x * c.x * {function}({RAY}, {lamp}), 0.0)");
        let twin = move |row: &[f64]| {
            let (sight, air) = (sight(row), uniform(row, &phase));
            let everywhere = match emitter {
                Emitter::Isotropic => 0.0,
                _ => 1e-6 * Oracle::default().radiance(&sight, &IsotropicLamp, &air),
            };
            (vec![method(&sight, &emitter, &air)], everywhere)
        };
        Case { name, variant, roots, call, inputs: rays(), limit, twin: Box::new(twin), media, coefficients, moments }
    }
}

/// All cases of air-light and media.
pub fn cases() -> Vec<Case> {
    // A ray that grazes the cone tells cosines apart that differ in f32's last digit.
    let cone = Emitter::SpotCone { cos_inner: round(0.95), cos_outer: round(0.8) };
    let ball = || Emitter::Legendre(vec![1.0, 0.5, 0.25]);
    let trial =
        |name, roots, function, phase, lamp, limit| Trial { name, roots, function, nodes: 16, phase, lamp, limit };
    let vacuum = |name, phase, lamp| {
        let trial = trial(name, &["airlight_vacuum"], "lamp_airlight", phase, lamp, 1e-4);
        trial.case(|sight, lamp, air| Vacuum::default().radiance(sight, lamp, air))
    };
    let march: &[&str] = &["airlight_ray_march"];
    let closed_form = |name, phase| {
        let trial = trial(name, &["airlight_closed_form"], "lamp_airlight_closed", phase, Emitter::Isotropic, 1e-4);
        trial.case(|sight, _, air| ClosedForm::default().radiance(sight, &IsotropicLamp, air))
    };
    let block = Bounds::Box { min: DVec3::new(-2.0, -1.0, -3.0), max: DVec3::new(1.0, 2.0, 0.5) };
    let ball_bounds = Bounds::Sphere { centre: DVec3::new(0.5, 0.25, -1.0), radius: 3.0 };
    let layer = Density::Exponential { base_m: 1.5, scale_height_m: 4.0 };
    let linear = Density::Linear { zero_m: 2.0, slope_per_m: -0.25 };
    vec![
        quadrature("quadrature, isotropic", 16, Phase::Isotropic, Emitter::Isotropic),
        quadrature("quadrature, Rayleigh", 16, Phase::Rayleigh, Emitter::Isotropic),
        quadrature("quadrature, Henyey-Greenstein 0.85", 32, Phase::HenyeyGreenstein { g: 0.85 }, Emitter::Isotropic),
        quadrature("quadrature, Legendre", 16, Phase::Legendre(vec![1.0, 0.9, 0.5, 0.1]), Emitter::Isotropic),
        quadrature("quadrature, cone", 16, Phase::Isotropic, cone),
        quadrature("quadrature, Legendre lamp", 16, Phase::Isotropic, ball()),
        vacuum("vacuum, isotropic", Phase::Isotropic, Emitter::Isotropic),
        vacuum("vacuum, Rayleigh", Phase::Rayleigh, ball()),
        closed_form("closed form", Phase::Isotropic),
        closed_form("closed form, Rayleigh", Phase::Rayleigh),
        closed_form("closed form, linear", Phase::Linear { a1: -0.75 }),
        closed_form("closed form, degree 2", Phase::Legendre(vec![1.0, 1.5, 0.75])),
        trial("ray march", march, "lamp_airlight", Phase::Isotropic, Emitter::Isotropic, 1e-4)
            .case(|sight, lamp, air| RayMarch { steps: 64 }.radiance(sight, lamp, air)),
        lut(),
        optical_length("exponential", layer.clone(), Bounds::Unbounded, 2e-5),
        optical_length("linear", linear.clone(), Bounds::Unbounded, 2e-5),
        optical_length("box", Density::Uniform, block.clone(), 2e-5),
        optical_length("ball", Density::Uniform, ball_bounds.clone(), 1e-4),
        optical_length("hull", Density::Uniform, prism(), 2e-5),
        optical_length("mesh", Density::Uniform, Bounds::Mesh(Arc::new(crate::common::angle(2, |p| p))), 1e-4),
        optical_length(
            "fog in a mesh",
            layer.clone(),
            Bounds::Mesh(Arc::new(crate::common::angle(2, |p| p - 1.0))),
            1e-4,
        ),
        optical_length("grid", cloud(), Bounds::Unbounded, 2e-5),
        optical_length("planet", planet(6.371e6, 8.0e3), Bounds::Unbounded, 2e-5),
        optical_length("small planet", planet(40.0, 3.0), Bounds::Unbounded, 2e-5),
        density_at("density in a box", layer.clone(), block, 5e-6),
        density_at("density in a ball", linear.clone(), ball_bounds, 5e-6),
        density_at("density in a hull", cloud(), prism(), 5e-6),
        density_at("density in a mesh", layer, Bounds::Mesh(Arc::new(crate::common::angle(2, |p| p - 1.0))), 5e-6),
        density_at("density over a planet", planet(6.371e6, 8.0e3), Bounds::Unbounded, 5e-6),
        density_at("density over a small planet", planet(40.0, 3.0), Bounds::Unbounded, 5e-6),
    ]
}

/// A planet 2 m below the origin, tilted so that no axis is its up.
fn planet(radius_m: f64, scale_height_m: f64) -> Density {
    // Its centre is exact in f32.
    let centre = DVec3::new(-0.5, -0.75, 0.375) * radius_m.log2().floor().exp2();
    Density::Planet { centre, radius_m: centre.length() - 2.0, scale_height_m }
}

/// The table against the same table looked up in f64; where its two look-ups cancel, against the oracle.
fn lut() -> Case {
    let table = Lut::new(256, 3);
    let twin = move |sight: &Sight<f64>, _: &Emitter<f64>, air: &UniformAir<f64>| {
        let height = sight.h.max(1e-4 * sight.eye_distance());
        let near = Sight { h: height, ..*sight };
        let (h, va, excess) = (air.sigma_t * height, near.behind() / height, near.excess(near.length));
        let whole = table.tail(0, h, va);
        let left = whole - (-air.sigma_t * excess).exp() * table.tail(0, h, va + excess / height);
        match left < 0.05 * whole || va > 20.0 {
            true => Oracle::default().radiance(sight, &IsotropicLamp, air),
            false => table.radiance(&near, &IsotropicLamp, air),
        }
    };
    let (roots, function): (&[&str], _) = (&["airlight_lut"], "lamp_airlight_table");
    let (phase, lamp, limit) = (Phase::Rayleigh, Emitter::Isotropic, 5e-5);
    let mut case = Trial { name: "lut", roots, function, nodes: 16, phase, lamp, limit }.case(twin);
    // The difference of two look-ups: relative to the endless ray's light.
    case.twin = {
        let (value, phase) = (case.twin, Phase::Rayleigh);
        Box::new(move |row| {
            let (sight, air) = (sight(row), uniform(row, &phase));
            let endless = Oracle::default().radiance(&Sight { length: f64::INFINITY, ..sight }, &IsotropicLamp, &air);
            (value(row).0, endless)
        })
    };
    case
}

/// Optical length of a ray from the eye (a.xyz, length a.w, direction b.xyz).
fn optical_length(name: &'static str, density: Density, bounds: Bounds, limit: f64) -> Case {
    let mut inputs = rays();
    if let Bounds::Mesh(mesh) = &bounds {
        inputs.extend(through_edges(mesh));
    }
    // Level, upright and almost level rays.
    for dir in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 1e-6, 0.0], [1.0, -1e-4, 0.0]] {
        inputs
            .extend([0.01, 1.0, 50.0].map(|length| vec![0.25, 1.0, -0.5, length, dir[0], round(dir[1]), dir[2], 0.0]));
    }
    let (set, case) = in_medium(density, bounds);
    Case {
        name,
        call: "vec4f(optical_depth(ViewRay(a.xyz, b.xyz, a.w)), 0.0)".into(),
        inputs,
        limit,
        twin: Box::new(move |row| {
            let dir = DVec3::new(row[4], row[5], row[6]);
            let ray = Ray::new(DVec3::new(row[0], row[1], row[2]), dir.normalize(), row[3]);
            // Borders that a ray only touches move by the rounding of its places.
            (vec![set.optical_depth(&ray)[0]], 1e-2)
        }),
        ..case
    }
}

/// Density at a place (a.xyz) as far as the bounds reach: in a lattice about them and at random.
fn density_at(name: &'static str, density: Density, bounds: Bounds, limit: f64) -> Case {
    let mut random = SmallRng::seed_from_u64(11);
    let mut anywhere = || [(); 3].map(|()| round(random.random_range(-3.0..3.0))).to_vec();
    // Odd steps: none of the places lies on a border.
    let step = |i: i32| round(-2.9 + 0.733 * f64::from(i));
    let lattice = (0..512).map(|i| [i % 8, i / 8 % 8, i / 64].map(step).to_vec());
    let inputs = (0..4096).map(|_| anywhere()).chain(lattice).collect();
    let (set, case) = in_medium(density, bounds);
    Case {
        name,
        call: "vec4f(optical_inside(media[0], a.xyz) * density_at(media[0], a.xyz), 0.0, 0.0, 0.0)".into(),
        inputs,
        limit,
        twin: Box::new(move |row| (vec![set.media[0].density_at(DVec3::new(row[0], row[1], row[2]))], 1e-2)),
        ..case
    }
}

/// A medium of extinction 1, in f64 and as the shader takes it.
fn in_medium(density: Density, bounds: Bounds) -> (MediumSet, Case) {
    let mut record = Medium { sigma_t: [1.0; 3], ..Medium::default() };
    let mut coefficients = Vec::new();
    let (kind, base, slope) = match &density {
        Density::Exponential { base_m, scale_height_m } => (1, *base_m, 1.0 / scale_height_m),
        Density::Linear { zero_m, slope_per_m } => (2, *zero_m, *slope_per_m),
        Density::Planet { centre, radius_m, scale_height_m } => {
            record.grid_x = centre.extend(centre.length()).as_vec4().to_array();
            (3, centre.length() - radius_m, 1.0 / scale_height_m)
        }
        Density::Grid(grid) => {
            let map = grid.world_from_grid().inverse();
            let row = |r: usize| map.matrix3.row(r).extend(map.translation[r]).as_vec4().to_array();
            (record.grid_x, record.grid_y, record.grid_z) = (row(0), row(1), row(2));
            [record.count_x, record.count_y, record.count_z] = grid.size().as_uvec3().to_array();
            coefficients.extend(grid.values());
            (4, 0.0, 0.0)
        }
        Density::Uniform => (0, 0.0, 0.0),
    };
    record.planes = coefficients.len() as u32;
    let (shape, low, high) = match &bounds {
        Bounds::Box { min, max } => (1, *min, *max),
        Bounds::Sphere { centre, radius } => (2, *centre, DVec3::new(*radius, 0.0, 0.0)),
        Bounds::Hull(planes) => {
            record.plane_count = planes.len() as u32;
            coefficients.extend(planes.iter().flat_map(|plane| plane.as_vec4().to_array()));
            (3, DVec3::ZERO, DVec3::ZERO)
        }
        Bounds::Mesh(mesh) => {
            record.plane_count = mesh.boxes().len() as u32;
            coefficients.extend(bake_runtime::air::mesh_numbers(mesh, DVec3::ZERO));
            let [low, high] = mesh.bounding_box();
            (4, low, high)
        }
        _ => (0, DVec3::ZERO, DVec3::ZERO),
    };
    (record.bounds, record.low, record.high) = (shape, low.as_vec3().to_array(), high.as_vec3().to_array());
    (record.density, record.base, record.slope) = (kind, base as f32, slope as f32);
    let effects = ["DENSITY_EXPONENTIAL", "DENSITY_LINEAR", "DENSITY_PLANET", "DENSITY_GRID"].into_iter().zip(1..);
    let variant = effects.fold(Variant::new(Pass::Air), |v, (effect, own)| v.with(effect, kind == own));
    let effects = ["BOUNDS_BOX", "BOUNDS_BALL", "BOUNDS_HULL", "BOUNDS_MESH"].into_iter().zip(1..);
    let variant = effects.fold(variant, |v, (effect, own)| v.with(effect, shape == own)).constant("MEDIA", 1);
    let variant = variant.with("BOUNDS_BOX", shape == 1 || shape == 4);
    let scatter = medium::Scatter { sigma_s: [1.0; 3], sigma_a: [0.0; 3] };
    let set = MediumSet { media: vec![medium::Medium { bounds, density, scatter, phase: Phase::Isotropic }] };
    (set, Case { variant, roots: &["medium"], media: vec![record], coefficients, ..Case::default() })
}

/// A grid of noise, turned and longer one way than the others; the last rays' origins lie within.
fn cloud() -> Density {
    let mut random = SmallRng::seed_from_u64(3);
    let size = IVec3::new(5, 4, 6);
    let values = (0..size.element_product()).map(|_| random.random_range(0.0f32..2.0)).collect();
    let placed = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.5, 1.0, 0.75),
        DQuat::from_euler(glam::EulerRot::YXZ, 0.4, -0.7, 1.1),
        DVec3::new(-1.0, 0.0, -2.0),
    );
    Density::Grid(Arc::new(DensityGrid::new(size, values, placed).expect("valid")))
}

/// Rays exactly through corners and middles of edges of a mesh with dyadic corners: every way along and between the axes.
fn through_edges(mesh: &ClosedMesh) -> Vec<Vec<f64>> {
    let corner = |index: u32| mesh.positions()[index as usize];
    let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let places = edges.flat_map(|[a, b]| [corner(a), 0.5 * (corner(a) + corner(b))]);
    let ways = (0..27).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0);
    let ways: Vec<DVec3> = ways.filter(|way| *way != DVec3::ZERO).collect();
    let ray = |place: DVec3, way: DVec3| {
        let (from, dir) = (place - 4.0 * way, way.normalize());
        [from.x, from.y, from.z, 20.0, dir.x, dir.y, dir.z, 0.0].map(round).to_vec()
    };
    places.flat_map(|place| ways.iter().map(move |&way| ray(place, way))).collect()
}

/// A prism with a slanted roof.
fn prism() -> Bounds {
    let plane = |x: f64, y: f64, z: f64, d: f64| DVec3::new(x, y, z).normalize().extend(d);
    let sides = [plane(1.0, 0.2, 0.0, 1.5), plane(-1.0, 0.0, 0.5, 2.0), plane(-0.3, 0.0, -1.0, 1.0)];
    Bounds::Hull(sides.into_iter().chain([plane(0.3, 1.0, 0.2, 1.25), plane(0.0, -1.0, 0.0, 0.5)]).collect())
}
