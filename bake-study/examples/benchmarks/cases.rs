//! What is measured.

use bake_core::settings::{self, Bounds, Density, Medium, Phase, Scatter, Settings, SettingsError};
use bake_study::effort::Effort;
use std::path::Path;

/// A scene in its air.
pub struct Case {
    /// Name of its folder.
    pub name: &'static str,
    /// Stem of its scene.
    pub scene: &'static str,
    /// What it stands for.
    pub what: &'static str,
    /// Extinction in 1/m, albedo, mean cosine; none for no air.
    air: Option<[f32; 3]>,
    /// Width and height of the page.
    page: u32,
    /// Samples per texel of the reference.
    reference: u32,
}

/// All cases.
pub const CASES: [Case; 4] = [
    Case { name: "cornell", scene: "cornell", what: "an open box without air", air: None, page: 64, reference: 4096 },
    Case {
        name: "room-1",
        scene: "lit_room",
        what: "a closed room of 4 × 2.5 × 3 m with a point light in air of optical size 1 (extinction times its depth of 3 m), albedo 1",
        air: Some([1.0 / 3.0, 1.0, 0.0]),
        page: 32,
        reference: 8192,
    },
    Case {
        name: "room-3",
        scene: "lit_room",
        what: "the same room, optical size 3, albedo 0.7",
        air: Some([1.0, 0.7, 0.0]),
        page: 32,
        reference: 8192,
    },
    Case {
        name: "hall",
        scene: "hall",
        what: "the hall of the README in haze: 20 m of mean free path, albedo 0.9, mean cosine 0.3",
        air: Some([0.05, 0.9, 0.3]),
        page: 64,
        reference: 1536,
    },
];

/// The reference above which a case is cheap enough for all of a quick study.
const CHEAP: u32 = 4096;

impl Case {
    /// The scene's own settings in this case's air.
    pub fn settings(&self, file: &Path) -> Result<Settings, SettingsError> {
        let side_file = settings::sidecar(file);
        let settings = if side_file.exists() { settings::read(&side_file)? } else { Settings::default() };
        let media = self.air.map(|[sigma_t, albedo, g]| {
            let scatter = Scatter::Sigma { s: [sigma_t * albedo; 3], a: [sigma_t * (1.0 - albedo); 3] };
            let phase = if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein(g) };
            vec![Medium { name: "air".into(), bounds: Bounds::Scene, density: Density::Uniform, scatter, phase }]
        });
        Ok(Settings { media, ..settings })
    }

    /// A quick study with this case's page and reference; in the hall with fewer points, for a third of an hour on two cores.
    pub fn effort(&self) -> Effort {
        let quick = Effort { page: Some(self.page), ..Effort::quick().with_reference(self.reference) };
        if self.reference >= CHEAP {
            return quick;
        }
        let (samples, grids) = (vec![8, 32, 128, 384], vec![[8, 256], [12, 256], [16, 256]]);
        Effort { samples, grids, fixed_samples: 128, targets: vec![0.2, 0.1], bands: vec![3, 5, 11], ..quick }
    }
}
