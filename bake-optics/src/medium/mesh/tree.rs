//! A small tree of boxes over triangles, for all crossings of a half line; halved at the median of the longest axis.

use glam::DVec3;

use crate::medium::Ray;

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// The tree. Nodes lie depth first: a branch's first child follows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    nodes: Vec<Node>,
}

/// A box of the tree, and where a walk goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshBox {
    /// Lowest corner, metres.
    pub min: DVec3,
    /// Highest corner, metres.
    pub max: DVec3,
    /// The box after all that this one holds; the one after a box that is met is its neighbour in the list.
    pub next: u32,
    /// Triangles of a leaf; empty for a branch.
    pub triangles: std::ops::Range<u32>,
}

#[derive(Debug, Clone, PartialEq)]
struct Node {
    min: DVec3,
    max: DVec3,
    /// First triangle of a leaf, or the node that follows this branch's first child.
    at: u32,
    /// Triangles of a leaf; 0 for a branch.
    count: u32,
}

impl Tree {
    /// Over at least one triangle; reorders them.
    pub fn new(positions: &[DVec3], triangles: &mut [[u32; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(triangles.len()) };
        tree.build(positions, triangles, 0);
        tree
    }

    /// Lowest and highest corner of all.
    pub fn bounds(&self) -> [DVec3; 2] {
        [self.nodes[0].min, self.nodes[0].max]
    }

    /// All boxes, depth first.
    pub fn boxes(&self) -> Vec<MeshBox> {
        let mut next = vec![self.nodes.len() as u32; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.count == 0) {
            next[node.at as usize] = next[index];
            next[index + 1] = node.at;
        }
        let triangles = |node: &Node| if node.count > 0 { node.at..node.at + node.count } else { 0..0 };
        let boxed =
            |(node, next): (&Node, u32)| MeshBox { min: node.min, max: node.max, next, triangles: triangles(node) };
        self.nodes.iter().zip(next).map(boxed).collect()
    }

    fn build(&mut self, positions: &[DVec3], triangles: &mut [[u32; 3]], first: u32) {
        let corners = triangles.iter().flatten().map(|&corner| positions[corner as usize]);
        let (min, max) = corners
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), corner| (min.min(corner), max.max(corner)));
        let node = self.nodes.len();
        self.nodes.push(Node { min, max, at: first, count: triangles.len() as u32 });
        if triangles.len() <= LEAF {
            return;
        }
        let axis = (max - min).max_position();
        let middle = triangles.len() / 2;
        let centre = |t: &[u32; 3]| t.iter().map(|&corner| positions[corner as usize][axis]).sum::<f64>();
        triangles.select_nth_unstable_by(middle, |a, b| centre(a).total_cmp(&centre(b)).then(a.cmp(b)));
        let (low, high) = triangles.split_at_mut(middle);
        self.build(positions, low, first);
        let second = self.nodes.len() as u32;
        self.build(positions, high, first + middle as u32);
        self.nodes[node] = Node { min, max, at: second, count: 0 };
    }

    /// Calls `visit` with all triangles whose boxes the ray's half line (whatever its length) may meet.
    pub fn for_each_met(&self, ray: &Ray, mut visit: impl FnMut(usize)) {
        let line = Line { origin: ray.origin, dir: ray.dir, dir_abs: ray.dir.abs() };
        let mut open = vec![0usize];
        while let Some(index) = open.pop() {
            let node = &self.nodes[index];
            if !line.may_meet(node.min, node.max) {
                continue;
            }
            if node.count > 0 {
                (node.at..node.at + node.count).for_each(|triangle| visit(triangle as usize));
            } else {
                open.extend([index + 1, node.at as usize]);
            }
        }
    }
}

struct Line {
    origin: DVec3,
    dir: DVec3,
    dir_abs: DVec3,
}

impl Line {
    /// Separating axes of line and box (Ericson 2005, section 5.3.3), with slack above the rounding of the crossing test.
    fn may_meet(&self, min: DVec3, max: DVec3) -> bool {
        let (centre, half) = (0.5 * (min + max), 0.5 * (max - min));
        let from_centre = self.origin - centre;
        let slack = 1e-13 * (self.origin.abs() + centre.abs() + half).element_sum();
        let apart = from_centre.cross(self.dir).abs();
        let d = self.dir_abs;
        let reach = DVec3::new(half.y * d.z + half.z * d.y, half.z * d.x + half.x * d.z, half.x * d.y + half.y * d.x);
        // The farthest corner along the ray must not lie behind its start.
        let ahead = half.dot(d) - from_centre.dot(self.dir);
        apart.cmple(reach + slack).all() && ahead >= -slack
    }
}
