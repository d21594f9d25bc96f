//! How far probes see: two moments of the distance of surfaces by direction, by which readers that blend probes tell those that see a
//! place from those that do not (Majercik et al. 2019, "Dynamic diffuse global illumination with ray-traced irradiance fields").

use super::octahedron::unfold;
use super::points::LatticeLight;
use crate::progress::{Interrupted, Progress};
use crate::trace::{Ray, Tracer};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Texels across of a probe's octahedral map.
pub const SIZE: u32 = 16;
/// Texels of a map.
pub const TEXELS: usize = (SIZE * SIZE) as usize;
/// Rays across of a texel.
const RAYS: u32 = 4;
/// Diagonals of a cell beyond which distances count as that: nothing farther off comes between a place and its probes.
const FARTHEST: f32 = 1.5;

/// Mean distance (metres) and mean squared distance (metres²) of what is seen through the texels of every point's map, row by row from
/// the corner (−1, −1), points in the order of the light. Zero where a point has no place.
///
/// # Errors
/// Interrupted.
pub fn moments(tracer: &Tracer, light: &LatticeLight, progress: &dyn Progress) -> Result<Vec<Vec2>, Interrupted> {
    let farthest = FARTHEST * light.lattice.spacing.length();
    progress.stage("what probes see", light.places.len() as u64);
    let maps = light.places.par_iter().map(|place| {
        progress.advance(1);
        let map = || place.map_or([Vec2::ZERO; TEXELS], |place| map(tracer, place, farthest));
        if progress.is_cancelled() { Err(Interrupted) } else { Ok(map()) }
    });
    Ok(maps.collect::<Result<Vec<_>, _>>()?.concat())
}

fn map(tracer: &Tracer, origin: Vec3, farthest: f32) -> [Vec2; TEXELS] {
    let distance = |dir| tracer.closest_hit(&Ray { origin, dir, t_max: farthest }).map_or(farthest, |hit| hit.t);
    std::array::from_fn(|texel| {
        let corner = Vec2::new((texel as u32 % SIZE) as f32, (texel as u32 / SIZE) as f32);
        let seen = |ray: u32| {
            let within = Vec2::new((ray % RAYS) as f32 + 0.5, (ray / RAYS) as f32 + 0.5) / RAYS as f32;
            let distance = distance(unfold((corner + within) * (2.0 / SIZE as f32) - 1.0));
            Vec2::new(distance, distance * distance)
        };
        (0..RAYS * RAYS).map(seen).sum::<Vec2>() / (RAYS * RAYS) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::octahedron::fold;
    use crate::test_scenes::{closed_box, matte, scene};

    /// In a cube's middle a ray ends where its largest coordinate is the half side.
    #[test]
    fn distances_of_a_cubes_walls_come_back() {
        let scene = scene(vec![closed_box(Vec3::splat(-1.0), Vec3::ONE, true, 0)], vec![matte(0.5)]);
        let tracer = Tracer::new(&scene);
        let (middle, aside) = (map(&tracer, Vec3::ZERO, 9.0), map(&tracer, Vec3::splat(0.1), 9.0));
        let worst = |map: &[Vec2; TEXELS]| {
            let off = |texel: usize| {
                let at = Vec2::new((texel as u32 % SIZE) as f32 + 0.5, (texel as u32 / SIZE) as f32 + 0.5);
                let exact = 1.0 / unfold(at * (2.0 / SIZE as f32) - 1.0).abs().max_element();
                assert!(map[texel].y >= map[texel].x.powi(2) * (1.0 - 1e-6), "a variance is not negative");
                (map[texel].x / exact - 1.0).abs()
            };
            (0..TEXELS).map(off).fold(0.0, f32::max)
        };
        // A texel's mean is not its middle: corners of the cube lie inside texels.
        assert!(worst(&middle) < 0.04 && worst(&aside) > 0.08, "{} and {}", worst(&middle), worst(&aside));
        let towards = (fold(Vec3::X) + 1.0) * (0.5 * SIZE as f32);
        let texel = towards.y as usize * SIZE as usize + towards.x.min(SIZE as f32 - 1.0) as usize;
        assert!((middle[texel].x - 1.0).abs() < 0.02 && map(&tracer, Vec3::ZERO, 0.5)[texel] == Vec2::new(0.5, 0.25));
    }
}
