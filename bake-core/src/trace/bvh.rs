//! Four-wide bounding volume hierarchy: built by `obvhs` as a binary tree, collapsed here, traversed by our own code,
//! whose box test is conservative so that no hit is lost.
//!
//! Boxes are grown by 2⁻²¹ of the largest coordinate, and the far distance by 1 + 2γ₃ (Ize 2013, "Robust BVH Ray
//! Traversal"), so that rounding can only add visits. Cost: 128 bytes a node, about one node per two primitives.

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use std::ops::Range;
use std::time::Duration;
use wide::f32x4;

/// 1 + 2γ₃ with γ₃ = 3ε/(1 − 3ε).
const FAR_GROWTH: f32 = 1.0 + 2.0 * (3.0 * 5.960_464_5e-8);
/// Share of the largest coordinate by which boxes grow.
const BOX_GROWTH: f32 = 1.0 / (1u32 << 21) as f32;
/// Directions smaller than this are taken as this, with their sign: 1/x stays finite.
const TINY: f32 = 1e-30;
/// Waiting children of shallow and of usual trees: three a level and the one being opened. Deeper trees take the long way.
const SHALLOW_STACK: usize = 40;
const STACK: usize = 96;
const DEEP_STACK: usize = 2048;

/// Four children: their boxes by axis (minimum x, y, z, maximum x, y, z) and what they hold.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Node {
    bounds: [[f32; 4]; 6],
    /// First primitive of a leaf, or node index.
    first: [u32; 4],
    /// Primitives of a leaf, 0 for an inner child, [`ABSENT`] for none.
    count: [u32; 4],
}

const ABSENT: u32 = u32::MAX;

/// A place in leaf order that holds no primitive.
pub const GAP: u32 = u32::MAX;

/// A tree over primitives that the caller holds in the order of [`Bvh::order`].
#[derive(Debug, Clone, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    levels: usize,
    /// For each place in leaf order, the index of the primitive given to `build`, or [`GAP`].
    pub order: Vec<u32>,
}

/// A box given to the builder.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box of some points; inside out when there are none.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        let empty = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        points.into_iter().fold(empty, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }
}

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        Aabb::new(Vec3A::from(self.min), Vec3A::from(self.max))
    }
}

/// A ray as the box test wants it.
#[derive(Debug, Clone, Copy)]
pub struct BoxRay {
    origin: [f32x4; 3],
    inverse: [f32x4; 3],
    near: [usize; 3],
}

impl BoxRay {
    /// Prepares a ray.
    #[inline]
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        let over = |d: f32| 1.0 / if d.abs() < TINY { TINY.copysign(d) } else { d };
        let inverse = Vec3::new(over(dir.x), over(dir.y), over(dir.z));
        let near = |axis: usize| if inverse[axis] < 0.0 { axis + 3 } else { axis };
        let splat = |v: Vec3| [f32x4::splat(v.x), f32x4::splat(v.y), f32x4::splat(v.z)];
        Self { origin: splat(origin), inverse: splat(inverse), near: [near(0), near(1), near(2)] }
    }
}

impl Bvh {
    /// Builds the tree. Leaves hold at most `leaf_size` primitives and start at multiples of it.
    pub fn build(boxes: &[Bounds], leaf_size: u32) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let params = BvhBuildParams {
            pre_split: false, // a primitive in two leaves would be counted twice by transmittance
            max_prims_per_leaf: leaf_size,
            ..BvhBuildParams::medium_build()
        };
        let tree = build_bvh2(boxes, params, &mut Duration::default());
        let largest = boxes.iter().map(|b| b.min.abs().max(b.max.abs()).max_element()).fold(0.0, f32::max);
        let mut collapse = Collapse { tree: &tree, growth: largest * BOX_GROWTH, leaf_size, bvh: Self::default() };
        collapse.root();
        assert!(3 * collapse.bvh.levels < DEEP_STACK, "a tree of {} levels", collapse.bvh.levels);
        collapse.bvh
    }

    /// Visits the leaves that a ray may meet within `t_max`, nearest first; `leaf` gets a range of places in leaf
    /// order and the current reach, and returns the new reach (a negative one ends the walk).
    #[inline(always)]
    pub fn traverse(&self, ray: &BoxRay, t_max: f32, leaf: impl FnMut(Range<usize>, f32) -> f32) {
        if 3 * self.levels < SHALLOW_STACK {
            self.walk::<SHALLOW_STACK>(ray, t_max, leaf);
        } else if 3 * self.levels < STACK {
            self.walk::<STACK>(ray, t_max, leaf);
        } else {
            self.walk::<DEEP_STACK>(ray, t_max, leaf);
        }
    }

    #[inline(always)]
    fn walk<const N: usize>(&self, ray: &BoxRay, t_max: f32, mut leaf: impl FnMut(Range<usize>, f32) -> f32) {
        if self.nodes.is_empty() {
            return;
        }
        let mut reach = t_max;
        let mut stack = [(0u32, 0u32, 0.0f32); N];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (first, count, near) = stack[depth];
            if near > reach {
                continue;
            }
            if count > 0 {
                reach = leaf(first as usize..(first + count) as usize, reach);
                continue;
            }
            let node = &self.nodes[first as usize];
            let (near, far) = node.distances(ray, reach);
            let bottom = depth;
            for child in 0..4 {
                if near[child] <= far[child] && node.count[child] != ABSENT {
                    let mut at = depth;
                    while at > bottom && stack[at - 1].2 < near[child] {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (node.first[child], node.count[child], near[child]);
                    depth += 1;
                }
            }
        }
    }
}

