//! A scene on the device: buffers, textures, and what is drawn.

use std::sync::OnceLock;

use bake_formats::glb::document::Sampler;
use wgpu::util::DeviceExt;

use crate::error::{Result, RuntimeError};
use crate::scene::{Draw, LatticeData, Page, SceneData, Texture};
use crate::sky;

/// A scene on the device.
#[derive(Debug)]
pub struct Model {
    /// What it was made from, without pixels and vertices.
    pub scene: SceneData,
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) instances: wgpu::Buffer,
    pub(crate) page_uvs: wgpu::Buffer,
    /// Chart of each page coordinate, once they are set.
    pub(crate) page_charts: Option<wgpu::Buffer>,
    pub(crate) surfaces: Vec<wgpu::Buffer>,
    pub(crate) textures: Vec<(wgpu::TextureView, wgpu::Sampler)>,
    pub(crate) pages: Vec<PageViews>,
    pub(crate) probes: Option<wgpu::TextureView>,
    pub(crate) air_light: Option<wgpu::TextureView>,
    /// The environment's picture.
    pub(crate) sky: Option<wgpu::TextureView>,
    /// Its harmonics, once they were asked for.
    sky_harmonics: OnceLock<Vec<[f64; 3]>>,
    /// Exponents of the materials' Phong lobes, each once.
    pub(crate) exponents: Vec<f32>,
}

/// A lightmap page on the device.
#[derive(Debug)]
pub(crate) struct PageViews {
    pub irradiance: wgpu::TextureView,
    pub sh1: Option<wgpu::TextureView>,
}

impl Model {
    /// Puts a scene on the device. Errors: a page, texture or buffer beyond the device's limits.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, mut scene: SceneData) -> Result<Self> {
        check_limits(device, &scene)?;
        let exponents = number_lobes(&mut scene);
        let buffer = |label, bytes: &[u8], usage| {
            // Empty lists still need a binding.
            let contents = if bytes.is_empty() { &[0; 64] } else { bytes };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let model = Self {
            vertices: buffer("vertices", bytemuck::cast_slice(&scene.vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer("indices", bytemuck::cast_slice(&scene.indices), wgpu::BufferUsages::INDEX),
            instances: buffer("instances", bytemuck::cast_slice(&scene.instances), storage),
            page_uvs: buffer("page_uvs", bytemuck::cast_slice(&scene.page_uvs), storage),
            page_charts: None,
            surfaces: (scene.materials.iter())
                .map(|m| buffer("surface", bytemuck::bytes_of(&m.surface), wgpu::BufferUsages::UNIFORM))
                .collect(),
            textures: scene.textures.iter().map(|texture| upload_texture(device, queue, texture)).collect(),
            pages: scene.pages.iter().map(|page| upload_page(device, queue, page)).collect(),
            probes: scene.probes.as_ref().map(|lattice| upload_lattice(device, queue, lattice)),
            air_light: scene.air_light.as_ref().map(|lattice| upload_lattice(device, queue, lattice)),
            sky: scene
                .sky
                .as_ref()
                .map(|sky| upload_texels(device, queue, [sky.width, sky.height], &[opaque(&sky.radiance)], false)),
            sky_harmonics: OnceLock::new(),
            exponents,
            scene: SceneData::default(),
        };
        scene.vertices = Vec::new();
        scene.indices = Vec::new();
        scene.textures.iter_mut().for_each(|texture| texture.rgba = Vec::new());
        Ok(Self { scene, ..model })
    }

    /// Puts other irradiance on a lightmap page, lux, row by row. Panics where it is not one value a texel.
    pub fn set_irradiance(&self, queue: &wgpu::Queue, page: usize, texels: &[[f32; 3]]) {
        let texture = self.pages[page].irradiance.texture();
        let wgpu::Extent3d { width, height, .. } = texture.size();
        assert_eq!(texels.len(), width as usize * height as usize, "one value a texel");
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * width), rows_per_image: None };
        let texels = opaque(texels);
        queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, texture.size());
    }

    /// Tells the chart of each page coordinate ([`crate::scene::page_charts`]), for [`crate::Show::Charts`].
    pub fn set_charts(&mut self, device: &wgpu::Device, charts: &[u32]) {
        let contents = if charts.is_empty() { &[0; 4] } else { bytemuck::cast_slice(charts) };
        let usage = wgpu::BufferUsages::STORAGE;
        let descriptor = wgpu::util::BufferInitDescriptor { label: Some("page_charts"), contents, usage };
        self.page_charts = Some(device.create_buffer_init(&descriptor));
    }

    /// Whether the charts are known.
    pub fn has_charts(&self) -> bool {
        self.page_charts.is_some()
    }

    /// Harmonics of the environment's picture; `None` where there is no picture.
    pub(crate) fn sky_harmonics(&self) -> Option<&[[f64; 3]]> {
        let picture = self.scene.sky.as_ref()?;
        Some(self.sky_harmonics.get_or_init(|| sky::harmonics(picture)))
    }

    /// Sets vertex and index lists.
    pub(crate) fn bind_lists(&self, pass: &mut wgpu::RenderPass) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }

    /// Whether a draw's page holds harmonics.
    pub(crate) fn has_sh1(&self, draw: &Draw) -> bool {
        draw.page.is_some_and(|page| self.pages[page as usize].sh1.is_some())
    }

    /// What a draw binds of its page, by the shader's name.
    pub(crate) fn page_resource(&self, draw: &Draw, name: &str) -> wgpu::BindingResource<'_> {
        let page = &self.pages[draw.page.expect("only lightmapped shaders bind a page") as usize];
        wgpu::BindingResource::TextureView(match name {
            "sh1_texels" => page.sh1.as_ref().unwrap_or(&page.irradiance),
            _ => &page.irradiance,
        })
    }

    /// What a draw binds of its material, by the shader's name.
    pub(crate) fn material_resource(&self, draw: &Draw, name: &str) -> wgpu::BindingResource<'_> {
        let material = &self.scene.materials[draw.material as usize];
        let texture = |index: Option<u32>| &self.textures[index.expect("only textured shaders bind one") as usize];
        match name {
            "base_texture" => wgpu::BindingResource::TextureView(&texture(material.base_texture).0),
            "base_sampler" => wgpu::BindingResource::Sampler(&texture(material.base_texture).1),
            "normal_texture" => wgpu::BindingResource::TextureView(&texture(material.normal_texture).0),
            "normal_sampler" => wgpu::BindingResource::Sampler(&texture(material.normal_texture).1),
            "emission_texture" => wgpu::BindingResource::TextureView(&texture(material.emission_texture).0),
            "emission_sampler" => wgpu::BindingResource::Sampler(&texture(material.emission_texture).1),
            _ => self.surfaces[draw.material as usize].as_entire_binding(),
        }
    }
}

