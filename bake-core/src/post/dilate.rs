//! Values for texels that no sample reached: buried ones, and the gutters that bilinear lookups read.
//!
//! Ring by ring outwards, each texel takes the mean of its filled neighbours (a diagonal one counts 1/√2) of one
//! chart: its own where it is buried, else the one with most weight around it. Charts never mix. A chart that is
//! buried as a whole has no value to take here: see [`super::adopt`].

use crate::atlas::{Atlas, Page};
use crate::solve::buffers::{PageBuffers, Validity};
use glam::Vec3;
use rayon::prelude::*;

/// Fills buried texels, however deep, and `gutter_texels` rings around the charts, in all terms, the variance and SH.
/// Filled texels get [`Validity::Filled`] and keep zero samples. `pages` are those of the atlas, in order.
pub fn dilate(atlas: &Atlas, pages: &mut [PageBuffers], gutter_texels: u32) {
    assert_eq!(atlas.pages.len(), pages.len(), "one buffer a page");
    atlas.pages.par_iter().zip(pages).for_each(|(page, buffers)| {
        let mut fill = Fill::new(page, buffers);
        while fill.ring(buffers, Validity::Buried) {}
        fill.start_over(buffers);
        for _ in 0..gutter_texels {
            fill.ring(buffers, Validity::Empty);
        }
    });
}

/// No chart.
const NONE: u32 = u32::MAX;

struct Fill {
    width: i64,
    height: i64,
    /// Chart of each texel: that of its surface, or that of its filled value.
    chart: Vec<u32>,
    /// Texels that the last ring filled.
    front: Vec<usize>,
}

/// A texel to fill and what from.
struct Blend {
    target: usize,
    chart: u32,
    sources: Vec<(usize, f32)>,
}

impl Fill {
    fn new(page: &Page, buffers: &PageBuffers) -> Self {
        let mut chart = vec![NONE; page.width as usize * page.height as usize];
        for texel in &page.texels {
            chart[page.index(texel.x.into(), texel.y.into())] = texel.chart;
        }
        let mut fill = Self { width: page.width.into(), height: page.height.into(), chart, front: Vec::new() };
        fill.start_over(buffers);
        fill
    }

    /// Lets the next ring start from everything that has a value.
    fn start_over(&mut self, buffers: &PageBuffers) {
        self.front = (0..self.chart.len()).filter(|&i| has_value(buffers.validity[i])).collect();
    }

    /// The texels around one, with weights 1 and 1/√2.
    fn around(&self, texel: usize) -> impl Iterator<Item = (usize, f32)> + use<> {
        let (width, height) = (self.width, self.height);
        let (x, y) = (texel as i64 % width, texel as i64 / width);
        let offsets = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))).filter(|d| *d != (0, 0));
        offsets
            .map(move |(dx, dy)| (x + dx, y + dy, dx * dy == 0))
            .filter(move |(x, y, _)| (0..width).contains(x) && (0..height).contains(y))
            .map(move |(x, y, side)| ((y * width + x) as usize, if side { 1.0 } else { 0.5f32.sqrt() }))
    }

    /// Fills the texels in state `from` next to the front; whether there were any.
    fn ring(&mut self, buffers: &mut PageBuffers, from: Validity) -> bool {
        let mut targets: Vec<usize> = self.front.iter().flat_map(|&t| self.around(t).map(|(n, _)| n)).collect();
        targets.retain(|&t| buffers.validity[t] == from);
        targets.sort_unstable();
        targets.dedup();
        let blends: Vec<Blend> = targets.iter().filter_map(|&target| self.blend(target, &buffers.validity)).collect();
        for image in buffers.terms.iter_mut().map(|t| &mut t.irradiance).chain([&mut buffers.variance]) {
            apply(image, &blends, |v: &Vec3, w| *v * w, |a, b| a + b);
        }
        if let Some(sh1) = &mut buffers.sh1 {
            apply(sh1, &blends, |v, w| v.map(|c| c * w), |a, b| [0, 1, 2, 3].map(|k| a[k] + b[k]));
        }
        self.front = blends.iter().map(|b| b.target).collect();
        for blend in &blends {
            buffers.validity[blend.target] = Validity::Filled;
            self.chart[blend.target] = blend.chart;
        }
        !self.front.is_empty()
    }

    /// Sources of a texel, all of one chart; `None` where no fitting neighbour has a value.
    fn blend(&self, target: usize, validity: &[Validity]) -> Option<Blend> {
        let valued = || self.around(target).filter(|(n, _)| has_value(validity[*n]));
        let chart = match self.chart[target] {
            NONE => {
                let weight = |chart| valued().filter(|(n, _)| self.chart[*n] == chart).map(|(_, w)| w).sum::<f32>();
                // Most weight; of equals the lowest number.
                let mut charts: Vec<u32> = valued().map(|(n, _)| self.chart[n]).collect();
                charts.sort_unstable();
                charts.into_iter().rev().max_by(|a, b| weight(*a).total_cmp(&weight(*b)))?
            }
            own => own,
        };
        let mut sources: Vec<_> = valued().filter(|(n, _)| self.chart[*n] == chart).collect();
        let sum: f32 = sources.iter().map(|(_, w)| w).sum();
        sources.iter_mut().for_each(|(_, w)| *w /= sum);
        (!sources.is_empty()).then_some(Blend { target, chart, sources })
    }
}

fn has_value(validity: Validity) -> bool {
    matches!(validity, Validity::Good | Validity::Filled)
}

/// Writes every blend into an image. No blend reads what another writes.
fn apply<T: Copy>(image: &mut [T], blends: &[Blend], scale: impl Fn(&T, f32) -> T, add: impl Fn(T, T) -> T) {
    for blend in blends {
        let values = blend.sources.iter().map(|(source, weight)| scale(&image[*source], *weight));
        if let Some(value) = values.reduce(&add) {
            image[blend.target] = value;
        }
    }
}
