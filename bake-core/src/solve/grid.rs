//! The light grid: incident radiance in the air at the nodes of a lattice, gathered once, looked up along every path.
//!
//! Nodes hold l ≤ 2 harmonics of light that comes straight from surfaces and of light that collided before; light
//! straight from emitters is drawn where it is needed, exactly. Nodes are filled by the same walks as mode `walk`
//! ([`super::sphere`]), so the grid's only error is interpolation: no sweeps, nothing to converge.
//!
//! Between nodes one corner of the cell is drawn in proportion to its trilinear weight. In cells with geometry a corner
//! counts only where it is seen from the point, so that light does not pass walls thinner than a cell. The noise of nodes
//! is the same for all texels that look them up and is not part of a texel's variance.

use super::media::{Deflected, Flight, Fog, Leg, Media};
use super::path::{Counters, Paths};
use super::sampler::{Sampler, hash};
use super::sphere::{Incident, Sh9, harmonics};
use crate::progress::{Interrupted, Progress};
use crate::trace::{Ray, Tracer};
use bake_formats::Term;
use bake_optics::medium::MediumSet;
use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

/// Largest distance of nodes, in mean free paths: measured in impulse responses' section 12.5.
pub const MOST_FREE_PATHS: f64 = 0.45;
/// Cells along a side at most.
pub const MOST_CELLS: u32 = 40;
/// Rays by which a node learns whether it lies inside something.
const PROBES: u32 = 12;

/// How fine the grid is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridSettings {
    /// Cells along the region's longest side at least.
    pub cells: u32,
    /// Walks a node.
    pub samples: u32,
}

/// A lattice over the scattering air.
#[derive(Debug, Clone)]
pub struct LightGrid {
    min: Vec3,
    spacing: Vec3,
    /// Nodes along each axis, at least 2.
    size: UVec3,
    nodes: Vec<Node>,
    /// Whether the corners of a cell all see each other.
    clear: Vec<bool>,
}

/// Light at a node.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Straight from surfaces.
    once: Sh9,
    /// Collided before.
    more: Sh9,
    /// Whether it lies in free air.
    valid: bool,
}

impl LightGrid {
    /// Lays out and fills the grid.
    pub fn solve(
        paths: &Paths<Fog>,
        settings: GridSettings,
        seed: u32,
        counters: &mut [u64; 3],
        progress: &dyn Progress,
    ) -> Result<Self, Interrupted> {
        let (min, max) = region(paths.media.set, paths.tracer.scene().bounds());
        let size = lattice(paths.media.set, min, max - min, settings.cells);
        let spacing = (max - min) / (size - 1).as_vec3();
        let mut grid = Self { min, spacing, size, nodes: vec![], clear: vec![] };
        progress.stage("light in the air", u64::from(size.element_product()));
        let nodes = (0..size.element_product()).into_par_iter().map(|index| {
            let node = grid.node(paths, index, settings.samples, hash(seed, index));
            progress.advance(1);
            if progress.is_cancelled() { Err(Interrupted) } else { Ok(node) }
        });
        let (nodes, counts): (Vec<_>, Vec<_>) = nodes.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        counts.iter().for_each(|count: &Counters| count.add_to(counters));
        grid.nodes = nodes;
        grid.clear = (0..grid.nodes.len() as u32).into_par_iter().map(|i| grid.is_clear(paths.tracer, i)).collect();
        Ok(grid)
    }

