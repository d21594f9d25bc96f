//! The lightmapped surface in world space: charts, and the nearest triangle whose normal agrees.

use crate::baked_scene::{BakedScene, Geometry, Lightmap, Node};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Least cosine between a point's normal and a surface's: 60 degrees apart.
const LEAST_AGREEMENT: f32 = 0.5;

/// Triangles within this share of their coordinates' size are equally near: rounding of f32 coordinates.
const TIE: f32 = 4e-6;

/// Most triangles in a leaf of the tree.
const LEAF: usize = 4;

/// A triangle with a lightmap.
#[derive(Debug, Clone)]
pub(super) struct Triangle {
    pub corners: [Vec3; 3],
    /// Page coordinates.
    pub uv: [Vec2; 3],
    /// Unit geometric normal, away from the front.
    normal: Vec3,
    double_sided: bool,
    /// Numbered through the package.
    pub chart: u32,
    pub page: u32,
    /// Index into [`Surface::nodes`].
    pub node: u32,
}

impl Triangle {
    /// Page coordinate at the weights of the second and third corner.
    pub fn uv_at(&self, barycentric: Vec2) -> Vec2 {
        let [a, b, c] = self.uv;
        a + barycentric.x * (b - a) + barycentric.y * (c - a)
    }

    /// Cosine between the normals; a double-sided triangle faces both ways.
    fn agreement(&self, normal: Vec3) -> f32 {
        let cosine = self.normal.dot(normal);
        if self.double_sided { cosine.abs() } else { cosine }
    }
}

/// The place on the surface that a point belongs to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub triangle: u32,
    /// Weights of the second and third corner.
    pub barycentric: Vec2,
    pub distance: f32,
    agreement: f32,
}

/// All lightmapped triangles under a bounding volume tree.
pub(super) struct Surface {
    pub triangles: Vec<Triangle>,
    /// Path of each lightmapped node.
    pub nodes: Vec<String>,
    tree: Vec<Branch>,
}

/// A node of the tree: `count` triangles from `first`, or, for 0, two children at `first` and `first + 1`.
#[derive(Debug, Clone, Copy)]
struct Branch {
    min: Vec3,
    max: Vec3,
    first: u32,
    count: u32,
}

impl Branch {
    fn distance_squared(&self, point: Vec3) -> f32 {
        point.distance_squared(point.clamp(self.min, self.max))
    }
}

impl Surface {
    /// Gathers the triangles and builds the tree.
    pub fn new(scene: &BakedScene) -> Self {
        let mut surface = Self { triangles: Vec::new(), nodes: Vec::new(), tree: Vec::new() };
        let mut charts = 0;
        for node in &scene.nodes {
            if let Some(lightmap) = &node.lightmap {
                surface.add(scene, node, lightmap, &mut charts);
            }
        }
        surface.build();
        surface
    }

    fn add(&mut self, scene: &BakedScene, node: &Node, lightmap: &Lightmap, charts: &mut u32) {
        let geometry = &scene.geometries[node.geometry as usize];
        let chart_of = charts_of(geometry, &lightmap.uv, charts);
        let mirrored = node.world_from_object.matrix3.determinant() < 0.0;
        let (page, owner) = (lightmap.page, self.nodes.len() as u32);
        self.nodes.push(node.path.clone());
        let mut chart = chart_of.into_iter();
        for primitive in &geometry.primitives {
            let double_sided = scene.materials[primitive.material as usize].double_sided;
            for indices in &primitive.triangles {
                let at = indices.map(|vertex| vertex as usize);
                let corners = at.map(|v| node.world_from_object.transform_point3(geometry.positions[v]));
                let chart = chart.next().expect("one chart a triangle");
                let cross = (corners[1] - corners[0]).as_dvec3().cross((corners[2] - corners[0]).as_dvec3());
                // Triangles without area have no side; their neighbours cover them.
                let Some(normal) = cross.try_normalize() else { continue };
                let normal = if mirrored { -normal } else { normal }.as_vec3();
                let uv = at.map(|v| lightmap.uv[v]);
                self.triangles.push(Triangle { corners, uv, normal, double_sided, chart, page, node: owner });
            }
        }
    }

