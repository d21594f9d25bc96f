//! All tables together, as read from a file.

use std::sync::OnceLock;

use bake_formats::table_file::{TableFile, TableFileError};

use crate::axial::{ALL_DEGREES, HARMONIC_COUNT, HARMONICS};
use crate::curves::{Curves, Shape};
use crate::fitted::Criterion;
use crate::recipe::{Layout, MOST_BANDS, Recipe};
use crate::{axial, directional, fitted, generate, point, resample};

/// The tables that every file holds, in file order.
pub const NAMES: [&str; 9] = [
    "point.single",
    "point.orders",
    "point.all",
    "directional.single",
    "directional.orders",
    "directional.all",
    "area.single",
    "axial.orders",
    "axial.all",
];

/// Which collisions a response counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatter {
    /// Exactly one.
    Single,
    /// From two up to this many; at most as many as the tables hold.
    Multiple(usize),
    /// Exactly so many, from two on: for study, a bake needs only sums.
    Order(usize),
    /// Two or more, without end.
    AllMultiple,
}

/// Tables as read from a file, refined to the grid that is looked up.
#[derive(Debug, Clone)]
pub struct TableSet {
    recipe: Recipe,
    /// In the order of [`NAMES`].
    tables: Vec<Curves>,
}

impl TableSet {
    /// The set that is part of the program.
    pub fn embedded() -> &'static Self {
        static SET: OnceLock<TableSet> = OnceLock::new();
        SET.get_or_init(|| {
            let file = TableFile::from_bytes(EMBEDDED, "embedded tables").expect("checked by the tests of this crate");
            Self::from_file(&file).expect("checked by the tests of this crate")
        })
    }

    /// A set with at least so many zonal bands: that of the program up to its 11; beyond, the same with 16 bands of point and directional
    /// light. Those are made when they are first asked for, which takes some seconds of one processor. Areas and lamps keep their
    /// fourteen harmonics, l ≤ 8.
    pub fn with_bands(bands: usize) -> &'static Self {
        static WIDE: OnceLock<TableSet> = OnceLock::new();
        if bands <= Self::embedded().recipe.bands {
            return Self::embedded();
        }
        WIDE.get_or_init(|| {
            let recipe = Recipe { bands: MOST_BANDS, ..Self::embedded().recipe };
            let zonal = generate::zonal_tables(&recipe);
            let mut tables: Vec<_> = zonal.iter().map(|t| resample::distances(t, recipe.read_grid())).collect();
            tables.extend_from_slice(&Self::embedded().tables[tables.len()..]);
            Self { recipe, tables }
        })
    }

    /// The tables as published in 2019: once-scattered light of three phase functions, that of areas about a fitted axis. Made when
    /// they are first asked for, which takes some seconds of one processor.
    pub fn published() -> &'static Self {
        static SET: OnceLock<TableSet> = OnceLock::new();
        SET.get_or_init(|| {
            let recipe = Recipe { layout: Layout::Paper, ..Self::embedded().recipe };
            let (basis, Recipe { grid, bands, .. }) = (recipe.basis(), recipe);
            let mut set = Self { recipe, tables: Self::embedded().tables.clone() };
            for (name, curves) in [
                ("point.single", point::store_single(grid, &basis, bands)),
                ("directional.single", directional::store_single(grid, &basis, bands)),
                ("area.single", fitted::store_single(grid, Criterion::Radiance)),
            ] {
                let index = NAMES.iter().position(|n| *n == name).expect("one of the names");
                set.tables[index] = resample::distances(&curves, recipe.read_grid());
            }
            set
        })
    }

    /// From a file.
    pub fn from_file(file: &TableFile) -> Result<Self, TableFileError> {
        let fault = |field: &str, problem: String| TableFileError::Inconsistent {
            origin: "table file".to_owned(),
            field: field.to_owned(),
            problem,
        };
        let recipe: Recipe =
            serde_json::from_value(file.manifest.recipe.clone()).map_err(|error| fault("recipe", error.to_string()))?;
        if let Some(problem) = recipe.fault() {
            return Err(fault("recipe", problem));
        }
        let names: Vec<_> = file.manifest.tables.iter().map(|t| t.name.as_str()).collect();
        if names != NAMES {
            return Err(fault("tables", format!("found {names:?}, expected {NAMES:?}")));
        }
        let mut tables = Vec::new();
        for ((entry, values), columns) in file.manifest.tables.iter().zip(&file.values).zip(column_counts(&recipe)) {
            let shape: Shape =
                serde_json::from_value(entry.details.clone()).map_err(|error| fault(&entry.name, error.to_string()))?;
            if entry.rows != Curves::rows(&recipe.grid) || entry.columns != columns {
                let problem = format!("{} × {} values do not fit the recipe", entry.rows, entry.columns);
                return Err(fault(&entry.name, problem));
            }
            let curves = Curves { grid: recipe.grid, shape, columns, values: values.clone() };
            tables.push(resample::distances(&curves, recipe.read_grid()));
        }
        Ok(Self { recipe, tables })
    }

    /// The same read at `bins` ≥ 16 distances and cut to degrees l < `bands`: what less memory costs. (Tables of an actual phase
    /// function keep their own distances and degrees.)
    pub fn reduced(&self, bins: usize, bands: usize) -> Self {
        let recipe = Recipe { read_bins: bins.max(16), ..self.recipe };
        let reduce = |(name, curves): (&&str, &Curves)| {
            let mut curves = resample::distances(curves, recipe.read_grid());
            let columns = curves.columns;
            let degrees: Vec<usize> = (0..columns).map(|column| self.degree(name, column)).collect();
            curves.values.chunks_exact_mut(columns).for_each(|row| {
                row.iter_mut().zip(&degrees).filter(|(_, l)| **l >= bands).for_each(|(value, _)| *value = 0.0);
            });
            curves
        };
        Self { recipe, tables: NAMES.iter().zip(&self.tables).map(reduce).collect() }
    }

    /// Degree of a column of one of [`NAMES`].
    fn degree(&self, name: &str, column: usize) -> usize {
        let fitted = self.recipe.layout.criterion().is_some();
        match name {
            "area.single" if fitted => (column % fitted::COLUMNS) % fitted::BANDS,
            "area.single" => HARMONICS[column % HARMONIC_COUNT].0,
            "axial.orders" | "axial.all" => {
                let curves = axial::curves(&ALL_DEGREES);
                HARMONICS[curves[column % curves.len()].0].0
            }
            _ => column % self.recipe.bands,
        }
    }

    /// The recipe behind the set.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The curves of one of [`NAMES`], on the grid that is read. Panics on another name.
    pub fn table(&self, name: &str) -> &Curves {
        &self.tables[NAMES.iter().position(|n| *n == name).unwrap_or_else(|| panic!("no table {name}"))]
    }
}

/// The default file, made by `bake tables generate`.
const EMBEDDED: &[u8] = include_bytes!("../data/default.tables");

/// The bytes of the embedded file.
pub fn embedded_bytes() -> &'static [u8] {
    EMBEDDED
}

/// Columns of each of [`NAMES`].
fn column_counts(recipe: &Recipe) -> [usize; 9] {
    let (bands, legendre, higher) = (recipe.bands, recipe.basis().len(), recipe.scatter_orders - 1);
    let curves = axial::curves(&ALL_DEGREES).len();
    [
        bands * legendre,
        bands * higher,
        bands,
        bands * legendre,
        bands * higher,
        bands,
        match recipe.layout.criterion() {
            None => recipe.angles.nodes * HARMONIC_COUNT * legendre,
            Some(_) => fitted::ANGLES * fitted::COLUMNS * legendre,
        },
        curves * higher,
        curves,
    ]
}
