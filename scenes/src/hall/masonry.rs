//! The hall's walls, vault, columns and floor.

use super::{AISLE, AISLE_CEILING, BAY, COLUMN, LENGTH, Materials, NAVE, VAULT, WALL};
use crate::build::{Opening, Patch, cuboid, extrude, lathe, wall};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// The arch between two columns.
const ARCH: Opening = Opening { centre: 0.0, half_width: BAY / 2.0 - 0.35, sill: COLUMN, spring: COLUMN };
/// The window above it.
const CLERESTORY: Opening = Opening { centre: 0.0, half_width: 0.45, sill: 5.15, spring: 5.7 };
/// The window of an aisle.
const WINDOW: Opening = Opening { centre: 0.0, half_width: 0.85, sill: 0.9, spring: 3.1 };
/// The window above the dais.
pub const FAR_WINDOW: Opening = Opening { centre: 0.0, half_width: 0.95, sill: 3.4, spring: 6.4 };
/// How far windows reach back.
const REVEAL: f64 = 0.5;
/// How far ribs stand out from the vault, and their width.
const RIB: [f64; 2] = [0.16, 0.36];
/// Width and length of a floor tile.
const TILE: [f64; 2] = [0.8, 0.85];

/// Tiles in two tones with a carpet along the axis, in one chart.
pub fn floor(materials: &Materials) -> Patch {
    let mut patch = Patch::default();
    let (columns, rows) = ((2.0 * AISLE / TILE[0]).round() as u32, (LENGTH / TILE[1]).round() as u32);
    for row in 0..rows {
        for column in 0..columns {
            let chart = DVec2::new(f64::from(column) * TILE[0], f64::from(row) * TILE[1]);
            let corner = DVec3::new(chart.x - AISLE, 0.0, -chart.y);
            let is_carpet = column == columns / 2 - 1 || column == columns / 2;
            let tile = if is_carpet { materials.carpet } else { materials.tiles[((row + column) % 2) as usize] };
            patch.add_quad(corner, DVec3::X * TILE[0], -DVec3::Z * TILE[1], chart, tile);
        }
    }
    patch
}

/// A half circle about the start of the vault, from right to left.
fn vault_arc(radius: f64) -> Vec<DVec2> {
    let segments = 40;
    let point = |i: i32| DVec2::new(0.0, VAULT) + DVec2::from_angle(PI * f64::from(i) / f64::from(segments)) * radius;
    (0..=segments).map(point).collect()
}

/// One bay of the barrel vault, reaching back from z = 0.
pub fn vault(materials: &Materials) -> Patch {
    extrude(&vault_arc(NAVE), BAY, materials.vault)
}

/// An arch under the vault, about z = 0.
pub fn rib(materials: &Materials) -> [Patch; 3] {
    let half = RIB[1] / 2.0;
    let (outer, inner) = (vault_arc(NAVE), vault_arc(NAVE - RIB[0]));
    let soffit = extrude(&inner, RIB[1], materials.stone).moved(DAffine3::from_translation(DVec3::Z * half));
    let mut front = Patch::default();
    for (o, i) in outer.windows(2).zip(inner.windows(2)) {
        front.add_polygon(&[i[0], o[0], o[1], i[1]], half, materials.stone);
    }
    let back = front.clone().moved(DAffine3::from_rotation_y(PI));
    [soffit, front, back]
}

/// One bay of an arcade: nave face, aisle face, the arch's soffit and the reveal of the window above.
pub fn arcade(materials: &Materials) -> [Patch; 4] {
    let sides = [-BAY / 2.0, BAY / 2.0];
    let flat = |height| sides.map(|s| DVec2::new(s, height));
    let nave = wall(sides, COLUMN, &flat(VAULT), &[ARCH, CLERESTORY], materials.plaster);
    let aisle = wall(sides, COLUMN, &flat(AISLE_CEILING), &[ARCH], materials.plaster)
        .moved(DAffine3::from_rotation_y(PI))
        .moved(DAffine3::from_translation(-DVec3::Z * WALL));
    [nave, aisle, ARCH.reveal(WALL, true, materials.stone), CLERESTORY.reveal(WALL, false, materials.stone)]
}

