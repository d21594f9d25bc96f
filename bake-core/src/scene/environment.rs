//! Light from infinitely far: a uniform sky, or an image in Radiance HDR or OpenEXR.

use super::Environment;
use super::error::{Fault, Place, Refusal};
use super::files;
use super::options::{Env, LoadOptions};
use super::warning::{WarningKind, Warnings};
use glam::Vec3;
use image::{ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Largest width of an environment image, texels.
const MAX_WIDTH: u32 = 16384;

/// The environment that the settings ask for.
pub(super) fn load(options: &LoadOptions, warnings: &mut Warnings) -> Result<Option<Environment>, Refusal> {
    match (options.sky, &options.env) {
        (Some(_), Some(_)) => Err(Fault::value("given besides `env`", "one of the two").at(&Place::root("sky"))),
        (Some(sky), None) => uniform(sky).map(Some),
        (None, Some(env)) => from_file(env, warnings).map(Some),
        (None, None) => Ok(None),
    }
}

fn uniform(sky: Vec3) -> Result<Environment, Refusal> {
    if !(sky.min_element() >= 0.0 && sky.is_finite()) {
        return Err(Fault::value(sky, "three numbers of 0 or more, cd/m²").at(&Place::root("sky")));
    }
    Ok(Environment { width: 1, height: 1, radiance: vec![sky], rotation: 0.0 })
}

fn from_file(env: &Env, warnings: &mut Warnings) -> Result<Environment, Refusal> {
    if !(env.scale >= 0.0 && env.scale.is_finite()) {
        return Err(Fault::value(env.scale, "0 or more").at(&Place::root("env.scale")));
    }
    if !env.rotation_deg.is_finite() {
        return Err(Fault::value(env.rotation_deg, "a finite number").at(&Place::root("env.rotation_deg")));
    }
    let bytes = files::read(&env.file).map_err(|fault| fault.in_file(&env.file))?;
    let (width, height, mut radiance) = decode(&bytes).map_err(|fault| fault.in_file(&env.file))?;
    let mut negative = 0;
    for (i, texel) in radiance.iter_mut().enumerate() {
        *texel *= env.scale;
        if !texel.is_finite() {
            let place = format!("texel ({}, {})", i as u32 % width, i as u32 / width);
            return Err(Fault::value(*texel, "finite radiance").in_file(&env.file).object(place));
        }
        negative += u64::from(texel.min_element() < 0.0);
        *texel = texel.max(Vec3::ZERO);
    }
    let message = format!("{}: radiance below zero is taken as zero", env.file.display());
    warnings.push_many(WarningKind::EnvironmentRange, &Place::root("env"), negative, message);
    Ok(Environment { width, height, radiance, rotation: env.rotation_deg.to_radians() })
}

/// Width, height and texels; the formats are told apart by their first bytes.
fn decode(bytes: &[u8]) -> Result<(u32, u32, Vec<Vec3>), Fault> {
    let format = match bytes {
        [0x76, 0x2f, 0x31, 0x01, ..] => return decode_exr(bytes),
        [b'#', b'?', ..] => ImageFormat::Hdr,
        _ => {
            return Err(Fault::Unsupported {
                what: "neither Radiance HDR nor OpenEXR".into(),
                way_out: "convert the environment to .hdr or .exr",
            });
        }
    };
    let refuse = |e: image::ImageError| Fault::Decode { format: "Radiance HDR", reason: e.to_string() };
    let (width, height) = ImageReader::with_format(Cursor::new(bytes), format).into_dimensions().map_err(refuse)?;
    check_size(width as usize, height as usize, bytes.len())?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(Limits::no_limits());
    let image = reader.decode().map_err(refuse)?.into_rgb32f();
    Ok((width, height, image.as_raw().as_chunks::<3>().0.iter().map(|c| Vec3::from(*c)).collect()))
}

fn decode_exr(bytes: &[u8]) -> Result<(u32, u32, Vec<Vec3>), Fault> {
    use exr::prelude::*;
    let refuse = |e: Error| Fault::Decode { format: "OpenEXR", reason: e.to_string() };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), true).map_err(refuse)?;
    for header in &meta.headers {
        check_size(header.layer_size.width(), header.layer_size.height(), bytes.len())?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size: Vec2<usize>, _: &_| (size.width(), vec![Vec3::ZERO; size.area()]),
            |(width, texels), at, (r, g, b): (f32, f32, f32)| texels[at.y() * *width + at.x()] = Vec3::new(r, g, b),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(refuse)?;
    let size = image.layer_data.size;
    Ok((size.width() as u32, size.height() as u32, image.layer_data.channel_data.pixels.1))
}

/// Keeps memory in proportion: both formats pack at most some hundred texels into a byte.
fn check_size(width: usize, height: usize, bytes: usize) -> Result<(), Fault> {
    if width == 0 || height == 0 || width > MAX_WIDTH as usize || height > MAX_WIDTH as usize {
        return Err(Fault::value(format!("{width} × {height}"), format!("1 to {MAX_WIDTH} texels a side")));
    }
    let (needed, allowed) = ((width * height * 12) as u64, (64 << 20) + 1100 * bytes as u64);
    if needed > allowed { Err(Fault::TooLarge { needed, allowed }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hdr(width: u32, height: u32, texels: &[[f32; 3]]) -> Vec<u8> {
        let pixels: Vec<_> = texels.iter().map(|t| image::Rgb(*t)).collect();
        let mut out = Vec::new();
        let encoder = image::codecs::hdr::HdrEncoder::new(&mut out);
        encoder.encode(&pixels, width as usize, height as usize).expect("encodes");
        out
    }

    #[test]
    fn hdr_rows_come_from_the_top() {
        let texels = [[1.0, 0.5, 0.25], [2.0, 4.0, 8.0], [0.0; 3], [16.0, 16.0, 16.0]];
        let (width, height, got) = decode(&hdr(2, 2, &texels)).expect("an HDR image");
        assert_eq!((width, height, got), (2, 2, texels.map(Vec3::from).to_vec()));
    }

    #[test]
    fn exr_values_arrive_whole() {
        use exr::prelude::*;
        let texel = |x: usize, y: usize| (x as f32 + 0.1, y as f32 + 0.2, 3e4);
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        write_rgb_file(file.path(), 3, 2, texel).expect("writes");
        let bytes = std::fs::read(file.path()).expect("reads");
        let (width, height, got) = decode(&bytes).expect("an EXR image");
        assert_eq!((width, height), (3, 2));
        assert_eq!(got[4], Vec3::new(1.1, 1.2, 3e4));
    }

    #[test]
    fn broken_and_strange_files_are_refused() {
        assert!(matches!(decode(b"GIF89a"), Err(Fault::Unsupported { .. })));
        assert!(matches!(
            decode(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n"),
            Err(Fault::TooLarge { .. })
        ));
        assert!(matches!(decode(&[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]), Err(Fault::Decode { .. })));
        assert!(uniform(Vec3::new(-1.0, 0.0, 0.0)).is_err());
        assert!(uniform(Vec3::NAN).is_err());
    }
}
