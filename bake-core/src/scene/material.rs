//! Materials: factors into range, textures with their samplers and transforms, extensions into the Lambertian model.

use super::document::{Document, MaterialRecord, Sampler, TextureInfo, Volume};
use super::error::{Fault, Place, Refusal, lookup};
use super::image::Images;
use super::options::UnlitMode;
use super::warning::{WarningKind, Warnings};
use super::{AlphaMode, Material, TextureRef, Wrap};
use glam::{Vec3, Vec4};

/// Roughness below which, without metal, a surface counts as mirror-like.
const MIRROR_ROUGHNESS: f32 = 0.1;

/// Converts materials.
pub(super) struct Materials<'a, 'b> {
    pub document: &'a Document,
    pub images: &'b mut Images<'a>,
    pub warnings: &'b mut Warnings,
    pub unlit: UnlitMode,
}

impl Materials<'_, '_> {
    /// Converts one material of the document.
    pub fn convert(&mut self, index: usize, record: &MaterialRecord) -> Result<Material, Refusal> {
        let at = Place::entry("materials", index);
        let pbr = &record.pbr_metallic_roughness;
        let pbr_at = at.field("pbrMetallicRoughness");
        let base = pbr.base_color_factor.unwrap_or([1.0; 4]);
        let mut material = Material {
            name: record.name.clone().unwrap_or_else(|| format!("material {index}")),
            base_color: Vec4::from(self.unit_range(base, &pbr_at.field("baseColorFactor"))?),
            base_color_texture: self.texture(pbr.base_color_texture.as_ref(), &pbr_at.field("baseColorTexture"))?,
            emission: self.emission(record, &at)?,
            emission_texture: self.texture(record.emissive_texture.as_ref(), &at.field("emissiveTexture"))?,
            alpha_mode: self.alpha_mode(record, &at)?,
            double_sided: record.double_sided,
            is_specular: is_specular(record),
            ..Material::default()
        };
        self.extensions(&mut material, record, &at.field("extensions"))?;
        if record.extensions.unlit.is_some() {
            self.apply_unlit(&mut material, &at);
        }
        Ok(material)
    }

