//! Dilation and stitching on atlases of small scenes, lit by functions of the place.

use super::*;
use crate::atlas::shapes::{block, grid, scene_of, smooth, sphere, without_uv};
use crate::atlas::{self, Atlas, AtlasSettings, Bilinear};
use crate::scene::Scene;
use crate::solve::buffers::{PageBuffers, TermImage, Validity};
use bake_formats::Term;
use glam::{Affine3A, Vec2, Vec3};
use testkit::compare::Worst;

const SENTINEL: f32 = -1e6;

fn atlas_of(scene: &Scene, texels_per_m: f32) -> Atlas {
    atlas::build(scene, &AtlasSettings { texels_per_m, ..AtlasSettings::default() }).expect("builds").0
}

/// World place of a surface point.
fn place(scene: &Scene, point: &atlas::SurfacePoint) -> Vec3 {
    let instance = &scene.instances[point.instance as usize];
    let mesh = &scene.meshes[instance.mesh as usize];
    let [a, b, c] = mesh.triangles[point.triangle as usize].map(|v| mesh.positions[v as usize]);
    instance.world_from_object.transform_point3(a + (b - a) * point.barycentric.x + (c - a) * point.barycentric.y)
}

/// Buffers with two terms and SH: `light` of the place, and a second term that is a third of it; `noise` is relative.
fn lit(scene: &Scene, atlas: &Atlas, light: impl Fn(Vec3) -> f32, noise: f32) -> Vec<PageBuffers> {
    let of_page = |page: &atlas::Page| {
        let n = page.width as usize * page.height as usize;
        let mut value = vec![Vec3::splat(SENTINEL); n];
        let mut validity = vec![Validity::Empty; n];
        for (number, texel) in (0..).zip(&page.texels) {
            let mean: f32 = page.points_of(texel).iter().map(|p| p.weight * light(place(scene, p))).sum();
            let random = 1.0 + noise * (2.0 * sobol_burley::sample(number % 65536, 0, number / 65536) - 1.0);
            let index = page.index(texel.x.into(), texel.y.into());
            value[index] = mean * random * Vec3::new(1.0, 0.5, 2.0);
            validity[index] = Validity::Good;
        }
        let third = value.iter().map(|v| *v / 3.0).collect();
        PageBuffers {
            width: page.width,
            height: page.height,
            sh1: Some(value.iter().map(|v| [*v, -*v, *v * 0.1, Vec3::ZERO]).collect()),
            terms: vec![
                TermImage { term: Term::Direct, irradiance: value },
                TermImage { term: Term::Indirect, irradiance: third },
            ],
            variance: vec![Vec3::ONE; n],
            samples: vec![1; n],
            validity,
        }
    };
    atlas.pages.iter().map(of_page).collect()
}

fn ball() -> (Scene, Atlas) {
    let scene = scene_of(vec![smooth(sphere(24))], &[(0, Affine3A::from_translation(Vec3::new(3.0, 1.0, -2.0)))]);
    let atlas = atlas_of(&scene, 12.0);
    (scene, atlas)
}

fn waves(p: Vec3) -> f32 {
    2.0 + (3.0 * p.x).sin() * (2.0 * p.y).cos() + (2.5 * p.z).sin() * 0.5
}

#[test]
fn stitching_brings_the_two_sides_of_noisy_seams_together() {
    let (scene, atlas) = ball();
    let seams = find_seams(&scene, &atlas, 15.0);
    let mut pages = lit(&scene, &atlas, waves, 0.1);
    dilate(&atlas, &mut pages, 2);
    let before = seam_score(&seams, &atlas, &pages);
    let raw = pages.clone();
    stitch(&seams, &atlas, &mut pages);
    let after = seam_score(&seams, &atlas, &pages);
    println!("{} seams, raw {before:?}, stitched {after:?}", seams.len());
    assert!(seams.len() > 50 && before.samples > 500 && before.samples == after.samples);
    // The raw bake is the negative control: it must score clearly worse.
    assert!(before.mean > 0.02 && after.mean < before.mean / 5.0 && after.max < before.max / 3.0);
    let mean = |pages: &[PageBuffers]| {
        let good = pages
            .iter()
            .flat_map(|p| (0..p.validity.len()).filter(|i| p.validity[*i] == Validity::Good).map(|i| p.total(i).y));
        good.clone().sum::<f32>() / good.count() as f32
    };
    assert!((mean(&pages) / mean(&raw) - 1.0).abs() < 2e-3, "the mean moved from {} to {}", mean(&raw), mean(&pages));
}

