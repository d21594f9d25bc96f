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
    reach: f32,
    /// Stations by bucket, with their cells: a hash of the cell chooses the bucket.
    entries: Vec<(IVec3, u32)>,
    /// First entry of each bucket, and the end; a power of two and one.
    starts: Vec<u32>,
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
        let mut stations = Self { vertices, area, reach: 0.0, entries: vec![], starts: vec![] };
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
        let Self { vertices, area, .. } = &*self;
        let reach = REACH * area.sqrt().max(f32::MIN_POSITIVE);
        let buckets = vertices.len().next_power_of_two();
        let mut entries: Vec<(IVec3, u32)> =
            vertices.iter().zip(0..).map(|(v, i)| (cell(v.origin, reach), i)).collect();
        entries.sort_by_key(|&(cell, index)| (bucket(cell, buckets), index));
        let starts = (0..=buckets).map(|b| entries.partition_point(|e| bucket(e.0, buckets) < b) as u32).collect();
        (self.reach, self.entries, self.starts) = (reach, entries, starts);
    }

    /// The station nearest to a vertex among those near it that look the same way.
    pub fn nearest(&self, vertex: &Vertex) -> Option<u32> {
        let mut best = (0.0, None);
        self.around(vertex, |station, weight| {
            if weight > best.0 {
                best = (weight, Some(station as u32));
            }
        });
        best.1
    }

    /// The box around all stations; empty without any.
    pub fn bounds(&self) -> [Vec3; 2] {
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        self.vertices.iter().fold(empty, |[low, high], v| [low.min(v.origin), high.max(v.origin)])
    }

    /// The stations near a vertex that look the same way, with their weights.
    pub fn around(&self, vertex: &Vertex, mut visit: impl FnMut(usize, f32)) {
        // Cells are twice the reach wide: eight hold all that is near.
        let corner = cell(vertex.origin - self.reach, self.reach);
        for i in 0..8 {
            let cell = corner + IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let bucket = bucket(cell, self.starts.len() - 1);
            for &(at, station) in &self.entries[self.starts[bucket] as usize..self.starts[bucket + 1] as usize] {
                let known = &self.vertices[station as usize];
                let near = 1.0 - known.origin.distance_squared(vertex.origin) / (self.reach * self.reach);
                if near > 0.0 && at == cell && known.normal_geom.dot(vertex.normal_geom) > SAME_SIDE {
                    visit(station as usize, near * near);
                }
            }
        }
    }
}

fn cell(point: Vec3, reach: f32) -> IVec3 {
    (point / (2.0 * reach)).floor().as_ivec3()
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
