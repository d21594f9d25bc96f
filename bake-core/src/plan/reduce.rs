//! Air without one of its effects: pure functions from air to air, applied before any solver sees it.

use crate::air::{Air, limits};
use bake_optics::medium::{Bounds, Density, Medium, Scatter};
use bake_optics::phase::Phase;

/// Air that swallows what it scattered.
pub fn without_scattering(air: &Air) -> Air {
    each(air, |medium| {
        medium.scatter = Scatter { sigma_s: [0.0; 3], sigma_a: medium.scatter.sigma_t() };
        medium.phase = Phase::Isotropic;
    })
}

/// Air that only scatters.
pub fn without_absorption(air: &Air) -> Air {
    each(air, |medium| medium.scatter.sigma_a = [0.0; 3])
}

/// Air that scatters alike in all directions.
pub fn isotropic(air: &Air) -> Air {
    each(air, |medium| medium.phase = Phase::Isotropic)
}

/// Air with the mean of its three coefficients in all channels.
pub fn grey(air: &Air) -> Air {
    let mean = |[r, g, b]: [f64; 3]| if r == g && g == b { [r; 3] } else { [(r + g + b) / 3.0; 3] };
    each(air, |medium| {
        let Scatter { sigma_s, sigma_a } = medium.scatter;
        medium.scatter = Scatter { sigma_s: mean(sigma_s), sigma_a: mean(sigma_a) };
    })
}

/// Air whose density is the middle between its least and its largest. Media without end stay as they are.
pub fn homogeneous(air: &Air) -> Air {
    each(air, |medium| {
        let [low, high] = limits::limits(medium).density;
        let density = 0.5 * (low + high);
        if medium.density == Density::Uniform || !density.is_finite() {
            return;
        }
        if let (Density::Grid(_), Bounds::Unbounded) = (&medium.density, &medium.bounds) {
            let [min, max] = limits::own_box(medium);
            medium.bounds = Bounds::Box { min, max };
        }
        let Scatter { sigma_s, sigma_a } = medium.scatter;
        medium.scatter = Scatter { sigma_s: sigma_s.map(|s| s * density), sigma_a: sigma_a.map(|s| s * density) };
        medium.density = Density::Uniform;
    })
}

fn each(air: &Air, change: impl Fn(&mut Medium)) -> Air {
    let mut reduced = air.clone();
    reduced.media.media.iter_mut().for_each(change);
    reduced
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{MediumSet, Ray};
    use glam::DVec3;

    fn smoke() -> Air {
        let medium = Medium {
            bounds: Bounds::Box { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 1.0) },
            density: Density::Exponential { base_m: 0.0, scale_height_m: 1.0 },
            scatter: Scatter { sigma_s: [0.5, 0.4, 0.3], sigma_a: [0.1, 0.0, 0.2] },
            phase: Phase::HenyeyGreenstein { g: 0.5 },
        };
        Air { media: MediumSet { media: vec![medium] }, names: vec!["smoke".into()], ..Air::default() }
    }

    #[test]
    fn each_takes_away_one_thing_and_keeps_the_rest() {
        let air = smoke();
        let questions =
            |air: &Air| [air.scatters(), air.absorbs(), !air.is_isotropic(), !air.is_grey(), !air.is_homogeneous()];
        assert_eq!(questions(&air), [true; 5]);
        assert_eq!(questions(&without_scattering(&air)), [false, true, false, true, true]);
        assert_eq!(questions(&without_absorption(&air)), [true, false, true, true, true]);
        assert_eq!(questions(&isotropic(&air)), [true, true, false, true, true]);
        assert_eq!(questions(&grey(&air)), [true, true, true, false, true]);
        assert_eq!(questions(&homogeneous(&air)), [true, true, true, true, false]);
        let line = Ray::between(DVec3::ZERO, DVec3::new(1.0, 2.0, 1.0));
        let depth = |air: &Air| air.media.optical_depth(&line);
        assert_eq!(depth(&without_scattering(&air)), depth(&air));
        assert!(depth(&without_absorption(&air))[0] < depth(&air)[0]);
    }

    #[test]
    fn what_is_absent_already_changes_no_bit() {
        let scatter = Scatter { sigma_s: [0.1; 3], sigma_a: [0.0; 3] };
        let air = Air { media: MediumSet { media: vec![Medium { scatter, ..Medium::default() }] }, ..Air::default() };
        assert_eq!(
            [without_absorption(&air), isotropic(&air), grey(&air), homogeneous(&air)],
            [0; 4].map(|_| air.clone())
        );
    }
}