    fn build(&mut self) {
        if self.triangles.is_empty() {
            return;
        }
        self.tree.push(branch(&self.triangles, 0, self.triangles.len()));
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let Branch { first, count, .. } = self.tree[index];
            let (first, count) = (first as usize, count as usize);
            if count <= LEAF {
                continue;
            }
            let range = &mut self.triangles[first..first + count];
            let center = |triangle: &Triangle| triangle.corners.iter().sum::<Vec3>();
            let (low, high) = range
                .iter()
                .map(center)
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
            let axis = (high - low).max_position();
            range.select_nth_unstable_by(count / 2, |a, b| center(a)[axis].total_cmp(&center(b)[axis]));
            let children = self.tree.len();
            self.tree.push(branch(&self.triangles, first, count / 2));
            self.tree.push(branch(&self.triangles, first + count / 2, count - count / 2));
            self.tree[index].first = children as u32;
            self.tree[index].count = 0;
            open.extend([children, children + 1]);
        }
    }

    /// The nearest place whose normal agrees within 60 degrees; of places equally near, the one that agrees best.
    pub fn nearest(&self, point: Vec3, normal: Vec3) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let tie = TIE * (1.0 + point.abs().max_element());
        let mut open = Vec::with_capacity(64);
        open.extend((!self.tree.is_empty()).then_some(0u32));
        while let Some(index) = open.pop() {
            let branch = &self.tree[index as usize];
            let reach = best.map_or(f32::INFINITY, |hit| hit.distance + tie);
            if branch.distance_squared(point) > reach * reach {
                continue;
            }
            if branch.count == 0 {
                let [near, far] = [branch.first, branch.first + 1];
                let nearer_last =
                    self.tree[near as usize].distance_squared(point) < self.tree[far as usize].distance_squared(point);
                open.extend(if nearer_last { [far, near] } else { [near, far] });
                continue;
            }
            for triangle in branch.first..branch.first + branch.count {
                if let Some(hit) = self.hit(triangle, point, normal)
                    && best.is_none_or(|best| hit.beats(&best, tie))
                {
                    best = Some(hit);
                }
            }
        }
        best
    }

    fn hit(&self, index: u32, point: Vec3, normal: Vec3) -> Option<Hit> {
        let triangle = &self.triangles[index as usize];
        let agreement = triangle.agreement(normal);
        (agreement >= LEAST_AGREEMENT).then(|| {
            let (barycentric, distance) = closest(triangle.corners, point);
            Hit { triangle: index, barycentric, distance, agreement }
        })
    }
}

impl Hit {
    /// Distance first; within rounding, agreement; then order, so that results repeat.
    fn beats(&self, other: &Self, tie: f32) -> bool {
        if (self.distance - other.distance).abs() > tie {
            return self.distance < other.distance;
        }
        if (self.agreement - other.agreement).abs() > 1e-3 {
            return self.agreement > other.agreement;
        }
        (self.distance, self.triangle) < (other.distance, other.triangle)
    }
}

fn branch(triangles: &[Triangle], first: usize, count: usize) -> Branch {
    let corners = triangles[first..first + count].iter().flat_map(|triangle| triangle.corners);
    let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), c| (min.min(c), max.max(c)));
    Branch { min, max, first: first as u32, count: count as u32 }
}

/// Closest point of a triangle: weights of the second and third corner, and distance
/// (Ericson 2005, Real-Time Collision Detection, section 5.1.5), in f64.
fn closest(corners: [Vec3; 3], point: Vec3) -> (Vec2, f32) {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let p = point.as_dvec3();
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let (v, w) = if d1 <= 0.0 && d2 <= 0.0 {
        (0.0, 0.0)
    } else if d3 >= 0.0 && d4 <= d3 {
        (1.0, 0.0)
    } else if d6 >= 0.0 && d5 <= d6 {
        (0.0, 1.0)
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        (d1 / (d1 - d3), 0.0)
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        (0.0, d2 / (d2 - d6))
    } else if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        (1.0 - w, w)
    } else {
        let scale = (va + vb + vc).recip();
        (vb * scale, vc * scale)
    };
    ((Vec2::new(v as f32, w as f32)), (a + ab * v + ac * w).distance(p) as f32)
}

