//! The light grid: incident radiance in the air at the nodes of a lattice, gathered once, looked up along every path.
//!
//! Nodes hold l ≤ 2 harmonics of light that comes straight from emitters, straight from surfaces, and of light that
//! collided before, each the mean over the air that looks the node up: what the air scatters is kept as a whole, however wide
//! the cells. What emitters send is found first ([`emitted`]), the rest is filled twice: by a few walks of mode `walk`
//! ([`super::sphere`]), then by many paths that look the first fill up (final gathering). Nothing is iterated; the errors are
//! noise and blur, which brightens what is dark beside what is bright.
//!
//! Emitters are sharp where the rest is smooth. The first leg of a path draws them, where the nodes say that they matter;
//! later legs take them from the nodes.
//!
//! Between nodes isotropic air blends all corners of a cell by trilinear weight; other air, which needs all harmonics, draws
//! one in proportion to it. In cells with geometry one is drawn in any case, and a corner counts only where it is seen from
//! the point, so that light does not pass walls thinner than a cell. The noise of nodes is the same for all texels that look
//! them up and is not part of a texel's variance.

mod border;
mod emitted;
#[cfg(test)]
mod tests;

use self::emitted::Emitted;
use super::LUMINANCE;
use super::air::MOST_LOOKS;
pub use super::grid_size::*;
use super::media::{Deflected, Flight, Fog, InScattered, Leg, Media};
use super::path::{Counters, Paths};
use super::sampler::{Sampler, hash};
use super::sphere::{Incident, Sh9, harmonics};
use crate::progress::{Interrupted, Progress};
use crate::trace::{Ray, Tracer};
use bake_formats::Term;
use bake_optics::medium::MediumSet;
use bake_optics::phase::Phase;
use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

/// Samples of the second fill for one walk of the first, whose noise the second averages over many nodes.
const WALK_SHARE: u32 = 8;
/// Look-ups for each collision, where samples spread as far as a texel's value: the share that leaves the least noise is in
/// proportion to what the air scatters, and inverse to the spread of the rest. Measured as error² × processor time: in a
/// Cornell box, which spreads by 0.6, twice as many as collide take least (half of it: 1.4 times, a quarter: 2.3
/// times as much), in a hall of lamps, sun and sky, which spreads by 1.5, anything from a half to all of them the same.
const USUAL_LOOKS_PER_COLLISION: f32 = 1.15;
/// Limits of it.
const LEAST_LOOKS_PER_COLLISION: f32 = 0.5;
const MOST_LOOKS_PER_COLLISION: f32 = 2.0;
/// Cells along each axis at least.
const FEWEST_CELLS: f64 = 4.0;
/// Rays by which a node learns whether it lies inside something.
const PROBES: u32 = 12;

/// A lattice over the scattering air.
#[derive(Debug, Clone)]
pub struct LightGrid {
    min: Vec3,
    spacing: Vec3,
    /// Nodes along each axis, at least 2.
    size: UVec3,
    /// Whether a node lies outside of solids, in or beside air that scatters.
    free: Vec<bool>,
    /// Whether the corners of the cell above a node are free and all see each other.
    clear: Vec<bool>,
    nodes: Vec<Node>,
}

/// The cell around a point.
struct Cell {
    /// Its lowest corner.
    lowest: UVec3,
    /// Trilinear weight of each corner at the point.
    weights: [f32; 8],
}

/// Light at a node.
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    /// Straight from emitters.
    straight: Sh9,
    /// Straight from surfaces.
    reflected: Sh9,
    /// Collided before.
    collided: Sh9,
    /// Order 0 of light straight from emitters other than lamps.
    drawn: Vec3,
}

