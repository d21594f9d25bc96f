//! All tables together: generated from a recipe, kept in a file, prepared for a medium.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use bake_formats::table_file::{Precision, TableEntry, TableFile, TableFileError, TableManifest};
use bake_optics::harmonics::clamped_cosine;
use bake_optics::phase::Phase;

use crate::axial::{ALL_DEGREES, HARMONIC_COUNT, HARMONICS};
use crate::curves::{Curves, Grid, Shape};
use crate::fitted::FittedResponse;
use crate::node::Node;
use crate::recipe::Recipe;
use crate::remap::Air;
use crate::resample;
use crate::response::{AxialResponse, ZonalResponse};
use crate::rgb::AxialRgb;
use crate::transport::harmonics::stripped_legendre;
use crate::transport::phase_basis::PhaseBasis;
use crate::transport::slab::SlabSource;
use crate::transport::sources::{EMITTER_DEGREES, Source};
use crate::{accuracy, area, axial, directional, fitted, point};

/// Moments beyond the tables above this, |g|^20 at g = 0.67, ask for a table of the actual phase function: at 0.8 the series
/// would be wrong by 1.6 % for a point light and by 40 % for a surface that faces away, of the l = 0 coefficient.
const LEFT_OUT_MOMENT: f64 = 3.3e-4;

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

/// Progress of [`generate`]: share done, 0 … 1, and what is being made.
pub type Progress<'a> = &'a (dyn Fn(f64, &str) + Sync);

/// The tables of a recipe as computed, on the stored grid, in the order of [`NAMES`]. Deterministic.
pub fn compute_tables(recipe: &Recipe, progress: Progress) -> Vec<Curves> {
    let Recipe { grid, bands, scatter_orders, all_orders_albedo: albedo, .. } = *recipe;
    let basis = recipe.basis();
    progress(0.0, "sources");
    let sources: Vec<Source> = (1..scatter_orders).map(Source::order).collect();
    let all = Source::all(albedo);
    let slabs = slab_sources(scatter_orders);
    let slab_all = SlabSource::all(albedo);
    progress(0.2, "point");
    let all_point = Shape::POINT_MULTIPLE.all_orders(all.rate);
    let all_slab = Shape::DIRECTIONAL.all_orders(slab_all.rate);
    let point_orders: Vec<_> =
        sources.iter().map(|s| point::store_multiple(grid, Shape::POINT_MULTIPLE, s, 1.0, bands)).collect();
    let mut tables = vec![
        point::store_single(grid, &basis, bands),
        side_by_side(&point_orders),
        point::store_multiple(grid, all_point, &all, albedo, bands),
    ];
    progress(0.4, "directional");
    let slab_orders: Vec<_> =
        slabs.iter().map(|s| directional::store_multiple(grid, Shape::DIRECTIONAL, s, 1.0, bands)).collect();
    tables.push(directional::store_single(grid, &basis, bands));
    tables.push(side_by_side(&slab_orders));
    tables.push(directional::store_multiple(grid, all_slab, &slab_all, albedo, bands));
    progress(0.55, "area");
    tables.push(match recipe.layout.criterion() {
        None => area::store_single(grid, recipe.angles, &basis),
        Some(criterion) => fitted::store_single(grid, criterion),
    });
    progress(0.75, "axial");
    tables.push(axial::store_multiple(grid, Shape::POINT_MULTIPLE, &sources, 1.0));
    tables.push(axial::store_multiple(grid, all_point, &[all], albedo));
    progress(1.0, "done");
    tables
}

/// Sources of directional orders 2 … `orders`.
pub(crate) fn slab_sources(orders: usize) -> Vec<SlabSource> {
    (1..orders).fold(Vec::new(), |mut sources, _| {
        sources.push(SlabSource::order(sources.last()));
        sources
    })
}

/// Tables of equal grid and shape as one.
fn side_by_side(tables: &[Curves]) -> Curves {
    let first = &tables[0];
    let rows = Curves::rows(&first.grid);
    let values = (0..rows).flat_map(|row| tables.iter().flat_map(move |t| t.row(row).iter().copied())).collect();
    Curves { columns: tables.iter().map(|t| t.columns).sum(), values, ..*first }
}

/// A whole file: computed, rounded, and its look-up measured against direct evaluation.
pub fn generate(recipe: &Recipe, progress: Progress) -> TableFile {
    let tables = compute_tables(recipe, &|share, what| progress(0.8 * share, what));
    let mut file = to_file(recipe, &tables);
    let set = TableSet::from_file(&file).expect("what was just made");
    progress(0.8, "measuring look-up");
    let errors = accuracy::measure(&set, accuracy::SAMPLES);
    file.manifest.tables.iter_mut().zip(errors).for_each(|(entry, error)| entry.look_up_error = error);
    progress(1.0, "done");
    file
}

