//! A measured lamp (IES LM-63 file) as a distribution around its axis and as a Legendre series.

use bake_optics::axial_table::AxialTable;
use bake_optics::emitter::Emitter;
use testkit::reference::shared;

const PI: f64 = std::f64::consts::PI;

/// What of a photometric file this test needs.
struct Profile {
    vertical: Vec<f64>,
    horizontal: Vec<f64>,
    candela: Vec<f64>,
}

/// Reads TILT=NONE files; the real reader with its checks lives elsewhere.
fn read(text: &str) -> Profile {
    let body = text.split_once("TILT=NONE").expect("TILT=NONE").1;
    let numbers: Vec<f64> = body
        .split([' ', '\n', '\r', ',', '\t'])
        .filter(|s| !s.is_empty())
        .map(|s| s.parse().expect("a number"))
        .collect();
    let (rows, columns) = (numbers[4] as usize, numbers[3] as usize);
    let angles = |from: usize, count: usize| numbers[from..from + count].iter().map(|d| d.to_radians()).collect();
    Profile {
        vertical: angles(13, columns),
        horizontal: angles(13 + columns, rows),
        candela: numbers[13 + columns + rows..][..rows * columns].to_vec(),
    }
}

#[test]
fn a_real_lamp_keeps_its_flux_and_converges_in_legendre_terms() {
    let Some(path) = shared("assets/ies-arnold-a/12.IES") else { return };
    let profile = read(&std::fs::read_to_string(path).expect("readable"));
    let table = AxialTable::from_profile(&profile.vertical, &profile.horizontal, &profile.candela).expect("valid");
    let (columns, last) = (profile.vertical.len(), profile.horizontal.len() - 1);
    // Flux of the bilinear profile itself by the midpoint rule, 40 steps per cell; the quarter circle four times.
    let mut flux = 0.0;
    for row in 0..last {
        for column in 0..columns - 1 {
            let steps = 40;
            let (theta, d_theta) = (profile.vertical[column], profile.vertical[column + 1] - profile.vertical[column]);
            let d_phi = profile.horizontal[row + 1] - profile.horizontal[row];
            let at = |i: usize, j: usize| profile.candela[(row + i) * columns + column + j];
            for step in 0..steps {
                let v = (step as f64 + 0.5) / steps as f64;
                let mean = 0.5 * ((at(0, 0) + at(1, 0)) * (1.0 - v) + (at(0, 1) + at(1, 1)) * v);
                flux += mean * (theta + d_theta * v).sin() * d_theta / steps as f64 * d_phi;
            }
        }
    }
    flux *= 2.0 * PI / (profile.horizontal[last] - profile.horizontal[0]);
    println!("flux {flux:.4} by midpoints, {:.4} from the table", table.flux());
    assert!((table.flux() / flux - 1.0).abs() < 1e-4);

    let lamp = Emitter::Table(table);
    let squared = |f: &dyn Fn(f64) -> f64| (0..4000).map(|i| (f64::from(i) + 0.5) / 2000.0 - 1.0).map(f).sum::<f64>();
    let misses: Vec<f64> = [2, 4, 8, 16]
        .map(|bands| {
            let series = lamp.to_legendre(bands);
            (squared(&|c| (series.eval(c) - lamp.eval(c)).powi(2)) / squared(&|c| lamp.eval(c).powi(2))).sqrt()
        })
        .to_vec();
    println!("relative L2 error with 2, 4, 8, 16 Legendre terms: {misses:.3?}");
    assert!(misses.windows(2).all(|pair| pair[1] < pair[0]), "more terms must come closer");
    assert!((lamp.legendre(1)[0] * 4.0 * PI / flux - 1.0).abs() < 1e-4);
}
