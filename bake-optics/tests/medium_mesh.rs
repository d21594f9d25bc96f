//! Closed meshes as bounds: against brute-force inside tests, convex twins and closed forms.

use bake_optics::medium::mesh::{ClosedMesh, MeshError};
use bake_optics::medium::{Bounds, Density, Medium, Ray, Scatter};
use glam::{DVec3, DVec4};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use testkit::compare::Worst;

type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

/// A torus about Y with `rings` × `sides` quads; the tube is squeezed and wavy so that it is nowhere convex.
fn torus(rings: u32, sides: u32) -> Soup {
    let angle = |i: u32, n: u32| 2.0 * PI * f64::from(i % n) / f64::from(n);
    let corner = |ring: u32, side: u32| {
        let (u, v) = (angle(ring, rings), angle(side, sides));
        let tube = 0.4 + 0.1 * (3.0 * u).sin();
        let radius = 1.0 + tube * v.cos();
        DVec3::new(radius * u.cos(), 0.7 * tube * v.sin(), radius * u.sin())
    };
    let positions = (0..rings).flat_map(|r| (0..sides).map(move |s| corner(r, s))).collect();
    let index = |r: u32, s: u32| (r % rings) * sides + s % sides;
    let quads = (0..rings).flat_map(|r| (0..sides).map(move |s| (r, s)));
    let triangles = quads.flat_map(|(r, s)| {
        let [a, b, c, d] = [index(r, s), index(r, s + 1), index(r + 1, s + 1), index(r + 1, s)];
        [[a, b, c], [a, c, d]]
    });
    (positions, triangles.collect())
}

fn cube(min: DVec3, max: DVec3) -> Soup {
    let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// Both soups as one.
fn joined(a: Soup, b: Soup) -> Soup {
    let offset = a.0.len() as u32;
    let moved = b.1.iter().map(|t| t.map(|corner| corner + offset));
    (a.0.into_iter().chain(b.0).collect(), a.1.into_iter().chain(moved).collect())
}

fn turned((positions, triangles): Soup) -> Soup {
    (positions, triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect())
}

fn closed((positions, triangles): &Soup) -> ClosedMesh {
    ClosedMesh::new(positions, triangles).expect("closed")
}

/// Winding number by the sum of solid angles (van Oosterom and Strackee 1983): knows nothing of rays.
fn winding((positions, triangles): &Soup, point: DVec3) -> f64 {
    let solid_angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| positions[corner as usize] - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        2.0 * a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * PI)
}

/// Distance of a point to the nearest interval end.
fn margin(intervals: &[(f64, f64)], s: f64) -> f64 {
    intervals.iter().flat_map(|&(from, to)| [(s - from).abs(), (s - to).abs()]).fold(f64::INFINITY, f64::min)
}

fn direction() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..2.0 * PI).prop_map(|(z, a)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * a.cos(), r * a.sin(), z)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if std::env::var_os("BAKE_LONG").is_some() { 20_000 } else { 300 }))]

    /// Every point of a ray is in an interval exactly where the solid angles say inside.
    #[test]
    fn intervals_are_the_points_inside(
        x in -1.8..1.8f64, y in -0.8..0.8f64, z in -1.8..1.8f64, dir in direction(), shape in 0..3usize,
    ) {
        let soups = [
            torus(11, 7),
            joined(torus(9, 5), cube(DVec3::new(0.2, -0.5, 0.2), DVec3::new(1.5, 0.5, 1.5))),
            joined(cube(-DVec3::ONE, DVec3::ONE), turned(cube(DVec3::splat(-0.5), DVec3::splat(0.6)))),
        ];
        let soup = &soups[shape];
        let mesh = closed(soup);
        let ray = Ray::new(DVec3::new(x, y, z), dir, 3.0);
        let intervals = mesh.intervals(&ray);
        for pair in intervals.windows(2) {
            prop_assert!(pair[0].1 < pair[1].0);
        }
        for i in 0..60 {
            let s = (f64::from(i) + 0.5) * 0.05;
            if margin(&intervals, s) < 1e-9 {
                continue;
            }
            let inside = intervals.iter().any(|&(from, to)| from < s && s < to);
            let truth = winding(soup, ray.at(s)).abs() > 0.5;
            prop_assert_eq!(inside, truth, "at {} of {:?}: {:?}", s, ray, intervals);
            prop_assert_eq!(mesh.contains(ray.at(s)), truth);
        }
    }
}

/// Rays straight at vertices, along edges and within faces: no leak, and the length inside is that of a hair beside.
#[test]
fn rays_through_vertices_and_edges_are_counted_once() {
    let mut counted = 0;
    for soup in [torus(8, 4), cube(-DVec3::ONE, DVec3::ONE)] {
        let mesh = closed(&soup);
        let inside = |ray: &Ray| mesh.intervals(ray).iter().map(|(from, to)| to - from).sum::<f64>();
        let targets: Vec<DVec3> = soup
            .1
            .iter()
            .flat_map(|t| {
                let [a, b, c] = t.map(|corner| soup.0[corner as usize]);
                [a, 0.5 * (a + b), 0.25 * a + 0.75 * c]
            })
            .collect();
        for (index, &target) in targets.iter().enumerate() {
            let other = targets[(7 * index + 3) % targets.len()];
            let outside = target.normalize() * 5.0 + DVec3::new(0.0, 0.3, 0.0);
            for origin in [outside, 3.0 * target - 2.0 * other] {
                let ray = Ray { length: f64::INFINITY, ..Ray::between(origin, target) };
                let length = inside(&ray);
                assert!((0.0..4.0).contains(&length), "{target} from {origin}: {length}");
                // What enters leaves: a leak would make the whole half line inside, and the start with it.
                if !mesh.contains(origin) {
                    let intervals = mesh.intervals(&ray);
                    assert!(intervals.iter().all(|i| i.0 > 0.0 && i.1.is_finite()), "{intervals:?}");
                }
                counted += 1;
            }
        }
    }
    assert!(counted > 200);
}

