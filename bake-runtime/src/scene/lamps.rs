//! What lamps and suns send straight to points in space, so that it can be taken out of light stored there: the air's
//! methods draw it themselves, sharply.

use bake_formats::manifest::{LightKind, LightRecord, ProfileRecord};
use bake_formats::metrics::luminance;
use bake_optics::emitter::Emitter;
use bake_optics::harmonics::real_sh;
use bake_optics::medium::{MediumSet, Ray};
use glam::{DVec3, Vec3, Vec4};

use super::LatticeData;

/// How much of a light's own pattern must be in what is stored at a point for it to count as seen from there.
const SEEN: f64 = 0.5;

/// Farthest that a sun's ray is followed through air, metres.
const FAR: f64 = 1e9;

/// Takes out of stored light what comes straight from `lights` through `media`; `places`: where each point's light was gathered.
///
/// Whether a point sees a light is not stored. It is told from the harmonics themselves: where the light arrives, its pattern
/// D is in them at least once, c·D ≥ D·D, as other light only adds to it; where it does not, only by chance. Half is the border:
/// a hidden light is mistaken only at points where what is there otherwise matches half of it.
pub(super) fn take_out(lattice: &mut LatticeData, places: &[Vec3], lights: &[LightRecord], media: &MediumSet) {
    let bands = if lattice.harmonics.len() >= 9 { 3 } else { 2 };
    for (at, place) in places.iter().enumerate() {
        for light in lights {
            let Some((dir, irradiance)) = arriving(light, place.as_dvec3(), media) else { continue };
            let pattern = real_sh(dir.to_array(), bands);
            let own: f64 = pattern.iter().map(|y| y * y).sum();
            let stored = |k: usize| luminance(Vec4::from(lattice.harmonics[k][at]).truncate());
            let there: f64 = pattern.iter().enumerate().map(|(k, y)| stored(k) * y).sum();
            if there < SEEN * luminance(DVec3::from(irradiance).as_vec3()) * own {
                continue;
            }
            for (harmonic, y) in lattice.harmonics.iter_mut().zip(&pattern) {
                (0..3).for_each(|c| harmonic[at][c] -= (irradiance[c] * y) as f32);
            }
        }
    }
}

/// Direction towards a light, and what it sends through the air to a plane that faces it, lux; `None` where it does not shine.
fn arriving(light: &LightRecord, place: DVec3, media: &MediumSet) -> Option<(DVec3, [f64; 3])> {
    let color = light.color.as_dvec3();
    let (dir, away, share) = match &light.kind {
        LightKind::Directional { direction, .. } => (-direction.as_dvec3().try_normalize()?, FAR, 1.0),
        LightKind::Point { position, radius, range, profile } => {
            let (dir, away, fall) = from_place(*position, *radius, *range, place)?;
            (dir, away, fall * profile.as_ref().map_or(1.0, |profile| measured(profile, -dir)))
        }
        LightKind::Spot { position, direction, inner_angle, outer_angle, radius, range, profile } => {
            let (dir, away, fall) = from_place(*position, *radius, *range, place)?;
            let cone = Emitter::SpotCone {
                cos_inner: f64::from(*inner_angle).cos(),
                cos_outer: f64::from(*outer_angle).cos(),
            };
            let cosine = direction.as_dvec3().try_normalize()?.dot(-dir);
            let shape = profile.as_ref().map_or_else(|| cone.eval(cosine), |profile| measured(profile, -dir));
            (dir, away, fall * shape)
        }
    };
    let passes = media.transmittance(&Ray::new(place, dir, away));
    let irradiance = [0, 1, 2].map(|c| color[c] * share * passes[c]);
    (share > 0.0).then_some((dir, irradiance))
}

/// Direction towards a lamp, its distance, and 1/distance², 1/m².
fn from_place(position: Vec3, radius: f32, range: Option<f32>, place: DVec3) -> Option<(DVec3, f64, f64)> {
    let way = position.as_dvec3() - place;
    let away = way.length();
    let reached = range.is_none_or(|range| away <= f64::from(range));
    (away > 0.0 && reached).then(|| (way / away, away, 1.0 / (away * away).max(f64::from(radius).powi(2))))
}

