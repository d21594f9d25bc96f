//! What a study keeps on disk as it goes: `points.csv`, one line for every measured point, keyed by a hash of all that
//! its numbers depend on, and the reference's pages. An interrupted study finds them again.

use crate::error::StudyError;
use crate::measure::{Baked, Errors, Page};
use crate::point::{AirChange, Point, Stop};
use bake_core::solve::Mode;
use bake_formats::float_image::{FloatImage, PixelFormat, Quantity};
use bake_formats::package::write_atomic;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// One line of `points.csv`: settings, what they took, and how far they lead. Shares of one, seconds.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Row {
    /// Hash of everything that the numbers depend on.
    pub key: String,
    /// Solver of the air.
    pub mode: String,
    /// Samples per texel that were taken on the page with most.
    pub samples: u32,
    /// Standard error asked for.
    pub target: Option<f32>,
    /// Standard error that the bake states, of the page with the largest.
    pub stated_error: f32,
    /// Most reflections; unlimited where empty.
    pub bounces: Option<u32>,
    /// What was done to the air.
    pub air: String,
    /// Cells along a side of the light grid.
    pub cells: Option<u32>,
    /// Walks a node of the light grid.
    pub walks: Option<u32>,
    /// Distances at which tables are read.
    pub bins: Option<usize>,
    /// Degrees below which tables are read.
    pub bands: Option<usize>,
    /// Collisions up to which tables are summed, where that was not left to the scene.
    pub orders: Option<usize>,
    /// Seed.
    pub seed: u32,
    /// Seconds of the bake without loading and layout.
    pub seconds: f64,
    /// Of those, until the first path.
    pub prepare_seconds: f64,
    /// How much longer the slowest of three took, where the bake was brief enough to be repeated.
    pub seconds_spread: f64,
    /// Rays, those for shadows included.
    pub rays: u64,
    /// As in [`Errors`].
    pub bias: f64,
    /// As in [`Errors`].
    pub bias_error: f64,
    /// As in [`Errors`].
    pub rmse: f64,
    /// As in [`Errors`].
    pub noise: f64,
    /// As in [`Errors`].
    pub floor: f64,
    /// As in [`Errors`].
    pub least_floor: f64,
    /// As in [`Errors`].
    pub reference_error: f64,
    /// As in [`Errors`].
    pub texels: usize,
}

impl Row {
    /// Of one measurement.
    pub fn new(key: String, point: &Point, baked: &Baked, spread: f64, errors: &Errors) -> Self {
        let reports = &baked.lightmap.reports;
        let tables = (point.mode == Mode::Tables).then_some(point.tables);
        Self {
            key,
            mode: point.mode.name().into(),
            samples: reports.iter().map(|page| page.samples).max().unwrap_or(0),
            target: if let Stop::Error(target) = point.stop { Some(target) } else { None },
            stated_error: reports.iter().map(|page| page.error).fold(0.0, f32::max),
            bounces: point.bounces,
            air: match point.air {
                AirChange::AsIs => "as set".into(),
                AirChange::None => "none".into(),
                AirChange::Collisions(most) => format!("at most {most} collisions"),
                AirChange::Uniform => "one density".into(),
                AirChange::Scattering(factor) => format!("scattering × {factor}"),
            },
            cells: point.grid.map(|[cells, _]| cells),
            walks: point.grid.map(|[_, walks]| walks),
            bins: tables.map(|tables| tables.bins),
            bands: tables.map(|tables| tables.bands),
            orders: tables.and_then(|tables| tables.orders),
            seed: point.seed,
            seconds: baked.seconds,
            prepare_seconds: baked.prepare_seconds,
            seconds_spread: spread,
            rays: baked.lightmap.rays + baked.lightmap.shadow_rays,
            bias: errors.bias,
            bias_error: errors.bias_error,
            rmse: errors.rmse,
            noise: errors.noise,
            floor: errors.floor,
            least_floor: errors.least_floor,
            reference_error: errors.reference_error,
            texels: errors.texels,
        }
    }

    /// The errors alone.
    pub fn errors(&self) -> Errors {
        Errors {
            bias: self.bias,
            bias_error: self.bias_error,
            rmse: self.rmse,
            noise: self.noise,
            floor: self.floor,
            least_floor: self.least_floor,
            reference_error: self.reference_error,
            texels: self.texels,
        }
    }
}