impl LightGrid {
    /// Lays out and fills the grid.
    ///
    /// # Errors
    /// [`Interrupted`] when the progress asks to stop.
    pub fn solve(
        paths: &Paths<Fog>,
        settings: GridSettings,
        seed: u32,
        counters: &mut [u64; 3],
        progress: &dyn Progress,
    ) -> Result<Self, Interrupted> {
        let mut grid = Self::lay_out(paths, settings.cells, hash(seed, 0));
        progress.stage("light in the air", 3 * u64::from(grid.node_count()));
        let emitted = grid.emitted(paths, settings.samples, hash(seed, 3), counters, progress)?;
        let walks = settings.samples.div_ceil(WALK_SHARE);
        let walked = grid.fill(paths, walks, hash(seed, 1), counters, progress)?;
        grid.nodes = with_emitted(&walked, &emitted);
        let lit = Lit::new(paths.media.clone(), &grid, paths.tracer);
        let Paths { tracer, emitters, bounces, sh1, .. } = *paths;
        let paths = Paths { tracer, emitters, media: &lit, bounces, sh1 };
        let gathered = grid.fill(&paths, settings.samples, hash(seed, 2), counters, progress)?;
        grid.nodes = with_emitted(&grid.drawn_out(tracer, &gathered), &emitted);
        Ok(grid)
    }

    fn lay_out(paths: &Paths<Fog>, fewest_cells: u32, seed: u32) -> Self {
        let (min, max) = region(paths.media.set, paths.tracer.scene().bounds());
        let size = lattice(paths.media.set, min, max - min, fewest_cells);
        let spacing = (max - min) / (size - 1).as_vec3();
        let mut grid = Self { min, spacing, size, free: vec![], clear: vec![], nodes: vec![] };
        let (count, tracer) = (grid.node_count(), paths.tracer);
        let is_free = |i| {
            let point = grid.position(grid.lattice_point(i));
            grid.has_air(paths.media.set, point) && !is_inside(tracer, point, hash(seed, i))
        };
        grid.free = (0..count).into_par_iter().map(is_free).collect();
        grid.clear = (0..count).into_par_iter().map(|i| grid.is_clear(tracer, i)).collect();
        grid
    }

    /// Light at the nodes that paths find: straight from surfaces, and collided before.
    fn fill<M: Media>(
        &self,
        paths: &Paths<M>,
        samples: u32,
        seed: u32,
        counters: &mut [u64; 3],
        progress: &dyn Progress,
    ) -> Result<Vec<[Sh9; 2]>, Interrupted> {
        let nodes = (0..self.node_count()).into_par_iter().map(|index| {
            let counters = Counters::default();
            let node = self.node(paths, index, samples, hash(seed, index), &counters);
            progress.advance(1);
            if progress.is_cancelled() { Err(Interrupted) } else { Ok((node, counters)) }
        });
        let (nodes, counts): (Vec<_>, Vec<_>) = nodes.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        counts.iter().for_each(|count: &Counters| count.add_to(counters));
        Ok(nodes)
    }

