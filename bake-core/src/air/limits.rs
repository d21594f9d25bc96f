//! The most that a medium can do to light on a straight line: limits that hold for every line.

use super::Air;
pub(crate) use super::summary::own_box;
use bake_optics::medium::{Density, Medium};
use glam::DVec3;

/// Limits over all lines and points of a medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    /// Longest line inside, metres; infinite where the medium has no end.
    pub longest_m: f64,
    /// Least and largest density inside.
    pub density: [f64; 2],
}

/// Limits of optical depth over all lines through the air, per channel: what counts in the sum is `coefficient` (1/m).
pub(crate) fn depth(air: &Air, coefficient: impl Fn(&Medium, &Limits) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for medium in &air.media.media {
        let limits = limits(medium);
        let sigma = coefficient(medium, &limits);
        // Nothing times an endless line is no depth.
        (0..3).filter(|&c| sigma[c] > 0.0).for_each(|c| sum[c] += sigma[c] * limits.longest_m);
    }
    sum
}

/// Of one medium, from the box around it.
pub(crate) fn limits(medium: &Medium) -> Limits {
    let [min, max] = own_box(medium);
    let size = max - min;
    if size.cmplt(DVec3::ZERO).any() {
        return Limits { longest_m: 0.0, density: [0.0; 2] };
    }
    let corners: [DVec3; 8] = std::array::from_fn(|i| {
        DVec3::from_array(std::array::from_fn(|axis| if i >> axis & 1 == 1 { max[axis] } else { min[axis] }))
    });
    let over = |points: &[DVec3]| {
        let densities = points.iter().map(|&point| medium.density.at(point));
        densities.fold([f64::INFINITY, 0.0], |[low, high], d| [low.min(d), high.max(d)])
    };
    let density = match &medium.density {
        Density::Uniform => [1.0; 2],
        _ if !size.is_finite() => [0.0, f64::INFINITY],
        // Monotone along y: the corners hold both ends.
        Density::Linear { .. } | Density::Exponential { .. } => over(&corners),
        Density::Planet { centre, .. } => [over(&corners)[0], medium.density.at(centre.clamp(min, max))],
        Density::Grid(grid) => [0.0, grid.largest()],
    };
    Limits { longest_m: size.length(), density }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, MediumSet, Ray, Scatter};

    /// No line through a medium is deeper than the limit, nor any point denser.
    #[test]
    fn no_line_goes_beyond() {
        let bounds = Bounds::Box { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 2.0, 5.0) };
        let scatter = Scatter { sigma_s: [0.5, 1.0, 0.0], sigma_a: [0.1; 3] };
        for density in [
            Density::Uniform,
            Density::Linear { zero_m: 1.0, slope_per_m: -0.7 },
            Density::Exponential { base_m: 0.5, scale_height_m: 0.8 },
            Density::Planet { centre: DVec3::new(0.0, -4.0, 3.0), radius_m: 4.0, scale_height_m: 1.0 },
        ] {
            let medium = Medium { bounds: bounds.clone(), density, scatter, ..Medium::default() };
            let air = Air { media: MediumSet { media: vec![medium.clone()] }, ..Air::default() };
            let of = limits(&medium);
            let most = depth(&air, |medium, limits| medium.scatter.sigma_t().map(|sigma| sigma * limits.density[1]));
            let number = |i: u32, k: u32| (f64::from(i * 7 + k) * 0.618_034 + f64::from(i) * 0.414_214).fract();
            for i in 0..400 {
                let at = |k: u32| {
                    DVec3::new(8.0 * number(i, k) - 3.0, 4.0 * number(i, k + 1) - 1.0, 5.0 * number(i, k + 2) + 1.0)
                };
                let line = Ray::between(at(0), at(3));
                let depth = air.media.optical_depth(&line);
                (0..3).for_each(|c| assert!(depth[c] <= most[c] * (1.0 + 1e-12), "{medium:?}: {depth:?}, {most:?}"));
                let d = medium.density_at(at(0));
                assert!(d == 0.0 || (of.density[0] * (1.0 - 1e-12)..=of.density[1] * (1.0 + 1e-12)).contains(&d));
            }
            // Half the limit is broken: the diagonal of the uniform box alone does that.
            let [min, max] = bounds.bounding_box();
            let diagonal = air.media.optical_depth(&Ray::between(min, max))[0];
            assert!(medium.density != Density::Uniform || diagonal > 0.99 * most[0]);
        }
    }

    #[test]
    fn endless_air_has_no_limit() {
        let medium = Medium { scatter: Scatter { sigma_s: [1.0, 0.0, 0.0], sigma_a: [0.0; 3] }, ..Medium::default() };
        let air = Air { media: MediumSet { media: vec![medium] }, ..Air::default() };
        assert_eq!(depth(&air, |medium, _| medium.scatter.sigma_s), [f64::INFINITY, 0.0, 0.0]);
    }
}
