//! Laws that the shapes obey: closed ones close, walls have the area that is left of them.

use glam::{DVec2, DVec3};
use scenes::build::{Opening, Patch, cuboid, lathe, room, wall};
use std::f64::consts::PI;

/// Area vectors (normal times area) of all triangles, and their centres.
fn triangles(patches: &[Patch]) -> Vec<(DVec3, DVec3)> {
    let of_patch = |patch: &Patch| {
        let position = |i: u32| patch.vertices[i as usize].position;
        let one = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(position);
            ((b - a).cross(c - a) / 2.0, (a + b + c) / 3.0)
        };
        patch.triangles.iter().map(|(corners, _)| one(*corners)).collect::<Vec<_>>()
    };
    patches.iter().flat_map(of_patch).collect()
}

/// Sum of area vectors, zero where closed, and the enclosed volume (divergence theorem), negative where inside out.
fn closure_and_volume(patches: &[Patch]) -> (f64, f64) {
    let triangles = triangles(patches);
    let sum: DVec3 = triangles.iter().map(|(area, _)| *area).sum();
    (sum.length(), triangles.iter().map(|(area, centre)| area.dot(*centre) / 3.0).sum())
}

fn sphere() -> Patch {
    let point = |i: i32| DVec2::from_angle(PI * (f64::from(i) / 32.0 - 0.5));
    lathe(&(0..=32).map(point).collect::<Vec<_>>(), 64, Default::default())
}

#[test]
fn closed_shapes_close_and_face_outward() {
    let (low, high) = (DVec3::new(-1.0, 2.0, 0.5), DVec3::new(1.0, 2.5, 2.0));
    let cases: [(&str, Vec<Patch>, f64); 4] = [
        ("cuboid", cuboid(low, high, Default::default()).to_vec(), 1.5),
        ("room", room(low, high, Default::default()).to_vec(), -1.5),
        ("sphere", vec![sphere()], 4.0 / 3.0 * PI),
        ("sphere from inside", vec![sphere().flipped()], -4.0 / 3.0 * PI),
    ];
    for (name, patches, expected) in cases {
        let (open, volume) = closure_and_volume(&patches);
        assert!(open < 1e-12, "{name}: {open}");
        // 64 by 32 facets enclose 0.5 % less than the sphere.
        assert!((volume / expected - 1.0).abs() < 0.006, "{name}: {volume} against {expected}");
    }
}

#[test]
fn an_open_shape_is_seen() {
    let faces = cuboid(DVec3::ZERO, DVec3::ONE, Default::default());
    assert!(closure_and_volume(&faces[..5]).0 > 0.9);
}

#[test]
fn a_wall_lacks_the_area_of_its_openings() {
    let door = Opening { centre: 0.2, half_width: 0.6, sill: 0.0, spring: 1.5 };
    let window = Opening { centre: 0.2, half_width: 0.3, sill: 2.6, spring: 3.0 };
    let top = [(-2.0, 4.0), (0.0, 5.0), (2.0, 4.0)].map(DVec2::from);
    let area: DVec3 = triangles(&[wall([-2.0, 2.0], 0.0, &top, &[door, window], Default::default())])
        .iter()
        .map(|(area, _)| *area)
        .sum();
    // A half circle of 16 segments has the area n/2 sin(π/n) r².
    let opening =
        |o: Opening| 2.0 * o.half_width * (o.spring - o.sill) + 8.0 * (PI / 16.0).sin() * o.half_width.powi(2);
    let expected = 16.0 + 2.0 - opening(door) - opening(window);
    assert!((area.z - expected).abs() < 1e-9 && area.x.abs() < 1e-12, "{area} against {expected}");
}

#[test]
fn reveals_face_the_opening() {
    let window = Opening { centre: 0.0, half_width: 0.5, sill: 1.0, spring: 2.0 };
    let middle = DVec3::new(0.0, 1.7, -0.1);
    for (area, centre) in triangles(&[window.reveal(0.2, false, Default::default())]) {
        assert!(area.dot(middle - centre) > 0.0, "{centre}");
    }
}