/// Chart of each triangle: triangles that share an edge's positions and page coordinates are of one chart.
/// `next` is the first free chart number and moves on.
pub fn charts_of(geometry: &Geometry, uv: &[Vec2], next: &mut u32) -> Vec<u32> {
    let triangles: Vec<[u32; 3]> = geometry.primitives.iter().flat_map(|p| p.triangles.iter().copied()).collect();
    let mut parent: Vec<u32> = (0..triangles.len() as u32).collect();
    fn root(parent: &mut [u32], mut at: u32) -> u32 {
        while parent[at as usize] != at {
            parent[at as usize] = parent[parent[at as usize] as usize];
            at = parent[at as usize];
        }
        at
    }
    let key = |vertex: u32| {
        let (position, uv) = (geometry.positions[vertex as usize], uv[vertex as usize]);
        [position.x, position.y, position.z, uv.x, uv.y].map(f32::to_bits)
    };
    let mut edges: HashMap<[[u32; 5]; 2], u32> = HashMap::new();
    for (index, triangle) in triangles.iter().enumerate() {
        for i in 0..3 {
            let mut edge = [key(triangle[i]), key(triangle[(i + 1) % 3])];
            edge.sort_unstable();
            let neighbour = *edges.entry(edge).or_insert(index as u32);
            let (a, b) = (root(&mut parent, index as u32), root(&mut parent, neighbour));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut numbers = HashMap::new();
    (0..triangles.len() as u32)
        .map(|index| {
            *numbers.entry(root(&mut parent, index)).or_insert_with(|| {
                *next += 1;
                *next - 1
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::SmallRng;
    use rand::{RngExt, SeedableRng};

    fn random_surface(rng: &mut SmallRng, count: usize) -> Surface {
        let mut vector = |size: f32| Vec3::from_array([(); 3].map(|()| rng.random_range(-size..size)));
        let mut triangles = Vec::new();
        for _ in 0..count {
            let origin = vector(10.0);
            let corners = [origin, origin + vector(1.0), origin + vector(1.0)];
            let Some(normal) = (corners[1] - origin).cross(corners[2] - origin).try_normalize() else { continue };
            let uv = [Vec2::ZERO; 3];
            triangles.push(Triangle { corners, uv, normal, double_sided: false, chart: 0, page: 0, node: 0 });
        }
        let mut surface = Surface { triangles, nodes: vec![String::new()], tree: Vec::new() };
        surface.build();
        surface
    }

    #[test]
    fn the_tree_finds_what_brute_force_finds() {
        let mut rng = SmallRng::seed_from_u64(1);
        let mut found = 0;
        for count in [0, 1, 2, 5, 17, 400] {
            let surface = random_surface(&mut rng, count);
            for _ in 0..500 {
                let mut vector = |size: f32| Vec3::from_array([(); 3].map(|()| rng.random_range(-size..size)));
                let (point, normal) = (vector(12.0), vector(1.0).normalize());
                let distances = (0..surface.triangles.len() as u32).filter_map(|t| surface.hit(t, point, normal));
                let nearest = distances.map(|hit| hit.distance).min_by(f32::total_cmp);
                match (surface.nearest(point, normal), nearest) {
                    (None, None) => {}
                    (Some(hit), Some(distance)) => {
                        found += 1;
                        assert!(hit.distance <= distance + 1e-4, "{} against {distance}", hit.distance);
                    }
                    other => panic!("{count} triangles: {other:?}"),
                }
            }
        }
        assert!(found > 1000);
    }

    #[test]
    fn the_closest_point_beats_every_other_point_of_the_triangle() {
        let mut rng = SmallRng::seed_from_u64(2);
        for _ in 0..2000 {
            let mut vector = || Vec3::from_array([(); 3].map(|()| rng.random_range(-1.0f32..1.0)));
            let ([a, b, c], point) = ([vector(), vector(), vector()], 2.0 * vector());
            let (at, distance) = closest([a, b, c], point);
            assert!(at.min_element() >= 0.0 && at.element_sum() <= 1.0 + 1e-6, "{at}");
            assert!(((a + at.x * (b - a) + at.y * (c - a)).distance(point) - distance).abs() < 1e-5);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let other = a + (b - a) * (i as f32 / 20.0) + (c - a) * (j as f32 / 20.0);
                    assert!(other.distance(point) >= distance - 1e-5);
                }
            }
        }
    }
}
