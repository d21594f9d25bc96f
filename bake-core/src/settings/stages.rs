//! What each stage is told: the one settings record split into the options of loader, atlas and solver.

use super::{LightUnits, Quality, Settings, SettingsError, Unlit};
use crate::atlas::AtlasSettings;
use crate::scene::{self, LoadOptions, Scene, SceneChoice, UnlitMode};
use crate::solve::grid::GridSettings;
use crate::solve::{Effort, LightmapSettings, Mode};
use glam::Vec3;

impl Settings {
    /// For [`crate::scene::load()`].
    pub fn load_options(&self) -> LoadOptions {
        LoadOptions {
            scene: self.scene.as_ref().map(|choice| match choice.parse() {
                Ok(index) => SceneChoice::Index(index),
                Err(_) => SceneChoice::Name(choice.clone()),
            }),
            light_units: match self.light_units {
                LightUnits::Gltf => scene::LightUnits::Gltf,
                LightUnits::Watts => scene::LightUnits::Watts,
                LightUnits::Unitless => scene::LightUnits::Unitless,
            },
            light_scale: self.light_scale,
            min_light_radius: self.light_radius_m,
            sky: self.sky.map(Vec3::from),
            sun: self.sun.map(|sun| scene::Sun {
                azimuth_deg: sun.azimuth_deg,
                elevation_deg: sun.elevation_deg,
                lux: sun.lux,
                color: sun.colour.into(),
                angular_diameter_deg: sun.angular_diameter_deg,
            }),
            env: self.env.as_ref().map(|env| scene::Env {
                file: env.file.clone(),
                rotation_deg: env.rotation_deg,
                scale: env.scale,
            }),
            ies: self
                .ies
                .iter()
                .map(|(node, file)| (node.clone(), scene::Ies { file: file.clone(), scale: 1.0 }))
                .collect(),
            bake_instanced: self.bake_instanced,
            unlit: match self.unlit {
                Unlit::Black => UnlitMode::Black,
                Unlit::Reflect => UnlitMode::Reflect,
                Unlit::Emit(radiance) => UnlitMode::Emit(radiance),
            },
            require_light: true,
        }
    }

    /// Takes over the media of the scene's extras where none are set, so that they are recorded as settings are.
    ///
    /// # Errors
    /// Extras that are no media.
    pub fn adopt_media(&mut self, scene: &Scene) -> Result<(), SettingsError> {
        if let (None, Some(extras)) = (&self.media, &scene.media_extras) {
            self.media = Some(super::media_of_scene(extras)?);
        }
        Ok(())
    }

    /// Takes the lightmap from nodes whose record says so, or gives it; returns the keys of `nodes` that fit nothing.
    pub fn choose_lightmapped(&self, scene: &mut Scene) -> Vec<String> {
        for instance in &mut scene.instances {
            if let Some(lightmap) = self.node(&instance.path).and_then(|node| node.lightmap) {
                instance.lightmapped = lightmap;
            }
        }
        let unused = |key: &&String| !scene.instances.iter().any(|instance| Self::key_fits(key, &instance.path));
        self.nodes.keys().filter(unused).cloned().collect()
    }

    /// For [`crate::atlas::build()`].
    pub fn atlas_settings(&self) -> AtlasSettings {
        let density = |(name, node): (&String, &super::Node)| Some((name.clone(), node.texels_per_m?));
        AtlasSettings {
            texels_per_m: self.texels_per_m,
            page_size: self.page_size,
            max_pages: self.max_pages,
            padding: self.padding,
            node_texels_per_m: self.nodes.iter().filter_map(density).collect(),
            ..AtlasSettings::default()
        }
    }

    /// For [`crate::solve::lightmap`]; mode and what is left out are the plan's to choose.
    pub fn lightmap_settings(&self) -> LightmapSettings {
        let (floor, cap) = self.samples.map_or(self.quality.sample_range(), |samples| (samples, samples));
        LightmapSettings {
            target_error: self.relative_error(),
            min_samples: floor,
            max_samples: cap,
            bounces: self.bounces,
            sh1: self.sh1,
            seed: self.seed,
            deadline: None,
            environment: true,
            collisions: None,
            mode: Mode::Walk,
            grid: self.quality.grid(),
            tables: Effort::default(),
        }
    }
}

impl Quality {
    /// The light grid: fine enough for walls of a share 1/cells of the scene, samples for the noise of many nodes together.
    ///
    /// Measured in the courtyard at night, whose unlit texels see nothing but what the air brings round corners: RMSE 7.8 % as
    /// for medium, 4.2 % as for high, 3.1 % as for final, each with the noise of 2048 samples a texel (1.0 to 1.3 %).
    pub fn grid(self) -> GridSettings {
        let [cells, samples] = match self {
            Self::Preview => [8, 128],
            Self::Medium => [12, 128],
            Self::High => [16, 256],
            Self::Final => [24, 512],
        };
        GridSettings { cells, samples }
    }

    /// Samples per texel at least and at most. A sample's spread is about the texel's value, so that an error e takes
    /// about e⁻² samples; the cap leaves a factor of four for harder light, the floor keeps the estimate of the error
    /// itself reliable.
    pub fn sample_range(self) -> (u32, u32) {
        match self {
            Self::Preview => (32, 512),
            Self::Medium => (64, 4096),
            Self::High => (64, 16384),
            Self::Final => (128, 65536),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Instance;
    use crate::settings::Node;
    use glam::Affine3A;
    use std::collections::BTreeMap;

    fn instance(path: &str, lightmapped: bool) -> Instance {
        Instance { path: path.into(), node: 0, mesh: 0, world_from_object: Affine3A::IDENTITY, lightmapped }
    }

    #[test]
    fn nodes_give_and_take_lightmaps_and_unused_keys_are_told() {
        let node = |lightmap| Node { texels_per_m: None, lightmap };
        let nodes = BTreeMap::from([
            ("Grass".to_owned(), node(Some(true))),
            ("Roof".to_owned(), node(Some(false))),
            ("Rof".to_owned(), node(Some(false))),
        ]);
        let settings = Settings { nodes, ..Settings::default() };
        let instances = vec![instance("Grass", false), instance("House/Roof/Bolt", true), instance("House", true)];
        let mut scene = Scene { instances, ..Scene::default() };
        assert_eq!(settings.choose_lightmapped(&mut scene), ["Rof"]);
        assert_eq!(scene.instances.iter().map(|i| i.lightmapped).collect::<Vec<_>>(), [true, false, true]);
    }

    #[test]
    fn the_cap_of_every_preset_lets_it_reach_its_error() {
        for (name, quality) in Quality::ALL {
            let (floor, cap) = quality.sample_range();
            let needed = quality.relative_error().powi(-2);
            assert!((floor as f32) < needed && needed < cap as f32, "{name}: {floor}..{cap}, about {needed} needed");
        }
    }

    #[test]
    fn a_number_of_samples_is_taken_exactly() {
        let solver = Settings { samples: Some(96), ..Settings::default() }.lightmap_settings();
        assert_eq!((solver.min_samples, solver.max_samples), (96, 96));
    }
}
