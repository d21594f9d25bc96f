//! Laws of the whole atlas on small scenes.

use super::*;
use crate::atlas::shapes::{block, cobbles, moebius, scene_of, smooth, sphere, without_uv};
use glam::{Affine3A, Vec3};
use testkit::compare::Worst;

/// Page coordinate of a surface point, in texels, by the way that readers of the atlas go.
fn page_texel(atlas: &Atlas, point: &SurfacePoint) -> Vec2 {
    let placement = atlas.placements[point.instance as usize].expect("lightmapped");
    let layout = &atlas.layouts[placement.layout as usize];
    let [a, b, c] = layout.triangles[point.triangle as usize].map(|v| layout.uv[v as usize]);
    let uv = a + (b - a) * point.barycentric.x + (c - a) * point.barycentric.y;
    let page = &atlas.pages[placement.page as usize];
    (placement.offset + placement.scale * uv) * Vec2::new(page.width as f32, page.height as f32)
}

/// The laws that hold for every atlas: order, ranges, weights, and every point inside its texel.
fn check_laws(scene: &Scene, atlas: &Atlas) {
    let mut outside = Worst::new("distance of surface points from their texel", 2e-3);
    for page in &atlas.pages {
        let order: Vec<_> = page.texels.iter().map(|t| page.index(t.x.into(), t.y.into())).collect();
        assert!(order.is_sorted_by(|a, b| a < b), "texels are row-major and each stands once");
        for texel in &page.texels {
            assert!(u32::from(texel.x) < page.width && u32::from(texel.y) < page.height);
            let points = page.points_of(texel);
            let sum: f32 = points.iter().map(|p| p.weight).sum();
            assert!(!points.is_empty() && (sum - 1.0).abs() < 1e-5, "{texel:?} weighs {sum}");
            for point in points {
                let placement = atlas.placements[point.instance as usize].expect("lightmapped");
                let layout = &atlas.layouts[placement.layout as usize];
                assert_eq!(placement.first_chart + layout.chart[point.triangle as usize], texel.chart);
                let p = page_texel(atlas, point) - Vec2::new(texel.x.into(), texel.y.into());
                outside.record(f64::from((-p).max(p - 1.0).max_element().max(0.0)), || format!("{texel:?} {p}"));
            }
        }
    }
    outside.check();
    for (instance, placement) in scene.instances.iter().zip(&atlas.placements) {
        assert_eq!(instance.lightmapped, placement.is_some());
        if let Some(placement) = placement {
            let layout = &atlas.layouts[placement.layout as usize];
            let mesh = &scene.meshes[instance.mesh as usize];
            assert_eq!(layout.mesh, instance.mesh);
            for (flat, own) in layout.triangles.iter().zip(&mesh.triangles) {
                assert_eq!(flat.map(|v| layout.source_vertex[v as usize]), *own, "triangles keep their order");
            }
            assert!(layout.uv.iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0));
        }
    }
}

/// Bilinear lookups, at surface points spread over all triangles, that read a texel of another chart.
pub(super) fn crossing_lookups(atlas: &Atlas, per_triangle: u32) -> usize {
    let owners: Vec<BTreeMap<(i64, i64), u32>> = atlas
        .pages
        .iter()
        .map(|page| page.texels.iter().map(|t| ((t.x.into(), t.y.into()), t.chart)).collect())
        .collect();
    let mut crossing = 0;
    for (instance, placement) in atlas.placements.iter().enumerate() {
        let Some(placement) = placement else { continue };
        let layout = &atlas.layouts[placement.layout as usize];
        for triangle in 0..layout.triangles.len() as u32 {
            for i in 0..per_triangle {
                let (s, t) = (sobol_burley::sample(i, 0, 1).sqrt(), sobol_burley::sample(i, 1, 1));
                let barycentric = Vec2::new(s * (1.0 - t), s * t);
                let point = SurfacePoint { instance: instance as u32, triangle, barycentric, weight: 1.0 };
                let corner = (page_texel(atlas, &point) - 0.5).floor();
                let chart = placement.first_chart + layout.chart[triangle as usize];
                crossing += [(0, 0), (1, 0), (0, 1), (1, 1)]
                    .iter()
                    .filter_map(|(x, y)| {
                        owners[placement.page as usize].get(&(corner.x as i64 + x, corner.y as i64 + y))
                    })
                    .filter(|owner| **owner != chart)
                    .count();
            }
        }
    }
    crossing
}

