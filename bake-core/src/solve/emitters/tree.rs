//! A tree over all emitters of finite distance, from which one is drawn roughly in proportion to what it can send to
//! a point. Source: Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! in the form of Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, 12.6.3 (no splitting).

use glam::Vec3;
use std::f32::consts::PI;

/// What is known of a group of emitters.
#[derive(Debug, Clone, Copy)]
pub struct LightBounds {
    /// Box of their positions.
    pub min: Vec3,
    /// Box of their positions.
    pub max: Vec3,
    /// Axis of the cone that holds their axes.
    pub axis: Vec3,
    /// Cosine of that cone's half angle.
    pub cos_spread: f32,
    /// Cosine of the angle beyond an axis at which emission ends.
    pub cos_emission: f32,
    /// Largest intensity, cd: radiance times area for surfaces.
    pub intensity: f32,
    /// Emission on both sides.
    pub two_sided: bool,
}

/// [`LightBounds`] as draws ask them.
#[derive(Debug, Clone, Copy)]
struct Group {
    centre: Vec3,
    /// Of the ball around the box, squared.
    radius2: f32,
    axis: Vec3,
    cos_spread: f32,
    sin_spread: f32,
    cos_emission: f32,
    intensity: f32,
    two_sided: bool,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    group: Group,
    parent: u32,
    /// Left child is the next node; a leaf holds [`LEAF`] here.
    right: u32,
    emitter: u32,
}

const LEAF: u32 = u32::MAX;
const BUCKETS: usize = 12;

/// The tree. Node 0 is the root.
#[derive(Debug, Default)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// Node of each emitter; [`LEAF`] for those that emit nothing.
    leaf_of: Vec<u32>,
}

