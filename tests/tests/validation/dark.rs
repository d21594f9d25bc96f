//! Rooms that no light can reach are exactly dark: nothing leaks through walls, corners or a layout's gaps.

use bake_tests::ledger::Ledger;
use bake_tests::points::{Point, on_surfaces};
use bake_tests::program::Baked;

/// Texels from a wall within which a look-up takes in a texel of the other side. Where a wall is thinner than a texel, the
/// texels under it belong to the room that their middle lies in, and a bilinear look-up reaches one texel along each axis of
/// the chart: √2 where the chart lies askew.
const REACH: f64 = std::f64::consts::SQRT_2;

/// Brightest of the points that must be dark, as a share of the mean of the others.
fn leak(baked: &Baked, must_be_dark: impl Fn(&Point) -> bool, is_lit: impl Fn(&Point) -> bool) -> f64 {
    let sampler = baked.sampler();
    let (mut dark, mut lit, mut count) = ((0.0f64, 0), 0.0, 0);
    for point in on_surfaces(&baked.package, 8000) {
        let sample = sampler.sample(point.position.as_vec3(), point.normal.as_vec3()).expect("on a surface");
        let light = f64::from(sample.irradiance.max_element());
        if must_be_dark(&point) {
            dark = (dark.0.max(light), dark.1 + 1);
        } else if is_lit(&point) {
            (lit, count) = (lit + light, count + 1);
        }
    }
    assert!(dark.1 > 500 && count > 500, "{} dark and {count} lit points", dark.1);
    dark.0 / (lit / f64::from(count))
}

#[test]
fn a_closed_room_in_the_sun() {
    let baked = Baked::own("sealed_room", "--page-size 128 --max-pages 1 --samples 64");
    let ledger = Ledger::new("Leaks", "sealed_room");
    ledger.at_most("brightest inside / mean outside", leak(&baked, |p| p.node == "room", |p| p.node == "ground"), 0.0);
    let ground = leak(&baked, |p| p.node == "ground", |p| p.node == "ground" || p.node == "room");
    ledger.refused("the ground taken for the inside", ground.min(1e9), 0.0);
}

#[test]
fn behind_two_centimetres_of_wall() {
    let baked = Baked::own("thin_wall", "--page-size 128 --max-pages 1 --samples 64");
    let ledger = Ledger::new("Leaks", "thin_wall");
    let [left, right] = scenes::thin_wall::WALL;
    let beyond = |p: &Point| p.position.x >= right + if p.node == "wall" { -1e-5 } else { REACH * p.texel };
    let before = |p: &Point| p.position.x <= left + 1e-5;
    ledger.at_most("brightest behind / mean before", leak(&baked, beyond, before), 0.0);
    let everywhere = leak(&baked, |p| p.position.x >= left + 1e-4, before);
    ledger.note("brightest behind, look-ups across the wall included", everywhere);
    ledger.note("farthest of these from the wall, texels", farthest_lit(&baked, right));
    ledger.refused("the lit room taken for the dark one", leak(&baked, before, beyond).min(1e9), 0.0);
}

/// Distance of the farthest lit point behind a wall whose far side is at `x`, in texels.
fn farthest_lit(baked: &Baked, x: f64) -> f64 {
    let sampler = baked.sampler();
    let is_lit = |p: &Point| {
        let sample = sampler.sample(p.position.as_vec3(), p.normal.as_vec3());
        sample.is_some_and(|sample| sample.irradiance.max_element() > 0.0)
    };
    let behind = on_surfaces(&baked.package, 8000).into_iter().filter(|p| p.position.x > x && is_lit(p));
    behind.map(|p| (p.position.x - x) / p.texel).fold(0.0, f64::max)
}