/// A cube as mesh, as planes and as box are the same region.
#[test]
fn a_convex_mesh_is_its_planes() {
    let (min, max) = (DVec3::new(-1.0, 0.5, 2.0), DVec3::new(0.5, 3.0, 2.5));
    let mesh = closed(&cube(min, max));
    let planes = mesh.convex_planes(64).expect("convex");
    assert_eq!(planes.len(), 6);
    assert_eq!(closed(&turned(cube(min, max))).convex_planes(64).expect("turned back").len(), 6);
    assert_eq!(closed(&torus(9, 5)).convex_planes(64), None);
    assert_eq!(mesh.convex_planes(5), None);
    let hull = Bounds::Hull(Arc::from(planes));
    assert!(hull.bounding_box()[0].distance(min) < 1e-12 && hull.bounding_box()[1].distance(max) < 1e-12);
    let (mesh, cuboid) = (Bounds::Mesh(Arc::new(mesh)), Bounds::Box { min, max });
    let mut worst = Worst::new("mesh against box, m", 1e-12);
    for i in 0..400 {
        let t = f64::from(i);
        let origin = DVec3::new((t * 0.7).sin() * 3.0, (t * 0.3).cos() * 4.0, (t * 1.1).sin() * 4.0);
        let ray = Ray { length: 6.0, ..Ray::between(origin, DVec3::new(-0.2, 1.7, 2.2 + 0.3 * (t * 0.13).sin())) };
        for bounds in [&mesh, &hull] {
            let (a, b) = (bounds.intervals(&ray), cuboid.intervals(&ray));
            assert_eq!(a.len(), b.len(), "{ray:?}");
            for (a, b) in a.iter().zip(&b) {
                worst.record((a.0 - b.0).abs(), || format!("{ray:?}"));
                worst.record((a.1 - b.1).abs(), || format!("{ray:?}"));
            }
        }
    }
    worst.check();
}

/// Two boxes apart along x: optical length and free path go through the gap as if it were not there.
#[test]
fn free_paths_continue_after_a_gap() {
    let soup = joined(cube(DVec3::ZERO, DVec3::ONE), cube(DVec3::new(3.0, 0.0, 0.0), DVec3::new(5.0, 1.0, 1.0)));
    let medium = Medium {
        bounds: Bounds::Mesh(Arc::new(closed(&soup))),
        density: Density::Uniform,
        scatter: Scatter { sigma_s: [1.0; 3], sigma_a: [0.0; 3] },
        ..Medium::default()
    };
    let ray = Ray::new(DVec3::new(-1.0, 0.5, 0.25), DVec3::X, f64::INFINITY);
    assert!((medium.optical_length(&ray) - 3.0).abs() < 1e-12);
    for (target, distance) in [(0.5, 1.5), (0.999, 1.999), (1.5, 4.5), (2.75, 5.75)] {
        assert!((medium.free_path(&ray, target) - distance).abs() < 1e-12, "{target}");
    }
    assert_eq!(medium.free_path(&ray, 3.5), f64::INFINITY);
    assert!(medium.free_path(&Ray { length: 3.0, ..ray }, 1.5).is_infinite());
    assert_eq!(medium.density_at(DVec3::new(2.0, 0.5, 0.5)), 0.0);
    assert_eq!(medium.density_at(DVec3::new(4.0, 0.5, 0.5)), 1.0);
}

#[test]
fn what_encloses_nothing_is_refused() {
    let (positions, triangles) = cube(DVec3::ZERO, DVec3::ONE);
    let refused = |triangles: &[[u32; 3]]| ClosedMesh::new(&positions, triangles).expect_err("refused");
    assert!(matches!(refused(&triangles[1..]), MeshError::Open { edges: 3, .. }));
    let mut one_turned = triangles.clone();
    one_turned[4].swap(0, 1);
    assert!(matches!(refused(&one_turned), MeshError::Turned { edges: 3, .. }));
    assert_eq!(refused(&[[0, 1, 2], [0, 2, 1]]), MeshError::Flat);
    assert_eq!(refused(&[]), MeshError::Flat);
    assert_eq!(refused(&[[0, 1, 99]]), MeshError::Corner { triangle: 0 });
    assert_eq!(refused(&[[0, 0, 0]]), MeshError::Flat);
}

/// Corners split for normals, as glTF has them, are joined again.
#[test]
fn split_corners_are_welded() {
    let (positions, triangles) = cube(DVec3::ZERO, DVec3::ONE);
    let split: Vec<DVec3> = triangles.iter().flatten().map(|&corner| positions[corner as usize]).collect();
    let indices: Vec<[u32; 3]> = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = ClosedMesh::new(&split, &indices).expect("closed once welded");
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (8, 12));
    let planes: Vec<DVec4> = mesh.convex_planes(6).expect("a cube");
    assert!(planes.iter().all(|p| (p.truncate().length() - 1.0).abs() < 1e-12));
}
