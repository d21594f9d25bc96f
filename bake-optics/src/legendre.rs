//! Legendre polynomials and finite Legendre series on [−1, 1]: evaluation, projection, integrals over (0, 1).
//!
//! A series here is plain coefficients `c_j` of `Σ c_j P_j(x)`; phase functions, emitters and zonal harmonics scale them.

use crate::quadrature::GaussLegendre;
use crate::real::Real;

/// `P_0(x) … P_{n-1}(x)` into `out` (length n), |x| ≤ 1.
///
/// *Equation*: (l+1) P_{l+1} = (2l+1) x P_l − l P_{l−1} (Bonnet). *Accuracy*: absolute error below n ulp.
pub fn legendre_all<T: Real>(x: T, out: &mut [T]) {
    let (mut previous, mut current) = (T::zero(), T::one());
    for (l, slot) in out.iter_mut().enumerate() {
        *slot = current;
        (previous, current) = (current, legendre_next(l, x, current, previous));
    }
}

/// `P_l(x)`, |x| ≤ 1. *Cost*: l multiply-add pairs.
pub fn legendre<T: Real>(l: usize, x: T) -> T {
    let (mut previous, mut current) = (T::zero(), T::one());
    for j in 0..l {
        (previous, current) = (current, legendre_next(j, x, current, previous));
    }
    current
}

/// `P_{l+1}` from `P_l` and `P_{l−1}` (the latter ignored for l = 0).
#[inline]
pub fn legendre_next<T: Real>(l: usize, x: T, p_l: T, p_below: T) -> T {
    let l = l as f64;
    // The form x P_l + l/(l+1) (x P_l − P_{l−1}) keeps P_l(1) = 1 exactly.
    let forward = x * p_l;
    forward + T::of(l / (l + 1.0)) * (forward - p_below)
}

/// `Σ c_j P_j(x)` by Clenshaw's backward recurrence: no array of polynomials, error of one rounding per term.
pub fn series<T: Real>(coefficients: &[T], x: T) -> T {
    let (mut above, mut current) = (T::zero(), T::zero());
    for (j, &c) in coefficients.iter().enumerate().rev() {
        let j = j as f64;
        let next = c + T::of((2.0 * j + 1.0) / (j + 1.0)) * x * current - T::of((j + 1.0) / (j + 2.0)) * above;
        (above, current) = (current, next);
    }
    current
}

/// Series coefficients of f over [−1, 1]: `c_j = (2j+1)/2 ∫ f P_j dx` for j < `count`, by `nodes` Gauss–Legendre nodes per panel.
///
/// `breaks` are the places (ascending, inside (−1, 1)) where f or its derivative jumps; panels end there.
pub fn project<T: Real>(count: usize, nodes: usize, breaks: &[T], f: impl Fn(T) -> T) -> Vec<T> {
    let rule = GaussLegendre::<T>::new(nodes);
    let mut sums = vec![T::zero(); count];
    let mut polynomials = vec![T::zero(); count];
    let mut start = -T::one();
    for &end in breaks.iter().chain([&T::one()]) {
        let length = end - start;
        for &(node, weight) in rule.nodes() {
            let x = start + length * node;
            legendre_all(x, &mut polynomials);
            let value = f(x) * weight * length;
            sums.iter_mut().zip(&polynomials).for_each(|(sum, &p)| *sum += p * value);
        }
        start = end;
    }
    sums.iter().enumerate().map(|(j, &sum)| sum * T::of(j as f64 + 0.5)).collect()
}

/// `∫_0^1 x^n P_l(x) dx` for l < `out.len()` and real n ≥ 0.
///
/// *Equation*: I_0 = 1/(n+1), I_1 = 1/(n+2), I_l = I_{l−2} (n − l + 2)/(n + l + 1) (integrate Legendre's equation
/// against x^n, or Erdélyi 1954, 16.2). Exact zeros for integer n < l of equal parity; every step is one product, so no cancellation.
pub fn half_range_moments<T: Real>(n: T, out: &mut [T]) {
    for l in 0..out.len() {
        let degree = T::of(l as f64);
        out[l] = match l {
            0 => T::one() / (n + T::one()),
            1 => T::one() / (n + T::of(2.0)),
            _ => out[l - 2] * (n - degree + T::of(2.0)) / (n + degree + T::one()),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    #[test]
    fn known_values_and_ends() {
        // P_4(x) = (35 x^4 − 30 x^2 + 3)/8 (Abramowitz & Stegun 22.3.8).
        let x: f64 = 0.3;
        let want = (35.0 * x.powi(4) - 30.0 * x * x + 3.0) / 8.0;
        assert!((legendre(4, x) - want).abs() < 1e-15);
        for l in 0..64 {
            assert_eq!(legendre(l, 1.0f32), 1.0);
            assert_eq!(legendre(l, -1.0f64), if l % 2 == 0 { 1.0 } else { -1.0 });
        }
    }

    #[test]
    fn clenshaw_agrees_with_the_sum_of_polynomials() {
        let mut worst = Worst::new("Clenshaw against recurrence (absolute, of sum |c|)", 2e-15);
        let c: Vec<f64> = (0..40).map(|j| ((j * j) as f64).sin()).collect();
        let scale: f64 = c.iter().map(|v| v.abs()).sum();
        let mut p = vec![0.0; c.len()];
        for i in 0..=200 {
            let x = -1.0 + i as f64 * 0.01;
            legendre_all(x, &mut p);
            let want: f64 = p.iter().zip(&c).map(|(p, c)| p * c).sum();
            worst.record((series(&c, x) - want).abs() / scale, || format!("x {x}"));
        }
        worst.check();
    }

    #[test]
    fn projection_returns_the_coefficients_it_was_given() {
        let c = [1.0, -0.5, 0.25, 3.0, 0.0, 0.125];
        let got = project(6, 12, &[], |x: f64| series(&c, x));
        let mut worst = Worst::new("projection of a series (absolute)", 1e-14);
        got.iter().zip(&c).for_each(|(g, c)| worst.record((g - c).abs(), || format!("{c}")));
        worst.check();
    }

    #[test]
    fn half_range_moments_agree_with_quadrature() {
        let mut worst = Worst::new("half-range moments (absolute)", 2e-15);
        let rule = GaussLegendre::<f64>::cached(96);
        let mut out = [0.0; 17];
        for n in [0.0, 1.0, 2.0, 7.0, 10.0, 40.0] {
            half_range_moments(n, &mut out);
            for (l, &got) in out.iter().enumerate() {
                let want = rule.integrate(0.0, 1.0, |x| x.powf(n) * legendre(l, x));
                worst.record((got - want).abs(), || format!("n {n} l {l}"));
            }
        }
        worst.check();
    }
}