/// Numbers the Phong lobes that occur; layer 0 of the table is Lambert's.
fn number_lobes(scene: &mut SceneData) -> Vec<f32> {
    let mut exponents = Vec::new();
    for material in scene.materials.iter_mut().filter(|material| material.shines) {
        let exponent = material.surface.exponent;
        let known = exponents.iter().position(|&known| known == exponent);
        let at = known.unwrap_or_else(|| {
            exponents.push(exponent);
            exponents.len() - 1
        });
        material.surface.lobe = at as u32 + 1;
    }
    exponents
}

fn upload_lattice(device: &wgpu::Device, queue: &wgpu::Queue, lattice: &LatticeData) -> wgpu::TextureView {
    let [nx, ny, nz] = lattice.count;
    upload_texels(device, queue, [nx * nz, ny], &lattice.harmonics, true)
}

fn check_limits(device: &wgpu::Device, scene: &SceneData) -> Result<()> {
    let limits = device.limits();
    let side = limits.max_texture_dimension_2d;
    let sizes = scene.pages.iter().map(|p| ("a lightmap page", p.width.max(p.height)));
    let probes = scene
        .probes
        .iter()
        .chain(&scene.air_light)
        .map(|p| ("the image of probes or fog cells", (p.count[0] * p.count[2]).max(p.count[1])));
    let sky = scene.sky.iter().map(|sky| ("the environment's picture", sky.width.max(sky.height)));
    let sizes =
        sizes.chain(probes).chain(sky).chain(scene.textures.iter().map(|t| ("a texture", t.width.max(t.height))));
    for (what, size) in sizes {
        if size > side {
            let (what, needed, allowed) = (format!("{what}'s side in texels"), size.into(), side.into());
            let next = "bake with a smaller --page-size, or make the textures smaller";
            return Err(RuntimeError::Limit { what, needed, allowed, next });
        }
    }
    let buffers = [
        ("the vertex list in bytes", size_of_val(scene.vertices.as_slice()), limits.max_buffer_size),
        ("page coordinates in bytes", size_of_val(scene.page_uvs.as_slice()), limits.max_storage_buffer_binding_size),
    ];
    for (what, needed, allowed) in buffers {
        if needed as u64 > allowed {
            let next = "split the scene";
            return Err(RuntimeError::Limit { what: what.into(), needed: needed as u64, allowed, next });
        }
    }
    Ok(())
}

