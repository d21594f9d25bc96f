//! Images of named float channels as single-part OpenEXR files.
//!
//! Pixels are f32, or f16 divided by a power of two that keeps the group's largest value inside f16's range. ZIP, scan
//! lines, rows in order: equal content gives equal bytes. Everything that is no pixel stands as JSON in the one text
//! attribute `bake`, because the `exr` crate writes several custom attributes in random order.

use crate::error::{FormatError, Result};
use exr::prelude::*;
use half::f16;
use serde::{Deserialize, Serialize};
use std::io::{Cursor, Seek, Write};
use std::path::Path;

/// Version of the `bake` attribute.
pub const IMAGE_VERSION: u32 = 1;

/// Most decoded bytes that one stored byte can stand for (deflate reaches 1032); a header that claims more is damaged.
const MAX_EXPANSION: u64 = 4096;

/// Number format of stored pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PixelFormat {
    /// 32-bit floats, scale 1.
    #[default]
    F32,
    /// 16-bit floats with a power-of-two scale; counts stay f32.
    F16,
}

/// What a channel holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Irradiance on the surface, lux per linear Rec.709 channel.
    Irradiance,
    /// Variance of the mean of the total irradiance, lux².
    IrradianceVariance,
    /// Radiance of an environment's texels, cd/m².
    Radiance,
    /// Real orthonormal spherical harmonics of incident radiance, cd/m².
    ShRadiance,
    /// Number of samples.
    Samples,
    /// 1 where baked, 0 where filled or empty.
    Validity,
    /// Relative density of a medium.
    Density,
    /// Displacement in the world, metres.
    Offset,
    /// Distance of surfaces, metres.
    Distance,
    /// Its square, metres².
    SquaredDistance,
}

impl Quantity {
    /// Unit of the quantity as manifests spell it.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Irradiance => "lx",
            Self::IrradianceVariance => "lx^2",
            Self::Radiance | Self::ShRadiance => "cd/m^2",
            Self::Samples | Self::Validity | Self::Density => "1",
            Self::Offset | Self::Distance => "m",
            Self::SquaredDistance => "m^2",
        }
    }

    /// Whether the numbers are counts, which stay f32.
    fn is_count(self) -> bool {
        matches!(self, Self::Samples | Self::Validity)
    }
}

/// Channels that share quantity and scale: value = stored number · `scale`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelGroup {
    /// Channel names in the file.
    pub channels: Vec<String>,
    /// What they hold.
    pub quantity: Quantity,
    /// Unit of the value.
    pub unit: String,
    /// Power of two that stored numbers are multiplied by.
    pub scale: f32,
}

/// The `bake` attribute.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Metadata {
    format: String,
    version: u32,
    groups: Vec<ChannelGroup>,
}

/// A channel in true units, row-major, row 0 at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in the file, `LAYER.C` or `C`.
    pub name: String,
    /// What it holds.
    pub quantity: Quantity,
    /// `width · height` finite numbers.
    pub values: Vec<f32>,
}

/// Channels of one size.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FloatImage {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// The channels; files hold them in alphabetical order.
    pub channels: Vec<Channel>,
}

