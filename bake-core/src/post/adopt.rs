//! Charts that lie wholly inside other geometry: a column's end in the floor, the back of a frame on a wall.
//!
//! No sample reaches them, and they have no neighbours to be filled from. They take the light of their object's nearest texel,
//! so that mipmaps and coarse look-ups find nothing black beside what is seen.

use crate::atlas::{Page, SurfacePoint, Texel};
use crate::scene::Scene;
use crate::solve::buffers::{PageBuffers, Validity};
use crate::trace::world_triangle;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Gives every chart without a baked texel the values of the nearest baked texel of its instance; what it gets counts as
/// [`Validity::Filled`]. Instances without any baked texel stay as they are. Runs before [`dilate`](super::dilate()).
pub fn adopt(scene: &Scene, pages: &[Page], buffers: &mut [PageBuffers]) {
    assert_eq!(pages.len(), buffers.len(), "one buffer a page");
    pages.par_iter().zip(buffers).for_each(|(page, buffers)| {
        for (target, source) in adoptions(scene, page, &buffers.validity) {
            let images = buffers.terms.iter_mut().map(|term| &mut term.irradiance).chain([&mut buffers.variance]);
            images.for_each(|image| image[target] = image[source]);
            if let Some(sh1) = &mut buffers.sh1 {
                sh1[target] = sh1[source];
            }
            buffers.validity[target] = Validity::Filled;
        }
    });
}

/// Texels to fill, each with the one whose values it takes.
fn adoptions(scene: &Scene, page: &Page, validity: &[Validity]) -> Vec<(usize, usize)> {
    let index = |texel: &Texel| page.index(texel.x.into(), texel.y.into());
    // Of one chart all texels belong to one instance.
    let point = |texel: &Texel| page.points_of(texel)[0];
    let baked = || page.texels.iter().filter(|texel| validity[index(texel)] == Validity::Good);
    let seen: HashSet<u32> = baked().map(|texel| texel.chart).collect();
    let mut hidden: BTreeMap<u32, Vec<&Texel>> = BTreeMap::new();
    for texel in page.texels.iter().filter(|texel| !seen.contains(&texel.chart)) {
        hidden.entry(texel.chart).or_default().push(texel);
    }
    let mut lit: HashMap<u32, Vec<(Vec3, usize)>> =
        hidden.values().map(|texels| (point(texels[0]).instance, vec![])).collect();
    for texel in baked() {
        let point = point(texel);
        if let Some(lit) = lit.get_mut(&point.instance) {
            lit.push((place(scene, &point), index(texel)));
        }
    }
    let adopt = |texels: &Vec<&Texel>| {
        let middle = texels.iter().map(|texel| place(scene, &point(texel))).sum::<Vec3>() / texels.len() as f32;
        let distance = |(place, _): &(Vec3, usize)| place.distance_squared(middle);
        let nearest = lit[&point(texels[0]).instance].iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let sources = nearest.map(|&(_, source)| source);
        texels.iter().filter_map(|texel| Some((index(texel), sources?))).collect::<Vec<_>>()
    };
    hidden.values().flat_map(adopt).collect()
}

/// World place of a surface point.
fn place(scene: &Scene, point: &SurfacePoint) -> Vec3 {
    let [a, b, c] = world_triangle(scene, point.instance, point.triangle);
    a + (b - a) * point.barycentric.x + (c - a) * point.barycentric.y
}