pub(super) fn built(scene: &Scene, settings: &AtlasSettings) -> (Atlas, Vec<AtlasWarning>) {
    let (atlas, warnings) = build(scene, settings).expect("builds");
    check_laws(scene, &atlas);
    (atlas, warnings)
}

fn density(texels_per_m: f32) -> AtlasSettings {
    AtlasSettings { texels_per_m, ..AtlasSettings::default() }
}

#[test]
fn own_coordinates_keep_their_arrangement_and_their_density() {
    let size = Vec3::new(2.0, 1.0, 3.0);
    let scene = scene_of(vec![block(size, 0.1)], &[(0, Affine3A::IDENTITY)]);
    let (atlas, warnings) = built(&scene, &density(32.0));
    assert_eq!(warnings, []);
    assert_eq!(atlas.layouts[0].charts, 6);
    assert_eq!(crossing_lookups(&atlas, 200), 0);
    // Equal UV cells for unequal faces: only the mean density can hold.
    let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    let texels = atlas.pages[0].texels.len() as f32;
    let ratio = texels / (area * 32.0 * 32.0);
    assert!((0.95..1.15).contains(&ratio), "{ratio} texels per texel asked for");
}

#[test]
fn overlapping_coordinates_are_unwrapped_instead() {
    let mut overlapping = block(Vec3::ONE, 0.1);
    for uv in &mut overlapping.texcoords[1] {
        *uv = (*uv * Vec2::new(3.0, 2.0)).fract();
    }
    let scene = scene_of(vec![overlapping], &[(0, Affine3A::IDENTITY)]);
    let (atlas, warnings) = built(&scene, &density(32.0));
    let overlap = |w: &AtlasWarning| matches!(w, AtlasWarning::OwnUvRejected { problem: OwnUvProblem::Overlap { share }, .. } if *share > 0.5);
    assert!(warnings.len() == 1 && overlap(&warnings[0]), "{warnings:?}");
    assert_eq!(crossing_lookups(&atlas, 200), 0);
}