impl Node {
    #[inline(always)]
    fn distances(&self, ray: &BoxRay, reach: f32) -> ([f32; 4], [f32; 4]) {
        let distance =
            |axis: usize, plane: usize| (f32x4::new(self.bounds[plane]) - ray.origin[axis]) * ray.inverse[axis];
        let near = |axis: usize| distance(axis, ray.near[axis]);
        let far = |axis: usize| distance(axis, (ray.near[axis] + 3) % 6);
        let enter = near(0).fast_max(near(1)).fast_max(near(2)).fast_max(f32x4::ZERO);
        let leave = (far(0).fast_min(far(1)).fast_min(far(2)) * f32x4::splat(FAR_GROWTH)).fast_min(f32x4::splat(reach));
        (enter.to_array(), leave.to_array())
    }
}

/// Turns the binary tree into four-wide nodes.
struct Collapse<'t> {
    tree: &'t Bvh2,
    growth: f32,
    leaf_size: u32,
    bvh: Bvh,
}

impl Collapse<'_> {
    fn root(&mut self) {
        if self.tree.nodes[0].is_leaf() {
            self.node(&[0], 1);
        } else {
            let children = self.widen(0);
            self.node(&children, 1);
        }
    }

    /// Up to four descendants that together stand for a node: the largest inner one is opened first.
    fn widen(&self, index: usize) -> Vec<usize> {
        let open = |i: usize| self.tree.nodes[i].first_index as usize;
        let mut children = vec![open(index), open(index) + 1];
        while children.len() < 4 {
            let area = |&at: &usize| self.tree.nodes[children[at]].aabb().half_area();
            let inner = (0..children.len()).filter(|&at| !self.tree.nodes[children[at]].is_leaf());
            let Some(at) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
            let opened = open(children[at]);
            children[at] = opened;
            children.push(opened + 1);
        }
        children
    }

    /// Appends a node over these children, and everything below; returns its index.
    fn node(&mut self, children: &[usize], level: usize) -> u32 {
        self.bvh.levels = self.bvh.levels.max(level);
        let index = self.bvh.nodes.len();
        self.bvh.nodes.push(Node { bounds: [[0.0; 4]; 6], first: [0; 4], count: [ABSENT; 4] });
        for (slot, &child) in children.iter().enumerate() {
            let node = &self.tree.nodes[child];
            let (min, max) = (node.aabb().min - self.growth, node.aabb().max + self.growth);
            let (first, count) = if node.is_leaf() {
                let start = self.bvh.order.len() as u32;
                let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                self.bvh.order.extend_from_slice(&self.tree.primitive_indices[range]);
                self.bvh.order.resize((start + self.leaf_size) as usize, GAP);
                (start, node.prim_count)
            } else {
                (self.node(&self.widen(child), level + 1), 0)
            };
            let target = &mut self.bvh.nodes[index];
            for axis in 0..3 {
                target.bounds[axis][slot] = min[axis];
                target.bounds[axis + 3][slot] = max[axis];
            }
            target.first[slot] = first;
            target.count[slot] = count;
        }
        index as u32
    }
}
