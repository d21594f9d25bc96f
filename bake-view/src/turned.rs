//! What a person has turned: a package's air and lights, and lamps that were not baked. Nothing turned: as it was baked.

use bake_formats::manifest::{LightKind, LightRecord};
use bake_runtime::air::{Haze, Medium};
use glam::Vec3;

/// Whether a light shines, and how much brighter than it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimmer {
    /// Whether it shines.
    pub on: bool,
    /// Factor of its intensity.
    pub scale: f32,
}

impl Default for Dimmer {
    fn default() -> Self {
        Self { on: true, scale: 1.0 }
    }
}

impl Dimmer {
    /// The light as it now shines; none where it does not.
    pub fn applied(&self, light: &LightRecord) -> Option<LightRecord> {
        let shines = self.on && self.scale > 0.0;
        shines.then(|| LightRecord { color: light.color * self.scale, ..light.clone() })
    }
}

/// What is turned of one package.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Turned {
    /// The air's numbers, medium by medium; none: as it was baked.
    pub haze: Vec<Option<Haze>>,
    /// Its lights, one by one.
    pub lights: Vec<Dimmer>,
}

impl Turned {
    /// Nothing turned of so many media and lights.
    pub fn nothing(media: usize, lights: usize) -> Self {
        Self { haze: vec![None; media], lights: vec![Dimmer::default(); lights] }
    }

    /// The air as it now is.
    pub fn media(&self, baked: &[Medium]) -> Vec<Medium> {
        let haze = |index: usize| self.haze.get(index).copied().flatten();
        let turned =
            |(index, medium): (usize, &Medium)| haze(index).map_or_else(|| medium.clone(), |h| h.applied(medium));
        baked.iter().enumerate().map(turned).collect()
    }

    /// The lights that now shine.
    pub fn lights(&self, baked: &[LightRecord]) -> Vec<LightRecord> {
        let dimmer = |index: usize| self.lights.get(index).copied().unwrap_or_default();
        baked.iter().enumerate().filter_map(|(index, light)| dimmer(index).applied(light)).collect()
    }
}

/// A lamp that was not baked: it shines on surfaces and air alike, in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// Its centre, metres.
    pub place: Vec3,
    /// At 1, white surfaces 2 m away are as bright as the scene is.
    pub dimmer: Dimmer,
}

impl Lamp {
    /// Radius, metres.
    const RADIUS: f32 = 0.02;

    /// A lamp as bright as the scene.
    pub fn at(place: Vec3) -> Self {
        Self { place, dimmer: Dimmer::default() }
    }

    /// The light that it is where surfaces have radiance `white`, cd/m²; none where it does not shine.
    pub fn light(&self, white: f32) -> Option<LightRecord> {
        let kind = LightKind::Point { position: self.place, radius: Self::RADIUS, range: None, profile: None };
        // Irradiance I/d² makes radiance I/(π d²) on a white surface.
        let intensity = 4.0 * std::f32::consts::PI * white;
        self.dimmer.applied(&LightRecord { path: "lamp".into(), color: Vec3::splat(intensity), kind })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_dimmed_one_by_one() {
        let light = |x: f32| LightRecord {
            path: String::new(),
            color: Vec3::ONE,
            kind: LightKind::Directional { direction: Vec3::X * x, angular_radius: 0.0 },
        };
        let baked = [light(1.0), light(2.0), light(3.0)];
        assert_eq!(Turned::default().lights(&baked), baked);
        let mut turned = Turned::nothing(0, 3);
        assert_eq!(turned.lights(&baked), baked);
        (turned.lights[0].on, turned.lights[2].scale) = (false, 0.5);
        assert_eq!(turned.lights(&baked), [light(2.0), LightRecord { color: Vec3::splat(0.5), ..light(3.0) }]);
        turned.lights[1].scale = 0.0;
        assert_eq!(turned.lights(&baked).len(), 1);
    }

    #[test]
    fn a_lamp_two_metres_away_is_as_bright_as_the_scene() {
        let lamp = Lamp::at(Vec3::ZERO);
        let light = lamp.light(7.0).expect("it shines");
        assert!((light.color.x / 4.0 / std::f32::consts::PI - 7.0).abs() < 1e-5);
        assert_eq!(Lamp { dimmer: Dimmer { on: false, scale: 1.0 }, ..lamp }.light(7.0), None);
    }
}
