//! Least-squares seam stitching: texels along cuts change a little, so that both sides of a cut read the same.
//!
//! With x the values of the texels that lookups along seams read, x₀ those baked, and (A x)ₛ the difference of the two
//! bilinear lookups at place s of a seam, x minimises
//! ```text
//! Σₛ (A x)ₛ² + Σᵢ λᵢ (xᵢ − x₀ᵢ)²
//! ```
//! that is (AᵀA + Λ)(x − x₀) = −AᵀA x₀, solved in f64 by conjugate gradients with the diagonal as preconditioner
//! (Shewchuk 1994, B3). The operator depends on atlas and validity only and is the same for every channel of every
//! term and of SH, so the stitched total is the total of the stitched terms. Negative irradiance, which least squares
//! does not exclude, is raised to zero.
//! Source: Iwanicki 2013, "Lighting technology of The Last of Us"; Rakhteenko 2017, "Fixing lightmap seams".

use super::seams::{self, Seam};
use crate::atlas::Atlas;
use crate::solve::buffers::{PageBuffers, Validity};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Places fitted per texel of an edge.
const PER_TEXEL: f32 = 2.0;
/// Tether λ of baked texels: small against the seam terms, whose diagonal is about 1.
const TETHER_GOOD: f64 = 0.02;
/// Tether of filled texels, whose values are only guesses.
const TETHER_FILLED: f64 = 0.002;
/// Residual, relative to the right-hand side, at which iteration stops: below an ulp of f32.
const RESIDUAL: f64 = 1e-8;
/// Most iterations; the condition number is bounded by the tether, about 1e4, so √1e4 · ln(2e8)/2 ≈ 1000 suffice.
const ITERATIONS: u32 = 1000;

/// Stitches all images along the seams; run after [`dilate`](super::dilate()). Places that read a texel without value
/// are left out. Variance, samples and validity stay.
pub fn stitch(seams: &[Seam], atlas: &Atlas, pages: &mut [PageBuffers]) {
    let system = System::new(seams, atlas, pages);
    if system.rows.is_empty() {
        return;
    }
    let channels = channels(pages);
    let solved: Vec<Vec<f64>> = channels
        .par_iter()
        .map(|channel| {
            let baked: Vec<f64> = system.texels.iter().map(|at| f64::from(channel.read(pages, *at))).collect();
            system.stitched(&baked)
        })
        .collect();
    for (channel, values) in channels.iter().zip(&solved) {
        for (at, value) in system.texels.iter().zip(values) {
            channel.write(pages, *at, *value as f32);
        }
    }
}

/// A texel: page and index.
type At = (u32, u32);

/// One number per texel.
#[derive(Debug, Clone, Copy)]
enum Channel {
    /// Channel of a term's irradiance.
    Term(usize, usize),
    /// Channel of an SH coefficient.
    Sh(usize, usize),
}

/// All channels that every page has.
fn channels(pages: &[PageBuffers]) -> Vec<Channel> {
    let terms = pages.iter().map(|p| p.terms.len()).min().unwrap_or(0);
    let sh = if pages.iter().all(|p| p.sh1.is_some()) { 4 } else { 0 };
    let of_terms = (0..terms).flat_map(|t| (0..3).map(move |c| Channel::Term(t, c)));
    of_terms.chain((0..sh).flat_map(|k| (0..3).map(move |c| Channel::Sh(k, c)))).collect()
}

impl Channel {
    fn read(self, pages: &[PageBuffers], (page, texel): At) -> f32 {
        let page = &pages[page as usize];
        match self {
            Self::Term(term, c) => page.terms[term].irradiance[texel as usize][c],
            Self::Sh(k, c) => page.sh1.as_ref().map_or(0.0, |sh| sh[texel as usize][k][c]),
        }
    }

    fn write(self, pages: &mut [PageBuffers], (page, texel): At, value: f32) {
        let page = &mut pages[page as usize];
        match self {
            Self::Term(term, c) => page.terms[term].irradiance[texel as usize][c] = value.max(0.0),
            Self::Sh(k, c) => {
                if let Some(sh) = &mut page.sh1 {
                    sh[texel as usize][k][c] = if k == 0 { value.max(0.0) } else { value };
                }
            }
        }
    }
}

/// The least-squares problem, the same for every channel.
pub(super) struct System {
    /// The unknowns.
    texels: Vec<At>,
    /// Per unknown, λ.
    tether: Vec<f64>,
    /// Per place on a seam, the row of A.
    rows: Vec<Vec<(u32, f64)>>,
}