impl FloatImage {
    /// An image without channels.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, channels: Vec::new() }
    }

    /// Number of texels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Whether the image has no texel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a channel. Panics unless it has one value a texel.
    pub fn push(&mut self, name: impl Into<String>, quantity: Quantity, values: Vec<f32>) {
        assert_eq!(values.len(), self.len(), "one value a texel");
        self.channels.push(Channel { name: name.into(), quantity, values });
    }

    /// Adds the channels `prefix.R`, `.G`, `.B`, or `R`, `G`, `B` for an empty prefix.
    pub fn push_rgb<T: Into<[f32; 3]> + Copy>(&mut self, prefix: &str, quantity: Quantity, values: &[T]) {
        for (component, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let name = if prefix.is_empty() { letter.to_owned() } else { format!("{prefix}.{letter}") };
            self.push(name, quantity, values.iter().map(|&v| v.into()[component]).collect());
        }
    }

    /// The values of a channel, if it exists.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.values.as_slice())
    }

    /// The three channels of a prefix as in [`Self::push_rgb`], interleaved, if all exist.
    pub fn rgb<T: From<[f32; 3]>>(&self, prefix: &str) -> Option<Vec<T>> {
        let name = |letter: &str| if prefix.is_empty() { letter.to_owned() } else { format!("{prefix}.{letter}") };
        let [r, g, b] = [self.channel(&name("R"))?, self.channel(&name("G"))?, self.channel(&name("B"))?];
        Some((0..self.len()).map(|i| T::from([r[i], g[i], b[i]])).collect())
    }

    /// Writes the image; returns the groups with the scales chosen. `path` is for messages.
    /// Errors: a number that is not finite, an image without texels or channels, or the writer's own error.
    pub fn write(&self, path: &Path, format: PixelFormat, out: impl Write + Seek) -> Result<Vec<ChannelGroup>> {
        self.check(path)?;
        let groups = self.groups(format);
        let metadata = Metadata { format: "bake image".into(), version: IMAGE_VERSION, groups: groups.clone() };
        let mut attributes = LayerAttributes::default();
        let text = serde_json::to_string(&metadata).expect("plain data becomes JSON");
        attributes.other.insert(Text::from("bake"), AttributeValue::Text(Text::from(text.as_str())));
        let layer = Layer::new(
            (self.width as usize, self.height as usize),
            attributes,
            Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing },
            AnyChannels::sort(self.channels.iter().map(|channel| encode(channel, format, &groups)).collect()),
        );
        let mut image = Image::from_layer(layer);
        image.attributes.chromaticities = Some(rec709());
        image.write().to_buffered(out).map_err(|error| match error {
            exr::error::Error::Io(source) => FormatError::Io { action: "write", path: path.to_owned(), source },
            other => FormatError::damaged("EXR", path, other),
        })?;
        Ok(groups)
    }

    fn check(&self, path: &Path) -> Result<()> {
        if self.is_empty() || self.channels.is_empty() {
            let size = format!("{} x {}, {} channels", self.width, self.height, self.channels.len());
            return Err(FormatError::invalid(path, "image", size, "at least one texel and one channel"));
        }
        for channel in &self.channels {
            if let Some(at) = channel.values.iter().position(|v| !v.is_finite()) {
                let (x, y) = (at % self.width as usize, at / self.width as usize);
                let field = format!("channel {} at texel ({x}, {y})", channel.name);
                return Err(FormatError::invalid(path, field, channel.values[at], "a finite number"));
            }
        }
        Ok(())
    }

    /// One group a quantity, in order of appearance.
    fn groups(&self, format: PixelFormat) -> Vec<ChannelGroup> {
        let mut groups: Vec<ChannelGroup> = Vec::new();
        let mut largest: Vec<f32> = Vec::new();
        for channel in &self.channels {
            let peak = channel.values.iter().fold(0.0f32, |peak, v| peak.max(v.abs()));
            if let Some(at) = groups.iter().position(|group| group.quantity == channel.quantity) {
                groups[at].channels.push(channel.name.clone());
                largest[at] = largest[at].max(peak);
            } else {
                let quantity = channel.quantity;
                let unit = quantity.unit().to_owned();
                groups.push(ChannelGroup { channels: vec![channel.name.clone()], quantity, unit, scale: 1.0 });
                largest.push(peak);
            }
        }
        for (group, peak) in groups.iter_mut().zip(largest) {
            group.scale = scale_for(group.quantity, format, peak);
        }
        groups
    }

    /// Reads an image written by [`Self::write`]. `path` is for messages. Never panics; memory in proportion to `bytes`.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self> {
        let damaged = |reason: &dyn std::fmt::Display| FormatError::damaged("EXR", path, reason);
        let header = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| damaged(&e))?;
        check_header(&header, bytes.len() as u64).map_err(|reason| damaged(&reason))?;
        let groups = read_metadata(path, &header)?;
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .map_err(|e| damaged(&e))?;
        let (width, height) = (image.layer_data.size.0 as u32, image.layer_data.size.1 as u32);
        let mut result = Self::new(width, height);
        for channel in image.layer_data.channel_data.list {
            let name = channel.name.to_string();
            let Some(group) = groups.iter().find(|group| group.channels.contains(&name)) else {
                return Err(FormatError::invalid(path, "attribute bake", "without", format!("a group for {name}")));
            };
            let values: Vec<f32> = channel.sample_data.values_as_f32().map(|v| v * group.scale).collect();
            if values.len() != result.len() {
                return Err(damaged(&format!("channel {name} has {} values", values.len())));
            }
            result.channels.push(Channel { name, quantity: group.quantity, values });
        }
        result.check(path)?;
        Ok(result)
    }
}

