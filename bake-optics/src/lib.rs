//! Formulas of light in air: special functions, phase functions, media, air-light, harmonics. No I/O, threads or logging.
//!
//! Every formula is one generic source over [`Real`]: `f64` is the oracle, `f32` what bakes and shaders use.
//!
//! # Which function gives which quantity
//!
//! All take plain numbers. Accuracy is the largest relative error that the tests allow; "—": not offered in f32, where
//! it has no digits left or serves as reference only. Exponentials of rounded optical lengths T add T ulp; rounded heights and inverses of
//! optical depth add their condition.
//!
//! | quantity | function | f64 | f32 |
//! | --- | --- | --- | --- |
//! | e^z E_p(z), Re z ≥ 0 | [`special::scaled_exponential_integral`] | 2e-14 | 2e-6 |
//! | E_1(z) | [`special::e1`] | 2e-14 | 7e-6 |
//! | erfcx(x) | [`special::erfcx`] | 4e-15 | 2e-7 |
//! | (e^x − 1)/x, ln(1 + x)/x | [`special::phi1`], [`special::lam`] | 4e-16 | 4e-7 |
//! | Chapman C, ln C | [`special::chapman`], [`special::ln_chapman`] | 8e-15 | 1e-6 |
//! | Chapman for planets, z ≥ 100 | [`special::chapman_large_z`] | 0.4/z² | 4e-5 |
//! | opacity, transmittance of τ | [`medium::transmittance`] | 1e-15 | 2e-7 |
//! | τ and free path, uniform | [`medium::uniform`] | 1e-15 | 3e-7 |
//! | τ and free path, linear in height (start density `a h + k`, rate `a cos θ`) | [`medium::linear`] | 2e-15 | 1e-6 |
//! | τ and free path, exponential in height | [`medium::exponential`] | 4e-15 | 1e-6 |
//! | τ and free path, exponential around a planet | [`medium::planet`] | 1e-14 | 3e-6 |
//! | phase functions, moments, draws | [`phase::Phase`] | 1e-11 | 1e-6 |
//! | F(u, v), F_k(u, v) by angle | [`airlight::sun::f`], [`airlight::sun::f_k`] | 2e-14 | — |
//! | F(u, atan t2) − F(u, atan t1), the same of F_k | [`airlight::sun::f_difference`], [`airlight::sun::f_k_difference`] | 1e-13 | 1e-6 |
//! | isotropic air-light L(γ, T_sv, T_vp, β) | [`airlight::sun::airlight`] | 2e-13 (rays that graze the lamp 1e-10) | 1e-5 |
//! | G_n(T, θ), G_0 being n = 1 | [`surface::g`] | 2e-14 | 4e-6 |
//! | PSF, NPSF | [`psf::psf`], [`psf::npsf`] | 2e-13 | 2e-6 |
//! | air-light, any phase and lamp, 24 nodes a side | [`airlight::Quadrature`] on a [`airlight::Sight`] | `docs/airlight.md`; 48 nodes 1e-14, hard 1e-9 | 1e-5; 16 nodes 3e-5; order-10 lobes 5e-4 |
//! | the same, 8 or 16 rays at once | [`airlight::wide::radiance`] | — | 1e-5; 32 nodes, HG 0.9: 5e-5 |
//! | the same in closed form | [`airlight::ClosedForm`] | 1e-11, degree 10 1e-7 | 3e-5, isotropic lamp, degree ≤ 2 |
//! | truth for both | [`airlight::Oracle`] | 1e-14, hard 2e-11 | — |
//! | ∫ ds/((s + b)² + h²) | [`airlight::macklin::inverse_square_integral`] | 1e-15 | 1e-6 |
//! | moments M_0 … M_4 near vacuum | [`airlight::macklin::extinction_moments`] | 1e-14 | 1e-6 |
//! | ∫ e^{−Hv} v^n/(v² + 1)^m dv | [`airlight::pegoraro::definite`] | 5e-13 | — |
//! | its printed antiderivative, eq. 29 | [`airlight::pegoraro::eq29`] | 1e-10 for H ≤ 2, m ≤ 3; none beyond | — |

pub mod airlight;
pub mod axial_table;
pub mod emitter;
pub mod harmonics;
pub mod legendre;
pub mod medium;
pub mod phase;
pub mod psf;
pub mod quadrature;
pub mod real;
pub mod special;
pub mod surface;

pub use real::Real;
