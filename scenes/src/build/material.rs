//! Diffuse materials and their glTF form.

use serde_json::{Value, json};

/// A material of a [`Glb`](super::Glb).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MaterialId(pub(super) u32);

/// A texture of a [`Glb`](super::Glb).
#[derive(Debug, Clone, Copy)]
pub struct TextureId(pub(super) u32);

/// What lets light straight through.
#[derive(Debug, Clone, Copy)]
pub enum Alpha {
    /// Nothing.
    Opaque,
    /// The share 1 − α everywhere.
    Blend(f64),
    /// Holes where the texture's alpha is below one half. The texture repeats every metre of a lightmapped patch.
    Mask(TextureId),
}

/// A diffuse material.
#[derive(Debug, Clone)]
pub struct Material {
    /// Linear Rec.709, 0..1.
    pub albedo: [f64; 3],
    /// Emitted radiance, cd/m².
    pub emission: [f64; 3],
    /// What is transparent.
    pub alpha: Alpha,
    /// Share of light that goes straight through, coloured by the albedo.
    pub transmission: f64,
    /// Whether the back reflects and emits as the front does.
    pub double_sided: bool,
}

impl Material {
    /// Reflects the given share of each channel from the front, black at the back.
    pub fn diffuse(albedo: [f64; 3]) -> Self {
        Self { albedo, emission: [0.0; 3], alpha: Alpha::Opaque, transmission: 0.0, double_sided: false }
    }

    /// Emits the given radiance (cd/m²) and reflects nothing.
    pub fn emitter(emission: [f64; 3]) -> Self {
        Self { emission, ..Self::diffuse([0.0; 3]) }
    }

    /// Both faces alike.
    pub fn double_sided(self) -> Self {
        Self { double_sided: true, ..self }
    }

    /// The glTF material and the extensions it uses.
    pub(super) fn json(&self, name: &str) -> (Value, Vec<&'static str>) {
        let [r, g, b] = self.albedo;
        let alpha = if let Alpha::Blend(alpha) = self.alpha { alpha } else { 1.0 };
        let mut value = json!({
            "name": name,
            "doubleSided": self.double_sided,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, alpha], "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        });
        match self.alpha {
            Alpha::Opaque => {}
            Alpha::Blend(_) => value["alphaMode"] = json!("BLEND"),
            Alpha::Mask(texture) => {
                value["alphaMode"] = json!("MASK");
                value["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture.0 });
            }
        }
        let mut extensions = Vec::new();
        let mut extend = |value: &mut Value, name: &'static str, content: Value| {
            value["extensions"][name] = content;
            extensions.push(name);
        };
        let strength = self.emission.into_iter().fold(0.0, f64::max);
        if strength > 0.0 {
            value["emissiveFactor"] = json!(self.emission.map(|e| e / strength));
        }
        if strength > 0.0 && strength != 1.0 {
            extend(&mut value, "KHR_materials_emissive_strength", json!({ "emissiveStrength": strength }));
        }
        if self.transmission > 0.0 {
            extend(&mut value, "KHR_materials_transmission", json!({ "transmissionFactor": self.transmission }));
        }
        (value, extensions)
    }
}
