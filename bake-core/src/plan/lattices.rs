//! Where probes and the cells of a fog volume will lie.

use crate::air::Air;
use crate::scene::Scene;
use crate::settings::{Bounds, Settings, SettingsError};
use crate::solve::grid::region;
use crate::solve::lattice::{Lattice, MOST_POINTS, WIDEST_IMAGE};
use crate::solve::visibility;
use glam::{UVec3, Vec3};
use serde::Serialize;

/// Cells along the longest side of a fog volume whose spacing is not set.
const USUAL_CELLS: f32 = 32.0;

/// The lattices that settings ask for.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Lattices {
    /// Of probes.
    pub probes: Option<Lattice>,
    /// Of the fog volume's cells.
    pub fog_volume: Option<Lattice>,
}

impl Lattices {
    /// Lays them out: probes over the scene's box unless set by hand, fog over what scatters, or over the scene's box
    /// where nothing does.
    ///
    /// # Errors
    /// More points than can be solved and stored.
    pub fn lay_out(scene: &Scene, air: &Air, settings: &Settings) -> Result<Self, SettingsError> {
        let bounds = scene.bounds();
        let mut lattices = Self::default();
        if let Some(probes) = &settings.probes {
            let spacing = probes.spacing_m;
            let lattice = match (probes.origin, probes.count, &probes.bounds) {
                _ if !probes.points.is_empty() => {
                    Lattice::listed(probes.points.iter().copied().map(Vec3::from).collect(), spacing)
                }
                (Some(origin), Some(count), _) => {
                    Lattice::even(origin.into(), Vec3::splat(spacing), UVec3::from(count))
                }
                (_, _, Bounds::Box { min, max }) => Lattice::filling((*min).into(), (*max).into(), spacing),
                _ => Lattice::filling(bounds[0], bounds[1], spacing),
            };
            let tile = if probes.visibility { visibility::SIZE } else { 1 };
            let key = if probes.points.is_empty() { "probes.spacing_m" } else { "probes.points" };
            lattices.probes = Some(check(key, spacing, lattice, tile)?);
        }
        if let Some(volume) = &settings.fog_volume {
            let (min, max) = if air.scatters() { region(&air.media, bounds) } else { (bounds[0], bounds[1]) };
            let spacing = volume.spacing_m.unwrap_or((max - min).max_element().max(1e-3) / USUAL_CELLS);
            lattices.fog_volume = Some(check("fog_volume.spacing_m", spacing, Lattice::filling(min, max, spacing), 1)?);
        }
        Ok(lattices)
    }

    /// Points of both.
    pub fn points(&self) -> u64 {
        [&self.probes, &self.fog_volume].into_iter().flatten().map(Lattice::points).sum()
    }
}