/// A file of tables; errors of look-up still 0.
pub fn to_file(recipe: &Recipe, tables: &[Curves]) -> TableFile {
    let entries = NAMES.iter().zip(tables).map(|(name, curves)| entry(name, recipe, curves));
    let units = [
        ("distance", "1 (optical: sigma_t d)"),
        ("point", "W/(m² sr) per W/sr, at sigma_t = sigma_s = 1/m"),
        ("directional", "W/(m² sr) per W/m²"),
        ("area", "W/(m² sr) per W/sr on the emitter's axis"),
        ("look_up_error", "1 (of the l = 0 coefficient)"),
    ];
    let manifest = TableManifest {
        made_by: concat!("tables ", env!("CARGO_PKG_VERSION")).to_owned(),
        recipe: serde_json::to_value(recipe).expect("plain values"),
        units: units.into_iter().map(|(a, b)| (a.to_owned(), b.to_owned())).collect::<BTreeMap<_, _>>(),
        tables: entries.collect(),
    };
    let file = TableFile { manifest, values: tables.iter().map(|t| t.values.clone()).collect() };
    // Through the bytes once, so that the numbers in memory are those that a reader will see.
    TableFile::from_bytes(&file.to_bytes(), "memory").expect("what was just written")
}

fn entry(name: &str, recipe: &Recipe, curves: &Curves) -> TableEntry {
    let precision = match (name, recipe.precision) {
        ("point.single" | "directional.single", _) => Precision::F32,
        // Twenty Legendre tables add up to a number a hundred times smaller where the emitter faces away.
        ("area.single", Precision::F16) => Precision::F24,
        (_, precision) => precision,
    };
    let largest = curves.values.iter().fold(f32::MIN_POSITIVE, |m, v| m.max(v.abs()));
    TableEntry {
        name: name.to_owned(),
        meaning: "coefficient times e^(rate d), times d where inverse_distance; rows: d = 0, nodes, d = infinity"
            .to_owned(),
        rows: Curves::rows(&curves.grid),
        columns: curves.columns,
        precision,
        // The largest value lands at 2^14 … 2^15: as far from underflow of f16 as can be.
        scale: (largest.log2().ceil() - 15.0).exp2(),
        look_up_error: 0.0,
        details: serde_json::to_value(curves.shape).expect("plain values"),
    }
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

    /// The recipe behind the set.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The curves of one of [`NAMES`], on the grid that is read. Panics on another name.
    pub fn table(&self, name: &str) -> &Curves {
        &self.tables[NAMES.iter().position(|n| *n == name).unwrap_or_else(|| panic!("no table {name}"))]
    }

    /// Response of a medium to a point light.
    pub fn point(&self, air: &Air, scatter: Scatter) -> ZonalResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        match scatter {
            Scatter::Single => match self.own_basis(&air.phase) {
                Some(basis) => self.zonal(&point::store_single(self.grid(), &basis, self.recipe.bands), &[albedo]),
                None => self.zonal(self.table("point.single"), &self.recipe.weights(air)),
            },
            Scatter::Multiple(up_to) => self.zonal(self.table("point.orders"), &self.order_weights(albedo, up_to)),
            Scatter::AllMultiple if self.stored_all(albedo) => self.zonal(self.table("point.all"), &[1.0]),
            Scatter::AllMultiple => {
                let source = Source::all(albedo.max(SMALLEST_ALBEDO));
                let shape = Shape::POINT_MULTIPLE.all_orders(source.rate);
                self.zonal(&point::store_multiple(self.grid(), shape, &source, albedo, self.recipe.bands), &[1.0])
            }
        }
    }

    /// Response of a medium to directional light that enters it perpendicularly to its boundary.
    pub fn directional(&self, air: &Air, scatter: Scatter) -> ZonalResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        match scatter {
            Scatter::Single => match self.own_basis(&air.phase) {
                Some(basis) => {
                    self.zonal(&directional::store_single(self.grid(), &basis, self.recipe.bands), &[albedo])
                }
                None => self.zonal(self.table("directional.single"), &self.recipe.weights(air)),
            },
            Scatter::Multiple(up_to) => {
                self.zonal(self.table("directional.orders"), &self.order_weights(albedo, up_to))
            }
            Scatter::AllMultiple if self.stored_all(albedo) => self.zonal(self.table("directional.all"), &[1.0]),
            Scatter::AllMultiple => {
                let source = SlabSource::all(albedo.max(SMALLEST_ALBEDO));
                let shape = Shape::DIRECTIONAL.all_orders(source.rate);
                self.zonal(&directional::store_multiple(self.grid(), shape, &source, albedo, self.recipe.bands), &[1.0])
            }
        }
    }

    /// Response of a medium to a small Lambertian surface element.
    pub fn area(&self, air: &Air, scatter: Scatter) -> AxialResponse {
        match scatter {
            Scatter::Single => self.area_single(&air.phase).scaled(air.albedo),
            _ => self.axial(&cosine_legendre(), air, scatter),
        }
    }

    /// The same for the channels of one medium, which share a table where that is the same.
    pub fn area_rgb(&self, airs: &[Air; 3], scatter: Scatter) -> AxialRgb {
        let [first, others @ ..] = airs;
        if scatter == Scatter::Single && others.iter().all(|air| air.phase == first.phase) {
            let shared = self.area_single(&first.phase);
            return AxialRgb::new(airs.each_ref().map(|air| shared.scaled(air.albedo)));
        }
        AxialRgb::new(airs.each_ref().map(|air| self.area(air, scatter)))
    }

    /// Response of a medium to a small Lambertian surface element, light scattered once, about a fitted axis; `None` unless the
    /// layout is one of those.
    pub fn fitted_area(&self, air: &Air) -> Option<FittedResponse> {
        self.recipe.layout.criterion()?;
        let (curves, weights) = (self.table("area.single"), self.recipe.weights(air));
        let rows = weighted_rows(curves, &weights, fitted::ANGLES * fitted::COLUMNS);
        // The tilt takes the weights of the phase function only.
        let rows = rows.map(|mut row| {
            row.chunks_exact_mut(fitted::COLUMNS).for_each(|node| node[fitted::BANDS] /= air.albedo.max(1e-30));
            row
        });
        Some(FittedResponse::new(&curves.grid, curves.shape, rows))
    }

    /// Response of a medium to an emitter whose intensity is `Σ c_l P_l(cos)` about its axis, l ≤ 16, light scattered twice or more.
    /// (Once-scattered light of such an emitter needs its real distribution and visibility: the estimator of the bake.)
    /// `Scatter::Single` gives an empty response.
    pub fn axial(&self, legendre: &[f64], air: &Air, scatter: Scatter) -> AxialResponse {
        let albedo = air.albedo.clamp(0.0, 1.0);
        match scatter {
            Scatter::Single => self.axial_of(self.table("axial.orders"), &[], legendre),
            Scatter::Multiple(up_to) => {
                self.axial_of(self.table("axial.orders"), &self.order_weights(albedo, up_to), legendre)
            }
            Scatter::AllMultiple if self.stored_all(albedo) => self.axial_of(self.table("axial.all"), &[1.0], legendre),
            Scatter::AllMultiple => {
                let source = Source::all(albedo.max(SMALLEST_ALBEDO));
                let shape = Shape::POINT_MULTIPLE.all_orders(source.rate);
                self.axial_of(&axial::store_multiple(self.grid(), shape, &[source], albedo), &[1.0], legendre)
            }
        }
    }

    fn grid(&self) -> Grid {
        self.recipe.read_grid()
    }

    fn stored_all(&self, albedo: f64) -> bool {
        (albedo - self.recipe.all_orders_albedo).abs() < 1e-6
    }

    /// α² … α^up_to.
    fn order_weights(&self, albedo: f64, up_to: usize) -> Vec<f64> {
        (2..=up_to.min(self.recipe.scatter_orders)).map(|k| albedo.powi(k as i32)).collect()
    }

    /// The actual phase function where its Legendre orders in the tables do not suffice.
    fn own_basis(&self, phase: &Phase<f64>) -> Option<PhaseBasis> {
        if self.recipe.layout.criterion().is_some() {
            return None;
        }
        let beyond = (self.recipe.legendre_orders..self.recipe.legendre_orders + 24)
            .any(|l| phase.moment(l).abs() > LEFT_OUT_MOMENT);
        beyond.then(|| PhaseBasis::Functions(vec![phase.clone()]))
    }

    /// `Σ_i weight_i × block i` of every row; blocks of `bands` columns.
    fn zonal(&self, curves: &Curves, weights: &[f64]) -> ZonalResponse {
        let bands = self.recipe.bands;
        let rows = weighted_rows(curves, weights, bands).map(|row| row.iter().map(|&v| v as f32).collect::<Vec<_>>());
        ZonalResponse::new(&curves.grid, curves.shape, bands, rows.flatten().collect())
    }

    /// Light of an area scattered once, albedo 1.
    fn area_single(&self, phase: &Phase<f64>) -> AxialResponse {
        let air = Air { albedo: 1.0, phase: phase.clone() };
        if self.recipe.layout.criterion().is_some() {
            return self.area_from_fitted(&air);
        }
        match self.own_basis(phase) {
            Some(basis) => self.area_of(&area::store_single(self.grid(), self.recipe.angles, &basis), &[1.0]),
            None => self.area_of(self.table("area.single"), &self.recipe.weights(&air)),
        }
    }

    fn area_of(&self, curves: &Curves, weights: &[f64]) -> AxialResponse {
        let (stored, read) = (self.recipe.angles, area::AngleGrid { nodes: self.recipe.read_angles });
        let rows = weighted_rows(curves, weights, stored.nodes * HARMONIC_COUNT).flat_map(|row| {
            let nodes: Vec<[f64; HARMONIC_COUNT]> =
                row.chunks_exact(HARMONIC_COUNT).map(|c| std::array::from_fn(|h| c[h])).collect();
            resample::angles(&nodes, (0..read.nodes).map(|i| stored.index(read.cosine(i as f64))))
        });
        AxialResponse::new(&curves.grid, curves.shape, read.nodes, rows.map(|v| Node::new(&v)).collect())
    }

    /// The fitted functions as mirror-symmetric harmonics, so that a bake can be made with either layout. Albedo 1.
    fn area_from_fitted(&self, air: &Air) -> AxialResponse {
        let (curves, weights) = (self.table("area.single"), self.recipe.weights(air));
        let read = area::AngleGrid { nodes: self.recipe.read_angles };
        let rows = weighted_rows(curves, &weights, fitted::ANGLES * fitted::COLUMNS).flat_map(|row| {
            let at_node = |i: usize| match read.cosine(i as f64) {
                cos if cos < 0.0 => Node::new(&[0.0; HARMONIC_COUNT]),
                cos => Node::new(&fitted::stripped(&row, cos.min(1.0).acos())),
            };
            (0..read.nodes).map(at_node).collect::<Vec<_>>()
        });
        AxialResponse::new(&curves.grid, curves.shape, read.nodes, rows.collect())
    }

    fn axial_of(&self, curves: &Curves, weights: &[f64], legendre: &[f64]) -> AxialResponse {
        let read = area::AngleGrid { nodes: self.recipe.read_angles };
        let list = axial::curves(&ALL_DEGREES);
        let at_nodes: Vec<[[f64; EMITTER_DEGREES]; 5]> = (0..read.nodes)
            .map(|i| std::array::from_fn(|m| emitter_lanes(m, read.cosine(i as f64), legendre)))
            .collect();
        let rows = weighted_rows(curves, weights, list.len()).flat_map(|row| {
            let at_node = |lanes: &[[f64; EMITTER_DEGREES]; 5]| {
                let mut sum = [0.0; HARMONIC_COUNT];
                list.iter().zip(&row).for_each(|(&(h, degree), g)| sum[h] += lanes[HARMONICS[h].1][degree] * g);
                Node::new(&sum)
            };
            at_nodes.iter().map(at_node).collect::<Vec<_>>()
        });
        AxialResponse::new(&curves.grid, curves.shape, read.nodes, rows.collect())
    }
}

