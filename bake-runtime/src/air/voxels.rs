//! Media as the shaders take them: fine density grids become coarser ones, and so do regions that end at a mesh too fine to be walked.
//!
//! A cell of such a grid holds the mean density in it, found from exact intervals of upright lines; what a mesh holds in all is kept,
//! its border is blurred over a cell. *Accuracy*: see the tests.

use std::sync::Arc;

use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::mesh::ClosedMesh;
use bake_optics::medium::{Bounds, Density, Medium, Ray};
use glam::{DAffine3, DMat3, DVec3, IVec3};

/// Most points along an axis: what a shader can walk through at every node.
const MOST: i32 = 64;

/// Most triangles of a mesh: 4 MB that are written for every picture.
const MOST_TRIANGLES: usize = 65_536;

/// Most parts of a line inside a mesh: `mesh.wgsl` tells sixteen crossings apart.
const MOST_PARTS: usize = 8;

/// Lines that look for such places, along each side of a mesh's box.
const LINES_ACROSS: i32 = 32;

/// Cells along a mesh's longest side.
const CELLS: f64 = 48.0;

/// Lines along each side of a cell.
const LINES: i32 = 4;

/// The medium as it is drawn, and what is lost, in words.
pub(super) fn drawable(medium: Medium) -> (Medium, Option<String>) {
    if let Bounds::Mesh(mesh) = &medium.bounds
        && let Some(why) = too_fine(mesh)
    {
        let grid = filled(&medium);
        let note = format!("its mesh ({why}) as a grid of {} points", grid.size());
        let density = Density::Grid(Arc::new(grid));
        return (Medium { bounds: Bounds::Unbounded, density, ..medium }, Some(note));
    }
    let Density::Grid(grid) = &medium.density else { return (medium, None) };
    if grid.size().max_element() <= MOST {
        return (medium, None);
    }
    let mut coarse = DensityGrid::clone(grid);
    while coarse.size().max_element() > MOST {
        coarse = halved(&coarse);
    }
    let note = format!("its grid of {} points as one of {}", grid.size(), coarse.size());
    (Medium { density: Density::Grid(Arc::new(coarse)), ..medium }, Some(note))
}

/// Why a mesh is not drawn as it is.
fn too_fine(mesh: &ClosedMesh) -> Option<String> {
    let count = mesh.triangles().len();
    if count > MOST_TRIANGLES {
        return Some(format!("{count} triangles; {MOST_TRIANGLES} at most"));
    }
    let most = lines_through(mesh.bounding_box()).map(|line| mesh.intervals(&line).len()).max().unwrap_or(0);
    (most > MOST_PARTS).then(|| format!("{most} parts inside along a line; {MOST_PARTS} at most"))
}

/// Lines across a box, along each axis.
fn lines_through([low, high]: [DVec3; 2]) -> impl Iterator<Item = Ray> {
    let share = |line: i32| (f64::from(line) + 0.5) / f64::from(LINES_ACROSS);
    let line = move |axis: usize, i: i32| {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut from = low - DVec3::AXES[axis];
        from[u] += (high - low)[u] * share(i % LINES_ACROSS);
        from[v] += (high - low)[v] * share(i / LINES_ACROSS);
        Ray::new(from, DVec3::AXES[axis], f64::INFINITY)
    };
    (0..3).flat_map(move |axis| (0..LINES_ACROSS * LINES_ACROSS).map(move |i| line(axis, i)))
}

