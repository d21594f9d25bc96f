//! The trees against the brute-force twin, and watertightness with a leaky test as negative control.

use super::*;
use crate::scene::Light;
use crate::test_scenes::{closed_box, instance, matte, mesh, quad, scene};
use glam::{Mat3, Quat};
use std::f32::consts::TAU;

/// A bumpy closed ball about `centre`, seen from inside, with poles.
fn ball(centre: Vec3, radius: f32, rings: u32, inward: bool) -> crate::scene::Mesh {
    let segments = 2 * rings;
    let mut positions = vec![centre + Vec3::Y * radius, centre - Vec3::Y * radius];
    let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    for ring in 1..rings {
        for segment in 0..segments {
            let (polar, azimuth) = (ring as f32 / rings as f32 * TAU / 2.0, segment as f32 / segments as f32 * TAU);
            let bump = 1.0 + 0.1 * (5.0 * azimuth).sin() * (3.0 * polar).sin();
            let dir = Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin());
            positions.push(centre + radius * bump * dir);
        }
    }
    let mut triangles = Vec::new();
    for segment in 0..segments {
        triangles.push([0, at(1, segment + 1), at(1, segment)]);
        triangles.push([1, at(rings - 1, segment), at(rings - 1, segment + 1)]);
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(r, s)| at(ring + r, segment + s));
            triangles.push([a, b, c]);
            triangles.push([a, c, d]);
        }
    }
    if inward {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    mesh(positions, vec![], triangles, 0)
}

/// Directions spread over the sphere.
fn direction(i: u32) -> Vec3 {
    crate::solve::warp::uniform_sphere((i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877_7).fract())
}

/// Rays from inside a closed mesh aimed at vertices, edge midpoints and anywhere; the number that the test `hits` lets out.
fn escapes(scene: &Scene, origin: Vec3, hits: impl Fn(&Ray) -> bool) -> u32 {
    let mesh = &scene.meshes[0];
    let world = |v: u32| scene.instances[0].world_from_object.transform_point3(mesh.positions[v as usize]);
    let vertices = (0..mesh.positions.len() as u32).map(world);
    let edges = mesh.triangles.iter().map(|&[a, b, _]| 0.5 * (world(a) + world(b)));
    let anywhere = (0..4000).map(|i| origin + direction(i));
    let targets: Vec<Vec3> = vertices.chain(edges).chain(anywhere).collect();
    targets.iter().filter(|&&target| !hits(&Ray { origin, dir: target - origin, t_max: f32::INFINITY })).count() as u32
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    for (offset, scale) in [(0.0, 1.0), (0.0, 1e-3), (1e4, 1.0), (-3e5, 100.0)] {
        let centre = Vec3::new(offset, 0.3 * offset, -0.7 * offset);
        let scene = scene(vec![ball(centre, scale, 24, true)], vec![matte(0.5)]);
        let tracer = Tracer::new(&scene);
        for shift in [Vec3::ZERO, Vec3::new(0.31, 0.17, -0.23)] {
            let origin = centre + shift * scale;
            let lost = escapes(&scene, origin, |ray| tracer.closest_hit(ray).is_some());
            assert_eq!(lost, 0, "offset {offset}, scale {scale}");
            let dark = escapes(&scene, origin, |ray| tracer.transmittance(ray) == Vec3::ZERO);
            assert_eq!(dark, 0, "shadow rays, offset {offset}, scale {scale}");
        }
    }
}

#[test]
fn the_usual_test_leaks() {
    let scene = scene(vec![ball(Vec3::ZERO, 1.0, 24, true)], vec![matte(0.5)]);
    let lost = escapes(&scene, Vec3::new(0.31, 0.17, -0.23), |ray| {
        scene.meshes[0].triangles.iter().any(|&triangle| {
            let [a, b, c] = triangle.map(|v| scene.meshes[0].positions[v as usize]);
            let (ab, ac) = (b - a, c - a);
            let p = ray.dir.cross(ac);
            let inverse = 1.0 / ab.dot(p);
            let s = ray.origin - a;
            let (u, q) = (s.dot(p) * inverse, s.cross(ab));
            let v = ray.dir.dot(q) * inverse;
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) * inverse > 0.0
        })
    });
    assert!(lost > 0, "the negative control must lose rays");
}

#[test]
fn shared_meshes_are_watertight_in_place() {
    let mut scene = scene(vec![ball(Vec3::ZERO, 1.0, 16, true)], vec![matte(0.5)]);
    let turn = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.5, -0.7, 2.0),
        Quat::from_rotation_x(0.4),
        Vec3::new(30.0, -5.0, 12.0),
    );
    scene.instances = vec![instance(0, turn), instance(0, Affine3A::from_translation(Vec3::splat(500.0)))];
    let tracer = Tracer::new(&scene);
    let lost =
        escapes(&scene, turn.transform_point3(Vec3::new(0.2, 0.1, 0.3)), |ray| tracer.closest_hit(ray).is_some());
    assert_eq!(lost, 0);
}

