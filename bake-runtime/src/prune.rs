//! Stochastic pruning: of instanced clutter, in an order drawn once, ever fewer pieces are drawn as they get farther away,
//! each larger by what is missing.
//!
//! *Source*: Cook, Halstead, Planck and Ryu 2007; on a GPU Macklin 2010 (`u = 1/z`: half are left at twice the distance). The
//! twin of [`scale`] is `pruned_scale` in `pruning.wgsl`.

use glam::{DVec3, Vec3};

/// Runs of fewer placements are not clutter: all of them are always drawn.
pub const LEAST: usize = 32;

/// Width of the band of ranks in which pieces shrink before they go, as a share of the pieces that are gone.
const WINDOW: f32 = 0.2;

/// Share of the pieces that are drawn at a distance; all of them up to `start`, metres both.
pub fn kept_share(distance: f32, start: f32) -> f32 {
    start / distance.max(start).max(f32::MIN_POSITIVE)
}

/// How much longer than by itself a piece of a rank in [0, 1) is drawn where the share `kept` is; 0: not at all.
///
/// *Equation*: area A(r) = clamp((u − r)/w, 0, 1)/(u − w/2) with w = min(0.2 (1 − u), u), so that its mean over all ranks is 1
/// for every u.
pub fn scale(rank: f32, kept: f32) -> f32 {
    let window = (WINDOW * (1.0 - kept)).min(kept);
    let fade = ((kept - rank) / window.max(1e-6)).clamp(0.0, 1.0);
    (fade / (kept - 0.5 * window).max(1e-6)).sqrt()
}

/// How many of a run's placements can be seen at all from an eye, for the box of their origins.
pub(crate) fn count(all: u32, [low, high]: [Vec3; 2], eye: DVec3, start: f32) -> u32 {
    let eye = eye.as_vec3();
    let nearest = eye.distance(eye.clamp(low, high));
    ((all as f32 * kept_share(nearest, start)).ceil() as u32).min(all)
}

/// The order in which placements go: a number's place among all, as good as random (PCG hash, Jarzynski and Olano 2020).
pub(crate) fn scrambled(number: u32) -> u32 {
    let state = number.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 10_000;

    fn mean_area(kept: f32, scale: impl Fn(f32, f32) -> f32) -> f64 {
        let area = |i: usize| f64::from(scale((i as f32 + 0.5) / COUNT as f32, kept)).powi(2);
        (0..COUNT).map(area).sum::<f64>() / COUNT as f64
    }

    #[test]
    fn the_whole_area_stays_the_same_at_every_distance() {
        for kept in [1.0, 0.999, 0.7, 0.5, 0.2, 0.05, 0.01] {
            let area = mean_area(kept, scale);
            // One rank more or less at the band's ends.
            let allowed = 2.0 / (f64::from(kept) * COUNT as f64);
            assert!((area - 1.0).abs() < allowed, "{area} of {kept}, allowed {allowed}");
        }
        // Wrong twin: pieces that do not grow lose what is gone.
        let wrong = mean_area(0.2, |rank, kept| scale(rank, kept).min(1.0));
        assert!(wrong < 0.5, "{wrong}");
    }

    #[test]
    fn near_pieces_are_left_alone_and_none_comes_or_goes_at_once() {
        assert_eq!((kept_share(0.0, 10.0), kept_share(10.0, 10.0), kept_share(40.0, 10.0)), (1.0, 1.0, 0.25));
        assert!((0..100).all(|i| scale(i as f32 / 100.0, 1.0) == 1.0));
        let leap = |area: &dyn Fn(f32) -> f32| {
            let areas: Vec<f32> = (0..=1000).map(|step| area(1.0 - step as f32 / 1000.0)).collect();
            assert_eq!(areas[1000], 0.0);
            areas.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max)
        };
        // A thousandth of the way takes no piece more than a twentieth of its own area; cut off sharply, all of it goes at once.
        let (soft, sharp) =
            (leap(&|kept| scale(0.3, kept).powi(2)), leap(&|kept| if kept > 0.3 { 1.0 / kept } else { 0.0 }));
        assert!(soft < 0.05 && sharp > 1.0, "{soft} {sharp}");
    }

    #[test]
    fn whoever_is_seen_is_among_those_that_are_counted() {
        let origins: Vec<Vec3> = (0..400).map(|i| Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32)).collect();
        let bounds = [Vec3::ZERO, Vec3::new(19.0, 0.0, 19.0)];
        for eye in [DVec3::new(-30.0, 2.0, 5.0), DVec3::new(3.0, 1.0, 4.0), DVec3::new(0.0, 500.0, 0.0)] {
            let count = count(400, bounds, eye, 4.0);
            for (index, origin) in origins.iter().enumerate().skip(count as usize) {
                let rank = (index as f32 + 0.5) / 400.0;
                assert_eq!(scale(rank, kept_share(eye.as_vec3().distance(*origin), 4.0)), 0.0, "{index} of {count}");
            }
        }
        assert!(count(400, bounds, DVec3::new(0.0, 500.0, 0.0), 4.0) < 5);
    }
}
