//! What a surface does with light at a point: the material model, evaluated through textures and vertex colours.
//!
//! Shares of the incident light, per linear RGB channel, with base colour `b` (factor × texture × vertex colour),
//! coverage α, transmission t, diffuse transmission d of colour `c`:
//!
//! ```text
//! reflect     α (1 − t) (1 − d) b
//! transmit    α (1 − t) d c
//! through     1 − α + α t b
//! ```
//! α is 1 for OPAQUE, 0 or 1 for MASK, base alpha for BLEND. With b and c in [0, 1] the shares never sum to more than
//! one. The back of a single-sided face is the caller's matter, as are the chords of absorbing volumes.

use super::{AlphaMode, Image, Material, Mesh, Scene, TextureRef, Wrap};
use glam::{Vec2, Vec3, Vec4};
use std::sync::LazyLock;

/// A surface point's optical properties; shares are per linear RGB channel in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Diffusely reflected.
    pub reflect: Vec3,
    /// Diffusely transmitted to the far side.
    pub transmit: Vec3,
    /// Passes straight through.
    pub through: Vec3,
    /// Emitted radiance, cd/m², weakened by coverage.
    pub emission: Vec3,
}

impl Surface {
    /// At a point of an instance's triangle, seen from the front; `barycentric` are the weights of the second and third
    /// corner. Cost: a bilinear lookup for each texture that the material has; nothing is allocated.
    pub fn at(scene: &Scene, instance: u32, triangle: u32, barycentric: Vec2) -> Self {
        let point = Point::new(scene, instance, triangle, barycentric);
        let material = scene.material_at(instance, triangle);
        let base = point.base_color(material);
        let alpha = coverage(material.alpha_mode, base.w);
        let uncovered = Vec3::splat(1.0 - alpha);
        if material.unlit {
            return Self { reflect: Vec3::ZERO, transmit: Vec3::ZERO, through: uncovered, emission: Vec3::ZERO };
        }
        let base = base.truncate();
        let t = point.transmission(material);
        let (d, color) = point.diffuse_transmission(material);
        let scattered = alpha * (1.0 - t);
        Self {
            reflect: scattered * (1.0 - d) * base,
            transmit: scattered * d * color,
            through: uncovered + alpha * t * base,
            emission: alpha * point.emission(material),
        }
    }
}

impl Scene {
    /// Base alpha at a point of an instance's triangle: factor × texture × vertex colour.
    pub fn alpha_at(&self, instance: u32, triangle: u32, barycentric: Vec2) -> f32 {
        Point::new(self, instance, triangle, barycentric).base_color(self.material_at(instance, triangle)).w
    }
}

/// glTF 2.0, section 3.9.4.
fn coverage(mode: AlphaMode, alpha: f32) -> f32 {
    match mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        AlphaMode::Blend => alpha,
    }
}

/// A point of a triangle with what interpolation needs.
struct Point<'a> {
    scene: &'a Scene,
    mesh: &'a Mesh,
    corners: [usize; 3],
    weights: Vec3,
}

impl<'a> Point<'a> {
    fn new(scene: &'a Scene, instance: u32, triangle: u32, barycentric: Vec2) -> Self {
        let mesh = &scene.meshes[scene.instances[instance as usize].mesh as usize];
        let corners = mesh.triangles[triangle as usize].map(|v| v as usize);
        let weights = Vec3::new(1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y);
        Self { scene, mesh, corners, weights }
    }

    fn texel(&self, texture: &TextureRef, decode: fn([u8; 4]) -> Vec4) -> Vec4 {
        let set = &self.mesh.texcoords[usize::from(texture.texcoord)];
        let [a, b, c] = self.corners;
        let uv = set[a] * self.weights.x + set[b] * self.weights.y + set[c] * self.weights.z;
        texture.sample(&self.scene.images[texture.image as usize], uv, decode)
    }

    /// Base colour with alpha, clamped against rounding.
    fn base_color(&self, material: &Material) -> Vec4 {
        let colors = &self.mesh.colors;
        let [a, b, c] = self.corners;
        let vertex = colors[a] * self.weights.x + colors[b] * self.weights.y + colors[c] * self.weights.z;
        let texture = material.base_color_texture.as_ref().map_or(Vec4::ONE, |t| self.texel(t, srgb));
        (material.base_color * vertex * texture).clamp(Vec4::ZERO, Vec4::ONE)
    }

    fn emission(&self, material: &Material) -> Vec3 {
        if material.emission == Vec3::ZERO {
            return Vec3::ZERO;
        }
        material.emission * self.color(&material.emission_texture)
    }

    fn transmission(&self, material: &Material) -> f32 {
        if material.transmission == 0.0 {
            return 0.0;
        }
        material.transmission * material.transmission_texture.as_ref().map_or(1.0, |t| self.texel(t, linear).x)
    }

