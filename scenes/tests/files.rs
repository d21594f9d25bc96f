//! The committed files are what the code makes, and an independent reader accepts and understands them.

use glam::{DVec2, Vec3};
use std::fs;

#[test]
fn committed_files_have_the_same_bytes() {
    for scene in scenes::all() {
        for (name, content) in scene.files() {
            let committed = fs::read(scenes::folder().join(&name)).unwrap_or_default();
            assert!(committed == content, "{name} differs from what the code makes; `cargo run -p scenes` writes it");
        }
    }
}

#[test]
fn an_independent_reader_accepts_every_scene() {
    for scene in scenes::all() {
        gltf::Gltf::from_slice(&scene.glb).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    }
}

/// One mesh of a file: vertices and triangles of all its primitives.
struct Mesh {
    name: String,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    lightmap: Vec<DVec2>,
    triangles: Vec<[usize; 3]>,
}

fn meshes(glb: &[u8]) -> Vec<Mesh> {
    let gltf = gltf::Gltf::from_slice(glb).expect("valid");
    let blob = gltf.blob.as_deref();
    let read = |mesh: gltf::Mesh| {
        let name = mesh.name().unwrap_or("?").to_owned();
        let (positions, normals, lightmap, triangles) = (vec![], vec![], vec![], vec![]);
        let mut all = Mesh { name, positions, normals, lightmap, triangles };
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|_| blob);
            let first = all.positions.len();
            all.positions.extend(reader.read_positions().expect("positions").map(Vec3::from));
            all.normals.extend(reader.read_normals().expect("normals").map(Vec3::from));
            let texcoords = reader.read_tex_coords(1).into_iter().flat_map(|set| set.into_f32());
            all.lightmap.extend(texcoords.map(|uv| glam::Vec2::from(uv).as_dvec2()));
            let indices: Vec<usize> =
                reader.read_indices().expect("indices").into_u32().map(|i| first + i as usize).collect();
            all.triangles.extend(indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
        }
        all
    };
    gltf.meshes().map(read).collect()
}

#[test]
fn normals_lie_on_the_side_the_winding_faces() {
    for scene in scenes::all() {
        for mesh in meshes(&scene.glb) {
            for corners in &mesh.triangles {
                let [a, b, c] = corners.map(|i| mesh.positions[i]);
                let face = (b - a).cross(c - a);
                let place = || format!("{}: {} at {a}", scene.name, mesh.name);
                assert!(face.length() > 0.0, "{}: no area", place());
                for &corner in corners {
                    let normal = mesh.normals[corner];
                    assert!((normal.length() - 1.0).abs() < 1e-5, "{}: normal {normal}", place());
                    assert!(face.normalize().dot(normal) > 0.5, "{}: winding against normal", place());
                }
            }
        }
    }
}

/// Texels across the square in which lightmap coordinates are checked.
const PAGE: usize = 256;

/// The triangle that owns each texel, or the two that overlap. Triangles claim texels whose centre they contain.
fn rasterise(mesh: &Mesh) -> Result<Vec<Option<usize>>, [usize; 2]> {
    let mut owner = vec![None; PAGE * PAGE];
    for (index, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|i| mesh.lightmap[i] * PAGE as f64);
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        let turn = (b - a).perp_dot(c - a).signum();
        for y in min.y as usize..PAGE.min(max.y as usize + 1) {
            for x in min.x as usize..PAGE.min(max.x as usize + 1) {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let inside = [(a, b), (b, c), (c, a)].iter().all(|(s, e)| turn * (*e - *s).perp_dot(p - *s) > 1e-3);
                if inside && let Some(other) = owner[y * PAGE + x].replace(index) {
                    return Err([other, index]);
                }
            }
        }
    }
    Ok(owner)
}

#[test]
fn lightmap_charts_stay_inside_the_square_and_apart() {
    let mut checked = 0;
    for scene in scenes::all() {
        for mesh in meshes(&scene.glb).iter().filter(|mesh| !mesh.lightmap.is_empty()) {
            let place = format!("{}: {}", scene.name, mesh.name);
            assert!(mesh.lightmap.iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0), "{place}");
            let owner = rasterise(mesh).unwrap_or_else(|pair| panic!("{place}: triangles {pair:?} overlap"));
            let used = owner.iter().flatten().count() as f64 / owner.len() as f64;
            println!("{place}: {:.0} % used", 100.0 * used);
            assert!(used > 0.25, "{place}: {:.0} % used", 100.0 * used);
            checked += 1;
        }
    }
    assert!(checked > 0);
}

#[test]
fn the_overlap_check_sees_an_overlap() {
    let lightmap = [(0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.5, 0.4)].map(DVec2::from).to_vec();
    let triangles = vec![[0, 1, 2], [0, 3, 2]];
    let mesh = Mesh { name: String::new(), positions: vec![], normals: vec![], lightmap, triangles };
    assert_eq!(rasterise(&mesh), Err([0, 1]));
}

#[test]
fn the_stored_png_decodes_to_its_texels() {
    let occluders = scenes::all().into_iter().find(|scene| scene.name == "occluders").expect("is a scene");
    let gltf = gltf::Gltf::from_slice(&occluders.glb).expect("valid");
    let view = match gltf.images().next().expect("has an image").source() {
        gltf::image::Source::View { view, .. } => view,
        gltf::image::Source::Uri { uri, .. } => panic!("not embedded: {uri}"),
    };
    let bytes = &gltf.blob.as_deref().expect("has a buffer")[view.offset()..view.offset() + view.length()];
    let image = image::load_from_memory(bytes).expect("a PNG").into_rgba8();
    assert_eq!(image.dimensions(), (4, 4));
    assert_eq!([0, 1, 4, 5].map(|i| image.as_raw()[4 * i + 3]), [0, 255, 255, 0]);
}
