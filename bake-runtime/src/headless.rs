//! A device without a window, and pictures read back from it.

use crate::error::{Result, RuntimeError};

/// Device, queue and what they run on.
#[derive(Debug)]
pub struct Headless {
    /// What the device was opened on.
    pub adapter: wgpu::Adapter,
    /// Where textures and pipelines live.
    pub device: wgpu::Device,
    /// Where work is sent.
    pub queue: wgpu::Queue,
    /// Name, kind and driver.
    pub info: wgpu::AdapterInfo,
}

/// Features that make drawing better where the adapter has them; none is needed.
pub fn wanted_features() -> wgpu::Features {
    wgpu::Features::FLOAT32_BLENDABLE | wgpu::Features::TIMESTAMP_QUERY
}

/// What to ask of an adapter: wanted features it has, and its own limits.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("bake-runtime"),
        required_features: adapter.features() & wanted_features(),
        required_limits: adapter.limits(),
        ..Default::default()
    }
}

impl Headless {
    /// Opens the adapter named by `WGPU_ADAPTER_NAME`, else the fastest; software Vulkan counts.
    pub fn open() -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        pollster::block_on(Self::open_on(&instance, None))
    }

    /// The same on an instance, for a surface where there is one.
    pub async fn open_on(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self> {
        let adapter = match wgpu::util::initialize_adapter_from_env(instance, surface).await {
            Ok(adapter) => adapter,
            Err(_) => {
                let options = wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    compatible_surface: surface,
                    ..Default::default()
                };
                let found = instance.request_adapter(&options).await;
                found.map_err(|error| RuntimeError::NoAdapter { reason: error.to_string() })?
            }
        };
        let info = adapter.get_info();
        let opened = adapter.request_device(&device_descriptor(&adapter)).await;
        let (device, queue) =
            opened.map_err(|error| RuntimeError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        Ok(Self { adapter, device, queue, info })
    }

    /// A texture that can be drawn to and read back.
    pub fn target(&self, size: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("target"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
    }

    /// Bytes of a texture's first level, rows without padding.
    pub fn read_texture(&self, texture: &wgpu::Texture) -> Result<Vec<u8>> {
        read_texture(&self.device, &self.queue, texture)
    }

    /// Bytes of a buffer that has `COPY_SRC`.
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
        read_buffer(&self.device, &self.queue, buffer)
    }
}

/// Bytes of a buffer that has `COPY_SRC`.
pub fn read_buffer(device: &wgpu::Device, queue: &wgpu::Queue, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
    let copy = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
    queue.submit([encoder.finish()]);
    map(device, &copy)
}

/// Bytes of a texture's first level, rows without padding.
pub fn read_texture(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Result<Vec<u8>> {
    let size = texture.size();
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    let row = size.width * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: u64::from(padded) * u64::from(size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
        },
        wgpu::Extent3d { depth_or_array_layers: 1, ..size },
    );
    queue.submit([encoder.finish()]);
    let bytes = map(device, &buffer)?;
    Ok(bytes.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}

/// Waits for the device and copies a mappable buffer.
fn map(device: &wgpu::Device, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
    let failed = |reason: String| RuntimeError::ReadBack { reason };
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
        // The receiver is gone only when waiting failed, which is told below.
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
    let mapped = receiver.recv().map_err(|error| failed(error.to_string()))?;
    mapped.map_err(|error| failed(error.to_string()))?;
    let view = buffer.slice(..).get_mapped_range();
    Ok(view.map_err(|error| failed(error.to_string()))?.to_vec())
}