    /// Nodes along each axis.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    fn node_count(&self) -> u32 {
        self.size.element_product()
    }

    fn node<M: Media>(&self, paths: &Paths<M>, index: u32, samples: u32, seed: u32, counters: &Counters) -> [Sh9; 2] {
        if !self.free[index as usize] {
            return Default::default();
        }
        let (at, mut around, mut weights) = (self.lattice_point(index), Incident::default(), 0.0);
        for sample in 0..samples {
            let mut sampler = Sampler::new(sample, seed);
            let [x, y, z, _] = sampler.next4();
            let (point, weight) = self.around(paths.tracer, at, Vec3::new(x, y, z));
            if weight > 0.0 {
                weights += weight;
                around.add_scaled(&paths.reflected_sphere(point, &mut sampler, counters), weight);
            }
        }
        let mean = |term: Term| around.terms[term as usize].map(|sum| sum / f32::max(weights, f32::MIN_POSITIVE));
        let [reflected, single, multiple] = [Term::Indirect, Term::Single, Term::Multiple].map(mean);
        [reflected, std::array::from_fn(|i| single[i] + multiple[i])]
    }

    /// A point that may look a node up, drawn by trilinear weight, and the weight that it has beside others of this node:
    /// more where other corners of its cell are not seen, 0 where this one is not. `u` in [0,1)³.
    fn around(&self, tracer: &Tracer, at: UVec3, u: Vec3) -> (Vec3, f32) {
        let tent = |u: f32| if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() };
        let (node, offset) = (at.as_vec3(), Vec3::new(tent(u.x), tent(u.y), tent(u.z)));
        let outside = (node + offset).cmplt(Vec3::ZERO) | (node + offset).cmpgt((self.size - 1).as_vec3());
        let point = self.min + (node + Vec3::select(outside, -offset, offset)) * self.spacing;
        let cell = self.cell(point);
        if self.clear[self.index(cell.lowest)] {
            return (point, 1.0);
        }
        let seen = |corner: &u32| self.sees_node(tracer, point, self.corner(cell.lowest, *corner));
        if !self.sees_node(tracer, point, at) {
            return (point, 0.0);
        }
        let weights: f32 = (0..8).filter(seen).map(|corner| cell.weights[corner as usize]).sum();
        (point, 1.0 / weights)
    }

    /// Whether anything scatters within a cell of a point.
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
        const INWARDS: f32 = 0.02;
        let inside = at.as_vec3().clamp(Vec3::splat(INWARDS), (self.size - 1).as_vec3() - INWARDS);
        self.min + inside * self.spacing
    }

    fn corner(&self, lowest: UVec3, corner: u32) -> UVec3 {
        lowest + UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2)
    }

    /// Whether all corners of the cell above a lattice point are free and see each other.
    fn is_clear(&self, tracer: &Tracer, index: u32) -> bool {
        let lowest = self.lattice_point(index);
        if (lowest + 1).cmpge(self.size).any() {
            return false;
        }
        let corners: [UVec3; 8] = std::array::from_fn(|i| self.corner(lowest, i as u32));
        corners.iter().all(|&at| self.free[self.index(at)])
            && (0..8).all(|a| (0..a).all(|b| sees(tracer, self.position(corners[a]), self.position(corners[b]))))
    }

    #[inline]
    fn cell(&self, point: Vec3) -> Cell {
        let local = ((point - self.min) / self.spacing).clamp(Vec3::ZERO, (self.size - 1).as_vec3());
        let lowest = local.as_uvec3().min(self.size - 2);
        let share = local - lowest.as_vec3();
        let rest = 1.0 - share;
        let across = [rest.x * rest.y, share.x * rest.y, rest.x * share.y, share.x * share.y];
        // A corner may be all that is seen from its opposite.
        let weight = |corner: usize| (across[corner & 3] * if corner < 4 { rest.z } else { share.z }).max(1e-6);
        let weights = [weight(0), weight(1), weight(2), weight(3), weight(4), weight(5), weight(6), weight(7)];
        Cell { lowest, weights }
    }

    fn sees_node(&self, tracer: &Tracer, point: Vec3, at: UVec3) -> bool {
        self.free[self.index(at)] && sees(tracer, point, self.position(at))
    }

    /// A node near the point: a corner of its cell, or else the nearest that it sees.
    fn pick(&self, tracer: &Tracer, point: Vec3, u: f32) -> Option<usize> {
        self.draw_corner(tracer, point, u).or_else(|| self.nearest_seen(tracer, point))
    }

    /// What the nodes around a point hold, by trilinear weight where it sees all of them, else of one drawn by it.
    fn blend<const N: usize>(&self, tracer: &Tracer, point: Vec3, u: f32, held: &[[f32; N]]) -> [f32; N] {
        let Cell { lowest, weights } = self.cell(point);
        let first = self.index(lowest);
        if !self.clear[first] {
            return self.pick(tracer, point, u).map_or([0.0; N], |node| held[node]);
        }
        let (row, layer) = (self.size.x as usize, (self.size.x * self.size.y) as usize);
        let mut sum = [0.0; N];
        for (corner, weight) in weights.into_iter().enumerate() {
            let node = &held[first + (corner & 1) + (corner >> 1 & 1) * row + (corner >> 2) * layer];
            for (sum, held) in sum.iter_mut().zip(node) {
                *sum += weight * held;
            }
        }
        sum
    }

    /// A corner of the point's cell, drawn in proportion to trilinear weights among those that the point sees.
    fn draw_corner(&self, tracer: &Tracer, point: Vec3, mut u: f32) -> Option<usize> {
        let Cell { lowest, mut weights } = self.cell(point);
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
            if is_clear || self.sees_node(tracer, point, at) {
                return Some(self.index(at));
            }
            u = (1.0 + rest / weights[corner]).clamp(0.0, 1.0 - f32::EPSILON);
            weights[corner] = 0.0;
        }
        None
    }

    /// The nearest node that the point sees, of the cells around its own.
    fn nearest_seen(&self, tracer: &Tracer, point: Vec3) -> Option<usize> {
        let first = self.cell(point).lowest.saturating_sub(UVec3::ONE);
        let around =
            (0..64).map(|i| first + UVec3::new(i % 4, i / 4 % 4, i / 16)).filter(|at| at.cmplt(self.size).all());
        let mut free: Vec<UVec3> = around.filter(|&at| self.free[self.index(at)]).collect();
        let distance = |at: &UVec3| self.position(*at).distance_squared(point);
        free.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        free.iter().find(|&&at| sees(tracer, point, self.position(at))).map(|&at| self.index(at))
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
    /// Where all media are isotropic.
    even: Option<Even>,
    looks_per_collision: f32,
}

