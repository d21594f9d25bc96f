//! The media against 50-digit reference values: f64 against the files, f32 against f64 at the same (rounded) inputs.

use bake_optics::Real;
use bake_optics::medium::exponential::{self, Climb};
use bake_optics::medium::planet::{self, Orbit};
use bake_optics::medium::{linear, transmittance, uniform};
use testkit::compare::{Worst, relative_error};
use testkit::reference::{Row, read_csv};

fn rows(name: &str) -> Vec<Row> {
    read_csv(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name))
}

/// Optical length of a row's ray and its inverse, computed in T and returned as f64.
trait Kernel {
    fn forward<T: Real>(&self, row: &Row) -> f64;
    fn inverse<T: Real>(&self, row: &Row, depth: f64) -> f64;
    /// du/u per dτ/τ: what rounding of the depth costs.
    fn condition(&self, row: &Row) -> f64;
}

fn of<T: Real>(row: &Row, column: &str) -> T {
    T::of(row.number(column))
}

struct Uniform;
impl Kernel for Uniform {
    fn forward<T: Real>(&self, row: &Row) -> f64 {
        uniform::optical_length::<T>(of(row, "att"), of(row, "u")).as_f64()
    }
    fn inverse<T: Real>(&self, row: &Row, depth: f64) -> f64 {
        uniform::free_path::<T>(of(row, "att"), T::of(depth)).as_f64()
    }
    fn condition(&self, _: &Row) -> f64 {
        1.0
    }
}

struct Linear;
impl Linear {
    fn start<T: Real>(row: &Row) -> (T, T) {
        let (a, k): (T, T) = (of(row, "a"), of(row, "k"));
        (a * of(row, "height") + k, a * of(row, "cos_theta"))
    }
}
impl Kernel for Linear {
    fn forward<T: Real>(&self, row: &Row) -> f64 {
        let (start, rate) = Self::start::<T>(row);
        (of::<T>(row, "sigma") * linear::optical_length(start, rate, of(row, "u"))).as_f64()
    }
    fn inverse<T: Real>(&self, row: &Row, depth: f64) -> f64 {
        let (start, rate) = Self::start::<T>(row);
        linear::free_path(start, rate, T::of(depth) / of(row, "sigma")).as_f64()
    }
    fn condition(&self, row: &Row) -> f64 {
        let (start, rate) = Self::start::<f64>(row);
        let u = row.number("u_of_tau_in");
        let density = (start + rate * u).max(0.0);
        (row.number("tau_in") / (row.number("sigma") * density * u)).max(1.0)
    }
}

struct Exponential;
impl Exponential {
    fn climb<T: Real>(row: &Row) -> Climb<T> {
        Climb { height: of(row, "height"), cos_theta: of(row, "cos_theta") }
    }
}
impl Kernel for Exponential {
    fn forward<T: Real>(&self, row: &Row) -> f64 {
        let length = exponential::optical_length(of::<T>(row, "n"), Self::climb(row), of(row, "u"));
        (of::<T>(row, "att_sea_level") * length).as_f64()
    }
    fn inverse<T: Real>(&self, row: &Row, depth: f64) -> f64 {
        let target = T::of(depth) / of(row, "att_sea_level");
        exponential::free_path(of::<T>(row, "n"), Self::climb(row), target).as_f64()
    }
    fn condition(&self, row: &Row) -> f64 {
        let (n, u) = (row.number("n"), row.number("u_of_tau_in"));
        let density = (-n * (row.number("height") + u * row.number("cos_theta"))).exp();
        let height = 1.0 + (n * row.number("height")).abs();
        (height * row.number("tau_in") / (row.number("att_sea_level") * density * u)).max(1.0)
    }
}

