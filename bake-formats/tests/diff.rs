//! Comparison of two packages that differ by a known factor.

use bake_formats::diff::Comparison;
use bake_formats::float_image::{FloatImage, PixelFormat, Quantity};
use bake_formats::manifest::{Manifest, PageRecord, Settings, Source};
use bake_formats::{Package, PackageWriter, Term};
use std::path::Path;

/// Irradiance 100 in all texels of an 8 × 4 page but (3, 2), which has `odd`; texel (0, 0) was not baked.
fn package(folder: &Path, level: f32, odd: f32, size: [u32; 2]) -> Package {
    let [width, height] = size;
    let count = (width * height) as usize;
    let mut values = vec![[level; 3]; count];
    values[2 * width as usize + 3] = [odd; 3];
    values[0] = [1e9 * level; 3];
    let mut valid = vec![1.0; count];
    valid[0] = 0.0;
    let (mut lightmap, mut terms) = (FloatImage::new(width, height), FloatImage::new(width, height));
    lightmap.push_rgb("", Quantity::Irradiance, &values);
    terms.push_rgb("direct", Quantity::Irradiance, &values);
    terms.push_rgb("variance", Quantity::IrradianceVariance, &vec![[0.0; 3]; count]);
    terms.push("validity.Y", Quantity::Validity, valid);
    let mut writer = PackageWriter::create(folder, "p").unwrap();
    let lightmap = writer.add_image("lightmap.00.exr", &lightmap, PixelFormat::F32).unwrap();
    let terms = writer.add_image("terms.00.exr", &terms, PixelFormat::F32).unwrap();
    let source = Source { file: "p.glb".into(), blake3: String::new() };
    let mut manifest = Manifest::new("p", source, Settings::new(serde_json::Value::Null));
    manifest.terms = vec![Term::Direct];
    manifest.pages.push(PageRecord { width, height, lightmap, terms, sh1: None, raw: None });
    writer.finish(manifest).unwrap();
    Package::open(folder).unwrap()
}

#[test]
fn a_known_difference_is_found_and_its_worst_texel_named() {
    let folders = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let truth = package(folders[0].path(), 100.0, 100.0, [8, 4]);
    let bake = package(folders[1].path(), 110.0, 150.0, [8, 4]);
    let comparison = Comparison::open(&bake, &truth).unwrap();
    let diff = comparison.diff(true);
    // 31 baked texels: 30 of +10 %, one of +50 %.
    assert_eq!(diff.total.texels, 31);
    let (bias, rmse) = ((30.0 * 0.1 + 0.5) / 31.0, ((30.0 * 0.01 + 0.25) / 31.0f64).sqrt());
    for metrics in [diff.total, diff.terms[0].metrics] {
        assert!((metrics.luminance.bias - bias).abs() < 1e-6, "{metrics:?}");
        assert!((metrics.luminance.relative_rmse - rmse).abs() < 1e-6, "{metrics:?}");
    }
    assert_eq!((diff.worst[0].x, diff.worst[0].y), (3, 2));
    let png = image::load_from_memory(&comparison.false_color(0)).unwrap().to_rgb8();
    assert_eq!(png.get_pixel(0, 0).0, [0; 3], "not baked");
    assert_eq!(png.get_pixel(3, 2).0, [255, 0, 0], "beyond full");
    assert_eq!(png.get_pixel(5, 1).0, [255, 128, 128], "half of full");

    let same = Comparison::open(&truth, &truth).unwrap().diff(false);
    assert_eq!((same.total.luminance.bias, same.total.luminance.relative_rmse), (0.0, 0.0));
    let other = package(folders[2].path(), 100.0, 100.0, [8, 8]);
    let error = Comparison::open(&truth, &other).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("8x4") && error.contains("8x8"), "{error}");
}
