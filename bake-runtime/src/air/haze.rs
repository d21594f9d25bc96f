//! A medium in three numbers, as a person turns it: density, how much is scattered, and which way.

use bake_optics::medium::{Medium, Scatter};
use bake_optics::phase::Phase;

/// Means over the colour channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Haze {
    /// Extinction at density 1, 1/m.
    pub sigma_t: f64,
    /// Share of it that is scattered, 0 to 1.
    pub albedo: f64,
    /// Mean cosine of the phase function, −1 to 1.
    pub g: f64,
}

impl Haze {
    /// The numbers of a medium.
    pub fn of(medium: &Medium) -> Self {
        let (sigma_s, sigma_t) = (mean(medium.scatter.sigma_s), mean(medium.scatter.sigma_t()));
        let albedo = if sigma_t > 0.0 { sigma_s / sigma_t } else { 0.0 };
        Self { sigma_t, albedo, g: medium.phase.moment(1) }
    }

    /// The medium turned to these numbers; where one is as it was, so is what it stands for. Colours keep their proportions
    /// as far as no channel scatters more than it meets; another mean cosine makes the phase function Henyey and Greenstein's.
    pub fn applied(&self, medium: &Medium) -> Medium {
        let was = Self::of(medium);
        let mut new = medium.clone();
        if (self.sigma_t, self.albedo) != (was.sigma_t, was.albedo) {
            let sigma_t = medium.scatter.sigma_t();
            let albedo: [f64; 3] =
                std::array::from_fn(|c| medium.scatter.sigma_s[c] / sigma_t[c].max(f64::MIN_POSITIVE));
            let sigma_t =
                sigma_t.map(|s| if was.sigma_t > 0.0 { s * self.sigma_t / was.sigma_t } else { self.sigma_t });
            let albedo = albedo.map(|a| shifted(a, was.albedo, self.albedo.clamp(0.0, 1.0)));
            let sigma_s = std::array::from_fn(|c| sigma_t[c] * albedo[c]);
            new.scatter = Scatter { sigma_s, sigma_a: std::array::from_fn(|c| sigma_t[c] * (1.0 - albedo[c])) };
        }
        if self.g != was.g {
            new.phase = Phase::HenyeyGreenstein { g: self.g.clamp(-0.99, 0.99) };
        }
        new
    }
}

/// One channel's share where the mean moves: towards 0 all shrink alike, towards 1 what is missing does.
fn shifted(channel: f64, was: f64, now: f64) -> f64 {
    if now <= was {
        channel * now / was.max(f64::MIN_POSITIVE)
    } else {
        1.0 - (1.0 - channel) * (1.0 - now) / (1.0 - was)
    }
}

fn mean(channels: [f64; 3]) -> f64 {
    channels.iter().sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, Density};

    fn haze(sigma_s: [f64; 3], sigma_a: [f64; 3], phase: Phase<f64>) -> Medium {
        let bounds = Bounds::Box { min: glam::DVec3::ZERO, max: glam::DVec3::ONE };
        Medium { bounds, density: Density::Uniform, scatter: Scatter { sigma_s, sigma_a }, phase }
    }

    #[test]
    fn what_is_not_turned_stays_bit_by_bit() {
        let medium = haze([0.1, 0.2, 0.3], [0.01, 0.0, 0.02], Phase::Rayleigh);
        assert_eq!(Haze::of(&medium).applied(&medium), medium);
        let denser = Haze { sigma_t: 1.0, ..Haze::of(&medium) }.applied(&medium);
        assert_eq!(denser.phase, medium.phase);
    }

    #[test]
    fn the_turned_medium_has_the_numbers_it_was_turned_to() {
        let grey = haze([0.2; 3], [0.1; 3], Phase::Isotropic);
        for wanted in [
            Haze { sigma_t: 0.05, albedo: 0.3, g: -0.4 },
            Haze { sigma_t: 4.0, albedo: 1.0, g: 0.9 },
            Haze { sigma_t: 4.0, albedo: 0.0, g: 0.0 },
        ] {
            let got = Haze::of(&wanted.applied(&grey));
            assert!((got.sigma_t / wanted.sigma_t - 1.0).abs() < 1e-12, "{got:?}");
            assert!((got.albedo - wanted.albedo).abs() < 1e-12 && (got.g - wanted.g).abs() < 1e-12, "{got:?}");
        }
        // From nothing it comes up grey; a coloured one never scatters more than it meets.
        let none = haze([0.0; 3], [0.0; 3], Phase::Isotropic);
        let some = Haze { sigma_t: 0.5, albedo: 0.8, g: 0.0 }.applied(&none);
        assert!((Haze::of(&some).sigma_t - 0.5).abs() < 1e-12 && (Haze::of(&some).albedo - 0.8).abs() < 1e-12);
        let coloured = haze([0.9, 0.5, 0.1], [0.1, 0.5, 0.9], Phase::Isotropic);
        let bright = Haze { albedo: 0.95, ..Haze::of(&coloured) }.applied(&coloured);
        assert!(bright.scatter.sigma_a.iter().all(|&a| a >= 0.0), "{:?}", bright.scatter);
        assert!(bright.scatter.sigma_s[0] > bright.scatter.sigma_s[2]);
    }
}
