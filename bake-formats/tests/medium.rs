//! Media through their manifest records and back.

use bake_formats::MediumRecord;
use bake_formats::error::FormatError;
use bake_formats::medium::density_image;
use bake_optics::medium::grid::DensityGrid;
use bake_optics::medium::mesh::ClosedMesh;
use bake_optics::medium::{Bounds, Density, Medium, Ray, Scatter};
use bake_optics::phase::Phase;
use glam::{DAffine3, DVec3, DVec4, IVec3};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

fn tetrahedron() -> ClosedMesh {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    ClosedMesh::new(&positions, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).expect("closed")
}

fn media() -> Vec<Medium> {
    let scatter = Scatter { sigma_s: [0.5, 0.25, 0.125], sigma_a: [0.0, 0.5, 1.0] };
    let grid = DensityGrid::new(
        IVec3::new(2, 3, 4),
        (0..24).map(|i| i as f32).collect(),
        DAffine3::from_scale(DVec3::splat(0.5)),
    );
    let table = Phase::from_table(vec![0.0, 1.0, std::f64::consts::PI], vec![4.0, 2.0, 1.0]).expect("valid");
    let bounds = [
        Bounds::Unbounded,
        Bounds::Box { min: DVec3::ZERO, max: DVec3::ONE },
        Bounds::Sphere { centre: DVec3::X, radius: 2.0 },
        Bounds::Hull(Arc::from([DVec4::new(1.0, 0.0, 0.0, 1.0), DVec4::new(-1.0, 0.0, 0.0, 1.0)])),
        Bounds::Mesh(Arc::new(tetrahedron())),
        Bounds::Unbounded,
    ];
    let densities = [
        Density::Exponential { base_m: 0.5, scale_height_m: 2.0 },
        Density::Uniform,
        Density::Linear { zero_m: -1.0, slope_per_m: 0.25 },
        Density::Planet { centre: DVec3::NEG_Y, radius_m: 1.0, scale_height_m: 2.0 },
        Density::Uniform,
        Density::Grid(Arc::new(grid.expect("valid"))),
    ];
    let phases = [
        Phase::Isotropic,
        Phase::Rayleigh,
        Phase::HenyeyGreenstein { g: 0.5 },
        Phase::Linear { a1: -0.5 },
        Phase::Legendre(vec![1.0, 0.5, 0.25]),
        table,
    ];
    let parts = bounds.into_iter().zip(densities).zip(phases);
    parts.map(|((bounds, density), phase)| Medium { bounds, density, scatter, phase }).collect()
}

/// Through JSON text and back.
fn reopened(medium: &Medium) -> Result<Medium, FormatError> {
    let image = density_image(&medium.density);
    let record = MediumRecord::new("haze", medium, image.as_ref().map(|_| "room.medium.00.exr".into()));
    let text = serde_json::to_string(&record).expect("JSON");
    let record: MediumRecord = serde_json::from_str(&text).expect("its own text");
    record.medium(Path::new("room.bake.json"), |file| {
        assert_eq!(file, "room.medium.00.exr");
        Ok(image.expect("asked for a grid only"))
    })
}

#[test]
fn every_kind_comes_back() {
    for medium in media() {
        let back = reopened(&medium).expect("valid");
        assert_eq!((&back.density, &back.scatter), (&medium.density, &medium.scatter));
        // A tree over triangles may order them anew.
        if !matches!(medium.bounds, Bounds::Mesh(_)) {
            assert_eq!(back.bounds, medium.bounds);
        }
        for i in 0..20 {
            let ray = Ray::between(DVec3::new(-1.0, 0.3, 0.2 + 0.01 * f64::from(i)), DVec3::new(2.0, 0.1, 0.2));
            assert_eq!(back.bounds.intervals(&ray), medium.bounds.intervals(&ray));
            let cos = 1.0 - 0.1 * f64::from(i);
            assert!((back.phase.eval(cos) - medium.phase.eval(cos)).abs() < 1e-15);
        }
    }
}

#[test]
fn grids_too_wide_for_an_image_are_left_out_and_refused_by_name() {
    let size = IVec3::new(512, 1, 129);
    let grid = DensityGrid::new(size, vec![1.0; 512 * 129], DAffine3::IDENTITY).expect("valid");
    let medium = Medium { density: Density::Grid(Arc::new(grid)), ..Medium::default() };
    assert!(density_image(&medium.density).is_none());
    let message = reopened(&medium).expect_err("not stored").to_string();
    assert!(message.contains("haze") && message.contains("not stored"), "{message}");
}

#[test]
fn damaged_records_are_refused() {
    let good = serde_json::to_value(MediumRecord::new("haze", &media()[1], None)).expect("JSON");
    let wrong: [(&str, Value); 7] = [
        ("scatter", json!({"Sigma": {"s": [-1.0, 0.0, 0.0], "a": [0.0, 0.0, 0.0]}})),
        ("bounds", json!({"Box": {"min": [1.0, 0.0, 0.0], "max": [0.0, 1.0, 1.0]}})),
        ("bounds", json!({"Mesh": {"positions": [], "triangles": [[0, 1, 2]]}})),
        ("bounds", json!({"Hull": {"planes": [[0.0, 0.0, 0.0, 1.0]]}})),
        ("density", json!({"Exponential": {"base_m": 0.0, "scale_height_m": 0.0}})),
        ("phase", json!({"HenyeyGreenstein": 1.0})),
        ("phase", json!({"Table": {"angles": [0.0], "values": [1.0]}})),
    ];
    for (field, value) in wrong {
        let mut record = good.clone();
        record[field] = value.clone();
        let record: MediumRecord = serde_json::from_value(record).expect("the right types");
        let refused = record.medium(Path::new("room.bake.json"), |_| unreachable!());
        let message = refused.expect_err(&value.to_string()).to_string();
        assert!(message.contains("haze") && message.contains(field) && message.contains("bake again"), "{message}");
    }
}
