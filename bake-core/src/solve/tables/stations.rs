//! Points spread evenly over the surfaces of a scene, and what is known there looked up from anywhere.

use crate::scene::Scene;
use crate::solve::path::Vertex;
use crate::solve::sampler::hash;
use crate::solve::warp;
use crate::trace::{Tracer, world_triangle};
use glam::{IVec3, Vec3};

/// Reach of a station in units of their mean spacing.
const REACH: f32 = 2.0;
/// Cosine between normals above which a station speaks for a point.
const SAME_SIDE: f32 = 0.8;
/// Steps of the additive recurrence that spreads points over triangles (Roberts 2018, R2).
const R2: [f32; 2] = [0.754_877_7, 0.569_840_3];

/// Points of surfaces, each for the same area.
pub struct Stations {
    /// Where light is gathered.
    pub vertices: Vec<Vertex>,
    /// Area of surface per station, m².
    pub area: f32,
    /// What speaks for a point: stations within reach.
    near: Index,
    /// The nearest is mostly nearer than half the reach: a quarter as many are asked.
    nearest: Index,
}

/// Stations within a radius of any point.
#[derive(Default)]
struct Index {
    radius: f32,
    /// By bucket: a hash of the cell chooses it.
    entries: Vec<Entry>,
    /// First entry of each bucket, and the end; a power of two and one.
    starts: Vec<u32>,
}

struct Entry {
    cell: IVec3,
    station: u32,
    point: Vec3,
    normal: Vec3,
}

impl Stations {
    /// Spreads about `count` stations.
    pub fn new(tracer: &Tracer, count: usize) -> Self {
        let sides = sides(tracer.scene());
        let mut sum = 0.0;
        let cumulative: Vec<f64> = sides
            .iter()
            .map(|(i, t, _)| {
                let [a, b, c] = world_triangle(tracer.scene(), *i, *t);
                sum += f64::from(0.5 * (b - a).cross(c - a).length());
                sum
            })
            .collect();
        let vertex = |k: usize| {
            let target = (k as f64 + 0.5) / count as f64 * sum;
            let (instance, triangle, side) = sides[cumulative.partition_point(|&a| a <= target).min(sides.len() - 1)];
            let [u, v] = R2.map(|step| (0.5 + step * k as f32).fract());
            let barycentric = warp::triangle(u, v);
            let place = tracer.place(instance, triangle, barycentric);
            Vertex::on(tracer, (instance, triangle, barycentric), &place, side)
        };
        let vertices: Vec<Vertex> = if sum > 0.0 { (0..count).map(vertex).collect() } else { vec![] };
        let area = (sum / count as f64) as f32;
        let mut stations = Self { vertices, area, near: Index::default(), nearest: Index::default() };
        stations.index();
        stations
    }

    /// Leaves out some stations; of `known`, what belongs to the others.
    pub fn retain<T>(&mut self, known: Vec<T>, without: &[bool]) -> Vec<T> {
        let mut keep = without.iter().map(|w| !w);
        self.vertices.retain(|_| keep.next().unwrap_or(true));
        self.index();
        known.into_iter().zip(without).filter(|(_, without)| !**without).map(|(known, _)| known).collect()
    }

    fn index(&mut self) {
        let reach = REACH * self.area.sqrt().max(f32::MIN_POSITIVE);
        (self.near, self.nearest) = (Index::new(&self.vertices, reach), Index::new(&self.vertices, 0.5 * reach));
    }

    /// The station nearest to a vertex among those near it that look the same way.
    pub fn nearest(&self, vertex: &Vertex) -> Option<u32> {
        let nearest = |index: &Index| {
            let mut best = (f32::INFINITY, None);
            index.around(vertex, |station, square| {
                if square < best.0 {
                    best = (square, Some(station));
                }
            });
            best.1
        };
        nearest(&self.nearest).or_else(|| nearest(&self.near))
    }

    /// The box around all stations; empty without any.
    pub fn bounds(&self) -> [Vec3; 2] {
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        self.vertices.iter().fold(empty, |[low, high], v| [low.min(v.origin), high.max(v.origin)])
    }

    /// The stations near a vertex that look the same way, with their weights.
    pub fn around(&self, vertex: &Vertex, mut visit: impl FnMut(usize, f32)) {
        let over_square = 1.0 / (self.near.radius * self.near.radius);
        self.near.around(vertex, |station, square| {
            let near = 1.0 - square * over_square;
            visit(station as usize, near * near);
        });
    }
}

impl Index {
    fn new(vertices: &[Vertex], radius: f32) -> Self {
        let buckets = vertices.len().next_power_of_two();
        let entry = |(vertex, station): (&Vertex, u32)| {
            let (point, normal) = (vertex.origin, vertex.normal_geom);
            Entry { cell: cell(point, radius), station, point, normal }
        };
        let mut entries: Vec<Entry> = vertices.iter().zip(0..).map(entry).collect();
        entries.sort_by_key(|entry| (bucket(entry.cell, buckets), entry.station));
        let starts = (0..=buckets).map(|b| entries.partition_point(|e| bucket(e.cell, buckets) < b) as u32).collect();
        Self { radius, entries, starts }
    }

    /// Stations nearer than the radius that look the same way as a vertex, with the squares of their distances.
    fn around(&self, vertex: &Vertex, mut visit: impl FnMut(u32, f32)) {
        // Cells are twice the radius wide: eight hold all that is near.
        let corner = cell(vertex.origin - self.radius, self.radius);
        for i in 0..8 {
            let cell = corner + IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let bucket = bucket(cell, self.starts.len() - 1);
            for entry in &self.entries[self.starts[bucket] as usize..self.starts[bucket + 1] as usize] {
                let square = entry.point.distance_squared(vertex.origin);
                if square < self.radius * self.radius
                    && entry.cell == cell
                    && entry.normal.dot(vertex.normal_geom) > SAME_SIDE
                {
                    visit(entry.station, square);
                }
            }
        }
    }
}

fn cell(point: Vec3, radius: f32) -> IVec3 {
    (point / (2.0 * radius)).floor().as_ivec3()
}

fn bucket(cell: IVec3, buckets: usize) -> usize {
    hash(hash(cell.x as u32, cell.y as u32), cell.z as u32) as usize & (buckets - 1)
}

/// Sides of triangles that light can reach: instance, triangle, front (1) or back (−1).
fn sides(scene: &Scene) -> Vec<(u32, u32, f32)> {
    let mut sides = Vec::new();
    for (index, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh as usize];
        for primitive in &mesh.primitives {
            let double_sided = scene.materials[primitive.material as usize].double_sided;
            for triangle in primitive.triangles.clone() {
                sides.push((index as u32, triangle, 1.0));
                if double_sided {
                    sides.push((index as u32, triangle, -1.0));
                }
            }
        }
    }
    sides
}
