//! Small packages made with the writers of `bake-formats`, a device or a counted skip, and pictures as numbers.
#![allow(dead_code, reason = "each test file uses its own part")]

use bake_formats::baked_scene::{BakedScene, Geometry, Lightmap, Node, PageImage, Primitive, Texture};
use bake_formats::float_image::{FloatImage, PixelFormat, Quantity};
use bake_formats::glb::document as gltf;
use bake_formats::manifest::{InstanceRecord, PageRecord, Settings, Source};
use bake_formats::{Manifest, Package, PackageWriter, Term};
use bake_optics::medium::mesh::ClosedMesh;
use bake_runtime::{Camera, Headless, Model, Renderer, SceneData};
use glam::{Affine3A, DVec3, Vec2, Vec3};

/// A device, or a counted skip where there is no adapter.
pub fn headless() -> Option<Headless> {
    match Headless::open() {
        Ok(headless) => Some(headless),
        Err(error) => {
            testkit::reference::skip(&error.to_string());
            None
        }
    }
}

/// A scene with one page, to be written as a package.
pub struct Fixture {
    pub scene: BakedScene,
    pub size: [u32; 2],
    pub irradiance: Vec<[f32; 3]>,
    pub sh1: Option<Vec<Vec<[f32; 3]>>>,
    pub edit: Box<dyn Fn(&mut Manifest)>,
}

impl Fixture {
    /// An empty scene with a page of constant light.
    pub fn new(size: [u32; 2], light: [f32; 3]) -> Self {
        let irradiance = vec![light; (size[0] * size[1]) as usize];
        let page = PageImage { uri: "test.lightmap.00.exr".into(), preview: png(1, 1, &[255; 4]), preview_white: 1.0 };
        let scene = BakedScene { name: "test".into(), pages: vec![page], ..Default::default() };
        Self { scene, size, irradiance, sh1: None, edit: Box::new(|_| {}) }
    }

    /// Adds a material; returns its index.
    pub fn material(&mut self, edit: impl FnOnce(&mut gltf::Material)) -> u32 {
        let mut material = gltf::Material {
            name: format!("material {}", self.scene.materials.len()),
            pbr_metallic_roughness: gltf::Pbr {
                base_color_factor: [0.5, 0.5, 0.5, 1.0],
                base_color_texture: None,
                metallic_factor: 0.0,
                roughness_factor: 1.0,
            },
            emissive_factor: None,
            emissive_texture: None,
            alpha_mode: gltf::AlphaMode::Opaque,
            alpha_cutoff: None,
            double_sided: false,
            extensions: Default::default(),
        };
        edit(&mut material);
        self.scene.materials.push(material);
        self.scene.materials.len() as u32 - 1
    }

    /// Adds a texture, nearest neighbour; returns how a material refers to it.
    pub fn texture(&mut self, width: u32, height: u32, rgba: &[u8]) -> gltf::TextureInfo {
        let sampler = gltf::Sampler { mag_filter: 9728, min_filter: 9728, wrap_s: 33071, wrap_t: 33071 };
        self.scene.textures.push(Texture { png: png(width, height, rgba), sampler });
        gltf::TextureInfo { index: self.scene.textures.len() as u32 - 1, tex_coord: 0, extensions: None }
    }

