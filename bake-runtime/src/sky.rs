//! The environment behind all surfaces, and how a stated distance of air dims and blurs it (Sun et al. 2005, section 6).
//!
//! *Equation*: L'(ω) = e^{−T} L(ω) + (σ_s/σ_t) Σ_lm f_l(T) c_lm Y_lm(ω), with c_lm the harmonics of L and f_l the zonal factors of the
//! point-spread function of isotropic air ([`bake_optics::psf`]), cut at [`BANDS`] by Lanczos' window so that a bright sun does not ring.

use bake_optics::harmonics::{Window, real_sh, real_sh_into};
use bake_optics::medium::Medium;
use bake_optics::psf::convolution_factors;

/// Bands of the glow's harmonics: a blur of some 15°.
const BANDS: usize = 12;

/// Texels of the glow across and down: five a wave of the highest band.
pub(crate) const GLOW: [u32; 2] = [64, 32];

/// An environment's picture: latitude-longitude, column 0 begins at −Z and turns towards +X, row 0 is +Y.
#[derive(Debug, Clone, PartialEq)]
pub struct SkyPicture {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Radiance, cd/m².
    pub radiance: Vec<[f32; 3]>,
    /// Turn about +Y, radians.
    pub rotation: f32,
}

/// Direction of a place on a latitude-longitude picture, shares of its width and height.
fn direction(across: f64, down: f64, rotation: f64) -> [f64; 3] {
    let (azimuth, polar) = (std::f64::consts::TAU * across + rotation, std::f64::consts::PI * down);
    [polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()]
}

/// Harmonics of a picture, `BANDS`² of them.
pub(crate) fn harmonics(sky: &SkyPicture) -> Vec<[f64; 3]> {
    let mut sum = vec![[0.0; 3]; BANDS * BANDS];
    let mut basis = vec![0.0; BANDS * BANDS];
    for y in 0..sky.height {
        let edge = |row: u32| (std::f64::consts::PI * f64::from(row) / f64::from(sky.height)).cos();
        let solid_angle = std::f64::consts::TAU / f64::from(sky.width) * (edge(y) - edge(y + 1));
        for x in 0..sky.width {
            let place = [(f64::from(x) + 0.5) / f64::from(sky.width), (f64::from(y) + 0.5) / f64::from(sky.height)];
            real_sh_into(direction(place[0], place[1], sky.rotation.into()), BANDS, &mut basis);
            let texel = sky.radiance[(y * sky.width + x) as usize];
            for (sum, value) in sum.iter_mut().zip(&basis) {
                (0..3).for_each(|c| sum[c] += solid_angle * value * f64::from(texel[c]));
            }
        }
    }
    sum
}

/// Optical thickness of a distance of air without end, and its albedo, a channel each.
fn thickness(media: &[Medium], distance_m: u32) -> [(f64, f64); 3] {
    std::array::from_fn(|c| {
        let sigma_s: f64 = media.iter().map(|medium| medium.scatter.sigma_s[c]).sum();
        let sigma_t: f64 = media.iter().map(|medium| medium.scatter.sigma_t()[c]).sum();
        let t = (sigma_t * f64::from(distance_m)).min(80.0);
        (t, if t > 1e-9 { sigma_s / sigma_t } else { 0.0 })
    })
}

/// What is left of the light itself.
pub(crate) fn attenuation(media: &[Medium], distance_m: u32) -> [f32; 3] {
    thickness(media, distance_m).map(|(t, _)| (-t).exp() as f32)
}

/// σ_s/σ_t f_l, windowed, a channel each.
fn factors(media: &[Medium], distance_m: u32, bands: usize) -> [Vec<f64>; 3] {
    thickness(media, distance_m).map(|(t, albedo)| {
        let factors = if t > 1e-9 { convolution_factors(t, bands) } else { vec![0.0; bands] };
        let windowed = |(l, factor): (usize, f64)| factor * albedo * Window::<f64>::Lanczos.factor(l, bands);
        factors.into_iter().enumerate().map(windowed).collect()
    })
}

