//! Exponential integrals of complex argument, scaled: `S_p(z) = e^z E_p(z)`, `E_p(z) = ∫_1^∞ e^{−zt} t^{−p} dt`.
//!
//! Air-light meets only Re z ≥ 0, far from the branch cut along the negative real axis; the left half plane is there for completeness
//! (p = 1). Ei is not offered: its −iπ is a constant of integration that costs all digits (P10 sec. 3.4).
//!
//! Sources: series Abramowitz & Stegun 5.1.11, continued fraction 5.1.22, recurrence 5.1.14, asymptotic series 5.1.51.

use num_complex::Complex;

use crate::real::Real;

/// `E_1(z)`, principal branch. Underflows to 0 for Re z > 745 (f64) or 103 (f32): use [`scaled_exponential_integral`] there.
///
/// *Accuracy*: that of the scaled form plus |z| ulp from e^{−z}.
pub fn e1<T: Real>(z: Complex<T>) -> Complex<T> {
    match region(z) {
        Region::Series => e1_series(z),
        _ => (-z).exp() * scaled_exponential_integral(1, z),
    }
}

/// `S_p(z) = e^z E_p(z)` for p ≥ 0 and Re z ≥ 0 (p ≤ 1: any z off the cut; im = +0 is its upper side). S_1(0) = +∞.
///
/// *Accuracy*, relative to |S_p|, Re z ≥ 0: 6e-15 in f64, 1e-6 in f32 (dense grid, 1e-6 ≤ |z| ≤ 1e6). In the continued fraction's region each component has that accuracy for itself:
/// its imaginary part is a sum of terms of one sign. *Cost*: up to 60 complex divisions (f64), 18 (f32).
pub fn scaled_exponential_integral<T: Real>(p: usize, z: Complex<T>) -> Complex<T> {
    match p {
        0 => recip(z),
        1 => s1(z),
        _ if z.norm() < T::of(2.0) => forward(z, p),
        _ => continued_fraction(p, z),
    }
}

/// `S_1(z) … S_n(z)` into `out` (length n), Re z ≥ 0.
///
/// The recurrence `p S_{p+1} = 1 − z S_p` multiplies errors by |z|/p upwards and by p/|z| downwards: start at p ≈ |z| and walk both ways.
pub fn scaled_exponential_integrals<T: Real>(z: Complex<T>, out: &mut [Complex<T>]) {
    let n = out.len();
    if n == 0 {
        return;
    }
    let start = if z.norm() < T::of(2.0) { 1 } else { z.norm().round().to_usize().unwrap_or(n).clamp(1, n) };
    out[start - 1] = scaled_exponential_integral(start, z);
    for p in (1..start).rev() {
        out[p - 1] = recip(z) * (-out[p] * T::of(p as f64) + T::one());
    }
    for p in start..n {
        out[p] = step_up(p, z, out[p - 1]);
    }
}

/// Which expansion holds.
enum Region {
    Series,
    ContinuedFraction,
    Asymptotic,
}

/// The series loses e^{|z| + Re z} (its largest term against |E_1|); the continued fraction needs about 220/(|z| + Re z) steps.
/// Both turn on the same number; close to the cut and far out neither serves, and the asymptotic series is exact to e^{−|z|}.
fn region<T: Real>(z: Complex<T>) -> Region {
    let modulus = z.norm();
    if modulus + z.re >= T::of(T::pick(3.0, 4.0)) {
        Region::ContinuedFraction
    } else if modulus < T::of(T::pick(20.0, 50.0)) {
        Region::Series
    } else {
        Region::Asymptotic
    }
}

fn s1<T: Real>(z: Complex<T>) -> Complex<T> {
    match region(z) {
        Region::Series if z.re == T::zero() && z.im == T::zero() => Complex::new(T::infinity(), T::zero()),
        Region::Series => z.exp() * e1_series(z),
        Region::ContinuedFraction => continued_fraction(1, z),
        Region::Asymptotic => asymptotic(z),
    }
}

/// `E_1 = −γ − ln z − Σ_{k≥1} (−z)^k/(k k!)`.
fn e1_series<T: Real>(z: Complex<T>) -> Complex<T> {
    let euler = T::of(0.577_215_664_901_532_9);
    let mut sum = -z.ln() - euler;
    let mut term = Complex::new(T::one(), T::zero());
    for k in 1..400 {
        let k = T::of(k as f64);
        term = term * -z / k;
        sum -= term / k;
        if size(term) <= size(sum) * T::epsilon() * T::of(0.25) {
            break;
        }
    }
    sum
}

fn size<T: Real>(z: Complex<T>) -> T {
    z.re.abs() + z.im.abs()
}

/// `S_p = 1/(z+p − 1·p/(z+p+2 − 2(p+1)/(z+p+4 − …)))`, backward from a fixed depth.
///
/// Depth: the truncation error falls as e^{−4 sqrt(n|z|) cos(arg z/2)}, and |z| cos²(arg z/2) = (|z| + Re z)/2.
fn continued_fraction<T: Real>(p: usize, z: Complex<T>) -> Complex<T> {
    let (least, reach) = T::pick((3.0, 45.0), (5.0, 220.0));
    let p = p as f64;
    let depth = (least + 0.5 * p + reach / (z.norm() + z.re).as_f64()) as usize;
    let mut tail = z + T::of(p + 2.0 * depth as f64);
    for k in (1..=depth).rev() {
        let k = k as f64;
        tail = z + T::of(p + 2.0 * (k - 1.0)) - recip(tail) * T::of(k * (p + k - 1.0));
    }
    recip(tail)
}

/// `S_1 ~ (1/z) Σ (−1)^k k!/z^k`, 16 terms; the exponentially small jump across the negative axis is below rounding here.
fn asymptotic<T: Real>(z: Complex<T>) -> Complex<T> {
    let inverse = recip(z);
    let mut sum = Complex::new(T::one(), T::zero());
    for k in (1..=T::pick(10, 24)).rev() {
        sum = -inverse * sum * T::of(k as f64) + T::one();
    }
    inverse * sum
}

fn forward<T: Real>(z: Complex<T>, p: usize) -> Complex<T> {
    (1..p).fold(s1(z), |s, k| step_up(k, z, s))
}

/// `S_{p+1} = (1 − z S_p)/p`, with z S_1 → 0 at z = 0 where S_1 is infinite.
fn step_up<T: Real>(p: usize, z: Complex<T>, s: Complex<T>) -> Complex<T> {
    let product = if z.re == T::zero() && z.im == T::zero() { z } else { z * s };
    (-product + T::one()) / T::of(p as f64)
}

/// 1/z after Smith 1962: no overflow of |z|², each component to a few ulp.
fn recip<T: Real>(z: Complex<T>) -> Complex<T> {
    if z.re.abs() >= z.im.abs() {
        let ratio = z.im / z.re;
        let scale = (z.re + z.im * ratio).recip();
        Complex::new(scale, -ratio * scale)
    } else {
        let ratio = z.re / z.im;
        let scale = (z.re * ratio + z.im).recip();
        Complex::new(ratio * scale, -scale)
    }
}