/// Mean densities of the cells of the region's box.
fn filled(medium: &Medium) -> DensityGrid {
    let [low, high] = medium.bounds.bounding_box();
    let cell = ((high - low).max_element() / CELLS).max(1e-9);
    let size = ((high - low) / cell).ceil().as_ivec3().max(IVec3::ONE);
    let mut values = vec![0.0f32; size.element_product() as usize];
    for y in 0..size.y {
        for x in 0..size.x {
            for line in 0..LINES * LINES {
                let at = |i: i32, line: i32| (f64::from(i) + (f64::from(line) + 0.5) / f64::from(LINES)) * cell;
                let foot = low + DVec3::new(at(x, line % LINES), at(y, line / LINES), 0.0);
                let upright = Ray::new(foot, DVec3::Z, high.z - low.z);
                for (enter, leave) in medium.bounds.intervals(&upright) {
                    for z in (enter / cell) as i32..size.z {
                        let (from, to) = ((f64::from(z) * cell).max(enter), (f64::from(z + 1) * cell).min(leave));
                        if from >= to {
                            break;
                        }
                        let mean = medium.density.optical_length(&upright.part(from, to)) / cell;
                        values[(x + size.x * (y + size.y * z)) as usize] += (mean / f64::from(LINES * LINES)) as f32;
                    }
                }
            }
        }
    }
    let placed = DAffine3 { matrix3: DMat3::from_diagonal(DVec3::splat(cell)), translation: low + 0.5 * cell };
    DensityGrid::new(size, values, placed).expect("finite means of a finite region")
}

