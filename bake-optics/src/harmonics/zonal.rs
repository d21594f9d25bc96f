//! Functions of the angle about one axis, as N zonal coefficients z_l: evaluation, products, rotation, cosine lobes.

use super::factors::zonal_norm;
use super::real_sh::real_sh_into;
use crate::legendre::{half_range_moments, legendre, legendre_all, legendre_next};
use crate::real::Real;

/// `y_l(c) = sqrt((2l+1)/(4π)) P_l(c)`, the orthonormal zonal harmonic Y_l0 about its axis.
pub fn y_zonal<T: Real>(l: usize, cos_angle: T) -> T {
    zonal_norm::<T>(l) * legendre(l, cos_angle)
}

/// `y_0(c) … y_{n−1}(c)` into `out` (length n).
pub fn y_zonal_all<T: Real>(cos_angle: T, out: &mut [T]) {
    legendre_all(cos_angle, out);
    out.iter_mut().enumerate().for_each(|(l, y)| *y *= zonal_norm::<T>(l));
}

/// `Σ z_l y_l(c)`: the zonal function at an angle from its axis.
pub fn zonal_eval<T: Real>(zonal: &[T], cos_angle: T) -> T {
    weighted_legendre_sum(cos_angle, zonal.iter().enumerate().map(|(l, &z)| z * zonal_norm::<T>(l)))
}

/// Zonal coefficients `z_l = c_l sqrt(4π/(2l+1))` of a Legendre series `Σ c_l P_l`.
pub fn zonal_from_legendre<T: Real>(legendre: &[T]) -> Vec<T> {
    legendre.iter().enumerate().map(|(l, &c)| c / zonal_norm::<T>(l)).collect()
}

/// Integral over the sphere of two zonal functions about axes at angle D: `Σ g_l h_l P_l(cos D)`.
///
/// O(N) for axes in any position (Dubouchet et al. 2019, appendix A; the addition theorem applied to both rotations).
/// Bands beyond the shorter of the two count as zero. *Accuracy*: 1e-7 of `Σ |g_l h_l|` in f32, 16 bands. *Cost*: 3N multiply-adds.
pub fn zonal_dot<T: Real>(g: &[T], h: &[T], cos_between_axes: T) -> T {
    weighted_legendre_sum(cos_between_axes, g.iter().zip(h).map(|(&g, &h)| g * h))
}

/// Rotation to any axis: real SH coefficients `sqrt(4π/(2l+1)) z_l Y_lm(axis)`, index l(l+1)+m.
pub fn zonal_to_sh<T: Real>(zonal: &[T], axis: [T; 3]) -> Vec<T> {
    let mut out = vec![T::zero(); zonal.len() * zonal.len()];
    real_sh_into(axis, zonal.len(), &mut out);
    for (l, &z) in zonal.iter().enumerate() {
        let scale = z / zonal_norm::<T>(l);
        out[l * l..(l + 1) * (l + 1)].iter_mut().for_each(|y| *y *= scale);
    }
    out
}

/// `A_l = 2π ∫_0^1 c P_l(c) dc`: π, 2π/3, π/4, 0, −π/24, 0, π/64 … (Ramamoorthi & Hanrahan 2001), so that a surface at angle η from
/// the axis of an incident zonal radiance z receives `E = Σ A_l z_l y_l(cos η)`.
pub fn clamped_cosine<T: Real>(bands: usize) -> Vec<T> {
    power_cosine(T::one(), bands)
}

/// `2π ∫_0^1 c^n P_l(c) dc`, real n ≥ 0: the lobe max(0, c)^n in the convention of [`clamped_cosine`].
pub fn power_cosine<T: Real>(exponent: T, bands: usize) -> Vec<T> {
    let mut out = vec![T::zero(); bands];
    half_range_moments(exponent, &mut out);
    out.iter_mut().for_each(|a| *a *= T::TAU());
    out
}

/// Zonal coefficients `∫ max(0, c)^n y_l dω` of the lobe max(0, c)^n itself, for [`zonal_dot`] and `zonal_convolve`.
pub fn zonal_power_cosine<T: Real>(exponent: T, bands: usize) -> Vec<T> {
    let mut out = power_cosine(exponent, bands);
    out.iter_mut().enumerate().for_each(|(l, a)| *a *= zonal_norm::<T>(l));
    out
}

