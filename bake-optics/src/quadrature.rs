//! Gauss–Legendre rules: nodes and weights on (0, 1), measured from the left end so that no caller has to subtract.
//!
//! Nodes come from the crate `gauss-quad` (Bogaert 2014, doi 10.1137/140954969: f64 accuracy at any size, O(n)).

use std::num::NonZeroUsize;

use crate::real::Real;

/// Largest rule kept by [`GaussLegendre::cached`].
pub const CACHED_NODES: usize = 256;

/// A Gauss–Legendre rule: `∫_0^1 f ≈ Σ weight f(node)`, exact for polynomials up to degree 2n − 1.
///
/// *Accuracy*: nodes and weights within 1e-15 in f64, correctly rounded from these in f32.
#[derive(Debug, Clone, PartialEq)]
pub struct GaussLegendre<T> {
    nodes: Vec<(T, T)>,
}

impl<T: Real> GaussLegendre<T> {
    /// A rule of `count` nodes. Zero counts as one.
    pub fn new(count: usize) -> Self {
        let count = NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN);
        let rule = gauss_quad::legendre::GaussLegendre::new(count);
        let to_unit = |&(x, w): &(f64, f64)| (T::of(0.5 * (1.0 + x)), T::of(0.5 * w));
        Self { nodes: rule.as_node_weight_pairs().iter().map(to_unit).collect() }
    }

    /// A rule made once per process and shared. Panics for `count` above [`CACHED_NODES`].
    pub fn cached(count: usize) -> &'static Self {
        T::gauss_legendre_cache()[count].get_or_init(|| Self::new(count))
    }

    /// Pairs (node, weight) on (0, 1), ascending; weights sum to 1.
    #[inline]
    pub fn nodes(&self) -> &[(T, T)] {
        &self.nodes
    }

    /// `∫_a^b f(x) dx`.
    #[inline]
    pub fn integrate(&self, a: T, b: T, mut f: impl FnMut(T) -> T) -> T {
        let length = b - a;
        let mut sum = T::zero();
        for &(node, weight) in &self.nodes {
            sum += weight * f(a + length * node);
        }
        sum * length
    }

    /// `∫_0^length f(offset) d offset`: for integrands that need the distance from the left end exactly.
    #[inline]
    pub fn integrate_offset(&self, length: T, f: impl FnMut(T) -> T) -> T {
        self.integrate(T::zero(), length, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    #[test]
    fn polynomials_up_to_degree_2n_minus_1_are_exact_and_the_next_is_not() {
        let mut worst = Worst::new("Gauss-Legendre monomials f64", 4e-15);
        for n in [1, 2, 3, 5, 8, 16, 24, 48, 96] {
            let rule = GaussLegendre::<f64>::cached(n);
            for degree in 0..2 * n {
                let got = rule.integrate(0.0, 1.0, |x| x.powi(degree as i32));
                worst.relative(got, 1.0 / (degree as f64 + 1.0), || format!("n {n} degree {degree}"));
            }
        }
        worst.check();
        let short = GaussLegendre::<f64>::cached(3).integrate(0.0, 1.0, |x| x.powi(6));
        assert!((short * 7.0 - 1.0).abs() > 1e-4, "three nodes must miss degree 6");
    }

    #[test]
    fn weights_sum_to_one_and_nodes_are_symmetric_in_both_precisions() {
        fn check<T: Real>(allowed: f64) {
            let mut worst = Worst::new("Gauss-Legendre symmetry", allowed);
            for n in 1..=64 {
                let nodes = GaussLegendre::<T>::cached(n).nodes().to_vec();
                assert_eq!(nodes.len(), n);
                assert!(nodes.windows(2).all(|pair| pair[0].0 < pair[1].0));
                worst.relative(nodes.iter().map(|n| n.1.as_f64()).sum(), 1.0, || format!("n {n}"));
                for i in 0..n {
                    let mirrored = nodes[i].0.as_f64() + nodes[n - 1 - i].0.as_f64();
                    worst.relative(mirrored, 1.0, || format!("n {n} node {i}"));
                }
            }
            worst.check();
        }
        check::<f64>(4e-15);
        check::<f32>(1.2e-7);
    }
}
