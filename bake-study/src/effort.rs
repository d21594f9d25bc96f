//! How much a study may take.

use bake_core::settings::Settings;

/// How much a study may take.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// Largest width and height of the page that all must fit on; the settings' own pages when absent.
    pub page: Option<u32>,
    /// Samples per texel of the reference.
    pub reference_samples: u32,
    /// Samples per texel of the modes' lines.
    pub samples: Vec<u32>,
    /// Samples per texel where something else is varied.
    pub fixed_samples: u32,
    /// Standard errors asked for.
    pub targets: Vec<f32>,
    /// Cells along a side and walks a node of the light grid.
    pub grids: Vec<[u32; 2]>,
    /// Distances at which tables are read.
    pub bins: Vec<usize>,
    /// Degrees below which tables are read, up to 16.
    pub bands: Vec<usize>,
    /// Collisions up to which tables are summed.
    pub orders: Vec<usize>,
}

impl Effort {
    /// Minutes: one small page.
    pub fn quick() -> Self {
        Self {
            page: Some(96),
            reference_samples: 8192,
            samples: vec![8, 32, 128, 512, 2048],
            fixed_samples: 256,
            targets: vec![0.1, 0.04, 0.02],
            grids: vec![[4, 256], [8, 256], [12, 64], [12, 256], [12, 1024], [16, 256]],
            bins: vec![16, 64, 256],
            bands: vec![3, 5, 7, 9, 11, 13, 15],
            orders: vec![2, 3, 5, 10],
        }
    }

    /// What it takes: the settings' own pages.
    pub fn thorough() -> Self {
        Self {
            page: None,
            reference_samples: 65536,
            samples: vec![8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192],
            fixed_samples: 1024,
            targets: vec![0.1, 0.04, 0.02, 0.01],
            grids: [4, 8, 12, 18, 24]
                .into_iter()
                .flat_map(|cells| [128, 512, 2048].map(|walks| [cells, walks]))
                .collect(),
            bins: vec![16, 32, 64, 128, 256, 512],
            bands: vec![3, 5, 7, 9, 11, 13, 15],
            orders: vec![2, 3, 5, 10],
        }
    }

    /// With another reference; points that it could not judge are left out.
    pub fn with_reference(mut self, samples: u32) -> Self {
        self.reference_samples = samples;
        self.samples.retain(|&point| point <= samples / 4);
        self.fixed_samples = self.fixed_samples.min(samples / 4);
        self
    }

    /// The settings with pages of this effort.
    pub fn pages(&self, mut settings: Settings) -> Settings {
        if let Some(page) = self.page {
            settings.page_size = settings.page_size.min(page);
            settings.max_pages = Some(1);
        }
        settings
    }
}
