//! The two number types of the crate behind one trait, so that each formula is written once.

use std::fmt::{Debug, Display};
use std::sync::OnceLock;

use num_traits::{Float, FloatConst, NumAssign};

use crate::quadrature::{CACHED_NODES, GaussLegendre};

/// A real number: `f64` (oracle) or `f32` (fast form).
pub trait Real: Float + FloatConst + NumAssign + Debug + Display + Default + Send + Sync + 'static {
    /// The nearest value to `x`; for constants and counts.
    fn of(x: f64) -> Self;

    /// The value as `f64`, exactly.
    fn as_f64(self) -> f64;

    /// One value of this type per precision: `pick(f32 form, f64 form)`.
    fn pick<V>(single: V, double: V) -> V;

    /// Where cached Gauss–Legendre rules of this type live.
    #[doc(hidden)]
    fn gauss_legendre_cache() -> &'static [OnceLock<GaussLegendre<Self>>; CACHED_NODES + 1];
}

macro_rules! real {
    ($t:ty, $single:ident, $double:ident => $chosen:ident) => {
        impl Real for $t {
            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $t
            }

            #[inline(always)]
            fn as_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn pick<V>($single: V, $double: V) -> V {
                $chosen
            }

            fn gauss_legendre_cache() -> &'static [OnceLock<GaussLegendre<Self>>; CACHED_NODES + 1] {
                static CACHE: [OnceLock<GaussLegendre<$t>>; CACHED_NODES + 1] =
                    [const { OnceLock::new() }; CACHED_NODES + 1];
                &CACHE
            }
        }
    };
}

real!(f32, single, _double => single);
real!(f64, _single, double => double);
