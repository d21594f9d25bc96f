//! The images of a page.

use crate::scene::Environment;
use crate::solve::buffers::{PageBuffers, Validity};
use crate::solve::points::LatticeLight;
use crate::solve::visibility;
use bake_formats::float_image::{FloatImage, Quantity};
use bake_formats::metrics::luminance;
use glam::{Vec2, Vec3};

/// Total irradiance as R, G, B.
pub(super) fn lightmap(page: &PageBuffers) -> FloatImage {
    let mut image = FloatImage::new(page.width, page.height);
    image.push_rgb("", Quantity::Irradiance, &totals(page));
    image
}

fn totals(page: &PageBuffers) -> Vec<Vec3> {
    (0..page.validity.len()).map(|index| page.total(index)).collect()
}

/// Terms, variance, samples and validity; the total without air beside them where it was kept.
pub(super) fn terms(page: &PageBuffers, vacuum: Option<&PageBuffers>) -> FloatImage {
    let mut image = FloatImage::new(page.width, page.height);
    for term in &page.terms {
        image.push_rgb(term.term.name(), Quantity::Irradiance, &term.irradiance);
    }
    if let Some(vacuum) = vacuum {
        image.push_rgb("vacuum", Quantity::Irradiance, &totals(vacuum));
    }
    image.push_rgb("variance", Quantity::IrradianceVariance, &page.variance);
    image.push("samples.Y", Quantity::Samples, page.samples.iter().map(|&count| count as f32).collect());
    let valid = page.validity.iter().map(|&state| f32::from(state == Validity::Good)).collect();
    image.push("validity.Y", Quantity::Validity, valid);
    image
}

/// l ≤ 1 harmonics, when they were asked for.
pub(super) fn sh1(page: &PageBuffers) -> Option<FloatImage> {
    let coefficients = page.sh1.as_ref()?;
    let mut image = FloatImage::new(page.width, page.height);
    for index in 0..4 {
        let values: Vec<Vec3> = coefficients.iter().map(|texel| texel[index]).collect();
        image.push_rgb(&format!("c{index}"), Quantity::ShRadiance, &values);
    }
    Some(image)
}

/// The first coefficients at every point of a lattice, where each was gathered, and whether it was.
pub(super) fn lattice(light: &LatticeLight, coefficients: usize) -> FloatImage {
    let [nx, ny, nz] = light.lattice.count.to_array();
    let mut image = FloatImage::new(nx * nz, ny);
    for index in 0..coefficients {
        let values: Vec<Vec3> = light.light.iter().map(|sh| sh[index]).collect();
        image.push_rgb(&format!("c{index}"), Quantity::ShRadiance, &values);
    }
    let places = light.places.iter().enumerate();
    let moved = places.map(|(i, place)| place.map_or(Vec3::ZERO, |place| place - light.lattice.position(i)));
    let moved: Vec<Vec3> = moved.collect();
    for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
        image.push(format!("offset.{letter}"), Quantity::Offset, moved.iter().map(|m| m[axis]).collect());
    }
    let valid = light.places.iter().map(|place| f32::from(place.is_some())).collect();
    image.push("validity.Y", Quantity::Validity, valid);
    image
}

/// Moments of how far every point sees: the map of the point at pixel (x, y) of [`lattice`] begins at texel (SIZE x, SIZE y).
pub(super) fn visibility(light: &LatticeLight) -> Option<FloatImage> {
    let moments = light.visibility.as_ref()?;
    let [nx, ny, nz] = light.lattice.count.to_array();
    let (width, height) = (visibility::SIZE * nx * nz, visibility::SIZE * ny);
    let at = |pixel: u32| {
        let ([x, y], size) = ([pixel % width, pixel / width], visibility::SIZE);
        let (point, texel) = (y / size * nx * nz + x / size, y % size * size + x % size);
        moments[point as usize * visibility::TEXELS + texel as usize]
    };
    let tiled: Vec<Vec2> = (0..width * height).map(at).collect();
    let mut image = FloatImage::new(width, height);
    image.push("distance.Y", Quantity::Distance, tiled.iter().map(|m| m.x).collect());
    image.push("squared_distance.Y", Quantity::SquaredDistance, tiled.iter().map(|m| m.y).collect());
    Some(image)
}

/// Widest picture of an environment, texels.
const ENVIRONMENT_WIDTH: u32 = 1024;

/// An environment's radiance; wide ones are halved, each texel the mean of the four it stands for.
pub(super) fn environment(environment: &Environment) -> FloatImage {
    let (mut width, mut height) = (environment.width, environment.height);
    let mut radiance = environment.radiance.clone();
    while width > ENVIRONMENT_WIDTH && width % 2 == 0 && height % 2 == 0 {
        let mean = |at: u32| {
            let (x, y) = (2 * (at % (width / 2)), 2 * (at / (width / 2)));
            let texel = |dx: u32, dy: u32| radiance[((y + dy) * width + x + dx) as usize];
            (texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1)) * 0.25
        };
        radiance = (0..width / 2 * (height / 2)).map(mean).collect();
        (width, height) = (width / 2, height / 2);
    }
    let mut image = FloatImage::new(width, height);
    image.push_rgb("", Quantity::Radiance, &radiance);
    image
}

/// 8-bit sRGB PNG of the total, and the irradiance of its white.
pub(super) fn preview(page: &PageBuffers) -> (Vec<u8>, f32) {
    let (image, white) = picture(page);
    (png(&image), white)
}

/// The preview, made smaller where it is larger than `side`.
pub(super) fn thumbnail(page: &PageBuffers, side: u32) -> Vec<u8> {
    let (image, _) = picture(page);
    if image.width().max(image.height()) <= side {
        return png(&image);
    }
    let scale = f64::from(side) / f64::from(image.width().max(image.height()));
    let shrink = |size: u32| ((f64::from(size) * scale) as u32).max(1);
    png(&image::imageops::thumbnail(&image, shrink(image.width()), shrink(image.height())))
}

/// The total with the 99th percentile of luminance over baked texels as white; returns that irradiance too.
fn picture(page: &PageBuffers) -> (image::RgbImage, f32) {
    let totals = totals(page);
    let good = (0..totals.len()).filter(|&index| page.validity[index] == Validity::Good);
    let mut levels: Vec<f32> = good.map(|index| luminance(totals[index]) as f32).collect();
    levels.sort_unstable_by(f32::total_cmp);
    let white = levels.get(levels.len().saturating_sub(1) * 99 / 100).copied().filter(|&white| white > 0.0);
    let white = white.unwrap_or(1.0);
    let texels = totals.iter().flat_map(|total| (*total / white).to_array().map(srgb)).collect();
    (image::RgbImage::from_raw(page.width, page.height, texels).expect("three bytes a texel"), white)
}

fn png(image: &image::RgbImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes a PNG");
    bytes.into_inner()
}

/// sRGB transfer function to 8 bits (IEC 61966-2-1).
fn srgb(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}