/// The normalised Phong lobe `(n+1)/(2π) max(0, c)^n` in the convention of [`clamped_cosine`]; the first coefficient is 1.
pub fn phong<T: Real>(exponent: T, bands: usize) -> Vec<T> {
    let mut out = vec![T::zero(); bands];
    half_range_moments(exponent, &mut out);
    out.iter_mut().for_each(|a| *a *= exponent + T::one());
    out
}

/// Irradiance on a surface whose normal makes the angle η with the axis of an incident zonal radiance: `Σ A_l z_l y_l(cos η)`.
///
/// *Cost*: no allocation; the A_l are produced by their recurrence along the way.
pub fn irradiance<T: Real>(zonal: &[T], cos_eta: T) -> T {
    let mut half_range = [T::of(0.5), T::of(1.0 / 3.0)];
    let terms = zonal.iter().enumerate().map(|(l, &z)| {
        if l >= 2 {
            half_range[l % 2] *= T::of((3.0 - l as f64) / (2.0 + l as f64));
        }
        half_range[l % 2] * z * zonal_norm::<T>(l)
    });
    weighted_legendre_sum(cos_eta, terms) * T::TAU()
}

/// Convolution of a function's SH coefficients with a zonal kernel about each direction: band l times `sqrt(4π/(2l+1)) k_l` (Driscoll & Healy 1994).
/// Bands that the kernel lacks become 0.
pub fn zonal_convolve<T: Real>(coefficients: &mut [T], kernel: &[T]) {
    for l in 0..coefficients.len().isqrt() {
        let factor = kernel.get(l).map_or(T::zero(), |&k| k / zonal_norm::<T>(l));
        coefficients[l * l..(l + 1) * (l + 1)].iter_mut().for_each(|c| *c *= factor);
    }
}

