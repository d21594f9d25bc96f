//! Density grids of every kind of file: values, places, and what is refused.

use super::*;
use crate::settings::Values;
use ::exr::prelude as ex;
use noise::Noise;
use std::io::Cursor;
use testkit::compare::Worst;

/// A small generator of our own, so that mutations repeat.
mod noise {
    /// SplitMix64 (Steele, Lea and Flood 2014).
    pub struct Noise(pub u64);

    impl Noise {
        pub fn next(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        }

        pub fn below(&mut self, end: usize) -> usize {
            (self.next() % end as u64) as usize
        }
    }
}

const PLAIN: Choice<'static> = Choice { name: None, size: None, values: Values::F32, place: Place::Auto, z_up: false };

fn cuboid() -> Bounds {
    Bounds::Box { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 1.0, 8.0) }
}

fn data(file: &str) -> Vec<u8> {
    std::fs::read(format!("{}/tests/data/air/{file}", env!("CARGO_MANIFEST_DIR"))).expect("committed")
}

fn refusal(bytes: &[u8], choice: Choice) -> String {
    read(bytes, choice, &cuboid()).expect_err("refused").to_string()
}

/// Values 1, 2, … of a lattice.
fn counting(size: [u32; 3]) -> Vec<f32> {
    (1..=size.iter().product::<u32>()).map(|i| i as f32).collect()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// A KTX2 file of one 3-D level: header, level index, data.
fn ktx(format: u32, scheme: u32, size: [u32; 3], data: &[u8]) -> Vec<u8> {
    let mut file = vec![0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, 0x0d, 0x0a, 0x1a, 0x0a];
    for word in [format, 4, size[0], size[1], size[2], 0, 1, 1, scheme, 0, 0, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    for word in [0, 0, 104, data.len() as u64, data.len() as u64] {
        file.extend(word.to_le_bytes());
    }
    file.extend(data);
    file
}

/// An EXR file of slices side by side.
fn exr_file(size: [u32; 3], channels: &[&str], values: &[f32]) -> Vec<u8> {
    let [nx, ny, nz] = size.map(|side| side as usize);
    let texel = |p: usize| values[p % (nx * nz) % nx + nx * (p / (nx * nz) + ny * (p % (nx * nz) / nx))];
    let samples: Vec<f32> = (0..nx * ny * nz).map(texel).collect();
    let channel = |name: &&str| ex::AnyChannel::new(*name, ex::FlatSamples::F32(samples.clone()));
    let channels = ex::AnyChannels::sort(channels.iter().map(channel).collect());
    let image = ex::Image::from_channels((nx * nz, ny), channels);
    let mut bytes = Cursor::new(Vec::new());
    ex::WritableImage::write(&image).non_parallel().to_buffered(&mut bytes).expect("written");
    bytes.into_inner()
}

/// A grid that fills the box: value (i, j, k) lies in the middle of its part, and holds up to the faces.
#[track_caller]
fn assert_fills(grid: &DensityGrid, size: [u32; 3], values: &[f32], scale: f64) {
    let Bounds::Box { min, max } = cuboid() else { unreachable!() };
    let size = size.map(|side| side as usize);
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                let share =
                    (DVec3::new(i as f64, j as f64, k as f64) + 0.5) / DVec3::from(size.map(|side| side as f64));
                let want = f64::from(values[i + size[0] * (j + size[1] * k)]) * scale;
                let got = grid.at(min + share * (max - min));
                assert!((got - want).abs() <= 1e-3 * want + 1e-6, "({i}, {j}, {k}): {got} for {want}");
            }
        }
    }
    assert!((grid.at(min) - f64::from(values[0]) * scale).abs() < 1e-3, "the outermost value holds to the corner");
}

