//! Splitting a mesh into clusters of bounded size: whole connected parts together where they fit, larger ones halved
//! across their longest extent.

use glam::Vec3;
use std::collections::HashMap;

/// Clusters of at most `most` triangles each, every triangle in one; members ascend.
pub(super) fn split(positions: &[Vec3], triangles: &[[u32; 3]], most: usize) -> Vec<Vec<u32>> {
    let mut clusters: Vec<Vec<u32>> = Vec::new();
    let mut open: Option<usize> = None;
    for part in connected(positions, triangles) {
        if part.len() > most {
            let centre = |t: u32| triangles[t as usize].iter().map(|&v| positions[v as usize] / 3.0).sum();
            halve(part, &centre, most, &mut clusters);
            continue;
        }
        match open {
            Some(i) if clusters[i].len() + part.len() <= most => clusters[i].extend(part),
            _ => {
                open = Some(clusters.len());
                clusters.push(part);
            }
        }
    }
    for cluster in &mut clusters {
        cluster.sort_unstable();
    }
    clusters
}

/// Halves at the median of the triangles' centres along their longest extent, until small enough.
fn halve(mut part: Vec<u32>, centre: &impl Fn(u32) -> Vec3, most: usize, clusters: &mut Vec<Vec<u32>>) {
    if part.len() <= most {
        clusters.push(part);
        return;
    }
    let low = part.iter().map(|&t| centre(t)).fold(Vec3::INFINITY, Vec3::min);
    let high = part.iter().map(|&t| centre(t)).fold(Vec3::NEG_INFINITY, Vec3::max);
    let axis = (high - low).max_position();
    part.sort_by(|&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    let rest = part.split_off(part.len() / 2);
    halve(part, centre, most, clusters);
    halve(rest, centre, most, clusters);
}

/// Parts connected through corners of equal position, in order of their first triangle.
fn connected(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut welded = HashMap::new();
    let weld: Vec<u32> = (0..positions.len() as u32)
        .map(|v| *welded.entry(positions[v as usize].to_array().map(f32::to_bits)).or_insert(v))
        .collect();
    let mut parent: Vec<u32> = (0..positions.len() as u32).collect();
    for triangle in triangles {
        let first = root(&mut parent, weld[triangle[0] as usize]);
        for &v in &triangle[1..] {
            let other = root(&mut parent, weld[v as usize]);
            parent[other as usize] = first;
        }
    }
    let mut number = HashMap::new();
    let mut parts: Vec<Vec<u32>> = Vec::new();
    for (t, triangle) in triangles.iter().enumerate() {
        let part = *number.entry(root(&mut parent, weld[triangle[0] as usize])).or_insert(parts.len());
        if part == parts.len() {
            parts.push(Vec::new());
        }
        parts[part].push(t as u32);
    }
    parts
}

/// The representative of a union, halving paths on the way.
fn root(parent: &mut [u32], mut at: u32) -> u32 {
    while parent[at as usize] != at {
        parent[at as usize] = parent[parent[at as usize] as usize];
        at = parent[at as usize];
    }
    at
}