    /// Share and colour.
    fn diffuse_transmission(&self, material: &Material) -> (f32, Vec3) {
        if material.diffuse_transmission == 0.0 {
            return (0.0, Vec3::ZERO);
        }
        let share = material.diffuse_transmission_texture.as_ref().map_or(1.0, |t| self.texel(t, linear).w);
        let color = material.diffuse_transmission_color * self.color(&material.diffuse_transmission_color_texture);
        (material.diffuse_transmission * share, color)
    }

    /// An sRGB texture's colour; white where there is none.
    fn color(&self, texture: &Option<TextureRef>) -> Vec3 {
        texture.as_ref().map_or(Vec3::ONE, |t| self.texel(t, srgb).truncate())
    }
}

impl TextureRef {
    /// The texture at texture coordinates `uv` before its transform: texels decoded, then blended bilinearly (or the
    /// nearest taken). Texel (x, y) has its centre at ((x + 0.5)/width, (y + 0.5)/height), v down.
    fn sample(&self, image: &Image, uv: Vec2, decode: fn([u8; 4]) -> Vec4) -> Vec4 {
        let uv1 = uv.extend(1.0);
        let x = self.transform[0].dot(uv1) * image.width as f32;
        let y = self.transform[1].dot(uv1) * image.height as f32;
        let fetch = |x: f32, y: f32| {
            let column = self.wrap[0].texel(x, image.width);
            let row = self.wrap[1].texel(y, image.height);
            decode(image.rgba[row as usize * image.width as usize + column as usize])
        };
        if !self.linear {
            return fetch(x.floor(), y.floor());
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let above = fetch(left, top).lerp(fetch(left + 1.0, top), fx);
        let below = fetch(left, top + 1.0).lerp(fetch(left + 1.0, top + 1.0), fx);
        above.lerp(below, fy)
    }
}

impl Wrap {
    /// Index of the texel for a whole-numbered position, which may lie anywhere (no number reads as 0).
    fn texel(self, position: f32, size: u32) -> u32 {
        let (at, size) = (position as i64, i64::from(size));
        let wrapped = match self {
            Self::Repeat => at.rem_euclid(size),
            Self::Clamp => at.clamp(0, size - 1),
            Self::Mirror => {
                let at = at.rem_euclid(2 * size);
                at.min(2 * size - 1 - at)
            }
        };
        wrapped as u32
    }
}

/// IEC 61966-2-1, from 8 bits to linear.
static SRGB_TO_LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let c = i as f64 / 255.0;
        let linear = if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

/// A linear value in [0, 1] from its 8-bit sRGB code (IEC 61966-2-1).
pub fn srgb_to_linear(code: u8) -> f32 {
    SRGB_TO_LINEAR[usize::from(code)]
}

fn srgb([r, g, b, a]: [u8; 4]) -> Vec4 {
    let table = &*SRGB_TO_LINEAR;
    Vec4::new(table[usize::from(r)], table[usize::from(g)], table[usize::from(b)], f32::from(a) / 255.0)
}

fn linear(texel: [u8; 4]) -> Vec4 {
    Vec4::from(texel.map(f32::from)) / 255.0
}

#[cfg(test)]
mod tests {
    use super::super::{Instance, Primitive};
    use super::*;
    use proptest::prelude::*;
    use std::sync::Arc;

    const PLAIN: TextureRef =
        TextureRef { image: 0, texcoord: 0, wrap: [Wrap::Repeat; 2], linear: true, transform: [Vec3::X, Vec3::Y] };

    /// One triangle over the unit square's lower left half, uv = position, with one material.
    fn scene(material: Material, image: Option<Image>) -> Scene {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let uv: Vec<Vec2> = positions.iter().map(|p| p.truncate()).collect();
        let mesh = Mesh {
            normals: vec![Vec3::Z; 3],
            texcoords: [uv.clone(), uv.clone(), uv],
            colors: vec![Vec4::ONE; 3],
            triangles: vec![[0, 1, 2]],
            primitives: vec![Primitive { triangles: 0..1, vertices: 0..3, material: 0 }],
            positions,
            ..Mesh::default()
        };
        let instance = Instance {
            path: "t".into(),
            node: 0,
            mesh: 0,
            world_from_object: glam::Affine3A::IDENTITY,
            lightmapped: true,
        };
        let images = image.into_iter().map(Arc::new).collect();
        Scene { meshes: vec![mesh], instances: vec![instance], materials: vec![material], images, ..Scene::default() }
    }

    fn gray(width: u32, values: &[u8]) -> Image {
        Image { width, height: values.len() as u32 / width, rgba: values.iter().map(|v| [*v, *v, *v, *v]).collect() }
    }