    fn emission(&mut self, record: &MaterialRecord, at: &Place) -> Result<Vec3, Refusal> {
        let factor = self.unit_range(record.emissive_factor.unwrap_or_default(), &at.field("emissiveFactor"))?;
        let strength = record.extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength).unwrap_or(1.0);
        let place = at.field("extensions.KHR_materials_emissive_strength.emissiveStrength");
        Ok(Vec3::from(factor) * not_negative(strength, &place)?)
    }

    fn alpha_mode(&self, record: &MaterialRecord, at: &Place) -> Result<AlphaMode, Refusal> {
        let cutoff = not_negative(record.alpha_cutoff.unwrap_or(0.5), &at.field("alphaCutoff"))?;
        match record.alpha_mode.as_deref() {
            None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
            Some("MASK") => Ok(AlphaMode::Mask(cutoff)),
            Some("BLEND") => Ok(AlphaMode::Blend),
            Some(mode) => Err(Fault::value(format!("`{mode}`"), "OPAQUE, MASK or BLEND").at(&at.field("alphaMode"))),
        }
    }

    /// KHR_materials_transmission, KHR_materials_diffuse_transmission, KHR_materials_volume.
    fn extensions(&mut self, material: &mut Material, record: &MaterialRecord, at: &Place) -> Result<(), Refusal> {
        if let Some(extension) = &record.extensions.transmission {
            let at = at.field("KHR_materials_transmission");
            let factor = extension.transmission_factor.unwrap_or(0.0);
            [material.transmission] = self.unit_range([factor], &at.field("transmissionFactor"))?;
            material.transmission_texture =
                self.texture(extension.transmission_texture.as_ref(), &at.field("transmissionTexture"))?;
        }
        if let Some(extension) = &record.extensions.diffuse_transmission {
            let at = at.field("KHR_materials_diffuse_transmission");
            let factor = extension.diffuse_transmission_factor.unwrap_or(0.0);
            [material.diffuse_transmission] = self.unit_range([factor], &at.field("diffuseTransmissionFactor"))?;
            material.diffuse_transmission_texture =
                self.texture(extension.diffuse_transmission_texture.as_ref(), &at.field("diffuseTransmissionTexture"))?;
            let color = extension.diffuse_transmission_color_factor.unwrap_or([1.0; 3]);
            material.diffuse_transmission_color =
                self.unit_range(color, &at.field("diffuseTransmissionColorFactor"))?.into();
            let texture = extension.diffuse_transmission_color_texture.as_ref();
            material.diffuse_transmission_color_texture =
                self.texture(texture, &at.field("diffuseTransmissionColorTexture"))?;
        }
        if let Some(volume) = &record.extensions.volume {
            material.volume_sigma_a = self.sigma_a(volume, &at.field("KHR_materials_volume"))?;
        }
        Ok(())
    }

    /// sigma_a = −ln(attenuationColor) / attenuationDistance (KHR_materials_volume, "Attenuation"); zero when thin.
    /// A channel of colour zero is taken as 1e-6, so that the coefficient stays finite.
    fn sigma_a(&mut self, volume: &Volume, at: &Place) -> Result<Vec3, Refusal> {
        let thickness = not_negative(volume.thickness_factor.unwrap_or(0.0), &at.field("thicknessFactor"))?;
        let color = self.unit_range(volume.attenuation_color.unwrap_or([1.0; 3]), &at.field("attenuationColor"))?;
        let Some(distance) = volume.attenuation_distance else { return Ok(Vec3::ZERO) };
        if distance.is_nan() || distance <= 0.0 {
            return Err(Fault::value(distance, "above 0").at(&at.field("attenuationDistance")));
        }
        if thickness == 0.0 {
            return Ok(Vec3::ZERO);
        }
        let sigma_a = color.map(|c| (-f64::from(c.max(1e-6)).ln() / f64::from(distance)).min(1e30) as f32);
        // −0 for white.
        Ok(Vec3::from(sigma_a).max(Vec3::ZERO))
    }

    fn apply_unlit(&mut self, material: &mut Material, at: &Place) {
        match self.unlit {
            UnlitMode::Black => {
                material.unlit = true;
                let message =
                    "an unlit material neither reflects nor emits; `--unlit reflect` or `--unlit emit` change that";
                self.warnings.push(WarningKind::Unlit, at, message);
            }
            UnlitMode::Reflect => {}
            UnlitMode::Emit(radiance) => {
                material.emission = material.base_color.truncate() * radiance;
                material.emission_texture = material.base_color_texture.clone();
                material.base_color = Vec3::ZERO.extend(material.base_color.w);
            }
        }
    }

    /// Numbers clamped into [0, 1] with a warning; no numbers are refused.
    fn unit_range<const N: usize>(&mut self, values: [f32; N], place: &Place) -> Result<[f32; N], Refusal> {
        if let Some(bad) = values.iter().find(|v| !v.is_finite()) {
            return Err(Fault::value(bad, "0 to 1").at(place));
        }
        let clamped = values.map(|v| v.clamp(0.0, 1.0));
        if clamped != values {
            let message = format!("{values:?} is outside 0 to 1 and clamped");
            self.warnings.push(WarningKind::MaterialRange, place, message);
        }
        Ok(clamped)
    }

    /// A use of a texture; none where there is none or it cannot be had.
    fn texture(&mut self, info: Option<&TextureInfo>, place: &Place) -> Result<Option<TextureRef>, Refusal> {
        let Some(info) = info else { return Ok(None) };
        let texture = lookup(&self.document.textures, "textures", info.index, &place.field("index"))?;
        let at = Place::entry("textures", info.index as usize);
        let sampler = match texture.sampler {
            Some(index) => lookup(&self.document.samplers, "samplers", index, &at.field("sampler"))?,
            None => &Sampler::default(),
        };
        let source = texture.extensions.webp.as_ref().map(|webp| webp.source).or(texture.source);
        let Some(source) = source else {
            let message =
                "the texture has no PNG, JPEG or WebP image, its factor alone is used; convert KTX2 textures to PNG";
            self.warnings.push(WarningKind::MissingTexture, &at, message);
            return Ok(None);
        };
        let Some(image) = self.images.get(source, &at.field("source"), self.warnings)? else { return Ok(None) };
        let transform = info.extensions.transform.as_ref();
        let texcoord = transform.and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
        if texcoord > 2 {
            let message =
                format!("texture coordinate set {texcoord} is not read (0 to 2 are); the factor alone is used");
            self.warnings.push(WarningKind::TexcoordSet, place, message);
            return Ok(None);
        }
        let wrap = [wrap(sampler.wrap_s), wrap(sampler.wrap_t)];
        let linear = sampler.mag_filter != Some(NEAREST);
        Ok(Some(TextureRef { image, texcoord: texcoord as u8, wrap, linear, transform: matrix(info, place)? }))
    }
}

const NEAREST: u32 = 9728;

/// glTF 2.0, section 5.26; unknown codes wrap as if absent.
fn wrap(code: Option<u32>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// Translation · rotation · scale as KHR_texture_transform defines them, rows on (u, v, 1):
/// rotation by r turns counter-clockwise in a v-down image, u' = cos r·u + sin r·v, v' = −sin r·u + cos r·v.
fn matrix(info: &TextureInfo, place: &Place) -> Result<[Vec3; 2], Refusal> {
    let Some(transform) = &info.extensions.transform else { return Ok([Vec3::X, Vec3::Y]) };
    let [ox, oy] = transform.offset.unwrap_or_default();
    let [sx, sy] = transform.scale.unwrap_or([1.0; 2]);
    let (sin, cos) = transform.rotation.unwrap_or(0.0).sin_cos();
    let rows = [Vec3::new(cos * sx, sin * sy, ox), Vec3::new(-sin * sx, cos * sy, oy)];
    if rows.iter().all(|row| row.is_finite()) {
        return Ok(rows);
    }
    Err(Fault::value(format!("{rows:?}"), "finite numbers").at(&place.field("extensions.KHR_texture_transform")))
}

fn not_negative(value: f32, place: &Place) -> Result<f32, Refusal> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(Fault::value(value, "0 or more").at(place))
}

/// Metal, or nearly a mirror, by its factors; a texture may make it less so, hence counted only without one.
fn is_specular(record: &MaterialRecord) -> bool {
    let pbr = &record.pbr_metallic_roughness;
    let textured = pbr.metallic_roughness_texture.is_some();
    let metallic = pbr.metallic_factor.unwrap_or(1.0) > 0.5;
    let mirror = pbr.roughness_factor.unwrap_or(1.0) < MIRROR_ROUGHNESS;
    mirror || (metallic && !textured)
}