#[test]
fn all_images_are_stitched_alike() {
    let (scene, atlas) = ball();
    let seams = find_seams(&scene, &atlas, 15.0);
    let mut pages = lit(&scene, &atlas, waves, 0.1);
    dilate(&atlas, &mut pages, 2);
    stitch(&seams, &atlas, &mut pages);
    let mut worst = Worst::new("a third of the first term against the second, and SH against irradiance", 1e-5);
    for page in &pages {
        let sh = page.sh1.as_ref().expect("asked for");
        for i in (0..page.validity.len()).filter(|i| page.validity[*i] == Validity::Good) {
            let (first, second) = (page.terms[0].irradiance[i], page.terms[1].irradiance[i]);
            worst.record(f64::from((first / 3.0 - second).abs().max_element()), || format!("texel {i}"));
            worst.record(f64::from((sh[i][1] + first).abs().max_element()), || format!("SH of texel {i}"));
        }
    }
    worst.check();
}

#[test]
fn equal_values_stay_as_they_are() {
    let (scene, atlas) = ball();
    let mut pages = lit(&scene, &atlas, |_| 5.0, 0.0);
    dilate(&atlas, &mut pages, 2);
    let seams = find_seams(&scene, &atlas, 15.0);
    assert!(seam_score(&seams, &atlas, &pages).max < 1e-5);
    stitch(&seams, &atlas, &mut pages);
    let mut worst = Worst::new("change of a constant", 1e-5);
    for i in (0..pages[0].validity.len()).filter(|i| pages[0].validity[*i] != Validity::Empty) {
        worst.relative(pages[0].terms[0].irradiance[i].x.into(), 5.0, || format!("texel {i}"));
    }
    worst.check();
}

#[test]
fn creases_are_no_seams_but_tiles_of_one_floor_are() {
    let cube = scene_of(vec![without_uv(block(Vec3::ONE, 0.0))], &[(0, Affine3A::IDENTITY)]);
    let faces = |scene: &Scene| {
        let mut scene = scene.clone();
        let mesh = &mut scene.meshes[0];
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            for v in t {
                mesh.normals[*v as usize] = (b - a).cross(c - a).normalize();
            }
        }
        scene
    };
    let cube = faces(&cube);
    assert_eq!(find_seams(&cube, &atlas_of(&cube, 8.0), 15.0), []);
    let tile = smooth(grid(2, 2, |u, v| Vec3::new(v, 0.0, u)));
    // The second tile is mirrored: its normals must follow.
    let placed = [Affine3A::IDENTITY, Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0))];
    let floor = scene_of(vec![tile], &placed.map(|p| (0, p)));
    let seams = find_seams(&floor, &atlas_of(&floor, 8.0), 15.0);
    assert_eq!(seams.len(), 2, "{seams:?}");
}

/// A filled texel may repeat a value from a texel away: 1/12 m times the steepest gradient of `waves`, at most
/// √(3² + 2² + 1.25²) = 3.8 per metre.
const FILL_ERROR: f64 = 3.8 / 12.0;

#[test]
fn every_lookup_on_the_surface_reads_filled_texels_only() {
    let (scene, atlas) = ball();
    let unread = |gutter: u32| {
        let mut pages = lit(&scene, &atlas, waves, 0.0);
        dilate(&atlas, &mut pages, gutter);
        let placement = atlas.placements[0].expect("lightmapped");
        let layout = &atlas.layouts[0];
        let (mut unread, mut worst) = (0, Worst::new("bilinear value against the light there", FILL_ERROR));
        let solid = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| scene.meshes[0].positions[v as usize]);
            (b - a).cross(c - a).length() > 1e-6
        };
        let triangles = layout.triangles.iter().enumerate();
        // Triangles at the poles have no area, hence no chart.
        for (t, own) in triangles.filter(|(t, _)| solid(&scene.meshes[0].triangles[*t])) {
            for i in 0..20 {
                let (s, r) = (sobol_burley::sample(i, 0, 2).sqrt(), sobol_burley::sample(i, 1, 2));
                let barycentric = Vec2::new(s * (1.0 - r), s * r);
                let [a, b, c] = own.map(|v| layout.uv[v as usize]);
                let uv = a + (b - a) * barycentric.x + (c - a) * barycentric.y;
                let lookup = Bilinear::at(placement.texel(uv, &atlas.pages[0]), pages[0].width, pages[0].height);
                let value: f32 = lookup.used().map(|(texel, w)| w * pages[0].terms[0].irradiance[texel].x).sum();
                // Rounding may put a lookup 1e-3 texel beyond the gutter's last read texel.
                if lookup.used().any(|(texel, w)| w > 1e-3 && pages[0].validity[texel] == Validity::Empty) {
                    unread += 1;
                } else {
                    let point = atlas::SurfacePoint { instance: 0, triangle: t as u32, barycentric, weight: 1.0 };
                    let want = waves(place(&scene, &point));
                    worst.record(f64::from((value - want).abs()), || format!("triangle {t}"));
                }
            }
        }
        (unread, worst)
    };
    let (missing, worst) = unread(1);
    assert_eq!(missing, 0);
    worst.check();
    assert!(unread(0).0 > 100, "negative control: without a gutter lookups read empty texels");
}