    /// Nodes along each axis.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    fn node(&self, paths: &Paths<Fog>, index: u32, samples: u32, seed: u32) -> (Node, Counters) {
        let (point, counters) = (self.position(self.lattice_point(index)), Counters::default());
        let dark = Node { once: Sh9::default(), more: Sh9::default(), valid: true };
        if is_inside(paths.tracer, point, seed) {
            return (Node { valid: false, ..dark }, counters);
        }
        if !self.has_air(paths.media.set, point) {
            return (dark, counters);
        }
        let mut sum = Incident::default();
        for sample in 0..samples {
            let one = paths.gather_sphere(point, false, &mut Sampler::new(sample, seed), &counters);
            sum.add_scaled(&one, 1.0 / samples as f32);
        }
        let of = |term: Term| sum.terms[term as usize];
        let more = std::array::from_fn(|i| of(Term::Single)[i] + of(Term::Multiple)[i]);
        (Node { once: of(Term::Indirect), more, valid: true }, counters)
    }

    /// Whether anything scatters within a cell of the point.
    fn has_air(&self, set: &MediumSet, point: Vec3) -> bool {
        let offsets = |i: u32| UVec3::new(i % 5, i / 5 % 5, i / 25).as_vec3() * 0.5 - 1.0;
        (0..125).any(|i| {
            let at = (point + offsets(i) * self.spacing).clamp(self.min, self.max());
            set.sigma_s(at.as_dvec3()).iter().any(|&sigma| sigma > 0.0)
        })
    }

    fn max(&self) -> Vec3 {
        self.min + self.spacing * (self.size - 1).as_vec3()
    }

    fn lattice_point(&self, index: u32) -> UVec3 {
        UVec3::new(index % self.size.x, index / self.size.x % self.size.y, index / (self.size.x * self.size.y))
    }

    fn index(&self, at: UVec3) -> usize {
        (at.x + self.size.x * (at.y + self.size.y * at.z)) as usize
    }

    /// Nodes on the border are moved inwards a little, off the walls that often stand there.
    fn position(&self, at: UVec3) -> Vec3 {
        const INWARDS: f32 = 1e-3;
        let inside = at.as_vec3().clamp(Vec3::splat(INWARDS), (self.size - 1).as_vec3() - INWARDS);
        self.min + inside * self.spacing
    }

    fn corner(&self, lowest: UVec3, corner: u32) -> UVec3 {
        lowest + UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2)
    }

    /// Whether all corners of the cell above a lattice point are valid and see each other.
    fn is_clear(&self, tracer: &Tracer, index: u32) -> bool {
        let lowest = self.lattice_point(index);
        if (lowest + 1).cmpge(self.size).any() {
            return false;
        }
        let corners: [UVec3; 8] = std::array::from_fn(|i| self.corner(lowest, i as u32));
        corners.iter().all(|&at| self.nodes[self.index(at)].valid)
            && (0..8).all(|a| (0..a).all(|b| sees(tracer, self.position(corners[a]), self.position(corners[b]))))
    }

    /// A node near the point, drawn in proportion to trilinear weights among the corners of its cell that it sees.
    fn pick(&self, tracer: &Tracer, point: Vec3, mut u: f32) -> Option<&Node> {
        let local = ((point - self.min) / self.spacing).clamp(Vec3::ZERO, (self.size - 1).as_vec3());
        let lowest = local.as_uvec3().min(self.size - 2);
        let share = local - lowest.as_vec3();
        let mut weights: [f32; 8] = std::array::from_fn(|corner| {
            let along = |axis: usize| if corner >> axis & 1 == 1 { share[axis] } else { 1.0 - share[axis] };
            // A corner may be all that is seen from its opposite.
            (along(0) * along(1) * along(2)).max(1e-6)
        });
        let is_clear = self.clear[self.index(lowest)];
        // Corners that are not seen are put away one by one: what remains keeps its proportions.
        for _ in 0..8 {
            let total: f32 = weights.iter().sum();
            let mut rest = u * total;
            let corner = (0..8).find(|&i| {
                rest -= weights[i];
                rest < 0.0
            });
            let corner = corner.unwrap_or_else(|| (0..8).rfind(|&i| weights[i] > 0.0).unwrap_or(0));
            let at = self.corner(lowest, corner as u32);
            let node = &self.nodes[self.index(at)];
            if is_clear || (node.valid && sees(tracer, point, self.position(at))) {
                return Some(node);
            }
            u = (1.0 + rest / weights[corner]).clamp(0.0, 1.0 - f32::EPSILON);
            weights[corner] = 0.0;
        }
        self.nearest_seen(tracer, point, lowest)
    }

    /// The nearest node that the point sees, of the cells around its own.
    fn nearest_seen(&self, tracer: &Tracer, point: Vec3, lowest: UVec3) -> Option<&Node> {
        let first = lowest.saturating_sub(UVec3::ONE);
        let around =
            (0..64).map(|i| first + UVec3::new(i % 4, i / 4 % 4, i / 16)).filter(|at| at.cmplt(self.size).all());
        let mut valid: Vec<UVec3> = around.filter(|&at| self.nodes[self.index(at)].valid).collect();
        let distance = |at: &UVec3| self.position(*at).distance_squared(point);
        valid.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        valid.iter().find(|&&at| sees(tracer, point, self.position(at))).map(|&at| &self.nodes[self.index(at)])
    }
}

/// Air whose light the grid knows.
pub struct Lit<'a, 's> {
    /// The air.
    pub fog: Fog<'a>,
    /// The light in it.
    pub grid: &'a LightGrid,
    /// For what stands between a point and the nodes.
    pub tracer: &'a Tracer<'s>,
    /// Legendre moments l ≤ 2 of each medium's phase function.
    moments: Vec<[f32; 3]>,
}

impl<'a, 's> Lit<'a, 's> {
    /// Fog with its light.
    pub fn new(fog: Fog<'a>, grid: &'a LightGrid, tracer: &'a Tracer<'s>) -> Self {
        let moments = |phase: &bake_optics::phase::Phase<f64>| std::array::from_fn(|l| phase.moment(l) as f32);
        let moments = fog.set.media.iter().map(|medium| moments(&medium.phase)).collect();
        Self { fog, grid, tracer, moments }
    }
}

