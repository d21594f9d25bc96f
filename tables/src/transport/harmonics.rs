//! Associated Legendre functions without Condon–Shortley sign in the two scalings the tables use.

/// `P̄_l^m(c)/sin^m θ = sqrt((l−m)!/(l+m)!) d^m P_l/dc^m` for l = 0 … `out.len()`−1 (zero below m): a polynomial in c.
///
/// *Equation*: three-term recurrence in l, `sqrt(l²−m²) p_l = (2l−1) c p_{l−1} − sqrt((l−1)²−m²) p_{l−2}`, from
/// `p_m = (2m−1)!!/sqrt((2m)!)`. *Accuracy*: 1e-14 of the largest value for l ≤ 16, m ≤ 10.
pub fn stripped_legendre(m: usize, c: f64, out: &mut [f64]) {
    let sectoral = (1..=m).fold(1.0, |p: f64, k| p * ((2 * k - 1) as f64 / (2 * k) as f64).sqrt());
    let root = |l: usize| ((l * l - m * m) as f64).sqrt();
    for l in 0..out.len() {
        out[l] = match l.cmp(&m) {
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Equal => sectoral,
            std::cmp::Ordering::Greater => {
                let below = if l >= m + 2 { root(l - 1) * out[l - 2] } else { 0.0 };
                ((2 * l - 1) as f64 * c * out[l - 1] - below) / root(l)
            }
        };
    }
}

/// `P̄_l^m(cos θ) = sqrt((l−m)!/(l+m)!) P_l^m(cos θ)` for l = 0 … `out.len()`−1.
pub fn scaled_legendre(m: usize, cos: f64, sin: f64, out: &mut [f64]) {
    stripped_legendre(m, cos, out);
    let power = sin.powi(m as i32);
    out.iter_mut().for_each(|p| *p *= power);
}

/// Factor that turns `P̄_l^m` into the real harmonic `Y_lm(γ, φ = 0)`: `sqrt((2l+1)/4π)`, times √2 for m > 0.
pub fn real_norm(l: usize, m: usize) -> f64 {
    let zonal = ((2 * l + 1) as f64 / (4.0 * std::f64::consts::PI)).sqrt();
    if m == 0 { zonal } else { std::f64::consts::SQRT_2 * zonal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    #[test]
    fn they_agree_with_the_real_harmonics_of_bake_optics() {
        let mut worst = Worst::new("P̄_l^m against real SH (absolute)", 1e-13);
        for step in 0..=40 {
            let gamma = std::f64::consts::PI * step as f64 / 40.0;
            let (s, c) = gamma.sin_cos();
            let y = bake_optics::harmonics::real_sh([s, 0.0, c], 12);
            for m in 0..12 {
                let mut p = [0.0; 12];
                scaled_legendre(m, c, s, &mut p);
                for l in m..12 {
                    let want = y[bake_optics::harmonics::sh_index(l, m as isize)];
                    worst.record((p[l] * real_norm(l, m) - want).abs(), || format!("l {l} m {m} gamma {gamma}"));
                }
            }
        }
        worst.check();
    }
}