/// `Σ w_l P_l(x)` by the forward recurrence, weights produced on the fly.
#[inline]
fn weighted_legendre_sum<T: Real>(x: T, weights: impl Iterator<Item = T>) -> T {
    let (mut previous, mut current, mut sum) = (T::zero(), T::one(), T::zero());
    for (l, weight) in weights.enumerate() {
        sum += weight * current;
        (previous, current) = (current, legendre_next(l, x, current, previous));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::{project, real_sh};
    use super::*;
    use testkit::compare::Worst;

    fn unit(x: f64, y: f64, z: f64) -> [f64; 3] {
        let r = (x * x + y * y + z * z).sqrt();
        [x / r, y / r, z / r]
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    #[test]
    fn cosine_coefficients_are_the_published_ones() {
        let pi = std::f64::consts::PI;
        let want = [pi, 2.0 * pi / 3.0, pi / 4.0, 0.0, -pi / 24.0, 0.0, pi / 64.0];
        let mut worst = Worst::new("clamped cosine", 1e-15);
        for (got, want) in clamped_cosine::<f64>(7).iter().zip(want) {
            worst.relative(*got, want, || format!("{want}"));
        }
        worst.check();
    }

    #[test]
    fn a_rotated_zonal_function_is_the_same_function() {
        let zonal: Vec<f64> = (0..16).map(|l| (1.0 + l as f64).recip()).collect();
        let mut worst = Worst::new("zonal rotation (absolute)", 2e-14);
        for axis in
            [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], unit(1.0, 0.0, 0.0), unit(0.3, -0.8, 0.1), unit(1e-9, 1e-9, -1.0)]
        {
            let sh = zonal_to_sh(&zonal, axis);
            for direction in [unit(0.0, 1.0, 0.0), unit(0.5, 0.5, -0.7), unit(-0.2, 0.9, 0.4), axis] {
                let got: f64 = sh.iter().zip(real_sh(direction, 16)).map(|(c, y)| c * y).sum();
                worst.record((got - zonal_eval(&zonal, dot(axis, direction))).abs(), || {
                    format!("{axis:?} {direction:?}")
                });
            }
        }
        worst.check();
    }

    #[test]
    fn the_double_product_equals_the_sum_over_rotated_coefficients() {
        let g: Vec<f64> = (0..16).map(|l| (0.7f64).powi(l)).collect();
        let h: Vec<f64> = (0..16).map(|l| (-0.9f64).powi(l)).collect();
        let (a, b) = (unit(0.2, 0.7, -0.4), unit(-0.9, 0.1, 0.3));
        let want: f64 = zonal_to_sh(&g, a).iter().zip(zonal_to_sh(&h, b)).map(|(g, h)| g * h).sum();
        let got = zonal_dot(&g, &h, dot(a, b));
        assert!((got - want).abs() < 1e-13 * want.abs(), "{got} {want}");
        // Negative control: the extra y_l factor that the convention tempts to add.
        let wrong: f64 = (0..16).map(|l| g[l] * h[l] * y_zonal(l, dot(a, b))).sum();
        assert!((wrong - want).abs() > 0.1 * want.abs());
    }

    #[test]
    fn irradiance_is_the_cosine_weighted_integral() {
        let zonal: Vec<f64> = (0..8).map(|l| (0.6f64).powi(l)).collect();
        let normal = unit(0.3, 0.4, 0.5);
        let axis = unit(-0.3, 0.8, 0.1);
        // The clamped cosine about the normal, projected exactly (band-limited product: only l < 8 meets the radiance).
        let cosine = zonal_power_cosine(1.0, 8);
        let want = zonal_dot(&zonal, &cosine, dot(normal, axis));
        assert!((irradiance(&zonal, dot(normal, axis)) - want).abs() < 1e-14);
        let by_quadrature = project(1, 64, |w| zonal_eval(&zonal, dot(w, axis)) * dot(w, [0.0, 0.0, 1.0]).max(0.0))[0];
        let e = irradiance(&zonal, axis[2]);
        assert!((by_quadrature * (4.0 * std::f64::consts::PI).sqrt() - e).abs() < 1e-3 * e, "{by_quadrature} {e}");
    }

    #[test]
    fn convolving_with_the_clamped_cosine_gives_irradiance() {
        let (zonal, axis) = ((0..16).map(|l| (0.8f64).powi(l)).collect::<Vec<_>>(), unit(0.1, -0.4, 0.9));
        let kernel = zonal_power_cosine(1.0, 16);
        let mut sh = zonal_to_sh(&zonal, axis);
        zonal_convolve(&mut sh, &kernel);
        let mut worst = Worst::new("irradiance two ways (absolute)", 1e-13);
        for normal in [unit(0.0, 0.0, 1.0), unit(1.0, 2.0, 3.0), unit(-1.0, 0.2, -0.6)] {
            let got = super::super::sh_sum(&sh, normal);
            worst.record((got - irradiance(&zonal, dot(normal, axis))).abs(), || format!("{normal:?}"));
        }
        worst.check();
    }

    #[test]
    fn phong_lobes_are_normalised_and_agree_with_quadrature() {
        let rule = crate::quadrature::GaussLegendre::<f64>::cached(96);
        let mut worst = Worst::new("Phong coefficients (absolute)", 1e-13);
        for n in [0.0, 1.0, 10.0, 20.0, 64.0] {
            let lobe = phong(n, 16);
            assert_eq!(lobe[0], 1.0);
            for (l, &got) in lobe.iter().enumerate() {
                let want = rule.integrate(0.0, 1.0, |c| (n + 1.0) * c.powf(n) * legendre(l, c));
                worst.record((got - want).abs(), || format!("n {n} l {l}"));
            }
        }
        worst.check();
    }

    #[test]
    fn single_precision_double_products_stay_within_their_limit() {
        let mut worst = Worst::new("double product f32, 16 bands (of the sum of |g h|)", 5e-7);
        for i in 0..=400 {
            let c = (i as f32 * 0.005 - 1.0).min(1.0);
            let (g, h): (Vec<f32>, Vec<f32>) =
                (0..16).map(|l| ((l as f32 + i as f32).sin(), (l as f32 * 1.7).cos())).unzip();
            let wide = |v: &[f32]| v.iter().map(|&x| f64::from(x)).collect::<Vec<_>>();
            let scale: f32 = g.iter().zip(&h).map(|(g, h)| (g * h).abs()).sum();
            let want = zonal_dot(&wide(&g), &wide(&h), f64::from(c));
            worst.record((f64::from(zonal_dot(&g, &h, c)) - want).abs() / f64::from(scale), || format!("c {c}"));
        }
        worst.check();
    }
}