    #[test]
    fn srgb_table_against_published_values() {
        // IEC 61966-2-1: both ends, and 188, whose linear value is close to one half.
        assert_eq!(SRGB_TO_LINEAR[0], 0.0);
        assert_eq!(SRGB_TO_LINEAR[255], 1.0);
        assert!((SRGB_TO_LINEAR[188] - 0.502_886_5).abs() < 1e-6);
        assert!((SRGB_TO_LINEAR[10] - 10.0 / 255.0 / 12.92).abs() < 1e-8);
    }

    #[test]
    fn bilinear_meets_texel_centres_and_blends_halfway() {
        let image = gray(2, &[0, 255, 0, 255]);
        let at = |u: f32| PLAIN.sample(&image, Vec2::new(u, 0.25), linear).x;
        for (u, want) in [(0.25, 0.0), (0.75, 1.0), (0.5, 0.5), (0.0, 0.5), (1.0, 0.5)] {
            assert!((at(u) - want).abs() < 1e-6, "{u}");
        }
    }

    #[test]
    fn rows_go_down() {
        let image = gray(1, &[0, 255]);
        assert_eq!(PLAIN.sample(&image, Vec2::new(0.5, 0.75), linear).x, 1.0);
    }

    #[test]
    fn wrapping() {
        for (wrap, at, want) in [
            (Wrap::Repeat, -1.0, 3),
            (Wrap::Repeat, 4.0, 0),
            (Wrap::Clamp, -1.0, 0),
            (Wrap::Clamp, 9.0, 3),
            (Wrap::Mirror, -1.0, 0),
            (Wrap::Mirror, 4.0, 3),
            (Wrap::Mirror, 7.0, 0),
            (Wrap::Mirror, 8.0, 0),
            (Wrap::Mirror, 9.0, 1),
        ] {
            assert_eq!(wrap.texel(at, 4), want, "{wrap:?} {at}");
        }
        for at in [f32::NAN, f32::INFINITY, -1e30] {
            for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
                assert!(wrap.texel(at, 4) < 4);
            }
        }
    }

    #[test]
    fn mask_cuts_and_blend_lets_through() {
        let image = || gray(2, &[100, 200]);
        let material = |alpha_mode| Material {
            alpha_mode,
            base_color_texture: Some(TextureRef { linear: false, ..PLAIN }),
            ..Material::default()
        };
        let point = |mode, u| Surface::at(&scene(material(mode), Some(image())), 0, 0, Vec2::new(u, 0.1));
        assert_eq!(point(AlphaMode::Mask(0.5), 0.2).through, Vec3::ONE);
        assert_eq!(point(AlphaMode::Mask(0.5), 0.8).through, Vec3::ZERO);
        assert_eq!(point(AlphaMode::Opaque, 0.2).through, Vec3::ZERO);
        let blend = point(AlphaMode::Blend, 0.2);
        let alpha = 100.0 / 255.0;
        assert!((blend.through - (1.0 - alpha)).abs().max_element() < 1e-6);
        assert!((blend.reflect - alpha * SRGB_TO_LINEAR[100]).abs().max_element() < 1e-6);
    }

    #[test]
    fn vertex_colours_multiply() {
        let mut scene = scene(Material { base_color: Vec4::splat(0.5), ..Material::default() }, None);
        scene.meshes[0].colors = vec![Vec4::ZERO, Vec4::ONE, Vec4::ZERO];
        assert_eq!(Surface::at(&scene, 0, 0, Vec2::new(0.5, 0.25)).reflect, Vec3::splat(0.25));
    }

    proptest! {
        /// Law: a surface never gives more than it gets.
        #[test]
        fn shares_never_exceed_one(
            base in prop::array::uniform4(0.0f32..=1.0), color in prop::array::uniform3(0.0f32..=1.0),
            t in 0.0f32..=1.0, d in 0.0f32..=1.0, mode in 0..3, texels in prop::array::uniform4(0u8..=255),
            u in -3.0f32..3.0, v in -3.0f32..3.0, unlit: bool,
        ) {
            let material = Material {
                base_color: base.into(),
                base_color_texture: Some(PLAIN),
                transmission: t,
                transmission_texture: Some(PLAIN),
                diffuse_transmission: d,
                diffuse_transmission_color: color.into(),
                alpha_mode: [AlphaMode::Opaque, AlphaMode::Mask(0.5), AlphaMode::Blend][mode as usize],
                unlit,
                ..Material::default()
            };
            let scene = scene(material, Some(gray(2, &texels)));
            let got = Surface::at(&scene, 0, 0, Vec2::new(u, v));
            let sum = got.reflect + got.transmit + got.through;
            prop_assert!(sum.max_element() <= 1.0 + 1e-6, "{got:?}");
            let least = got.reflect.min(got.transmit).min(got.through);
            prop_assert!(least.min_element() >= 0.0, "{got:?}");
        }
    }
}
