//! Whether triangles enclose a region: each edge is shared by as many triangles one way as the other.

use glam::DVec3;
use std::collections::HashMap;

/// Why triangles bound nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A corner that is not finite, or an index without a corner.
    #[error("triangle {triangle} has no finite corners")]
    Corner {
        /// Which.
        triangle: usize,
    },
    /// There is a hole.
    #[error("the mesh is not closed: {edges} edges have a face on one side only, one at {at} m")]
    Open {
        /// How many.
        edges: usize,
        /// Middle of one of them.
        at: DVec3,
    },
    /// Neighbouring faces look to different sides.
    #[error("the mesh's faces look both ways: across {edges} edges one looks in and one out, for example at {at} m")]
    Turned {
        /// How many.
        edges: usize,
        /// Middle of one of them.
        at: DVec3,
    },
    /// No volume.
    #[error("the mesh encloses no volume")]
    Flat,
}

/// Corners at the same place made one, and triangles that use them; those that collapse are left out.
pub fn welded(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), MeshError> {
    let (mut places, mut unique) = (HashMap::new(), Vec::new());
    let mut weld = |corner: u32| {
        let place = positions.get(corner as usize).filter(|p| p.is_finite())?;
        // Zero has two signs.
        let key = (*place + DVec3::ZERO).to_array().map(f64::to_bits);
        Some(*places.entry(key).or_insert_with(|| {
            unique.push(*place);
            unique.len() as u32 - 1
        }))
    };
    let mut kept = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = corners.map(&mut weld) else { return Err(MeshError::Corner { triangle }) };
        if a != b && b != c && c != a {
            kept.push([a, b, c]);
        }
    }
    if kept.is_empty() { Err(MeshError::Flat) } else { Ok((unique, kept)) }
}

/// Every edge must be passed as often one way as the other.
pub fn check_closed(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    let mut edges: Vec<(u32, u32, i32)> = Vec::with_capacity(3 * triangles.len());
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.push((*from.min(to), *from.max(to), if from < to { 1 } else { -1 }));
        }
    }
    edges.sort_unstable();
    let (mut open, mut turned, mut at) = (0, 0, [None; 2]);
    for uses in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let balance: i32 = uses.iter().map(|edge| edge.2).sum();
        if balance == 0 {
            continue;
        }
        let middle = 0.5 * (positions[uses[0].0 as usize] + positions[uses[0].1 as usize]);
        let (count, first) = if uses.len() % 2 == 1 { (&mut open, 0) } else { (&mut turned, 1) };
        *count += 1;
        at[first].get_or_insert(middle);
    }
    match at {
        [Some(at), _] => Err(MeshError::Open { edges: open, at }),
        [None, Some(at)] => Err(MeshError::Turned { edges: turned, at }),
        [None, None] => Ok(()),
    }
}

/// Volume, positive where faces look outwards (divergence theorem, about the first corner).
pub fn outward_volume(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<f64, MeshError> {
    let about = positions[0];
    let corner = |index: u32| positions[index as usize] - about;
    let volume: f64 = triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum();
    let size = positions.iter().map(|p| (*p - about).length()).fold(0.0, f64::max);
    if volume.abs() > 1e-12 * size.powi(3) { Ok(volume) } else { Err(MeshError::Flat) }
}
