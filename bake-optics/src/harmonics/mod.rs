//! Spherical and zonal harmonics: real, orthonormal, without Condon–Shortley sign, index l(l+1)+m, up to [`MAX_BANDS`] bands.
//!
//! l = 1 is y, z, x times +0.488603. `bands` N means l = 0 … N−1. A zonal function about a unit axis a is
//! `f(ω) = Σ_l z_l y_l(a·ω)` with `y_l(c) = sqrt((2l+1)/(4π)) P_l(c)`; only its N coefficients z_l are kept.

mod factors;
mod real_sh;
mod window;
mod zonal;

pub use factors::zonal_norm;
pub use real_sh::{project, real_sh, real_sh_into, sh_index, sh_sum};
pub use window::Window;
pub use zonal::{
    clamped_cosine, irradiance, phong, power_cosine, y_zonal, y_zonal_all, zonal_convolve, zonal_dot, zonal_eval,
    zonal_from_legendre, zonal_power_cosine, zonal_to_sh,
};

/// Most bands the crate's callers use; nothing here breaks above it, accuracy is measured up to it.
pub const MAX_BANDS: usize = 16;