#[test]
fn every_dense_form_fills_the_bounds_alike() {
    let size = [3, 2, 4];
    let values = counting(size);
    let quarters: Vec<f32> = values.iter().map(|v| v / 32.0).collect();
    let halves: Vec<u8> = values.iter().flat_map(|&v| half::f16::from_f32(v).to_le_bytes()).collect();
    let words: Vec<u8> = values.iter().flat_map(|&v| ((v / 32.0 * 65535.0).round() as u16).to_le_bytes()).collect();
    let bytes: Vec<u8> = values.iter().map(|&v| (v / 32.0 * 255.0).round() as u8).collect();
    let packed = zstd::bulk::compress(&floats(&values), 3).expect("packs");
    let sized = Choice { size: Some(size), ..PLAIN };
    let cases = [
        ("raw f32", floats(&values), sized, 1.0),
        ("raw f16", halves.clone(), Choice { values: Values::F16, ..sized }, 1.0),
        ("raw u16", words.clone(), Choice { values: Values::U16, ..sized }, 1.0 / 32.0),
        ("KTX2 f32", ktx(100, 0, size, &floats(&values)), PLAIN, 1.0),
        ("KTX2 f16", ktx(76, 0, size, &halves), PLAIN, 1.0),
        ("KTX2 u16", ktx(70, 0, size, &words), PLAIN, 1.0 / 32.0),
        ("KTX2 zstd", ktx(100, 2, size, &packed), PLAIN, 1.0),
        ("EXR", exr_file(size, &["Y"], &quarters), sized, 1.0 / 32.0),
        ("EXR, channel chosen", exr_file(size, &["a", "b"], &values), Choice { name: Some("b"), ..sized }, 1.0),
    ];
    for (what, file, choice, scale) in cases {
        let (grid, _) = read(&file, choice, &cuboid()).unwrap_or_else(|error| panic!("{what}: it {error}"));
        assert_fills(&grid, size, &values, scale);
    }
    // A byte holds 1/255.
    let (grid, _) = read(&bytes, Choice { values: Values::U8, ..sized }, &cuboid()).expect("raw u8");
    assert!((grid.largest() - 24.0 / 32.0).abs() < 0.5 / 255.0);
}

/// Optical depth through a constant grid is that of a uniform medium: nothing is lost at the faces.
#[test]
fn a_constant_grid_is_uniform_up_to_its_faces() {
    let (grid, _) = read(&floats(&[2.0; 8]), Choice { size: Some([2, 2, 2]), ..PLAIN }, &cuboid()).expect("valid");
    let medium = bake_optics::medium::Medium {
        bounds: cuboid(),
        density: bake_optics::medium::Density::Grid(std::sync::Arc::new(grid)),
        ..Default::default()
    };
    let mut worst = Worst::new("optical length, relative", 1e-12);
    for (origin, dir, length) in
        [(DVec3::new(-9.0, 0.01, 2.01), DVec3::X, 4.0), (DVec3::new(2.9, 0.99, 0.0), DVec3::Z, 6.0)]
    {
        let ray = bake_optics::medium::Ray::new(origin, dir, 100.0);
        worst.relative(medium.optical_length(&ray), 2.0 * length, || format!("{dir}"));
    }
    worst.check();
}

/// With `z_up` the third axis goes up and the second away: (x, y, z) of the file is (x, z, −y).
#[test]
fn files_with_z_up_are_turned() {
    let size = [1, 2, 2];
    let choice = Choice { size: Some(size), z_up: true, ..PLAIN };
    let (grid, _) = read(&floats(&[1.0, 2.0, 3.0, 4.0]), choice, &cuboid()).expect("valid");
    // Box x −1…3, y 0…1, z 2…8: file (j, k) lies at y = (k + ½)/2, z = 8 − 6 (j + ½)/2.
    for (j, k, value) in [(0, 0, 1.0), (1, 0, 2.0), (0, 1, 3.0), (1, 1, 4.0)] {
        let point = DVec3::new(1.0, 0.25 + 0.5 * f64::from(k), 6.5 - 3.0 * f64::from(j));
        assert!((grid.at(point) - value).abs() < 1e-12, "({j}, {k})");
    }
    let vdb = data("fog.vdb");
    let (plain, _) = read(&vdb, PLAIN, &cuboid()).expect("valid");
    let (turned, _) = read(&vdb, Choice { z_up: true, ..PLAIN }, &cuboid()).expect("valid");
    let point = DVec3::new(0.31, 0.12, -0.2);
    assert!(plain.at(point) > 0.0);
    assert!((turned.at(DVec3::new(point.x, point.z, -point.y)) - plain.at(point)).abs() < 1e-12);
}

