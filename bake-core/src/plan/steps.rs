//! Hard steps of density within the scene: where tables, which read the mean of a leg's air, err most.

use super::expected::ends_within;
use crate::air::Air;
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::{Density, Medium};
use glam::{DVec3, IVec3};

/// Change from one voxel to the next that makes a step, as a share of the largest density.
const STEP: f32 = 0.5;

/// Names of the media whose density steps.
pub(super) fn steps(air: &Air) -> Vec<&str> {
    let named = air.media.media.iter().zip(&air.names);
    named.filter(|(medium, _)| is_hard(medium, air.scene)).map(|(_, name)| name.as_str()).collect()
}

/// Whether a medium's density falls to nothing at once within the scene, or by more than half between two voxels.
pub(super) fn is_hard(medium: &Medium, scene: [DVec3; 2]) -> bool {
    match &medium.density {
        Density::Grid(grid) => has_steps(grid, ends_within(grid.bounding_box(), scene)),
        _ => ends_within(medium.bounds.bounding_box(), scene),
    }
}

/// `is_inside`: nothing stands beyond the border, too.
fn has_steps(grid: &DensityGrid, is_inside: bool) -> bool {
    let (size, values) = (grid.size(), grid.values());
    let strides = [1, size.x, size.x * size.y];
    let most = STEP * grid.largest() as f32;
    let at = |index: i32| IVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y));
    (0..size.element_product()).any(|index| {
        let (here, place) = (values[index as usize], at(index));
        (0..3).any(|axis| {
            let next = if place[axis] + 1 < size[axis] { Some(values[(index + strides[axis]) as usize]) } else { None };
            let is_border = is_inside && (place[axis] == 0 || next.is_none());
            (is_border && here > most) || next.is_some_and(|next| (next - here).abs() > most)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, MediumSet};
    use glam::DAffine3;
    use std::sync::Arc;

    const SIDE: i32 = 9;

    /// A grid over the unit cube by distance from its middle, in a scene as large or three times as large.
    fn grid(density: impl Fn(f64) -> f64, is_inside: bool) -> Air {
        let at = |i: i32| IVec3::new(i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)).as_dvec3() / f64::from(SIDE - 1);
        let values = (0..SIDE.pow(3)).map(|i| density(at(i).distance(DVec3::splat(0.5))) as f32).collect();
        let placed = DAffine3::from_scale(DVec3::splat(1.0 / f64::from(SIDE - 1)));
        let grid = DensityGrid::new(IVec3::splat(SIDE), values, placed).expect("a grid");
        let around = if is_inside { 1.0 } else { 0.0 };
        let medium = Medium { density: Density::Grid(Arc::new(grid)), ..Medium::default() };
        let scene = [DVec3::splat(-around), DVec3::splat(1.0 + around)];
        Air { media: MediumSet { media: vec![medium] }, names: vec!["smoke".into()], scene }
    }

    #[test]
    fn balls_and_what_is_cut_off_step_and_blobs_do_not() {
        let (ball, blob) = (|r: f64| f64::from(r < 0.3), |r: f64| (-r * r / 0.05).exp());
        for is_inside in [false, true] {
            assert_eq!(steps(&grid(ball, is_inside)), ["smoke"]);
            assert!(steps(&grid(blob, is_inside)).is_empty());
        }
        assert_eq!(steps(&grid(|_| 1.0, true)), ["smoke"], "cut off within the scene");
        assert!(steps(&grid(|_| 1.0, false)).is_empty(), "it ends where the scene does");
        let mut cube = grid(blob, true);
        cube.media.media[0].density = Density::Uniform;
        cube.media.media[0].bounds = Bounds::Box { min: DVec3::splat(0.3), max: DVec3::splat(0.7) };
        assert_eq!(steps(&cube), ["smoke"]);
    }
}
