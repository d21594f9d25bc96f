//! Receiver and emitter in the frame of an axial response, without a frame: only dot products.
//!
//! a = direction from receiver to emitter, n = receiver's normal (or any direction), e = the emitter's axis (a surface's
//! normal), c = cos θ = −e·a. With p = e − (e·a) a, |p| = sin θ, every `sin^m θ Y_lm(n)` is a polynomial in n·a and n·p.

use crate::angles::coordinate;
use crate::axial::HARMONIC_COUNT;
use crate::node::Basis;
use glam::Vec3;
use wide::f32x4;

/// What a look-up needs to know of receiver and emitter: made once, used for all channels and orders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Place of cos θ among the angle nodes, −1 … 1.
    pub(crate) angle: f32,
    /// `A_l sin^m θ Y_lm(n)` in the order of [`crate::axial::HARMONICS`].
    pub(crate) basis: Basis,
}

/// Norms: `A_l`, the norm of Y_lm and the leading factor of the polynomial.
const N00: f32 = 0.886_226_93; // π sqrt(1/4π)
const N1: f32 = 1.023_326_7; // 2π/3 sqrt(3/4π)
const N20: f32 = 0.247_707_96; // π/4 sqrt(5/4π) / 2
const N21: f32 = 0.858_085_53; // π/4 sqrt(15/4π)
const N22: f32 = 0.429_042_77; // π/4 sqrt(15/16π)
const N40: f32 = -0.013_847_296; // −π/24 sqrt(9/4π) / 8
const N41: f32 = -0.017_515_598; // −π/24 sqrt(9/4π) sqrt(2/20) / 2
const N42: f32 = -0.061_926_99; // −π/24 sqrt(9/4π) sqrt(2/360) 15/2
const N43: f32 = -0.231_709_58; // −π/24 sqrt(9/4π) sqrt(2/5040) 105
const N44: f32 = -0.081_921_71; // −π/24 sqrt(9/4π) sqrt(2/40320) 105
const N60: f32 = 0.003_120_446; // π/64 sqrt(13/4π) / 16
const N61: f32 = 0.028_599_36; // π/64 sqrt(13/4π) sqrt(2/42) 21/8
const N80: f32 = -0.000_223_022_9; // −π/128 sqrt(17/4π) / 128

/// (2,0), (4,0), (6,0), (8,0): coefficients of 1, z² … z⁸.
const ZONAL: [[f32; 4]; 5] = [
    [-N20, 3.0 * N40, -5.0 * N60, 35.0 * N80],
    [3.0 * N20, -30.0 * N40, 105.0 * N60, -1260.0 * N80],
    [0.0, 35.0 * N40, -315.0 * N60, 6930.0 * N80],
    [0.0, 0.0, 231.0 * N60, -12012.0 * N80],
    [0.0, 0.0, 0.0, 6435.0 * N80],
];

/// (1,1), (2,1), (4,1), (6,1): coefficients of x times 1, z, z³, z⁵.
const SIDEWAYS: [[f32; 4]; 4] = [
    [N1, 0.0, 0.0, 0.0],
    [0.0, N21, -15.0 * N41, 5.0 * N61],
    [0.0, 0.0, 35.0 * N41, -30.0 * N61],
    [0.0, 0.0, 0.0, 33.0 * N61],
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
        Self { angle: coordinate(-e_a), basis: Basis::new(basis(z, x, q2)) }
    }
}

/// `A_l sin^m θ Y_lm`: stripped Legendre polynomials in z times `q^m cos mφ` (Chebyshev) in x = q cos φ; in the lanes of
/// [`crate::node`], two of them empty.
#[inline]
fn basis(z: f32, x: f32, q2: f32) -> [f32x4; 4] {
    let (z2, x2) = (z * z, x * x);
    let double = 2.0 * x2 - q2;
    let (wide_z2, [z0, z1, z2s, z3, z4]) = (f32x4::splat(z2), ZONAL.map(f32x4::from));
    let zonal = z0 + wide_z2 * (z1 + wide_z2 * (z2s + wide_z2 * (z3 + wide_z2 * z4)));
    let [s0, s1, s3, s5] = SIDEWAYS.map(f32x4::from);
    let sideways = f32x4::splat(x) * (s0 + f32x4::splat(z) * (s1 + wide_z2 * (s3 + wide_z2 * s5)));
    let higher = [
        N22 * double,
        N42 * (7.0 * z2 - 1.0) * double,
        N43 * z * (4.0 * x2 - 3.0 * q2) * x,
        N44 * (8.0 * x2 * (x2 - q2) + q2 * q2),
    ];
    [f32x4::from([0.0, 0.0, N00, N1 * z]), zonal, sideways, f32x4::from(higher)]
}

/// World SH coefficients, l ≤ 2, index l(l+1)+m, of the incident radiance whose stripped coefficients
/// (`AxialResponse::coefficients`) are given: what a probe adds up.
///
/// *Equation*: degree 1 is the vector `L_10 a + L_11' p`, degree 2 the traceless matrix
/// `L_20 (3aaᵀ − 1)/2 + √3/2 [L_21' (apᵀ + paᵀ) + L_22' (ppᵀ − bbᵀ)]`, b = a × p; primes: divided by sin^m θ.
pub fn probe_sh(stripped: &[f32; HARMONIC_COUNT], to_emitter: Vec3, axis_emitter: Vec3) -> [f32; 9] {
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
        let cosine = clamped_cosine::<f64>(9);
        for (n, theta) in samples() {
            let axis = Vec3::new(theta.sin(), 0.0, -theta.cos());
            let z = n.dot(Vec3::Z);
            let x = n.dot(axis) - z * axis.z;
            let got = basis(z, x, (1.0 - z * z).max(0.0) * (1.0 - axis.z * axis.z).max(0.0));
            assert_eq!(Geometry::new(n, Vec3::Z, axis).basis, Basis::new(got));
            let got: [f32; 16] = bytemuck::cast(got);
            let got = |h: usize| got[2 + crate::node::LANES.iter().position(|&lane| lane == h).expect("in a lane")];
            let y = real_sh(n.to_array().map(f64::from), 9);
            for (h, &(l, m)) in HARMONICS.iter().enumerate() {
                let want = cosine[l] * f64::from(theta.sin()).powi(m as i32) * y[sh_index(l, m as isize)];
                worst.record((f64::from(got(h)) - want).abs(), || format!("{n} theta {theta} {l},{m}"));
            }
        }
        worst.check();
    }

    #[test]
    fn probe_coefficients_are_those_of_the_rotated_radiance() {
        let mut worst = Worst::new("probe SH against the radiance itself (absolute)", 3e-6);
        let stripped: [f32; HARMONIC_COUNT] =
            std::array::from_fn(|h| [0.9, -0.4, 0.7, 0.3, -0.8, 0.5].get(h).copied().unwrap_or(0.0));
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