impl LightTree {
    /// Builds the tree over emitters given by their bounds; those without intensity are left out.
    pub fn build(emitters: &[LightBounds]) -> Self {
        let mut items: Vec<u32> =
            (0..emitters.len() as u32).filter(|&i| emitters[i as usize].intensity > 0.0).collect();
        let mut tree = Self { nodes: Vec::new(), leaf_of: vec![LEAF; emitters.len()] };
        if !items.is_empty() {
            tree.grow(emitters, &mut items, 0, 0);
        }
        tree
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Draws an emitter for a receiver at `point` with unit `normal`, zero for one in the air; returns it with its
    /// probability.
    pub fn sample(&self, point: Vec3, normal: Vec3, mut u: f32) -> Option<(u32, f32)> {
        let mut at = 0;
        let mut probability = 1.0;
        if self.nodes.is_empty() {
            return None;
        }
        while self.nodes[at].right != LEAF {
            let left = self.left_share(at, point, normal)?;
            if u < left {
                u /= left;
                probability *= left;
                at += 1;
            } else {
                u = (u - left) / (1.0 - left);
                probability *= 1.0 - left;
                at = self.nodes[at].right as usize;
            }
            u = u.min(1.0 - f32::EPSILON);
        }
        // Below the root only children of some importance are taken.
        let is_lit = at > 0 || self.nodes[0].group.importance(point, normal) > 0.0;
        is_lit.then(|| (self.nodes[at].emitter, probability))
    }

    /// Draws an emitter for the air along the segment from `a` to `b`; returns it with its probability.
    ///
    /// Roughly in proportion to what reaches the segment, intensity over distance, whatever the direction of emission:
    /// a cone may cross the segment anywhere.
    pub fn sample_segment(&self, a: Vec3, b: Vec3, mut u: f32) -> Option<(u32, f32)> {
        if self.nodes.is_empty() {
            return None;
        }
        let (mut at, mut probability) = (0, 1.0);
        while self.nodes[at].right != LEAF {
            let right = self.nodes[at].right as usize;
            let importance = [at + 1, right].map(|child| self.nodes[child].group.importance_along(a, b));
            let left = importance[0] / (importance[0] + importance[1]);
            let (share, next) = if u < left { (left, at + 1) } else { (1.0 - left, right) };
            u = if u < left { u / left } else { (u - left) / (1.0 - left) }.min(1.0 - f32::EPSILON);
            probability *= share;
            at = next;
        }
        Some((self.nodes[at].emitter, probability))
    }

    /// The probability with which [`Self::sample`] draws an emitter.
    pub fn probability(&self, emitter: u32, point: Vec3, normal: Vec3) -> f32 {
        let mut at = self.leaf_of[emitter as usize];
        if at == LEAF || (at == 0 && self.nodes[0].group.importance(point, normal) <= 0.0) {
            return 0.0;
        }
        let mut probability = 1.0;
        while at != 0 {
            let parent = self.nodes[at as usize].parent;
            let Some(left) = self.left_share(parent as usize, point, normal) else { return 0.0 };
            probability *= if at == parent + 1 { left } else { 1.0 - left };
            at = parent;
        }
        probability
    }

    /// Share of the left child; `None` when neither can light the point.
    fn left_share(&self, at: usize, point: Vec3, normal: Vec3) -> Option<f32> {
        let left = self.nodes[at + 1].group.importance(point, normal);
        let right = self.nodes[self.nodes[at].right as usize].group.importance(point, normal);
        (left + right > 0.0).then(|| left / (left + right))
    }

    fn grow(&mut self, emitters: &[LightBounds], items: &mut [u32], parent: u32, depth: u32) {
        let index = self.nodes.len();
        let bounds = LightBounds::union_of(items.iter().map(|&i| emitters[i as usize]));
        if let [emitter] = *items {
            self.leaf_of[emitter as usize] = index as u32;
            self.nodes.push(Node { group: Group::new(&bounds), parent, right: LEAF, emitter });
            return;
        }
        self.nodes.push(Node { group: Group::new(&bounds), parent, right: 0, emitter: 0 });
        let middle = split(emitters, items, &bounds, depth);
        let (left, right) = items.split_at_mut(middle);
        self.grow(emitters, left, index as u32, depth + 1);
        self.nodes[index].right = self.nodes.len() as u32;
        self.grow(emitters, right, index as u32, depth + 1);
    }
}

/// Orders `items` so that a cheap split lies at the returned place (0 < place < len).
fn split(emitters: &[LightBounds], items: &mut [u32], bounds: &LightBounds, depth: u32) -> usize {
    let extent = bounds.max - bounds.min;
    let centre = |i: u32, axis: usize| emitters[i as usize].centre()[axis];
    let best = (0..3)
        .filter(|&axis| extent[axis] > 0.0)
        .flat_map(|axis| candidates(emitters, items, bounds, axis))
        .min_by(|a, b| a.cost.total_cmp(&b.cost));
    if let (Some(best), true) = (best, depth < 48) {
        let bucket = |i: u32| bucket_of(centre(i, best.axis), bounds, best.axis);
        items.sort_by_key(|&i| (bucket(i) > best.bucket, i));
        let middle = items.partition_point(|&i| bucket(i) <= best.bucket);
        if middle > 0 && middle < items.len() {
            return middle;
        }
    }
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    items.sort_by(|&a, &b| centre(a, axis).total_cmp(&centre(b, axis)).then(a.cmp(&b)));
    items.len() / 2
}

struct Candidate {
    axis: usize,
    bucket: usize,
    cost: f32,
}

fn bucket_of(centre: f32, bounds: &LightBounds, axis: usize) -> usize {
    let share = (centre - bounds.min[axis]) / (bounds.max[axis] - bounds.min[axis]);
    ((share * BUCKETS as f32) as usize).min(BUCKETS - 1)
}

fn candidates(emitters: &[LightBounds], items: &[u32], bounds: &LightBounds, axis: usize) -> Vec<Candidate> {
    let mut buckets = [None::<LightBounds>; BUCKETS];
    for &item in items {
        let emitter = emitters[item as usize];
        let slot = &mut buckets[bucket_of(emitter.centre()[axis], bounds, axis)];
        *slot = Some(slot.map_or(emitter, |b| b.union(&emitter)));
    }
    let extent = bounds.max - bounds.min;
    let stretch = extent.max_element() / extent[axis];
    let cost =
        |range: &[Option<LightBounds>]| range.iter().flatten().copied().reduce(|a, b| a.union(&b)).map(|b| b.cost());
    (0..BUCKETS - 1)
        .filter_map(|bucket| {
            let (left, right) = (cost(&buckets[..=bucket])?, cost(&buckets[bucket + 1..])?);
            Some(Candidate { axis, bucket, cost: stretch * (left + right) })
        })
        .collect()
}

impl LightBounds {
    fn centre(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    fn union_of(mut all: impl Iterator<Item = Self>) -> Self {
        let first = all.next().expect("a group has members");
        all.fold(first, |a, b| a.union(&b))
    }

    fn union(&self, other: &Self) -> Self {
        let (axis, cos_spread) = cone_union((self.axis, self.cos_spread), (other.axis, other.cos_spread));
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            cos_spread,
            cos_emission: self.cos_emission.min(other.cos_emission),
            intensity: self.intensity + other.intensity,
            two_sided: self.two_sided || other.two_sided,
        }
    }