/// The files of a study.
pub struct Store {
    folder: PathBuf,
    /// Hash of scene, settings and reference, in which keys are rooted.
    subject: String,
    rows: HashMap<String, Row>,
}

impl Store {
    /// Opens a folder, new or with what an earlier study measured.
    ///
    /// # Errors
    /// The folder cannot be made or read, or its table is not one of ours.
    pub fn open(folder: &Path, subject: String) -> Result<Self, StudyError> {
        std::fs::create_dir_all(folder).map_err(StudyError::io(folder))?;
        let mut store = Self { folder: folder.to_owned(), subject, rows: HashMap::new() };
        let path = store.points();
        if path.exists() {
            let text = std::fs::read_to_string(&path).map_err(StudyError::io(&path))?;
            // A killed study may leave half a line.
            let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
            if whole.len() < text.len() {
                write_atomic(&path, |out| out.write_all(whole.as_bytes()))?;
            }
            for row in csv::Reader::from_reader(whole.as_bytes()).deserialize() {
                let row: Row = row.map_err(|error| store.foreign(&error))?;
                store.rows.insert(row.key.clone(), row);
            }
        }
        Ok(store)
    }

    fn foreign(&self, error: &csv::Error) -> StudyError {
        StudyError::Points { path: self.points(), reason: error.to_string() }
    }

    /// The table of points.
    pub fn points(&self) -> PathBuf {
        self.folder.join("points.csv")
    }

    /// A file of the study.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The key of a point.
    pub fn key(&self, point: &Point) -> String {
        let point = serde_json::to_string(point).expect("plain data becomes JSON");
        hash(&[&self.subject, &point])
    }

    /// What was measured of a point.
    pub fn row(&self, point: &Point) -> Option<&Row> {
        self.rows.get(&self.key(point))
    }

    /// Keeps a row, on disk before anything else is done.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn add(&mut self, row: Row) -> Result<(), StudyError> {
        let path = self.points();
        let is_new = !path.exists() || std::fs::metadata(&path).is_ok_and(|data| data.len() == 0);
        let mut writer = csv::WriterBuilder::new().has_headers(is_new).from_writer(Vec::new());
        writer.serialize(&row).map_err(|error| self.foreign(&error))?;
        let line = writer.into_inner().expect("memory takes a line");
        let open = OpenOptions::new().create(true).append(true).open(&path);
        open.and_then(|mut file: File| file.write_all(&line)).map_err(StudyError::io(&path))?;
        self.rows.insert(row.key.clone(), row);
        Ok(())
    }

    /// The reference's pages, if an earlier study left them, and what they took: stored as a row without errors.
    ///
    /// # Errors
    /// A file is there and damaged.
    pub fn reference(&self, point: &Point, pages: usize) -> Result<Option<Vec<Page>>, StudyError> {
        let paths: Vec<PathBuf> = (0..pages).map(|page| self.reference_file(point, page)).collect();
        if self.row(point).is_none() || !paths.iter().all(|path| path.exists()) {
            return Ok(None);
        }
        paths.iter().map(|path| read_page(path)).collect::<Result<_, _>>().map(Some)
    }

    /// Keeps the reference's pages.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn keep_reference(&self, point: &Point, pages: &[Page]) -> Result<(), StudyError> {
        for (index, page) in pages.iter().enumerate() {
            write_page(&self.reference_file(point, index), page)?;
        }
        Ok(())
    }

    fn reference_file(&self, point: &Point, page: usize) -> PathBuf {
        self.folder.join(format!("reference-{}.{page:02}.exr", self.key(point)))
    }
}

/// A page that [`write_page`] wrote.
pub(crate) fn read_page(path: &Path) -> Result<Page, StudyError> {
    let bytes = std::fs::read(path).map_err(StudyError::io(path))?;
    let image = FloatImage::read(path, &bytes)?;
    page_of(&image).ok_or_else(|| StudyError::Points { path: path.to_owned(), reason: "channels are missing".into() })
}

/// Writes a page as an EXR image that loses nothing.
pub(crate) fn write_page(path: &Path, page: &Page) -> Result<(), StudyError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image_of(page).write(path, PixelFormat::F32, &mut bytes)?;
    Ok(write_atomic(path, |out| out.write_all(bytes.get_ref()))?)
}

