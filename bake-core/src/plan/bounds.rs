//! How much each effect can change the light on the lightmapped surface: limits known before any light is solved.
//!
//! *Quantity.* Mean over the lightmapped surface of |E − E'| over the median texel irradiance; E with the effect, E'
//! without, all else simulated. Single texels may change by more: beside a lamp, in a shadow.
//!
//! *Setting.* Light flies in legs that end at a surface or a collision. Of a leg's flux at most `p = 1 − exp(−τ)`
//! collides, at most `p_s = 1 − exp(−τ_s)` is scattered; τ, τ_s are the largest extinction and scattering depth of
//! any line through the air (longest line of each medium times its largest density times its coefficient). Surfaces send
//! at most the share ρ of what arrives on to another leg. So no more than
//!
//! ```text
//! κ = p_s + (1 − p_s) ρ,     1 − κ = (1 − ρ) exp(−τ_s)
//! ```
//! of a leg's flux flies a further leg, and all legs together carry at most Φ/(1 − κ) of an emitted flux Φ (geometric
//! series over reflections and orders of scattering).
//!
//! *Lemma.* Let two airs differ, leg by leg, by at most δ_o of its flux in what arrives at surfaces and by at most δ_s in
//! what leaves collisions (L1 norms over position and direction). With `G` from legs to further legs, `O` from legs to
//! surfaces, `W = Φ + G W` and `F = O W`: `F − F' = (O − O') W + O' (1 − G')⁻¹ (G − G') W`, where |O'| ≤ 1,
//! |G − G'| ≤ ρ δ_o + δ_s and both |G| ≤ κ, so that for κ ≥ ρ
//!
//! ```text
//! ∫ |E − E'| dA ≤ (δ_o + δ_s) Φ / (1 − κ)²
//! ```
//! Divided by the lightmapped area and the median irradiance that is the bound. Where κ = 1 there is none.
//!
//! | effect | δ_o + δ_s |
//! |---|---|
//! | attenuation (all that the air does) | p + p_s |
//! | absorption | 1 − exp(−τ_a): what arrives or scatters more without it |
//! | scattering | p_s |
//! | multiple | p_s²: legs from collisions carry at most p_s of all, and lose at most p_s |
//! | anisotropy | p_s a, with `a = ∫ \|Φ − 1/4π\| dω ≤ √(Σ_{l ≥ 1} (2l + 1) m_l²)` over Legendre moments (Cauchy–Schwarz), at most 2 |
//! | heterogeneity, colour | Δ + Δ_s + Δ exp(Δ), with Δ, Δ_s the largest depth of the differences of extinction and scattering: \|exp(−τ) − exp(−τ')\| ≤ Δ |
//! | indirect | ρ |
//!
//! An emitter of flux Φ_e contributes at most Φ_e/(1 − κ), and p_s times that through its first scattering.
//!
//! *Taken on trust.* ρ averages a texture over its image, as if light did not seek its bright texels out.

use super::budget::Budget;
use crate::air::Air;
use crate::air::limits::{Limits, depth};
use bake_optics::medium::{Density, Medium};
use bake_optics::phase::Phase;

/// Largest share of a leg's flux that each effect changes, and what the scene makes of it.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    budget: Budget,
    /// 1 − κ.
    ending: f64,
    /// p_s.
    scattered: f64,
    /// p.
    collided: f64,
}

impl Bounds {
    /// For a scene and its air.
    pub fn new(budget: Budget, air: &Air) -> Self {
        let scattering = most(depth(air, |m, limits| at_peak(m.scatter.sigma_s, limits)));
        let extinction = most(depth(air, |m, limits| at_peak(m.scatter.sigma_t(), limits)));
        let ending = (1.0 - budget.albedo) * (-scattering).exp();
        Self { budget, ending, scattered: share(scattering), collided: share(extinction) }
    }

    /// Of a change of `delta` a leg.
    fn of(&self, delta: f64) -> f64 {
        let level = self.budget.level(self.budget.emitted.total());
        if delta == 0.0 || level == 0.0 { 0.0 } else { delta * level / (self.ending * self.ending) }
    }

    /// Of light that starts with a flux, lm.
    pub fn emitter(&self, flux: f64) -> f64 {
        let level = self.budget.level(flux);
        if level == 0.0 { 0.0 } else { level / self.ending }
    }

    /// Of the same through its first collision.
    pub fn scattered_emitter(&self, flux: f64) -> f64 {
        if self.scattered == 0.0 { 0.0 } else { self.scattered * self.emitter(flux) }
    }

    /// Of reflected light through its first collision.
    pub fn scattered_reflections(&self) -> f64 {
        self.of(self.scattered * self.budget.albedo)
    }

    /// Of all that the air does.
    pub fn attenuation(&self) -> f64 {
        self.of(self.collided + self.scattered)
    }

    /// Of what the air swallows.
    pub fn absorption(&self, air: &Air) -> f64 {
        self.of(share(most(depth(air, |m, limits| at_peak(m.scatter.sigma_a, limits)))))
    }

