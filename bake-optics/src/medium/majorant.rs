//! Delta tracking through a density grid under a coarse grid of upper bounds; empty blocks are skipped in one step.
//!
//! *Source*: Woodcock et al. 1965; Novák et al. 2018, section 4. For grids whose exact walk ([`DensityGrid::free_path`])
//! passes too many cells; both draw from the same distribution.

use glam::{DVec3, IVec3};

use crate::medium::Ray;
use crate::medium::grid::DensityGrid;
use crate::medium::walk::Walk;

/// Largest density per block of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct MajorantGrid {
    block: i32,
    size: IVec3,
    bounds: Vec<f64>,
}

/// What tracking found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracked {
    /// Distance of the collision; infinite where there is none.
    pub distance: f64,
    /// How often the density was looked up: the cost.
    pub lookups: u32,
}

impl MajorantGrid {
    /// Bounds for blocks of `block`³ cells (8 to 16 serves most grids). Zero counts as one.
    pub fn new(grid: &DensityGrid, block: u32) -> Self {
        let block = block.clamp(1, 1 << 20) as i32;
        // Cells run from −1 to size − 1 on each axis: size + 1 of them.
        let size = (grid.size() + block) / block;
        let blocks = (0..size.z).flat_map(|z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| (x, y, z))));
        let bounds = blocks.map(|b| largest(grid, IVec3::from(b) * block - 1, block)).collect();
        Self { block, size, bounds }
    }

    /// Samples a collision along `ray` for extinction `sigma_t` at density 1, drawing numbers in [0, 1) from `random`.
    ///
    /// The probability of none is exactly exp(−sigma_t × optical length).
    pub fn track(&self, grid: &DensityGrid, ray: &Ray, sigma_t: f64, mut random: impl FnMut() -> f64) -> Tracked {
        let mut lookups = 0;
        for step in self.walk(grid, ray) {
            let majorant = self.bound(step.cell);
            if majorant * sigma_t <= 0.0 {
                continue;
            }
            let mut at = step.from;
            loop {
                at -= (-random()).ln_1p() / (majorant * sigma_t);
                if at >= step.to {
                    break;
                }
                lookups += 1;
                if random() * majorant < grid.at(ray.at(at)) {
                    return Tracked { distance: at, lookups };
                }
            }
        }
        Tracked { distance: f64::INFINITY, lookups }
    }

    fn walk(&self, grid: &DensityGrid, ray: &Ray) -> Walk {
        let local = grid.local(ray);
        let scale = 1.0 / f64::from(self.block);
        Walk::new(Ray::new((local.origin + DVec3::ONE) * scale, local.dir * scale, ray.length), IVec3::ZERO, self.size)
    }

    fn bound(&self, at: IVec3) -> f64 {
        let (at, size) = (at.as_usizevec3(), self.size.as_usizevec3());
        self.bounds[at.x + size.x * (at.y + size.y * at.z)]
    }
}

/// The largest lattice value of the cells from `lowest`; one more point than cells on each axis.
fn largest(grid: &DensityGrid, lowest: IVec3, block: i32) -> f64 {
    let high = (lowest + block).min(grid.size() - 1);
    let low = lowest.max(IVec3::ZERO);
    let mut bound = 0.0f64;
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            bound = (low.x..=high.x).map(|x| grid.value(IVec3::new(x, y, z))).fold(bound, f64::max);
        }
    }
    bound
}
