//! What stands and hangs in the hall.

use super::{Materials, NAVE, VAULT};
use crate::build::{MaterialId, Patch, cuboid, lathe};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Height of the chandeliers' rings.
pub const CHANDELIER_HEIGHT: f64 = 4.7;
/// Radius of the ring, height of the hub above it.
const RING: [f64; 2] = [0.62, 0.9];

/// A bench facing −Z, its middle on the origin.
pub fn bench(materials: &Materials) -> Vec<Patch> {
    let plank = |min: [f64; 3], max: [f64; 3]| cuboid(min.into(), max.into(), materials.wood);
    [
        plank([-0.85, 0.42, -0.24], [0.85, 0.47, 0.20]),
        plank([-0.85, 0.60, 0.20], [0.85, 0.92, 0.24]),
        plank([-0.80, 0.0, -0.20], [-0.74, 0.42, 0.16]),
        plank([0.74, 0.0, -0.20], [0.80, 0.42, 0.16]),
        plank([-0.80, 0.0, 0.16], [-0.74, 0.92, 0.20]),
        plank([0.74, 0.0, 0.16], [0.80, 0.92, 0.20]),
    ]
    .concat()
}

/// Two steps against the far wall with a pedestal on them; the origin is at the wall's foot.
pub fn dais(materials: &Materials) -> Vec<Patch> {
    let step = |half: f64, near: f64, low: f64, high: f64| {
        cuboid(DVec3::new(-half, low, 0.0), DVec3::new(half, high, near), materials.stone)
    };
    let mut patches = [step(2.5, 2.9, 0.0, 0.18), step(1.9, 2.3, 0.18, 0.36)].concat();
    patches.extend(cuboid(DVec3::new(-0.4, 0.36, 1.0), DVec3::new(0.4, 1.06, 1.8), materials.plaster));
    patches
}

/// A vase 1.1 m high, its mouth open but not deep.
pub fn urn(materials: &Materials) -> Patch {
    let profile = [
        (0.17, 0.0),
        (0.18, 0.04),
        (0.12, 0.10),
        (0.15, 0.18),
        (0.24, 0.32),
        (0.31, 0.50),
        (0.33, 0.66),
        (0.29, 0.81),
        (0.20, 0.91),
        (0.15, 0.97),
        (0.16, 1.04),
        (0.21, 1.10),
        (0.19, 1.10),
        (0.14, 1.03),
        (0.12, 0.90),
        (0.0, 0.86),
    ];
    lathe(&profile.map(DVec2::from), 28, materials.clay)
}

/// A ball of 76 cm about the origin.
pub fn ball(materials: &Materials) -> Patch {
    sphere(0.38, [32, 16], materials.vault)
}

fn sphere(radius: f64, [around, up]: [u32; 2], material: MaterialId) -> Patch {
    let point = |i: u32| DVec2::from_angle(PI * f64::from(i) / f64::from(up) - FRAC_PI_2) * radius;
    lathe(&(0..=up).map(point).collect::<Vec<_>>(), around, material)
}

/// A cube of 55 cm on the ground.
pub fn block(materials: &Materials) -> [Patch; 6] {
    cuboid(DVec3::new(-0.275, 0.0, -0.275), DVec3::new(0.275, 0.55, 0.275), materials.plaster)
}

/// A cloth across the nave's wall, waved, its middle above the origin and facing −X.
pub fn banner(cloth: MaterialId) -> Patch {
    let (columns, half, top, bottom) = (12, 0.32, 4.72, 3.3);
    let place = |i: i32| {
        let t = 2.0 * f64::from(i) / f64::from(columns) - 1.0;
        DVec3::new(0.03 * (2.5 * PI * t).cos(), 0.0, t * half)
    };
    let mut patch = Patch::default();
    let mut along = 0.0;
    for i in 0..columns {
        let step = place(i + 1) - place(i);
        let corner = place(i) + DVec3::Y * bottom;
        patch.add_quad(corner, step, DVec3::Y * (top - bottom), DVec2::new(along, 0.0), cloth);
        along += step.length();
    }
    patch
}

/// A ring with eight bulbs, held by four bars from a hub on a rod from the vault. The origin is the ring's middle.
pub fn chandelier(materials: &Materials) -> Vec<Patch> {
    let [radius, hub] = RING;
    let tube = |i: i32| DVec2::new(radius, 0.0) + DVec2::from_angle(TAU * f64::from(i) / 6.0) * 0.035;
    let mut patches = vec![lathe(&(0..=6).map(tube).collect::<Vec<_>>(), 32, materials.bronze)];
    let rod = 0.02;
    patches.extend(bar(DVec3::Y * hub, DVec3::Y * (NAVE + VAULT - CHANDELIER_HEIGHT), rod, materials.bronze));
    for quarter in 0..4 {
        let out = around(FRAC_PI_2 * f64::from(quarter));
        patches.extend(bar(out * radius, DVec3::Y * hub, 0.6 * rod, materials.bronze));
    }
    for eighth in 0..8 {
        let place = around(TAU * (f64::from(eighth) + 0.5) / 8.0) * radius + DVec3::Y * 0.11;
        patches.push(sphere(0.075, [10, 6], materials.bulb).moved(DAffine3::from_translation(place)));
    }
    patches
}

/// The horizontal direction at an angle about Y.
fn around(angle: f64) -> DVec3 {
    DVec3::new(angle.sin(), 0.0, angle.cos())
}

/// A square bar from one point to another.
fn bar(from: DVec3, to: DVec3, half: f64, material: MaterialId) -> [Patch; 6] {
    let length = from.distance(to);
    let place = DAffine3::from_rotation_translation(DQuat::from_rotation_arc(DVec3::Y, (to - from) / length), from);
    cuboid(DVec3::new(-half, 0.0, -half), DVec3::new(half, length, half), material).map(|face| face.moved(place))
}

/// A conical shade on a rod from the aisle's ceiling; its rim is at the origin, its light just below.
pub fn pendant(materials: &Materials) -> Vec<Patch> {
    let shade = [(0.30, 0.0), (0.26, 0.10), (0.12, 0.24), (0.05, 0.28), (0.0, 0.28)];
    let mut patches = vec![lathe(&shade.map(DVec2::from), 24, materials.bronze)];
    patches.extend(bar(DVec3::Y * 0.28, DVec3::Y * 1.6, 0.012, materials.bronze));
    patches
}