/// Below this albedo a sum over all orders is that of this albedo.
const SMALLEST_ALBEDO: f64 = 1e-3;

/// The default file, made by `bake tables generate`.
const EMBEDDED: &[u8] = include_bytes!("../data/default.tables");

/// The bytes of the embedded file.
pub fn embedded_bytes() -> &'static [u8] {
    EMBEDDED
}

/// Legendre coefficients of the clamped cosine, `A_l (2l+1)/(4π)`: ¼, ½, 5/16, 0, −3/32 …
pub fn cosine_legendre() -> Vec<f64> {
    let a = clamped_cosine::<f64>(EMITTER_DEGREES);
    a.iter().enumerate().map(|(l, a)| a * (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI)).collect()
}

/// `c_l' P̄_l'^m(c)/sin^m θ` for all degrees.
fn emitter_lanes(m: usize, cos: f64, legendre: &[f64]) -> [f64; EMITTER_DEGREES] {
    let mut lanes = [0.0; EMITTER_DEGREES];
    stripped_legendre(m, cos, &mut lanes);
    lanes.iter_mut().enumerate().for_each(|(l, lane)| *lane *= legendre.get(l).copied().unwrap_or(0.0));
    lanes
}

/// Per row the weighted sum of its blocks of `width` columns.
fn weighted_rows<'a>(curves: &'a Curves, weights: &'a [f64], width: usize) -> impl Iterator<Item = Vec<f64>> + 'a {
    (0..Curves::rows(&curves.grid)).map(move |row| {
        let mut sum = vec![0.0; width];
        for (block, w) in curves.row(row).chunks_exact(width).zip(weights) {
            sum.iter_mut().zip(block).for_each(|(s, &v)| *s += w * f64::from(v));
        }
        sum
    })
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
