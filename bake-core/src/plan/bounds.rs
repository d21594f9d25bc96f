//! How much each effect can change the light on the lightmapped surface: limits known before any light is solved.
//!
//! *Quantity.* Mean over the lightmapped surface of |E − E'| over the median texel irradiance; E with the effect, E'
//! without, all else simulated. Single texels may change by more: beside a lamp, in a shadow.
//!
//! *Setting.* A flight goes from a surface or an emitter to the next surface, through any number of collisions; its legs
//! are straight. Of a leg's flux at most `p = 1 − exp(−τ)` collides and at most `p_s = 1 − exp(−τ_s)` is scattered; τ, τ_s are
//! the largest extinction and scattering depth of any line through the air (longest line of each medium times its largest
//! density times its coefficient). A flight has at most `n = Σ p_s^k = exp(τ_s)` legs on the mean, n − 1 of them from
//! collisions. Surfaces send at most the share ρ of what arrives on another flight, so that all flights together carry at
//! most Φ/(1 − ρ) of an emitted flux Φ.
//!
//! *Lemma.* Let what arrives by a flight differ between two airs by at most δ of the flux that starts (L1 norm over positions
//! and directions). With `R` for reflection, `O` for arrival and `F = O (Φ + R F)`, `F − F' = (O − O')(Φ + R F) + O' R (F − F')`,
//! where |O'| ≤ 1, |R| ≤ ρ and |Φ + R F| ≤ Φ/(1 − ρ); hence
//!
//! ```text
//! ∫ |E − E'| dA ≤ δ Φ / (1 − ρ)²
//! ```
//! Divided by the lightmapped area and the median irradiance that is the bound. Where ρ = 1 there is none.
//!
//! | effect | δ | because |
//! |---|---|---|
//! | attenuation (all that the air does) | p + p_s | first legs lose at most p, and at most p_s arrives otherwise |
//! | absorption | n p_a, at most 1 | a leg loses at most p_a = 1 − exp(−τ_a) |
//! | scattering | p_s | what arrives has scattered at its first leg |
//! | multiple | p_s² | the same at its second |
//! | own-plane term | 2 ρ p_s | at most p_s of what surfaces send scatters onto their own plane; without the term it arrives elsewhere |
//! | anisotropy | (n − 1) a, at most 2 p_s | a collision spreads apart at most `a = ∫ \|φ − 1/4π\| dω ≤ √(Σ_{l ≥ 1} (2l + 1) m_l²)` (Cauchy–Schwarz over Legendre moments), at most 2 |
//! | heterogeneity, colour | n (Δ + Δ_s + Δ exp(Δ)), at most 2 | Δ, Δ_s are the largest depths of the differences of extinction and scattering: \|exp(−τ) − exp(−τ')\| ≤ Δ at a leg's end, `∫ \|σ_s exp(−τ) − σ_s' exp(−τ')\| ds ≤ Δ_s + Δ exp(Δ)` on its way |
//!
//! An emitter of flux Φ_e contributes at most Φ_e/(1 − ρ), and p_s times that through its first flight's scattering; all
//! reflections together at most Φ ρ/(1 − ρ).
//!
//! *Taken on trust.* ρ averages a texture over its image, as if light did not seek its bright texels out.

use super::budget::Budget;
use crate::air::Air;
use crate::air::limits::{Limits, depth};
use bake_optics::medium::{Density, Medium, Scatter};
use bake_optics::phase::Phase;

/// What bounds are made of.
#[derive(Debug, Clone, Copy)]
pub struct Bounds<'a> {
    air: &'a Air,
    budget: Budget,
    /// p.
    collided: f64,
    /// p_s.
    scattered: f64,
    /// n − 1.
    collisions: f64,
}

impl<'a> Bounds<'a> {
    /// For a scene and its air.
    pub fn new(budget: Budget, air: &'a Air) -> Self {
        let scattering = largest(air, |scatter| scatter.sigma_s);
        let collided = share(largest(air, |scatter| scatter.sigma_t()));
        Self { air, budget, collided, scattered: share(scattering), collisions: scattering.exp_m1() }
    }