/// Refuses what cannot be stored at `tile` texels across a point.
fn check(key: &str, spacing: f32, lattice: Lattice, tile: u32) -> Result<Lattice, SettingsError> {
    if lattice.fits(tile) {
        return Ok(lattice);
    }
    let [x, y, z] = lattice.count.to_array();
    let (points, across) = (MOST_POINTS / u64::from(tile), WIDEST_IMAGE / u64::from(tile));
    Err(SettingsError::OutOfRange {
        key: key.into(),
        value: format!("{spacing}, which makes {x} × {y} × {z} points"),
        allowed: format!(
            "at most {points} points, and {across} along x times z: a larger spacing, a smaller box or a shorter list"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{FogVolume, Probes};
    use crate::test_scenes::{closed_box, matte, scene};
    use bake_optics::medium::{self, Medium, MediumSet, Scatter};
    use glam::DVec3;

    fn room() -> Scene {
        scene(vec![closed_box(Vec3::ZERO, Vec3::new(4.0, 2.0, 3.0), true, 0)], vec![matte(0.5)])
    }

    fn lay_out(settings: &Settings, air: &Air) -> Result<Lattices, SettingsError> {
        Lattices::lay_out(&room(), air, settings)
    }

    #[test]
    fn probes_fill_the_scene_or_a_box_or_stand_where_they_are_set() {
        let spaced = Probes { spacing_m: 1.0, ..Probes::default() };
        let boxed = Probes { bounds: Bounds::Box { min: [0.0; 3], max: [2.0; 3] }, ..spaced.clone() };
        let by_hand = Probes { origin: Some([9.0; 3]), count: Some([1, 2, 3]), ..spaced.clone() };
        for (probes, origin, count) in [(spaced, 0.5, [4, 2, 3]), (boxed, 0.5, [2, 2, 2]), (by_hand, 9.0, [1, 2, 3])] {
            let settings = Settings { probes: Some(probes), ..Settings::default() };
            let lattice = lay_out(&settings, &Air::default()).expect("fits").probes.expect("asked for");
            assert_eq!(lattice, Lattice::even(Vec3::splat(origin), Vec3::ONE, UVec3::from(count)));
        }
        let points = vec![[3.0, 1.0, 2.0], [0.5, 1.0, 0.5]];
        let one_by_one = Probes { spacing_m: 0.5, points, ..Probes::default() };
        let settings = Settings { probes: Some(one_by_one), ..Settings::default() };
        let lattice = lay_out(&settings, &Air::default()).expect("fits").probes.expect("asked for");
        assert_eq!((lattice.count, lattice.spacing), (UVec3::new(2, 1, 1), Vec3::splat(0.5)));
        assert_eq!([0, 1].map(|index| lattice.position(index)), [Vec3::new(3.0, 1.0, 2.0), Vec3::new(0.5, 1.0, 0.5)]);
    }

    #[test]
    fn more_probes_than_fit_are_refused() {
        let probes = Probes { spacing_m: 0.01, ..Probes::default() };
        let settings = Settings { probes: Some(probes), ..Settings::default() };
        let message = lay_out(&settings, &Air::default()).expect_err("24 million").to_string();
        assert!(message.contains("probes.spacing_m") && message.contains("400 × 200 × 300"), "{message}");
    }

    #[test]
    fn maps_of_what_probes_see_take_more_room() {
        let probes = |visibility| Probes { spacing_m: 0.05, visibility, ..Probes::default() };
        let lay_out = |visibility| {
            let settings = Settings { probes: Some(probes(visibility)), ..Settings::default() };
            lay_out(&settings, &Air::default())
        };
        assert!(lay_out(false).is_ok());
        let message = lay_out(true).expect_err("too wide").to_string();
        assert!(message.contains("65536 points, and 4096"), "{message}");
    }

    #[test]
    fn longer_lists_than_fit_are_refused() {
        let probes = |count| Probes { spacing_m: 1.0, points: vec![[0.0; 3]; count], ..Probes::default() };
        let lay_out = |count| {
            let settings = Settings { probes: Some(probes(count)), ..Settings::default() };
            lay_out(&settings, &Air::default())
        };
        assert!(lay_out(1 << 16).is_ok());
        let message = lay_out((1 << 16) + 1).expect_err("too wide").to_string();
        assert!(message.contains("probes.points") && message.contains("65537 × 1 × 1"), "{message}");
    }

    #[test]
    fn the_fog_volume_lies_around_what_scatters() {
        let bounds = medium::Bounds::Box { min: DVec3::ZERO, max: DVec3::new(2.0, 1.0, 1.0) };
        let scatter = Scatter { sigma_s: [1.0; 3], sigma_a: [0.0; 3] };
        let media = MediumSet { media: vec![Medium { bounds, scatter, ..Medium::default() }] };
        let air = Air { media, names: vec!["fog".into()], ..Air::default() };
        let volume = |spacing_m| Settings { fog_volume: Some(FogVolume { spacing_m }), ..Settings::default() };
        let of = |settings, air| lay_out(&settings, air).expect("fits").fog_volume.expect("asked for").count;
        assert_eq!(of(volume(Some(0.5)), &air), UVec3::new(4, 2, 2));
        assert_eq!(of(volume(None), &air), UVec3::new(32, 16, 16));
        assert_eq!(of(volume(Some(0.5)), &Air::default()), UVec3::new(8, 4, 6), "the scene's box without fog");
    }
}