impl System {
    pub(super) fn new(seams: &[Seam], atlas: &Atlas, pages: &[PageBuffers]) -> Self {
        let samples: Vec<_> = seams
            .iter()
            .flat_map(|seam| seam.samples(atlas, PER_TEXEL))
            .filter(|sides| sides.iter().all(|side| seams::is_readable(pages, side)))
            .collect();
        let mut unknown: BTreeMap<At, u32> = BTreeMap::new();
        for (page, lookup) in samples.iter().flatten() {
            unknown.extend(lookup.used().map(|(texel, _)| ((*page, texel as u32), 0)));
        }
        for (number, index) in (0..).zip(unknown.values_mut()) {
            *index = number;
        }
        let row = |sides: &[(u32, crate::atlas::Bilinear); 2]| {
            let mut row = BTreeMap::new();
            for ((page, lookup), sign) in sides.iter().zip([1.0, -1.0]) {
                for (texel, weight) in lookup.used() {
                    *row.entry(unknown[&(*page, texel as u32)]).or_insert(0.0) += sign * f64::from(weight);
                }
            }
            row.into_iter().collect()
        };
        let rows = samples.iter().map(row).collect();
        let texels: Vec<At> = unknown.into_keys().collect();
        let tether = texels
            .iter()
            .map(|(page, texel)| match pages[*page as usize].validity[*texel as usize] {
                Validity::Good => TETHER_GOOD,
                _ => TETHER_FILLED,
            })
            .collect();
        Self { texels, tether, rows }
    }

    /// AᵀA v + diag(extra) v.
    fn normal(&self, v: &[f64], extra: Option<&[f64]>) -> Vec<f64> {
        let mut out: Vec<f64> = match extra {
            Some(extra) => v.iter().zip(extra).map(|(v, e)| v * e).collect(),
            None => vec![0.0; v.len()],
        };
        for row in &self.rows {
            let difference: f64 = row.iter().map(|(i, w)| w * v[*i as usize]).sum();
            for (i, w) in row {
                out[*i as usize] += w * difference;
            }
        }
        out
    }

    /// The stitched values of baked ones.
    fn stitched(&self, baked: &[f64]) -> Vec<f64> {
        let mut diagonal = self.tether.clone();
        for (i, w) in self.rows.iter().flatten() {
            diagonal[*i as usize] += w * w;
        }
        let mut residual: Vec<f64> = self.normal(baked, None).iter().map(|r| -r).collect();
        let mut change = vec![0.0; baked.len()];
        let precondition = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
        let mut z = precondition(&residual);
        let mut direction = z.clone();
        let mut rz = dot(&residual, &z);
        let stop = RESIDUAL * RESIDUAL * rz;
        for _ in 0..ITERATIONS {
            if rz <= stop {
                break;
            }
            let image = self.normal(&direction, Some(&self.tether));
            let step = rz / dot(&direction, &image);
            for (i, d) in direction.iter().enumerate() {
                change[i] += step * d;
                residual[i] -= step * image[i];
            }
            z = precondition(&residual);
            let next = dot(&residual, &z);
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = z + next / rz * *d;
            }
            rz = next;
        }
        baked.iter().zip(&change).map(|(b, c)| b + c).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    /// The solution satisfies the normal equations, and sums of inputs give sums of outputs.
    #[test]
    fn the_minimum_is_met_and_the_operator_is_linear() {
        let number = |i: u32, k: u32| f64::from(sobol_burley::sample(i, k, 11));
        let n = 200;
        let row = |s: u32| -> Vec<(u32, f64)> {
            let at = |k| (number(s, k) * f64::from(n)) as u32;
            vec![(at(0), number(s, 3)), (at(1), 1.0 - number(s, 3)), (at(2), -1.0)]
        };
        let system = System {
            texels: (0..n).map(|i| (0, i)).collect(),
            tether: (0..n).map(|i| if i % 3 == 0 { TETHER_FILLED } else { TETHER_GOOD }).collect(),
            rows: (0..400).map(row).collect(),
        };
        let a: Vec<f64> = (0..n).map(|i| number(i, 1) * 100.0).collect();
        let b: Vec<f64> = (0..n).map(|i| number(i, 2)).collect();
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + b).collect();
        let [x, y, both] = [&a, &b, &sum].map(|v| system.stitched(v));
        let left = system.normal(&x, Some(&system.tether));
        let mut equations = Worst::new("normal equations, against a right-hand side of about 100", 1e-5);
        let mut sums = Worst::new("sum of solutions against the solution of the sum, values up to 100", 1e-4);
        for i in 0..n as usize {
            equations.record((left[i] - system.tether[i] * a[i]).abs(), || format!("{i}"));
            sums.record((x[i] + y[i] - both[i]).abs(), || format!("{i}"));
        }
        equations.check();
        sums.check();
        assert!((x[0] - a[0]).abs() > 1e-3, "something was stitched");
    }
}