    /// Of a difference of `delta` a flight.
    fn of(&self, delta: f64) -> f64 {
        self.grown(delta * self.budget.emitted.total(), 2)
    }

    /// Mean irradiance in medians after `times` series of reflections.
    fn grown(&self, flux: f64, times: i32) -> f64 {
        if flux == 0.0 { 0.0 } else { self.budget.level(flux) / (1.0 - self.budget.albedo).powi(times) }
    }

    /// Of light that starts with a flux, lm.
    pub fn emitter(&self, flux: f64) -> f64 {
        self.grown(flux, 1)
    }

    /// Of the same through collisions of its first flight.
    pub fn scattered_emitter(&self, flux: f64) -> f64 {
        self.grown(self.scattered * flux, 1)
    }

    /// Of reflected light through collisions.
    pub fn scattered_reflections(&self) -> f64 {
        self.of(self.scattered * self.budget.albedo)
    }

    /// Of light that surfaces reflect.
    pub fn indirect(&self) -> f64 {
        self.grown(self.budget.albedo * self.budget.emitted.total(), 1)
    }

    /// Of light that scatters between points of one plane, where it arrives on other surfaces instead.
    pub fn own_plane(&self) -> f64 {
        2.0 * self.scattered_reflections()
    }

    /// Of all that the air does.
    pub fn attenuation(&self) -> f64 {
        self.of(self.collided + self.scattered)
    }

    /// Of what the air swallows.
    pub fn absorption(&self) -> f64 {
        let a_leg = share(largest(self.air, |scatter| scatter.sigma_a));
        self.of(self.in_a_flight(a_leg).min(1.0))
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
    pub fn anisotropy(&self) -> f64 {
        let scattering = self.air.media.media.iter().filter(|medium| medium.scatter.sigma_s != [0.0; 3]);
        let a = scattering.map(|medium| distance_to_isotropic(&medium.phase)).fold(0.0, f64::max);
        self.of(if a == 0.0 { 0.0 } else { (self.collisions * a).min(2.0 * self.scattered) })
    }

    /// Of a density that varies, against the middle between its ends.
    pub fn heterogeneity(&self) -> f64 {
        self.of_differences(|medium, limits, sigma| match medium.density {
            Density::Uniform => [0.0; 3],
            _ => times(sigma, 0.5 * (limits.density[1] - limits.density[0])),
        })
    }

    /// Of coefficients that differ by channel, against their mean.
    pub fn colour(&self) -> f64 {
        self.of_differences(|_, limits, sigma| {
            let mean = sigma.iter().sum::<f64>() / 3.0;
            let is_grey = sigma == [sigma[0]; 3];
            times(if is_grey { [0.0; 3] } else { sigma.map(|sigma| (sigma - mean).abs()) }, limits.density[1])
        })
    }

    /// Of coefficients that differ by `difference` of themselves. Scattering and absorption differ on their own, at worst in
    /// the same sense.
    fn of_differences(&self, difference: impl Fn(&Medium, &Limits, [f64; 3]) -> [f64; 3]) -> f64 {
        let of = |coefficient: fn(&Scatter) -> [f64; 3]| {
            most(depth(self.air, |medium, limits| difference(medium, limits, coefficient(&medium.scatter))))
        };
        let scattering = of(|scatter| scatter.sigma_s);
        let extinction = scattering + of(|scatter| scatter.sigma_a);
        self.of(self.in_a_flight(extinction * (1.0 + extinction.exp()) + scattering).min(2.0))
    }

    /// Of a flight, from what a leg differs.
    fn in_a_flight(&self, a_leg: f64) -> f64 {
        if a_leg == 0.0 { 0.0 } else { a_leg * (1.0 + self.collisions) }
    }
}

/// Largest depth of a coefficient over all lines.
fn largest(air: &Air, coefficient: impl Fn(&Scatter) -> [f64; 3]) -> f64 {
    most(depth(air, |medium, limits| times(coefficient(&medium.scatter), limits.density[1])))
}

/// Nothing times an endless density is nothing.
fn times(sigma: [f64; 3], density: f64) -> [f64; 3] {
    sigma.map(|sigma| if sigma > 0.0 { sigma * density } else { 0.0 })
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
