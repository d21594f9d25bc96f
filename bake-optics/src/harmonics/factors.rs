//! Roots that every evaluation of harmonics needs, made at compile time for the bands in use and on the spot beyond.

use super::MAX_BANDS;
use crate::real::Real;

const SIZE: usize = MAX_BANDS + 1;

/// `sqrt((4l² − 1)/(l² − m²))`, m < l, and its reciprocal; 0 for m ≥ l.
static ASCENT: [[f64; SIZE]; SIZE] = ascent_tables().0;
static DESCENT: [[f64; SIZE]; SIZE] = ascent_tables().1;
/// `sqrt((2m+3)/(2m+2))`.
static SECTORAL: [f64; SIZE] = sectoral_table();
/// `sqrt((2l+1)/(4π))`.
static ZONAL: [f64; SIZE] = zonal_table();

/// `sqrt((4l² − 1)/(l² − m²))`, m < l: the factor that leads from Q_{l−1}^m to Q_l^m.
#[inline]
pub fn ascent<T: Real>(l: usize, m: usize) -> T {
    T::of(if l < SIZE { ASCENT[l][m] } else { ascent_ratio(l, m).sqrt() })
}

/// Its reciprocal; 0 for l = m, where the recurrence starts.
#[inline]
pub fn descent<T: Real>(l: usize, m: usize) -> T {
    if l < SIZE {
        T::of(DESCENT[l][m])
    } else if l == m {
        T::zero()
    } else {
        T::of(ascent_ratio(l, m).sqrt().recip())
    }
}

/// `sqrt((2m+3)/(2m+2))`: from Q_m^m to Q_{m+1}^{m+1}.
#[inline]
pub fn sectoral<T: Real>(m: usize) -> T {
    T::of(if m < SIZE { SECTORAL[m] } else { sectoral_ratio(m).sqrt() })
}

/// `sqrt((2l+1)/(4π))`: y_l at its axis.
#[inline]
pub fn zonal_norm<T: Real>(l: usize) -> T {
    T::of(if l < SIZE { ZONAL[l] } else { zonal_ratio(l).sqrt() })
}

const fn ascent_ratio(l: usize, m: usize) -> f64 {
    (4 * l * l - 1) as f64 / (l * l - m * m) as f64
}

const fn sectoral_ratio(m: usize) -> f64 {
    (2 * m + 3) as f64 / (2 * m + 2) as f64
}

const fn zonal_ratio(l: usize) -> f64 {
    (2 * l + 1) as f64 * (0.25 * std::f64::consts::FRAC_1_PI)
}

const fn ascent_tables() -> ([[f64; SIZE]; SIZE], [[f64; SIZE]; SIZE]) {
    let (mut up, mut down) = ([[0.0; SIZE]; SIZE], [[0.0; SIZE]; SIZE]);
    let mut l = 1;
    while l < SIZE {
        let mut m = 0;
        while m < l {
            up[l][m] = square_root(ascent_ratio(l, m));
            down[l][m] = 1.0 / up[l][m];
            m += 1;
        }
        l += 1;
    }
    (up, down)
}

const fn sectoral_table() -> [f64; SIZE] {
    let mut table = [0.0; SIZE];
    let mut m = 0;
    while m < SIZE {
        table[m] = square_root(sectoral_ratio(m));
        m += 1;
    }
    table
}

const fn zonal_table() -> [f64; SIZE] {
    let mut table = [0.0; SIZE];
    let mut l = 0;
    while l < SIZE {
        table[l] = square_root(zonal_ratio(l));
        l += 1;
    }
    table
}

/// Newton's iteration from above, for constants between 0.01 and 1000: f64::sqrt is not const.
const fn square_root(x: f64) -> f64 {
    let mut root = if x > 1.0 { x } else { 1.0 };
    let mut i = 0;
    while i < 40 {
        root = 0.5 * (root + x / root);
        i += 1;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    #[test]
    fn tables_hold_the_roots_and_go_on_beyond_their_end() {
        let mut worst = Worst::new("roots at compile time", 4.5e-16);
        for l in 1..SIZE + 3 {
            (0..l).for_each(|m| worst.relative(ascent(l, m), ascent_ratio(l, m).sqrt(), || format!("{l} {m}")));
            (0..l)
                .for_each(|m| worst.relative(descent(l, m), ascent_ratio(l, m).sqrt().recip(), || format!("{l} {m}")));
            assert_eq!(descent::<f64>(l, l), 0.0);
            worst.relative(sectoral(l), sectoral_ratio(l).sqrt(), || format!("sectoral {l}"));
            worst.relative(zonal_norm(l), zonal_ratio(l).sqrt(), || format!("zonal {l}"));
        }
        worst.check();
    }
}