/// Smallest power of two that brings `peak` to at most 2^15, where f16 ends at 65504; it also lifts small images out
/// of the subnormal numbers. 1 for f32 and for counts.
fn scale_for(quantity: Quantity, format: PixelFormat, peak: f32) -> f32 {
    if format == PixelFormat::F32 || quantity.is_count() || peak == 0.0 {
        return 1.0;
    }
    let exponent = (f64::from(peak).log2().ceil() as i32 - 15).clamp(-126, 127);
    2f32.powi(exponent)
}

fn encode(channel: &Channel, format: PixelFormat, groups: &[ChannelGroup]) -> AnyChannel<FlatSamples> {
    let group = groups.iter().find(|group| group.quantity == channel.quantity).expect("each channel has its group");
    let samples = if format == PixelFormat::F16 && !channel.quantity.is_count() {
        // Division by a power of two is exact.
        FlatSamples::F16(channel.values.iter().map(|v| f16::from_f32(v / group.scale)).collect())
    } else {
        FlatSamples::F32(channel.values.clone())
    };
    AnyChannel::new(channel.name.as_str(), samples)
}

/// Primaries and white point of Rec.709 (ITU-R BT.709-6, section 1.3).
fn rec709() -> exr::meta::attribute::Chromaticities {
    exr::meta::attribute::Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    }
}

/// Refuses headers that no file of ours has, before anything is allocated for pixels.
fn check_header(metadata: &MetaData, stored_bytes: u64) -> std::result::Result<(), String> {
    let [header] = metadata.headers.as_slice() else {
        return Err(format!("{} parts instead of one", metadata.headers.len()));
    };
    let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
    if width == 0 || height == 0 || width > 1 << 16 || height > 1 << 16 {
        return Err(format!("{width} x {height} texels"));
    }
    if header.deep || header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err("deep or subsampled channels".into());
    }
    let decoded = width * height * header.channels.bytes_per_pixel as u64;
    if decoded / MAX_EXPANSION > stored_bytes {
        return Err(format!("header claims {decoded} bytes of pixels, the file has {stored_bytes}"));
    }
    Ok(())
}

