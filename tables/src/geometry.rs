//! Receiver and emitter in the frame of an axial response, without a frame: only dot products.
//!
//! a = direction from receiver to emitter, n = receiver's normal (or any direction), e = the emitter's axis (a surface's
//! normal), c = cos θ = −e·a. With p = e − (e·a) a, |p| = sin θ, every `sin^m θ Y_lm(n)` is a polynomial in n·a and n·p.

use glam::Vec3;

/// What a look-up needs to know of receiver and emitter: made once, used for all channels and orders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Place of cos θ among the angle nodes, −1 … 1.
    pub(crate) angle: f32,
    /// `A_l sin^m θ Y_lm(n)` in the order of [`crate::axial::HARMONICS`], and one 0.
    pub(crate) basis: [f32; 12],
}

/// `A_l`, the norm of Y_lm and the leading factor of the polynomial in one number per harmonic.
const FACTORS: [f32; 11] = [
    0.886_226_93,   // π sqrt(1/4π)
    1.023_326_7,    // 2π/3 sqrt(3/4π)
    1.023_326_7,    // the same
    0.247_707_96,   // π/4 sqrt(5/4π) / 2
    0.858_085_53,   // π/4 sqrt(15/4π)
    0.429_042_77,   // π/4 sqrt(15/16π)
    -0.013_847_296, // −π/24 sqrt(9/4π) / 8
    -0.017_515_598, // −π/24 sqrt(9/4π) sqrt(2/20) / 2
    -0.061_926_99,  // −π/24 sqrt(9/4π) sqrt(2/360) 15/2
    -0.231_709_58,  // −π/24 sqrt(9/4π) sqrt(2/5040) 105
    -0.081_921_71,  // −π/24 sqrt(9/4π) sqrt(2/40320) 105
];

impl Geometry {
    /// From unit vectors: receiver's normal, direction from the receiver to the emitter, the emitter's axis.
    #[inline]
    pub fn new(normal_receiver: Vec3, to_emitter: Vec3, axis_emitter: Vec3) -> Self {
        let z = normal_receiver.dot(to_emitter);
        let e_a = axis_emitter.dot(to_emitter);
        // x = n·p, q² = |n − (n·a)a|² |p|²: the square of what multiplies cos φ in x.
        let x = normal_receiver.dot(axis_emitter) - z * e_a;
        let q2 = (1.0 - z * z).max(0.0) * (1.0 - e_a * e_a).max(0.0);
        Self { angle: angle_coordinate(-e_a), basis: basis(z, x, q2) }
    }
}

/// `s = c sqrt(2/(1 + c²))`: see [`crate::area::AngleGrid`].
#[inline]
pub(crate) fn angle_coordinate(cos_emitter: f32) -> f32 {
    let c = cos_emitter.clamp(-1.0, 1.0);
    c * (2.0 / (1.0 + c * c)).sqrt()
}

/// `A_l sin^m θ Y_lm`: stripped Legendre polynomials in z times `q^m cos mφ` (Chebyshev) in x = q cos φ.
#[inline]
fn basis(z: f32, x: f32, q2: f32) -> [f32; 12] {
    let f = FACTORS;
    let (z2, x2) = (z * z, x * x);
    let double = 2.0 * x2 - q2;
    [
        f[0],
        f[1] * z,
        f[2] * x,
        f[3] * (3.0 * z2 - 1.0),
        f[4] * z * x,
        f[5] * double,
        f[6] * ((35.0 * z2 - 30.0) * z2 + 3.0),
        f[7] * (35.0 * z2 - 15.0) * z * x,
        f[8] * (7.0 * z2 - 1.0) * double,
        f[9] * z * (4.0 * x2 - 3.0 * q2) * x,
        f[10] * (8.0 * x2 * (x2 - q2) + q2 * q2),
        0.0,
    ]
}