#[test]
fn the_trees_find_what_brute_force_finds() {
    let flip =
        Affine3A::from_mat3_translation(Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0)), Vec3::new(4.0, 0.0, 0.0));
    let turn = Affine3A::from_rotation_translation(Quat::from_rotation_y(1.0), Vec3::new(-3.0, 1.0, 2.0));
    let meshes = vec![ball(Vec3::ZERO, 1.0, 8, false), closed_box(Vec3::splat(-6.0), Vec3::splat(6.0), true, 0)];
    let mut scene = scene(meshes, vec![matte(0.5)]);
    scene.instances = vec![instance(0, flip), instance(0, turn), instance(1, Affine3A::IDENTITY)];
    let tracer = Tracer::new(&scene);
    let mut compared = 0;
    for i in 0..3000 {
        let origin = 5.0 * direction(i * 7 + 1) * (i as f32 * 0.414).fract();
        let ray = Ray { origin, dir: direction(i), t_max: f32::INFINITY };
        let slow = brute_force::closest_hit(&scene, origin.as_dvec3(), ray.dir.as_dvec3());
        let Some((t, instance, triangle)) = slow else { panic!("the box is closed") };
        let fast = tracer.closest_hit(&ray).expect("the box is closed");
        assert!(
            (f64::from(fast.t) / t - 1.0).abs() < 1e-4 || f64::from(fast.t) - t < 1e-5,
            "ray {i}: {} against {t}",
            fast.t
        );
        if (fast.instance, fast.triangle) == (instance, triangle) {
            compared += 1;
        }
        let place = tracer.place(fast.instance, fast.triangle, fast.barycentric);
        let along = origin + fast.t * ray.dir;
        assert!(place.point.position.distance(along) < 1e-4, "ray {i}");
        let inside_out = ray.dir.dot(place.normal_geom) > 0.0;
        assert_eq!(fast.back_face, inside_out, "ray {i}, instance {}", fast.instance);
    }
    assert!(compared > 2950, "{compared} of 3000 name the same triangle (edges may differ)");
}

#[test]
fn blended_surfaces_weaken_and_opaque_ones_block() {
    let wall = |x: f32, material| quad(Vec3::new(x, -1.0, -1.0), Vec3::Y * 2.0, Vec3::Z * 2.0, material);
    let mut glass = matte(1.0);
    glass.alpha_mode = AlphaMode::Blend;
    glass.base_color.w = 0.25;
    let mut hole = matte(1.0);
    hole.alpha_mode = AlphaMode::Mask(0.5);
    hole.base_color.w = 0.4;
    let scene = scene(vec![wall(1.0, 1), wall(2.0, 1), wall(3.0, 2), wall(4.0, 0)], vec![matte(0.5), glass, hole]);
    let tracer = Tracer::new(&scene);
    let left = |x: f32| tracer.transmittance(&Ray { origin: Vec3::ZERO, dir: Vec3::new(x, 0.1, 0.2), t_max: 1.0 }).x;
    assert_eq!(left(0.5), 1.0);
    assert_eq!(left(1.5), 0.75);
    assert_eq!(left(2.5), 0.75 * 0.75);
    assert_eq!(left(3.5), 0.75 * 0.75, "masked out");
    assert_eq!(left(4.5), 0.0);
    let hit = |origin: Vec3| tracer.closest_hit(&Ray { origin, dir: Vec3::X, t_max: 9.0 }).unwrap().instance;
    assert_eq!(hit(Vec3::ZERO), 0);
    assert_eq!(hit(Vec3::X * 2.5), 3, "the mask is a hole");
}

#[test]
fn a_scene_without_geometry_blocks_nothing() {
    let scene = Scene { lights: Vec::<Light>::new(), ..Scene::default() };
    let tracer = Tracer::new(&scene);
    let ray = Ray { origin: Vec3::ZERO, dir: Vec3::X, t_max: 1.0 };
    assert!(tracer.closest_hit(&ray).is_none());
    assert_eq!(tracer.transmittance(&ray), Vec3::ONE);
}

#[test]
fn paths_stay_in_a_closed_room() {
    // Points that hits leave on the edges between walls are what lets paths out: aim at edges and go on from there.
    let room = closed_box(Vec3::new(-1.5, -0.1, -1.5), Vec3::new(1.5, 2.0, 1.5), true, 0);
    let scene = scene(vec![room], vec![matte(0.8)]);
    let tracer = Tracer::new(&scene);
    let inside = Vec3::new(0.1, 0.5, 0.2);
    let mut on_edges = 0;
    for i in 0..40_000 {
        let f = |k: u32| (i as f32 * 0.618_034 + k as f32 * 0.324_717_95).fract();
        let corner = |k: u32| scene.meshes[0].positions[(i + k) as usize % 8];
        let target = corner(0).lerp(corner(1 + i % 3), f(0));
        let Some(hit) = tracer.closest_hit(&Ray { origin: inside, dir: target - inside, t_max: f32::INFINITY }) else {
            panic!("ray {i} has left the room")
        };
        let place = tracer.place(hit.instance, hit.triangle, hit.barycentric);
        on_edges += u32::from(hit.barycentric.min_element().min(1.0 - hit.barycentric.element_sum()) < 1e-6);
        let origin = place.point.offset_along(place.normal_geom);
        for k in 0..4 {
            let dir = crate::solve::warp::about(
                place.normal_geom,
                crate::solve::warp::cosine_hemisphere(f(2 * k), f(2 * k + 1)),
            );
            let ray = Ray { origin, dir, t_max: f32::INFINITY };
            assert!(tracer.closest_hit(&ray).is_some() && tracer.transmittance(&ray) == Vec3::ZERO, "{place:?}, {dir}");
        }
        let outside = Ray { origin, dir: Vec3::new(0.0, 4.0, 0.0) - origin, t_max: 1.0 };
        assert_eq!(tracer.transmittance(&outside), Vec3::ZERO, "{place:?}");
    }
    assert!(on_edges > 1000, "{on_edges} points on edges");
}
