//! Awkward meshes: every one is flattened, without overlap, in bounded pieces.

use super::super::layout::Islands;
use super::super::raster;
use super::super::shapes::{Soup, book, cobbles, helix, moebius, needles, soup, sphere, spiky};
use super::*;

fn long() -> bool {
    std::env::var("BAKE_LONG").as_deref() == Ok("1")
}

fn flattened(soup: &Soup) -> FlatMesh {
    let (flat, report) = unwrap(&soup.0, &soup.1, None);
    assert_eq!(report, UnwrapReport::default());
    assert_eq!(flat.triangles.len(), soup.1.len());
    for (own, flat_triangle) in soup.1.iter().zip(&flat.triangles) {
        assert_eq!(flat_triangle.map(|v| flat.source_vertex[v as usize]), *own);
    }
    assert!(flat.chart.iter().all(|c| *c < flat.charts));
    flat
}

/// Total flat area over total surface area, and the share of surface whose own ratio is off by more than 2.
fn areas(soup: &Soup, flat: &FlatMesh) -> (f64, f64) {
    let (mut solid, mut plane, mut off) = (0.0, 0.0, 0.0);
    for (own, triangle) in soup.1.iter().zip(&flat.triangles) {
        let area = surface_area(own.map(|v| soup.0[v as usize]));
        let [a, b, c] = triangle.map(|v| flat.position[v as usize].as_dvec2());
        let flat_area = 0.5 * (b - a).perp_dot(c - a).abs();
        solid += area;
        plane += flat_area;
        if flat_area < 0.5 * area || flat_area > 2.0 * area {
            off += area;
        }
    }
    (plane / solid, off / solid)
}

/// Texels covered, and of these shared by charts or covered more than once, at a density that gives about 200².
fn overlapped(soup: &Soup, flat: &FlatMesh) -> (u32, u32) {
    let area: f64 = soup.1.iter().map(|t| surface_area(t.map(|v| soup.0[v as usize]))).sum();
    let density = 200.0 / area.sqrt();
    let islands = Islands::of(flat);
    let (density, arrangement) = islands.arrange_at_most(density, 1, 1024).expect("fits");
    let layout = islands.layout(flat, 0, density, &arrangement);
    let fragments = raster::fragments(&layout, arrangement.size);
    let (mut covered, mut bad) = (0, 0);
    for group in fragments.chunk_by(|a, b| a.texel == b.texel) {
        let chart = |f: &raster::Fragment| layout.chart[f.triangle as usize];
        let sum: f32 = group.iter().map(|f| f.area).sum();
        covered += 1;
        bad += u32::from(sum > 1.02 || group.iter().any(|f| chart(f) != chart(&group[0])));
    }
    (covered, bad)
}

fn check_texels(name: &str, soup: &Soup, flat: &FlatMesh) {
    let (covered, bad) = overlapped(soup, flat);
    println!("{name}: {} triangles, {} charts, {covered} texels, {bad} overlapped", soup.1.len(), flat.charts);
    assert!(covered > 1000, "{name}");
    assert_eq!(bad, 0, "{name}: texels of several charts, or covered more than once");
}

/// Negative control: the helix projected as one chart covers itself, and is seen to.
#[test]
fn an_overlap_is_seen() {
    let soup = helix(200, 5.0);
    let layered = projection::project(&soup.0, &soup.1);
    assert!(layered.charts >= 5);
    let chart = vec![0; soup.1.len()];
    let (covered, bad) = overlapped(&soup, &FlatMesh { chart, charts: 1, ..layered });
    assert!(bad > covered / 2, "{bad} of {covered}");
}

#[test]
fn awkward_meshes_unwrap_without_overlap_and_keep_their_area() {
    let mut cases = vec![
        ("sphere", sphere(24), 1e-3),
        ("moebius", moebius(100), 1e-3),
        ("book", book(7), 1e-3),
        ("soup", soup(500), 1e-3),
        ("spiky", spiky(40), 1e-3),
        ("helix", helix(200, 5.0), 1e-3),
        ("cobbles", cobbles(if long() { 224 } else { 72 }), 1e-3),
        ("needles", needles(200), 1e-3),
    ];
    if long() {
        cases.push(("large soup", soup(50_000), 1e-3));
    }
    for (name, soup, distorted) in cases {
        let flat = flattened(&soup);
        let (ratio, off) = areas(&soup, &flat);
        assert!((ratio - 1.0).abs() < 0.01 && off <= distorted, "{name}: area ratio {ratio}, {off} distorted");
        check_texels(name, &soup, &flat);
    }
}

#[test]
fn out_of_time_everything_is_projected_without_overlap() {
    let cases = [
        ("sphere", sphere(24)),
        ("moebius", moebius(100)),
        ("soup", soup(300)),
        ("helix", helix(200, 5.0)),
        ("book", book(7)),
    ];
    for (name, soup) in cases {
        let (flat, report) = unwrap(&soup.0, &soup.1, Some(Instant::now()));
        assert_eq!(report, UnwrapReport { projected: soup.1.len() as u32, timed_out: true });
        let (ratio, _) = areas(&soup, &flat);
        assert!((1.0 / 3f64.sqrt()..=1.001).contains(&ratio), "{name}: area ratio {ratio}");
        check_texels(name, &soup, &flat);
    }
}

#[test]
fn a_box_has_a_chart_for_each_face() {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    assert_eq!(flattened(&((0..8).map(corner).collect(), triangles)).charts, 6);
}

#[test]
fn meshes_without_area_are_flattened_too() {
    let point = (vec![Vec3::ONE; 3], vec![[0, 1, 2]]);
    let (flat, report) = unwrap(&point.0, &point.1, None);
    assert_eq!((flat.charts, report.projected), (1, 1));
    // One real triangle beside one without area.
    let mixed = (vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(5.0)], vec![[0, 1, 2], [3, 3, 3]]);
    assert_eq!(flattened(&mixed).charts, 2);
}

#[test]
fn clusters_are_bounded_and_hold_every_triangle_once() {
    let soup = cobbles(60);
    let clusters = clusters::split(&soup.0, &soup.1, 500);
    assert!(clusters.iter().all(|c| !c.is_empty() && c.len() <= 500));
    let mut all: Vec<u32> = clusters.concat();
    all.sort_unstable();
    assert!(all.into_iter().eq(0..soup.1.len() as u32));
}