#[test]
fn coordinates_outside_or_without_area_are_refused_with_the_reason() {
    let mut outside = block(Vec3::ONE, 0.1);
    outside.texcoords[1][0].x = -0.25;
    let mut flat = block(Vec3::ONE, 0.1);
    flat.texcoords[1][..4].fill(Vec2::splat(0.5));
    let scene = scene_of(vec![outside, flat], &[(0, Affine3A::IDENTITY), (1, Affine3A::IDENTITY)]);
    let (_, warnings) = built(&scene, &density(16.0));
    let problems: Vec<_> = warnings
        .iter()
        .map(|w| match w {
            AtlasWarning::OwnUvRejected { problem, .. } => *problem,
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(problems[0], OwnUvProblem::Outside { coordinate: -0.25 });
    assert!(matches!(problems[1], OwnUvProblem::Degenerate { share } if (share - 1.0 / 6.0).abs() < 1e-5));
}

/// Negative control of the padding law: a UV set whose charts touch makes lookups cross, and the test sees it.
#[test]
fn lookups_cross_between_charts_that_touch() {
    let touching = scene_of(vec![block(Vec3::ONE, 0.0)], &[(0, Affine3A::IDENTITY)]);
    let settings = density(64.0);
    let mut plan = Plan::new(&touching, &settings, vec![Some(64.0)]);
    plan.flatten();
    let placed = plan.place().expect("fits");
    assert!(crossing_lookups(&plan.atlas(&placed), 200) > 0);
}

#[test]
fn one_density_for_instances_of_any_scale_mirrored_or_not() {
    let flat = without_uv(block(Vec3::new(1.0, 2.0, 0.5), 0.0));
    let scale = |s: Vec3| Affine3A::from_scale(s);
    let placed = [Vec3::ONE, Vec3::splat(2.0), Vec3::new(-1.0, 1.0, 1.0), Vec3::new(3.0, 1.0, 0.5)];
    let scene = scene_of(vec![flat], &placed.map(|s| (0, scale(s))));
    let (atlas, warnings) = built(&scene, &density(20.0));
    assert_eq!(warnings, []);
    let layouts: Vec<_> = atlas.placements.iter().map(|p| p.expect("lightmapped").layout).collect();
    assert_eq!(layouts[0], layouts[2], "a mirrored instance shares the layout");
    assert_eq!(crossing_lookups(&atlas, 100), 0);
    for (i, placement) in atlas.placements.iter().enumerate() {
        let placement = placement.expect("lightmapped");
        let layout = &atlas.layouts[placement.layout as usize];
        let page = &atlas.pages[placement.page as usize];
        let texels = placement.scale * Vec2::new(page.width as f32, page.height as f32);
        let flat: f32 = layout.triangles.iter().map(|t| area2(t.map(|v| layout.uv[v as usize] * texels))).sum();
        let mesh = &scene.meshes[0];
        let world = scene.instances[i].world_from_object;
        let p = |v: u32| world.transform_point3(mesh.positions[v as usize]);
        let solid: f32 =
            mesh.triangles.iter().map(|t| (p(t[1]) - p(t[0])).cross(p(t[2]) - p(t[0])).length() / 2.0).sum();
        let reached = (flat / solid).sqrt();
        assert!((reached / 20.0 - 1.0).abs() < 0.03, "instance {i}: {reached} texels per metre");
    }
}

fn area2([a, b, c]: [Vec2; 3]) -> f32 {
    (b - a).perp_dot(c - a).abs() / 2.0
}

#[test]
fn pages_are_limited_by_lowering_the_density() {
    let meshes = vec![without_uv(block(Vec3::splat(2.0), 0.0))];
    let scene = scene_of(meshes, &[(0, Affine3A::IDENTITY); 9]);
    let settings = AtlasSettings { page_size: 128, ..density(16.0) };
    let (free, warnings) = built(&scene, &settings);
    assert!(free.pages.len() > 1 && warnings.is_empty(), "{} pages, {warnings:?}", free.pages.len());
    let (limited, warnings) = built(&scene, &AtlasSettings { max_pages: Some(1), ..settings });
    assert_eq!(limited.pages.len(), 1);
    assert!(limited.pages[0].width <= 128 && limited.pages[0].height <= 128);
    let [AtlasWarning::DensityScaled { asked: 16.0, reached }] = warnings[..] else { panic!("{warnings:?}") };
    // Nine cubes of 24 m² on 128² texels: area alone allows 8.7 texels per metre.
    assert!((5.0..8.7).contains(&reached), "{reached}");
    let refused = build(&scene, &AtlasSettings { max_pages: Some(1), page_size: 8, ..density(16.0) });
    assert_eq!(refused.err(), Some(AtlasError::TooManyCharts { charts: 54, pages: 1, page_size: 8 }));
}

#[test]
fn an_instance_larger_than_a_page_is_scaled_by_itself() {
    let meshes = vec![without_uv(block(Vec3::ONE, 0.0))];
    let scene = scene_of(meshes, &[(0, Affine3A::IDENTITY), (0, Affine3A::from_scale(Vec3::splat(10.0)))]);
    let settings = AtlasSettings { page_size: 128, ..density(16.0) };
    let (_, warnings) = built(&scene, &settings);
    let [AtlasWarning::InstanceScaled { path, reached, .. }] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(path == "node 1" && (3.0..5.3).contains(reached), "{path}: {reached}");
}

#[test]
fn instances_without_lightmap_have_no_place_and_an_empty_scene_no_page() {
    let mut scene = scene_of(vec![block(Vec3::ONE, 0.1)], &[(0, Affine3A::IDENTITY); 2]);
    scene.instances[0].lightmapped = false;
    let (atlas, _) = built(&scene, &density(8.0));
    assert!(atlas.placements[0].is_none() && atlas.placements[1].is_some());
    let (atlas, _) = build(&Scene::default(), &density(8.0)).expect("builds");
    assert!(atlas.pages.is_empty());
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let refused = |settings: AtlasSettings, name: &str| match build(&Scene::default(), &settings) {
        Err(AtlasError::Setting { setting, .. }) => assert_eq!(setting, name),
        other => panic!("{name}: {other:?}"),
    };
    refused(density(0.0), "texels_per_m");
    refused(density(f32::NAN), "texels_per_m");
    refused(AtlasSettings { page_size: 3, ..density(1.0) }, "page_size");
    refused(AtlasSettings { max_pages: Some(0), ..density(1.0) }, "max_pages");
    refused(AtlasSettings { points_per_texel: 0, ..density(1.0) }, "points_per_texel");
    refused(AtlasSettings { padding: 1000, ..density(1.0) }, "padding");
}

/// A scene with everything: own coordinates, unwrapped ones, shared, mirrored and sheared instances.
fn medley() -> Scene {
    let meshes = vec![
        block(Vec3::new(2.0, 1.0, 3.0), 0.1),
        smooth(sphere(16)),
        smooth(moebius(40)),
        smooth(cobbles(24)),
        without_uv(block(Vec3::ONE, 0.0)),
    ];
    let turned = Affine3A::from_rotation_y(0.7) * Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.5));
    let mirrored = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let placed = [
        (0, Affine3A::IDENTITY),
        (1, mirrored),
        (1, Affine3A::IDENTITY),
        (2, turned),
        (3, Affine3A::IDENTITY),
        (4, turned),
        (4, mirrored * turned),
        (0, turned),
    ];
    scene_of(meshes, &placed)
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let scene = medley();
    let settings = AtlasSettings { page_size: 256, max_pages: Some(2), ..density(16.0) };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| built(&scene, &settings))
    };
    let one = with(1);
    assert!(with(2) == one && with(7) == one && with(7) == one);
    let other = built(&scene, &AtlasSettings { texels_per_m: 3.0, ..settings });
    assert!(other != one, "negative control: another atlas compares unequal");
}