fn image_of(page: &Page) -> FloatImage {
    let mut image = FloatImage::new(page.width, page.height);
    image.push_rgb("", Quantity::Irradiance, &page.total);
    image.push_rgb("variance", Quantity::IrradianceVariance, &page.variance);
    image.push("validity.Y", Quantity::Validity, page.valid.iter().map(|&valid| f32::from(valid)).collect());
    image
}

fn page_of(image: &FloatImage) -> Option<Page> {
    Some(Page {
        width: image.width,
        height: image.height,
        total: image.rgb::<Vec3>("")?,
        variance: image.rgb::<Vec3>("variance")?,
        valid: image.channel("validity.Y")?.iter().map(|&valid| valid > 0.5).collect(),
    })
}

/// Hash of the program that runs, so that numbers of one build are never taken for those of another; its version where its file
/// cannot be read.
pub fn program() -> &'static str {
    static PROGRAM: OnceLock<String> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let mut hasher = blake3::Hasher::new();
        let read = std::env::current_exe().and_then(File::open).and_then(|file| hasher.update_reader(file).map(drop));
        match read {
            Ok(()) => hasher.finalize().to_hex()[..16].to_owned(),
            Err(_) => env!("CARGO_PKG_VERSION").to_owned(),
        }
    })
}

/// Sixteen hexadecimal digits of the BLAKE3 of parts.
pub fn hash(parts: &[&str]) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    }
    hasher.finalize().to_hex()[..16].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::point::Tables;

    fn point(samples: u32) -> Point {
        Point {
            mode: Mode::Walk,
            stop: Stop::Samples(samples),
            bounces: None,
            air: AirChange::AsIs,
            grid: None,
            tables: Tables::default(),
            seed: 0,
        }
    }

    fn row(store: &Store, samples: u32) -> Row {
        let lightmap =
            bake_core::solve::Lightmap { pages: vec![], reports: vec![], rays: 1, shadow_rays: 2, cut_paths: 0 };
        let baked = Baked { lightmap, prepare_seconds: 0.0, seconds: 0.1 };
        Row::new(
            store.key(&point(samples)),
            &point(samples),
            &baked,
            0.0,
            &Errors { rmse: 0.1 + 0.2, ..Errors::default() },
        )
    }

    #[test]
    fn rows_come_back_to_the_last_bit_and_only_for_the_same_subject() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut store = Store::open(folder.path(), "a".into()).expect("opens");
        let rows = [8, 16].map(|samples| row(&store, samples));
        rows.iter().for_each(|row| store.add(row.clone()).expect("written"));
        let again = Store::open(folder.path(), "a".into()).expect("opens");
        assert_eq!([8, 16].map(|samples| again.row(&point(samples)).cloned()), rows.map(Some));
        assert_eq!(again.row(&point(32)), None);
        assert_eq!(Store::open(folder.path(), "b".into()).expect("opens").row(&point(8)), None);
    }

    #[test]
    fn half_a_line_of_a_killed_study_is_dropped_and_the_next_one_is_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut store = Store::open(folder.path(), "a".into()).expect("opens");
        store.add(row(&store, 8)).expect("written");
        let mut text = std::fs::read_to_string(store.points()).expect("read");
        text.push_str("0123456789abcdef,walk,1");
        std::fs::write(store.points(), text).expect("written");
        let mut store = Store::open(folder.path(), "a".into()).expect("opens");
        assert!(store.row(&point(8)).is_some());
        store.add(row(&store, 16)).expect("written");
        let store = Store::open(folder.path(), "a".into()).expect("opens");
        assert!(store.row(&point(16)).is_some());
    }

    #[test]
    fn a_table_of_another_kind_is_refused_with_the_next_step() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("points.csv"), "a,b\n1,2\n").expect("written");
        let message = Store::open(folder.path(), "a".into()).err().expect("refused").to_string();
        assert!(message.contains("points.csv") && message.contains("-o"), "{message}");
    }

    #[test]
    fn the_program_is_told_by_its_own_bytes() {
        let own = std::fs::read(std::env::current_exe().expect("it runs")).expect("it can be read");
        assert_eq!(program(), &blake3::hash(&own).to_hex()[..16]);
    }

    #[test]
    fn pages_come_back_as_they_were() {
        let page = Page {
            width: 2,
            height: 1,
            total: vec![Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO],
            variance: vec![Vec3::splat(1e-9), Vec3::ZERO],
            valid: vec![true, false],
        };
        assert_eq!(page_of(&image_of(&page)), Some(page));
    }
}