fn read_metadata(path: &Path, metadata: &MetaData) -> Result<Vec<ChannelGroup>> {
    let header = &metadata.headers[0];
    let Some(AttributeValue::Text(text)) = header.own_attributes.other.get(&Text::from("bake")) else {
        let expected = "the text that `bake` writes".into();
        return Err(FormatError::Foreign {
            path: path.into(),
            field: "attribute bake",
            value: "absent".into(),
            expected,
        });
    };
    let fields: serde_json::Value = serde_json::from_str(&text.to_string())
        .map_err(|error| FormatError::damaged("EXR", path, format!("attribute bake: {error}")))?;
    let version = fields.get("version").and_then(serde_json::Value::as_u64).unwrap_or(0);
    if version != u64::from(IMAGE_VERSION) {
        let found = u32::try_from(version).unwrap_or(u32::MAX);
        return Err(FormatError::Version { path: path.into(), found, supported: IMAGE_VERSION });
    }
    let metadata: Metadata = serde_json::from_value(fields)
        .map_err(|error| FormatError::damaged("EXR", path, format!("attribute bake: {error}")))?;
    for group in &metadata.groups {
        if !(group.scale.is_finite() && group.scale > 0.0) {
            return Err(FormatError::invalid(path, "attribute bake: scale", group.scale, "a power of two"));
        }
    }
    Ok(metadata.groups)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> FloatImage {
        let mut image = FloatImage::new(5, 3);
        let values: Vec<[f32; 3]> = (0..15).map(|i| [i as f32 * 1.7, 1e5 / (i + 1) as f32, 1e-3 * i as f32]).collect();
        image.push_rgb("", Quantity::Irradiance, &values);
        image.push("samples.Y", Quantity::Samples, (0..15).map(|i| 4096.0 + i as f32).collect());
        image
    }

    fn bytes(image: &FloatImage, format: PixelFormat) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        image.write(Path::new("t.exr"), format, &mut out).unwrap();
        out.into_inner()
    }

    #[test]
    fn f32_comes_back_bit_for_bit_and_bytes_repeat() {
        let image = sample();
        let first = bytes(&image, PixelFormat::F32);
        let back = FloatImage::read(Path::new("t.exr"), &first).unwrap();
        for channel in &image.channels {
            assert_eq!(back.channel(&channel.name), Some(channel.values.as_slice()), "{}", channel.name);
        }
        for _ in 0..20 {
            assert!(bytes(&image, PixelFormat::F32) == first, "same image, other bytes");
        }
    }

    #[test]
    fn f16_keeps_eleven_bits_beyond_its_own_range() {
        let image = sample();
        let back = FloatImage::read(Path::new("t.exr"), &bytes(&image, PixelFormat::F16)).unwrap();
        // Half a unit in the last of 11 bits, or half of f16's smallest step, 2^-25, times the scale 4.
        let mut worst = testkit::compare::Worst::new("f16 round trip", 2f64.powi(-11));
        for channel in image.channels.iter().filter(|channel| channel.quantity == Quantity::Irradiance) {
            for (want, got) in channel.values.iter().zip(back.channel(&channel.name).unwrap()) {
                let error = f64::from((want - got).abs()) - 4.0 * 2f64.powi(-25);
                worst.record(error.max(0.0) / f64::from(want.abs()).max(1e-30), || format!("{} {want}", channel.name));
            }
        }
        worst.check();
        assert_eq!(back.channel("samples.Y"), image.channel("samples.Y"), "counts stay exact");
    }

    #[test]
    fn tiny_images_leave_the_subnormal_range() {
        let mut image = FloatImage::new(1, 1);
        image.push("c0.R", Quantity::ShRadiance, vec![1.234e-9]);
        let back = FloatImage::read(Path::new("t.exr"), &bytes(&image, PixelFormat::F16)).unwrap();
        assert!((back.channels[0].values[0] / 1.234e-9 - 1.0).abs() < 2f32.powi(-11));
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_with_their_place() {
        let mut image = sample();
        image.channels[1].values[7] = f32::NAN;
        let error = image.write(Path::new("t.exr"), PixelFormat::F32, Cursor::new(Vec::new())).unwrap_err().to_string();
        assert!(error.contains("t.exr") && error.contains("channel G") && error.contains("(2, 1)"), "{error}");
    }

    #[test]
    fn damaged_files_are_errors_never_panics() {
        let good = bytes(&sample(), PixelFormat::F32);
        for length in 0..good.len() {
            assert!(FloatImage::read(Path::new("t.exr"), &good[..length]).is_err(), "cut to {length}");
        }
        let rounds = if std::env::var_os("BAKE_LONG").is_some() { 1_000_000 } else { 20_000 };
        let mut state = 1u64;
        let mut refused = 0;
        for _ in 0..rounds {
            let mut bad = good.clone();
            for _ in 0..1 + next(&mut state) % 4 {
                let at = next(&mut state) as usize % bad.len();
                bad[at] = next(&mut state) as u8;
            }
            refused += usize::from(FloatImage::read(Path::new("t.exr"), &bad).is_err());
        }
        println!("{refused} of {rounds} mutated files refused");
        assert!(refused > rounds / 2);
    }

    /// splitmix64.
    fn next(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}