/// Coverage law: the surface under all fragments is the surface of the scene; charts keep apart; every chart has texels.
#[test]
fn texels_stand_for_the_whole_surface() {
    let scene = medley();
    let settings = density(12.0);
    let (atlas, warnings) = built(&scene, &settings);
    assert_eq!(warnings, []);
    assert_eq!(crossing_lookups(&atlas, 20), 0);
    let mut worst = Worst::new("surface under the texels against the surface, per instance", 1e-4);
    let mut charts = BTreeSet::new();
    for page in &atlas.pages {
        charts.extend(page.texels.iter().map(|t| t.chart));
    }
    for (instance, placement) in scene.instances.iter().zip(&atlas.placements) {
        let placement = placement.expect("lightmapped");
        let layout = &atlas.layouts[placement.layout as usize];
        let page = &atlas.pages[placement.page as usize];
        let texels = placement.scale * Vec2::new(page.width as f32, page.height as f32);
        let size = texels.round().to_array().map(|n| n as u32);
        let mesh = &scene.meshes[instance.mesh as usize];
        let p = |v: u32| instance.world_from_object.transform_point3(mesh.positions[v as usize]);
        let solid = |t: usize| {
            let [a, b, c] = mesh.triangles[t].map(p);
            f64::from((b - a).cross(c - a).length() / 2.0)
        };
        let flat = |t: usize| f64::from(area2(layout.triangles[t].map(|v| layout.uv[v as usize] * texels)));
        let total: f64 = (0..mesh.triangles.len()).map(solid).sum();
        let under: f64 = raster::fragments(layout, size)
            .iter()
            .filter(|f| f.area > 0.0)
            .map(|f| f64::from(f.area) * solid(f.triangle as usize) / flat(f.triangle as usize))
            .sum();
        worst.relative(under, total, || instance.path.clone());
        assert!((0..layout.charts).all(|c| charts.contains(&(placement.first_chart + c))), "{}", instance.path);
    }
    worst.check();
}