/// Against what OpenVDB itself reads (tests/data/air/make.py): values, holes, tiles, half floats, transforms.
#[test]
fn openvdb_files_hold_what_openvdb_reads() {
    let table = String::from_utf8(data("values.csv")).expect("text");
    let (mut worst, mut active_points) = (Worst::new("density at voxels, absolute", 1e-9), 0);
    let mut open: Option<(String, DensityGrid)> = None;
    for line in table.lines().skip(1) {
        let [file, name, _, _, _, active, value, x, y, z] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let key = format!("{file} {name}");
        if open.as_ref().is_none_or(|(known, _)| *known != key) {
            let choice = Choice { name: Some(name), ..PLAIN };
            let (grid, _) =
                read(&data(file), choice, &Bounds::Unbounded).unwrap_or_else(|error| panic!("{key} {error}"));
            open = Some((key, grid));
        }
        let number = |text: &str| text.parse::<f64>().expect("a number");
        // The one inactive voxel with a value is no density.
        let want = if active == "1" { number(value) } else { 0.0 };
        active_points += usize::from(active == "1");
        let (_, grid) = open.as_ref().expect("just opened");
        worst.record((grid.at(DVec3::new(number(x), number(y), number(z))) - want).abs(), || line.to_owned());
    }
    assert!(active_points > 100, "{active_points}");
    worst.check();
}

/// Two files of others: 16-bit voxels that are not packed (file version 222), and Blosc (224). Numbers by OpenVDB 10.
#[test]
fn files_of_other_programs_are_read() {
    let cases = [
        ("vdb-smoke/smoke.vdb", [111, 222, 112], 1_049_275, 171_499.695_521_354_68, 5.714_843_75),
        ("vdb-torus/torus01.vdb", [22, 9, 22], 2450, 146_139.790_354_967_12, 100.0),
    ];
    for (file, size, active, sum, largest) in cases {
        let Some(path) = testkit::reference::shared(&format!("assets/{file}")) else {
            continue;
        };
        let lattice =
            decode(&std::fs::read(path).expect("readable"), PLAIN).unwrap_or_else(|error| panic!("{file} {error}"));
        assert_eq!(lattice.size, size);
        assert_eq!(lattice.values.iter().filter(|&&value| value > 0.0).count(), active);
        let got: f64 = lattice.values.iter().map(|&value| f64::from(value)).sum();
        assert!((got / sum - 1.0).abs() < 1e-12, "{file}: {got} for {sum}");
        assert_eq!(lattice.values.iter().copied().fold(0.0, f32::max), largest);
    }
}

#[test]
fn a_texture_of_another_program_is_read() {
    let Some(path) = testkit::reference::shared("assets/volume-bevy-bunny/bunny.ktx2") else {
        return;
    };
    let lattice = decode(&std::fs::read(path).expect("readable"), PLAIN).expect("valid");
    assert_eq!((lattice.size, lattice.values.len()), ([64; 3], 64 * 64 * 64));
}