/// A uniform sky through the air.
pub(crate) fn uniform(radiance: [f32; 3], media: &[Medium], distance_m: u32) -> [f32; 3] {
    let (left, glow) = (attenuation(media, distance_m), factors(media, distance_m, 1));
    std::array::from_fn(|c| radiance[c] * (left[c] + glow[c][0] as f32))
}

/// The glow as a picture of [`GLOW`] texels in world axes.
pub(crate) fn glow(harmonics: &[[f64; 3]], media: &[Medium], distance_m: u32) -> Vec<[f32; 4]> {
    let factors = factors(media, distance_m, BANDS);
    let [width, height] = GLOW;
    let texel = |at: u32| {
        let (across, down) = (f64::from(at % width) + 0.5, f64::from(at / width) + 0.5);
        let basis = real_sh(direction(across / f64::from(width), down / f64::from(height), 0.0), BANDS);
        let channel = |c: usize| -> f64 {
            let terms = basis.iter().zip(harmonics).enumerate();
            terms.map(|(k, (value, light))| value * light[c] * factors[c][k.isqrt()]).sum()
        };
        let [r, g, b] = [0, 1, 2].map(|c| channel(c).max(0.0) as f32);
        [r, g, b, 1.0]
    };
    (0..width * height).map(texel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, Density, Scatter};
    use bake_optics::phase::Phase;
    use testkit::compare::Worst;

    fn air() -> Vec<Medium> {
        let scatter = Scatter { sigma_s: [0.02, 0.01, 0.0], sigma_a: [0.0, 0.01, 0.02] };
        vec![Medium { bounds: Bounds::Unbounded, density: Density::Uniform, scatter, phase: Phase::Isotropic }]
    }

    #[test]
    fn an_even_picture_glows_as_a_uniform_sky() {
        let sky = SkyPicture { width: 64, height: 32, radiance: vec![[5.0, 3.0, 2.0]; 2048], rotation: 0.7 };
        let (left, glow) = (attenuation(&air(), 50), glow(&harmonics(&sky), &air(), 50));
        let want = uniform([5.0, 3.0, 2.0], &air(), 50);
        for texel in glow {
            // 32 rows leave something of the higher bands.
            (0..3).for_each(|c| {
                let got = [5.0, 3.0, 2.0][c] * left[c] + texel[c];
                assert!((got / want[c] - 1.0).abs() < 0.02, "channel {c}: {got}, not {}", want[c]);
            });
        }
    }

    #[test]
    fn one_bright_texel_glows_as_the_point_spread_function_says() {
        // Column 12 of 32 begins 3/8 of a turn from −Z towards +X.
        let mut radiance = vec![[0.0f32; 3]; 512];
        radiance[8 * 32 + 12] = [1e4; 3];
        let sky = SkyPicture { width: 32, height: 16, radiance, rotation: 0.0 };
        let glow = glow(&harmonics(&sky), &air(), 50);
        let towards = glam::DVec3::from(direction(12.5 / 32.0, 8.5 / 16.0, 0.0));
        let edge = |row: f64| (std::f64::consts::PI * row / 16.0).cos();
        let irradiance = 1e4 * std::f64::consts::TAU / 32.0 * (edge(8.0) - edge(9.0));
        let mut worst = Worst::new("glow 0.5 to 1.5 rad off a bright texel", 0.15);
        let mut other = Worst::new("glow of another thickness (negative control)", 0.15);
        let brightest = (0..glow.len()).max_by(|&a, &b| glow[a][0].total_cmp(&glow[b][0])).expect("texels");
        for (at, texel) in glow.iter().enumerate() {
            let place = [(at % 64) as f64 + 0.5, (at / 64) as f64 + 0.5];
            let gamma = glam::DVec3::from(direction(place[0] / 64.0, place[1] / 32.0, 0.0)).angle_between(towards);
            assert!(at != brightest || gamma < 0.15, "the brightest is {gamma} rad off");
            // Beyond the blur of the cut bands; what they ring is left.
            if (0.5..1.5).contains(&gamma) {
                let of = |t: f64| irradiance * bake_optics::psf::psf(gamma, t);
                worst.relative(texel[0].into(), of(1.0), || format!("{gamma} rad"));
                other.relative(texel[0].into(), of(1.5), || format!("{gamma} rad"));
            }
        }
        worst.check();
        assert!(!other.holds());
    }
}
