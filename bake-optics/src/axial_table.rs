//! A measured function of the angle from an axis: tabulated phase functions (Mie, measured) and lamps (IES).
//!
//! Linear in the **angle** between its points, zero outside their range: what photometric files mean and what renderers do. Everything derived
//! (flux, Legendre coefficients, sampling) belongs exactly to that interpolant.

use crate::legendre::legendre_all;
use crate::quadrature::GaussLegendre;
use crate::real::Real;

/// Why a table was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AxialTableError {
    /// Lengths differ or too few points.
    #[error("an axial table needs at least 2 angles and one value each; got {angles} angles, {values} values")]
    Shape {
        /// Number of angles.
        angles: usize,
        /// Number of values.
        values: usize,
    },
    /// Angles must ascend within [0, π].
    #[error("angle {index} of an axial table is {angle} rad; angles must ascend strictly from 0 to at most pi")]
    Angle {
        /// Which.
        index: usize,
        /// Its value.
        angle: f64,
    },
    /// Values must be finite and not negative.
    #[error("value {index} of an axial table is {value}; values must be finite and at least 0")]
    Value {
        /// Which.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A phase function or profile without any light.
    #[error("an axial table is zero everywhere; give at least one positive value")]
    Dark,
    /// A phase function must be known at every angle.
    #[error("a tabulated phase function covers {from} to {to} rad; it must cover 0 to pi")]
    Range {
        /// First angle.
        from: f64,
        /// Last angle.
        to: f64,
    },
}

/// Values at ascending angles (radians) from an axis, linear in the angle between, zero outside.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialTable<T> {
    angles: Vec<T>,
    values: Vec<T>,
    /// `2π ∫ value sin θ dθ` from the first angle up to each angle.
    cumulative: Vec<T>,
}

impl<T: Real> AxialTable<T> {
    /// Checks and stores a table. Angles in radians, ascending in [0, π]; values finite, ≥ 0, not all 0.
    /// First and last angle within 1e-6 rad of 0 and π are taken as these.
    pub fn new(mut angles: Vec<T>, values: Vec<T>) -> Result<Self, AxialTableError> {
        check(&angles, &values)?;
        snap_ends(&mut angles);
        let mut table = Self { angles, values, cumulative: vec![T::zero()] };
        for bin in 1..table.angles.len() {
            let (start, end) = (table.angles[bin - 1], table.angles[bin]);
            let so_far = table.cumulative[bin - 1];
            table.cumulative.push(so_far + table.mass_of_part(bin - 1, end - start));
        }
        if table.flux() > T::zero() { Ok(table) } else { Err(AxialTableError::Dark) }
    }

    /// Mean over the azimuth of a photometric profile: `relative` holds one row of `vertical.len()` values per horizontal angle.
    ///
    /// Horizontal angles (radians) follow the IES habits: one = the same all round; a span of π/2 or π = mirror-symmetric parts; else the circle closes
    /// from the last angle to the first. The mean is exact for a profile linear in the azimuth.
    pub fn from_profile(vertical: &[T], horizontal: &[T], relative: &[T]) -> Result<Self, AxialTableError> {
        let (rows, columns) = (horizontal.len(), vertical.len());
        if rows == 0 || relative.len() != rows * columns {
            return Err(AxialTableError::Shape { angles: columns, values: relative.len() });
        }
        let weights = azimuth_weights(horizontal);
        let mean = |column: usize| {
            weights.iter().enumerate().fold(T::zero(), |sum, (row, &w)| sum + w * relative[row * columns + column])
        };
        Self::new(vertical.to_vec(), (0..columns).map(mean).collect())
    }

    /// The angles, radians.
    pub fn angles(&self) -> &[T] {
        &self.angles
    }

    /// The values at the angles.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Value at an angle, radians.
    pub fn eval(&self, angle: T) -> T {
        let last = self.angles.len() - 1;
        if !(angle >= self.angles[0] && angle <= self.angles[last]) {
            return T::zero();
        }
        let bin = self.angles.partition_point(|&a| a <= angle).clamp(1, last) - 1;
        self.values[bin] + self.slope(bin) * (angle - self.angles[bin])
    }

    /// Integral over the sphere, `2π ∫ value sin θ dθ`.
    pub fn flux(&self) -> T {
        self.cumulative[self.cumulative.len() - 1]
    }

    /// The table times a factor.
    pub fn scaled(mut self, factor: T) -> Self {
        self.values.iter_mut().chain(&mut self.cumulative).for_each(|v| *v *= factor);
        self
    }

