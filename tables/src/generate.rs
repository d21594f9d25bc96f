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
