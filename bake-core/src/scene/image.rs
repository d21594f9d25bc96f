//! Images of textures: found, bounded, decoded to 8 bits a channel. An image that cannot be read is a warning.

use super::Image;
use super::buffers::Buffers;
use super::document::Document;
use super::error::{Fault, Place, Refusal, lookup};
use super::files::Files;
use super::warning::{WarningKind, Warnings};
use image::{ImageFormat, ImageReader, Limits};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;

/// Largest side of an image, texels.
const MAX_SIDE: u32 = 16384;

/// Decodes the images that materials ask for, each once.
pub(super) struct Images<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    files: &'a Files,
    /// Where an image of the document went; none where it could not be read.
    known: BTreeMap<u32, Option<u32>>,
    /// The decoded images.
    pub decoded: Vec<Arc<Image>>,
}

impl<'a> Images<'a> {
    /// Nothing decoded yet.
    pub fn new(document: &'a Document, buffers: &'a Buffers<'a>, files: &'a Files) -> Self {
        Self { document, buffers, files, known: BTreeMap::new(), decoded: Vec::new() }
    }

    /// Index of the decoded image; none (and a warning) when it cannot be read.
    pub fn get(&mut self, index: u32, from: &Place, warnings: &mut Warnings) -> Result<Option<u32>, Refusal> {
        if let Some(known) = self.known.get(&index) {
            return Ok(*known);
        }
        lookup(&self.document.images, "images", index, from)?;
        let place = Place::entry("images", index as usize);
        let slot = match self.decode(index, &place) {
            Ok(image) => {
                self.decoded.push(Arc::new(image));
                Some(self.decoded.len() as u32 - 1)
            }
            Err(refusal) => {
                let message = format!("the image is missing, its factor alone is used ({})", refusal.reason());
                warnings.push(WarningKind::MissingTexture, &place, message);
                None
            }
        };
        self.known.insert(index, slot);
        Ok(slot)
    }

    fn decode(&self, index: u32, place: &Place) -> Result<Image, Refusal> {
        let record = &self.document.images[index as usize];
        match (&record.uri, record.buffer_view) {
            (Some(uri), _) => {
                let bytes = self.files.fetch(uri, &place.field("uri"))?;
                decode(&bytes, self.files).map_err(|fault| fault.at(place))
            }
            (None, Some(view)) => {
                lookup(&self.document.buffer_views, "bufferViews", view, &place.field("bufferView"))?;
                decode(self.buffers.view(view), self.files).map_err(|fault| fault.at(place))
            }
            (None, None) => Err(Fault::Json("neither `uri` nor `bufferView`".into()).at(place)),
        }
    }
}

/// Decodes PNG, JPEG or WebP. Colour profiles and gamma chunks are ignored, as glTF 2.0, section 3.9.2, demands.
fn decode(bytes: &[u8], files: &Files) -> Result<Image, Fault> {
    let format = image::guess_format(bytes).map_err(|e| fault("image", e))?;
    let name = match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::WebP => "WebP",
        _ => return Err(Fault::Decode { format: "image", reason: "it is neither PNG, JPEG nor WebP".into() }),
    };
    let (width, height) =
        ImageReader::with_format(Cursor::new(bytes), format).into_dimensions().map_err(|e| fault(name, e))?;
    if width.max(height) > MAX_SIDE {
        return Err(Fault::value(format!("{width} × {height}"), format!("at most {MAX_SIDE} texels a side")));
    }
    // Eight bytes a texel for 16-bit images, four for the result.
    files.pixels.take(u64::from(width) * u64::from(height), 12)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(512 << 20);
    reader.limits(limits);
    let rgba = reader.decode().map_err(|e| fault(name, e))?.into_rgba8();
    let (width, height) = rgba.dimensions();
    Ok(Image { width, height, rgba: rgba.as_raw().as_chunks::<4>().0.to_vec() })
}

fn fault(format: &'static str, error: image::ImageError) -> Fault {
    Fault::Decode { format, reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn png(image: &image::DynamicImage) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        image.write_to(&mut out, ImageFormat::Png).expect("encodes");
        out.into_inner()
    }

    #[test]
    fn decodes_to_eight_bits_with_alpha() {
        let wide = image::DynamicImage::ImageRgb16(image::ImageBuffer::from_pixel(2, 1, image::Rgb([65535, 257, 0])));
        let got = decode(&png(&wide), &Files::new(Path::new("a"), &[])).expect("a PNG");
        assert_eq!((got.width, got.height, got.rgba), (2, 1, vec![[255, 1, 0, 255]; 2]));
    }

    #[test]
    fn a_header_that_promises_too_much_is_refused_before_decoding() {
        let mut bytes = png(&image::DynamicImage::new_rgba8(1, 1));
        let files = Files::new(Path::new("a"), &bytes);
        bytes[16..20].copy_from_slice(&16384u32.to_be_bytes());
        bytes[20..24].copy_from_slice(&16384u32.to_be_bytes());
        // The checksum of the header chunk covers its type and content.
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        assert!(matches!(decode(&bytes, &files), Err(Fault::TooLarge { .. })));
        bytes[16..20].copy_from_slice(&16385u32.to_be_bytes());
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        assert!(matches!(decode(&bytes, &files), Err(Fault::Value { .. })));
    }

    /// PNG specification, annex D.
    fn crc32(bytes: &[u8]) -> u32 {
        let step = |c: u32, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 };
        !bytes.iter().fold(!0, |c, b| (0..8).fold(c ^ u32::from(*b), step))
    }
}