/// An image with all its levels; each is the mean of four texels of the one above, in linear light.
fn upload_texture(device: &wgpu::Device, queue: &wgpu::Queue, texture: &Texture) -> (wgpu::TextureView, wgpu::Sampler) {
    let (width, height) = (texture.width.max(1), texture.height.max(1));
    let mip_level_count = 32 - width.max(height).leading_zeros();
    let descriptor = wgpu::TextureDescriptor {
        label: Some("texture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: if texture.linear { wgpu::TextureFormat::Rgba8Unorm } else { wgpu::TextureFormat::Rgba8UnormSrgb },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let mut bytes = texture.rgba.clone();
    let mut level = texture.rgba.clone();
    let mut size = [width, height];
    while size != [1, 1] {
        (level, size) = halve(&level, size);
        bytes.extend_from_slice(&level);
    }
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let view = device.create_texture_with_data(queue, &descriptor, order, &bytes).create_view(&Default::default());
    (view, device.create_sampler(&sampler(&texture.sampler)))
}

/// The next smaller level of an sRGB image with linear opacity.
fn halve(texels: &[u8], [width, height]: [u32; 2]) -> (Vec<u8>, [u32; 2]) {
    let size = [(width / 2).max(1), (height / 2).max(1)];
    let linear = |byte: u8| (f32::from(byte) / 255.0).powf(2.2);
    let mut out = Vec::with_capacity((size[0] * size[1] * 4) as usize);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let at = |dx: u32, dy: u32| {
                let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                ((y * width + x) * 4) as usize
            };
            let around = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            for channel in 0..3 {
                let mean = around.iter().map(|&i| linear(texels[i + channel])).sum::<f32>() * 0.25;
                out.push((mean.powf(1.0 / 2.2) * 255.0).round() as u8);
            }
            out.push((around.iter().map(|&i| u32::from(texels[i + 3])).sum::<u32>() / 4) as u8);
        }
    }
    (out, size)
}

/// glTF's sampler numbers (glTF 2.0, section 5.26).
fn sampler(sampler: &Sampler) -> wgpu::SamplerDescriptor<'static> {
    let wrap = |mode| match mode {
        33071 => wgpu::AddressMode::ClampToEdge,
        33648 => wgpu::AddressMode::MirrorRepeat,
        _ => wgpu::AddressMode::Repeat,
    };
    let filter = if sampler.mag_filter == 9728 { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
    wgpu::SamplerDescriptor {
        label: Some("material"),
        address_mode_u: wrap(sampler.wrap_s),
        address_mode_v: wrap(sampler.wrap_t),
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    }
}

/// With a fourth channel.
fn opaque(texels: &[[f32; 3]]) -> Vec<[f32; 4]> {
    texels.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect()
}

fn upload_page(device: &wgpu::Device, queue: &wgpu::Queue, page: &Page) -> PageViews {
    let size = [page.width, page.height];
    let sh1 = page.sh1.as_ref().map(|sh1| sh1.iter().map(|texels| opaque(texels)).collect::<Vec<_>>());
    PageViews {
        irradiance: upload_texels(device, queue, size, &[opaque(&page.irradiance)], false),
        sh1: sh1.map(|layers| upload_texels(device, queue, size, &layers, true)),
    }
}

/// Four-channel f32 images of one size as layers of a texture.
pub(crate) fn upload_texels(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    [width, height]: [u32; 2],
    layers: &[Vec<[f32; 4]>],
    array: bool,
) -> wgpu::TextureView {
    let texels: Vec<[f32; 4]> = layers.iter().flatten().copied().collect();
    let descriptor = wgpu::TextureDescriptor {
        label: Some("texels"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers.len() as u32 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = device.create_texture_with_data(queue, &descriptor, order, bytemuck::cast_slice(&texels));
    let dimension = if array { wgpu::TextureViewDimension::D2Array } else { wgpu::TextureViewDimension::D2 };
    texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
}