#[test]
fn buried_texels_take_values_of_their_own_chart_only() {
    let scene = scene_of(vec![block(Vec3::ONE, 0.1)], &[(0, Affine3A::IDENTITY)]);
    let atlas = atlas_of(&scene, 32.0);
    let page = &atlas.pages[0];
    let mut pages = lit(&scene, &atlas, |_| 1.0, 0.0);
    // Chart k is lit by k + 1; half of each is buried, and the last one wholly.
    for texel in &page.texels {
        let i = page.index(texel.x.into(), texel.y.into());
        pages[0].terms[0].irradiance[i] = Vec3::splat(texel.chart as f32 + 1.0);
        if texel.y % 16 < 8 || texel.chart == 5 {
            pages[0].validity[i] = Validity::Buried;
            pages[0].terms[0].irradiance[i] = Vec3::splat(SENTINEL);
        }
    }
    dilate(&atlas, &mut pages, 1);
    let mut filled = 0;
    for texel in &page.texels {
        let i = page.index(texel.x.into(), texel.y.into());
        let value = pages[0].terms[0].irradiance[i];
        if texel.chart == 5 {
            assert_eq!((pages[0].validity[i], value.x), (Validity::Buried, SENTINEL));
        } else {
            filled += u32::from(pages[0].validity[i] == Validity::Filled);
            assert!((value.x - (texel.chart as f32 + 1.0)).abs() < 1e-5, "{texel:?} holds {value}");
        }
    }
    assert!(filled > 100);
}

#[test]
fn a_chart_without_light_takes_that_of_its_objects_nearest_texel() {
    let above = Affine3A::from_translation(Vec3::Y * 1.01);
    let aside = Affine3A::from_translation(Vec3::X * 5.0);
    let scene = scene_of(vec![block(Vec3::ONE, 0.1)], &[(0, Affine3A::IDENTITY), (0, above), (0, aside)]);
    let atlas = atlas_of(&scene, 8.0);
    // The block above is brighter and nearer to the hidden top, but another object.
    let mut pages = lit(&scene, &atlas, |p| if p.y > 1.005 { 100.0 } else { p.y }, 0.0);
    let (mut tops, mut aside) = (vec![], vec![]);
    for texel in &atlas.pages[0].texels {
        let points = atlas.pages[0].points_of(texel);
        let index = atlas.pages[0].index(texel.x.into(), texel.y.into());
        match points[0].instance {
            0 if points.iter().all(|p| place(&scene, p).y > 0.999) => tops.push(index),
            2 => aside.push(index),
            _ => continue,
        }
        pages[0].validity[index] = Validity::Buried;
        pages[0].terms[0].irradiance[index] = Vec3::ZERO;
    }
    let before = hidden(&atlas, &pages);
    adopt(&scene, &atlas.pages, &mut pages);
    let after = hidden(&atlas, &pages);
    assert_eq!((after.texels as usize, after.lightless), (aside.len(), vec![2]));
    assert_eq!(before.texels as usize, aside.len() + tops.len(), "the top has no light without it");
    assert!(tops.len() > 30 && tops.iter().all(|&i| pages[0].validity[i] == Validity::Filled), "{} texels", tops.len());
    // The sides end at y = 1; their uppermost texels reach an eighth of a metre down at most.
    for &top in &tops {
        let light = pages[0].terms[0].irradiance[top].x;
        assert!((0.85..=1.0).contains(&light), "{light}");
    }
}
