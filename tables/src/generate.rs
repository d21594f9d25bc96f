//! From a recipe to a table file: everything computed, rounded, and its look-up measured.

use std::collections::BTreeMap;

use bake_formats::table_file::{Precision, TableEntry, TableFile, TableManifest};

use crate::curves::{Curves, Shape};
use crate::recipe::Recipe;
use crate::set::{NAMES, TableSet};
use crate::transport::slab::SlabSource;
use crate::transport::sources::Source;
use crate::{accuracy, area, axial, directional, fitted, point};

/// Progress of [`generate`]: share done, 0 … 1, and what is being made.
pub type Progress<'a> = &'a (dyn Fn(f64, &str) + Sync);

/// The tables of a recipe as computed, on the stored grid, in the order of [`NAMES`]. Deterministic.
pub fn compute_tables(recipe: &Recipe, progress: Progress) -> Vec<Curves> {
    let Recipe { grid, scatter_orders, all_orders_albedo: albedo, .. } = *recipe;
    progress(0.0, "sources");
    let sources: Vec<Source> = (1..scatter_orders).map(Source::order).collect();
    let all = Source::all(albedo);
    progress(0.2, "point");
    let mut tables = point_tables(recipe, &sources, &all).to_vec();
    progress(0.4, "directional");
    tables.extend(directional_tables(recipe));
    progress(0.55, "area");
    tables.push(match recipe.layout.criterion() {
        None => area::store_single(grid, recipe.angles, &recipe.basis()),
        Some(criterion) => fitted::store_single(grid, criterion),
    });
    progress(0.75, "axial");
    let all_shape = Shape::POINT_MULTIPLE.all_orders(all.rate);
    tables.push(axial::store_multiple(grid, Shape::POINT_MULTIPLE, &sources, 1.0));
    tables.push(axial::store_multiple(grid, all_shape, &[all], albedo));
    progress(1.0, "done");
    tables
}

/// Those whose bands the recipe chooses: the first six of [`NAMES`].
pub(crate) fn zonal_tables(recipe: &Recipe) -> Vec<Curves> {
    let sources: Vec<Source> = (1..recipe.scatter_orders).map(Source::order).collect();
    let point = point_tables(recipe, &sources, &Source::all(recipe.all_orders_albedo));
    point.into_iter().chain(directional_tables(recipe)).collect()
}

/// Light of a point light: scattered once, by orders from two on, and all of them.
fn point_tables(recipe: &Recipe, sources: &[Source], all: &Source) -> [Curves; 3] {
    let Recipe { grid, bands, all_orders_albedo: albedo, .. } = *recipe;
    let order = |source| point::store_multiple(grid, Shape::POINT_MULTIPLE, source, 1.0, bands);
    let shape = Shape::POINT_MULTIPLE.all_orders(all.rate);
    [
        point::store_single(grid, &recipe.basis(), bands),
        side_by_side(&sources.iter().map(order).collect::<Vec<_>>()),
        point::store_multiple(grid, shape, all, albedo, bands),
    ]
}

/// Directional light, the same.
fn directional_tables(recipe: &Recipe) -> [Curves; 3] {
    let Recipe { grid, bands, all_orders_albedo: albedo, .. } = *recipe;
    let all = SlabSource::all(albedo);
    let order = |source| directional::store_multiple(grid, Shape::DIRECTIONAL, source, 1.0, bands);
    let shape = Shape::DIRECTIONAL.all_orders(all.rate);
    [
        directional::store_single(grid, &recipe.basis(), bands),
        side_by_side(&slab_sources(recipe.scatter_orders).iter().map(order).collect::<Vec<_>>()),
        directional::store_multiple(grid, shape, &all, albedo, bands),
    ]
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
    let tables = compute_tables(recipe, &|share, what| progress(0.4 * share, what));
    let mut file = to_file(recipe, &tables);
    let set = TableSet::from_file(&file).expect("what was just made");
    let bounds = accuracy::bounds(&set, &|share, what| progress(0.4 + 0.6 * share, &format!("measuring {what}")));
    file.manifest.tables.iter_mut().zip(bounds).for_each(|(entry, bound)| entry.look_up_error = bound);
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
        // Twenty Legendre orders, or seventeen degrees of an emitter, add up to a number a hundred times smaller where it faces away.
        ("area.single" | "axial.orders" | "axial.all", Precision::F16) => Precision::F24,
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
