//! Dense density grids: trilinear between lattice points, exact optical length cell by cell.
//!
//! Inside a cell the trilinear density is a cubic polynomial of the distance along a ray, which two Gauss–Legendre nodes
//! integrate exactly. No step size, hence no step-size error.

use glam::{BVec3, DAffine3, DVec3, IVec3};

use crate::medium::Ray;
use crate::medium::invert::{self, Monotone};
use crate::medium::walk::Walk;

/// Density ≥ 0 at the points of a lattice.
///
/// In grid space the point (i, j, k) lies at those coordinates; beyond the outermost points the density falls to zero
/// within one cell, so that it is continuous everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct DensityGrid {
    size: IVec3,
    values: Vec<f32>,
    grid_from_world: DAffine3,
}

/// What a density grid refuses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridError {
    /// A size of zero or beyond 2^20 points along an axis.
    #[error("density grid: size {0} must lie in 1..=1048576 on every axis")]
    Size(IVec3),
    /// Not as many values as points.
    #[error("density grid: {got} values for a size that needs {need}")]
    Count {
        /// Values given.
        got: usize,
        /// Product of the size.
        need: usize,
    },
    /// A value that is negative or not finite.
    #[error("density grid: value {value} at index {index} must be finite and not negative")]
    Value {
        /// Where, x fastest.
        index: usize,
        /// What.
        value: f32,
    },
    /// A placement without an inverse.
    #[error("density grid: its placement in the world has no finite inverse")]
    Placement,
}

impl DensityGrid {
    /// A grid of `size` points with `values` in order x fastest, then y, then z, placed by `world_from_grid`.
    pub fn new(size: IVec3, values: Vec<f32>, world_from_grid: DAffine3) -> Result<Self, GridError> {
        if size.min_element() < 1 || size.max_element() > 1 << 20 {
            return Err(GridError::Size(size));
        }
        let need = size.as_i64vec3().element_product() as usize;
        if values.len() != need {
            return Err(GridError::Count { got: values.len(), need });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, v)| !(v.is_finite() && **v >= 0.0)) {
            return Err(GridError::Value { index, value });
        }
        let grid_from_world = world_from_grid.inverse();
        if !grid_from_world.is_finite() || world_from_grid.matrix3.determinant() == 0.0 {
            return Err(GridError::Placement);
        }
        Ok(Self { size, values, grid_from_world })
    }

    /// Lattice points along x, y, z.
    pub fn size(&self) -> IVec3 {
        self.size
    }

    /// The values, x fastest, then y, then z.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The largest value; no density is larger.
    pub fn largest(&self) -> f64 {
        f64::from(self.values.iter().copied().fold(0.0, f32::max))
    }

    /// Its placement: the lattice point (i, j, k) lies at the image of these coordinates.
    pub fn world_from_grid(&self) -> DAffine3 {
        self.grid_from_world.inverse()
    }

    /// Lowest and highest corner of the box beyond which the density is zero.
    pub fn bounding_box(&self) -> [DVec3; 2] {
        let placed = self.world_from_grid();
        let (low, high) = (DVec3::NEG_ONE, self.size.as_dvec3());
        let corner =
            |i: u32| placed.transform_point3(DVec3::select(BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low));
        (0..8).map(corner).fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], c| [min.min(c), max.max(c)])
    }

    /// The density at a world point.
    pub fn at(&self, point: DVec3) -> f64 {
        let local = self.grid_from_world.transform_point3(point);
        if local.cmple(DVec3::NEG_ONE).any() || local.cmpge(self.size.as_dvec3()).any() {
            return 0.0;
        }
        self.cell(local.floor().as_ivec3()).at(local)
    }

    /// Integral of the density along the ray, metres at density 1.
    pub fn optical_length(&self, ray: &Ray) -> f64 {
        let local = self.local(ray);
        self.walk(ray).map(|step| self.cell(step.cell).optical_length(&local, step.from, step.to)).sum()
    }

    /// Distance after which the optical length reaches `target`; infinite where it does not within the ray.
    pub fn free_path(&self, ray: &Ray, target: f64) -> f64 {
        if target <= 0.0 {
            return 0.0;
        }
        let local = self.local(ray);
        let mut passed = 0.0;
        for step in self.walk(ray) {
            let cell = self.cell(step.cell);
            let here = cell.optical_length(&local, step.from, step.to);
            if passed + here >= target {
                let path = Monotone {
                    value: |s| cell.optical_length(&local, step.from, step.from + s),
                    slope: |s| cell.at(local.at(step.from + s)),
                    limit: step.to - step.from,
                };
                let inside = invert::solve(path, target - passed);
                return step.from + inside.min(step.to - step.from);
            }
            passed += here;
        }
        f64::INFINITY
    }

    /// The value at a lattice point; zero outside.
    pub(crate) fn value(&self, at: IVec3) -> f64 {
        if at.cmplt(IVec3::ZERO).any() || at.cmpge(self.size).any() {
            return 0.0;
        }
        let (at, size) = (at.as_usizevec3(), self.size.as_usizevec3());
        f64::from(self.values[at.x + size.x * (at.y + size.y * at.z)])
    }

    /// The ray in grid space: same distances along it, direction not a unit vector.
    pub(crate) fn local(&self, ray: &Ray) -> Ray {
        let origin = self.grid_from_world.transform_point3(ray.origin);
        Ray::new(origin, self.grid_from_world.transform_vector3(ray.dir), ray.length)
    }

    fn walk(&self, ray: &Ray) -> Walk {
        Walk::new(self.local(ray), IVec3::NEG_ONE, self.size)
    }

    fn cell(&self, lowest: IVec3) -> Cell {
        let corners = std::array::from_fn(|i| {
            let i = i as i32;
            self.value(lowest + IVec3::new(i & 1, i >> 1 & 1, i >> 2))
        });
        Cell { lowest: lowest.as_dvec3(), corners }
    }
}

/// Eight values around a unit cell, x fastest.
struct Cell {
    lowest: DVec3,
    corners: [f64; 8],
}

impl Cell {
    fn at(&self, local: DVec3) -> f64 {
        let f = (local - self.lowest).clamp(DVec3::ZERO, DVec3::ONE);
        let c = &self.corners;
        let along_x = |i: usize| c[i] * (1.0 - f.x) + c[i + 1] * f.x;
        let along_y = |i: usize| along_x(i) * (1.0 - f.y) + along_x(i + 2) * f.y;
        along_y(0) * (1.0 - f.z) + along_y(4) * f.z
    }

    /// Two Gauss–Legendre nodes at 1/2 ± 1/(2√3), exact for cubics.
    fn optical_length(&self, local: &Ray, from: f64, to: f64) -> f64 {
        const OFFSET: f64 = 0.288_675_134_594_812_9;
        let (middle, length) = (0.5 * (from + to), to - from);
        0.5 * length * (self.at(local.at(middle - OFFSET * length)) + self.at(local.at(middle + OFFSET * length)))
    }
}