    /// Adds a shape: the square [−1, 1]² at z = 0 that faces +z.
    pub fn square(&mut self, material: u32) -> u32 {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from);
        self.scene.geometries.push(Geometry {
            name: "square".into(),
            positions: corners.map(|c| c.extend(0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            texcoord_0: corners.map(|c| Vec2::new(0.5 + 0.5 * c.x, 0.5 - 0.5 * c.y)).to_vec(),
            primitives: vec![Primitive { triangles: vec![[0, 1, 2], [0, 2, 3]], material }],
            ..Default::default()
        });
        self.scene.geometries.len() as u32 - 1
    }

    /// Places a square, lit by the part `corner` … `corner + size` of the page, v downwards.
    pub fn place(&mut self, geometry: u32, map: Affine3A, corner: Vec2, size: Vec2) {
        let uv = self.scene.geometries[geometry as usize].texcoord_0.iter().map(|&uv| corner + size * uv).collect();
        let lightmap = Some(Lightmap { page: 0, uv });
        let path = format!("node {}", self.scene.nodes.len());
        self.scene.nodes.push(Node { path, source_node: 0, world_from_object: map, geometry, lightmap });
    }

    /// Writes the package.
    pub fn write(&self, folder: &std::path::Path) -> Package {
        let mut writer = PackageWriter::create(folder, "test").expect("a writer");
        let source = Source { file: "test.glb".into(), blake3: "0".repeat(64) };
        let mut manifest = Manifest::new("test", source, Settings::new(serde_json::json!({})));
        let mut image = FloatImage::new(self.size[0], self.size[1]);
        image.push_rgb("", Quantity::Irradiance, &self.irradiance);
        let lightmap = writer.add_image("lightmap.00.exr", &image, PixelFormat::F32).expect("a lightmap");
        let mut terms = FloatImage::new(self.size[0], self.size[1]);
        let (direct, indirect): (Vec<_>, Vec<_>) =
            self.irradiance.iter().map(|e| (e.map(|e| 0.75 * e), e.map(|e| 0.25 * e))).unzip();
        terms.push_rgb("direct", Quantity::Irradiance, &direct);
        terms.push_rgb("indirect", Quantity::Irradiance, &indirect);
        let variance: Vec<_> = self.irradiance.iter().map(|e| e.map(|e| (0.1 * e).powi(2))).collect();
        terms.push_rgb("variance", Quantity::IrradianceVariance, &variance);
        // The last texel was filled from its neighbours.
        let valid = (1..=terms.len()).map(|texel| f32::from(u8::from(texel < terms.len()))).collect();
        terms.push("validity.Y", Quantity::Validity, valid);
        let terms = writer.add_image("terms.00.exr", &terms, PixelFormat::F32).expect("terms");
        let sh1 = self.sh1.as_ref().map(|sh1| {
            let mut image = FloatImage::new(self.size[0], self.size[1]);
            sh1.iter().enumerate().for_each(|(i, c)| image.push_rgb(&format!("c{i}"), Quantity::ShRadiance, c));
            writer.add_image("sh1.00.exr", &image, PixelFormat::F32).expect("harmonics")
        });
        let [width, height] = self.size;
        manifest.pages = vec![PageRecord { width, height, lightmap, terms, sh1, raw: None }];
        manifest.terms = vec![Term::Direct, Term::Indirect];
        let instances = self.scene.nodes.iter().enumerate().map(|(index, node)| InstanceRecord {
            baked_node: index as u32,
            node: 0,
            path: node.path.clone(),
            name: String::new(),
            page: 0,
            uv_offset: Vec2::ZERO,
            uv_scale: Vec2::ONE,
        });
        manifest.instances = instances.collect();
        (self.edit)(&mut manifest);
        let bytes = self.scene.to_bytes(&folder.join("test.baked.glb")).expect("a scene");
        writer.add_bytes("baked.glb", &bytes).expect("a scene file");
        writer.finish(manifest).expect("a package");
        Package::open(folder).expect("a package that was just written")
    }

    /// The scene read back from a package in a temporary folder.
    pub fn load(&self) -> SceneData {
        let folder = tempfile::tempdir().expect("a temporary folder");
        SceneData::load(&self.write(folder.path())).expect("a package that was just written loads")
    }
}

/// An L of 2 m x 2 m x 1 m and a block that overlaps it, all corners dyadic; the first `count` of them.
pub fn angle(count: usize, place: impl Fn(DVec3) -> DVec3) -> ClosedMesh {
    let shells = [
        ([0.0, 1.0], vec![[0.0, 0.0], [2.0, 0.0], [2.0, 0.75], [0.75, 0.75], [0.75, 2.0], [0.0, 2.0]]),
        ([0.25, 0.75], vec![[0.5, 1.0], [1.5, 1.0], [1.5, 1.5], [0.5, 1.5]]),
    ];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (heights, outline) in shells.into_iter().take(count) {
        let (first, count) = (positions.len() as u32, outline.len() as u32);
        let corners = heights.iter().flat_map(|&z| outline.iter().map(move |&[x, y]| DVec3::new(x, y, z)));
        positions.extend(corners.map(&place));
        let side = |i: u32| [[i, (i + 1) % count, (i + 1) % count + count], [i, (i + 1) % count + count, i + count]];
        // Fans about the first corner: both outlines are seen as a whole from there.
        let caps = (1..count - 1).flat_map(|i| [[0, i + 1, i], [count, count + i, count + i + 1]]);
        triangles.extend((0..count).flat_map(side).chain(caps).map(|t| t.map(|i| i + first)));
    }
    ClosedMesh::new(&positions, &triangles).expect("closed")
}

/// PNG of 8-bit RGBA.
pub fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let image = image::RgbaImage::from_raw(width, height, rgba.to_vec()).expect("four bytes a texel");
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG");
    bytes.into_inner()
}

/// A camera `distance` in front of the origin that looks along −z and sees 1 m up and down at distance 2.
pub fn front(distance: f64) -> Camera {
    let mut camera = Camera::look_at(DVec3::new(0.0, 0.0, distance), DVec3::ZERO);
    camera.fov_y = 2.0 * 0.5f32.atan();
    camera
}

/// Radiance of a picture, row by row from the top, and the display's bytes.
pub fn picture(
    headless: &Headless,
    scene: SceneData,
    camera: &Camera,
    settings: &bake_runtime::Settings,
    size: [u32; 2],
) -> (Vec<[f32; 3]>, Vec<u8>) {
    let model = Model::new(&headless.device, &headless.queue, scene).expect("a small scene fits");
    let mut renderer = Renderer::new(&headless.device, &headless.queue, wgpu::TextureFormat::Rgba8Unorm);
    let target = headless.target(size, wgpu::TextureFormat::Rgba8Unorm);
    renderer.draw(&model, camera, settings, &target.create_view(&Default::default()), size);
    let display = headless.read_texture(&target).expect("bytes come back");
    (radiance(headless, &renderer), display)
}

/// The last picture's radiance.
pub fn radiance(headless: &Headless, renderer: &Renderer) -> Vec<[f32; 3]> {
    let texture = renderer.radiance().expect("a picture was drawn");
    let bytes = headless.read_texture(texture).expect("bytes come back");
    match texture.format() {
        wgpu::TextureFormat::Rgba32Float => {
            bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned::<[f32; 4]>).map(|[r, g, b, _]| [r, g, b]).collect()
        }
        _ => {
            let half = |t: &[u8]| bytemuck::pod_read_unaligned::<[u16; 4]>(t).map(|h| half::f16::from_bits(h).to_f32());
            bytes.chunks_exact(8).map(half).map(|[r, g, b, _]| [r, g, b]).collect()
        }
    }
}