#[test]
fn what_is_no_fog_is_refused_with_the_way_out() {
    let (several, surface, fog) = (data("several.vdb"), data("surface.vdb"), data("fog.vdb"));
    let named = |name| Choice { name: Some(name), ..PLAIN };
    let sized = Choice { size: Some([2, 2, 2]), ..PLAIN };
    let mut negative = counting([2, 2, 2]);
    negative[3] = -1.0;
    let nan = [1.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let file = Choice { place: Place::File, ..sized };
    let cases: &[(Vec<u8>, Choice, &[&str])] = &[
        (surface, PLAIN, &["level set", "`surface`", "convert"]),
        (
            several.clone(),
            PLAIN,
            &["several grids", "`name`", "half (fog volume)", "turned (fog volume)", "surface (level set)"],
        ),
        (several.clone(), named("surface"), &["level set"]),
        (several.clone(), named("velocity"), &["Tree_vec3s_5_4_3", "float grid"]),
        (several.clone(), named("empty"), &["no active voxel", "`empty`"]),
        (several.clone(), named("endless"), &["0.5 beyond its voxels"]),
        (several, named("smoke"), &["no grid `smoke`", "half"]),
        (fog[..fog.len() / 2].to_vec(), PLAIN, &["damaged OpenVDB", "of 38649"]),
        (b"no grid at all".to_vec(), PLAIN, &["neither", "size"]),
        (floats(&[1.0; 7]), sized, &["28 bytes", "32"]),
        (floats(&negative), sized, &["down to -1", "level set"]),
        (floats(&nan), sized, &["NaN", "index 1"]),
        (floats(&[1.0; 8]), file, &["does not say where"]),
        (floats(&[1.0; 8]), Choice { size: Some([1 << 20, 1 << 20, 1 << 20]), ..PLAIN }, &["points", "coarsely"]),
        (ktx(37, 0, [2, 2, 2], &[0; 32]), PLAIN, &["format 37", "R8_UNORM"]),
        (ktx(100, 0, [2, 2, 0], &[0; 32]), PLAIN, &["3-D texture"]),
        (ktx(100, 0, [2, 2, 2], &[0; 31]), PLAIN, &["31 bytes"]),
        (exr_file([2, 2, 2], &["a", "b"], &counting([2, 2, 2])), sized, &["several channels", "a, b"]),
        (exr_file([2, 2, 2], &["a"], &counting([2, 2, 2])), named("c"), &["no channel `c`"]),
        (
            exr_file([2, 2, 2], &["a"], &counting([2, 2, 2])),
            Choice { size: Some([3, 2, 2]), ..PLAIN },
            &["8 texels", "12"],
        ),
    ];
    for (bytes, choice, parts) in cases {
        let message = refusal(bytes, *choice);
        for part in *parts {
            assert!(message.contains(part), "`{part}` is missing in: it {message}");
        }
    }
    let endless = read(&floats(&[1.0; 8]), sized, &Bounds::Unbounded).expect_err("nothing to fill").to_string();
    assert!(endless.contains("no end"), "{endless}");
}

#[test]
fn rounding_below_zero_is_cleared_and_counted() {
    let mut values = counting([2, 2, 2]);
    (values[2], values[5]) = (-1e-4, -2e-4);
    let (grid, negatives) =
        read(&floats(&values), Choice { size: Some([2, 2, 2]), ..PLAIN }, &cuboid()).expect("valid");
    let negatives = negatives.expect("told");
    assert_eq!((negatives.count, negatives.lowest), (2, -2e-4));
    assert!(grid.values().iter().all(|&value| value >= 0.0));
}

/// Bytes changed, cut and repeated at random: an answer or a refusal, never a panic, a hang or an allocation out of proportion.
#[test]
fn damaged_files_are_refused_or_read() {
    let size = [3, 2, 4];
    let sized = Choice { size: Some(size), ..PLAIN };
    let originals = [
        (data("fog.vdb"), PLAIN),
        (data("surface.vdb"), PLAIN),
        (data("several.vdb"), Choice { name: Some("half"), ..PLAIN }),
        (ktx(100, 0, size, &floats(&counting(size))), PLAIN),
        (ktx(100, 2, size, &zstd::bulk::compress(&floats(&counting(size)), 3).expect("packs")), PLAIN),
        (exr_file(size, &["Y"], &counting(size)), sized),
    ];
    let rounds = if std::env::var_os("BAKE_LONG").is_some() { 20_000 } else { 300 };
    let mut noise = Noise(1);
    let (mut refused, mut read_anyway) = (0, 0);
    for (original, choice) in &originals {
        // Heads decide most; half of the changes fall into the first 2000 bytes.
        let head = original.len().min(2000);
        for round in 0..rounds {
            let mut bytes = original.clone();
            for _ in 0..=noise.below(4) {
                let at = if round % 2 == 0 { noise.below(head) } else { noise.below(original.len()) };
                bytes[at] = match noise.below(4) {
                    0 => 0xff,
                    1 => 0,
                    2 => bytes[at] ^ (1 << noise.below(8)),
                    _ => noise.next() as u8,
                };
            }
            if noise.below(8) == 0 {
                bytes.truncate(noise.below(original.len()));
            }
            match read(&bytes, *choice, &cuboid()) {
                Ok(_) => read_anyway += 1,
                Err(_) => refused += 1,
            }
        }
    }
    println!("{refused} refused, {read_anyway} read");
    assert!(refused > rounds && read_anyway > rounds / 10);
}