    /// Surface-area orientation heuristic.
    fn cost(&self) -> f32 {
        let spread = self.cos_spread.clamp(-1.0, 1.0).acos();
        let limit = (spread + self.cos_emission.clamp(-1.0, 1.0).acos()).min(PI);
        let (sin, cos) = spread.sin_cos();
        let omega = 2.0 * PI * (1.0 - cos)
            + PI / 2.0 * (2.0 * limit * sin - (spread - 2.0 * limit).cos() - 2.0 * spread * sin + cos);
        let d = self.max - self.min;
        self.intensity * omega * 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }
}

impl Group {
    fn new(bounds: &LightBounds) -> Self {
        let LightBounds { min, max, axis, cos_spread, cos_emission, intensity, two_sided } = *bounds;
        let (centre, radius2) = (bounds.centre(), 0.25 * (max - min).length_squared());
        Self { centre, radius2, axis, cos_spread, sin_spread: sine(cos_spread), cos_emission, intensity, two_sided }
    }

    /// Upper estimate of what the group sends to a point: intensity × cosine bounds / distance². Zero only where the
    /// whole group lies below the receiver's horizon or turns away from it.
    #[inline]
    fn importance(&self, point: Vec3, normal: Vec3) -> f32 {
        let away = point - self.centre;
        let distance2 = away.length_squared();
        let to_point = away.normalize_or(if normal == Vec3::ZERO { self.axis } else { normal });
        let (sin_bound, cos_bound) = if distance2 > self.radius2 {
            let sin2 = self.radius2 / distance2;
            (sin2.sqrt(), (1.0 - sin2).sqrt())
        } else {
            (0.0, -1.0)
        };
        let cos_axis = self.axis.dot(to_point);
        let cos_axis = if self.two_sided { cos_axis.abs() } else { cos_axis };
        let cos_beyond = cos_difference(cos_axis, self.sin_spread, self.cos_spread);
        let cos_emitted = cos_difference(cos_beyond, sin_bound, cos_bound);
        if cos_emitted <= self.cos_emission {
            return 0.0;
        }
        let strength = self.intensity * cos_emitted.max(0.05) / distance2.max(self.radius2).max(1e-12);
        if normal == Vec3::ZERO {
            return strength;
        }
        strength * cos_difference(-normal.dot(to_point), sin_bound, cos_bound).max(0.0)
    }

