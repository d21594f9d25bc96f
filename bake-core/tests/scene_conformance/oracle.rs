//! Texture lookup by the book, in f64 and one texel at a time: OpenGL 4.6, sections 8.14.2 and 8.14.3, the source of
//! glTF's sampler codes.

use glam::{DVec2, DVec4, Vec2};
use std::path::Path;

/// A texture read with the `image` crate.
pub struct Texture {
    image: image::RgbaImage,
    pub wrap: [Wrap; 2],
    pub nearest: bool,
}

#[derive(Clone, Copy, Debug)]
pub enum Wrap {
    Repeat,
    Clamp,
    Mirror,
}

impl Wrap {
    /// Table 8.20.
    fn texel(self, at: i64, size: i64) -> u32 {
        let mirror = |a: i64| if a >= 0 { a } else { -(1 + a) };
        let texel = match self {
            Self::Clamp => at.clamp(0, size - 1),
            Self::Repeat => at.rem_euclid(size),
            Self::Mirror => (size - 1) - mirror(at.rem_euclid(2 * size) - size),
        };
        u32::try_from(texel).expect("inside")
    }
}

impl Texture {
    pub fn open(path: &Path) -> Self {
        let image = image::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).into_rgba8();
        Self { image, wrap: [Wrap::Repeat; 2], nearest: false }
    }

    /// Linear colour and alpha at `uv`.
    pub fn at(&self, uv: Vec2) -> DVec4 {
        let size = DVec2::new(self.image.width().into(), self.image.height().into());
        let at = uv.as_dvec2() * size;
        if self.nearest {
            return self.texel(at.floor());
        }
        let low = (at - 0.5).floor();
        let t = at - 0.5 - low;
        let mut sum = DVec4::ZERO;
        for (dx, wx) in [(0.0, 1.0 - t.x), (1.0, t.x)] {
            for (dy, wy) in [(0.0, 1.0 - t.y), (1.0, t.y)] {
                sum += wx * wy * self.texel(low + DVec2::new(dx, dy));
            }
        }
        sum
    }

    fn texel(&self, at: DVec2) -> DVec4 {
        let x = self.wrap[0].texel(at.x as i64, self.image.width().into());
        let y = self.wrap[1].texel(at.y as i64, self.image.height().into());
        let [r, g, b, a] = self.image.get_pixel(x, y).0.map(|c| f64::from(c) / 255.0);
        DVec4::new(linear(r), linear(g), linear(b), a)
    }
}

/// IEC 61966-2-1.
pub fn linear(srgb: f64) -> f64 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}
