//! Control variates: a few paths stand for all, since in some known airs all were folded and it is known how far the few were off.
//!
//! With terms `y` of the few in other air, `x` of the few and `X` of all in the known ones, `y − β (x − X)` has the mean of `y` for any
//! matrix `β` that does not depend on the sequence at hand, and the least variance for `β = Cov(y, x) Cov(x, x)⁻¹` (Lavenberg and
//! Welch 1981). It is fitted over all texels of a task, for each half of the sequences to the other half.

use super::REPLICATES;
use glam::Vec3;

/// Irradiance by term.
pub type Terms = [Vec3; 4];

/// Airs in which all paths are folded: the bake's own, thin haze and thick haze.
pub const AIRS: usize = 3;

/// Terms of all known airs.
const CONTROLS: usize = 4 * AIRS;
/// The sequences of a half.
const HALF: usize = REPLICATES / 2;
/// Added to the diagonal of correlations, over the number of observations: holds `β` where observations are few and does
/// nothing where they are many.
const RIDGE: f64 = 0.1;

type Controls = [f64; CONTROLS];

/// What is known of a texel: means by sequence.
#[derive(Debug, Clone, Default)]
pub struct Thinned {
    /// Of the few, in other air; corrected, what stands for all.
    pub few: [Terms; REPLICATES],
    /// In known airs.
    pub known: Known,
}

/// Means of the few and of all by sequence and air.
#[derive(Debug, Clone, Copy, Default)]
pub struct Known(pub [[[Terms; AIRS]; REPLICATES]; 2]);

impl Known {
    /// Adds to the means of the few (0) or of all (1) what one of `count` paths brings.
    pub fn add(&mut self, of: usize, replicate: u32, airs: &[Terms; AIRS], count: usize) {
        let means = self.0[of][replicate as usize].as_flattened_mut();
        means.iter_mut().zip(airs.as_flattened()).for_each(|(mean, term)| *mean += *term / count as f32);
    }

    /// Every mean.
    pub fn means_mut(&mut self) -> impl Iterator<Item = &mut Vec3> {
        self.0.as_flattened_mut().as_flattened_mut().as_flattened_mut().iter_mut()
    }

    fn controls(&self, of: usize, replicate: usize, channel: usize) -> Controls {
        let terms = self.0[of][replicate].as_flattened();
        std::array::from_fn(|i| f64::from(terms[i][channel]))
    }
}

/// Corrects the texels of a task.
pub fn correct(texels: &mut [Thinned]) {
    for channel in 0..3 {
        let betas = [1, 0].map(|half| beta(texels, channel, half));
        for texel in texels.iter_mut() {
            for (r, terms) in texel.few.iter_mut().enumerate() {
                let (few, all) = (texel.known.controls(0, r, channel), texel.known.controls(1, r, channel));
                for (term, beta) in terms.iter_mut().zip(&betas[r / HALF]) {
                    let off: f64 = beta.iter().zip(few.iter().zip(&all)).map(|(b, (few, all))| b * (few - all)).sum();
                    term[channel] -= off as f32;
                }
            }
        }
    }
}

/// `β` by term of one half of the sequences in one channel.
fn beta(texels: &[Thinned], channel: usize, half: usize) -> [Controls; 4] {
    let (mut xx, mut yx) = ([[0.0; CONTROLS]; CONTROLS], [[0.0; CONTROLS]; 4]);
    for texel in texels {
        let xs = centred(std::array::from_fn(|i| texel.known.controls(0, half * HALF + i, channel)));
        let ys = centred(std::array::from_fn(|i| texel.few[half * HALF + i].map(|term| f64::from(term[channel]))));
        for (x, y) in xs.iter().zip(&ys) {
            add_outer(&mut xx, x, x);
            add_outer(&mut yx, y, x);
        }
    }
    // In units of each term's own spread, so that none is lost beside another; a term that does not spread controls nothing.
    let scale: Controls = std::array::from_fn(|i| if xx[i][i] > 0.0 { xx[i][i].sqrt().recip() } else { 0.0 });
    let ridge = RIDGE / ((texels.len() * (HALF - 1)) as f64).max(1.0);
    let correlation: [Controls; CONTROLS] = std::array::from_fn(|i| {
        let of = |j: usize| match (i == j, scale[i] > 0.0) {
            (true, true) => 1.0 + ridge,
            (true, false) => 1.0,
            (false, _) => xx[i][j] * scale[i] * scale[j],
        };
        std::array::from_fn(of)
    });
    let root = cholesky(&correlation);
    yx.map(|row| {
        let solved = solve(&root, std::array::from_fn(|i| row[i] * scale[i]));
        std::array::from_fn(|i| solved[i] * scale[i])
    })
}