impl Media for Lit<'_, '_> {
    const PRESENT: bool = true;
    const CACHED: bool = true;

    fn scatters_again(&self) -> bool {
        self.fog.scatters_again()
    }

    fn transmittance(&self, leg: &Leg) -> Vec3 {
        self.fog.transmittance(leg)
    }

    fn scattering_stretch(&self, leg: &Leg) -> Option<(f32, f32)> {
        self.fog.scattering_stretch(leg)
    }

    fn fly(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Flight {
        self.fog.fly(leg, throughput, u)
    }

    fn collide(&self, leg: &Leg, throughput: Vec3, u: [f32; 2]) -> Option<(f32, Vec3)> {
        self.fog.collide(leg, throughput, u)
    }

    fn scatter(&self, point: Vec3, from: Vec3, to: Vec3) -> Vec3 {
        self.fog.scatter(point, from, to)
    }

    fn deflect(&self, point: Vec3, dir: Vec3, u: [f32; 3]) -> Option<Deflected> {
        self.fog.deflect(point, dir, u)
    }

    fn deflect_pdf(&self, point: Vec3, dir: Vec3, to: Vec3) -> f32 {
        self.fog.deflect_pdf(point, dir, to)
    }

    /// Σ over media of `sigma_s` Σ_l g_l Σ_m L_lm Y_lm(dir), g_l the phase function's Legendre moments (addition theorem).
    fn cached(&self, point: Vec3, dir: Vec3, u: f32) -> [Vec3; 2] {
        let Some(node) = self.grid.pick(self.tracer, point, u) else { return [Vec3::ZERO; 2] };
        let y = harmonics(dir);
        let band = |light: &Sh9, range: std::ops::Range<usize>| range.map(|i| light[i] * y[i]).sum::<Vec3>();
        let bands = [&node.once, &node.more].map(|light| [band(light, 0..1), band(light, 1..4), band(light, 4..9)]);
        let mut scattered = [Vec3::ZERO; 2];
        for (medium, g) in self.fog.set.media.iter().zip(&self.moments) {
            let sigma_s = (DVec3::from(medium.scatter.sigma_s) * medium.density_at(point.as_dvec3())).as_vec3();
            for (sum, [b0, b1, b2]) in scattered.iter_mut().zip(bands) {
                *sum += sigma_s * (b0 * g[0] + b1 * g[1] + b2 * g[2]).max(Vec3::ZERO);
            }
        }
        scattered
    }
}

/// The box in which light is gathered: around what scatters, or around the scene where that has no end.
pub(crate) fn region(set: &MediumSet, [low, high]: [Vec3; 2]) -> (Vec3, Vec3) {
    // Air that goes on much farther than the scene is lit there as on the border.
    let margin = (high - low).max_element();
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for medium in set.media.iter().filter(|m| m.scatter.sigma_s.iter().any(|&s| s > 0.0)) {
        let [a, b] = medium.bounds.bounding_box().map(|corner| corner.as_vec3());
        min = min.min(a.max(low - margin));
        max = max.max(b.min(high + margin));
    }
    (min, max.max(min + 1e-3))
}

/// Nodes along each axis: close enough for the mean free path where the air is densest.
fn lattice(set: &MediumSet, min: Vec3, size: Vec3, fewest_cells: u32) -> UVec3 {
    const LOOKS: u32 = 16;
    let at = |i: u32| (UVec3::new(i % LOOKS, i / LOOKS % LOOKS, i / (LOOKS * LOOKS)).as_vec3() + 0.5) / LOOKS as f32;
    let densest = (0..LOOKS.pow(3)).flat_map(|i| set.sigma_t((min + at(i) * size).as_dvec3())).fold(0.0, f64::max);
    let spacing = (MOST_FREE_PATHS / densest).min(f64::from(size.max_element()) / f64::from(fewest_cells));
    let cells = (size.as_dvec3() / spacing).ceil().clamp(DVec3::splat(3.0), DVec3::splat(f64::from(MOST_CELLS)));
    cells.as_uvec3() + 1
}

fn sees(tracer: &Tracer, from: Vec3, to: Vec3) -> bool {
    tracer.transmittance(&Ray { origin: from, dir: to - from, t_max: 1.0 }) != Vec3::ZERO
}

/// Whether most rays from a point meet the backs of single-sided surfaces.
fn is_inside(tracer: &Tracer, point: Vec3, seed: u32) -> bool {
    let turn = hash(seed, 1) as f32 / u32::MAX as f32;
    let backs = (0..PROBES).filter(|&i| {
        let (u, v) = ((i as f32 + 0.5) / PROBES as f32, (i as f32 * 0.618_034 + turn).fract());
        let ray = Ray { origin: point, dir: super::warp::uniform_sphere(u, v), t_max: f32::INFINITY };
        super::texels::meets_back(tracer, &ray)
    });
    2 * backs.count() as u32 > PROBES
}
