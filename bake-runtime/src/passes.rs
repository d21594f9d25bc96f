//! Pipelines made from variants, their bindings taken from the shader itself: what a shader does not declare is not bound.

use std::collections::HashMap;

use wgpu::naga;

use crate::scene::Vertex;
use crate::shader;
use crate::variant::{Pass, Variant};

/// Everything that tells pipelines apart.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Key {
    pub variant: Variant,
    pub format: wgpu::TextureFormat,
    pub mirrored: bool,
    pub double_sided: bool,
    pub blended: bool,
}

impl Key {
    /// A pass over the whole target.
    pub fn screen(variant: Variant, format: wgpu::TextureFormat) -> Self {
        Self { variant, format, mirrored: false, double_sided: true, blended: false }
    }
}

/// A pipeline and what it binds.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub pipeline: wgpu::RenderPipeline,
    groups: Vec<Group>,
}

/// The bindings of one group.
#[derive(Debug)]
struct Group {
    layout: wgpu::BindGroupLayout,
    names: Vec<(u32, String)>,
}

/// A binding as the shader declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// Its group.
    pub group: u32,
    /// Its number.
    pub binding: u32,
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: wgpu::BindingType,
}

/// The bindings that a parsed shader declares, in order.
pub fn bindings(module: &naga::Module) -> Vec<Binding> {
    let declared = module.global_variables.iter().filter_map(|(_, variable)| {
        let place = variable.binding.as_ref()?;
        let name = variable.name.clone().unwrap_or_default();
        let ty = binding_type(&name, variable.space, &module.types[variable.ty].inner)?;
        Some(Binding { group: place.group, binding: place.binding, name, ty })
    });
    let mut declared: Vec<Binding> = declared.collect();
    declared.sort_by_key(|binding| (binding.group, binding.binding));
    declared
}

/// Textures named `…_texels` are read texel by texel and never filtered.
fn binding_type(name: &str, space: naga::AddressSpace, ty: &naga::TypeInner) -> Option<wgpu::BindingType> {
    use naga::{AddressSpace, ImageClass, ImageDimension, TypeInner};
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    Some(match (space, ty) {
        (AddressSpace::Uniform, _) => buffer(wgpu::BufferBindingType::Uniform),
        (AddressSpace::Storage { access }, _) => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !access.contains(naga::StorageAccess::STORE) })
        }
        (_, TypeInner::Sampler { comparison: true }) => {
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison)
        }
        (_, TypeInner::Sampler { .. }) => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        (_, TypeInner::Image { dim, arrayed, class }) => wgpu::BindingType::Texture {
            sample_type: match class {
                ImageClass::Depth { .. } => wgpu::TextureSampleType::Depth,
                _ => wgpu::TextureSampleType::Float { filterable: !name.ends_with("_texels") },
            },
            view_dimension: match (dim, arrayed) {
                (ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
                (ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
                (ImageDimension::D3, _) => wgpu::TextureViewDimension::D3,
                _ => return None,
            },
            multisampled: false,
        },
        _ => return None,
    })
}

/// Pipelines by key, made at first use.
#[derive(Debug, Default)]
pub(crate) struct Pipelines(HashMap<Key, Pipeline>);

impl Pipelines {
    pub fn get(&mut self, device: &wgpu::Device, key: Key) -> &Pipeline {
        self.0.entry(key).or_insert_with_key(|key| Pipeline::new(device, key))
    }

    /// Variants made so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.0.keys().map(|key| &key.variant)
    }
}

impl Pipeline {
    fn new(device: &wgpu::Device, key: &Key) -> Self {
        let text = shader::compose(&key.variant);
        let parsed = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| {
            panic!("the shader '{}' does not parse: {}", key.variant, error.emit_to_string(&text))
        });
        let groups = groups(device, &bindings(&parsed));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("composed"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let layouts: Vec<_> = groups.iter().map(|group| Some(&group.layout)).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        Self { pipeline: render_pipeline(device, key, &module, &layout), groups }
    }

    /// Binds a group to what `resource` knows under the names that the shader uses.
    pub fn bind<'a>(
        &self,
        device: &wgpu::Device,
        pass: &mut wgpu::RenderPass,
        group: usize,
        resource: impl Fn(&str) -> wgpu::BindingResource<'a>,
    ) {
        let Some(Group { layout, names }) = self.groups.get(group) else { return };
        let entries: Vec<_> = (names.iter())
            .map(|(binding, name)| wgpu::BindGroupEntry { binding: *binding, resource: resource(name) })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        pass.set_bind_group(group as u32, &device.create_bind_group(&descriptor), &[]);
    }
}

/// Layouts of groups 0 to the last that has a binding; empty ones between are allowed.
fn groups(device: &wgpu::Device, bindings: &[Binding]) -> Vec<Group> {
    let count = bindings.iter().map(|binding| binding.group + 1).max().unwrap_or(0);
    let group = |group: u32| {
        let own: Vec<&Binding> = bindings.iter().filter(|binding| binding.group == group).collect();
        let entry = |binding: &&Binding| wgpu::BindGroupLayoutEntry {
            binding: binding.binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: binding.ty,
            count: None,
        };
        let entries: Vec<_> = own.iter().map(entry).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let names = own.iter().map(|binding| (binding.binding, binding.name.clone())).collect();
        Group { layout: device.create_bind_group_layout(&descriptor), names }
    };
    (0..count).map(group).collect()
}

fn render_pipeline(
    device: &wgpu::Device,
    key: &Key,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
) -> wgpu::RenderPipeline {
    let attributes =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x4, 4 => Float32x4];
    let vertices = wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let pass = key.variant.pass();
    let meshes = matches!(pass, Pass::Surface | Pass::Caster | Pass::Pick);
    let buffers = [meshes.then_some(vertices)];
    let target = wgpu::ColorTargetState {
        format: key.format,
        blend: key.blended.then_some(wgpu::BlendState::ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("pass"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: if meshes { &buffers } else { &[] },
        },
        primitive: wgpu::PrimitiveState {
            front_face: if key.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
            cull_mode: (!key.double_sided).then_some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: depth_state(key),
        multisample: Default::default(),
        fragment: (pass != Pass::Caster).then_some(wgpu::FragmentState {
            module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(target)],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Depth is near/distance: nearer is greater. The sky and blended surfaces leave it as it is.
fn depth_state(key: &Key) -> Option<wgpu::DepthStencilState> {
    let (write, compare) = match key.variant.pass() {
        Pass::Surface => (!key.blended, wgpu::CompareFunction::Greater),
        Pass::Caster | Pass::Pick => (true, wgpu::CompareFunction::Greater),
        Pass::Sky => (false, wgpu::CompareFunction::Always),
        _ => return None,
    };
    Some(wgpu::DepthStencilState {
        format: wgpu::TextureFormat::Depth32Float,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: Default::default(),
        bias: Default::default(),
    })
}
