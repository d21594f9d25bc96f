//! Inverting a growing optical length: Newton's iteration inside a bracket that never opens, with a fixed bound on steps.

use crate::Real;

/// A function that starts at 0 and never decreases, with its derivative.
pub struct Monotone<T, V, S> {
    /// The function; must accept `limit`.
    pub value: V,
    /// Its derivative, ≥ 0; need not be continuous.
    pub slope: S,
    /// Largest argument, may be infinite.
    pub limit: T,
}

/// Steps come in pairs of which at least one halves the bracket or the step: enough for the last bit of f64.
const STEPS: usize = 200;

/// The argument at which the function reaches `target`; infinite where it does not within the limit.
///
/// Newton on the value from the left, on its logarithm from the right (the density may grow exponentially); the middle
/// of the bracket where either leaves it or does not halve the step, as between empty and dense parts.
/// Stops when a step is below 2 ulp. *Cost*: 3 to 8 steps as a rule.
pub fn solve<T: Real, V: Fn(T) -> T, S: Fn(T) -> T>(function: Monotone<T, V, S>, target: T) -> T {
    let Monotone { value, slope, limit } = function;
    if target <= T::zero() {
        return T::zero();
    }
    let whole = value(limit);
    if whole < target || whole.is_nan() {
        return T::infinity();
    }
    let first = target / slope(T::zero());
    let (mut low, mut high) = bracket(&value, limit, target, first);
    let mut at = if first > low && first < high { first } else { middle(low, high) };
    let mut last_step = T::infinity();
    for _ in 0..STEPS {
        let reached = value(at);
        if reached < target {
            low = at
        } else {
            high = at
        }
        let step = newton_step(reached, slope(at), target);
        if step.abs() <= T::of(2.0) * T::epsilon() * at || high - low <= T::epsilon() * high {
            return (at + step).max(low).min(high);
        }
        let newton = at + step;
        let shrinks = step.abs() <= T::of(0.5) * last_step;
        let next = if newton > low && newton < high && shrinks { newton } else { middle(low, high) };
        last_step = (next - at).abs();
        at = next;
    }
    at
}

fn newton_step<T: Real>(reached: T, slope: T, target: T) -> T {
    if reached < target {
        (target - reached) / slope
    } else {
        -((reached - target) / target).ln_1p() * (reached / slope)
    }
}

/// A bracket with finite ends: grows by powers of 16 from the first guess where the limit is infinite.
fn bracket<T: Real>(value: &impl Fn(T) -> T, limit: T, target: T, first: T) -> (T, T) {
    if limit < T::infinity() {
        return (T::zero(), limit);
    }
    let usable = first > T::zero() && first < T::max_value();
    let (mut low, mut high) = (T::zero(), if usable { first } else { T::one() });
    while high < T::infinity() && value(high) < target {
        low = high;
        high *= T::of(16.0);
    }
    (low, high.min(T::max_value()))
}

/// Geometric middle of wide brackets (they span decades), arithmetic of narrow ones.
fn middle<T: Real>(low: T, high: T) -> T {
    if low > T::zero() && high > T::of(4.0) * low {
        low.sqrt() * high.sqrt()
    } else if low == T::zero() && high > T::zero() {
        high * T::of(1.0 / 16.0)
    } else {
        low + (high - low) * T::of(0.5)
    }
}