    /// The angle below which the share u of the flux lies, 0 ≤ u ≤ 1: bracketed Newton on the exact cumulative.
    pub fn sample(&self, u: T) -> T {
        let wanted = u.max(T::zero()).min(T::one()) * self.flux();
        let last = self.angles.len() - 1;
        let bin = self.cumulative.partition_point(|&c| c <= wanted).clamp(1, last) - 1;
        let rest = wanted - self.cumulative[bin];
        self.angles[bin] + self.invert_part(bin, rest)
    }

    /// Coefficients c_l of `Σ c_l P_l(cos θ)` for l < `bands`, interval by interval: `(2l+1)/2 ∫ value P_l sin θ dθ`.
    pub fn legendre(&self, bands: usize) -> Vec<T> {
        let (mut sums, mut p) = (vec![T::zero(); bands], vec![T::zero(); bands]);
        for bin in 0..self.angles.len() - 1 {
            let (start, end) = (self.angles[bin], self.angles[bin + 1]);
            let length = end - start;
            let nodes = 8 + (bands as f64 * length.as_f64()) as usize;
            for &(node, weight) in GaussLegendre::<T>::new(nodes).nodes() {
                let angle = start + length * node;
                legendre_all(angle.cos(), &mut p);
                let value = (self.values[bin] + self.slope(bin) * length * node) * angle.sin() * weight * length;
                sums.iter_mut().zip(&p).for_each(|(sum, &p)| *sum += value * p);
            }
        }
        sums.iter().enumerate().map(|(l, &sum)| sum * T::of(l as f64 + 0.5)).collect()
    }

    fn slope(&self, bin: usize) -> T {
        (self.values[bin + 1] - self.values[bin]) / (self.angles[bin + 1] - self.angles[bin])
    }

    /// Flux of a bin from its start to `offset` beyond it; 12 nodes are exact to rounding for bins up to π wide.
    fn mass_of_part(&self, bin: usize, offset: T) -> T {
        let (start, value, slope) = (self.angles[bin], self.values[bin], self.slope(bin));
        let density = |x: T| (value + slope * x) * (start + x).sin();
        T::TAU() * GaussLegendre::<T>::cached(12).integrate_offset(offset, density)
    }

    fn invert_part(&self, bin: usize, mass: T) -> T {
        let (mut low, mut high) = (T::zero(), self.angles[bin + 1] - self.angles[bin]);
        let mut x = high * T::of(0.5);
        for _ in 0..60 {
            let excess = self.mass_of_part(bin, x) - mass;
            if excess > T::zero() {
                high = x
            } else {
                low = x
            }
            let density = T::TAU() * (self.values[bin] + self.slope(bin) * x) * (self.angles[bin] + x).sin();
            let newton = x - excess / density;
            let next = if newton > low && newton < high { newton } else { (low + high) * T::of(0.5) };
            if (next - x).abs() <= T::epsilon() * self.angles[bin + 1] {
                return next;
            }
            x = next;
        }
        x
    }
}

/// How far from 0 and π the ends of a table may lie and still mean them: files give π in few digits.
const END_TOLERANCE: f64 = 1e-6;

fn snap_ends<T: Real>(angles: &mut [T]) {
    let (last, near) = (angles.len() - 1, T::of(END_TOLERANCE));
    if angles[0] < near {
        angles[0] = T::zero();
    }
    if (angles[last] - T::PI()).abs() < near {
        angles[last] = T::PI();
    }
}

fn check<T: Real>(angles: &[T], values: &[T]) -> Result<(), AxialTableError> {
    if angles.len() < 2 || angles.len() != values.len() {
        return Err(AxialTableError::Shape { angles: angles.len(), values: values.len() });
    }
    let mut previous = -T::epsilon();
    for (index, &angle) in angles.iter().enumerate() {
        if !(angle > previous && angle <= T::PI() + T::of(END_TOLERANCE)) {
            return Err(AxialTableError::Angle { index, angle: angle.as_f64() });
        }
        previous = angle;
    }
    match values.iter().position(|v| !(v.is_finite() && *v >= T::zero())) {
        Some(index) => Err(AxialTableError::Value { index, value: values[index].as_f64() }),
        None => Ok(()),
    }
}