fn centred<const N: usize>(mut values: [[f64; N]; HALF]) -> [[f64; N]; HALF] {
    for i in 0..N {
        let mean = values.iter().map(|value| value[i]).sum::<f64>() / HALF as f64;
        values.iter_mut().for_each(|value| value[i] -= mean);
    }
    values
}

fn add_outer<const N: usize>(sum: &mut [Controls; N], a: &[f64; N], b: &Controls) {
    for (row, a) in sum.iter_mut().zip(a) {
        row.iter_mut().zip(b).for_each(|(sum, b)| *sum += a * b);
    }
}

/// The lower triangle `L` of `L Lᵀ = matrix`, symmetric with a ridge.
fn cholesky(matrix: &[Controls; CONTROLS]) -> [Controls; CONTROLS] {
    let mut root = [[0.0; CONTROLS]; CONTROLS];
    for i in 0..CONTROLS {
        for j in 0..=i {
            let rest = matrix[i][j] - (0..j).map(|k| root[i][k] * root[j][k]).sum::<f64>();
            // Rounding leaves at least this of a ridge that no texel of a task outweighs.
            root[i][j] = if i == j { rest.max(f64::EPSILON).sqrt() } else { rest / root[j][j] };
        }
    }
    root
}

/// `x` of `L Lᵀ x = b`.
fn solve(root: &[Controls; CONTROLS], mut b: Controls) -> Controls {
    for i in 0..CONTROLS {
        b[i] = (b[i] - (0..i).map(|k| root[i][k] * b[k]).sum::<f64>()) / root[i][i];
    }
    for i in (0..CONTROLS).rev() {
        b[i] = (b[i] - (i + 1..CONTROLS).map(|k| root[k][i] * b[k]).sum::<f64>()) / root[i][i];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::sampler::hash;

    /// Paths kept of each sequence, and all.
    const COUNTS: [u32; 2] = [2, 16];
    const MEAN: f32 = 3.0;

    fn random(index: u32, of: u32) -> f32 {
        hash(index, of) as f32 / u32::MAX as f32
    }

    /// Texels whose paths bring 4 u in one known air, 4 u² in another and `other(u, own)` in other air; u and own even in 0…1.
    fn texels(count: u32, seed: u32, other: impl Fn(f32, f32) -> f32) -> Vec<Thinned> {
        let texel = |t: u32| {
            let mut texel = Thinned::default();
            for r in 0..REPLICATES {
                for path in 0..COUNTS[1] {
                    let at = hash(hash(seed, t), r as u32 * COUNTS[1] + path);
                    let (u, own) = (random(at, 1), random(at, 2));
                    for (of, count) in COUNTS.into_iter().enumerate().filter(|&(_, count)| path < count) {
                        for (air, x) in [4.0 * u, 4.0 * u * u].into_iter().enumerate() {
                            texel.known.0[of][r][air][1] += Vec3::new(x, 0.0, 0.25 * x) / count as f32;
                        }
                    }
                    if path < COUNTS[0] {
                        texel.few[r][1] += Vec3::splat(other(u, own)) / COUNTS[0] as f32;
                    }
                }
            }
            texel
        };
        (0..count).map(texel).collect()
    }

    /// Mean and variance of what texels hold for their sequences, in a channel.
    fn spread(texels: &[Thinned], channel: usize) -> (f64, f64) {
        let values: Vec<f64> = texels.iter().flat_map(|t| t.few).map(|terms| f64::from(terms[1][channel])).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64)
    }

    /// The other air lies between the two known ones. The green channel, in which those say nothing, is the twin that stays as
    /// noisy as the few are.
    #[test]
    fn few_paths_become_as_good_as_all_where_airs_are_alike() {
        let mut thinned = texels(64, 1, |u, own| MEAN * (u + u * u) * (1.0 + 0.1 * (own - 0.5)));
        let few = spread(&thinned, 0).1;
        correct(&mut thinned);
        let [red, green, blue] = [0, 1, 2].map(|channel| spread(&thinned, channel).1 / few);
        let all = f64::from(COUNTS[0]) / f64::from(COUNTS[1]);
        println!("variance of what the few have: {red} and {blue}, {green} without control; all paths {all}");
        assert!(red < 1.25 * all && blue < 1.25 * all, "{red} {blue}");
        assert!((green - 1.0).abs() < 1e-6, "{green}");
    }

    /// Known air that says nothing of the other, and one texel to fit to: the hardest for a fit. The twin takes the means of
    /// all to be half as large as they are.
    #[test]
    fn means_stay_what_they_are() {
        let trials = 4000;
        let mean = |shrink: f32| {
            let trial = |seed: u32| {
                let mut thinned = texels(1, seed, |u, own| 2.0 * MEAN * own + u - 0.5);
                thinned[0].known.0[1].as_flattened_mut().as_flattened_mut().iter_mut().for_each(|term| *term *= shrink);
                correct(&mut thinned);
                spread(&thinned, 0).0
            };
            let means: Vec<f64> = (0..trials).map(trial).collect();
            testkit::statistics::mean_and_error(&means)
        };
        let (found, error) = mean(1.0);
        println!("{found} ± {error}");
        assert!((found - f64::from(MEAN)).abs() < 4.0 * error, "{found} ± {error}");
        let (twin, error) = mean(0.5);
        assert!((twin - f64::from(MEAN)).abs() > 4.0 * error, "{twin} ± {error}");
    }

    #[test]
    fn a_known_air_comes_back_as_all_paths_had_it() {
        let mut thinned = texels(64, 1, |u, _| 4.0 * u);
        let all: Vec<f32> = thinned.iter().flat_map(|t| t.known.0[1]).map(|airs| airs[0][1].x).collect();
        correct(&mut thinned);
        let far = thinned.iter().flat_map(|t| t.few).zip(all).map(|(f, all)| (f[1].x / all - 1.0).abs());
        assert!(far.clone().fold(0.0, f32::max) < 0.01, "{:?}", far.fold(0.0, f32::max));
    }

    #[test]
    fn nothing_stays_nothing_and_sizes_do_not_matter() {
        let mut dark = vec![Thinned::default(); 3];
        correct(&mut dark);
        assert!(dark.iter().flat_map(|t| t.few).flatten().all(|term| term == Vec3::ZERO));
        let mut tiny = texels(8, 1, |u, _| 1e-18 * u);
        tiny.iter_mut().flat_map(|t| t.known.means_mut()).for_each(|term| *term *= 1e12);
        correct(&mut tiny);
        assert!(tiny.iter().flat_map(|t| t.few).all(|terms| terms[1].is_finite() && terms[1].x > 0.0));
    }

    #[test]
    fn a_system_of_equations_is_solved() {
        let random = |i: usize, j: usize| f64::from(random(i as u32, j as u32)) - 0.5;
        let lower: [Controls; CONTROLS] =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 2.0 } else { random(i.max(j), i.min(j)) }));
        let x: Controls = std::array::from_fn(|i| random(99, i));
        let b = lower.map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>());
        let off = |found: Controls| found.iter().zip(&x).map(|(f, x)| (f - x).abs()).fold(0.0, f64::max);
        assert!(off(solve(&cholesky(&lower), b)) < 1e-12);
        assert!(off(b) > 0.1, "the right side is no solution");
    }
}