/// World SH coefficients, l ≤ 2, index l(l+1)+m, of the incident radiance whose stripped coefficients
/// (`AxialResponse::coefficients`) are given: what a probe adds up.
///
/// *Equation*: degree 1 is the vector `L_10 a + L_11' p`, degree 2 the traceless matrix
/// `L_20 (3aaᵀ − 1)/2 + √3/2 [L_21' (apᵀ + paᵀ) + L_22' (ppᵀ − bbᵀ)]`, b = a × p; primes: divided by sin^m θ.
pub fn probe_sh(stripped: &[f32; 11], to_emitter: Vec3, axis_emitter: Vec3) -> [f32; 9] {
    let a = to_emitter;
    let p = axis_emitter - axis_emitter.dot(a) * a;
    let b = a.cross(p);
    let v = stripped[1] * a + stripped[2] * p;
    let half_root3 = 0.5 * 3.0f32.sqrt();
    let entry = |i: usize, j: usize| {
        let identity = if i == j { 1.0 } else { 0.0 };
        stripped[3] * 0.5 * (3.0 * a[i] * a[j] - identity)
            + half_root3 * (stripped[4] * (a[i] * p[j] + p[i] * a[j]) + stripped[5] * (p[i] * p[j] - b[i] * b[j]))
    };
    let (r, x, y, z) = (1.0 / 3.0f32.sqrt(), 0, 1, 2);
    [
        stripped[0],
        v.y,
        v.z,
        v.x,
        2.0 * r * entry(x, y),
        2.0 * r * entry(y, z),
        entry(z, z),
        2.0 * r * entry(x, z),
        r * (entry(x, x) - entry(y, y)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axial::HARMONICS;
    use bake_optics::harmonics::{clamped_cosine, real_sh, sh_index, sh_sum};
    use testkit::compare::Worst;

    /// Directions with the emitter leaning to +x: the frame in which the harmonics are defined, a = z.
    fn samples() -> Vec<(Vec3, f32)> {
        let normals = [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.3, -0.5, 0.8), Vec3::new(-0.7, 0.2, -0.4), Vec3::Y];
        let angles = [0.0f32, 1e-4, 0.3, 1.2, std::f32::consts::FRAC_PI_2, 2.0, 3.0, std::f32::consts::PI];
        normals.iter().flat_map(|n| angles.iter().map(move |&t| (n.normalize(), t))).collect()
    }

    #[test]
    fn the_contraction_is_the_clamped_cosine_against_real_harmonics() {
        let mut worst = Worst::new("A_l sin^m θ Y_lm(n) (absolute)", 2e-6);
        let cosine = clamped_cosine::<f64>(5);
        for (n, theta) in samples() {
            let axis = Vec3::new(theta.sin(), 0.0, -theta.cos());
            let geometry = Geometry::new(n, Vec3::Z, axis);
            let y = real_sh(n.to_array().map(f64::from), 5);
            for (h, &(l, m)) in HARMONICS.iter().enumerate() {
                let want = cosine[l] * f64::from(theta.sin()).powi(m as i32) * y[sh_index(l, m as isize)];
                worst.record((f64::from(geometry.basis[h]) - want).abs(), || format!("{n} theta {theta} {l},{m}"));
            }
        }
        worst.check();
    }

    #[test]
    fn probe_coefficients_are_those_of_the_rotated_radiance() {
        let mut worst = Worst::new("probe SH against the radiance itself (absolute)", 3e-6);
        let stripped = [0.9, -0.4, 0.7, 0.3, -0.8, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
        for (i, (a, axis)) in
            [(Vec3::Z, Vec3::X), (Vec3::new(0.2, -0.7, 0.4), Vec3::new(0.5, 0.5, -0.1)), (Vec3::X, -Vec3::X)]
                .iter()
                .enumerate()
        {
            let (a, axis) = (a.normalize(), axis.normalize());
            let p = axis - axis.dot(a) * a;
            let sin = p.length();
            let x = if sin > 0.0 { p / sin } else { a.any_orthonormal_vector() };
            let world = probe_sh(&stripped, a, axis).map(f64::from);
            for (direction, _) in samples() {
                let local = [direction.dot(x), direction.dot(a.cross(x)), direction.dot(a)].map(f64::from);
                let y = real_sh(local, 3);
                let want: f64 = (0..6)
                    .map(|h| {
                        let (l, m) = HARMONICS[h];
                        f64::from(stripped[h] * sin.powi(m as i32)) * y[sh_index(l, m as isize)]
                    })
                    .sum();
                let got = sh_sum(&world, direction.to_array().map(f64::from));
                worst.record((got - want).abs(), || format!("case {i} {direction}"));
            }
        }
        worst.check();
    }
}