/// What isotropic air scatters of the light at the nodes for each unit of `sigma_s`.
struct Even {
    /// Luminance straight from emitters other than lamps, then from surfaces, then collided before.
    parts: Vec<[f32; 8]>,
    /// All kinds of light together.
    whole: Vec<[f32; 4]>,
}

impl Even {
    /// `again`: whether light that collided before counts.
    fn new(nodes: &[Node], again: bool) -> Self {
        // Y_00, which is all that the addition theorem leaves.
        let y = harmonics(Vec3::Z)[0];
        let parts = |node: &Node| {
            let ([a, b, c], [d, e, f]) = ((node.reflected[0] * y).to_array(), (node.collided[0] * y).to_array());
            [y * node.drawn.dot(LUMINANCE), a, b, c, d, e, f, 0.0]
        };
        let whole = |node: &Node| {
            let collided = if again { node.collided[0] } else { Vec3::ZERO };
            (y * (node.straight[0] + node.reflected[0] + collided)).extend(0.0).to_array()
        };
        Self { parts: nodes.iter().map(parts).collect(), whole: nodes.iter().map(whole).collect() }
    }
}

impl<'a, 's> Lit<'a, 's> {
    /// Fog with its light.
    pub fn new(fog: Fog<'a>, grid: &'a LightGrid, tracer: &'a Tracer<'s>) -> Self {
        let moments = |phase: &bake_optics::phase::Phase<f64>| std::array::from_fn(|l| phase.moment(l) as f32);
        let moments: Vec<_> = fog.set.media.iter().map(|medium| moments(&medium.phase)).collect();
        let is_isotropic = fog.set.media.iter().all(|medium| matches!(medium.phase, Phase::Isotropic));
        let even = is_isotropic.then(|| Even::new(&grid.nodes, fog.scatters_again(1)));
        Self { fog, grid, tracer, moments, even, looks_per_collision: MOST_LOOKS_PER_COLLISION }
    }

    /// The same for paths whose samples spread so far about a texel's value, as a share of it: where surfaces are noisy, looks
    /// at the air cost more than they bring.
    pub fn beside(self, spread: f32) -> Self {
        let [least, most] = [LEAST_LOOKS_PER_COLLISION, MOST_LOOKS_PER_COLLISION];
        Self { looks_per_collision: (USUAL_LOOKS_PER_COLLISION / spread).clamp(least, most), ..self }
    }

    /// Σ over media of `sigma_s` Σ_l g_l Σ_m L_lm Y_lm(dir), g_l the phase function's Legendre moments (addition theorem), for
    /// each kind of light.
    fn scattered<const N: usize>(&self, point: Vec3, dir: Vec3, light: [&Sh9; N]) -> [Vec3; N] {
        let y = harmonics(dir);
        let band = |light: &Sh9, range: std::ops::Range<usize>| range.map(|i| light[i] * y[i]).sum::<Vec3>();
        let bands = light.map(|light| [band(light, 0..1), band(light, 1..4), band(light, 4..9)]);
        let mut sum = [Vec3::ZERO; N];
        for (medium, g) in self.fog.set.media.iter().zip(&self.moments) {
            let sigma_s = (DVec3::from(medium.scatter.sigma_s) * medium.density_at(point.as_dvec3())).as_vec3();
            for (sum, [b0, b1, b2]) in sum.iter_mut().zip(bands) {
                *sum += sigma_s * (b0 * g[0] + b1 * g[1] + b2 * g[2]);
            }
        }
        sum
    }
}

