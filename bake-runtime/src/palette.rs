//! Colours for numbers, one source for shaders and legends.

use std::fmt::Write;

use glam::Vec3;

/// Colours at equal distances, straight lines in linear light between them.
#[derive(Debug, PartialEq)]
pub struct Palette {
    /// 8-bit sRGB.
    stops: &'static [[u8; 3]],
}

/// From dark violet to yellow: the lightness rises evenly, so that it reads in grey and to colour-blind eyes
/// (viridis; Smith, van der Walt and Firing 2015).
pub const SEQUENTIAL: Palette = Palette {
    stops: &[
        [0x44, 0x01, 0x54],
        [0x47, 0x2d, 0x7b],
        [0x3b, 0x52, 0x8b],
        [0x2c, 0x72, 0x8e],
        [0x21, 0x91, 0x8c],
        [0x28, 0xae, 0x80],
        [0x5e, 0xc9, 0x62],
        [0xad, 0xdc, 0x30],
        [0xfd, 0xe7, 0x25],
    ],
};

/// Blue below, nearly black in the middle, orange above.
pub const DIVERGING: Palette = Palette {
    stops: &[[0xa8, 0xe4, 0xff], [0x1c, 0x72, 0xcc], [0x10, 0x10, 0x12], [0xc4, 0x4f, 0x1a], [0xff, 0xdd, 0x8c]],
};

impl Palette {
    /// Number of stops.
    pub fn len(&self) -> usize {
        self.stops.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.stops.is_empty()
    }

    /// Linear colour at `share`, 0 the first stop, 1 the last. Twin: `palette_color` in `palette.wgsl`.
    pub fn color(&self, share: f32) -> Vec3 {
        let at = share.clamp(0.0, 1.0) * (self.stops.len() - 1) as f32;
        let low = (at as usize).min(self.stops.len() - 2);
        self.linear(low).lerp(self.linear(low + 1), at - low as f32)
    }

    /// sRGB transfer function (IEC 61966-2-1) undone.
    fn linear(&self, stop: usize) -> Vec3 {
        let channel = |byte: u8| {
            let c = f32::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        Vec3::from(self.stops[stop].map(channel))
    }

    /// Its stops for a shader, with digits that give the same f32 back.
    pub(crate) fn declaration(&self) -> String {
        let count = self.stops.len();
        let mut list = String::new();
        for Vec3 { x, y, z } in (0..count).map(|stop| self.linear(stop)) {
            let _ = write!(list, "vec3f({x:e}, {y:e}, {z:e}), ");
        }
        format!(
            "const PALETTE_COUNT = {count}u;\nvar<private> PALETTE: array<vec3f, {count}> = array<vec3f, {count}>({list});\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_rises_evenly_or_falls_and_rises_about_the_middle() {
        let luma = |color: Vec3| color.dot(Vec3::new(0.2126, 0.7152, 0.0722));
        let steps =
            |palette: &Palette| -> Vec<f32> { (0..=64).map(|i| luma(palette.color(i as f32 / 64.0))).collect() };
        assert!(steps(&SEQUENTIAL).windows(2).all(|pair| pair[1] > pair[0]));
        let diverging = steps(&DIVERGING);
        assert!(diverging[..=32].windows(2).all(|pair| pair[1] < pair[0]));
        assert!(diverging[32..].windows(2).all(|pair| pair[1] > pair[0]));
    }
}