    /// Of all orders of scattering.
    pub fn scattering(&self) -> f64 {
        self.of(self.scattered)
    }

    /// Of orders from the second on.
    pub fn multiple(&self) -> f64 {
        self.of(self.scattered * self.scattered)
    }

    /// Of preferred deflections.
    pub fn anisotropy(&self, air: &Air) -> f64 {
        let scattering = air.media.media.iter().filter(|medium| medium.scatter.sigma_s != [0.0; 3]);
        self.of(self.scattered * scattering.map(|medium| distance_to_isotropic(&medium.phase)).fold(0.0, f64::max))
    }

    /// Of a density that varies, against the middle between its ends.
    pub fn heterogeneity(&self, air: &Air) -> f64 {
        let spread = |sigma: [f64; 3], medium: &Medium, limits: &Limits| match medium.density {
            Density::Uniform => [0.0; 3],
            _ => sigma.map(|s| if s > 0.0 { 0.5 * s * (limits.density[1] - limits.density[0]) } else { 0.0 }),
        };
        self.of_depths(
            most(depth(air, |m, limits| spread(m.scatter.sigma_t(), m, limits))),
            most(depth(air, |m, limits| spread(m.scatter.sigma_s, m, limits))),
        )
    }

    /// Of coefficients that differ by channel, against their mean.
    pub fn colour(&self, air: &Air) -> f64 {
        let spread = |sigma: [f64; 3], limits: &Limits| {
            let mean = sigma.iter().sum::<f64>() / 3.0;
            at_peak(if sigma == [sigma[0]; 3] { [0.0; 3] } else { sigma.map(|s| (s - mean).abs()) }, limits)
        };
        let of = |medium: &Medium, limits: &Limits| {
            // What is scattered and what is absorbed each go to their own mean.
            let [s, a] = [medium.scatter.sigma_s, medium.scatter.sigma_a].map(|sigma| spread(sigma, limits));
            std::array::from_fn(|c| s[c] + a[c])
        };
        self.of_depths(most(depth(air, of)), most(depth(air, |m, limits| spread(m.scatter.sigma_s, limits))))
    }

    fn of_depths(&self, extinction: f64, scattering: f64) -> f64 {
        if extinction == 0.0 { 0.0 } else { self.of(extinction * (1.0 + extinction.exp()) + scattering) }
    }

    /// Of light that surfaces reflect.
    pub fn indirect(&self) -> f64 {
        self.of(self.budget.albedo)
    }
}

fn at_peak(sigma: [f64; 3], limits: &Limits) -> [f64; 3] {
    sigma.map(|sigma| if sigma > 0.0 { sigma * limits.density[1] } else { 0.0 })
}

fn most(depths: [f64; 3]) -> f64 {
    depths.into_iter().fold(0.0, f64::max)
}

/// 1 − exp(−τ).
fn share(depth: f64) -> f64 {
    -(-depth).exp_m1()
}

/// Upper limit of `∫ |Φ − 1/4π| dω`: `√(Σ_{l ≥ 1} (2l + 1) m_l²)` in closed form where there is one, and at most 2.
fn distance_to_isotropic(phase: &Phase<f64>) -> f64 {
    let square = match phase {
        Phase::Isotropic => 0.0,
        Phase::Linear { a1 } => a1 * a1 / 3.0,
        Phase::Rayleigh => 0.05,
        // Σ (2l + 1) g^{2l} = (1 + g²)/(1 − g²)².
        Phase::HenyeyGreenstein { g } => (1.0 + g * g) / (1.0 - g * g).powi(2) - 1.0,
        Phase::Legendre(a) => a.iter().enumerate().skip(1).map(|(l, a)| a * a / (2 * l + 1) as f64).sum(),
        Phase::Table(_) => 4.0,
    };
    square.sqrt().min(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};
    use testkit::compare::Worst;

    /// The closed forms against the integral, on 200,000 bands of the sphere: never below it.
    #[test]
    fn moments_bound_the_distance_to_isotropic() {
        let phases = [
            Phase::Isotropic,
            Phase::Linear { a1: -0.8 },
            Phase::Rayleigh,
            Phase::HenyeyGreenstein { g: 0.01 },
            Phase::HenyeyGreenstein { g: -0.5 },
            Phase::HenyeyGreenstein { g: 0.9 },
            Phase::Legendre(vec![1.0, 0.3, 0.2]),
        ];
        let mut worst = Worst::new("integral beyond its bound", 1e-6);
        for phase in phases {
            let count = 200_000;
            let width = 2.0 / f64::from(count);
            let band = |i: i32| (phase.eval(-1.0 + (f64::from(i) + 0.5) * width) - 0.25 / PI).abs() * TAU * width;
            let exact: f64 = (0..count).map(band).sum();
            let bound = distance_to_isotropic(&phase);
            worst.record((exact - bound).max(0.0), || format!("{phase:?}: {exact}, bound {bound}"));
            assert!(exact >= 0.4 * bound.min(1.9), "{phase:?}: {bound} says too little of {exact}");
        }
        worst.check();
    }
}