impl Media for Lit<'_, '_> {
    const PRESENT: bool = true;
    const CACHED: bool = true;

    fn scatters_again(&self, collisions: u32) -> bool {
        self.fog.scatters_again(collisions)
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

    fn cached(&self, point: Vec3, dir: Vec3, u: f32) -> InScattered {
        if let Some(even) = &self.even {
            let [drawn, a, b, c, d, e, f, _] = self.grid.blend(self.tracer, point, u, &even.parts);
            let sigma_s = self.fog.sigma_s(point);
            return InScattered {
                reflected: sigma_s * Vec3::new(a, b, c),
                collided: sigma_s * Vec3::new(d, e, f),
                drawn: drawn * sigma_s.dot(LUMINANCE),
            };
        }
        let Some(node) = self.grid.pick(self.tracer, point, u) else { return InScattered::default() };
        let node = &self.grid.nodes[node];
        let scattered = self.scattered(point, dir, [&node.reflected, &node.collided]);
        let [reflected, collided] = scattered.map(|light| light.max(Vec3::ZERO));
        InScattered { reflected, collided, drawn: (self.fog.sigma_s(point) * node.drawn).dot(LUMINANCE) }
    }

    fn looks_per_collision(&self) -> f32 {
        self.looks_per_collision
    }

    /// Several where finding one is cheap.
    fn most_looks(&self) -> usize {
        if self.fog.uniform.is_some() { MOST_LOOKS } else { 1 }
    }

    /// Straight light may come out negative in some directions where forward scattering is strong; its integral over
    /// directions, all that the next reflection knows, is right.
    fn cached_whole(&self, point: Vec3, dir: Vec3, u: f32) -> Vec3 {
        if let Some(even) = &self.even {
            let [r, g, b, _] = self.grid.blend(self.tracer, point, u, &even.whole);
            return self.fog.sigma_s(point) * Vec3::new(r, g, b);
        }
        let Some(node) = self.grid.pick(self.tracer, point, u) else { return Vec3::ZERO };
        let node = &self.grid.nodes[node];
        let [straight, reflected, collided] =
            self.scattered(point, dir, [&node.straight, &node.reflected, &node.collided]);
        let collided = if self.scatters_again(1) { collided.max(Vec3::ZERO) } else { Vec3::ZERO };
        straight + reflected.max(Vec3::ZERO) + collided
    }
}

/// Nodes along each axis: close enough for the mean free path where the air is densest.
fn lattice(set: &MediumSet, min: Vec3, size: Vec3, fewest_cells: u32) -> UVec3 {
    const LOOKS: u32 = 16;
    let at = |i: u32| (UVec3::new(i % LOOKS, i / LOOKS % LOOKS, i / (LOOKS * LOOKS)).as_vec3() + 0.5) / LOOKS as f32;
    let densest = (0..LOOKS.pow(3)).flat_map(|i| set.sigma_t((min + at(i) * size).as_dvec3())).fold(0.0, f64::max);
    let side = side(size.as_dvec3());
    let fine = (MOST_FREE_PATHS / densest).min(side / f64::from(fewest_cells));
    let spacing = fine.max(side / f64::from(MOST_CELLS));
    (size.as_dvec3() / spacing).ceil().max(DVec3::splat(FEWEST_CELLS)).as_uvec3() + 1
}

/// Nodes of what paths and what emitters bring.
fn with_emitted(gathered: &[[Sh9; 2]], emitted: &[Emitted]) -> Vec<Node> {
    let node = |([reflected, collided], emitted): (&[Sh9; 2], &Emitted)| Node {
        straight: emitted.straight,
        reflected: *reflected,
        collided: std::array::from_fn(|i| collided[i] + emitted.scattered[i]),
        drawn: emitted.drawn,
    };
    gathered.iter().zip(emitted).map(node).collect()
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
