//! Reading a page between its texels.

use super::{Page, Placement};
use glam::Vec2;

/// The four texels of a bilinear lookup and their weights, which sum to 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bilinear {
    /// Row-major indices on the page.
    pub texels: [u32; 4],
    /// Weights.
    pub weights: [f32; 4],
}

impl Bilinear {
    /// The lookup at a place given in texels (centres at half-integers), clamped to a page of `width × height`.
    pub fn at(place: Vec2, width: u32, height: u32) -> Self {
        let last = Vec2::new(width.saturating_sub(1) as f32, height.saturating_sub(1) as f32);
        let place = (place - 0.5).clamp(Vec2::ZERO, last);
        let low = place.floor();
        let high = (low + 1.0).min(last);
        let s = place - low;
        let index = |x: f32, y: f32| y as u32 * width + x as u32;
        Self {
            texels: [index(low.x, low.y), index(high.x, low.y), index(low.x, high.y), index(high.x, high.y)],
            weights: [(1.0 - s.x) * (1.0 - s.y), s.x * (1.0 - s.y), (1.0 - s.x) * s.y, s.x * s.y],
        }
    }

    /// Texels with their weights, those without weight left out.
    pub fn used(&self) -> impl Iterator<Item = (usize, f32)> {
        self.texels.iter().zip(self.weights).filter(|(_, w)| *w > 0.0).map(|(t, w)| (*t as usize, w))
    }
}

impl Placement {
    /// A coordinate of the layout in texels of its page.
    pub fn texel(&self, uv: Vec2, page: &Page) -> Vec2 {
        (self.offset + self.scale * uv) * Vec2::new(page.width as f32, page.height as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_image_is_read_exactly_between_centres_and_held_outside() {
        let (width, height) = (5u32, 4u32);
        let image: Vec<f32> = (0..20).map(|i| 2.0 * (i % width) as f32 - 3.0 * (i / width) as f32).collect();
        let read = |p: Vec2| Bilinear::at(p, width, height).used().map(|(t, w)| w * image[t]).sum::<f32>();
        for i in 0..100 {
            let p = Vec2::new(sobol_burley::sample(i, 0, 0) * 5.0, sobol_burley::sample(i, 1, 0) * 4.0);
            let inside = (p - 0.5).clamp(Vec2::ZERO, Vec2::new(4.0, 3.0));
            let want = 2.0 * inside.x - 3.0 * inside.y;
            assert!((read(p) - want).abs() < 1e-5, "{p}: {} for {want}", read(p));
        }
        assert_eq!(read(Vec2::new(1.5, 2.5)), image[2 * 5 + 1], "a centre is its texel");
    }
}