fn measured(profile: &ProfileRecord, travel: DVec3) -> f64 {
    let axis = profile.axis.as_dvec3().try_normalize().unwrap_or(DVec3::NEG_Y);
    let terms = profile.legendre.iter().map(|&term| f64::from(term)).collect();
    Emitter::Legendre(terms).eval(axis.dot(travel)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bake_optics::medium::{Bounds, Density, Medium, Scatter};
    use bake_optics::phase::Phase;

    fn haze() -> MediumSet {
        let bounds = Bounds::Box { min: DVec3::splat(-50.0), max: DVec3::splat(50.0) };
        let scatter = Scatter { sigma_s: [0.1, 0.05, 0.02], sigma_a: [0.0, 0.1, 0.0] };
        MediumSet { media: vec![Medium { bounds, density: Density::Uniform, scatter, phase: Phase::Isotropic }] }
    }

    fn lamp(kind: LightKind) -> LightRecord {
        LightRecord { path: "lamp".into(), color: Vec3::new(100.0, 200.0, 50.0), kind }
    }

    fn spot(outer_angle: f32) -> LightRecord {
        let (position, direction) = (Vec3::new(0.0, 4.0, 0.0), Vec3::NEG_Y);
        let (radius, range, profile) = (0.01, None, None);
        lamp(LightKind::Spot { position, direction, inner_angle: 0.1, outer_angle, radius, range, profile })
    }

    /// Even light from everywhere at one point, and a lamp's on top where it is seen.
    fn stored(bands: usize, even: f32, lamp: Option<(DVec3, [f64; 3])>) -> LatticeData {
        let pattern = lamp.map(|(dir, e)| (real_sh(dir.to_array(), bands), e));
        let texel = |k: usize| {
            let of = |c: usize| pattern.as_ref().map_or(0.0, |(y, e)| (e[c] * y[k]) as f32);
            let base = if k == 0 { even * (4.0 * std::f32::consts::PI).sqrt() } else { 0.0 };
            vec![[base + of(0), base + of(1), base + of(2), 1.0]]
        };
        LatticeData { count: [1; 3], harmonics: (0..bands * bands).map(texel).collect(), ..LatticeData::default() }
    }

    #[test]
    fn what_a_seen_lamp_sends_is_gone_and_the_rest_stays() {
        let place = Vec3::new(1.0, 0.0, 0.5);
        let direct = (place.as_dvec3() - DVec3::new(0.0, 4.0, 0.0)).length();
        for (bands, even) in [(2, 0.0), (2, 0.3), (3, 5.0)] {
            let light = spot(0.6);
            let arrives = arriving(&light, place.as_dvec3(), &haze()).expect("inside the cone");
            // Inverse square, cone and Beer's law, channel by channel.
            let cosine = 4.0 / direct;
            let share = ((cosine - 0.6f64.cos()) / (0.1f64.cos() - 0.6f64.cos())).clamp(0.0, 1.0).powi(2);
            for (c, (color, sigma)) in [(100.0, 0.1), (200.0, 0.15), (50.0, 0.02)].into_iter().enumerate() {
                let want = color * share / (direct * direct) * f64::exp(-sigma * direct);
                assert!((arrives.1[c] / want - 1.0).abs() < 1e-6, "{:?}", arrives.1);
            }
            let mut lattice = stored(bands, even, Some(arrives));
            take_out(&mut lattice, &[place], &[light], &haze());
            let wanted = stored(bands, even, None);
            for (got, want) in lattice.harmonics.iter().flatten().zip(wanted.harmonics.iter().flatten()) {
                (0..4).for_each(|c| assert!((got[c] - want[c]).abs() < 1e-5, "{got:?}, not {want:?}"));
            }
        }
    }

    #[test]
    fn what_a_hidden_lamp_or_one_that_shines_elsewhere_would_send_is_left() {
        let place = Vec3::new(1.0, 0.0, 0.5);
        let hidden = stored(2, 0.3, None);
        for light in [spot(0.6), spot(0.11)] {
            let mut lattice = hidden.clone();
            take_out(&mut lattice, &[place], &[light], &haze());
            assert_eq!(lattice, hidden);
        }
        let sun = lamp(LightKind::Directional { direction: Vec3::NEG_Y, angular_radius: 0.0 });
        let arrives = arriving(&sun, place.as_dvec3(), &haze()).expect("suns shine everywhere");
        assert!(
            (arrives.1[2] / (50.0 * (-0.02f64 * 50.0).exp()) - 1.0).abs() < 1e-6,
            "through the air above: {arrives:?}"
        );
    }
}