    fn importance_along(&self, a: Vec3, b: Vec3) -> f32 {
        let way = b - a;
        let length2 = way.length_squared();
        let share = if length2 > 0.0 { ((self.centre - a).dot(way) / length2).clamp(0.0, 1.0) } else { 0.0 };
        let distance = self.centre.distance(a + share * way).max(self.radius2.sqrt());
        self.intensity / distance.max(1e-3)
    }
}

fn sine(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// cos(max(0, a − b)).
#[inline]
fn cos_difference(cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b {
        1.0
    } else if sin_b == 0.0 {
        cos_a * cos_b
    } else {
        cos_a * cos_b + sine(cos_a) * sin_b
    }
}

/// The smallest cone around two cones.
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let angle = |cos: f32| cos.clamp(-1.0, 1.0).acos();
    let (spread_a, spread_b, between) = (angle(a.1), angle(b.1), a.0.angle_between(b.0));
    if (between + spread_b).min(PI) <= spread_a {
        return a;
    }
    if (between + spread_a).min(PI) <= spread_b {
        return b;
    }
    let spread = 0.5 * (spread_a + between + spread_b);
    let pivot = a.0.cross(b.0);
    if spread >= PI || pivot.length_squared() < 1e-12 {
        return (Vec3::Y, -1.0);
    }
    let axis = glam::Quat::from_axis_angle(pivot.normalize(), spread - spread_a) * a.0;
    (axis.normalize(), spread.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamps(count: u32) -> Vec<LightBounds> {
        (0..count)
            .map(|i| {
                let f = i as f32;
                let position =
                    Vec3::new((f * 0.618).fract() * 10.0, (f * 0.414).fract() * 3.0, (f * 0.732).fract() * 8.0);
                let axis = Vec3::new((f * 1.3).sin(), (f * 0.7).cos(), (f * 2.1).sin()).normalize();
                LightBounds {
                    min: position,
                    max: position,
                    axis,
                    cos_spread: 1.0,
                    cos_emission: if i % 3 == 0 { -1.0 } else { 0.0 },
                    intensity: 1.0 + (i % 5) as f32,
                    two_sided: i % 4 == 1,
                }
            })
            .collect()
    }

    #[test]
    fn probabilities_sum_to_one_and_match_the_draws() {
        let emitters = lamps(37);
        let tree = LightTree::build(&emitters);
        let (point, normal) = (Vec3::new(4.0, 1.0, 3.0), Vec3::new(0.3, 1.0, -0.2).normalize());
        let n = 20_000;
        let (mut counts, mut nothing) = (vec![0u32; 37], 0u32);
        for i in 0..n {
            match tree.sample(point, normal, (i as f32 + 0.5) / n as f32) {
                Some((emitter, p)) => {
                    assert!((tree.probability(emitter, point, normal) / p - 1.0).abs() < 1e-4);
                    counts[emitter as usize] += 1;
                }
                None => nothing += 1,
            }
        }
        let mut sum = f64::from(nothing) / f64::from(n);
        for (i, &count) in counts.iter().enumerate() {
            let p = tree.probability(i as u32, point, normal);
            sum += f64::from(p);
            let drawn = count as f32 / n as f32;
            assert!((drawn - p).abs() < 2e-3, "emitter {i}: drawn {drawn}, probability {p}");
        }
        assert!((sum - 1.0).abs() < 2e-3, "{sum}");
    }

    #[test]
    fn whatever_can_light_a_point_can_be_drawn() {
        let emitters = lamps(64);
        let tree = LightTree::build(&emitters);
        for i in 0..200u32 {
            let f = i as f32;
            let point = Vec3::new((f * 0.37).fract() * 10.0, (f * 0.91).fract() * 3.0, (f * 0.53).fract() * 8.0);
            let normal = Vec3::new((f * 1.7).sin(), (f * 0.3).cos(), (f * 0.9).sin()).normalize();
            for (index, lamp) in emitters.iter().enumerate() {
                let to_lamp = lamp.min - point;
                let cos_receiver = to_lamp.normalize().dot(normal);
                let cos_lamp = -to_lamp.normalize().dot(lamp.axis);
                let cos_lamp = if lamp.two_sided { cos_lamp.abs() } else { cos_lamp };
                if cos_receiver > 1e-3 && cos_lamp > lamp.cos_emission + 1e-3 {
                    assert!(tree.probability(index as u32, point, normal) > 0.0, "point {i}, lamp {index}");
                }
            }
        }
    }

    #[test]
    fn emitters_in_one_place_still_split() {
        let emitters = vec![lamps(1)[0]; 100];
        let tree = LightTree::build(&emitters);
        let p = tree.probability(42, emitters[0].min + Vec3::X, Vec3::NEG_X);
        assert!((p - 0.01).abs() < 1e-3, "{p}");
    }
}
