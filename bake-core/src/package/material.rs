//! Materials and textures in glTF's form.

use crate::scene::{AlphaMode, Image, Material, Scene, TextureRef, Wrap};
use bake_formats::baked_scene::Texture;
use bake_formats::glb::document as gltf;
use glam::Vec3;

/// Collects the textures while materials are translated.
pub(super) struct Translator<'a> {
    scene: &'a Scene,
    /// Coordinate sets that become 1, 2, … of the baked scene's materials.
    sets: &'a [u8],
    /// PNG of each image of the scene, made at first use.
    pngs: Vec<Option<Vec<u8>>>,
    /// Textures so far.
    pub textures: Vec<Texture>,
    /// Image behind each texture.
    images: Vec<u32>,
}

impl<'a> Translator<'a> {
    pub fn new(scene: &'a Scene, sets: &'a [u8]) -> Self {
        Self { scene, sets, pngs: vec![None; scene.images.len()], textures: Vec::new(), images: Vec::new() }
    }

    /// One material; extensions appear only where they say something.
    pub fn material(&mut self, material: &Material) -> gltf::Material {
        let strength = material.emission.max_element();
        let (alpha_mode, alpha_cutoff) = match material.alpha_mode {
            AlphaMode::Opaque => (gltf::AlphaMode::Opaque, None),
            AlphaMode::Mask(cutoff) => (gltf::AlphaMode::Mask, Some(cutoff)),
            AlphaMode::Blend => (gltf::AlphaMode::Blend, None),
        };
        gltf::Material {
            name: material.name.clone(),
            pbr_metallic_roughness: gltf::Pbr {
                base_color_factor: material.base_color.to_array(),
                base_color_texture: self.texture(&material.base_color_texture),
                metallic_factor: 0.0,
                roughness_factor: 1.0,
            },
            // The factor stays in [0, 1]; what is brighter goes into the strength.
            emissive_factor: (strength > 0.0).then(|| (material.emission / strength.max(1.0)).to_array()),
            emissive_texture: self.texture(&material.emission_texture),
            alpha_mode,
            alpha_cutoff,
            double_sided: material.double_sided,
            extensions: self.extensions(material, strength),
        }
    }

    fn extensions(&mut self, material: &Material, strength: f32) -> gltf::MaterialExtensions {
        let transmission = (material.transmission > 0.0).then(|| gltf::Transmission {
            transmission_factor: material.transmission,
            transmission_texture: self.texture(&material.transmission_texture),
        });
        let diffuse_transmission = (material.diffuse_transmission > 0.0).then(|| gltf::DiffuseTransmission {
            diffuse_transmission_factor: material.diffuse_transmission,
            diffuse_transmission_texture: self.texture(&material.diffuse_transmission_texture),
            diffuse_transmission_color_factor: material.diffuse_transmission_color.to_array(),
            diffuse_transmission_color_texture: self.texture(&material.diffuse_transmission_color_texture),
        });
        gltf::MaterialExtensions {
            emissive_strength: (strength > 1.0).then_some(gltf::EmissiveStrength { emissive_strength: strength }),
            transmission,
            diffuse_transmission,
            volume: volume(material.volume_sigma_a),
            unlit: material.unlit.then_some(gltf::Unlit {}),
            lightmap: None,
        }
    }

    fn texture(&mut self, texture: &Option<TextureRef>) -> Option<gltf::TextureInfo> {
        let texture = texture.as_ref()?;
        let filter = if texture.linear { [9729, 9987] } else { [9728, 9984] };
        let [wrap_s, wrap_t] = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Mirror => 33648,
            Wrap::Clamp => 33071,
        });
        let sampler = gltf::Sampler { mag_filter: filter[0], min_filter: filter[1], wrap_s, wrap_t };
        let known = self.textures.iter().zip(&self.images);
        let known = known.into_iter().position(|(t, &image)| image == texture.image && t.sampler == sampler);
        let index = known.unwrap_or_else(|| {
            let at = texture.image as usize;
            let image = &self.scene.images[at];
            let png = self.pngs[at].get_or_insert_with(|| encode(image)).clone();
            self.textures.push(Texture { png, sampler });
            self.images.push(texture.image);
            self.textures.len() - 1
        });
        let extensions = transform(&texture.transform).map(|transform| gltf::TextureInfoExtensions { transform });
        let set = self.sets.iter().position(|&set| set == texture.texcoord).map_or(0, |at| at as u32 + 1);
        Some(gltf::TextureInfo { index: index as u32, tex_coord: set, extensions })
    }
}

/// Beer–Lambert: after distance d the share exp(−σ_a d) is left; d is the mean free path of the strongest channel.
fn volume(sigma_a: Vec3) -> Option<gltf::Volume> {
    let largest = sigma_a.max_element();
    (largest > 0.0).then(|| {
        let distance = largest.recip();
        let attenuation_color = (-sigma_a * distance).exp().to_array();
        gltf::Volume { thickness_factor: 1.0, attenuation_distance: distance, attenuation_color }
    })
}

/// Takes translation · rotation · scale apart: columns of the matrix are sx·(cos r, −sin r) and sy·(sin r, cos r)
/// (KHR_texture_transform).
fn transform(rows: &[Vec3; 2]) -> Option<gltf::TextureTransform> {
    if *rows == [Vec3::X, Vec3::Y] {
        return None;
    }
    let [a, b] = rows;
    let scale_u = a.x.hypot(b.x);
    let rotation = if scale_u > 0.0 { (-b.x).atan2(a.x) } else { a.y.atan2(b.y) };
    let (sin, cos) = rotation.sin_cos();
    Some(gltf::TextureTransform { offset: [a.z, b.z], rotation, scale: [scale_u, a.y * sin + b.y * cos] })
}

fn encode(image: &Image) -> Vec<u8> {
    let texels = image.rgba.as_flattened().to_vec();
    let image = image::RgbaImage::from_raw(image.width, image.height, texels).expect("four bytes a texel");
    let mut png = std::io::Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).expect("memory takes a PNG");
    png.into_inner()
}