/// One bay of an outer wall: the wall, its window's reveal and bars, the aisle's ceiling.
pub fn outer_wall(materials: &Materials) -> Vec<Patch> {
    let sides = [-BAY / 2.0, BAY / 2.0];
    let top = sides.map(|s| DVec2::new(s, AISLE_CEILING));
    let ceiling = DVec3::new(sides[0], AISLE_CEILING, 0.0);
    let depth = AISLE - NAVE - WALL;
    let mut patches = vec![
        wall(sides, 0.0, &top, &[WINDOW], materials.plaster),
        WINDOW.reveal(REVEAL, false, materials.stone),
        Patch::quad(ceiling, DVec3::X * BAY, DVec3::Z * depth, materials.vault),
    ];
    patches.extend(bars(WINDOW, materials));
    patches
}

/// A window's mullion and transoms.
fn bars(window: Opening, materials: &Materials) -> Vec<Patch> {
    let (half, z) = (0.03, -0.6 * REVEAL);
    let bar = |low: DVec2, high: DVec2| cuboid(low.extend(z - half), high.extend(z + half), materials.bronze);
    let top = window.spring + window.half_width;
    let mut bars = bar(DVec2::new(-half, window.sill), DVec2::new(half, top)).to_vec();
    for y in [window.sill + (window.spring - window.sill) / 2.0, window.spring] {
        bars.extend(bar(DVec2::new(-window.half_width, y - half), DVec2::new(window.half_width, y + half)));
    }
    bars
}

/// The wall across nave and aisles, facing +Z.
pub fn end_wall(window: Option<Opening>, materials: &Materials) -> Vec<Patch> {
    let mut top = vault_arc(NAVE);
    top.reverse();
    let mut patches = vec![wall([-NAVE, NAVE], 0.0, &top, window.as_slice(), materials.plaster)];
    let rectangle = |from: f64, to: f64, height: f64| {
        Patch::quad(DVec3::X * from, DVec3::X * (to - from), DVec3::Y * height, materials.plaster)
    };
    for (from, to, height) in [(NAVE, NAVE + WALL, COLUMN), (NAVE + WALL, AISLE, AISLE_CEILING)] {
        patches.push(rectangle(from, to, height));
        patches.push(rectangle(-to, -from, height));
    }
    if let Some(window) = window {
        patches.push(window.reveal(REVEAL, false, materials.stone));
        patches.extend(bars(window, materials));
    }
    patches
}

/// A column: plinth, turned base, shaft and capital, abacus.
pub fn column(materials: &Materials) -> Vec<Patch> {
    let profile = [
        (0.37, 0.22),
        (0.40, 0.25),
        (0.40, 0.30),
        (0.37, 0.33),
        (0.335, 0.35),
        (0.335, 0.38),
        (0.355, 0.40),
        (0.355, 0.44),
        (0.31, 0.47),
        (0.30, 0.52),
        (0.305, 1.20),
        (0.295, 2.00),
        (0.265, 2.66),
        (0.29, 2.69),
        (0.29, 2.73),
        (0.265, 2.75),
        (0.28, 2.84),
        (0.33, 2.94),
        (0.38, 3.00),
    ];
    let mut patches = block(0.82, 0.0, 0.22, materials);
    patches.push(lathe(&profile.map(DVec2::from), 24, materials.stone));
    patches.extend(block(0.82, 3.0, COLUMN, materials));
    patches
}

/// A square slab about the axis.
fn block(width: f64, low: f64, high: f64, materials: &Materials) -> Vec<Patch> {
    let half = DVec3::new(width / 2.0, 0.0, width / 2.0);
    cuboid(DVec3::Y * low - half, DVec3::Y * high + half, materials.stone).to_vec()
}

/// Half a pier against an end wall.
pub fn pilaster(materials: &Materials) -> [Patch; 6] {
    cuboid(DVec3::new(-0.36, 0.0, -0.175), DVec3::new(0.36, COLUMN, 0.175), materials.stone)
}

/// Two mouldings along the right wall of the nave.
pub fn cornices(materials: &Materials) -> Vec<Patch> {
    let run = |out: f64, low: f64, high: f64| {
        cuboid(DVec3::new(NAVE - out, low, -LENGTH), DVec3::new(NAVE, high, 0.0), materials.stone)
    };
    let steps = [(0.22, VAULT - 0.10, VAULT), (0.14, VAULT - 0.20, VAULT - 0.10), (0.09, 4.80, 4.92)];
    steps.into_iter().flat_map(|(out, low, high)| run(out, low, high)).collect()
}
