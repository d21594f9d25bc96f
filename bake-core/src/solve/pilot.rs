//! A first look at the light on texels, a few thousand paths long: what bounds on contributions are shares of, and what paths
//! spend on the air is weighed against.

use super::emitters::Emitters;
#[cfg(feature = "media")]
use super::media::Fog;
use super::media::{Media, Vacuum};
#[cfg(feature = "media")]
use super::noise::Noise;
use super::path::{Counters, Gather, Paths};
use super::sampler::{Sampler, hash};
use super::texels::Start;
use super::{LUMINANCE, LightmapSettings, paths, texels, warp};
use crate::atlas::{Atlas, Page, Texel};
use crate::trace::{Ray, Tracer};
use bake_optics::medium::MediumSet;
use glam::Vec3;
use rayon::prelude::*;

/// Texels looked at, evenly spread over all pages, and paths for each.
const TEXELS: usize = 256;
const SAMPLES: u32 = 16;
/// Of the pilot, beside those of pages.
const SEED: u32 = 0x7069_6c6f;
/// Of rays that may escape.
const ESCAPING_SEED: u32 = 0x6f70_656e;

/// A lower limit of the median texel irradiance, luminance in lux; the same bits whatever the thread count.
///
/// Air takes light away here and gives none back: scattering only adds. Of n texels in ascending order the one at rank
/// n/2 − 1.5 √n is taken, which lies above the median once in 700 times, whatever the distribution (binomial, three
/// standard deviations).
pub fn median(tracer: &Tracer, air: &MediumSet, atlas: &Atlas, settings: &LightmapSettings) -> f64 {
    let emitters = Emitters::new(tracer);
    let texels = match absorbing(air) {
        #[cfg(feature = "media")]
        Some(air) => samples(&paths(tracer, &emitters, &Fog::new(&air), settings), atlas, settings.seed),
        _ => samples(&paths(tracer, &emitters, &Vacuum, settings), atlas, settings.seed),
    };
    let mut levels: Vec<f64> = texels.iter().map(|texel| mean(texel)).collect();
    levels.sort_by(f64::total_cmp);
    let count = levels.len() as f64;
    let rank = (0.5 * count - 1.5 * count.sqrt()).max(0.0);
    levels.get(rank as usize).copied().unwrap_or(0.0)
}

/// Air that takes what it meets; none without media.
fn absorbing(air: &MediumSet) -> Option<MediumSet> {
    let mut air = air.clone();
    for medium in &mut air.media {
        medium.scatter.sigma_a = medium.scatter.sigma_t();
        medium.scatter.sigma_s = [0.0; 3];
    }
    (!air.media.is_empty()).then_some(air)
}

/// Share of cosine-distributed rays from texels that meet nothing; 0 without texels.
pub fn escaping(tracer: &Tracer, atlas: &Atlas, seed: u32) -> f64 {
    let texels = spread(atlas);
    let look = |(index, (page, texel)): (usize, &(&Page, &Texel))| {
        let starts = texels::starts(tracer, page, texel);
        let Some(Start { vertex, .. }) = starts.first() else { return [0, 0] };
        let seed = hash(hash(seed, ESCAPING_SEED), index as u32);
        let escapes = |sample: &u32| {
            let [u, v, ..] = Sampler::new(*sample, seed).next4();
            let dir = warp::about(vertex.normal_geom, warp::cosine_hemisphere(u, v));
            tracer.closest_hit(&Ray { origin: vertex.origin, dir, t_max: f32::INFINITY }).is_none()
        };
        [(0..SAMPLES).filter(escapes).count(), SAMPLES as usize]
    };
    let [escaped, all] = texels.par_iter().enumerate().map(look).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    escaped as f64 / all.max(1) as f64
}

/// Some texels of all pages.
fn spread(atlas: &Atlas) -> Vec<(&Page, &Texel)> {
    let texels: Vec<(&Page, &Texel)> =
        atlas.pages.iter().flat_map(|page| page.texels.iter().map(move |texel| (page, texel))).collect();
    let count = texels.len().min(TEXELS);
    (0..count).map(|index| texels[index * texels.len() / count]).collect()
}

/// How far single samples spread about the value of their texel, as a share of it or of the median: root mean square as
/// in [`super::PageReport::error`].
#[cfg(feature = "media")]
pub(super) fn spread_of_samples<M: Media>(paths: &Paths<M>, atlas: &Atlas, seed: u32) -> f32 {
    let of = |texel: Vec<f64>| {
        let level = mean(&texel);
        let square = texel.iter().map(|sample| (sample - level).powi(2)).sum::<f64>();
        (level as f32, (square / f64::from(SAMPLES - 1)) as f32)
    };
    Noise::of(samples(paths, atlas, seed).into_iter().map(of)).error
}

fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// Luminance of each path, by texel.
fn samples<M: Media>(paths: &Paths<M>, atlas: &Atlas, seed: u32) -> Vec<Vec<f64>> {
    let texels = spread(atlas);
    let sample = |index: usize| {
        let (page, texel) = texels[index];
        let starts = texels::starts(paths.tracer(), page, texel);
        if starts.is_empty() {
            return None;
        }
        let seed = hash(hash(seed, SEED), index as u32);
        let one = |sample| {
            let mut sampler = Sampler::new(sample, seed);
            let [u, ..] = sampler.next4();
            let start = &starts[texels::pick(&starts, u)].vertex;
            let gathered = paths.gather(start, &mut sampler, &Counters::default());
            f64::from(gathered.terms.into_iter().sum::<Vec3>().dot(LUMINANCE))
        };
        Some((0..SAMPLES).map(one).collect())
    };
    (0..texels.len()).into_par_iter().filter_map(sample).collect()
}