/// Weights of each horizontal angle in the mean over the circle; they sum to 1.
fn azimuth_weights<T: Real>(horizontal: &[T]) -> Vec<T> {
    let n = horizontal.len();
    let mut weights = vec![T::zero(); n];
    if n == 1 {
        weights[0] = T::one();
        return weights;
    }
    let half = T::of(0.5);
    let mut share = |i: usize, j: usize, width: T| {
        weights[i] += half * width;
        weights[j] += half * width;
    };
    (1..n).for_each(|i| share(i - 1, i, horizontal[i] - horizontal[i - 1]));
    let span = horizontal[n - 1] - horizontal[0];
    let is_part = [T::FRAC_PI_2(), T::PI()].iter().any(|&part| (span - part).abs() < T::of(1e-3));
    if !is_part {
        share(n - 1, 0, (T::TAU() - span).max(T::zero()));
    }
    let total = weights.iter().fold(T::zero(), |sum, &w| sum + w);
    weights.iter().map(|&w| w / total).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::compare::Worst;

    fn henyey_greenstein_table(g: f64, points: usize) -> AxialTable<f64> {
        let angles: Vec<f64> = (0..points).map(|i| std::f64::consts::PI * i as f64 / (points - 1) as f64).collect();
        let values = angles.iter().map(|a| crate::phase::henyey_greenstein(g, a.cos())).collect();
        AxialTable::new(angles, values).expect("a valid table")
    }

    #[test]
    fn flux_and_moments_converge_at_second_order_to_those_of_the_tabulated_function() {
        let (mut steps, mut errors) = (Vec::new(), Vec::new());
        for points in [91, 181, 361, 721] {
            let table = henyey_greenstein_table(0.5, points);
            steps.push((1.0 / points as f64).ln());
            let moment = table.legendre(4)[3] * 4.0 * std::f64::consts::PI / 7.0;
            errors.push(((table.flux() - 1.0).abs() + (moment - 0.125).abs()).ln());
        }
        let slope = testkit::statistics::slope(&steps, &errors);
        println!("convergence slope {slope:.3}, expected 2");
        assert!((slope - 2.0).abs() < 0.05);
    }

    #[test]
    fn sampling_inverts_the_cumulative() {
        let table = henyey_greenstein_table(0.9, 200);
        let rule = GaussLegendre::<f64>::cached(64);
        let mut worst = Worst::new("inverse of the cumulative", 1e-12);
        for i in 1..200 {
            let u = f64::from(i) / 200.0;
            let angle = table.sample(u);
            // Integrate the interpolant afresh, interval by interval.
            let mut below = 0.0;
            for pair in table.angles().windows(2) {
                let end = pair[1].min(angle);
                if end > pair[0] {
                    below += rule.integrate(pair[0], end, |a| table.eval(a) * a.sin() * std::f64::consts::TAU);
                }
            }
            worst.relative(below / table.flux(), u, || format!("u {u}"));
        }
        worst.check();
    }

    #[test]
    fn a_profile_is_averaged_over_the_circle_whatever_its_symmetry() {
        let vertical = [0.0, 0.8, std::f64::consts::FRAC_PI_2];
        let degrees = |list: &[f64]| list.iter().map(|d| d.to_radians()).collect::<Vec<_>>();
        let rows = |list: &[f64]| list.iter().flat_map(|&s| [1.0, s, 0.0]).collect::<Vec<_>>();
        // The same lamp (2 at 0 and 180 degrees, 1 at 90 and 270, linear between), as a full circle, open circle, half and quarter.
        for (horizontal, at) in [
            (vec![0.0, 90.0, 180.0, 270.0, 360.0], vec![2.0, 1.0, 2.0, 1.0, 2.0]),
            (vec![0.0, 90.0, 180.0, 270.0], vec![2.0, 1.0, 2.0, 1.0]),
            (vec![0.0, 90.0, 180.0], vec![2.0, 1.0, 2.0]),
            (vec![0.0, 90.0], vec![2.0, 1.0]),
        ] {
            let table = AxialTable::from_profile(&vertical, &degrees(&horizontal), &rows(&at)).expect("valid");
            assert!((table.values()[1] - 1.5).abs() < 1e-15, "{horizontal:?}: {:?}", table.values());
        }
    }

    #[test]
    fn bad_tables_are_refused_by_name() {
        let refuse = |angles: &[f64], values: &[f64]| AxialTable::new(angles.to_vec(), values.to_vec()).unwrap_err();
        assert!(matches!(refuse(&[0.0], &[1.0]), AxialTableError::Shape { .. }));
        assert!(matches!(refuse(&[0.0, 0.0], &[1.0, 1.0]), AxialTableError::Angle { index: 1, .. }));
        assert!(matches!(refuse(&[0.0, f64::NAN], &[1.0, 1.0]), AxialTableError::Angle { index: 1, .. }));
        assert!(matches!(refuse(&[0.0, 1.0], &[1.0, f64::INFINITY]), AxialTableError::Value { index: 1, .. }));
        assert!(matches!(refuse(&[0.0, 1.0], &[-1.0, 1.0]), AxialTableError::Value { index: 0, .. }));
        assert!(matches!(refuse(&[0.0, 1.0], &[0.0, 0.0]), AxialTableError::Dark));
    }
}