/// Means of twice two points along each axis; beyond the last there is nothing.
fn halved(grid: &DensityGrid) -> DensityGrid {
    let (old, size) = (grid.size(), (grid.size() + 1) / 2);
    let value = |at: IVec3| {
        let inside = at.cmplt(old).all();
        if inside { grid.values()[(at.x + old.x * (at.y + old.y * at.z)) as usize] } else { 0.0 }
    };
    let mean = |index: i32| {
        let at = IVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y));
        let corner = |i: i32| value(2 * at + IVec3::new(i & 1, i >> 1 & 1, i >> 2));
        (0..8).map(corner).sum::<f32>() / 8.0
    };
    let values = (0..size.element_product()).map(mean).collect();
    let within = DAffine3 { matrix3: DMat3::from_diagonal(DVec3::splat(2.0)), translation: DVec3::splat(0.5) };
    DensityGrid::new(size, values, grid.world_from_grid() * within).expect("means of values that were valid")
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::Scatter;
    use bake_optics::phase::Phase;

    fn medium(bounds: Bounds, density: Density) -> Medium {
        let scatter = Scatter { sigma_s: [0.5; 3], sigma_a: [0.0; 3] };
        Medium { bounds, density, scatter, phase: Phase::Isotropic }
    }

    /// An L, 2 m x 2 m x 1 m, from boxes that share no corner with its grid.
    fn angle() -> Bounds {
        let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.7], [0.8, 0.7], [0.8, 2.0], [0.0, 2.0]];
        let positions: Vec<DVec3> = [0.0, 1.0]
            .iter()
            .flat_map(|&z| outline.map(|[x, y]| DAffine3::from_rotation_z(0.3).transform_point3(DVec3::new(x, y, z))))
            .collect();
        let cap = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
        let side = |i: u32| [[i, (i + 1) % 6, (i + 1) % 6 + 6], [i, (i + 1) % 6 + 6, i + 6]];
        let mut triangles: Vec<[u32; 3]> = (0..6).flat_map(side).collect();
        triangles.extend(cap.map(|[a, b, c]| [a, c, b]));
        triangles.extend(cap.map(|t| t.map(|i| i + 6)));
        Bounds::Mesh(Arc::new(ClosedMesh::new(&positions, &triangles).expect("closed")))
    }

    /// Rays from around towards the middle of the box.
    fn rays() -> Vec<Ray> {
        (0..400)
            .map(|i| {
                let (turn, z) = (2.4 * f64::from(i), -1.0 + f64::from(i) / 200.0);
                let r = (1.0 - z * z).max(0.0).sqrt();
                let from = DVec3::new(0.6, 1.1, 0.5) + 5.0 * DVec3::new(r * turn.cos(), r * turn.sin(), z);
                let aim = DVec3::new(0.6 + 0.3 * turn.sin(), 1.1 - 0.3 * (2.0 * turn).cos(), 0.5 + 0.2 * turn.cos());
                Ray { length: 10.0, ..Ray::between(from, aim) }
            })
            .collect()
    }

    #[test]
    fn a_mesh_keeps_what_it_holds_and_its_border_within_a_cell() {
        for density in [Density::Uniform, Density::Exponential { base_m: 0.5, scale_height_m: 0.6 }] {
            let exact = medium(angle(), density);
            let density = Density::Grid(Arc::new(filled(&exact)));
            let coarse = medium(Bounds::Unbounded, density);
            let errors: Vec<f64> =
                rays().iter().map(|ray| coarse.optical_length(ray) - exact.optical_length(ray)).collect();
            let mean = rays().iter().map(|ray| exact.optical_length(ray)).sum::<f64>() / 400.0;
            let bias = errors.iter().sum::<f64>() / 400.0 / mean;
            let rms = (errors.iter().map(|e| e * e).sum::<f64>() / 400.0).sqrt() / mean;
            let worst = errors.iter().fold(0.0, |w: f64, e| w.max(e.abs())) / mean;
            println!(
                "mesh as grid, shares of the mean optical length {mean:.3}: bias {bias:.1e}, RMS {rms:.1e}, worst {worst:.1e}"
            );
            // At worst a ray runs in a face, whose cells are half full.
            assert!(bias.abs() < 5e-3 && rms < 2e-2 && worst < 0.2, "{bias} {rms} {worst}");
        }
    }

    /// Teeth of 0.5 m, 1 m from each to the next.
    fn comb(teeth: u32) -> Bounds {
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 0.5;
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let positions: Vec<DVec3> = (0..8 * teeth).map(|i| corner(i % 8) + DVec3::X * f64::from(i / 8)).collect();
        let triangles: Vec<[u32; 3]> =
            (0..teeth).flat_map(|tooth| triangles.clone().map(move |t| t.map(|i| i + 8 * tooth))).collect();
        Bounds::Mesh(Arc::new(ClosedMesh::new(&positions, &triangles).expect("closed")))
    }

    #[test]
    fn meshes_are_drawn_as_they_are_unless_a_line_meets_too_many_parts() {
        for bounds in [angle(), comb(8)] {
            let (drawn, note) = drawable(medium(bounds.clone(), Density::Uniform));
            assert!(note.is_none() && drawn.bounds == bounds);
        }
        let (drawn, note) = drawable(medium(comb(9), Density::Uniform));
        assert!(matches!(drawn.density, Density::Grid(_)) && drawn.bounds == Bounds::Unbounded);
        assert!(note.as_ref().is_some_and(|note| note.contains("9 parts")), "{note:?}");
    }

    #[test]
    fn wide_grids_become_coarser_and_keep_what_they_hold() {
        let size = IVec3::new(100, 3, 70);
        let wave = |i: i32| 1.0 + (0.2 * f64::from(i % 100)).sin() as f32;
        let values = (0..size.element_product()).map(wave).collect();
        let placed = DAffine3::from_scale_rotation_translation(
            DVec3::new(0.1, 0.2, 0.15),
            glam::DQuat::from_rotation_y(0.4),
            DVec3::new(3.0, 1.0, -2.0),
        );
        let fine = DensityGrid::new(size, values, placed).expect("valid");
        let (drawn, note) = drawable(medium(Bounds::Unbounded, Density::Grid(Arc::new(fine.clone()))));
        let Density::Grid(coarse) = &drawn.density else { panic!("still a grid") };
        assert_eq!(coarse.size(), IVec3::new(50, 2, 35));
        assert!(note.is_some_and(|note| note.contains("[100, 3, 70]")));
        // Inside, where both are far from their ends, densities agree as a wave of 31 points by means of two does.
        let middle = placed.transform_point3(DVec3::new(50.3, 0.5, 30.2));
        assert!((coarse.at(middle) / fine.at(middle) - 1.0).abs() < 0.02, "{} {}", coarse.at(middle), fine.at(middle));
        let total = |grid: &DensityGrid| {
            let volume = grid.world_from_grid().matrix3.determinant();
            grid.values().iter().map(|&v| f64::from(v)).sum::<f64>() * volume
        };
        assert!((total(coarse) / total(&fine) - 1.0).abs() < 1e-5);
        let (same, note) = drawable(medium(Bounds::Unbounded, Density::Grid(Arc::new(coarse.as_ref().clone()))));
        assert!(note.is_none() && same.density == drawn.density);
    }
}
