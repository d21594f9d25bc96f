//! How noisy a page (or a lattice) still is: the number that decides when sampling ends.
//!
//! A texel's error is its standard error over max(its level, the page's median), so that dark corners do not ask for
//! samples that nobody sees. The page's is the root mean square over all but the noisiest hundredth: two texels that touch
//! a lamp would else decide for thousands. What is left out is not hidden, it is told beside the rest.
//!
//! The hundredth is chosen by errors that are estimated themselves, from [`super::REPLICATES`] = 8 means. On texels that are
//! all equally noisy this takes 1.0 % off the root mean square: with χ² of 7 degrees of freedom, whose largest
//! hundredth holds P(χ²₉ > 18.48) = 3.0 % of the sum, √(0.970/0.99) = 0.990.

/// One in so many texels is left out of the error: the noisiest.
const LEFT_OUT: usize = 100;

/// Standard errors over levels, in luminance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// Median level.
    pub median: f32,
    /// Root mean square of all but the noisiest hundredth.
    pub error: f32,
    /// Root mean square of that hundredth; 0 among fewer than a hundred texels, of which none is left out.
    pub noisiest: f32,
}

impl Noise {
    /// Of texels' levels and the variances of these.
    pub fn of(texels: impl Iterator<Item = (f32, f32)>) -> Self {
        let texels: Vec<(f32, f32)> = texels.collect();
        let mut levels: Vec<f32> = texels.iter().map(|&(level, _)| level).collect();
        levels.sort_by(f32::total_cmp);
        let median = levels.get(levels.len() / 2).copied().unwrap_or(0.0);
        let square = |&(level, variance): &(f32, f32)| {
            let level = level.max(median);
            if level > 0.0 { f64::from(variance / (level * level)) } else { 0.0 }
        };
        let mut squares: Vec<f64> = texels.iter().map(square).collect();
        squares.sort_by(f64::total_cmp);
        let (most, noisiest) = squares.split_at(squares.len() - squares.len() / LEFT_OUT);
        Self { median, error: root_mean(most), noisiest: root_mean(noisiest) }
    }
}

fn root_mean(squares: &[f64]) -> f32 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::REPLICATES;
    use crate::solve::sampler::{MAX_SAMPLES, Sampler};

    /// Texels of level 1 whose variance is estimated from replicates of normal spread 1: the truth is 1/8.
    fn evenly_noisy(count: u32) -> Vec<(f32, f32)> {
        let normal = |[u, v, ..]: [f32; 4]| (-2.0 * (1.0 - u).ln()).sqrt() * (std::f32::consts::TAU * v).cos();
        let texel = |texel: u32| {
            let draw = |i| normal(Sampler::new(texel % MAX_SAMPLES, 1000 + i).next4());
            let drawn: Vec<f32> = (0..REPLICATES as u32).map(draw).collect();
            let n = REPLICATES as f32;
            let mean = drawn.iter().sum::<f32>() / n;
            (1.0, drawn.iter().map(|d| (d - mean).powi(2)).sum::<f32>() / (n * (n - 1.0)))
        };
        (0..count).map(texel).collect()
    }

    #[test]
    fn even_noise_is_told_nearly_whole() {
        let noise = Noise::of(evenly_noisy(20_000).into_iter());
        let ratio = noise.error / (1.0f32 / 8.0).sqrt();
        println!("told / true {ratio:.4}, expected 0.990; the noisiest {:.3}", noise.noisiest);
        // The root mean square of 20 000 estimates with 7 degrees of freedom is known to √(1/(2·7·20000)) = 0.2 %.
        assert!((ratio - 0.990).abs() < 0.006, "{ratio}");
        assert!(noise.noisiest > 1.5 * noise.error);
    }

    #[test]
    fn few_texels_do_not_decide_and_are_told() {
        let mut texels = evenly_noisy(1000);
        let even = Noise::of(texels.iter().copied());
        texels.iter_mut().take(5).for_each(|texel| texel.1 = 100.0);
        let lamps = Noise::of(texels.iter().copied());
        assert!((lamps.error / even.error - 1.0).abs() < 0.02, "{lamps:?} beside {even:?}");
        assert!(lamps.noisiest > 5.0, "{lamps:?}");
        // Negative control: a root mean square over all would ask for four times the samples.
        let all = root_mean(&texels.iter().map(|&(_, variance)| f64::from(variance)).collect::<Vec<_>>());
        assert!(all > 2.0 * even.error, "{all}");
        // More than the hundredth does decide.
        texels.iter_mut().take(30).for_each(|texel| texel.1 = 100.0);
        assert!(Noise::of(texels.into_iter()).error > 1.0);
    }

    #[test]
    fn dark_texels_are_judged_by_the_median_and_nothing_by_nothing() {
        let noise = Noise::of([(0.0, 0.01), (1.0, 0.01), (4.0, 0.16)].into_iter());
        assert_eq!((noise.median, noise.noisiest), (1.0, 0.0));
        assert!((noise.error - 0.1).abs() < 1e-6, "{noise:?}");
        for dark in [vec![], vec![(0.0, 0.0); 200]] {
            assert_eq!(Noise::of(dark.into_iter()), Noise { median: 0.0, error: 0.0, noisiest: 0.0 });
        }
    }
}
