//! One lantern plain, Draco-compressed and quantized: the same triangles, corner by corner.

use crate::{all_world_triangles, load};
use bake_core::scene::Scene;
use glam::DVec3;
use testkit::compare::Worst;
use testkit::reference::shared;

type Triangle = [DVec3; 3];

/// Largest distance of two triangles' corners, starting from any corner but with the same winding.
fn distance(a: &Triangle, b: &Triangle) -> f64 {
    let turned = |k: usize| (0..3).map(|i| a[i].distance(b[(i + k) % 3])).fold(0.0, f64::max);
    turned(0).min(turned(1)).min(turned(2))
}

fn centre(t: &Triangle) -> DVec3 {
    (t[0] + t[1] + t[2]) / 3.0
}

/// Pairs every triangle of `ours` with one of `theirs`, within `reach`: the largest distance of a pair and what is left
/// of `theirs`, or none where a triangle finds no partner.
fn pair_up(ours: &[Triangle], theirs: &[Triangle], reach: f64) -> Option<(f64, Vec<Triangle>)> {
    let mut free: Vec<Triangle> = theirs.to_vec();
    free.sort_by(|a, b| centre(a).x.total_cmp(&centre(b).x));
    let mut taken = vec![false; free.len()];
    let mut worst = 0.0f64;
    for triangle in ours {
        let x = centre(triangle).x;
        let first = free.partition_point(|t| centre(t).x < x - reach);
        let near = (first..free.len()).take_while(|&i| centre(&free[i]).x <= x + reach);
        let (best, gap) = near
            .filter(|&i| !taken[i])
            .map(|i| (i, distance(triangle, &free[i])))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, gap)| *gap <= reach)?;
        taken[best] = true;
        worst = worst.max(gap);
    }
    let left = free.into_iter().zip(taken).filter(|(_, taken)| !taken).map(|(t, _)| t).collect();
    Some((worst, left))
}

/// Smallest height of a triangle.
fn thickness([a, b, c]: &Triangle) -> f64 {
    let longest = a.distance(*b).max(b.distance(*c)).max(c.distance(*a));
    (b - a).cross(c - a).length() / longest
}

fn lantern(form: &str) -> Option<Scene> {
    Some(load(&shared(&format!("assets/Lantern/{form}/Lantern.gltf"))?).0)
}

#[test]
fn every_triangle_has_its_twin_in_the_other_encodings() {
    let Some(plain) = lantern("glTF") else { return };
    let plain = all_world_triangles(&plain);
    let low = plain.as_flattened().iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = plain.as_flattened().iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = (high - low).max_element();
    for (form, bits) in [("glTF-Draco", 11), ("glTF-Quantized", 14)] {
        let scene = lantern(form).expect("lies beside it");
        assert!(scene.meshes.iter().all(|mesh| mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5)));
        let other = all_world_triangles(&scene);
        // Half a step of rounding along each of three axes; no mesh is larger than the lantern.
        let step = 0.5f64.powi(bits + 1) * 3f64.sqrt();
        let (gap, left) = pair_up(&other, &plain, 1e-2 * size).expect("every triangle has a twin");
        let mut worst = Worst::new(format!("{form}: corners of {} triangles, relative to size", other.len()), step);
        worst.record(gap / size, || "the worst pair".into());
        worst.check();
        // What is missing was thinner than the steps and fell flat.
        assert_eq!(left.len(), plain.len() - other.len());
        let mut thin = Worst::new(format!("{form}: thickness of {} triangles fallen flat", left.len()), 2.0 * step);
        thin.record(0.0, || "none".into());
        for triangle in &left {
            thin.record(thickness(triangle) / size, || format!("{}", triangle[0]));
        }
        thin.check();
        assert!(left.len() < plain.len() / 20);
    }
    // Controls: one corner moved by two hundredths of the size, and one triangle turned around.
    let mut moved = plain.clone();
    moved[100][0].y += 2e-2 * size;
    assert!(pair_up(&moved, &plain, 1e-2 * size).is_none());
    let mut turned = plain.clone();
    turned[100].swap(0, 1);
    assert!(pair_up(&turned, &plain, 1e-4 * size).is_none());
}
