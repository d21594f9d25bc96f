//! Which unit cells a ray passes, and where it enters and leaves each.

use glam::{DVec3, IVec3};

use crate::medium::{Bounds, Ray};

/// Iterator over the cells (named by their lowest corner) of the box [lowest, highest] along a ray, in order.
///
/// Distances come from integer planes each time, so that nothing drifts; a cell that is only touched is left out.
pub struct Walk {
    ray: Ray,
    cell: IVec3,
    lowest: IVec3,
    highest: IVec3,
    at: f64,
    end: f64,
}

/// One cell and the part of the ray inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Lowest corner.
    pub cell: IVec3,
    /// Distance of entry.
    pub from: f64,
    /// Distance of exit.
    pub to: f64,
}

impl Walk {
    /// Walks `ray` (direction of any length) through the cells between two integer corners.
    pub fn new(ray: Ray, lowest: IVec3, highest: IVec3) -> Self {
        let bounds = Bounds::Box { min: lowest.as_dvec3(), max: highest.as_dvec3() };
        let (at, end) = bounds.clip(&ray).unwrap_or((0.0, 0.0));
        let cell = if at < end { ray.at(at).floor().as_ivec3().clamp(lowest, highest - 1) } else { lowest };
        Self { ray, cell, lowest, highest, at, end }
    }

    /// Distance and axis of the next plane crossed.
    fn exit(&self) -> (f64, usize) {
        let ahead = self.cell.as_dvec3() + DVec3::select(self.ray.dir.cmpgt(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
        let distance = |axis: usize| {
            let speed = self.ray.dir[axis];
            if speed == 0.0 { f64::INFINITY } else { (ahead[axis] - self.ray.origin[axis]) / speed }
        };
        let nearer = |a: usize, b: usize| if distance(b) < distance(a) { b } else { a };
        let axis = nearer(nearer(0, 1), 2);
        (distance(axis), axis)
    }
}

impl Iterator for Walk {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        while self.at < self.end {
            let (exit, axis) = self.exit();
            let step = Step { cell: self.cell, from: self.at, to: exit.min(self.end) };
            self.cell[axis] += if self.ray.dir[axis] > 0.0 { 1 } else { -1 };
            let inside = self.cell[axis] >= self.lowest[axis] && self.cell[axis] < self.highest[axis];
            // The last cell takes what rounding left before the border.
            let step = if inside { step } else { Step { to: self.end, ..step } };
            self.at = if inside { self.at.max(step.to) } else { self.end };
            if step.from < step.to {
                return Some(step);
            }
        }
        None
    }
}