struct Planet;
impl Planet {
    fn orbit<T: Real>(row: &Row) -> Orbit<T> {
        let altitude = T::of(row.number("r") - row.number("R"));
        Orbit { radius: of(row, "r"), altitude, cos_theta: of(row, "cos_theta") }
    }
}
impl Kernel for Planet {
    fn forward<T: Real>(&self, row: &Row) -> f64 {
        (of::<T>(row, "att_sea_level") * planet::optical_length(of(row, "n"), Self::orbit(row), of(row, "u"))).as_f64()
    }
    fn inverse<T: Real>(&self, row: &Row, depth: f64) -> f64 {
        let target = T::of(depth) / of(row, "att_sea_level");
        planet::free_path(of(row, "n"), Self::orbit(row), target, T::infinity()).as_f64()
    }
    fn condition(&self, row: &Row) -> f64 {
        row.number("inverse_condition").max(1.0)
    }
}

struct Limits {
    /// Relative error of the optical depth.
    forward: f64,
    /// Relative error of the distance per unit of condition number.
    inverse: f64,
    forward_single: f64,
    inverse_single: f64,
}

fn check(name: &str, tau: &str, kernel: &impl Kernel, limits: Limits) {
    let mut forward = Worst::new(format!("{name} f64 depth"), limits.forward);
    let mut inverse = Worst::new(format!("{name} f64 distance / condition"), limits.inverse);
    let mut forward_single = Worst::new(format!("{name} f32 depth"), limits.forward_single);
    let mut inverse_single = Worst::new(format!("{name} f32 distance / condition"), limits.inverse_single);
    let rows = rows(name);
    for row in &rows {
        let place = || format!("{:?}", row);
        let double = kernel.forward::<f64>(row);
        forward.relative(double, row.number(tau), place);
        // Comparing within f32's range only; inputs rounded to f32 move the result by their own condition.
        if double < 1e30 && double > 1e-30 {
            forward_single.relative(kernel.forward::<f32>(row), double, place);
        }
        let (depth, want) = (row.number("tau_in"), row.number("u_of_tau_in"));
        let condition = kernel.condition(row);
        if want.is_infinite() {
            assert_eq!(kernel.inverse::<f64>(row, depth * (1.0 + 1e-12)), f64::INFINITY, "{row:?}");
        } else if condition < 1e8 {
            inverse.record(relative_error(kernel.inverse::<f64>(row, depth), want) / condition, place);
            if condition < 1e3 && depth > 1e-30 && depth < 1e30 {
                inverse_single.record(relative_error(kernel.inverse::<f32>(row, depth), want) / condition, place);
            }
        }
    }
    [forward, inverse, forward_single, inverse_single].iter().for_each(Worst::check);
}

// Limits are small multiples of the accuracies published with the data (f64: linear 6e-16, exponential 4e-15, the
// rest 1e-12) and of a few f32 ulp (6e-8) times the condition of the row's inputs.

#[test]
fn uniform_medium() {
    check(
        "medium_constant.csv",
        "tau",
        &Uniform,
        Limits { forward: 1e-15, inverse: 1e-15, forward_single: 3e-7, inverse_single: 3e-7 },
    );
    for row in rows("medium_constant.csv") {
        let tau = row.number("tau_in");
        assert!(relative_error(transmittance::opacity(tau), row.number("opacity")) < 1e-15, "{row:?}");
        assert!(relative_error(transmittance::transmittance(tau), row.number("transmittance")) < 1e-15, "{row:?}");
        assert!(relative_error(transmittance::opacity(tau as f32).into(), row.number("opacity")) < 2e-7, "{row:?}");
    }
}

#[test]
fn linear_medium() {
    check(
        "medium_linear.csv",
        "tau_clamped",
        &Linear,
        Limits { forward: 2e-15, inverse: 2e-15, forward_single: 1e-6, inverse_single: 1e-6 },
    );
}

#[test]
fn exponential_medium() {
    check(
        "medium_rectexp.csv",
        "tau",
        &Exponential,
        Limits { forward: 4e-15, inverse: 2e-15, forward_single: 1e-6, inverse_single: 1e-6 },
    );
}

#[test]
fn planet_medium() {
    check(
        "medium_sphere.csv",
        "tau",
        &Planet,
        Limits { forward: 1e-14, inverse: 16.0 * f64::EPSILON, forward_single: 3e-6, inverse_single: 3e-6 },
    );
}
